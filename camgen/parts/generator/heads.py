"""Heads of pins, and the levels that they take."""

from __future__ import annotations

import math

from camgen.parts.generator.layout import Layout


def levels_beyond(layout: Layout, point: str) -> tuple[int, int]:
    """How many levels the head of a pin takes over its highest link, and it or a thread under its lowest."""
    if point in layout.shafts:
        collar = layout.collar(point)
        step = layout.least_thickness + layout.fits.slide_clearance
        over = int(point in layout.over_shafts)
        return over if collar is None else math.ceil(collar.height / step), 0
    if len(layout.webs_at(point)) > 1 or layout.on_ground(point):
        return 0, 0
    if point in layout.eccentrics.values():  # another eccentric holds down what turns on it
        return 0, 0
    if layout.kind(point) == "shoulder":
        screw = layout.sizes.shoulder
        least = layout.least_thickness
        step = least + layout.fits.slide_clearance
        over = math.ceil((screw.height + least / 2) / step)
        return over, math.ceil(screw.thread_length / step)
    taken = 1 + (point in layout.tall)
    return (0, taken) if point in layout.hung_points else (taken, 0)


def head_room(layout: Layout, point: str) -> float:
    """Height of the levels that are kept free over a pin's highest link, mm."""
    over = levels_beyond(layout, point)[0]
    play = layout.fits.slide_clearance
    return over * (layout.least_thickness + play) - play
