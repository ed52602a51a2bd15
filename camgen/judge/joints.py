"""A machine with its joints where its features are: what the judge closes.

An eye counts with the centre of its circle, two faces with their middle line, a cam with what its follower rolls to on the
outline. What no file shows stays where it is meant.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike

from camgen.geometry.rings import Ring
from camgen.judge.contact import RollingContact, Touch, contact
from camgen.judge.contact_faces import ArmFace, SlideFace
from camgen.judge.contact_tips import ArmTip, Form, SlideTip
from camgen.judge.edge_contact import EdgeContact
from camgen.judge.edge_runs import GroundTip
from camgen.judge.edges import Engagement
from camgen.judge.measured import Readings
from camgen.judge.meshes import MeshedWheel, Meshing
from camgen.judge.pair_events import Slide as Sliding
from camgen.judge.pair_events import Turn
from camgen.judge.pawls import PawlMotion
from camgen.judge.pin_tracks import TrackedPins
from camgen.machine.features import (
    CamOutline,
    Demand,
    Edge,
    EdgePair,
    EngagedPair,
    Eye,
    Faces,
    Feature,
    Flat,
    GearTeeth,
    Mark,
    Mount,
    PawlPair,
    PinEyes,
    SharedFlat,
    SlideFaces,
    SlotFaces,
    Steady,
    Teeth,
)
from camgen.machine.model import (
    GROUND,
    Cam,
    Gear,
    Joint,
    Machine,
    Output,
    Pin,
    Place,
    Slide,
    Slot,
    Turning,
    centres_of,
    placed,
)
from camgen.numerics import ASKED, Floats, latest
from camgen.tolerances import SAME_POINT

STILL = Turning(0.0)  # law of a follower that stands still
_STEEP = 0.25  # cosine of a pressure angle (75 deg) that no cam is meant to reach, so that a wrong one widens no limit
_PLATE_CHORD = 1e-5  # mm, by which chords lie off a plate's arcs as they are run over
_PLATE_STEP = 1e-5  # mm, over which the slope along a plate is taken
_SLOPE = 1e-6  # rad of cam angle, over which the slope of a rolled motion is taken: shorter than any facet


@dataclass(frozen=True)
class RollingLaw:
    """A cam's law as its follower rolls: theta is the cam's angle less the phase; s in rad, or mm where it slides.

    arm: mm, None where it slides; least: way of the tip square to the outline per unit of s, mm, where it is known; middle: of
    a face, as `contact.Touch` counts places on it. turn, shift: from the part's frame to the contact's at theta = 0, of a part
    that is not turned over.
    """

    contact: RollingContact | EdgeContact
    arm: float | None
    least: float | None = None
    middle: float = 0.0
    turn: complex = 1 + 0j
    shift: complex = 0j

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """s at theta, (n,), or its derivative."""
        if order > 1:
            return np.zeros(
                np.shape(theta)
            )  # a facet has none; only the start of Newton's method asks for it
        return self._slopes(theta) if order else self._angles(theta)

    @cached_property
    def _angles(self) -> Callable[[ArrayLike], Floats]:
        return latest(self.contact.angle, ASKED)

    @cached_property
    def _slopes(self) -> Callable[[ArrayLike], Floats]:
        return latest(self._slope, ASKED)

    def _slope(self, theta: Floats) -> Floats:
        if isinstance(self.contact, EdgeContact):
            return self.contact.slope(theta)
        return np.asarray(
            (self.contact.angle(theta + _SLOPE) - self.contact.angle(theta - _SLOPE)) / (2 * _SLOPE)
        )

    def lever(self, theta: Floats) -> Floats:
        """Way of the tip square to the outline per unit of s, (n,) mm; of one that is too steep to be meant as if it were not."""
        if self.least is not None:
            return np.full(theta.shape, self.least)
        touch = self.contact.touch(theta)
        arm = self.arm or 1.0
        if self.arm is not None and isinstance(self.contact.form, ArmFace):
            return np.maximum(np.abs(touch.place), _STEEP * arm)
        return np.asarray(arm * np.maximum(np.cos(touch.pressure_angle), _STEEP))


@dataclass(frozen=True, eq=False)
class PlateLaw:
    """A cam's law as its follower runs along the edge of a plate that slides: x is the plate's place less the phase, mm; s in rad, or
    mm where it slides.

    ring: of the plate on the ground at x = 0, its edges straight; span: of x, that is judged.
    """

    ring: Ring
    tip: GroundTip
    span: tuple[float, float]

    def __call__(self, x: Floats, order: int = 0) -> Floats:
        """s at x, (n,), or its derivative."""
        if order > 1:
            return np.zeros(np.shape(x))
        return self._slopes(x) if order else self._places(x)

    @cached_property
    def _places(self) -> Callable[[ArrayLike], Floats]:
        return latest(lambda x: self.tip.run(self.ring, np.asarray(x, float), _PLATE_CHORD), ASKED)

    @cached_property
    def _slopes(self) -> Callable[[ArrayLike], Floats]:
        return latest(
            lambda x: (self(x + _PLATE_STEP) - self(x - _PLATE_STEP)) / (2 * _PLATE_STEP), ASKED
        )

    middle = 0.0

    @property
    def contact(self) -> PlateLaw:
        """Itself: it has touches."""
        return self

    def angle(self, x: Floats) -> Floats:
        """s at x, (n,)."""
        return self(x)

    def touch(self, x: Floats) -> Touch:
        """s and the pressure angle at x, (n,)."""
        s = self(x)
        steep = self.tip.pressure_angle(s, self(x, 1))
        none = np.full(np.shape(x), np.nan)
        return Touch(s, steep, np.zeros(np.shape(x), np.int64), none)

    @property
    def changes(self) -> Floats:
        """Places at which the touch goes from one edge to the next: none is told."""
        return np.empty(0)

    def lever(self, x: Floats) -> Floats:
        """Way of the tip square to the edge per unit of s, (n,) mm; of one that is too steep to be meant as if it were not."""
        arm = abs(self.tip.way) if self.tip.swings else 1.0
        return np.asarray(arm * np.maximum(np.cos(self.touch(x).pressure_angle), _STEEP))


@dataclass(frozen=True)
class Fit:
    """How a joint fits, mm."""

    play: float  # as measured
    nominal: float  # the play that is wanted
    misfit: float  # how much the worst of its features is off
    shifts: tuple[float, float] = (0.0, 0.0)  # of each side
    parts: tuple[str, str] = ("", "")  # of each side, "" where it is none


@dataclass(frozen=True)
class Outline:
    """A cam's outline as measured: what its follower does on it, by itself (`law`, the tip larger by what it is meant to stay
    off) and as wide as it is (`tight`); own: with the tip that a part has, None where no tip was found."""

    feature: CamOutline
    law: RollingLaw | PlateLaw
    tight: RollingLaw | PlateLaw
    own: RollingLaw | PlateLaw | None = None

    def play(self, other: Outline, theta: Floats) -> Floats:
        """Way of the follower from this outline to another one, rad or mm, (n,); below 0 they are in each other's way."""
        return np.asarray(self.feature.leaves * (other.tight(theta) - self.tight(theta)))


@dataclass(frozen=True)
class Nominal:
    """A machine as it is meant: what its files are measured against."""

    machine: Machine
    features: Sequence[Feature]  # of its parts, that make its joints
    mounts: Sequence[Mount]
    demands: Sequence[Demand] = ()  # more than the motion, by output


@dataclass(frozen=True)
class Closable:
    """The machine as measured; the fit of each joint that was, and the outlines of each cam, the one that drives first.

    meshings: of each Gear its wheels, of planets that are alike those of the first; engagements: of each Cam its edges, where these
    have any shape; pawls: of each ratchet wheel and pawl.
    """

    machine: Machine
    fits: Mapping[str, Fit]
    outlines: Mapping[str, Sequence[Outline]]
    meshings: Mapping[str, Meshing]
    engagements: Mapping[str, Engagement]
    pawls: Mapping[str, PawlMotion]


def measured_machine(
    machine: Machine, features: Sequence[Feature], mounts: Sequence[Mount], readings: Readings
) -> Closable:
    """The machine with its joints and outputs where the features are.

    ValueError, with the joint's name, where a feature's part stands on neither of its bodies, or a follower misses its cam.
    """
    builder = _Builder(machine, mounts, mounts_on_flats(features, mounts, readings), readings)
    for kind in (
        PinEyes,
        Steady,
        SlideFaces,
        SlotFaces,
        CamOutline,
        GearTeeth,
        EdgePair,
    ):  # cams and gears ask for the pins that hold them
        for feature in features:
            if isinstance(feature, kind):
                builder.put(feature)
    marks = [feature.eye for feature in features if isinstance(feature, Mark)]
    outputs = tuple(builder.output(output, marks) for output in machine.outputs)
    joints = tuple(builder.joints[joint.name] for joint in machine.joints)
    return Closable(
        replace(machine, joints=joints, outputs=outputs),
        builder.fits,
        builder.outlines,
        builder.meshings,
        builder.engagements,
        builder.pawls,
    )


@lru_cache(maxsize=4)  # a machine is the same object for all kinds of its files
def at_rest(machine: Machine, joints: frozenset[str]) -> Machine:
    """The machine with the followers of some cams at rest."""
    if not joints:
        return machine
    return replace(
        machine,
        joints=tuple(
            replace(each, law=STILL) if isinstance(each, Cam) and each.name in joints else each
            for each in machine.joints
        ),
    )


def mounts_on_flats(
    features: Sequence[Feature], mounts: Sequence[Mount], readings: Readings
) -> list[Mount]:
    """The mounts, those of parts on a pin with a flat where its holes and flats, as found, put them."""
    keyed_mounts = list(mounts)
    for feature in (feature for feature in features if isinstance(feature, SharedFlat)):
        first = {mount.body: k for k, mount in enumerate(mounts) if mount.part == feature.a.part}
        second = {mount.body: k for k, mount in enumerate(mounts) if mount.part == feature.b.part}
        (a, b) = readings.facing[feature]
        for body in first.keys() & second.keys():  # both sides of a machine may have them
            on = keyed_mounts[first[body]]
            n = second[body]
            free = replace(keyed_mounts[n], at=0j, angle=0.0)
            turned = replace(free, angle=on.direction(a) - free.direction(b))
            centre = on.place(readings.eyes[feature.a].centre)
            keyed_mounts[n] = replace(
                turned, at=centre - turned.place(readings.eyes[feature.b].centre)
            )
    return keyed_mounts


@dataclass(frozen=True)
class _Side:
    """One of the two features that a joint fits together."""

    part: str | None
    nominal: float  # its size, mm
    size: float  # as measured, mm
    shift: float  # of its centre, mm


class _Builder:
    """Joints, put one by one where their features are."""

    def __init__(
        self,
        machine: Machine,
        mounts: Sequence[Mount],
        keyed_mounts: Sequence[Mount],
        readings: Readings,
    ) -> None:
        self.machine = machine
        self.mounts = mounts
        self.made = dict(zip(mounts, keyed_mounts, strict=True))
        self.found = readings
        self.joints = {joint.name: joint for joint in machine.joints}
        self.nominal = {joint.name: joint for joint in machine.joints if isinstance(joint, Pin)}
        self.fits: dict[str, Fit] = {}
        self.outlines: dict[str, list[Outline]] = {}
        self.meshings: dict[str, Meshing] = {}
        self.engagements: dict[str, Engagement] = {}
        self.pawls: dict[str, PawlMotion] = {}

    def put(
        self,
        feature: PinEyes | Steady | SlideFaces | SlotFaces | CamOutline | GearTeeth | EdgePair,
    ) -> None:
        """Put the feature's joint where it is."""
        if isinstance(feature, GearTeeth) and feature.implied is not None:
            self._gear(feature, feature.implied)
            return
        if isinstance(feature, EngagedPair) and feature.implied is not None:
            self._engaged_pair(feature, feature.implied)
            return
        joint = self.joints[feature.joint]
        match feature, joint:
            case Steady(), Pin():
                self._steady(feature, joint)
                new: Joint = joint
            case PinEyes(), Pin():
                new = self._pin(feature, joint)
            case SlideFaces(), Slide():
                new = self._slide(feature, joint)
            case SlotFaces(), Slot():
                new = self._slot(feature, joint)
            case CamOutline(), Cam():
                self._cam(feature, joint)
                new = joint
            case GearTeeth(), Gear():
                new = self._gear(feature, joint)
            case PawlPair(), Cam():
                self._pawl_pair(feature, joint)
                new = replace(joint, law=STILL)
            case EngagedPair(), Cam():
                new = self._engaged_pair(feature, joint)
            case _:
                raise ValueError(f"{joint.name} is no joint for {type(feature).__name__}")
        self.joints[feature.joint] = new

    def _mount(self, part: str, place: Place, at: complex) -> Mount:
        """The copy of the part on the place's body whose point `at` is nearest to it."""
        mounts = [mount for mount in self.mounts if (mount.part, mount.body) == (part, place.body)]
        if not mounts:
            raise ValueError(f"{part} is not mounted on {place.body}")
        return min(mounts, key=lambda mount: abs(mount.place(at) - place.at))

    def _place_of(self, eye: Eye, place: Place) -> Place:
        """The place moved to where its eye was found."""
        if eye.part is None:
            return place
        mount = self._mount(eye.part, place, eye.at)
        return Place(
            place.body,
            place.at + self.made[mount].place(self.found.eyes[eye].centre) - mount.place(eye.at),
        )

    def _on(self, part: str | None, body: str) -> bool:
        """Whether a part stands on a body, as what no file shows may."""
        return part is None or any(
            (mount.part, mount.body) == (part, body) for mount in self.mounts
        )

    def _pin(self, feature: PinEyes, joint: Pin) -> Pin:

        def fits(a: Eye, b: Eye) -> bool:
            return self._on(a.part, joint.a.body) and self._on(b.part, joint.b.body)

        a = feature.a
        b = feature.b
        # in either order
        if not fits(a, b) and fits(b, a):
            a, b = b, a
        new = replace(joint, a=self._place_of(a, joint.a), b=self._place_of(b, joint.b))
        rings = sum(ring.outside - ring.bore for ring in feature.rings)
        sides = (
            _Side(a.part, a.diameter - rings, self._size(a) - rings, abs(new.a.at - joint.a.at)),
            _Side(b.part, b.diameter, self._size(b), abs(new.b.at - joint.b.at)),
        )
        self._fit(joint.name, sides, (a, b), feature.pin, a.shaft)
        return new

    def _steady(self, feature: Steady, joint: Pin) -> None:
        """How far the far end is off the joint's axis is a misfit of the joint, and so are sizes there."""
        eyes = self.found.eyes
        ground = joint.a if joint.a.body == GROUND else joint.b
        shifts = [self._place_of(eye, ground).at - ground.at for eye in (feature.near, feature.far)]
        off = abs(shifts[1] - shifts[0])
        if feature.webs is not None:
            body = joint.b if ground is joint.a else joint.a
            low, high = (
                self.made[self._mount(eye.part or "", body, eye.at)].place(eyes[eye].centre)
                for eye in feature.webs
            )
            off += abs(high - low)
        sizes = [abs(eyes[eye].diameter - eye.diameter) for eye in (feature.far, feature.pin)]
        fit = self.fits[feature.joint]
        self.fits[feature.joint] = replace(
            fit, misfit=max(fit.misfit, off, *sizes, eyes[feature.far].spread)
        )

    def _size(self, eye: Eye) -> float:
        return self.found.eyes[eye].diameter

    def _fit(
        self,
        joint: str,
        sides: tuple[_Side, _Side],
        eyes: Sequence[Eye] = (),
        pin: Eye | None = None,
        shaft: bool = False,
    ) -> None:
        """Write down a joint's fit, from what its two sides measure, mm; shaft: the first of them is in the second."""

        def play(a: float, b: float, through: float | None) -> float:
            return (b - a) * (1 if shaft else -1) if through is None else a + b - 2 * through

        a, b = sides
        measured_play = play(a.size, b.size, self._size(pin) if pin else None)
        nominal_play = play(a.nominal, b.nominal, pin.diameter if pin else None)
        misfit = abs(measured_play - nominal_play) / (
            1 if pin is None else 2
        )  # a pin is in two holes, so their play counts by the half
        for eye in eyes:  # each hole's own size, and its centres at several heights
            reading = self.found.eyes[eye]
            misfit = max(
                misfit,
                reading.spread,
                abs(reading.diameter - eye.diameter) if eye.part and eye.diameter else 0.0,
            )
        self.fits[joint] = Fit(
            measured_play, nominal_play, misfit, (a.shift, b.shift), (a.part or "", b.part or "")
        )

    def _line(self, faces: Faces, place: Place, along: float) -> tuple[Place, float]:
        """The middle of two faces: where it crosses beside the place, square to the direction `along`, and its direction."""
        mount = self._mount(faces.part, place, faces.at)
        reading = self.found.faces[faces]
        through = mount.place(faces.at + 1j * cmath.exp(1j * faces.angle) * reading.offset)
        angle = mount.direction(faces.angle + reading.lean)
        angle += round((along - angle) / math.pi) * math.pi
        nominal_way = cmath.exp(1j * along)
        way = cmath.exp(1j * angle)
        distance = ((place.at - through) * nominal_way.conjugate()).real / (
            way * nominal_way.conjugate()
        ).real
        return Place(place.body, through + distance * way), angle

    def _slide(self, feature: SlideFaces, joint: Slide) -> Slide:
        rails = feature.rails
        runner = feature.runner
        if self._on(rails.part, joint.runner.body) and not self._on(rails.part, joint.guide.body):
            raise ValueError(f"{joint.name}: {rails.part} is mounted on its runner")
        guide, angle = self._line(rails, joint.guide, joint.angle)
        block, runner_angle = self._line(runner, joint.runner, joint.angle - joint.turn)
        faces = self.found.faces
        sides = (
            _Side(rails.part, rails.width, faces[rails].width, abs(guide.at - joint.guide.at)),
            _Side(runner.part, runner.width, faces[runner].width, abs(block.at - joint.runner.at)),
        )
        self._fit(joint.name, sides)
        return replace(joint, guide=guide, runner=block, angle=angle, turn=angle - runner_angle)

    def _slot(self, feature: SlotFaces, joint: Slot) -> Slot:
        guide, angle = self._line(feature.walls, joint.guide, joint.angle)
        runner = self._place_of(feature.eye, joint.runner)
        walls = feature.walls
        eye = feature.eye
        width = self.found.faces[walls].width
        sides = (
            _Side(walls.part, walls.width, width, abs(guide.at - joint.guide.at)),
            _Side(eye.part, eye.diameter, self._size(eye), abs(runner.at - joint.runner.at)),
        )
        self._fit(joint.name, sides, (eye,), feature.pin)
        return replace(joint, guide=guide, runner=runner, angle=angle)

    def _pin_places(self, pin: str, body: str) -> tuple[complex, complex]:
        """Where a pin holds a body: in the body's frame and on the ground."""
        joint = self.joints[pin]
        assert isinstance(joint, Pin), f"{pin} is no pin"
        return (joint.a.at, joint.b.at) if joint.a.body == body else (joint.b.at, joint.a.at)

    def _cam(self, feature: CamOutline, joint: Cam) -> None:
        """Its joint stays: which outline drives is said later."""
        if isinstance(feature.tip, Edge):
            edge = self._edge_law(feature, joint, feature.tip)
            self.outlines.setdefault(joint.name, []).append(Outline(feature, edge, edge))
            return
        try:
            tip, facing, radius = self._tip(feature, joint)
            law: RollingLaw | PlateLaw
            tight: RollingLaw | PlateLaw
            law = tight = self._rolling_law(feature, joint, tip, facing, radius, feature.free)
            if feature.free:
                tight = self._rolling_law(feature, joint, tip, facing, radius, 0.0)
        except ValueError as fault:
            raise ValueError(f"{joint.name}: {fault}") from None
        outlines = self.outlines.setdefault(joint.name, [])
        outlines.append(Outline(feature, law, tight, self._own(feature, joint)))

    def _gear(self, feature: GearTeeth, joint: Gear) -> Gear:
        """A pair whose teeth lie in each other's gaps on the line of their axes, with the play that is left there."""
        meant_axes = []
        axes = []
        wheels = []
        for teeth, pin, body in zip(
            (feature.a, feature.b), feature.turns, (joint.a, joint.b), strict=True
        ):
            meant, place = self._axle(pin, body, joint.carrier)
            meant_axes.append(meant)
            axes.append(place)
            wheels.append(self._wheel(joint.name, teeth, pin, body))
        line = axes[1] - axes[0]
        lean = cmath.phase(line / (meant_axes[1] - meant_axes[0]))
        start = joint.phase + (1 - joint.ratio) * lean
        radius = feature.b.radius
        base = radius * math.cos(feature.pressure)
        meshing = Meshing(joint.name, wheels[0], wheels[1], line, joint.ratio, start, base)
        twin = next((each for each in self.meshings.values() if each.alike(meshing)), None)
        lead = (twin or meshing).lead
        space = 2 * math.pi * radius / feature.b.count
        meant = space - feature.a.thickness - feature.b.thickness
        play = radius * (twin or meshing).play
        # each wheel answers for one half, square to its flanks: as far as its outline may lie off
        misfit = abs(play - meant) / 2 * math.cos(feature.pressure)
        if twin is None:
            self.meshings[joint.name] = meshing
        if feature.implied is None:  # what follows from other joints limits no output further
            self.fits[joint.name] = Fit(play, meant, misfit)
        return replace(joint, phase=start + lead)

    def _axle(self, pin: str, body: str, carrier: str) -> tuple[complex, complex]:
        """Where a pin holds a body on its carrier, meant and measured, in that one's frame; both may turn on the ground there."""
        sides = (self.nominal[pin].a, self.nominal[pin].b)
        meant = next(side for side in sides if side.body != body)
        place = self._pin_places(pin, body)[1]
        if meant.body == carrier:
            return meant.at, place
        for name, other in self.nominal.items():
            held = {side.body: side.at for side in (other.a, other.b)}
            if held.keys() == {GROUND, carrier} and abs(held[GROUND] - meant.at) < SAME_POINT:
                return held[carrier], self._pin_places(name, carrier)[0]
        raise ValueError(f"{pin}: {body} and {carrier} have no axis in common")

    def _wheel(self, joint: str, teeth: Teeth, pin: str, body: str) -> MeshedWheel:
        """A wheel on its body, about the pin that holds it."""
        if not self._on(teeth.part, body):
            raise ValueError(f"{joint}: {teeth.part} is not mounted on {body}")
        pivot = self._pin_places(pin, body)[0]
        mount = self.made[self._mount(teeth.part, Place(body, pivot), 0j)]
        return MeshedWheel(teeth, self.found.wheels[teeth], mount, pivot)

    def _engaged_pair(self, feature: EngagedPair, joint: Cam) -> Cam:
        """A pair whose follower goes where the edges let it."""
        spin, carried = feature.rates
        driver = joint.cam if spin else GROUND
        a = self._edges(feature.a, driver, feature.turns)
        b = self._edges(feature.b, joint.follower, feature.swings)
        axes = [
            self._axle(pin, body, feature.carrier)[1]
            for pin, body in ((feature.turns, driver), (feature.swings, joint.follower))
        ]
        # where all stand at the joint's angle 0
        begin = joint.phase - self.machine.start_of(joint.cam).angle
        turned = self.machine.start_of(feature.carrier).angle + carried * begin
        kind = Engagement if feature.tracks is None else TrackedPins
        engagement = kind(
            feature,
            tuple(ring.moved(cmath.exp(1j * spin * joint.phase)) for ring in a),
            tuple(ring.moved(cmath.exp(1j * joint.rest)) for ring in b),
            (axes[1] - axes[0]) * cmath.exp(1j * turned),
            joint.law,
        )
        worst = engagement.worst_gap
        # each body answers for one half
        off = abs(worst.gap - worst.meant) / 2
        parts = worst.driver, worst.driven
        if feature.implied is None:  # what follows from other joints limits no output further
            self.fits[joint.name] = Fit(worst.gap, worst.meant, off, parts=parts)
        self.engagements[joint.name] = engagement
        return replace(joint, law=engagement)

    def _pawl_pair(self, feature: PawlPair, joint: Cam) -> None:
        """A wheel and its pawl, which is judged by itself: nothing hangs on it, and no step of Newton's method goes past a fall."""
        (wheel,) = self._edges(feature.a, joint.cam, feature.turns)
        (pawl,) = self._edges(feature.b, joint.follower, feature.swings)
        axes = [
            self._pin_places(pin, body)[1]
            for pin, body in ((feature.turns, joint.cam), (feature.swings, joint.follower))
        ]
        self.pawls[joint.name] = PawlMotion(
            feature,
            wheel.moved(cmath.exp(1j * joint.phase)),
            pawl.moved(cmath.exp(1j * joint.rest)),
            axes[1] - axes[0],
            joint.law,
            self.machine.start_of(joint.cam).angle - joint.phase,
        )

    def _edges(self, edges: Sequence[Edge], body: str, pin: str) -> list[Ring]:
        """Those of a body that a pin holds."""
        pivot = self._pin_places(pin, body)[0]
        return [self._edge(edge, body, self.nominal[pin], pivot) for edge in edges]

    def _edge(self, edge: Edge, body: str, pin: Pin, pivot: complex) -> Ring:
        """An edge about the pivot of its body, in the body's axes, with its bore on its axis; pin: the nominal one."""
        meant = pin.a.at if pin.a.body == body else pin.b.at
        axis = pivot
        if edge.seat is not None:
            near = min(
                (
                    mount
                    for mount in self.mounts
                    if (mount.part, mount.body) == (edge.seat.part, body)
                ),
                key=lambda mount: abs(mount.place(edge.seat.at) - meant),  # type: ignore[union-attr]
            )
            meant = near.place(edge.seat.at)
            axis = self.made[near].place(self.found.eyes[edge.seat].centre)
        mount = self.made[self._mount(edge.part, Place(body, meant), edge.bore.at)]
        shift = mount.at + axis - mount.place(self.found.eyes[edge.bore].centre) - pivot
        turn = cmath.exp(1j * mount.angle) * (-1 if mount.flipped else 1)
        return self.found.edges[edge].moved(turn, shift, mirror=mount.flipped)

    def _own(self, feature: CamOutline, joint: Cam) -> RollingLaw | PlateLaw | None:
        """What the follower's own tip rolls to; None where it is lost or does not fit the cam."""
        own = feature.own
        eyes = self.found.eyes
        if own is None or own.tip not in eyes or feature.swings is None:
            return None
        mount = self._mount(own.part, Place(joint.follower), own.tip.at)
        tip = (
            mount.place(eyes[own.tip].centre)
            - mount.place(eyes[own.bore].centre)
            + mount.place(own.bore.at)
        )
        radius = eyes[own.tip].diameter / 2 if own.radius is None else own.radius
        try:
            return self._rolling_law(feature, joint, tip, None, radius, feature.free)
        except ValueError:
            return None

    def _rolling_law(
        self,
        feature: CamOutline,
        joint: Cam,
        tip: complex,
        facing: complex | None,
        radius: float,
        air: float,
    ) -> RollingLaw | PlateLaw:
        """What a follower with this tip, so much larger, mm, rolls to on one outline."""
        radius += air
        if joint.over is not None:
            return self._plate_law(feature, joint, tip, radius)
        centre = self._pin_places(feature.turns, joint.cam)[1]
        ring, turn, shift = self._turning(feature, joint)
        form: Form
        if feature.swings is not None:
            axle, pivot = self._pin_places(feature.swings, joint.follower)
            rest = cmath.exp(1j * joint.rest)
            arm = rest * (tip - axle)
            start = pivot - centre
            middle = 0.0
            if facing is None:
                form = ArmTip(start, arm, radius, feature.leaves, feature.inside)
            else:
                normal = -rest * facing
                foot = normal.conjugate() * arm
                form = ArmFace(start, normal, foot.real - air, feature.leaves)
                middle = foot.imag
            lever: float | None = abs(arm)
        else:
            start, along = self._sliding(joint, tip)
            start -= centre
            lever = None
            middle = 0.0
            if facing is None:
                form = SlideTip(start, along, radius, feature.leaves, feature.inside)
            else:
                form = SlideFace(start - air * feature.leaves * along, along, feature.leaves)
        return RollingLaw(contact(ring, form), lever, feature.nominal.lever, middle, turn, shift)

    def _plate_law(self, feature: CamOutline, joint: Cam, tip: complex, radius: float) -> PlateLaw:
        """What a follower with this round tip runs to along a plate's edge."""
        assert joint.over is not None and feature.way is not None
        slide = self.joints[joint.over]
        assert isinstance(slide, Slide)
        travel = cmath.exp(1j * slide.angle)
        turn = cmath.exp(1j * slide.turn)
        place = slide.guide.at + joint.phase * travel - turn * slide.runner.at
        mount = next(
            each for each in self.mounts if (each.part, each.body) == (feature.part, joint.cam)
        )
        ring = self.found.rings[feature]
        ring = ring.moved(cmath.exp(1j * mount.angle), mount.at).moved(turn, place)
        if feature.swings is not None:
            axle, start = self._pin_places(feature.swings, joint.follower)
            way = cmath.exp(1j * joint.rest) * (tip - axle)
        else:
            start, way = self._sliding(joint, tip)
        points = ring.facetted(_PLATE_CHORD)
        swings = feature.swings is not None
        ground = GroundTip(radius, start, way, swings, feature.leaves, travel)
        return PlateLaw(Ring.straight(points), ground, feature.way)

    def _turning(self, feature: CamOutline, joint: Cam) -> tuple[Ring, complex, complex]:
        """A cam's outline about its shaft at theta = 0, and how it is turned and then shifted there from its part's frame."""
        own = self._pin_places(feature.turns, joint.cam)[0]
        mounts = [
            mount for mount in self.mounts if (mount.part, mount.body) == (feature.part, joint.cam)
        ]
        if len(mounts) <= feature.copy:
            raise ValueError(f"{feature.part} is not mounted on {joint.cam}")
        mount = mounts[feature.copy]
        if feature.bore is not None:
            own += mount.place(self.found.eyes[feature.bore].centre) - mount.place(feature.bore.at)
        turn = cmath.exp(1j * mount.angle) * (-1 if mount.flipped else 1)
        turn = turn * cmath.exp(1j * joint.phase)
        shift = (mount.at - own) * cmath.exp(1j * joint.phase)
        return self.found.rings[feature].moved(turn, shift, mirror=mount.flipped), turn, shift

    def _sliding(self, joint: Cam, point: complex) -> tuple[complex, complex]:
        """Where a point of a follower that slides is on the ground at s = 0, and the way of its slide."""
        assert joint.slide is not None
        slide = self.joints[joint.slide]
        assert isinstance(slide, Slide)
        along = cmath.exp(1j * slide.angle)
        way = cmath.exp(1j * slide.turn) * (point - slide.runner.at)
        return slide.guide.at + along * joint.rest + way, along

    def _edge_law(self, feature: CamOutline, joint: Cam, tip: Edge) -> RollingLaw:
        """What a follower with an outline of any shape rolls to."""
        centre = self._pin_places(feature.turns, joint.cam)[1]
        ring, turn, shift = self._turning(feature, joint)
        mount = self.made[self._mount(tip.part, Place(joint.follower), tip.bore.at)]
        on_body = cmath.exp(1j * mount.angle) * (-1 if mount.flipped else 1)
        shoe = self.found.edges[tip].moved(on_body, mount.at, mirror=mount.flipped)
        freedom: Turn | Sliding = Turn()
        if feature.swings is not None:
            axle, pivot = self._pin_places(feature.swings, joint.follower)
            shoe = shoe.moved(cmath.exp(1j * joint.rest)).moved(
                shift=-axle * cmath.exp(1j * joint.rest)
            )
            apart = pivot - centre
        else:
            start, along = self._sliding(joint, 0j)
            way, _ = self._sliding(joint, 1 + 0j)
            shoe = shoe.moved(way - start, start - centre)
            freedom = Sliding(along)
            apart = 0j
        contact = EdgeContact(ring, shoe, apart, freedom, feature.leaves, joint.law)
        # cam and shoe may both be off
        least = None if feature.nominal.lever is None else feature.nominal.lever / 2
        return RollingLaw(contact, None, least, 0.0, turn, shift)

    def _tip(self, feature: CamOutline, joint: Cam) -> tuple[complex, complex | None, float]:
        """The follower's tip in its body's frame: its place, its face's direction, its radius, mm."""
        tip = feature.tip
        assert not isinstance(tip, Edge)
        body = joint.follower
        if isinstance(tip, Flat):
            face = self.found.flats[tip]
            if tip.part is None:
                return tip.at, cmath.exp(1j * tip.facing), 0.0
            mount = self._mount(tip.part, Place(body), tip.at)
            return mount.place(face.at), cmath.exp(1j * mount.direction(face.facing)), 0.0
        reading = self.found.eyes[tip]
        radius = reading.diameter / 2 if feature.radius is None else feature.radius
        if tip.part is None:
            return tip.at, None, radius
        return self._mount(tip.part, Place(body), tip.at).place(reading.centre), None, radius

    def output(self, output: Output, marks: Sequence[Eye]) -> Output:
        """The output with its places where the eyes of joints, or their marks, are."""

        def measured_place(place: Place) -> Place:
            for nominal, joint in zip(self.machine.joints, self.joints.values(), strict=True):
                for side, measured in zip(centres_of(nominal), centres_of(joint), strict=True):
                    if side.body == place.body and abs(side.at - place.at) < SAME_POINT:
                        return measured
            for eye in marks:
                for mount in self.mounts:
                    if (mount.part, mount.body) == (eye.part, place.body) and abs(
                        mount.place(eye.at) - place.at
                    ) < SAME_POINT:
                        return self._place_of(eye, place)
            return place

        return replace(output, of=placed(output.of, measured_place))
