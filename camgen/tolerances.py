"""Every tolerance that is not a user's choice: a name, a unit, a reason."""

from __future__ import annotations

# Two points of exact geometry closer than this are one point, mm. Coordinates reach 1e5 mm, where float64 resolves 1.5e-11.
SAME_POINT = 1e-9

# Newton on an intersection of exact curves stops below this residual, mm (a few ulp of a 100 mm coordinate is 1e-13).
INTERSECTION = 1e-12

# Largest relative rounding of a coordinate by the float32 of STL and 3MF: half an ulp, 2**-24.
FLOAT32_ROUNDING = 2.0**-24

# A triangle's unit normal as an STL stores it against the one of its corners: float32 and slivers; a turned one is 2 off.
NORMAL_ROUNDING = 1e-4

# Corners of a crossed body that are nearer than so many float32 roundings in each coordinate are made one.
MERGED_STEPS = 8

# Error of a copy's place in a 3MF, as a share of the sizes in its transform, which is written with six decimals.
TRANSFORM_ROUNDING = 4e-6

# Chord tolerance at which walls between arcs are measured, mm.
WALL_FACETS = 1e-3

# Share of a print compensation that its way back through facets may leave at corners between an arc and another edge.
WAY_BACK = 0.05

# Spare allowed on a first-order error bound for the terms of second order.
BOUND_SPARE = 0.05

# Cam angles at which a file's motion is judged; seeded random, so never the generator's own.
JUDGED_ANGLES = 7200

# Window over which speed is averaged before it is compared, deg of cam angle: facets make raw speed ripple as 1/N.
SPEED_WINDOW_DEG = 5.0

# Volume may differ by this share, besides the facets' own part; it finds a lost hole or a wrong thickness,
# the outline's accuracy is judged by the motion.
VOLUME_SHARE = 1e-3

# A law of motion joins its neighbour where displacement and derivatives agree to this share of their peaks: published
# coefficients have six decimals (MR-13 leaves its ends with speed 2.8e-8, with the misprinted sign 1.6e-3).
LAW_CLOSES = 1e-6

# Ends of lines and arcs from other programs' drawings that are one point, mm: some write gaps of 1.3 um, and a gap of
# 5 um cannot be meant.
CHAIN_GAP = 5e-3

# Chords for splines and ellipses that are read, mm: a tenth of the finest outline tolerance in use.
CURVE_CHORDS = 1e-4
