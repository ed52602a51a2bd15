"""What the assembly of a linkage says beside its bodies: drive, engraving, stiffness, balance, and the mirror between two sides."""

from __future__ import annotations

import math
from collections.abc import Sequence

from camgen.errors import DesignError
from camgen.machine.features import Balance, Feature
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.spec import LinkageSpec
from camgen.machines.loads.counterweights import Counterweight, balance_of
from camgen.parts import materials
from camgen.parts.catalogue import turning_text
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.joints import part_name, pivot_of
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.mounted import upper_end
from camgen.parts.motors import GEARED, HAND_CRANK, HOLES_UNKNOWN
from camgen.parts.part import Part
from camgen.parts.sides import Mirror
from camgen.parts.stiffness import bending_stiffness
from camgen.parts.turning_over import fit_turned_over


def supply_volts(spec: LinkageSpec) -> float:
    """For what voltage its motor is, V; 0 where that is not known."""
    geared = GEARED.get(spec.motor.model or "") if spec.motor else None
    return geared.volts if geared else 0.0


def driving_text(spec: LinkageSpec) -> str:
    """What its drive is to do, in words."""
    drive = spec.drive
    if isinstance(drive, t.Drive):
        turning = turning_text(drive.speed_rpm)
        model = spec.motor.model if spec.motor else None
        if model is None or model.lower() == spec.making.motor or spec.making.hand_crank:
            return turning
        geared = GEARED.get(model)
        known = "measure yours: parts.can" if spec.making.can else HOLES_UNKNOWN
        more = "" if geared is None else f" for {geared.volts:g} V ({known})"
        if model == HAND_CRANK:
            more = " (your own, or parts.hand_crank adds one)"
        if geared is not None:
            turning += f" at work, {geared.no_load_rpm:.3g} rpm without load"
        return f"{model}{more}, {turning}"
    low, high = drive.range
    return f"linear, {high - low:g} mm at {drive.speed:g} mm/s, on link {drive.link}"


def with_engraving(
    spec: LinkageSpec, bodies: Bodies, features: Sequence[Feature]
) -> Sequence[Part]:
    """Parts with what is engraved in them but letters: a text in a link, and what says the upper side of a cam, wheel or crank that
    fits turned over as well; of sheet only where engraving is cut too.
    """
    texts = {
        part_name(link): (shape.engrave, f"parts.{link}.engrave")
        for link in spec.diagram.links
        if (shape := spec.making.shape(link)).engrave
    }
    parts = bodies.parts
    reversible = set(fit_turned_over(parts, features, bodies.mounts))
    if not (texts or reversible):
        return parts
    from camgen.parts.engraving import engraved, with_upper_side

    engraves = spec.files.engrave or not spec.making.of_sheet
    mark = spec.files.up_marks and engraves and spec.making.sides == 1
    told = (engraved(part, False, *texts.get(part.name, ())) for part in parts)
    return [with_upper_side(part, mark) if part.name in reversible else part for part in told]


def with_letters(spec: LinkageSpec, parts: Sequence[Part]) -> Sequence[Part]:
    """Parts with the letters of their holes, where the spec asks for these: of both sides, for both sides of a machine have one part
    as long as it is its own mirror image."""
    if not spec.files.hole_letters:
        return parts
    from camgen.parts.engraving import engraved

    return [engraved(part, True) for part in parts]


def arm_stiffness(spec: LinkageSpec, bodies: Bodies) -> float | None:
    """Of the follower that swings on the one cam of the machine, N m/rad; None of another, or where there are several."""
    swinging = [cam for cam in spec.cams if spec.diagram.slide_of(cam.follower) is None]
    if len(spec.cams) != 1 or not swinging:
        return None
    (cam,) = swinging
    points = bodies.layout.points_of(cam.follower)
    pivot = spec.diagram.pivot(cam.follower) or ""
    if not {pivot, cam.at} <= points.keys():
        return None
    name = part_name(cam.follower)
    arm = next(part for part in bodies.parts if part.name == name)
    held = points[pivot]
    pushed = points[cam.at]
    modulus = materials.of(spec.material.name).elastic.modulus
    return bending_stiffness(arm, held, pushed, modulus) * abs(pushed - held) ** 2 * 1e-3


def balance(weight: Counterweight, whole: complex, bodies: Bodies, density: float) -> Balance:
    """What the solids of the driven link with its counterweight are held to.

    whole: moment of all that is to turn with it, complex g mm; density: of what is printed, kg/m^3.
    """
    layout = bodies.layout
    link = layout.driven
    origin = layout.at(link, layout.shaft_of(link))
    solids = bodies.solids(density)
    return balance_of(link, pivot_of(layout, link), origin, whole - weight.other, solids)


def mirror(near: Layout) -> Mirror:
    """Half-way between the second plates of two sides; DesignError where no shaft of the near one gets there."""
    end = upper_end(near)
    assert end is not None, "a fault of the spec"
    if end.axis is None:
        raise DesignError(
            "shafts in the second plate",
            0,
            1,
            "",
            f"link {near.driven}",
            'set parts.shaft = "interrupted": its upper end goes on into the far side',
        )
    phase = math.radians(near.sizes.side_phase_deg)
    return Mirror(end.top + near.sizes.side_gap / 2, end.shaft, phase, near.sizes)
