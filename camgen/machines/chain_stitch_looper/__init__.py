"""The loopers of a two-thread chain stitch."""
