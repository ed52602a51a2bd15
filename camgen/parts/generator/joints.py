"""What the joints of a linkage of parts are measured on: holes, slots, rails, outlines and pins, by the parts that have them."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from camgen.machine import model as m
from camgen.machine.cams.machine import nominal_cam
from camgen.machine.features import (
    CamOutline,
    Edge,
    EngagedPair,
    Eye,
    Faces,
    Feature,
    Flat,
    GearTeeth,
    Mark,
    Mount,
    NominalCam,
    PawlPair,
    PinEyes,
    PinTracks,
    Ring,
    SharedFlat,
    SlotFaces,
    Steady,
)
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.cycloids import CycloidDrive, Stud
from camgen.parts.generator.discs import eccentric_name
from camgen.parts.generator.dowels import stud_hole
from camgen.parts.generator.genevas import GenevaDrive
from camgen.parts.generator.layout import Layout, pivot_name
from camgen.parts.generator.mutilated import MutilatedDrive
from camgen.parts.generator.noncircular import NoncircularDrive
from camgen.parts.generator.pins import bearing_name
from camgen.parts.generator.plates import SECOND
from camgen.parts.generator.ratchets import RatchetDrive
from camgen.parts.generator.second_plate import far_hole
from camgen.parts.generator.stubs import in_upper
from camgen.parts.generator.wheels import EdgeDrive, PlateTip, Tip, pivot


def part_name(link: str) -> str:
    """Name of a link's part: such that its files are not taken for plates and lists, or for those of its shaft."""
    taken = link.lower().startswith(("plate", "parts")) or link.lower() in (
        "shaft",
        "collar",
        "shaft-collar",
    )
    return f"link-{link}" if taken else link


def point_of(layout: Layout, joint: m.Joint) -> tuple[str, str, str]:
    """The point of a pin or slot, and its two links, a slot's last."""
    if isinstance(joint, m.Slot):
        point = next(name for name, slot in layout.slots.items() if slot == joint)
        return point, layout.web_at(joint.runner.body, point), joint.guide.body
    assert isinstance(joint, m.Pin)
    places = layout.machine.body(joint.a.body).points
    here = [name for name, z in places.items() if z == joint.a.at]
    links = (map(layout.carrier, layout.pivots.get(name, ())) for name in here)
    point = next(name for name, on in zip(here, links, strict=True) if joint.b.body in on)
    return point, layout.web_at(joint.a.body, point), layout.web_at(joint.b.body, point)


def part_of(layout: Layout, link: str) -> str:
    """Name of the part that a link is; of one that is a wheel alone, that wheel's."""
    level = layout.alone.get(link)
    parts = {tip.level: f"cam-{tip.name}{'-inner' * tip.grooved}" for tip in layout.tips}
    parts |= {each.level: each.part for each in layout.gear_wheels if each.link == link}
    parts |= {each.level: each.part_on(link) for each in layout.edge_drives if link in each.links}
    return part_name(link) if level is None else parts[level]


def _eye(layout: Layout, point: str, link: str, beside: str = "") -> Eye:
    """A link's hole at a point; of the ground the one in the plate that holds the other link's pin, or is nearer to it."""
    if link == GROUND and beside and in_upper(layout, point, beside):
        return Eye(SECOND, layout.at(GROUND, point), far_hole(layout, point))
    for about, (on, shaft) in layout.discs.items():
        if link == on == GROUND and point in (about, shaft):
            at = layout.at(GROUND, point) - layout.at(GROUND, about)
            return Eye(pivot_name(about), at, layout.hole(point, GROUND), shaft=point == about)
    disc = point in layout.discs and link == layout.pressed_in(point)
    if disc and point in layout.eccentrics:
        at = layout.at(link, point) - layout.at(link, layout.discs[point][1])
        return Eye(eccentric_name(layout, point), at, layout.hole(point, link), shaft=True)
    return Eye(part_of(layout, link), layout.at(link, point), layout.hole(point, link), shaft=disc)


def features_of(layout: Layout, pins: Sequence[Mount]) -> Sequence[Feature]:
    """Holes, slots, rails, outlines and pins of every joint, and pens; pins: copies of all pins and shafts."""
    found: list[Feature] = []
    for joint in layout.machine.joints:
        if isinstance(joint, m.Slide):
            guide = layout.guides[joint.runner.body]
            names = part_name(joint.guide.body), part_name(joint.runner.body)
            found.append(guide.faces(*names, layout.fits.slide_clearance))
        elif isinstance(joint, m.Pin | m.Slot):
            point, a, b = point_of(layout, joint)
            fixed = layout.pressed_in(point)
            if layout.on_motor(point, GROUND):
                # its boss in the plate, its shaft in the link: the mean counts twice
                pin = Eye(None, 0j, (layout.sizes.face.boss + layout.turning(point)) / 2, True)  # type: ignore[union-attr]
            elif point in layout.discs:  # a part of its link
                found.append(PinEyes(joint.name, _eye(layout, point, a), _eye(layout, point, b)))
                continue
            else:
                part = _pin_of(layout, pins, point, fixed, b if a == fixed else a)
                pin = Eye(part, 0j, layout.turning(point), True)
            if isinstance(joint, m.Slot):
                middle = sum(layout.slots_of(b)[point]) / 2
                part = SECOND if b == GROUND and layout.in_second(point) else part_name(b)
                walls = Faces(part, middle, joint.angle, layout.hole(point, b))
                found.append(SlotFaces(joint.name, walls, _eye(layout, point, a), pin))
            else:
                bearings = (layout.bearing_in(point, link) for link in (a, b))
                rings = tuple(
                    Ring(bearing_name(each), each.bore, each.outside) for each in bearings if each
                )
                eyes = (_eye(layout, point, a, b), _eye(layout, point, b, a))
                found.append(PinEyes(joint.name, *eyes, pin, rings))
    for each in layout.gear_pairs:
        on = each.joint.carrier
        turns = (axle_of(layout, each.a.link, on), axle_of(layout, each.b.link, on))
        both = each.a.teeth(each.mesh), each.b.teeth(each.mesh)
        implied = each.joint if each.implied else None
        angle = each.mesh.working_angle
        found.append(GearTeeth(each.joint.name, *both, turns, angle, implied))
    found += [_JUDGED[type(drive)](layout, drive) for drive in layout.edge_drives]
    found += [pair for drive in layout.cycloid_drives for pair in _cycloid(layout, drive)]
    found += [outline for tip in layout.tips for outline in _outlines(layout, tip)]
    found += [_plate_outline(layout, plate) for plate in layout.plates]
    found += [*_keyed(layout), *_steady(layout, pins)]
    marks = (*layout.pens.items(), *layout.thread_posts.items())
    return [*found, *(Mark(_eye(layout, point, link)) for point, link in marks)]


def _pin_of(layout: Layout, pins: Sequence[Mount], point: str, link: str, beside: str) -> str:
    """The part that is the pin or shaft of a point, fixed in a link, on which another one turns."""
    place = (layout.carrier(link), layout.at(link, point))
    here = [each for each in pins if (each.body, each.at) == place]
    floor = layout.floor(layout.level[beside])
    below = (each for each in here if each.z <= floor)
    return max(below, key=lambda each: each.z, default=here[0]).part


def _keyed(layout: Layout) -> Iterator[SharedFlat]:
    """Webs on one crank pin, eccentrics on one shaft."""
    for point in layout.eccentrics:
        link, shaft = layout.discs[point]
        bore = _eye(layout, shaft, link)
        other = Eye(eccentric_name(layout, point), 0j, bore.diameter)
        yield SharedFlat(bore, other, math.pi / 2)
    for (low, held), (high, _) in pairwise(layout.webs.items()):
        yield SharedFlat(_eye(layout, held[1], low), _eye(layout, held[1], high), math.pi / 2)


def _steady(layout: Layout, pins: Sequence[Mount]) -> Iterator[Steady]:
    """Pins and shafts that the second plate holds too."""
    for point in layout.points_of(GROUND):
        if not layout.in_second(point):
            continue
        far = Eye(SECOND, layout.at(GROUND, point), far_hole(layout, point))
        hangs = layout.split_level(point) is not None
        if hangs and point not in layout.shafts:
            continue  # it is the joints' own
        joints = [
            each.name
            for each in layout.machine.joints
            if isinstance(each, m.Pin)
            and point_of(layout, each)[0] == point
            and GROUND in (each.a.body, each.b.body)
        ]
        if not joints:
            continue  # a spring's eye sits there
        ends = None
        if hangs:
            web = layout.upper_web
            part = f"shaft-{web}"
            ends = (_eye(layout, point, layout.driven), _eye(layout, point, web))
        else:
            part = _pin_of(layout, pins, point, layout.pressed_in(point), GROUND)
        pin = Eye(part, 0j, layout.turning(point), True)
        yield Steady(joints[0], _eye(layout, point, GROUND), far, pin, ends)


def pivot_of(layout: Layout, link: str) -> str:
    """Name of the pin on which a link turns on the ground."""
    joints = layout.machine.joints
    return next(
        each.name
        for each in joints
        if isinstance(each, m.Pin) and {each.a.body, each.b.body} == {GROUND, link}
    )


def axle_of(layout: Layout, link: str, carrier: str) -> str:
    """Name of the pin on which a link turns on what carries it; where they share none on the ground."""
    joints = [each for each in layout.machine.joints if isinstance(each, m.Pin)]
    pins = {frozenset((each.a.body, each.b.body)): each.name for each in joints}
    return pins.get(frozenset((link, carrier))) or pivot_of(layout, link)


def _tip(layout: Layout, tip: Tip) -> Eye | Flat:
    """What of the follower touches: a roller's seat, an edge, a face."""
    link = tip.joint.follower
    if tip.rolls:
        return _eye(layout, tip.point, link)
    at = layout.at(link, tip.point)
    if tip.shape == "knife":
        return Eye(part_name(link), at, 0.0)
    low, high = tip.face()
    away = tip.away(float(layout.machine.start_of(link).angle))
    origin = at if tip.joint.slide is not None else pivot(layout.machine, link)[0]
    middle = origin + (low + high) / 2 * 1j * away
    return Flat(part_name(link), middle, cmath.phase(-away), high - low)


def _outlines(layout: Layout, tip: Tip) -> Iterator[CamOutline]:
    """What a roller runs on, first what drives; the hole of its pin is what holds it."""
    joint = tip.joint
    name = f"cam-{tip.name}"
    driving = CamOutline(
        joint.name,
        f"{name}-inner" if tip.grooved else name,
        pivot_of(layout, joint.cam),
        pivot_of(layout, joint.follower) if joint.slide is None else None,
        _tip(layout, tip),
        tip.radius if tip.rolls else None,
        tip.leaves,
        free=tip.cam.air,
        roller=tip.roller.part if tip.rolls else None,
        nominal=nominal_cam(tip.cam, tip.ridden.limits),
    )
    yield driving
    if tip.grooved:
        wall = nominal_cam(tip.cam, tip.ridden.limits, outer=True)
        free = layout.fits.slide_clearance
        yield replace(driving, part=f"{name}-outer", inside=True, free=free, nominal=wall)


def _plate_outline(layout: Layout, plate: PlateTip) -> CamOutline:
    """What a roller runs on along a plate that slides; the hole of its pin is what holds it."""
    joint = plate.joint
    assert joint.over is not None
    limits = plate.ridden.limits
    arm = 1.0 if joint.slide is not None else abs(plate.cam.follower.velocity(0.0, 0).item())
    lever = arm * math.cos(math.radians(plate.cam.steepest))
    return CamOutline(
        joint.name,
        part_name(joint.cam),
        joint.over,
        pivot_of(layout, joint.follower) if joint.slide is None else None,
        _eye(layout, plate.point, joint.follower),
        plate.roller.radius,
        1 if plate.cam.follower.leaves > 0 else -1,
        roller=plate.roller.part,
        way=plate.way,
        nominal=NominalCam(None, lever, limits.ripple, limits.undercut),
    )


def _cycloid(layout: Layout, drive: CycloidDrive) -> Iterator[EngagedPair]:
    """What a cycloidal drive is judged on: pins of the ground round the disc, holes of the disc round those of the output."""
    wish = drive.wish
    part = part_name(wish.link)
    bore = _eye(layout, wish.at, wish.link)
    rides = axle_of(layout, wish.link, wish.crank)
    lobes = wish.disc.lobes
    yield EngagedPair(
        wish.joint,
        tuple(_stud_edge(layout, stud) for stud in drive.pins),
        (Edge(part, bore),),
        pivot_of(layout, wish.crank),
        rides,
        wish.disc.least_gap,
        ((0.0, math.tau),),
        math.tau * lobes,
        wish.crank,
        (0.0, 1.0),
        PinTracks("a", lobes, wish.disc.gap, *wish.disc.hardest),
    )
    if wish.output is not None and drive.output is not None:
        yield EngagedPair(
            wish.output_joint,
            tuple(Edge(part, bore, hole=z) for z in drive.hole_places),
            tuple(_stud_edge(layout, stud) for stud in drive.output_pins),
            rides,
            pivot_of(layout, wish.output),
            wish.air,
            ((0.0, math.tau),),
            math.tau,
            wish.crank,
            (1.0, -float(lobes)),
            PinTracks("b", 0, wish.output_gap, *drive.output.hardest),
            None if wish.opposite is None else wish.output_law(layout.machine.start),
        )


def _stud_edge(layout: Layout, stud: Stud) -> Edge:
    """A pin's rim, in its hole of its link."""
    seat = Eye(part_name(stud.link), stud.at, stud_hole(layout, stud))
    return Edge(stud.part, Eye(stud.part, 0j, 2 * stud.radius, shaft=True), seat)


def _geneva(layout: Layout, drive: GenevaDrive) -> EngagedPair:
    """What a Geneva drive is judged on."""
    hole = layout.turning(drive.wish.point) + layout.fits.running_clearance
    geneva = drive.geneva
    parts = [drive.part_on(link) for link in drive.links]
    lock, slotted = (_edge(layout, part) for part in parts)
    if drive.inner:  # both about the middle of their drawings: they have no bore
        lock, slotted = (Edge(part, Eye(part, 0j, 0.0)) for part in parts)
        slotted = replace(slotted, hole=0j)
    seat = _eye(layout, drive.wish.point, drive.joint.cam)
    return EngagedPair(
        drive.joint.name,
        (
            lock,
            Edge(drive.roller.part, Eye(drive.roller.part, 0j, hole), seat),
        ),
        (slotted,),
        pivot_of(layout, drive.joint.cam),
        pivot_of(layout, drive.joint.follower),
        geneva.slot_air,
        geneva.held,
        math.tau * geneva.stations,
    )


def _noncircular(layout: Layout, drive: NoncircularDrive) -> EngagedPair:
    """What a pair of wheels that are not round is judged on."""
    pair = drive.pair
    period = math.tau * pair.turns
    return EngagedPair(*_both_edges(layout, drive), pair.air, ((0.0, math.tau),), period)


def _mutilated(layout: Layout, drive: MutilatedDrive) -> EngagedPair:
    """What mutilated gears are judged on."""
    law = drive.law
    period = math.tau * law.pair.stations
    edges = _both_edges(layout, drive)
    return EngagedPair(*edges, law.pair.free, law.held, period, pushed=(law.drives,))


def _ratchet(layout: Layout, drive: RatchetDrive) -> PawlPair:
    """What a ratchet is judged on."""
    pawl = drive.pawl
    return PawlPair(
        *_both_edges(layout, drive),
        passes=drive.wish.law.way,
        teeth=pawl.wheel.teeth,
        first=drive.first_tip(layout.machine),
        end=pawl.end,
        lost=pawl.dropping,
        friction=drive.wish.friction,
    )


# what a pair that drives by its edge is judged on
_JUDGED: Mapping[type[EdgeDrive], Callable[[Layout, Any], Feature]] = {
    GenevaDrive: _geneva,
    NoncircularDrive: _noncircular,
    MutilatedDrive: _mutilated,
    RatchetDrive: _ratchet,
}


def _both_edges(layout: Layout, drive: EdgeDrive) -> tuple[str, tuple[Edge], tuple[Edge], str, str]:
    """The joint of a drive, the edges of both its parts, and the pins on which they turn."""
    a, b = (_edge(layout, drive.part_on(link)) for link in drive.links)
    turns, swings = (pivot_of(layout, link) for link in drive.links)
    return drive.joint.name, (a,), (b,), turns, swings


def _edge(layout: Layout, part: str) -> Edge:
    """The edge of a wheel on a shaft."""
    shaft = layout.sizes.shaft_diameter + layout.fits.press_clearance
    return Edge(part, Eye(part, 0j, shaft))
