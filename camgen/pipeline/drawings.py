"""What the drawings of a machine's parts say beside their shapes: material, mass, number, fits of holes.

Two parts fit where, in the assembly, a round hole of one and the round outline of the other have one axis and heights in
common, and their diameters differ by the clearance of what slides or is pressed; or where a joint says what goes through.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator

import numpy as np

from camgen.files.dimensions import hole_of, number
from camgen.files.title_block import Facts, Fit
from camgen.machine.features import PartPose, PinEyes
from camgen.machines.mechanism import Mechanism
from camgen.parts.catalogue import STEEL
from camgen.parts.part import Layer, Part
from camgen.records import dataclass
from camgen.tolerances import SAME_POINT

_ONE_AXIS = 1e-5  # mm, what closing the joints leaves of it


@dataclass(frozen=True)
class _Disc:
    """A round outline or hole in the assembly: centre, heights and diameter, mm."""

    at: complex
    low: float
    high: float
    diameter: float

    def holds(self, shaft: _Disc) -> bool:
        """Whether a shaft goes through this hole."""
        common = min(self.high, shaft.high) - max(self.low, shaft.low)
        return abs(self.at - shaft.at) < _ONE_AXIS and common > SAME_POINT


def facts_of(mechanism: Mechanism, part: Part) -> Facts:
    """What the drawing of one of its parts says."""
    sheet, cut = mechanism.drawing, mechanism.cut_of_sheet(part)
    printed, steel = part.made == "printed" and not cut, part.made.endswith(" of steel")
    names = [each.name for each in mechanism.parts()]
    return Facts(
        mechanism=mechanism.mechanism,
        material="as the sheet" if cut else mechanism.material.name if printed else "steel" if steel else part.made,
        mass_g=part.volume * (mechanism.density if printed else 1e3 * STEEL) * 1e-6 if printed or steel else None,
        tolerance=sheet.tolerance,
        number=f"{sheet.number}-{names.index(part.name) + 1:02d}" if sheet.number else "",
        date=sheet.date or "",
        fits=tuple(_fits(mechanism, part)),
        profile_step_deg=sheet.profile_step_deg,
        position=sheet.position,
    )


def _fits(mechanism: Mechanism, part: Part) -> Iterator[Fit]:
    """Fits of a part's round holes."""
    clearances = {"press": mechanism.print.press_clearance, "slide": mechanism.print.slide_clearance}
    poses = mechanism.poses(np.zeros(1))
    shafts = [
        _placed((outer.place, outer.radius), layer, other, pose)
        for other in mechanism.parts() if other.name != part.name
        for layer in other.layers if (outer := hole_of(layer.region.outer)).radius
        for pose in poses[other.name]
    ]  # fmt: skip
    told = set[tuple[complex, float]]()
    for layer in part.layers:
        for hole in map(hole_of, layer.region.holes):
            if not hole.radius or (hole.place, hole.radius) in told:
                continue
            inside = list(_said(mechanism, part.name, hole.place))
            for pose in poses[part.name]:
                own = _placed((hole.place, hole.radius), layer, part, pose)
                inside += [shaft.diameter for shaft in shafts if own.holds(shaft)]
            for word, clearance in clearances.items():
                found = [size for size in inside if abs(2 * hole.radius - size - clearance) < SAME_POINT]
                if found:
                    told.add((hole.place, hole.radius))
                    yield Fit(hole.place, 2 * hole.radius, f"{word} on Ø{number(found[0])}")
                    break


def _said(mechanism: Mechanism, part: str, place: complex) -> Iterator[float]:
    """Diameters, mm, of what goes through a part's hole and no file shows: as its joints say, and a motor's at its own datum."""
    tables = [getattr(mechanism, name, None) for name in ("geometry", "making", "motor")]
    sizes = [getattr(table, name, None) for table in tables for name in ("shaft_diameter", "boss_diameter")]
    yield from (size for size in sizes if size and abs(place) < SAME_POINT)
    for joint in mechanism.features():
        if isinstance(joint, PinEyes):
            mine = [eye for eye in (joint.a, joint.b) if eye.part == part and not eye.shaft and abs(eye.at - place) < SAME_POINT]
            yield from (eye.diameter for eye in (joint.pin, joint.a, joint.b) if mine and eye and eye.shaft)


def _placed(disc: tuple[complex, float], layer: Layer, part: Part, pose: PartPose) -> _Disc:
    """A circle (centre, radius) of a layer of a part where the part stands."""
    at, radius = disc
    low, high = (part.thickness - layer.z1, part.thickness - layer.z0) if pose.flipped else (layer.z0, layer.z1)
    own = -at.conjugate() if pose.flipped else at
    place = complex(pose.place[0]) + cmath.exp(1j * float(pose.angle[0])) * own
    return _Disc(place, pose.z + low, pose.z + high, 2 * radius)
