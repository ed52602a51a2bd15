"""Of each pin of a machine what bears it: where its holes and pins lie in the parts, how long they are, how they are held.

turning   the hole in which the pin turns: the wider of the two, or both
held      the hole in which it is pressed
lever     from the face where it is held to the middle of what turns on it, mm: the arm that bends it
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from camgen.geometry.outlines import Arc, Contour
from camgen.machine.features import Eye, Feature, Mount, PinEyes, heights
from camgen.machine.model import Machine, Pin, Place
from camgen.parts.catalogue import BEARINGS, Bearing
from camgen.parts.part import Part

_SAME = 1e-6  # mm


@dataclass(frozen=True)
class Journal:
    """A bearing of a Pin: diameter and length, mm; lever: mm, 0 where nothing bends; the plastics or "steel" of both.

    ball: the ball bearing on the pin; None of a plain one. part: what the pin or shaft is in the list of parts.
    """

    joint: str
    diameter: float
    length: float
    lever: float
    shaft: str
    hole: str
    ball: Bearing | None = None
    part: str = ""


@dataclass(frozen=True)
class Post:
    """A pin of one link that a spring or a cam's roller bends: diameter and lever, mm; what it is of; pull: N, 0 by a cam.

    by: the spring, or the joint of the cam; part: as of a Journal.
    """

    name: str
    by: str
    diameter: float
    lever: float
    material: str
    pull: float = 0.0
    part: str = ""


def _round(contour: Contour, eye: Eye) -> bool:
    """Whether the contour is the eye's circle, or one with a flat."""
    return any(
        isinstance(piece, Arc)
        and abs(piece.centre - eye.at) < _SAME
        and abs(2 * piece.radius - eye.diameter) < _SAME
        for piece in contour.pieces
    )


def _span(part: Part, eye: Eye, mount: Mount) -> tuple[float, float] | None:
    """From where to where the eye reaches in the assembly, mm; None where the part has no such circle."""
    layers = [
        layer
        for layer in part.layers
        if any(
            _round(contour, eye)
            for contour in ((layer.region.outer,) if eye.shaft else layer.region.holes)
        )
    ]
    if not layers:
        return None
    return heights(
        mount, part.thickness, min(layer.z0 for layer in layers), max(layer.z1 for layer in layers)
    )


class _Places:
    """Eyes of features as they lie in the assembly."""

    def __init__(self, parts: Sequence[Part], mounts: Sequence[Mount], printed: str) -> None:
        self.parts, self.mounts, self.printed = {part.name: part for part in parts}, mounts, printed

    def span(self, eye: Eye, sides: Sequence[Place]) -> tuple[float, float] | None:
        """Of the copy of the eye's part that is at the joint."""
        at = {side.body: side.at for side in sides}
        mounts = [mount for mount in self.mounts if mount.part == eye.part and mount.body in at]
        if eye.part is None or not mounts:
            return None
        mount = min(mounts, key=lambda mount: abs(mount.place(eye.at) - at[mount.body]))
        return _span(self.parts[eye.part], eye, mount)

    def material(self, eye: Eye) -> str:
        """Of the eye's part."""
        return (
            self.printed
            if eye.part is not None and self.parts[eye.part].made == "printed"
            else "steel"
        )


def journals(
    machine: Machine,
    features: Sequence[Feature],
    parts: Sequence[Part],
    mounts: Sequence[Mount],
    printed: str,
) -> Mapping[str, Journal]:
    """The bearings of a machine's pins by their joints, as far as its parts show them; printed: the name of their plastic.

    A motor's own shaft runs in the motor's bearings and is none.
    """
    places, found = _Places(parts, mounts, printed), dict[str, Journal]()
    for feature in features:
        if not isinstance(feature, PinEyes):
            continue
        joint = machine.joint(feature.joint)
        if not isinstance(joint, Pin) or (feature.pin is not None and feature.pin.part is None):
            continue
        sides = (joint.a, joint.b)
        made = _journal(feature, places, sides)
        if made is not None:
            found[joint.name] = made
    return found


def _journal(feature: PinEyes, places: _Places, sides: Sequence[Place]) -> Journal | None:
    eyes = (feature.a, feature.b)
    holes = [eye for eye in eyes if not eye.shaft]
    shaft = feature.pin or next((eye for eye in eyes if eye.shaft), None)
    if shaft is None or not holes:
        return None
    widest = max(eye.diameter for eye in holes)
    turning = [eye for eye in holes if eye.diameter > widest - _SAME]
    held = [eye for eye in holes if eye not in turning]
    spans = [span for eye in turning if (span := places.span(eye, sides)) is not None]
    if not spans:
        return None
    low, high = min(spans, key=lambda span: span[1] - span[0])
    lever = 0.0
    if feature.pin is None:  # a disc that is itself the pin: what of it lies in the hole
        disc = places.span(shaft, sides)
        if disc is not None:
            low, high = max(low, disc[0]), min(high, disc[1])
    else:
        faces = [
            face for eye in held if (span := places.span(eye, sides)) is not None for face in span
        ]
        lever = min((abs((low + high) / 2 - face) for face in faces), default=0.0)
    if high - low <= _SAME:
        return None
    sizes = [(each.bore, each.outside) for each in feature.rings]
    ball = next((each for each in BEARINGS.values() if (each.bore, each.outside) in sizes), None)
    materials = places.material(shaft), places.material(turning[0])
    return Journal(
        feature.joint, shaft.diameter, high - low, lever, *materials, ball, shaft.part or ""
    )
