"""What a machine is: bodies, joints, drives, loads, outputs. Records and nothing but data.

    body      a rigid link; its frame is its own, its points complex mm in it; the body "ground" stands still
    place     a point of a body, in the body's frame
    pose      where a body's frame is on the ground: ground = place + exp(i angle) * own
    joint     holds two bodies together: Pin, Slide, Slot, Gear, Cam, Clutch
    drive     says a body's angle, or a place along a slide, as a function of theta
    theta     the machine's independent variable, rad; it grows at the machine's speed, rad/s of either sign
    law       a callable (theta, order) -> (n,): value and derivatives to theta, order 0..2, for theta (n,) rad

Lengths mm, angles rad counter-clockwise, masses kg, inertia kg m^2, forces N, torques N m, time s.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeVar

import numpy as np

from camgen.errors import no_such
from camgen.numerics import Floats as Floats
from camgen.numerics import Points as Points

Law = Callable[[Floats, int], Floats]
# Where a cam is touched at its angles, (n,) rad: place, complex mm, and unit normal into the follower, in the cam's frame.
Touch = Callable[[Floats], tuple[Points, Points]]

GROUND = "ground"
MM = 1e-3  # m


@dataclass(frozen=True)
class Place:
    """A point of a body."""

    body: str
    at: complex = 0j  # mm in the body's frame


@dataclass(frozen=True)
class Pose:
    """Where a body's frame is; scalars, or (n,) each over the turn."""

    place: Any  # complex mm
    angle: Any  # rad


@dataclass(frozen=True)
class Body:
    """A rigid link."""

    name: str
    points: Mapping[str, complex] = field(default_factory=dict)  # mm in its frame
    mass: float = 0.0  # kg
    centre: complex = 0j  # of mass, mm in its frame
    inertia: float = 0.0  # about that centre, kg m^2

    def at(self, point: str) -> Place:
        """The named point as a place; ArgumentError where there is none."""
        if point not in self.points:
            raise no_such("point", point, list(self.points), self.name)
        return Place(self.name, complex(self.points[point]))


@dataclass(frozen=True)
class Pin:
    """A turning joint: both places coincide. Its reaction is the force of b on a, N."""

    name: str
    a: Place
    b: Place
    clearance: float = 0.0  # diametral, mm
    friction: float = 0.0  # radius of its friction circle, mm


@dataclass(frozen=True)
class Slide:
    """A straight guide on one body for another that does not turn in it.

    The runner's place lies on a line through the guide's place; its length along that line from there is the slide's place.
    """

    name: str
    guide: Place
    runner: Place
    angle: float = 0.0  # of the line in the guide's frame, rad
    turn: float = 0.0  # of the runner's frame to the guide's, rad
    clearance: float = 0.0  # across, mm
    friction: float = 0.0  # coefficient


@dataclass(frozen=True)
class Slot:
    """A pin of one body (runner) in a straight slot of another (guide), free to turn; the line as in a Slide."""

    name: str
    guide: Place
    runner: Place
    angle: float = 0.0  # of the line in the guide's frame, rad
    clearance: float = 0.0  # across, mm
    friction: float = 0.0  # coefficient


@dataclass(frozen=True)
class Gear:
    """Bodies that turn in proportion, both seen from the carrier: angle of b = ratio * angle of a + phase."""

    name: str
    a: str
    b: str
    ratio: float
    phase: float = 0.0  # rad
    carrier: str = GROUND
    clearance: float = 0.0  # backlash as an angle of b, rad


@dataclass(frozen=True)
class Cam:
    """A cam contact: the follower's angle, or its place along a slide, is s = rest + law(cam's angle - phase); angles are those
    to the ground. Of a linear cam the law's argument is the cam's place along the slide `over`, mm."""

    name: str
    cam: str
    follower: str
    law: Law  # rad, or mm along the slide
    slide: str | None = None
    phase: float = 0.0  # rad
    rest: float = 0.0  # rad or mm
    closure: Literal["form", "force"] = "form"  # force: the cam only pushes, the way it `leaves`
    leaves: int = 1  # +1 or -1, the sense of s that takes the follower off the cam
    clearance: float = 0.0  # lash of the follower, rad or mm
    touches: tuple[
        Touch, ...
    ] = ()  # where known: the first pushes the way it leaves, a second back
    friction: float = 0.0  # coefficient of what slides there
    over: str | None = None  # the slide of a cam that does not turn


@dataclass(frozen=True)
class Clutch:
    """Two freewheels on one shaft: b turns with a while a turns forwards, and is held on the ground while it does not."""

    name: str
    a: str
    b: str
    law: Law  # angle of b over theta, which grows from turn to turn, rad
    apart: Callable[[Floats], Floats]  # angle of b less that of a, (n,) rad; nan while b is held
    clearance: float = 0.0


Joint = Pin | Slide | Slot | Gear | Cam | Clutch


@dataclass(frozen=True)
class Turning:
    """The usual law of a drive: start + rate * theta."""

    rate: float = 1.0
    start: float = 0.0

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """The order-th derivative at theta, (n,)."""
        if order == 0:
            return self.start + self.rate * np.asarray(theta, float)
        return np.full(np.shape(theta), self.rate if order == 1 else 0.0)


@dataclass(frozen=True)
class Drive:
    """What moves the machine: the angle of a body to the ground, or its place along a slide or slot, as a law of theta."""

    name: str
    body: str
    law: Law = field(default_factory=Turning)  # rad, or mm along the slide
    slide: str | None = None
    motor: str | None = None  # name of what turns it, of several; all without one are on one shaft


@dataclass(frozen=True)
class Force:
    """A constant force on a place."""

    name: str
    on: Place
    force: complex  # N in the ground's frame


@dataclass(frozen=True)
class Torque:
    """A constant torque on a body, and its reverse on another."""

    name: str
    on: str
    torque: float  # N m
    by: str = GROUND


@dataclass(frozen=True)
class Spring:
    """A spring between two places: it pulls where it is longer than free, pushes where shorter."""

    name: str
    a: Place
    b: Place
    rate: float  # N/mm
    free: float = 0.0  # length, mm


@dataclass(frozen=True)
class TorsionSpring:
    """Torque rate * (angle of a - angle of b - free) draws a back."""

    name: str
    a: str
    b: str
    rate: float  # N m/rad
    free: float = 0.0  # rad


@dataclass(frozen=True)
class Gravity:
    """The same acceleration on all masses."""

    acceleration: complex = -9.80665j  # m/s^2


@dataclass(frozen=True)
class Angle:
    """The angle of a body to another, rad, continuous."""

    body: str
    on: str = GROUND


@dataclass(frozen=True)
class Along:
    """The place along the named slide or slot, mm."""

    slide: str


@dataclass(frozen=True)
class Resistance:
    """A force along a slide or torque on an angle, by the measure x and its speed v: force + law(x) - rate x - damping v -
    friction against v."""

    name: str
    of: Angle | Along
    force: float = 0.0  # N or N m, as law
    rate: float = 0.0  # N/mm or N m/rad
    damping: float = 0.0  # N s/mm or N m s/rad
    friction: float = 0.0  # N or N m, none at rest
    law: Callable[[Floats], Floats] | None = None
    wound: float = 0.0  # N or N m of the force, that a spring of that rate gives


@dataclass(frozen=True)
class Path:
    """The path of a place on the ground, complex mm."""

    of: Place


@dataclass(frozen=True)
class Function:
    """Any real function of places on the ground.

    value(*jets): jets are (order + 1, n) complex, each a place with its derivatives; returns (order + 1, n), the value
    with its derivatives. Called with unit derivatives it is its own gradient.
    """

    of: tuple[Place, ...]
    value: Callable[..., Floats]


@dataclass(frozen=True)
class Effort:
    """What acts on a measure as it grows, over theta."""

    name: str
    of: Angle | Along | Path | Function
    law: Law  # of order 0, N, or N m on an angle
    way: complex = 1 + 0j  # of the force on a path, unit vector of the ground
    turns: bool = False  # whether that way turns with the path's body
    moving: bool = False  # whether it acts the way that the measure moves, and not at rest


Load = Force | Torque | Spring | TorsionSpring | Gravity | Resistance | Effort


@dataclass(frozen=True)
class Output:
    """What is wanted and judged."""

    name: str
    of: Angle | Along | Path | Function
    unit: str = "mm"


def unit_of(output: Output) -> tuple[str, float]:
    """What people read an output in, and how many of it one unit of it is."""
    return ("deg", math.degrees(1)) if isinstance(output.of, Angle) else ("mm", 1.0)


def places_of(of: Angle | Along | Path | Function) -> tuple[Place, ...]:
    """The places that a measure sees."""
    return (of.of,) if isinstance(of, Path) else of.of if isinstance(of, Function) else ()


def placed(
    of: Angle | Along | Path | Function, at: Callable[[Place], Place]
) -> Angle | Along | Path | Function:
    """The same measure of other places."""
    if isinstance(of, Function):
        return replace(of, of=tuple(at(place) for place in of.of))
    return Path(at(of.of)) if isinstance(of, Path) else of


Named = (
    Body | Joint | Drive | Force | Torque | Spring | TorsionSpring | Resistance | Effort | Output
)
N = TypeVar("N", bound=Named)


def bodies_of(each: Joint | Drive | Load | Output) -> tuple[str, ...]:
    """Names of the bodies that a joint holds, a drive moves, a load is on or an output is of; of a slide that is named: none."""
    match each:
        case (
            Pin(a=Place() as a, b=b)
            | Spring(a=a, b=b)
            | Slide(guide=a, runner=b)
            | Slot(guide=a, runner=b)
        ):
            return a.body, b.body
        case Gear():
            return each.a, each.b, each.carrier
        case Cam():
            return each.cam, each.follower
        case Clutch():
            return each.a, each.b
        case Drive():
            return (each.body,)
        case Force():
            return (each.on.body,)
        case Torque():
            return each.on, each.by
        case TorsionSpring():
            return each.a, each.b
        case Resistance(of=Angle() as of) | Effort(of=Angle() as of) | Output(of=Angle() as of):
            return of.body, of.on
        case Effort(of=Path() as of) | Output(of=Path() as of):
            return (of.of.body,)
        case Effort(of=Function() as of) | Output(of=Function() as of):
            return tuple(place.body for place in of.of)
    return ()


def centres_of(joint: Joint) -> tuple[Place, ...]:
    """Places of a joint that are centres of a hole or a pin."""
    return (
        (joint.a, joint.b)
        if isinstance(joint, Pin)
        else (joint.runner,)
        if isinstance(joint, Slot)
        else ()
    )


def slide_of(each: Joint | Drive | Load | Output) -> str | None:
    """Name of the slide or slot along which a cam or drive moves its body, or a resistance or output is measured."""
    if isinstance(each, Cam | Drive):
        return each.slide
    return (
        each.of.slide
        if isinstance(each, Resistance | Effort | Output) and isinstance(each.of, Along)
        else None
    )


def _named(name: str, among: Sequence[N], what: str) -> N:
    match = next((each for each in among if each.name == name), None)
    if match is None:
        raise no_such(what, name, [each.name for each in among], "machine")
    return match


class NamedTwice(ValueError):
    """Bodies, joints, loads or outputs of a model with one name."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        super().__init__(f"named twice: {', '.join(names)}")


@dataclass(frozen=True, eq=False)
class Machine:
    """Bodies, joints, drives, loads, outputs; two machines are the same only where they are one object.

    Raises ValueError for a name used twice, a body or slide that is not there, or a body without a start.
    """

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    drives: tuple[Drive, ...]
    start: Mapping[
        str, Pose
    ]  # of each moving body at theta = 0, as drawn: the branch of every dyad
    loads: tuple[Load, ...] = ()
    outputs: tuple[Output, ...] = ()
    speed: float = 1.0  # d theta / dt, rad/s

    def __post_init__(self) -> None:
        bodies = [body.name for body in self.bodies]
        loads = [load for load in self.loads if not isinstance(load, Gravity)]
        for records in (self.bodies, (*self.joints, *self.drives), loads, self.outputs):
            names = [each.name for each in records]
            if len(set(names)) < len(names):
                raise NamedTwice(sorted({name for name in names if names.count(name) > 1}))
        slides = [joint.name for joint in self.joints if isinstance(joint, Slide | Slot)]
        known = {*bodies, GROUND}
        for each in (*self.joints, *self.drives, *loads, *self.outputs):
            for body in bodies_of(each):
                if body not in known:
                    raise ValueError(f"{each.name} is on {body}, which is no body")
            slide = slide_of(each)
            if slide is not None and slide not in slides:
                raise ValueError(f"{each.name} is along {slide}, which is no slide or slot")
        without_start = [body.name for body in self.moving if body.name not in self.start]
        if without_start:
            raise ValueError(f"without a start: {', '.join(without_start)}")

    @property
    def moving(self) -> tuple[Body, ...]:
        """All bodies but the ground."""
        return tuple(body for body in self.bodies if body.name != GROUND)

    def body(self, name: str) -> Body:
        """The named body; ValueError where there is none, here and below."""
        return _named(name, self.bodies if name != GROUND else (*self.bodies, Body(GROUND)), "body")

    def joint(self, name: str) -> Joint:
        """The named joint."""
        return _named(name, self.joints, "joint")

    def cam(self, name: str) -> Cam:
        """The named cam, or pair that turns by a law."""
        return _named(name, [joint for joint in self.joints if isinstance(joint, Cam)], "cam")

    def slide(self, name: str) -> Slide | Slot:
        """The named slide or slot."""
        return _named(
            name,
            [joint for joint in self.joints if isinstance(joint, Slide | Slot)],
            "slide or slot",
        )

    def output(self, name: str) -> Output:
        """The named output."""
        return _named(name, self.outputs, "output")

    def started(self, start: Mapping[str, Pose]) -> Machine:
        """The same with other poses of all its moving bodies at theta = 0; not checked again."""
        machine = copy(self)
        object.__setattr__(machine, "start", start)
        return machine

    def start_of(self, body: str) -> Pose:
        """The body's pose as drawn."""
        return Pose(0j, 0.0) if body == GROUND else self.start[body]
