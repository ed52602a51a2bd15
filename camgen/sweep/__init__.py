"""Many variants of one spec, each made and judged, as rows of one table."""
