"""A drum: several disc cams and rows of pins on one shaft, as one part."""
