"""What is bought and is no part, as simple solids where it stands: screws with their nuts, keys, springs, motors.

Nothing says where a screw goes but the parts. Its column is all clearance holes of its thread on one axis, with the core hole
that they lead to; a screw from behind has a core hole alone. Where a machine has another number of such columns than screws are
bought, camgen knows no place for them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from camgen.machine.features import heights
from camgen.machines.mechanism import Mechanism
from camgen.numerics import coordinates
from camgen.parts.assembly import Assembly, plate_of
from camgen.parts.catalogue import (
    CAM_FOLLOWERS,
    CORE_HOLES,
    FOLLOWER_NUT,
    FOLLOWER_WASHER,
    HEX_KEYS,
    MOTOR_FACES,
    NUT_STANDARD,
    ROLLER_STANDARD,
    SCREWS,
    WASHERS,
    Bought,
    CamFollower,
    MotorFace,
    Screw,
)
from camgen.parts.coils import spring_sketches
from camgen.parts.keyways import key_length, keyed, parallel_keys, shaft_keyway
from camgen.parts.part import Tap
from camgen.parts.set_screws import ON_KEY_STANDARD
from camgen.parts.shafts import OF_SHAFT
from camgen.parts.standing import Round, StandingCopy, discs, standing_copies
from camgen.tolerances import SAME_POINT

_ALIKE = 0.35  # mm, by which a printed hole may differ from that of its thread
_ON_CIRCLE = 0.01  # mm, by which a motor's screw may miss its circle
_SOCKET = 0.5  # of a head's height, how deep its hexagon is
_POCKET = 1.5  # heights of a nut, at most, between holes that hold one
_RING = 0.13  # of a shaft's diameter, how broad a retaining ring is
_NUT = 0.8  # of a stud's diameter, how high its nut is drawn
_FLATS = 1.65  # and how broad
_BEFORE_END = 1.0  # mm, how far before the stud's end
_WIRE = 0.1  # of a spring's diameter, as its wire is drawn

Piece = tuple[Any, float, float]  # a polygon of shapely, from where to where it reaches, mm
Thing = Sequence[Piece]  # one screw, key, spring or motor


@dataclass(frozen=True)
class _Column:
    """Where a screw goes."""

    at: complex
    holes: Sequence[Round]  # of its clearance, from the lowest up
    cores: Sequence[Round]
    parts: frozenset[str]  # with these holes
    sunk_below: bool  # whether a pocket for its head is under the lowest hole

    @property
    def up(self) -> bool:
        """Whether its head is below."""
        if self.cores:
            return not self.holes or self.cores[0].high > self.holes[-1].high
        return self.sunk_below


def bought_shapes(mechanism: Mechanism, things: Sequence[Bought]) -> dict[Bought, list[Thing]]:
    """Of each thing, the solids of all its copies at theta = 0; nothing of those that have no known place."""
    assembly = mechanism.assembly
    poses = assembly.poses(np.zeros(1))
    copies = [
        copy
        for copy in standing_copies(assembly.parts, assembly.mounts, poses)
        if not (copy.pose.standing or copy.pose.upright)
    ]
    found = _screws(assembly, things, copies)
    for thing in things:
        if not thing.thread:
            found[thing] = _others(assembly, thing, copies)
    named = mechanism.load.cam_follower if mechanism.load else None
    found |= _on_shaft(assembly, things, CAM_FOLLOWERS.get(named or ""))
    springs = [thing for thing in things if thing.role == "spring"]
    if len(springs) == len(assembly.coils):
        lines = spring_sketches(assembly.coils, assembly.courses)
        for thing, coil, sketch in zip(springs, assembly.coils, lines, strict=True):
            found[thing] = [[_spring(sketch.course, coil.diameter, coil.eyes)]]
    return {thing: shapes for thing, shapes in found.items() if shapes}


def is_drawn_short(assembly: Assembly, thing: Bought) -> bool:
    """Whether a thing is a motor of a frame that says nothing of its length."""
    face = MOTOR_FACES.get(assembly.motor.frame)
    return thing.role == "drive" and face is not None and not face.length


def _others(assembly: Assembly, thing: Bought, copies: Sequence[StandingCopy]) -> list[Thing]:
    """Keys, screws on them, and motors."""
    if thing.role == "drive":
        return list(_motors(assembly, copies))
    if thing.standard == ON_KEY_STANDARD:
        taps: list[Thing] = [[_in_thread(copy, copy.part.tap)] for copy in copies if copy.part.tap]
        return taps if len(taps) == thing.count else []
    own = {name for name, _ in thing.at} or assembly.by_name.keys()
    keys = [key.size for key in parallel_keys(assembly.parts, assembly.one_key)]
    if thing.size not in keys:
        return []
    if assembly.one_key:
        return [[_one_key(copies, [each for copy in copies for each in _keys(copy)])]]
    return [[each] for copy in copies if copy.part.name in own for each in _keys(copy)]


# ---- screws ----------------------------------------------------------------------------------------------------------


def _screws(
    assembly: Assembly, things: Sequence[Bought], copies: Sequence[StandingCopy]
) -> dict[Bought, list[Thing]]:
    """Screws of all kinds, those of a motor first, then those that say with which parts they come; and their nuts."""
    found = dict[Bought, list[Thing]]()
    used = set[tuple[complex, bool]]()
    screws = [each for each in things if each.thread and each.standard != NUT_STANDARD]
    nuts = [each for each in things if each.thread and each.standard == NUT_STANDARD]
    for thing in sorted(screws, key=lambda each: (each.role != "drive screw", not each.at)):
        screw = SCREWS[thing.thread].headed(thing.standard)
        columns = [
            column
            for column in _columns(copies, screw)
            if (column.at, column.up) not in used and _fits(assembly, thing, column)
        ]
        if len(columns) != thing.count:
            continue
        used |= {(column.at, column.up) for column in columns}
        found[thing] = [_screw(screw, thing, column) for column in columns]
        for own in nuts:
            if not (set(thing.at) <= set(own.at) if thing.at else own.role == thing.role != ""):
                continue
            found.setdefault(own, []).extend(
                [_nut(screw, column)] for column in columns if column.holes
            )
    return found


def _columns(copies: Sequence[StandingCopy], screw: Screw) -> Iterator[_Column]:
    """Where screws of a thread can go."""
    holes = [(hole, copy.part.name) for copy in copies for hole in copy.holes]
    core = CORE_HOLES[screw.thread]
    alike = [
        (hole, name)
        for hole, name in holes
        if abs(hole.diameter - screw.clearance) < _ALIKE or abs(hole.diameter - core) < _ALIKE
    ]
    while alike:
        first = alike[0][0]
        line = [(hole, name) for hole, name in alike if hole.in_line(first)]
        alike = [(hole, name) for hole, name in alike if not hole.in_line(first)]
        clear = [hole for hole, _ in line if abs(hole.diameter - screw.clearance) < _ALIKE]
        clear.sort(key=lambda hole: hole.low)
        cores = [hole for hole, _ in line if hole not in clear]
        wide = [hole for hole, _ in holes if hole.in_line(first) and hole.diameter > screw.head]
        parts = frozenset(name for _, name in line)
        for group in _sides(clear, cores):
            low, high = (group[0].low, group[-1].high) if group else (math.inf, -math.inf)
            sunk_below = any(hole.high < low + _ALIKE for hole in wide) and not any(
                hole.low > high - _ALIKE for hole in wide
            )
            yield _Column(first.at, group, cores, parts, sunk_below)


def _sides(clear: Sequence[Round], cores: Sequence[Round]) -> list[Sequence[Round]]:
    """Clearance holes under and over what has the thread, where they are on both sides of it; else all."""
    middle = min((hole.low + hole.high for hole in cores), default=-math.inf) / 2
    sides = (
        [hole for hole in clear if hole.low < middle],
        [hole for hole in clear if hole.low > middle],
    )
    return [*sides] if all(sides) else [clear]


def _fits(assembly: Assembly, thing: Bought, column: _Column) -> bool:
    """Whether a screw may go into a column."""
    if thing.at:
        return bool(column.parts & {name for name, _ in thing.at})
    if thing.role == "drive screw":
        face = MOTOR_FACES.get(assembly.motor.frame)
        motors = [disc for each in assembly.stand_ins if each.drives for disc in each.discs]
        if motors:
            return any(
                abs(column.at - at) < radius + SCREWS[thing.thread].headed(thing.standard).head
                and any(abs(hole.low - face) < SAME_POINT for hole in column.holes)
                for at, radius, _, face in motors
            )
        return face is not None and any(
            abs(abs(column.at) - abs(z)) < _ON_CIRCLE for z in face.screws
        )
    if thing.role == "mount" and assembly.frame is not None and assembly.frame.fixings:
        return any(abs(column.at - z) < SAME_POINT for z, _ in assembly.frame.fixings)
    if thing.role == "mount" and not thing.length:  # what it goes into is no part
        return bool(column.holes) != bool(column.cores)
    return bool(column.holes)


def _screw(screw: Screw, thing: Bought, column: _Column) -> Thing:
    """A shank and a head with its hexagon; of one from behind what is in the core hole."""
    import shapely

    shank = _disc(column.at, screw.nominal / 2)
    ends = [end for hole in (*column.holes, *column.cores) for end in (hole.low, hole.high)]
    if not column.holes:
        return [(shank, min(ends), max(ends))]
    way = 1.0 if column.up else -1.0
    seat = column.holes[0].low if column.up else column.holes[-1].high
    far = max(ends) if column.up else min(ends)
    tip = seat + way * thing.length if thing.length else far
    flats = HEX_KEYS.get(thing.standard, {}).get(screw.thread, screw.nominal / 2)
    socket = shapely.Polygon(coordinates(_hexagon(column.at, flats)))
    head = _disc(column.at, screw.head / 2)
    top = seat - way * screw.height
    floor = top + way * _SOCKET * screw.height
    return [
        (shank, *sorted((seat, tip))),
        (head.difference(socket), *sorted((seat, top))),
        (socket, *sorted((seat, floor))),
    ]


def _nut(screw: Screw, column: _Column) -> Piece:
    """A nut in its pocket between clearance holes, else at the end away from the head."""
    import shapely

    gaps = [
        (below.high, above.low)
        for below, above in zip(column.holes, column.holes[1:], strict=False)
        if screw.nut < above.low - below.high < _POCKET * screw.nut
    ]
    low = column.holes[-1].high if column.up else column.holes[0].low - screw.nut
    if gaps:
        low = sum(gaps[0]) / 2 - screw.nut / 2
    return shapely.Polygon(coordinates(_hexagon(column.at, screw.flats))), low, low + screw.nut


def _hexagon(at: complex, flats: float) -> Any:
    """Its corners, (6,) complex mm; flats: width across them."""
    return at + flats / math.sqrt(3) * np.exp(1j * math.pi / 3 * np.arange(6))


def _disc(at: complex, radius: float) -> Any:
    import shapely

    return shapely.Point(at.real, at.imag).buffer(radius, quad_segs=24)


def _in_thread(copy: StandingCopy, tap: Tap) -> Piece:
    """A set screw on its key as long as its thread."""
    import shapely

    half = SCREWS[tap.thread].nominal / 2
    corners = [
        copy.at(complex(side * half, end))
        for end, side in ((tap.inner, -1), (tap.outer, -1), (tap.outer, 1), (tap.inner, 1))
    ]
    low, high = heights(copy.pose, copy.part.thickness, tap.height - half, tap.height + half)
    return shapely.Polygon(coordinates(np.array(corners))), low, high


# ---- keys, springs, motors -------------------------------------------------------------------------------------------


def _keys(copy: StandingCopy) -> Iterator[Piece]:
    """The key in each keyed bore of a copy, half way along it."""
    import shapely

    part = copy.part
    for hole in part.region.holes:
        seat = keyed(hole)
        if seat is None:
            continue
        (centre, radius), *_ = discs(hole)
        bore = next(each for each in copy.holes if abs(each.at - copy.at(centre)) < _ON_CIRCLE)
        t1, _ = shaft_keyway(2 * radius)
        inner, outer = radius - t1, radius + seat.depth
        corners = [
            copy.at(centre + seat.way * complex(along, side * seat.width / 2))
            for along, side in ((inner, -1), (outer, -1), (outer, 1), (inner, 1))
        ]
        long = min(key_length(2 * radius, part.thickness), part.thickness)
        middle = (bore.low + bore.high) / 2
        yield (
            shapely.Polygon(coordinates(np.array(corners))),
            middle - long / 2,
            middle + long / 2,
        )


def _one_key(copies: Sequence[StandingCopy], keys: Sequence[Piece]) -> Piece:
    """The key that goes through the bores of all copies, of the keys that they would have each; half way along them."""
    seats = [(copy, seat) for copy in copies for seat in map(keyed, copy.part.region.holes) if seat]
    whole = sum(copy.part.thickness for copy, _ in seats)
    half = min(key_length(2 * seats[0][1].radius, whole), whole) / 2
    middle = (min(low for _, low, _ in keys) + max(high for *_, high in keys)) / 2
    return keys[0][0], middle - half, middle + half


def _on_shaft(
    assembly: Assembly, things: Sequence[Bought], follower: CamFollower | None
) -> dict[Bought, list[Thing]]:
    """A shaft that is no part through the bores of its cams, the end for the coupling down, with its rings and bearings; and rollers
    on the cams."""
    shaft = next((thing.shaft for thing in things if thing.shaft is not None), None)
    found = dict[Bought, list[Thing]]()
    if shaft is None or shaft.bearings is None:
        return found
    parts = assembly.by_name
    top = max(each.z + parts[each.part].thickness for each in assembly.mounts if each.at == 0)
    zero = top + shaft.bores[0][0]  # height of the end that is up

    def ring(inner: float, outer: float, start: float, length: float) -> Piece:
        """From one diameter to another, so long, mm from the shaft's upper end."""
        face = (
            _disc(0j, outer / 2).difference(_disc(0j, inner / 2)) if inner else _disc(0j, outer / 2)
        )
        return face, zero - start - length, zero - start

    cuts = sorted((*wall, pair.diameter) for pair in shaft.grooves for wall in pair.walls)
    ends = [0.0, *(x for begin, end, _ in cuts for x in (begin, end)), shaft.length]
    whole = zip(ends[::2], ends[1::2], strict=True)
    rod = [ring(0.0, shaft.diameter, begin, end - begin) for begin, end in whole]
    rod += [ring(0.0, floor, begin, end - begin) for begin, end, floor in cuts]
    bearings = shaft.bearings
    third = (bearings.outside - shaft.diameter) / 3
    races = (shaft.diameter, shaft.diameter + third), (bearings.outside - third, bearings.outside)
    rings = dict[str, list[Thing]]()
    for pair in shaft.grooves:
        wide = pair.diameter + 2 * _RING * shaft.diameter
        rings.setdefault(pair.ring, []).extend(
            [ring(pair.diameter, wide, start, pair.thick)]
            for start in (pair.start, pair.start + pair.apart - pair.thick)
        )
    for thing in things:
        if thing.shaft is not None:
            found[thing] = [rod]
        elif thing.name in rings:
            found[thing] = rings[thing.name]
        elif thing.name == OF_SHAFT:
            found[thing] = [
                [ring(*race, x, bearings.width) for race in races] for x in bearings.seats
            ]
        elif thing.standard == ROLLER_STANDARD:
            rollers = [*_rollers(assembly, follower), *_in_tracks(assembly, follower)]
            found[thing] = rollers if len(rollers) == thing.count else []
            if follower is not None and found[thing]:
                washers = washers_on(things)
                pairs = [_fastened(each, follower, washers) for each in rollers]
                named = {each.name: each for each in things}
                for k, name in enumerate((FOLLOWER_WASHER, FOLLOWER_NUT)):
                    if name in named:
                        found[named[name]] = [pair[k] for pair in pairs]
    return found


def washers_on(things: Sequence[Bought]) -> int:
    """How many washers are on the stud of each cam follower."""
    studs = next((each.count for each in things if each.standard == ROLLER_STANDARD), 1)
    return sum(each.count for each in things if each.name == FOLLOWER_WASHER) // studs


def _fastened(roller: Thing, follower: CamFollower, washers: int) -> tuple[Thing, Thing]:
    """Washers at the shoulder of a cam follower, twice as wide as its stud, and a nut a little before the stud's end."""
    import shapely

    (ring, low, high), (stud, foot, top) = roller
    end = follower.length - _BEFORE_END
    rows = (
        (0.0, washers * WASHERS[follower.stud], follower.stud),
        (end - _NUT * follower.stud, end, _FLATS * follower.stud / 2),
    )
    fixed: list[Thing] = []
    for begin, out, half in rows:
        if ring.interiors:  # upright
            sense = -1 if low - foot > top - high else 1
            shoulder = (low if sense < 0 else high) + sense * follower.beyond
            ends = sorted(shoulder + sense * each for each in (begin, out))
            disc = shapely.Point(stud.centroid).buffer(half, quad_segs=24)
            fixed.append([(disc.difference(stud), *ends)])
            continue
        z = np.array(stud.exterior.coords) @ np.array([1, 1j])
        way = (z[1] - z[0]) / abs(z[1] - z[0])
        start = (z[0] + z[3]) / 2 + way * follower.beyond
        corners = [
            start + way * complex(along, side)
            for along, side in ((begin, -half), (out, -half), (out, half), (begin, half))
        ]
        face = shapely.Polygon(coordinates(np.array(corners)))
        middle = (foot + top) / 2
        fixed.append([(face, top, middle + half), (face, middle - half, foot)])
    return fixed[0], fixed[1]


def _in_tracks(assembly: Assembly, follower: CamFollower | None) -> Iterator[Thing]:
    """Rings of cam followers in tracks of drums, and their studs, square to the drum's axis, at theta = 0."""
    import shapely

    stud = (0.0, 0.0)
    if follower is not None:
        stud = follower.stud / 2, follower.beyond + follower.length
    for track in assembly.tracks:
        drum = assembly.by_name[track.part].drum
        mount = next(each for each in assembly.mounts if each.part == track.part)
        if drum is None or mount.upright or mount.flipped:
            continue
        start = np.zeros(1)
        height = mount.z + float(drum.path.height(start, 0)[0])
        aside = float(drum.path.beside(start, 0)[0])
        way = np.exp(1j * (mount.angle + math.atan2(aside, drum.roller.middle)))
        radius, length, inner, _ = track.roller
        rods = ((inner, length, radius), (inner + length, stud[1], stud[0]))
        pieces = []
        for begin, long, half in rods:
            corners = [
                way * complex(begin + along * long, side * half)
                for along, side in ((0, -1), (1, -1), (1, 1), (0, 1))
            ]
            if long:
                face = shapely.Polygon(coordinates(mount.at + np.array(corners)))
                pieces.append((face, height - half, height + half))
        yield pieces


def _rollers(assembly: Assembly, follower: CamFollower | None) -> list[Thing]:
    """Rings of cam followers on disc cams, where these stand at theta = 0, and their studs on the side where less of the cams is."""
    courses = assembly.courses(np.zeros(1))
    tips = [each for each in assembly.stand_ins if each.rolls]
    parts = assembly.by_name
    bottom = min((each.z for each in assembly.mounts), default=0.0)
    top = max((each.z + parts[each.part].thickness for each in assembly.mounts), default=0.0)
    found = list[Thing]()
    for each in tips:
        body = courses[each.body]
        turn = np.exp(1j * np.ravel(body.angle)[0])
        for at, radius, low, high in each.discs:
            place = complex(np.ravel(body.place)[0] + turn * at)
            ring = _disc(place, radius)
            if follower is None:
                found.append([(ring, low, high)])
                continue
            stud = _disc(place, follower.stud / 2)
            middle = (low + high) / 2
            face = follower.width / 2  # of the ring
            head = face + follower.beyond
            ends = -head - follower.length, head
            if top - high <= low - bottom:
                ends = -head, head + follower.length
            rolls = ring.difference(stud), middle - face, middle + face
            found.append([rolls, (stud, middle + ends[0], middle + ends[1])])
    return found


def _spring(course: Any, diameter: float, eyes: tuple[float, float]) -> Piece:
    """An extension spring as a zigzag from pin to pin."""
    import shapely

    line = shapely.LineString(coordinates(np.ravel(course(np.zeros(1)))))
    return line.buffer(_WIRE * diameter / 2, cap_style="flat", join_style="mitre"), *eyes


def _between_screws(
    copies: Sequence[StandingCopy], face: MotorFace, at: complex, top: float
) -> complex:
    """The middle of the holes for a motor's screws in what lies on its face, which is `top` high; its shaft at `at`."""
    reach = max(map(abs, face.screws))
    places = [
        hole.at
        for copy in copies
        for hole in copy.holes
        if abs(hole.low - top) < SAME_POINT and abs(abs(hole.at - at) - reach) < _ON_CIRCLE
    ]
    return sum(places) / len(places) if places else at


def _motors(assembly: Assembly, copies: Sequence[StandingCopy]) -> Iterator[Thing]:
    """Bodies of motors with their shafts; of a frame without a known length as long as half its width."""
    import shapely

    face = MOTOR_FACES.get(assembly.motor.frame)
    bodies = [disc for each in assembly.stand_ins if each.drives for disc in each.discs]
    if not bodies and face is not None:
        plates = [
            hole
            for copy in copies
            for hole in copy.holes
            if abs(hole.at) < _ON_CIRCLE and abs(hole.diameter - face.boss) < 1
        ]
        top = min((hole.low for hole in plates), default=0.0)
        bodies = [(0j, face.half, top - face.half, top)]
    for at, radius, low, high in bodies:
        pieces: list[Piece] = [(_disc(at, radius), low, high)]
        if face is not None and not face.length:
            body = shapely.box(
                *(x + way * face.half for way in (-1, 1) for x in (at.real, at.imag))
            )
            aside = abs(sum(face.screws)) / len(face.screws)
            if aside > SAME_POINT:  # of a can beside its shaft, half way between its screws
                middle = _between_screws(copies, face, at, high)
                body = _disc(middle, face.reach - aside)
            pieces = [(body, low, high), (_disc(at, face.boss / 2), high, high + face.boss_height)]
        reach = assembly.motor.reach
        shaft = assembly.motor.shaft or (face.shaft if face else 0.0)
        if shaft and reach is not None:
            # the face of one that a bar holds lies on the plate, above what holds it
            face_at = high if assembly.frame is None else plate_of(assembly)[1].z
            pieces.append((_disc(at, shaft / 2), high, face_at + reach))
        yield pieces
