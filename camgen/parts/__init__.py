"""Bodies to make: stacks of layers, machine parts, fits, what is bought."""
