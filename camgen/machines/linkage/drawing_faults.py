"""What is wrong between the tables that draw a linkage, all at once, each with its path and what would be right."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from camgen.errors import Fault, Key, SpecError
from camgen.machine.model import GROUND
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.drawing import Drawing
from camgen.machines.linkage.links import CLOSED, shape, too_long
from camgen.machines.pairs import air_faults, still_faults
from camgen.motion.polydyne import NEEDED, rough
from camgen.schemas import shortened
from camgen.spec import unknown
from camgen.tolerances import SAME_POINT

MOST_LINKS = 60  # they close together: the time grows with the cube of their number, 40 take a third of a minute

_TAKEN = {  # names of links whose files would have the names of others, or lie on their shelf
    "assembly": "the assembly",
    "drawing": "a dimensioned drawing",
    "timing": "the timing diagram",
}


def drawing_faults(drawing: Drawing) -> list[Fault]:
    """Names that are not there, points on no link, lengths between points of no link, links that nothing holds."""
    if not drawing.points:
        right = "the points of the drawing, such as O = [0, 0]"
        return [Fault(("points",), "an empty table", right)]
    faults = [
        *_link_faults(drawing),
        *_length_faults(drawing),
        *_joint_faults(drawing),
        *_output_faults(drawing),
    ]
    return faults or list(shape_faults(drawing, drawing.links))


def _link_faults(drawing: Drawing) -> Iterable[Fault]:
    if GROUND not in drawing.links:
        usual = ("ground", "frame", "base", "fixed")
        near = next((name for name in drawing.links if name.lower() in usual), None)
        right = "missing: the link that stands still, by its points"
        yield Fault(("links", "ground"), "", right, near)
    if len(drawing.links) > MOST_LINKS:
        right = f"at most {MOST_LINKS} links, because more would take many minutes: divide the machine, and join its parts with [[include]]"
        yield Fault(("links",), f"{len(drawing.links)} links", right)
    seen: dict[str, str] = {}
    for name in drawing.links:
        if seen.setdefault(name.lower(), name) != name:
            right = f"another name: {seen[name.lower()]} and this one differ only in capitals, and so would the names of their files"
            yield Fault(("links", name), "", right)
        if name.lower() in _TAKEN:
            right = f"another name: the files of its part would look like {_TAKEN[name.lower()]}"
            yield Fault(("links", name), "", right)
    yield from _point_faults(drawing)
    for name in drawing.links:
        if name != GROUND and not _meets_another(drawing, name):
            right = "nothing holds this link: let it share a point with another link, or slide"
            yield Fault(("links", name), "", right)


def _point_faults(drawing: Drawing) -> Iterable[Fault]:
    """Points that are not there, twice on a link, or on none."""
    for name, points in drawing.links.items():
        for k, point in enumerate(points):
            if point not in drawing.points:
                yield unknown(("links", name, k), point, drawing.points)
            if point in points[:k]:
                yield Fault(("links", name, k), repr(point), "each point of a link once")
    used = {point for points in drawing.links.values() for point in points}
    for point in drawing.points:
        if point not in used:
            yield Fault(
                ("points", point), "", "is on no link: put it on a link in [links], or remove it"
            )


def _meets_another(drawing: Drawing, name: str) -> bool:
    """Whether a link shares a point with another one, slides, or has part in a slot."""
    points = drawing.links[name]
    others = {point for other, points in drawing.links.items() if other != name for point in points}
    return (
        not others.isdisjoint(points)
        or any(slide.link == name for slide in drawing.slides)
        or any(slot.link == name or slot.pin in points for slot in drawing.slots)
    )


def _length_faults(drawing: Drawing) -> Iterable[Fault]:
    seen: dict[frozenset[str], str] = {}
    for key in drawing.lengths:
        path = ("lengths", key)
        names = t.pair(key)
        if names is None:
            right = [each for each in drawing.lengths if t.pair(each)]
            here = f"; here {shortened(', '.join(right))}" if right else ""
            yield Fault(path, "", f'two points of one link, such as "A-B"{here}', unknown=True)
            continue
        lost = [point for point in names if point not in drawing.points]
        if lost:
            said = f"there is no point {' and no '.join(lost)}; the points are {', '.join(drawing.points)}"
            yield Fault(path, "", said, unknown=True)
            continue
        pair = frozenset(names)
        a, b = names
        if a == b:
            yield Fault(path, "", "two different points")
        elif not any(pair.issubset(points) for points in drawing.links.values()):
            yield Fault(
                path,
                "",
                f"a length between two points of one link: no link has both {a} and {b}",
                unknown=True,
            )
        elif pair in seen:
            yield Fault(path, "", f"given twice: also as {seen[pair]}")
        seen[pair] = key


def _joint_faults(drawing: Drawing) -> Iterable[Fault]:
    yield from _drive_faults(drawing)
    kinds: tuple[tuple[str, Sequence[Any], Callable[..., Iterable[Fault]]], ...] = (
        ("slide", drawing.slides, _slide_faults),
        ("slot", drawing.slots, _slot_faults),
        ("gear", drawing.gears, _gear_faults),
        ("cam", drawing.cams, _cam_faults),
        ("geneva", drawing.genevas, _geneva_faults),
        ("noncircular", drawing.noncirculars, _noncircular_faults),
        ("mutilated", drawing.mutilated, shaft_faults),
        ("cycloid", drawing.cycloids, _cycloid_faults),
    )
    for kind, rows, faults in kinds:
        for k, row in enumerate(rows):
            yield from faults(drawing, (kind, k), row)
    for name in drawing.levels_of_joints():
        if name in drawing.links:
            right = "another name: a cam, a gear, a Geneva drive, a pair of wheels or a ratchet already has this one"
            yield Fault(("links", name), "", right)
    named = dict.fromkeys(drawing.names_of_drives(), "drive")
    for path, name in drawing.joints():
        if name in named:
            yield Fault(
                (*path, "name"),
                repr(name),
                f"a name of its own: {named[name]} already has this one",
            )
        named[name] = ".".join(map(str, path))


def _link_fault(drawing: Drawing, path: Key, name: str, moves: bool = True) -> list[Fault]:
    """What is wrong with the name of a link; moves: the ground is none such."""
    if name not in drawing.links:
        return [unknown(path, name, drawing.links)]
    if name != GROUND or not moves:
        return []
    still = "; no wheel is made that stands still while another runs round it"
    right = f"a link that moves{still if path[0] == 'gear' else ''}"
    return [Fault(path, repr(name), right)]


def _line_faults(drawing: Drawing, path: Key, name: str, line: tuple[str, str]) -> Iterable[Fault]:
    """What is wrong with two points of a link that say where something slides."""
    points = drawing.links[name]
    for k, point in enumerate(line):
        if point not in points:
            right = f"a point of link {name}: {', '.join(points)}"
            yield Fault((*path, k), repr(point), right)
    first, second = line
    if first == second:
        yield Fault(path, repr(first), "two different points")
    elif first in drawing.points and second in drawing.points:
        length = abs(drawing.at(first) - drawing.at(second))
        if length < SAME_POINT:
            right = f"two points that lie apart: its length is {length:.3g} mm"
            yield Fault(path, f"{first}, {second}", right)


def _drive_faults(drawing: Drawing) -> Iterable[Fault]:
    several = len(drawing.drives) > 1
    for k, drive in enumerate(drawing.drives):
        table: Key = ("drive", k) if several else ("drive",)
        slides = isinstance(drive, t.SlidingDrive)
        path = (*table, "slide" if slides else "link")
        wrong = _link_fault(drawing, path, drive.link)
        yield from wrong
        slide = drawing.slide_of(drive.link)
        if slides and not wrong and (slide is None or slide.on != GROUND):
            yield Fault(path, repr(drive.link), "a link that a [[slide]] holds on the ground")
        if not slides and not wrong and drawing.pivot(drive.link) is None:
            yield Fault(path, repr(drive.link), "a link that shares a point with the ground")
        span = drive.range_deg
        if span is not None and not span[0] < span[1]:
            yield Fault((*table, drive.range_key), str(list(span)), "the least before the greatest")
        yield from drive.faults(table)


def _slide_faults(drawing: Drawing, path: Key, slide: t.Slide) -> Iterable[Fault]:
    link = _link_fault(drawing, (*path, "link"), slide.link)
    guide = _link_fault(drawing, (*path, "on"), slide.on, moves=False)
    yield from (*link, *guide)
    if not link and not guide and slide.link == slide.on:
        yield Fault((*path, "on"), repr(slide.on), "another link")
    if not guide:
        yield from _line_faults(drawing, (*path, "along"), slide.on, slide.along)


def _slot_faults(drawing: Drawing, path: Key, slot: t.Slot) -> Iterable[Fault]:
    wrong = _link_fault(drawing, (*path, "link"), slot.link, moves=False)
    if wrong:
        yield from wrong
        return
    yield from _line_faults(drawing, (*path, "along"), slot.link, slot.along)
    pin = (*path, "pin")
    if slot.pin not in drawing.points:
        yield unknown(pin, slot.pin, drawing.points)
    elif drawing.carrier(slot) is None:
        yield Fault(pin, repr(slot.pin), f"a point of a link other than {slot.link}")
    elif slot.pin in drawing.links[slot.link]:
        right = f"no point of {slot.link} itself, which would pin it"
        yield Fault(pin, repr(slot.pin), right)


def _gear_faults(drawing: Drawing, path: Key, gear: t.Gear) -> Iterable[Fault]:
    wheels = {"a": gear.a, "b": gear.b}
    wrong = [
        fault for end, name in wheels.items() for fault in _link_fault(drawing, (*path, end), name)
    ]
    yield from wrong
    if not wrong:
        if gear.a == gear.b:
            yield Fault((*path, "b"), repr(gear.b), "another link")
        for end, name in wheels.items():
            if drawing.slide_of(name):
                right = f"a link that turns: {name} slides and cannot"
                yield Fault((*path, end), repr(name), right)
    if gear.ratio == 0:
        yield Fault((*path, "ratio"), "0", "a ratio other than 0")
    if gear.inner and not 0 <= gear.ratio < 1:
        right = "above 0 and below 1: inner = true makes b a ring, a the pinion in it"
        yield Fault((*path, "ratio"), f"{gear.ratio:g}", right)
    for key, value in {"shift_a": gear.shift_a, "shift_b": gear.shift_b}.items():
        if value is not None and gear.shift is not None:
            yield Fault((*path, key), f"{value:g}", 'nothing: shift = "balanced" finds both')


def shaft_faults(drawing: Drawing, path: Key, pair: t.Pair) -> Iterable[Fault]:
    """What is wrong with the links of wheels that turn on the ground."""
    for key, name in {"a": pair.a, "b": pair.b}.items():
        wrong = _link_fault(drawing, (*path, key), name)
        if not wrong and drawing.pivot(name) is None:
            right = "a link that shares a point with the ground: it turns there"
            wrong = [Fault((*path, key), repr(name), right)]
        yield from wrong
    if pair.a == pair.b:
        yield Fault((*path, "b"), repr(pair.b), "another link")


def _noncircular_faults(drawing: Drawing, path: Key, pair: t.Noncircular) -> Iterable[Fault]:
    yield from shaft_faults(drawing, path, pair)
    ways = {
        "eccentricity": pair.eccentricity is not None,
        "sines_deg": bool(pair.sines_deg or pair.cosines_deg),
        "points": pair.points is not None,
    }
    given = [key for key, there in ways.items() if there]
    if len(given) != 1:
        right = (
            "one of eccentricity, waves (sines_deg, cosines_deg) and points, which say how b turns"
        )
        yield Fault(path, " and ".join(given) or "none of them", right)
        return
    if pair.eccentricity is not None and pair.turns != 1:
        yield Fault((*path, "turns"), f"{pair.turns:g}", "1: equal ellipses turn alike")
    try:
        assert pair.law
    except SpecError as error:
        yield from (replace(fault, path=(*path, *fault.path)) for fault in error.faults)


def _geneva_faults(drawing: Drawing, path: Key, geneva: t.Geneva) -> Iterable[Fault]:
    yield from shaft_faults(drawing, path, geneva)
    if geneva.gap is not None and geneva.inner:
        right = "no value here beside inner = true: dowels hold both wheel and lock"
        yield Fault((*path, "gap"), f"{geneva.gap:g}", right)
    points = drawing.links.get(geneva.a, ())
    if points and (geneva.pin not in points or geneva.pin == drawing.pivot(geneva.a)):
        free = [point for point in points if point != drawing.pivot(geneva.a)]
        right = f"a point of {geneva.a} that is not on its shaft: {', '.join(free) or 'add one'}"
        yield Fault((*path, "pin"), repr(geneva.pin), right)
    for key in drawing.lengths:
        if {*(t.pair(key) or ())} == {geneva.pin, drawing.pivot(geneva.a) if points else None}:
            right = "left out: it follows from slots and the distance of both shafts"
            yield Fault(("lengths", key), "", right)


def _cycloid_faults(drawing: Drawing, path: Key, row: t.Cycloid) -> Iterable[Fault]:
    links = {"crank": row.crank, "disc": row.disc} | ({"output": row.output} if row.output else {})
    wrong = [
        fault for key, name in links.items() for fault in _link_fault(drawing, (*path, key), name)
    ]
    yield from wrong
    if len({*links.values()}) < len(links):
        yield Fault(path, ", ".join(links.values()), "links that differ")
    if row.output is None:
        keys = "output_radius", "output_pin_radius"
        given = (key for key in keys if getattr(row, key) is not None)
        yield from (
            Fault((*path, key), "", "no value here without the key output") for key in given
        )
    if wrong:
        return
    shaft = drawing.pivot(row.crank)
    if shaft is None:
        right = "a link that shares a point with the ground: it turns there"
        yield Fault((*path, "crank"), repr(row.crank), right)
        return
    points = [point for point in drawing.links[row.crank] if point != shaft]
    if row.at not in points:
        right = f"a point of {row.crank} that is not on its shaft: {', '.join(points) or 'add one'}"
        yield Fault((*path, "at"), repr(row.at), right)
    if [*drawing.links[row.disc]] != [row.at]:
        right = f'a link with the point of the eccentric alone: {row.disc} = ["{row.at}"]'
        yield Fault((*path, "disc"), repr(row.disc), right)
    if row.output is not None and drawing.pivot(row.output) != shaft:
        right = (
            f"a link with the point {shaft} of the ground: it turns about the shaft of {row.crank}"
        )
        yield Fault((*path, "output"), repr(row.output), right)


def _cam_faults(drawing: Drawing, path: Key, cam: t.Cam) -> list[Fault]:
    faults = _link_fault(drawing, (*path, "cam"), cam.cam)
    if not faults and drawing.carries_plate(cam):
        faults = [*_plate_faults(drawing, path, cam)]
    elif not faults and drawing.pivot(cam.cam) is None:
        right = "a link that shares a point with the ground: it turns there"
        if drawing.slide_of(cam.cam) is not None:
            right += f"; {_instead_of_a_plate(drawing, cam)}"
        faults = [Fault((*path, "cam"), repr(cam.cam), right)]
    follower = (*path, "follower")
    strange = _link_fault(drawing, follower, cam.follower)
    if not strange and cam.follower == cam.cam:
        right = "another link: a cam does not move itself"
        strange = [Fault(follower, repr(cam.follower), right)]
    if strange:
        return [*faults, *strange]
    slide = drawing.slide_of(cam.follower)
    if drawing.pivot(cam.follower) is None and (slide is None or slide.on != GROUND):
        right = "a link that is pinned to the ground or slides on it"
        faults.append(Fault(follower, repr(cam.follower), right))
    slides = slide is not None
    if not faults and not drawing.carries_plate(cam):
        faults += [
            Fault((*path, "segment", k, "span"), f"{row.span:g}", f"span_deg: {cam.cam} turns")
            for k, row in enumerate(cam.segment)
            if row.span is not None
        ]
    faults += [
        *_tip_faults(drawing, path, cam),
        *_follower_faults(drawing, path, cam, slides),
        *air_faults((*path, "tip_clearance"), cam.tip_clearance, cam.closure, cam.radius),
        *_segment_faults((*path, "segment"), cam, slides),
    ]
    if not faults:
        faults += _polydyne_faults(drawing, path, cam) if cam.polydyne else []
        try:
            drawing.written_program(cam, path)
        except SpecError as error:
            faults += error.faults
    return faults


# of a segment, over a way without a use
_UNUSED = (
    "span_deg",
    "at_deg",
    "task",
    "inflection",
    "constant_velocity",
    "end_velocity",
    "end_acceleration",
    "end_jerk",
)


def _plate_faults(drawing: Drawing, path: Key, cam: t.Cam) -> Iterable[Fault]:
    """Of a cam that is a plate."""
    other = 'mechanism = "linear-cam" has a knife edge' if cam.shape == "knife" else "no flat face"
    if cam.shape != "roller":
        yield Fault((*path, "shape"), repr(cam.shape), f'"roller" on a plate that slides: {other}')
    if cam.spring is not None:
        right = "no table here: on a plate that slides use a [[spring]] between two pins"
        yield Fault((*path, "spring"), "", right)
    if cam.closure != "force":
        right = (
            '"force" on a plate that slides; for both senses a [[slot]] holds a pin of the follower'
        )
        yield Fault((*path, "closure"), repr(cam.closure), right)
    if cam.base_radius is not None:
        right = "no value here: a plate's edge lies where its follower is drawn"
        yield Fault((*path, "base_radius"), f"{cam.base_radius}", right)
    if cam.polydyne:
        yield Fault((*path, "polydyne"), "true", "false on a plate that slides")
    spans = [row.span for row in cam.segment if row.span is not None]
    for k, row in enumerate(cam.segment):
        for key in _UNUSED:
            field = type(row).model_fields[key]
            if key in row.model_fields_set and getattr(row, key) is not None:
                right = "no value here: a segment of a plate has span, in mm, and a law"
                yield Fault((*path, "segment", k, field.alias or key), "", right)
        if row.span is None:
            yield Fault((*path, "segment", k, "span"), "", "missing: mm of the plate's travel")
    low, high = drawing.drive.range_deg or (0.0, 0.0)
    length = math.fsum(spans)
    if len(spans) == len(cam.segment) and (low < 0 or high > length + SAME_POINT):
        right = f"within 0 and {length:g}, the travel of the segments of cam {cam.joint}, which begin as drawn"
        yield Fault(("drive", "range"), f"[{low:g}, {high:g}]", right)


def _instead_of_a_plate(drawing: Drawing, cam: t.Cam) -> str:
    """What makes the plate that was meant, and what moves its follower, with the numbers of this drawing."""
    straight = f"a straight track of {cam.cam} is a [[slot]] for the pin {cam.at}"
    drives = f'with [drive] slide = "{cam.cam}" it is a plate whose edge is made'
    other = f'{drives}; {straight}; any other edge is made by mechanism = "linear-cam"'
    slide = drawing.slide_of(cam.cam)
    hinge = drawing.pivot(cam.follower) if cam.follower in drawing.links else None
    names = [*(slide.along if slide else ()), hinge or "", cam.at]
    if not drawing.points.keys() >= {*names}:
        return other
    start, end, axle, tip = map(drawing.at, names)
    if min(abs(end - start), abs(tip - axle)) < SAME_POINT:
        return other
    way = (end - start) / abs(end - start)
    up = math.copysign(1, ((tip - start) / way).imag)  # the follower's side of the plate
    arm = (tip - axle) / way
    angle = math.degrees(math.atan2(up * arm.imag, abs(arm.real)))
    return (
        f'{other} with geometry.follower = {{ motion = "oscillating", arm = {abs(arm):.4g}, '
        f"start_deg = {angle:.4g} }}; what {cam.follower} moves is a linkage without {cam.cam}, "
        f'in which [drive] link = "{cam.follower}" runs its lifts as [[drive.segment]]'
    )


def _tip_faults(drawing: Drawing, path: Key, cam: t.Cam) -> Iterable[Fault]:
    """Of what touches a cam."""
    points = drawing.links[cam.follower]
    if cam.at not in points:
        right = f"a point of {cam.follower}: {', '.join(points)}"
        yield Fault((*path, "at"), repr(cam.at), right)
    rolls = cam.shape == "roller"
    if rolls != (cam.radius is not None):
        right = (
            "missing: the roller's radius" if rolls else f"no value here: a {cam.shape} has none"
        )
        yield Fault((*path, "radius"), "", right)
    if cam.face_width is not None and cam.shape != "flat":
        right = f"no value here: a {cam.shape} has no face"
        yield Fault((*path, "face_width"), f"{cam.face_width:g}", right)


def _segment_faults(path: Key, cam: t.Cam, slides: bool) -> Iterable[Fault]:
    """Of the segments of a cam's program."""
    keys = {"lift": "lift_deg", "to": "to_deg"}
    if slides:
        keys = {angle: way for way, angle in keys.items()}
    moves = "slides" if slides else "swings"
    for k, segment in enumerate(cam.segment):
        for key, other in keys.items():
            if getattr(segment, key) is not None:
                yield Fault((*path, k, key), "", f"{other}: {cam.follower} {moves}")
    yield from still_faults(path, [segment.kind for segment in cam.segment])


def _follower_faults(drawing: Drawing, path: Key, cam: t.Cam, slides: bool) -> Iterable[Fault]:
    """Of what holds and loads a follower."""
    if cam.face_offset and (slides or cam.shape != "flat"):
        right = "no value here: only the flat face of a follower that swings has it"
        yield Fault((*path, "face_offset"), f"{cam.face_offset:g}", right)
    if cam.spring is None:
        return
    if cam.closure != "force":
        right = 'no table here: only closure "force" has a spring'
        yield Fault((*path, "spring"), "", right)
    _, post, hook = drawing.returns[cam.joint]
    for name in [post] if cam.shape == "roller" else [post, hook]:
        if name in drawing.points or name in drawing.links:
            right = "another name: the return spring of a cam already has this one"
            yield Fault(("points", name), "", right)


def _polydyne_faults(drawing: Drawing, path: Key, cam: t.Cam) -> Iterable[Fault]:
    """What a correction for the follower's elasticity lacks."""
    if drawing.stiffness is None:
        right = "missing: a cam with polydyne corrects for it"
        yield Fault(("load", "stiffness"), "", right)
    known = all(point in drawing.points for point in drawing.links[cam.follower])
    if known and not drawing.inertia_of(cam):
        right = f"mass_g of what slides, or inertia_kg_m2 of what swings: what moves behind the stiffness of cam {cam.joint}"
        yield Fault(("masses", cam.follower), "", right)
    if cam.spring is not None and not cam.spring.rate:
        right = "above 0 with polydyne: it corrects for the spring, which otherwise follows from the cam"
        yield Fault((*path, "spring", "rate"), "0", right)
    polydyne = (*path, "polydyne")
    if drawing.turns_of(cam.cam) is None or drawing.drive.segments or drawing.drive.range_deg:
        right = "false: a corrected cam turns evenly, with the drive or by gears"
        yield Fault(polydyne, "true", right)
    if not drawing.moves_alone(cam.follower):
        right = (
            f"false: more than {cam.follower} moves with this cam, so its inertia is not constant"
        )
        yield Fault(polydyne, "true", right)
    try:
        segments = drawing.written_program(cam, path).segments
    except SpecError:  # said of the program
        return
    for k in rough(segments):
        yield Fault((*path, "segment", k, "law"), repr(segments[k].law.name), NEEDED)


def _output_faults(drawing: Drawing) -> Iterable[Fault]:
    for k, output in enumerate(drawing.outputs):
        if sum(each is not None for each in (output.point, output.link, output.thread)) != 1:
            yield Fault(("output", k), output.name, "either a point, a link or a thread")
        elif output.point is not None and output.point not in drawing.points:
            yield unknown(("output", k, "point"), output.point, drawing.points)
        elif output.link is not None and output.link not in drawing.links:
            yield unknown(("output", k, "link"), output.link, drawing.links)
        elif output.link == GROUND:
            yield Fault(("output", k, "link"), repr(GROUND), "a link that moves")
        yield from _thread_faults(drawing, ("output", k, "thread"), output.thread or ())
        if output.name in [other.name for other in drawing.outputs[:k]]:
            yield Fault(("output", k, "name"), repr(output.name), "a name of its own")
        yield from _target_faults(drawing, ("output", k), output)
    moving = [link for link in drawing.links if link != GROUND]
    for name in drawing.masses:
        if name not in moving:
            yield unknown(("masses", name), name, moving)


def _thread_faults(drawing: Drawing, path: Key, thread: Sequence[str]) -> Iterable[Fault]:
    """Points that are not there, that no post can stand at, and a thread whose length never changes."""
    for k, point in enumerate(thread):
        links = [name for name, points in drawing.links.items() if point in points]
        if point not in drawing.points:
            yield unknown((*path, k), point, drawing.points)
        elif len(links) > 1:
            right = f"a point of one link alone: {point} is a pin of {' and '.join(links)}"
            yield Fault((*path, k), repr(point), right)
        elif k and point == thread[k - 1]:
            yield Fault((*path, k), repr(point), "another point than the one before it")
    for link, points in drawing.links.items():
        if thread and {*thread} <= {*points}:
            right = f"points of two links: between those of {link} its length stays"
            yield Fault(path, ", ".join(thread), right)


def _target_faults(drawing: Drawing, path: Key, output: t.Wanted) -> Iterable[Fault]:
    keys: tuple[str, ...] = ("points", "path", "lines", "straightness")
    right = "no value here: only the path of a point has this target"
    if output.point is not None:
        keys = ("dwell", "time_ratio", "function")
        right = "no value here: only a link or a thread has this target, not a path"
    for key in keys:
        if getattr(output, key):
            yield Fault((*path, key), "", right)
    if output.points is not None:
        yield from output.points.faults((*path, "points"))
    if output.lines is not None:
        yield from output.lines.faults((*path, "lines"))
        lifts = [other.name for other in drawing.outputs if other.point is None]
        if output.lines.lift not in lifts:
            right = f"the name of an output that lifts the pen: of a link or a thread{': ' if lifts else ''}{', '.join(lifts)}"
            yield Fault((*path, "lines", "lift"), repr(output.lines.lift), right)
    if output.straightness is not None:
        yield from output.straightness.faults((*path, "straightness"))
    if drawing.drive.range_deg is None:
        return
    if output.time_ratio is not None:
        right = "no value here: this target needs a drive that turns all the way round"
        yield Fault((*path, "time_ratio"), "", right)
    low, high = drawing.drive.range_deg
    right = f"within drive.{drawing.drive.range_key}, {low:g} to {high:g} {drawing.drive.unit}"
    demands = {
        ("points", "theta_deg"): output.points and output.points.theta_deg,
        ("function", "at"): output.function and [pair[0] for pair in output.function.at],
        ("straightness", "range_deg"): output.straightness and output.straightness.range_deg,
    }
    for where, angles in demands.items():
        if angles and not low <= min(angles) <= max(angles) <= high:
            yield Fault((*path, *where), str(list(angles)), right)


def shape_faults(drawing: Drawing, links: Mapping[str, Sequence[str]]) -> Iterable[Fault]:
    """Those of these links whose lengths contradict each other, or do not say which way."""
    for name, points in links.items():
        lengths = drawing.lengths_of(points)
        drawn = drawing.drawn(points)
        same = [pair for pair in lengths if abs(drawn[pair[0]] - drawn[pair[1]]) < SAME_POINT]
        if same:
            a, b = (points[k] for k in same[0])
            right = f"two places: the drawing gives the direction from one to the other, lengths.{a}-{b} the distance"
            yield Fault(("links", name), f"{a} and {b} are drawn at one place", right)
            continue
        missed = shape(drawn, lengths)[1]
        if missed <= 1e3 * CLOSED * max(lengths.values(), default=1.0):
            continue
        if found := too_long(points, drawn, lengths):
            side, words, right = found
            ends = {points[k] for k in side}
            key = next((key for key in drawing.lengths if set(t.pair(key) or ()) == ends), None)
            path = ("lengths", key) if key else ("links", name)
            yield Fault(path, f"{drawing.lengths[key]:.6g}" if key else words, right)
            continue
        given = (f"{points[a]}-{points[b]} = {length:g}" for (a, b), length in lengths.items())
        right = (
            f"lengths that can meet: they miss by {missed:.3g} mm (a side of a triangle is at most the sum of "
            "the others; where no length is given the drawn distance counts)"
        )
        yield Fault(("links", name), ", ".join(given), right)
