"""Plane geometry: exact outlines, facets, arcs, rings, distances; it knows of no machine."""
