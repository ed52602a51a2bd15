"""Bodies that drive by their outlines: gears, rings, racks, planets, wheels that are not round, Geneva wheels, ratchets, cycloidal discs.

Each module makes one kind: a frozen record that checks itself, its radii in closed form, its edge as an exact contour about
the body's axis. DesignError, without a place, where there is none such.
"""
