"""Of each pin of a machine what bears it: where its holes and pins lie in the parts, how long they are, how they are held.

turning   the hole in which the pin turns: the wider of the two, or both; or the slot in which it runs
held      the hole in which it is pressed
lever     from the face where it is held to the middle of what turns on it, mm: the arm that bends it
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from camgen.geometry.outlines import Arc, Contour
from camgen.machine.cams.limits import MotionLimits
from camgen.machine.features import Eye, Faces, Feature, Mount, PinEyes, SlotFaces, heights
from camgen.machine.model import Machine, Pin, Place, Slot
from camgen.parts.catalogue import BEARINGS, BUSH, Bearing
from camgen.parts.part import Part, Role

_SAME = 1e-6  # mm


@dataclass(frozen=True)
class Journal:
    """A bearing of a Pin or a Slot."""

    joint: str
    diameter: float  # mm
    length: float  # mm
    lever: float  # mm, 0 where nothing bends
    shaft: str  # plastic or "steel"
    hole: str  # likewise
    ball: Bearing | None = None  # on the pin; None of a plain bearing
    part: str = ""  # what the pin or shaft is in the parts list
    slot: bool = False  # whether it is the walls of a slot
    role: Role = ""  # of the pin or shaft
    bush: bool = False  # whether it is a bush of bronze


@dataclass(frozen=True)
class DriveLimits:
    """What a spec asks of how the machine runs, None where it says nothing."""

    run_up: float | None = None  # s, from rest
    speed_swing: float | None = None  # greatest less least speed, as a share of what lies between


@dataclass(frozen=True)
class MaterialLimits:
    """What a spec says that its materials and followers bear, None where it says nothing; how it says what pins are made of."""

    hertz: float | None = None  # MPa, of contacts
    pv: float | None = None  # MPa m/s, of plain bearings
    pin_stress: float | None = None  # MPa
    tooth_stress: float | None = None  # MPa, at the root of a tooth
    bearing_life: float | None = None  # h, of ball bearings
    motion: MotionLimits = MotionLimits()  # of the followers of cams
    drive: DriveLimits = DriveLimits()
    keys: frozenset[str] = frozenset()  # of [parts], with the sizes of pins and shafts


@dataclass(frozen=True)
class Post:
    """A pin of one link that a spring or a cam's roller bends."""

    name: str
    by: str  # the spring, or the joint of the cam
    diameter: float  # mm
    lever: float  # mm
    material: str
    pull: float = 0.0  # of a spring, N
    part: str = ""  # what it is in the parts list
    role: Role = ""


def _round(contour: Contour, eye: Eye) -> bool:
    """Whether the contour is the eye's circle, or one with a flat."""
    return any(
        isinstance(piece, Arc)
        and abs(piece.centre - eye.at) < _SAME
        and abs(2 * piece.radius - eye.diameter) < _SAME
        for piece in contour.pieces
    )


def _slotted(contour: Contour, walls: Faces) -> bool:
    """Whether the contour has a round end of the slot."""
    back = cmath.exp(-1j * walls.angle)
    return any(
        isinstance(piece, Arc)
        and abs(((piece.centre - walls.at) * back).imag) < _SAME
        and abs(2 * piece.radius - walls.width) < _SAME
        for piece in contour.pieces
    )


def _span(
    part: Part, mount: Mount, shaft: bool, shows: Callable[[Contour], bool]
) -> tuple[float, float] | None:
    """From where to where in the assembly, mm, a part has such an edge: outside of a shaft, else a hole; None without one."""
    layers = [
        layer
        for layer in part.layers
        if any(map(shows, (layer.region.outer,) if shaft else layer.region.holes))
    ]
    if not layers:
        return None
    return heights(
        mount, part.thickness, min(layer.z0 for layer in layers), max(layer.z1 for layer in layers)
    )


class _Places:
    """Eyes of features as they lie in the assembly."""

    def __init__(self, parts: Sequence[Part], mounts: Sequence[Mount], printed: str) -> None:
        self.parts = {part.name: part for part in parts}
        self.mounts = mounts
        self.printed = printed

    def span(self, eye: Eye, sides: Sequence[Place]) -> tuple[float, float] | None:
        """Of the copy of the eye's part that is at the joint."""
        at = {side.body: side.at for side in sides}
        mounts = [mount for mount in self.mounts if mount.part == eye.part and mount.body in at]
        if eye.part is None or not mounts:
            return None
        mount = min(mounts, key=lambda mount: abs(mount.place(eye.at) - at[mount.body]))
        return _span(self.parts[eye.part], mount, eye.shaft, lambda edge: _round(edge, eye))

    def slot(self, walls: Faces, body: str) -> tuple[float, float] | None:
        """Of the slot in a part of the body."""
        mount = next(each for each in self.mounts if (each.part, each.body) == (walls.part, body))
        return _span(self.parts[walls.part], mount, False, lambda edge: _slotted(edge, walls))

    def material(self, part: str | None) -> str:
        """Of a part."""
        return (
            self.printed if part is not None and self.parts[part].process == "printed" else "steel"
        )

    def role(self, part: str | None) -> Role:
        """Of a part."""
        return "" if part is None else self.parts[part].role


def journals(
    machine: Machine,
    features: Sequence[Feature],
    parts: Sequence[Part],
    mounts: Sequence[Mount],
    printed: str,
) -> Mapping[str, Journal]:
    """The bearings of a machine's pins, in holes and in slots, by their joints, as far as its parts show them; printed: the name
    of their plastic.

    A motor's own shaft runs in the motor's bearings and is none.
    """
    places = _Places(parts, mounts, printed)
    bearings = dict[str, Journal]()
    for feature in features:
        if not isinstance(feature, PinEyes | SlotFaces):
            continue
        joint = machine.joint(feature.joint)
        if feature.pin is not None and feature.pin.part is None:
            continue
        if isinstance(feature, SlotFaces) and isinstance(joint, Slot):
            bearing = _in_slot(feature, joint, places, _held(machine, features, feature))
        elif isinstance(feature, PinEyes) and isinstance(joint, Pin):
            bearing = _journal(feature, places, (joint.a, joint.b))
        else:
            continue
        if bearing is not None:
            bearings[joint.name] = bearing
    return bearings


def _held(
    machine: Machine, features: Sequence[Feature], slot: SlotFaces
) -> list[tuple[Eye, tuple[Place, Place]]]:
    """Holes in which the pin of a slot is pressed, with the places of their joint: its own, or another's through which it goes."""
    joint = machine.joint(slot.joint)
    assert isinstance(joint, Slot)
    eyes = [(slot.eye, (joint.guide, joint.runner))]
    for each in features:
        other = machine.joint(each.joint) if isinstance(each, PinEyes) else None
        if isinstance(each, PinEyes) and isinstance(other, Pin) and slot.eye in (each.a, each.b):
            eye = each.b if slot.eye == each.a else each.a
            eyes.append((eye, (other.a, other.b)))
    return [each for each in eyes if each[0].diameter < slot.walls.width - _SAME]


def _in_slot(
    feature: SlotFaces,
    joint: Slot,
    places: _Places,
    pin_holes: Sequence[tuple[Eye, tuple[Place, Place]]],
) -> Journal | None:
    sides = (joint.guide, joint.runner)
    shaft = feature.pin or feature.eye
    walls = places.slot(feature.walls, joint.guide.body)
    if walls is None:
        return None
    pin = places.span(shaft, sides) or walls
    low = max(walls[0], pin[0])
    high = min(walls[1], pin[1])
    if high - low <= _SAME:
        return None
    spans = [places.span(eye, at) for eye, at in pin_holes if not eye.shaft]
    faces = [face for span in spans if span is not None for face in span]
    lever = min((abs((low + high) / 2 - face) for face in faces), default=0.0)
    materials = places.material(shaft.part), places.material(feature.walls.part)
    part = shaft.part or ""
    size = (shaft.diameter, high - low, lever)
    role = places.role(shaft.part)
    return Journal(feature.joint, *size, *materials, part=part, slot=True, role=role)


def _journal(feature: PinEyes, places: _Places, sides: Sequence[Place]) -> Journal | None:
    eyes = (feature.a, feature.b)
    holes = [eye for eye in eyes if not eye.shaft]
    shaft = feature.pin or next((eye for eye in eyes if eye.shaft), None)
    if shaft is None or not holes:
        return None
    widest = max(eye.diameter for eye in holes)
    turning = [eye for eye in holes if eye.diameter > widest - _SAME]
    fixed_eyes = [eye for eye in holes if eye not in turning]
    spans = [span for eye in turning if (span := places.span(eye, sides)) is not None]
    if not spans:
        return None
    low, high = min(spans, key=lambda span: span[1] - span[0])
    lever = 0.0
    if feature.pin is None:  # a disc that is itself the pin: what of it lies in the hole
        disc = places.span(shaft, sides)
        if disc is not None:
            low = max(low, disc[0])
            high = min(high, disc[1])
    else:
        faces = [
            face
            for eye in fixed_eyes
            if (span := places.span(eye, sides)) is not None
            for face in span
        ]
        lever = min((abs((low + high) / 2 - face) for face in faces), default=0.0)
    if high - low <= _SAME:
        return None
    sizes = [(each.bore, each.outside) for each in feature.rings]
    ball = next((each for each in BEARINGS.values() if (each.bore, each.outside) in sizes), None)
    bush = any(each.part == BUSH for each in feature.rings)
    materials = places.material(shaft.part), places.material(turning[0].part)
    size = (shaft.diameter, high - low, lever)
    role = places.role(shaft.part)
    return Journal(feature.joint, *size, *materials, ball, shaft.part or "", role=role, bush=bush)
