"""What the drawings of a machine's parts say beside their shapes: material, mass, number, fits of holes.

Two parts fit where, in the assembly, a round hole of one and the round outline of the other have one axis and heights in
common, and their diameters differ by the clearance of what slides or is pressed; or where a joint says what goes through.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from camgen.files.dimensions import hole_of, number
from camgen.files.title_block import Facts, Fit
from camgen.machine.features import PinEyes
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import cut_of_sheet
from camgen.parts.catalogue import CUT, TURNED
from camgen.parts.materials import STEEL
from camgen.parts.part import Part
from camgen.parts.steps import standing
from camgen.tolerances import SAME_POINT


def facts_of(mechanism: Mechanism, part: Part) -> Facts:
    """What the drawing of one of its parts says."""
    sheet = mechanism.drawing
    of_sheet = cut_of_sheet(mechanism.assembly, part)
    printed = part.process == "printed" and not of_sheet
    steel = part.process in (TURNED, CUT)
    names = [each.name for each in mechanism.assembly.parts]
    return Facts(
        mechanism=mechanism.mechanism,
        material="as the sheet"
        if of_sheet
        else mechanism.material.name
        if printed
        else "steel"
        if steel
        else part.process,
        mass_g=part.volume
        * (mechanism.assembly.process.density if printed else 1e3 * STEEL.density)
        * 1e-6
        if printed or steel
        else None,
        tolerance=sheet.tolerance,
        number=f"{sheet.number}-{names.index(part.name) + 1:02d}" if sheet.number else "",
        date=sheet.date or "",
        fits=tuple(_fits(mechanism, part)),
        profile_step_deg=sheet.profile_step_deg,
        position=sheet.position,
    )


def _fits(mechanism: Mechanism, part: Part) -> Iterator[Fit]:
    """Fits of a part's round holes."""
    clearances = {
        "press": mechanism.print.press_clearance,
        "slide": mechanism.print.slide_clearance,
    }
    poses = mechanism.assembly.poses(np.zeros(1))
    shafts = [
        standing(other, pose, layer, outer.place, outer.radius)
        for other in mechanism.assembly.parts
        if other.name != part.name
        for layer in other.layers
        if (outer := hole_of(layer.region.outer)).radius
        for pose in poses[other.name]
    ]
    holes = set[tuple[complex, float]]()
    for layer in part.layers:
        for place, radius in (
            (hole.place, hole.radius) for hole in map(hole_of, layer.region.holes)
        ):
            if not radius or (place, radius) in holes:
                continue
            inside = list(_nominal_diameters(mechanism, part.name, place))
            for pose in poses[part.name]:
                bore = standing(part, pose, layer, place, radius)
                inside += [shaft.diameter for shaft in shafts if bore.holds(shaft)]
            for word, clearance in clearances.items():
                sizes = [size for size in inside if abs(2 * radius - size - clearance) < SAME_POINT]
                if sizes:
                    holes.add((place, radius))
                    yield Fit(place, 2 * radius, f"{word} on Ø{number(sizes[0])}")
                    break


def _nominal_diameters(mechanism: Mechanism, part: str, place: complex) -> Iterator[float]:
    """Diameters, mm, of what goes through a part's hole and no file shows: as its joints say, and a motor's at its own datum."""
    tables = [getattr(mechanism, name, None) for name in ("geometry", "making", "motor")]
    sizes = [
        getattr(table, name, None)
        for table in tables
        if getattr(table, "make", "") != "cams"
        for name in ("shaft_diameter", "boss_diameter")
    ]
    yield from (size for size in sizes if size and abs(place) < SAME_POINT)
    for joint in mechanism.assembly.features:
        if isinstance(joint, PinEyes):
            holes = [
                eye
                for eye in (joint.a, joint.b)
                if eye.part == part and not eye.shaft and abs(eye.at - place) < SAME_POINT
            ]
            yield from (
                eye.diameter for eye in (joint.pin, joint.a, joint.b) if holes and eye and eye.shaft
            )
