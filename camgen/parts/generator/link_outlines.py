"""Edges of links, and what they are drawn round."""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, bulged
from camgen.parts.bands import ArmBand
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.dowels import dowel_hubs, stud_hubs
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.slotted import SlotHole, one_by_one
from camgen.parts.generator.wheels import NOSE, Tip, pivot
from camgen.parts.part import hull, with_bar


def link_hubs(layout: Layout, link: str) -> list[tuple[complex, float]]:
    """What a link's band is drawn round: hubs, and the feet of rails that stand on it."""
    wall = layout.sizes.wall if link == GROUND else 0.0
    foot = layout.sizes.rail_width / 2 + wall
    guides = (each for each in layout.guides.values() if each.joint.guide.body == link)
    feet = ((z, foot) for each in guides for ends in each.rails for z in ends)
    return [*layout.round_hubs(link), *feet, *dowel_hubs(layout, link), *stud_hubs(layout, link)]


def tip_bar(layout: Layout, tip: Tip) -> tuple[complex, complex, float, float, bool] | None:
    """The bar with the face or knife of a link that swings.

    Begin and direction of its middle line in the link's axes, half width and length, mm, and whether it is pointed. None of what slides; DesignError where a face's hub would be in the way.
    """
    if tip.joint.slide is not None:
        return None
    start = float(layout.machine.start_of(tip.joint.follower).angle)
    if tip.shape == "knife":
        away = tip.away(start)
        reach = NOSE * layout.nose_radius
        return (
            layout.at(tip.joint.follower, tip.point) + reach * away,
            -away,
            0.5 * layout.nose_radius,
            reach,
            True,
        )
    link = tip.joint.follower
    low, high = tip.face()
    hinge = pivot(layout.machine, link)[0]
    hub = layout.hub(next(name for name, z in layout.points_of(link).items() if z == hinge), link)
    near, far = sorted((abs(low), abs(high)))
    if low * high < 0 or near < hub or len(layout.points_of(link)) > 1:
        quantity = "place on the face where it is touched"
        where = f"cam {tip.joint.name}"
        remedy = "draw the hinge further off, and no other pins on this link: its hub must stay clear of the cam"
        raise DesignError(quantity, near, hub, "mm from the hinge", where, remedy)
    facing = tip.away(start)
    half = 0.4 * hub
    return hinge + half * facing, math.copysign(1, low + high) * 1j * facing, half, far, False


def arm_band(layout: Layout, link: str) -> ArmBand | None:
    """The band of a link that is asked to be bent or narrower than its hubs; DesignError where it has not two of them."""
    shape = layout.sizes.shape(link)
    hubs = link_hubs(layout, link)
    if shape.contours or (not shape.bow and shape.width is None):
        return None
    key = f"parts.{link}.{'bow' if shape.bow else 'width'}"
    if (
        len(hubs) != 2
        or link in layout.guides
        or layout.noses(link)
        or link == GROUND
        or layout.slots_of(link)
    ):
        remedy = "leave it out: it is for a link with two round holes and nothing else"
        raise DesignError(key, shape.bow or shape.width or 0.0, 0, "mm", f"link {link}", remedy)
    (a, first), (b, second) = hubs
    return ArmBand(
        link, a, b, (first, second), shape.width or 2 * min(first, second), shape.bow or 0.0
    )


def own_contours(layout: Layout, link: str) -> list[Contour]:
    """The outline of a cycloidal disc or a person's drawing and its holes, in the link's axes; nothing of other links.
    DesignError where the link has another body than a plate with round holes.

    A hole within a hub is the drawing of that joint, whose hole is the machine's.
    """
    for drive in layout.cycloid_drives:
        if drive.wish.link == link:
            return drive.contours()
    shape = layout.sizes.shape(link)
    if not shape.contours:
        return []
    if (
        link in layout.guides
        or layout.noses(link)
        or not layout.discs.keys().isdisjoint(layout.points_of(link))
    ):
        remedy = "leave it out: it is for a link that has pins, no rails, straps or faces"
        raise DesignError(f"parts.{link}.outline", 1, 0, "", f"link {link}", remedy)
    pose = layout.drawn_poses.get(link, layout.machine.start_of(link))
    turn = cmath.exp(-1j * pose.angle)
    shift = (complex(*shape.outline_at) - pose.place) * turn
    rings = [np.array(rows) for rows in shape.contours]
    contours = [bulged(rows[:, 0] + 1j * rows[:, 1], rows[:, 2]) for rows in rings]
    outer, *holes = (contour.moved(turn, shift) for contour in contours)
    hubs = layout.round_hubs(link)
    return [
        outer,
        *(
            hole
            for hole in holes
            if not any(
                abs(hole.centroid - z) < radius / 2 and abs(hole.area) < math.pi * radius**2
                for z, radius in hubs
            )
        ),
    ]


def link_outline(layout: Layout, link: str) -> Contour:
    """A link's edge."""
    if own := own_contours(layout, link):
        return own[0]
    if link in layout.guides:
        return layout.guides[link].outline
    arm = arm_band(layout, link)
    if arm is not None:
        return arm.outline()
    edge = hull(link_hubs(layout, link))
    for tip in layout.noses(link):
        bar = tip_bar(layout, tip)
        edge = edge if bar is None else with_bar(edge, *bar)
    return edge


def slot_holes(layout: Layout, link: str, points: Collection[str]) -> dict[str, Contour]:
    """Holes of a link's slots for the pins of these points."""
    ways = {point: ends for point, ends in layout.slots_of(link).items() if point in points}
    slots = (SlotHole(*ends, layout.slot_width(point) / 2, point) for point, ends in ways.items())
    return {f"slot {slot.name}": slot.contour for slot in one_by_one(slots, layout.min_wall)}
