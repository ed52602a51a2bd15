"""In which order a machine goes together, and where each part goes: on which shaft, how far from its end, over which hole.

A part of layers is, for this, round things on an axis each: its holes, and outlines that are a circle with or without flats.
Where a hole of one part and an outline of another have one axis and heights in common, the one goes on the other; where two
holes have one axis, they lie over each other and a pin comes through.
"""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from camgen.geometry.outlines import Arc, Contour
from camgen.machine.features import Mount, PartPose, PinEyes, heights
from camgen.parts.part import Layer, Part
from camgen.study import Table
from camgen.tolerances import SAME_POINT

_ONE_AXIS = 1e-3  # mm, far below any play
_LOOSE = 1.0  # mm, by which a hole may be wider than what it goes on
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

    def holds(self, outline: Round) -> bool:
        """Whether a round outline goes through this hole."""
        common = min(self.high, outline.high) - max(self.low, outline.low)
        return self.in_line(outline) and common > SAME_POINT and abs(self.diameter - outline.diameter) < _LOOSE


def standing(part: Part, pose: PartPose, layer: Layer, at: complex, radius: float) -> Round:
    """A circle of a part's layer, its centre and radius in the part's frame, mm, where a copy stands."""
    own = -at.conjugate() if pose.flipped else at
    place = complex(pose.place[0]) + cmath.exp(1j * float(pose.angle[0])) * own
    name = next((name for name, point in part.points if abs(point - at) < SAME_POINT), "")
    return Round(place, *heights(pose, part.thickness, layer.z0, layer.z1), 2 * radius, name)


@dataclass(frozen=True)
class _Laid:
    """A copy of a part where it stands."""

    part: Part
    low: float
    holes: Sequence[Round]
    outlines: Sequence[Round]

    @property
    def slender(self) -> bool:
        """Whether it is a shaft or a pin: its longest outline alone is long."""
        return any(each.high - each.low >= _LONG * each.diameter for each in self.outlines)


def order(
    parts: Sequence[Part], mounts: Sequence[Mount], poses: Mapping[str, Sequence[PartPose]], pairs: Sequence[object]
) -> Table:
    """Steps by the height of undersides; what is turned over, such as a pin with its head up, comes from above: by its top; a
    ball bearing before the link that holds it.

    poses: of each part's copies, at one angle; pairs: what joints are measured on.
    """
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    seats = {ring.part: {eye.part for each in eyes for eye in (each.a, each.b)} for each in eyes for ring in each.rings}
    number, places = Counter[str](), {part.name: k for k, part in enumerate(parts)}
    copies: dict[tuple[float, bool, int, bool, float], list[tuple[str, _Laid]]] = {}
    for mount in mounts:
        k = places[mount.part]
        part, number[mount.part] = parts[k], number[mount.part] + 1
        height = mount.z + (part.thickness if mount.flipped else 0.0)
        holders = seats.get(part.name, set())
        height = min([height, *(each.z for each in mounts if each.body == mount.body and each.part in holders)])
        step = round(height, 6) + 0.0, part.name not in seats, k, mount.flipped, round(mount.z, 6) + 0.0
        stands = _laid(part, poses[part.name][number[part.name] - 1])
        copies.setdefault(step, []).append((f"{part.name}-{number[part.name]}", stands))
    rows, below, by_height = list[tuple[object, ...]](), list[_Laid](), sorted(copies.items(), key=lambda each: each[0])
    for count, ((_, _, k, over, z), laid) in enumerate(by_height, 1):
        where = "; ".join(dict.fromkeys(filter(None, (_where(each, below) for _, each in laid))))
        rows.append((count, parts[k].name, _held(parts[k]), where, len(laid), z, "turned over" if over else "as drawn"))
        below += [each for _, each in laid]
    named = [[name for name, _ in laid] for _, laid in by_height]
    return Table("Assembly from the bottom up, by height", COLUMNS, rows, named)


def _held(part: Part) -> str:
    """What a part is, and what its notes say of how it is pressed, glued or screwed."""
    notes = [note for note in part.notes if re.search(r"press|glue|screw|tight", note)]
    return f"{part.title}: {'; '.join(notes)}" if notes else part.title


def _where(copy: _Laid, below: Sequence[_Laid]) -> str:
    """Where a copy goes, by what lies there before it; "" where nothing says."""
    if not copy.holes:  # a pin or a shaft, from above
        held = [(hole, other) for other in reversed(below) for hole in other.holes if any(map(hole.holds, copy.outlines))]
        point = next((f"{hole.name} of " for hole, _ in held if hole.name), "")
        names = list(dict.fromkeys(other.part.name for _, other in held))
        return f"through {point}{' and '.join(filter(None, (', '.join(names[:-1]), names[-1])))}" if names else ""
    said = []
    for hole in copy.holes:
        shaft = next((other for other in below if any(map(hole.holds, other.outlines))), None)
        own = f"{hole.name} " if hole.name and (shaft is None or hole.name != shaft.part.name) else ""
        if shaft is not None:
            far = f", underside {hole.low - shaft.low:.4g} mm from its lower end" if shaft.slender else ""
            said.append(f"{own}on {shaft.part.name}{far}")
            continue
        under = [(each.high, other.part.name, each.name) for other in below for each in other.holes if hole.in_line(each)]
        if under:
            _, name, point = max(under)
            said.append(f"{own}over {f'{point} of ' if point and point != hole.name else ''}{name}")
    return ", ".join(dict.fromkeys(said))


def _laid(part: Part, pose: PartPose) -> _Laid:
    """A copy's round things where it stands; of holes one above the other on one axis, the lowest and highest end."""
    outlines = [standing(part, pose, layer, *disc) for layer in part.layers for disc in _disc(layer.region.outer)]
    holes: list[Round] = []
    bored = ((layer, disc) for layer in part.layers for hole in layer.region.holes for disc in _disc(hole))
    for each in (standing(part, pose, layer, *disc) for layer, disc in bored):
        same = next((k for k, other in enumerate(holes) if each.in_line(other)), None)
        if same is None:
            holes.append(each)
        else:
            other = holes[same]
            narrow = min(each.diameter, other.diameter)
            holes[same] = Round(each.at, min(each.low, other.low), max(each.high, other.high), narrow, each.name)
    return _Laid(part, pose.z, holes, outlines)


def _disc(contour: Contour) -> Iterator[tuple[complex, float]]:
    """Centre and radius of a circle, with flats or a keyway or without."""
    widest = max((piece for piece in contour.pieces if isinstance(piece, Arc)), key=lambda arc: abs(arc.sweep), default=None)
    if widest and abs(widest.sweep) > math.pi:
        yield widest.centre, widest.radius
