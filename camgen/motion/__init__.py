"""Laws of motion, programs of a turn, and the search for them."""
