"""In which order a machine goes together, and where each part goes: on which shaft, how far from its end, over which hole.

A part of layers is, for this, round things on an axis each: its holes, and outlines that are a circle with or without flats;
and slots. Where a hole of one part and an outline of another have one axis and heights in common, the one goes on the other;
where two holes have one axis, they lie over each other and a pin comes through.

    tight    a hole that is hardly wider than what goes through it: there both are fixed on each other. It is said of the one that
             comes later, so that what is pressed in or on is held by something that is there
"""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from camgen.geometry.outlines import Arc, Contour
from camgen.machine.features import Mount, PartPose, PinEyes, heights
from camgen.parts.part import HoldingNote, Layer, Part
from camgen.study import Table
from camgen.tolerances import SAME_POINT

_ONE_AXIS = 1e-3  # mm, far below any play
_LOOSE = 1.0  # mm, by which a hole may be wider than what it goes on
_HALF_TURN = 1e-6  # rad, by which the ends of a slot may miss half a circle
_LONG = 3.0  # diameters, from which on a round thing has ends from which one measures
COLUMNS = ("step", "part", "what", "where", "count", "underside at z, mm", "lies")


@dataclass(frozen=True)
class Round:
    """A hole or a round outline in the assembly: axis, heights, diameter, mm; of the part's point there its name."""

    at: complex
    low: float
    high: float
    diameter: float
    name: str

    def in_line(self, other: Round) -> bool:
        """Whether both have one axis."""
        return abs(self.at - other.at) < _ONE_AXIS

    def is_one_with(self, other: Round) -> bool:
        """Whether both are one hole, in layers one above the other."""
        touching = max(self.low, other.low) - min(self.high, other.high) < SAME_POINT
        return self.in_line(other) and touching and abs(self.diameter - other.diameter) < SAME_POINT

    def holds(self, outline: Round) -> bool:
        """Whether a round outline goes through this hole."""
        return (
            self.in_line(outline)
            and _common(self, outline)
            and abs(self.diameter - outline.diameter) < _LOOSE
        )


@dataclass(frozen=True)
class Slot:
    """A slot in the assembly: both ends of its middle line, heights, width, mm."""

    a: complex
    b: complex
    low: float
    high: float
    diameter: float

    def in_line(self, other: Round) -> bool:
        """Whether the other one's axis is on the middle line."""
        off = (other.at - self.a) * (self.b - self.a).conjugate() / abs(self.b - self.a)
        return (
            -_ONE_AXIS < off.real < abs(self.b - self.a) + _ONE_AXIS and abs(off.imag) < _ONE_AXIS
        )

    def holds(self, outline: Round) -> bool:
        """Whether a round outline stands in this slot."""
        fits = abs(self.diameter - outline.diameter) < _LOOSE
        return self.in_line(outline) and _common(self, outline) and fits


def _common(hole: Round | Slot, outline: Round) -> bool:
    """Whether both have heights in common."""
    return min(hole.high, outline.high) - max(hole.low, outline.low) > SAME_POINT


def standing(part: Part, pose: PartPose, layer: Layer, at: complex, radius: float) -> Round:
    """A circle of a part's layer, its centre and radius in the part's frame, mm, where a copy stands."""
    centre = -at.conjugate() if pose.flipped else at
    place = complex(pose.place[0]) + cmath.exp(1j * float(pose.angle[0])) * centre
    name = next((name for name, point in part.points if abs(point - at) < SAME_POINT), "")
    return Round(place, *heights(pose, part.thickness, layer.z0, layer.z1), 2 * radius, name)


@dataclass(frozen=True)
class _StandingCopy:
    """A copy of a part where it stands."""

    part: Part
    low: float
    holes: Sequence[Round]
    slots: Sequence[Slot]
    outlines: Sequence[Round]

    @property
    def slender(self) -> bool:
        """Whether it is a shaft or a pin: its longest outline alone is long."""
        return any(each.high - each.low >= _LONG * each.diameter for each in self.outlines)


@dataclass(frozen=True)
class Fixing:
    """What of two parts that go through each other is fixed."""

    play: float  # greatest of a hole that is tight, mm
    said: str = "pressed and glued"  # how, in words
    rings: frozenset[str] = frozenset()  # names of ball bearings, which are pressed and not glued

    def words(self, hole: Round | Slot, holder: Part, outline: Round, held: Part) -> str:
        """How an outline is fixed in a hole; "" where it goes through with play, or both are bought to go together."""
        if (
            hole.diameter - outline.diameter > self.play
            or holder.process == held.process == "bought"
        ):
            return ""
        if holder.name in self.rings:
            return ""  # the ring turns with its pin, and holds it by nothing
        return "pressed" if held.name in self.rings else self.said


def order(
    parts: Sequence[Part],
    mounts: Sequence[Mount],
    poses: Mapping[str, Sequence[PartPose]],
    pairs: Sequence[object],
    fixing: Fixing,
) -> Table:
    """Steps by the height of undersides; what is turned over, such as a pin with its head up, comes from above: by its top; a
    ball bearing before the link that holds it.

    poses: of each part's copies, at one angle; pairs: what joints are measured on.
    """
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    seats = {
        ring.part: {eye.part for each in eyes for eye in (each.a, each.b)}
        for each in eyes
        for ring in each.rings
    }
    fixing = replace(fixing, rings=frozenset(seats))
    number = Counter[str]()
    places = {part.name: k for k, part in enumerate(parts)}
    copies: dict[tuple[float, bool, int, bool, float], list[tuple[str, _StandingCopy]]] = {}
    for mount in mounts:
        k = places[mount.part]
        part = parts[k]
        number[mount.part] = number[mount.part] + 1
        height = mount.z + (part.thickness if mount.flipped else 0.0)
        holders = seats.get(part.name, set())
        height = min(
            [
                height,
                *(each.z for each in mounts if each.body == mount.body and each.part in holders),
            ]
        )
        step = (
            round(height, 6) + 0.0,
            part.name not in seats,
            k,
            mount.flipped,
            round(mount.z, 6) + 0.0,
        )
        stands = _standing_copy(part, poses[part.name][number[part.name] - 1])
        copies.setdefault(step, []).append((f"{part.name}-{number[part.name]}", stands))
    rows = list[tuple[object, ...]]()
    below = list[_StandingCopy]()
    by_height = sorted(copies.items(), key=lambda each: each[0])
    for count, ((_, _, k, over, z), group) in enumerate(by_height, 1):
        where = "; ".join(
            dict.fromkeys(filter(None, (_where(each, below, fixing) for _, each in group)))
        )
        rows.append(
            (
                count,
                parts[k].name,
                _holding_notes(parts[k]),
                where,
                len(group),
                z,
                "turned over" if over else "as drawn",
            )
        )
        below += [each for _, each in group]
    names = [[name for name, _ in group] for _, group in by_height]
    return Table("Assembly from the bottom up, by height", COLUMNS, rows, names)


def _holding_notes(part: Part) -> str:
    """What a part is, and what its notes say of how it is held."""
    notes = [note for note in part.notes if isinstance(note, HoldingNote)]
    return f"{part.title}: {'; '.join(notes)}" if notes else part.title


def _where(copy: _StandingCopy, below: Sequence[_StandingCopy], fixing: Fixing) -> str:
    """Where a copy goes, by what lies there before it; "" where nothing says."""
    if not copy.holes:  # a pin or a shaft
        return _pin_words(copy, below, fixing) or (
            "by itself, until what is fixed on it comes" if copy.outlines else ""
        )
    places = []
    for hole in copy.holes:
        shaft, outline = next(
            ((other, each) for other in below for each in other.outlines if hole.holds(each)),
            (None, None),
        )
        of_copy = (
            f"{hole.name} " if hole.name and (shaft is None or hole.name != shaft.part.name) else ""
        )
        if shaft is not None and outline is not None:
            far = (
                f", underside {hole.low - shaft.low:.4g} mm from its lower end"
                if shaft.slender
                else ""
            )
            how = fixing.words(hole, copy.part, outline, shaft.part)
            places.append(f"{of_copy}{f'{how} on' if how else 'on'} {shaft.part.name}{far}")
            continue
        under = [
            (each.high, other.part.name, each.name)
            for other in below
            for each in other.holes
            if hole.in_line(each)
        ]
        if under:
            _, name, point = max(under)
            places.append(
                f"{of_copy}over {f'{point} of ' if point and point != hole.name else ''}{name}"
            )
            continue
        slots = [
            (slot.high, other.part.name)
            for other in below
            for slot in other.slots
            if slot.in_line(hole)
        ]
        if slots:
            places.append(f"{of_copy}over the slot of {max(slots)[1]}")
    for slot in copy.slots:
        pins = [other.part.name for other in below if any(map(slot.holds, other.outlines))]
        places += [f"its slot over {pin}" for pin in pins]
    return ", ".join(dict.fromkeys(places))


def _pin_words(copy: _StandingCopy, below: Sequence[_StandingCopy], fixing: Fixing) -> str:
    """Through what a pin or a shaft goes that lies there, from above, and where it is fixed."""
    round_holes = [
        (hole, other, outline)
        for other in reversed(below)
        for hole in other.holes
        for outline in copy.outlines
        if hole.holds(outline)
    ]
    point = next((f"{hole.name} of " for hole, _, _ in round_holes if hole.name), "")
    words: dict[str, list[str]] = {}
    for hole, other, outline in round_holes:
        fit = fixing.words(hole, other.part, outline, copy.part)
        names = words.setdefault(f"{fit} into" if fit else "through", [])
        names += [other.part.name] if other.part.name not in names else []
    ways: list[str] = []
    for how, names in sorted(words.items(), key=lambda each: each[0] != "through"):
        ways.append(
            f"{how} {point if not ways else ''}{' and '.join(filter(None, (', '.join(names[:-1]), names[-1])))}"
        )
    slots = dict.fromkeys(
        other.part.name
        for other in reversed(below)
        if any(slot.holds(outline) for slot in other.slots for outline in copy.outlines)
    )
    return ", ".join([*ways, *(f"in the slot of {name}" for name in slots)])


def _standing_copy(part: Part, pose: PartPose) -> _StandingCopy:
    """A copy's round things where it stands; of a hole through several layers the lowest and highest end."""
    outlines = [
        standing(part, pose, layer, *disc)
        for layer in part.layers
        for disc in _disc(layer.region.outer)
    ]
    holes: list[Round] = []
    bored = (
        (layer, disc)
        for layer in part.layers
        for hole in layer.region.holes
        for disc in _disc(hole)
    )
    for each in (standing(part, pose, layer, *disc) for layer, disc in bored):
        same = next((k for k, other in enumerate(holes) if each.is_one_with(other)), None)
        if same is None:
            holes.append(each)
        else:
            other = holes[same]
            holes[same] = replace(
                each, low=min(each.low, other.low), high=max(each.high, other.high)
            )
    slots = [
        _slot(part, pose, layer, *ends)
        for layer in part.layers
        for hole in layer.region.holes
        for ends in _stadium(hole)
    ]
    return _StandingCopy(part, pose.z, holes, slots, outlines)


def _slot(part: Part, pose: PartPose, layer: Layer, a: complex, b: complex, radius: float) -> Slot:
    """A slot of a part's layer where a copy stands."""
    one = standing(part, pose, layer, a, radius)
    other = standing(part, pose, layer, b, radius)
    return Slot(one.at, other.at, one.low, one.high, 2 * radius)


def _stadium(contour: Contour) -> Iterator[tuple[complex, complex, float]]:
    """Both ends of the middle line and the radius of an outline that is a slot."""
    sweeps: dict[tuple[complex, float], float] = {}
    for arc in (piece for piece in contour.pieces if isinstance(piece, Arc)):
        sweeps[arc.centre, arc.radius] = sweeps.get((arc.centre, arc.radius), 0.0) + abs(arc.sweep)
    (a, radius), *others = sweeps or {(0j, 0.0): 0.0}
    straight = len([piece for piece in contour.pieces if not isinstance(piece, Arc)])
    if (
        straight == 2
        and len(others) == 1
        and all(abs(sweep - math.pi) < _HALF_TURN for sweep in sweeps.values())
    ):
        yield a, others[0][0], radius


def _disc(contour: Contour) -> Iterator[tuple[complex, float]]:
    """Centre and radius of a circle, with flats or a keyway or without."""
    widest = max(
        (piece for piece in contour.pieces if isinstance(piece, Arc)),
        key=lambda arc: abs(arc.sweep),
        default=None,
    )
    if widest and abs(widest.sweep) > math.pi:
        yield widest.centre, widest.radius
