"""A spec while it is being written: rebuilt on save, or tried with sliders; pages that this machine alone can open."""
