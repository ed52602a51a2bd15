"""Measuring: features as the sections of files show them, and the machine with its joints where they are.

An eye counts with the centre of its circle, two faces with their middle line, a cam with what its follower rolls to on the
outline. What no file shows stays where it is meant.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from camgen.geometry.rings import Circle, Ring, Shape, fit_circle, hole_circles
from camgen.judge.contact import RollingContact, contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.machine.features import CamOutline, Eye, Faces, Feature, Flat, Mark, Mount, PinEyes, SlideFaces, SlotFaces, eyes
from camgen.machine.model import Cam, Function, Joint, Machine, Output, Path, Pin, Place, Slide, Slot
from camgen.tolerances import SAME_POINT

Floats = NDArray[np.float64]
Sections = Sequence[Sequence[Shape]]

_PARALLEL = 0.01  # rad, leaning more is another face
_SAME_FACE = 0.02  # of the width: faces at two heights that are further apart are two faces
_FLAT = 0.35  # of the diameter: a longer straight piece of a hole is a flat
_SAME_HOLE = 0.25  # of the diameter: a ring that is nearer than this in place and size is the eye
_HEAD = 1.0  # mm, a ring that is larger by more is a pin's head, not its shank
_ON_TIP = 0.02  # of the diameter: points of an outline so near to its nominal circle are on a rounded end
_STEEP = 0.25  # cosine of a pressure angle (75 deg) that no cam is meant to reach, so that a wrong one widens no limit
_SLOPE = 1e-6  # rad of cam angle, over which the slope of a rolled motion is taken: shorter than any facet


# ---- features --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Measured:
    """An eye as found in a file: centre and free diameter, mm (a shaft's: over its vertices), and how far the centres at
    several heights lie apart."""

    centre: complex
    diameter: float
    spread: float = 0.0


def measure(eye: Eye, sections: Sections) -> Measured | None:
    """The eye in the sections of its part, at all heights at which it is there; None where no ring comes near it."""
    found: list[tuple[Circle, float]] = []
    least = min(_SAME_HOLE * eye.diameter, max(_HEAD, 0.02 * eye.diameter))
    for shapes in sections:
        for shape in shapes:
            rings: Sequence[Ring] = [shape.outer] if eye.shaft else shape.holes
            near = [ring for ring in rings if abs(ring.centroid - eye.at) <= _SAME_HOLE * eye.diameter]
            circles = hole_circles(Shape(shape.outer, tuple(near)))
            pairs = zip(circles, near, strict=True)
            found += [(c, _free(c, ring)) for c, ring in pairs if abs(c.diameter - eye.diameter) <= least]
    if not found:
        return None
    centres = np.array([c.centre for c, _ in found])
    sizes = [c.diameter if eye.shaft else free for c, free in found]
    spread = float(np.max(np.abs(centres - centres[0])))
    return Measured(complex(centres.mean()), max(sizes) if eye.shaft else min(sizes), spread)


def _free(circle: Circle, ring: Ring) -> float:
    """The free diameter of a hole's round part, mm: a flat, longer than any facet, is left out."""
    straight = ring.bulges == 0
    flat = straight & (np.abs(ring.ends - ring.points) > _FLAT * circle.diameter)
    if not flat.any():
        return circle.clear_diameter
    facets = np.abs((ring.points + ring.ends)[straight & ~flat] / 2 - circle.centre)
    return min(circle.diameter, 2 * float(facets.min(initial=np.inf)))


def measure_end(eye: Eye, sections: Sections) -> Measured | None:
    """A rounded end of an outline, such as a follower's own tip: the circle through what lies near the nominal one."""
    found = []
    for ring in (shape.outer for shapes in sections for shape in shapes):
        points = ring.samples()
        near = points[np.abs(np.abs(points - eye.at) - eye.diameter / 2) <= _ON_TIP * eye.diameter]
        if len(near) > 4:
            found.append(fit_circle(near)[:2])
    if not found:
        return None
    centres = np.array([centre for centre, _ in found])
    return Measured(complex(centres.mean()), 2 * max(r for _, r in found), float(np.max(np.abs(centres - centres[0]))))


@dataclass(frozen=True)
class MeasuredFaces:
    """Two parallel faces as found: how far their middle lies to the left of the line they were sought at, mm, how far they
    lean from it, rad, and their distance, mm."""

    offset: float
    lean: float
    width: float


def measure_faces(through: complex, angle: float, width: float, sections: Sections) -> MeasuredFaces | None:
    """The two faces of a part, `width` apart, on either side of a line: the mean of all heights; None where one is missing."""
    sides = [_face(through, angle, side * width / 2, width, sections) for side in (-1, 1)]
    right, left = sides
    if right is None or left is None:
        return None
    return MeasuredFaces((left[0] + right[0]) / 2, (left[1] + right[1]) / 2, left[0] - right[0])


def _face(through: complex, angle: float, aside: float, width: float, sections: Sections) -> tuple[float, float] | None:
    """The straight face of a part sought `aside` to the left of a line: where it crosses beside `through`, mm, and its lean."""
    along, found = cmath.exp(1j * angle), []
    for shapes in sections:
        rings = [ring for shape in shapes for ring in (shape.outer, *shape.holes)]
        a, b = (np.concatenate([getattr(ring, end)[ring.bulges == 0] for ring in rings]) for end in ("points", "ends"))
        long = np.abs(b - a) > width / 4
        start, way = (a[long] - through) / along, (b[long] - a[long]) / along
        lean = np.arctan2(np.where(way.real < 0, -way.imag, way.imag), np.abs(way.real))
        away = start.imag - start.real * np.tan(lean)  # of the face, across from `through`
        off = np.where(np.abs(lean) < _PARALLEL, np.abs(away - aside), np.inf)
        nearest = int(np.argmin(off)) if len(off) else 0
        if len(off) and off[nearest] < _SAME_HOLE * width:
            found.append((off[nearest], away[nearest], lean[nearest]))
    if not found:
        return None
    away, lean = np.mean([row[1:] for row in found if row[0] <= min(found)[0] + _SAME_FACE * width], axis=0)
    return float(away), float(lean)


@dataclass
class Readings:
    """All features of a machine as the files of one kind show them; lost: sentences on what they do not show."""

    eyes: dict[Eye, Measured] = field(default_factory=dict)
    faces: dict[Faces, MeasuredFaces] = field(default_factory=dict)
    flats: dict[Flat, Flat] = field(default_factory=dict)
    rings: dict[CamOutline, Ring] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)


def read(features: Sequence[Feature], files: Mapping[str, Sections], drawing: bool) -> Readings:
    """Measure all features in the sections of the parts' files."""
    found = Readings()
    tips = {feature.tip for feature in features if isinstance(feature, CamOutline)}
    for eye in dict.fromkeys(eye for feature in features for eye in eyes(feature)):
        if eye.part is None or not eye.diameter:
            found.eyes[eye] = Measured(eye.at, eye.diameter)
            continue
        seen = measure(eye, files[eye.part])
        if seen is None and eye.shaft and eye in tips:
            seen = measure_end(eye, files[eye.part])
        if seen is None:
            found.lost.append(f"no eye of {eye.diameter:g} mm near {eye.at:.3f} in {eye.part}")
        else:
            found.eyes[eye] = seen
    for feature in features:
        match feature:
            case SlideFaces(joint=joint, rails=rails, runner=runner):
                pairs = [rails, runner]
            case SlotFaces(joint=joint, walls=walls):
                pairs = [walls]
            case CamOutline(joint=joint, part=part, tip=tip):
                pairs = []
                ring = _outline(files[part], feature.inside)
                face = _flat(tip, files[tip.part]) if isinstance(tip, Flat) else None
                if ring is None or (isinstance(tip, Flat) and face is None):
                    found.lost.append(f"{joint}: {'the face' if ring is not None else f'the outline of {part}'} is lost")
                    continue
                found.rings[feature] = ring
                if isinstance(tip, Flat) and face is not None:
                    found.flats[tip] = face
            case _:
                continue
        for pair in pairs:
            hidden = drawing and not pair.drawn
            meant = MeasuredFaces(0.0, 0.0, pair.width)
            faces = meant if hidden else measure_faces(pair.at, pair.angle, pair.width, files[pair.part])
            if faces is None:
                found.lost.append(f"{joint}: a face or its eye is lost")
                break
            found.faces[pair] = faces
    return found


def _outline(sections: Sections, inside: bool) -> Ring | None:
    """What a follower runs on: the largest outline of a part (of its heights), or hole, material on its left."""
    rings = [ring for shapes in sections for shape in shapes for ring in (shape.holes if inside else [shape.outer])]
    if not rings:
        return None
    ring = max(rings, key=lambda ring: abs(ring.area)).counter_clockwise()
    return ring.reversed() if inside else ring


def _flat(flat: Flat, sections: Sections) -> Flat | None:
    """A follower's face as it is."""
    along = flat.facing + math.pi / 2
    face = _face(flat.at, along, 0.0, flat.width, sections)
    if face is None:
        return None
    return replace(flat, at=flat.at + 1j * cmath.exp(1j * along) * face[0], facing=flat.facing + face[1])


# ---- the machine as measured -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rolled:
    """A cam's law as its follower rolls: theta is the cam's angle less the phase; s in rad, or mm where it slides."""

    contact: RollingContact
    arm: float | None

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """s at theta, (n,), or its derivative."""
        if order == 0:
            return self.contact.angle(theta)
        before, here, after = (self.contact.angle(theta + k * _SLOPE) for k in (-1, 0, 1))
        if order == 1:
            return np.asarray((after - before) / (2 * _SLOPE))
        return np.zeros_like(here)  # a facet has none; only the start of Newton's method asks for it

    def lever(self, theta: Floats) -> Floats:
        """Way of the tip square to the outline per unit of s, (n,) mm; of one that is too steep to be meant as if it were not."""
        return np.asarray((self.arm or 1.0) * np.maximum(np.cos(self.contact.touch(theta).pressure_angle), _STEEP))


@dataclass(frozen=True)
class Fit:
    """A joint's play as measured and as meant, mm, how much the worst of its features is off, and the shift of each side."""

    play: float
    meant: float
    misfit: float
    shifts: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Between:
    """A follower that two outlines hold: where each of them is touched, and the sense in which it leaves the first."""

    drive: Rolled
    other: Rolled
    leaves: int

    def play(self, theta: Floats) -> Floats:
        """Way from the first outline to the second, rad or mm, (n,); below 0 they are in each other's way."""
        return np.asarray(self.leaves * (self.other(theta) - self.drive(theta)))


@dataclass(frozen=True)
class Closable:
    """The machine as measured; the fit of each joint that was, and what holds each cam's follower twice, by name."""

    machine: Machine
    fits: Mapping[str, Fit]
    between: Mapping[str, Sequence[Between]]


def assembled(machine: Machine, features: Sequence[Feature], mounts: Sequence[Mount], found: Readings) -> Closable:
    """The same machine with its joints and outputs where the features are.

    ValueError, with the joint's name, where a feature's part stands on neither of its bodies, or a follower misses its cam.
    """
    builder = _Builder(machine, mounts, found)
    for kind in (PinEyes, SlideFaces, SlotFaces, CamOutline):  # a cam asks for the pins that hold it
        for feature in features:
            if isinstance(feature, kind):
                builder.put(feature)
    marks = [feature.eye for feature in features if isinstance(feature, Mark)]
    outputs = tuple(builder.output(output, marks) for output in machine.outputs)
    joints = tuple(builder.joints[joint.name] for joint in machine.joints)
    return Closable(replace(machine, joints=joints, outputs=outputs), builder.fits, builder.between)


class _Builder:
    """Joints, put one by one where their features are."""

    def __init__(self, machine: Machine, mounts: Sequence[Mount], found: Readings) -> None:
        self.mounts, self.found = mounts, found
        self.joints: dict[str, Joint] = {joint.name: joint for joint in machine.joints}
        self.fits: dict[str, Fit] = {}
        self.between: dict[str, list[Between]] = {}

    def put(self, feature: PinEyes | SlideFaces | SlotFaces | CamOutline) -> None:
        """Put the feature's joint where it is."""
        joint = self.joints[feature.joint]
        match feature, joint:
            case PinEyes(), Pin():
                new: Joint = self._pin(feature, joint)
            case SlideFaces(), Slide():
                new = self._slide(feature, joint)
            case SlotFaces(), Slot():
                new = self._slot(feature, joint)
            case CamOutline(), Cam():
                new = self._cam(feature, joint)
            case _:
                raise ValueError(f"{joint.name} is no joint for {type(feature).__name__}")
        self.joints[feature.joint] = new

    def _mount(self, part: str, place: Place, at: complex) -> Mount:
        """The copy of the part on the place's body whose point `at` is nearest to it."""
        mounts = [mount for mount in self.mounts if (mount.part, mount.body) == (part, place.body)]
        if not mounts:
            raise ValueError(f"{part} is not mounted on {place.body}")
        return min(mounts, key=lambda mount: abs(mount.place(at) - place.at))

    def _placed(self, eye: Eye, place: Place) -> Place:
        """The place moved to where its eye was found."""
        if eye.part is None:
            return place
        mount = self._mount(eye.part, place, eye.at)
        return Place(place.body, place.at + mount.place(self.found.eyes[eye].centre) - mount.place(eye.at))

    def _on(self, part: str | None, body: str) -> bool:
        return any((mount.part, mount.body) == (part, body) for mount in self.mounts)

    def _pin(self, feature: PinEyes, joint: Pin) -> Pin:
        a, b = feature.a, feature.b  # in either order
        if self._on(a.part, joint.b.body) or self._on(b.part, joint.a.body):
            a, b = b, a
        new = replace(joint, a=self._placed(a, joint.a), b=self._placed(b, joint.b))
        shifts = (abs(new.a.at - joint.a.at), abs(new.b.at - joint.b.at))
        self._fit(joint.name, (a.diameter, b.diameter), (self._size(a), self._size(b)), shifts, (a, b), feature.pin, a.shaft)
        return new

    def _size(self, eye: Eye) -> float:
        return self.found.eyes[eye].diameter

    def _fit(
        self, joint: str, meant: tuple[float, float], made: tuple[float, float], shifts: tuple[float, float],
        eyes: Sequence[Eye], pin: Eye | None = None, shaft: bool = False,
    ) -> None:  # fmt: skip
        """Write down a joint's fit, from what its two sides measure, mm; shaft: the first of them is in the second."""

        def play(sizes: tuple[float, float], through: float) -> float:
            a, b = sizes
            return a + b - 2 * through if pin is not None else (b - a) * (1 if shaft else -1)

        now, was = (play(made, self._size(pin)), play(meant, pin.diameter)) if pin else (play(made, 0.0), play(meant, 0.0))
        misfit = abs(now - was) / (1 if pin is None else 2)  # a pin is in two holes, so their play counts by the half
        for eye in eyes:  # each hole's own size, and its centres at several heights
            found = self.found.eyes[eye]
            misfit = max(misfit, found.spread, abs(found.diameter - eye.diameter) if eye.part and eye.diameter else 0.0)
        self.fits[joint] = Fit(now, was, misfit, shifts)

    def _line(self, faces: Faces, place: Place, along: float) -> tuple[Place, float]:
        """The middle of two faces: where it crosses beside the place, square to the direction `along`, and its direction."""
        mount, found = self._mount(faces.part, place, faces.at), self.found.faces[faces]
        through = mount.place(faces.at + 1j * cmath.exp(1j * faces.angle) * found.offset)
        angle = mount.direction(faces.angle + found.lean)
        angle += round((along - angle) / math.pi) * math.pi
        meant, way = cmath.exp(1j * along), cmath.exp(1j * angle)
        reach = ((place.at - through) * meant.conjugate()).real / (way * meant.conjugate()).real
        return Place(place.body, through + reach * way), angle

    def _slide(self, feature: SlideFaces, joint: Slide) -> Slide:
        rails, runner = feature.rails, feature.runner
        if self._on(rails.part, joint.runner.body) and not self._on(rails.part, joint.guide.body):
            raise ValueError(f"{joint.name}: {rails.part} is mounted on its runner")
        guide, angle = self._line(rails, joint.guide, joint.angle)
        block, own = self._line(runner, joint.runner, joint.angle - joint.turn)
        found = (self.found.faces[rails].width, self.found.faces[runner].width)
        shifts = (abs(guide.at - joint.guide.at), abs(block.at - joint.runner.at))
        self._fit(joint.name, (rails.width, runner.width), found, shifts, ())
        return replace(joint, guide=guide, runner=block, angle=angle, turn=angle - own)

    def _slot(self, feature: SlotFaces, joint: Slot) -> Slot:
        guide, angle = self._line(feature.walls, joint.guide, joint.angle)
        runner = self._placed(feature.eye, joint.runner)
        walls, eye = feature.walls, feature.eye
        found = (self.found.faces[walls].width, self._size(eye))
        shifts = (abs(guide.at - joint.guide.at), abs(runner.at - joint.runner.at))
        self._fit(joint.name, (walls.width, eye.diameter), found, shifts, (eye,), feature.pin)
        return replace(joint, guide=guide, runner=runner, angle=angle)

    def _held(self, pin: str, body: str) -> tuple[complex, complex]:
        """Where a pin holds a body: in the body's frame and on the ground."""
        joint = self.joints[pin]
        assert isinstance(joint, Pin), f"{pin} is no pin"
        return (joint.a.at, joint.b.at) if joint.a.body == body else (joint.b.at, joint.a.at)

    def _cam(self, feature: CamOutline, joint: Cam) -> Cam:
        try:
            law = self._rolled(feature, joint)
        except ValueError as fault:
            raise ValueError(f"{joint.name}: {fault}") from None
        if not isinstance(joint.law, Rolled):
            return replace(joint, law=law)
        self.between.setdefault(joint.name, []).append(Between(joint.law, law, -feature.leaves))
        return joint

    def _rolled(self, feature: CamOutline, joint: Cam) -> Rolled:
        """What the follower rolls to on one outline."""
        own, centre = self._held(feature.turns, joint.cam)
        mounts = [mount for mount in self.mounts if (mount.part, mount.body) == (feature.part, joint.cam)]
        if len(mounts) <= feature.copy:
            raise ValueError(f"{feature.part} is not mounted on {joint.cam}")
        mount = mounts[feature.copy]
        turn = cmath.exp(1j * mount.turned) * (-1 if mount.flipped else 1)
        ring = self.found.rings[feature].moved(turn, mount.at - own, mirror=mount.flipped)
        ring = ring.moved(cmath.exp(1j * joint.phase))
        tip, facing, radius = self._tip(feature, joint)
        form: Form
        if feature.swings is not None:
            held, pivot = self._held(feature.swings, joint.follower)
            turned = cmath.exp(1j * joint.rest)
            arm, start = turned * (tip - held), pivot - centre
            if facing is None:
                form = ArmTip(start, arm, radius, feature.leaves, feature.inside)
            else:
                normal = -turned * facing
                form = ArmFace(start, normal, (normal.conjugate() * arm).real, feature.leaves)
            lever: float | None = abs(arm)
        else:
            assert joint.slide is not None
            slide = self.joints[joint.slide]
            assert isinstance(slide, Slide)
            along = cmath.exp(1j * slide.angle)
            start = slide.guide.at + along * joint.rest + cmath.exp(1j * slide.turn) * (tip - slide.runner.at) - centre
            lever = None
            if facing is None:
                form = SlideTip(start, along, radius, feature.leaves, feature.inside)
            else:
                form = SlideFace(start, along, feature.leaves)
        return Rolled(contact(ring, form), lever)

    def _tip(self, feature: CamOutline, joint: Cam) -> tuple[complex, complex | None, float]:
        """The follower's tip in its body's frame: its place, its face's direction, its radius, mm."""
        tip, body = feature.tip, joint.follower
        if isinstance(tip, Flat):
            face = self.found.flats[tip]
            mount = self._mount(tip.part, Place(body), tip.at)
            return mount.place(face.at), cmath.exp(1j * mount.direction(face.facing)), 0.0
        found = self.found.eyes[tip]
        radius = found.diameter / 2 if feature.radius is None else feature.radius
        if tip.part is None:
            return tip.at, None, radius
        return self._mount(tip.part, Place(body), tip.at).place(found.centre), None, radius

    def output(self, output: Output, marks: Sequence[Eye]) -> Output:
        """The output with its places where their marks are."""

        def seen(place: Place) -> Place:
            for eye in marks:
                for mount in self.mounts:
                    if (mount.part, mount.body) == (eye.part, place.body) and abs(mount.place(eye.at) - place.at) < SAME_POINT:
                        return self._placed(eye, place)
            return place

        of = output.of
        if isinstance(of, Path):
            return replace(output, of=Path(seen(of.of)))
        if isinstance(of, Function):
            return replace(output, of=replace(of, of=tuple(seen(place) for place in of.of)))
        return output
