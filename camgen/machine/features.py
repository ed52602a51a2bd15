"""What a machine is to those that judge its files. Data alone: features that make its joints, parts on bodies, demands.

    eye       a round feature of a part: a hole, or the rim of a disc that is itself the pin (`shaft`)
    faces     two parallel straight faces of a part: rails, the walls of a slot, a runner
    outline   what a cam's follower runs on
    teeth     of a wheel: where its outline crosses the pitch circle
    edge      outline of a part that those of another body touch, whatever their shapes
    mount     where a part stands on its body: body = at + exp(i angle) * part
    stand-in  a thing that is not made but in the way

Places and diameters here are nominal, mm in the part's frame; the judge reads the true ones from each file.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from camgen.machine.model import Cam, Gear, Law, Output, Pose
from camgen.numerics import Floats

if TYPE_CHECKING:
    from camgen.machine.targets import Advance, Target


T = TypeVar("T")


def mapped(record: T, change: Callable[[str, Any], Any]) -> T:
    """A record with change(key, value) in place of its values, of those in tuples one by one."""

    def each(key: str, value: Any) -> Any:
        return (
            tuple(each(key, one) for one in value)
            if isinstance(value, tuple)
            else change(key, value)
        )

    keys = (key.name for key in fields(record))  # type: ignore[arg-type]
    return replace(record, **{key: each(key, getattr(record, key)) for key in keys})  # type: ignore[type-var]


@dataclass(frozen=True)
class Eye:
    """A hole, or the rim of a disc or of a rounded end."""

    part: (
        str | None
    )  # None for what no file shows and counts as exact, such as a bought motor's shaft
    at: complex  # centre
    diameter: float  # mm, 0 for a point of the part's frame, which no file shows either
    shaft: bool = False  # whether it is a rim


@dataclass(frozen=True)
class Faces:
    """Two parallel faces beside a line."""

    part: str
    at: complex  # on the line
    angle: float  # of the line, rad
    width: float  # between the faces, mm
    drawn: bool = (
        True  # whether the part's own drawing shows them; if not, they count as nominal in a DXF
    )


@dataclass(frozen=True)
class Flat:
    """One straight face of a follower."""

    part: (
        str | None
    )  # None for a face that no file shows and counts as exact, in the follower's own frame
    at: complex  # its middle
    facing: float  # direction out of its material, rad
    width: float  # mm


@dataclass(frozen=True)
class Ring:
    """A ball bearing that is pressed into a hole."""

    part: str
    bore: float  # diameter, mm
    outside: float  # diameter, mm


@dataclass(frozen=True)
class PinEyes:
    """Of a Pin: its eyes, in either order."""

    joint: str
    a: Eye
    b: Eye
    pin: Eye | None = None  # what goes through both where both are holes
    rings: tuple[Ring, ...] = ()  # bearings in the holes, in which the pin turns


@dataclass(frozen=True)
class SlideFaces:
    """Of a Slide: its faces."""

    joint: str
    rails: Faces
    runner: Faces  # that run between the rails, or round them


@dataclass(frozen=True)
class SlotFaces:
    """Of a Slot: its walls and what runs between them."""

    joint: str
    walls: Faces
    eye: Eye  # whose centre runs between the walls
    pin: Eye | None = None  # what goes through the eye where that is a hole


@dataclass(frozen=True)
class Edge:
    """An outline of a part that sits on an axis of its body by a hole of its own, or by its rim where it is a pin itself."""

    part: str
    bore: Eye  # that hole or rim
    seat: Eye | None = (
        None  # another part's hole on the axis; None: the pin on which the body turns
    )
    hole: complex | None = None  # middle of the hole whose edge it is, mm; None: the outer outline


@dataclass(frozen=True)
class OwnTip:
    """A follower's tip as a part has it, beside the nominal one."""

    part: str
    tip: Eye
    bore: Eye  # the part's hole on whose centre it swings
    radius: float | None = None  # mm, of a roller whose seat the tip's eye is; None: the eye's own


@dataclass(frozen=True, eq=False)
class NominalCam:
    """What one exact outline gives, and what of it the designer accepts; s in rad, or mm where the follower slides."""

    law: Law | None = None  # s over the cam's angle where the spec undercuts the joint's law
    # least way of the follower off the contact's tangent, mm per unit of s; None: as measured
    lever: float | None = None
    ripple: float = math.inf  # of the speed, as a share of the greatest
    undercut: float = math.inf  # loss of s


@dataclass(frozen=True)
class CamOutline:
    """Of a Cam: the part whose outline is touched, and the follower's tip. A joint's first outline drives; a further one, such
    as the other cam of a pair or the outer wall of a groove, limits its free play.

    free is by how much a groove is wider than its tip, the air of a pair on either side, below 0 its preload.
    """

    joint: str
    part: str
    turns: str  # Pin that holds the cam on the ground
    swings: str | None  # Pin that holds the follower on the ground; None for one that slides
    # an eye, in the follower's own frame where no part is made, a flat face, or the outline of a part
    tip: Eye | Flat | Edge
    radius: float | None = (
        None  # mm, of a roller whose seat the eye is; None: the eye's, as measured
    )
    leaves: Literal[1, -1] = 1  # the sense of s that takes the tip off the cam
    inside: bool = False  # whether the tip comes from within to the part's largest hole
    free: float = 0.0  # mm, how far the outline lies off a tip that is where its s says
    copy: int = 0  # which of the part's mounts on the cam's body it is
    bore: Eye | None = (
        None  # the part's own hole on the shaft, where no pin of the machine tells its place
    )
    own: OwnTip | None = None  # the tip as a part has it, judged by itself
    roller: str | None = None  # the part that runs there, where the tip is its seat
    # of a plate that slides: from where to where its program runs, mm from its drawn place
    way: tuple[float, float] | None = None
    nominal: NominalCam = NominalCam()
    # of a part that has one in each of its layers: which layer, from the bottom, of how many; None: the part's largest
    layer: tuple[int, int] | None = None
    track: str = ""  # what its spec calls it, of a part that has several


@dataclass(frozen=True)
class Teeth:
    """The teeth of a wheel about its part's origin; its pitch circle is the one that rolls on the mate's."""

    part: str
    count: int
    radius: float  # of the pitch circle, mm
    thickness: float  # of a tooth there, mm
    tooth: float = 0.0  # direction of the middle of one of them, rad
    bends: float = math.nan  # stress at its root by a force on its tip, MPa mm of width per N
    inside: bool = False  # whether they are a ring's, about the part's largest hole


@dataclass(frozen=True)
class GearTeeth:
    """Of a Gear: its wheels, of which b may be a ring."""

    joint: str
    a: Teeth
    b: Teeth
    turns: tuple[str, str]  # Pins about which they turn on what carries them, or both on the ground
    pressure: float = math.radians(20)  # between the flanks' normal and the common tangent, rad
    # where no joint of the machine says how they turn, since it follows from others: of several planets
    implied: Gear | None = None

    @property
    def curvature(self) -> float:
        """Of both flanks against each other at the pitch point, 1/mm."""
        hollow = -1 if self.b.inside else 1
        return (1 / self.a.radius + hollow / self.b.radius) / math.sin(self.pressure)


@dataclass(frozen=True)
class PinTracks:
    """Of an EngagedPair: round pins, each of which is wanted at a known gap from the other side's edges all the way.

    pins: on which side they are. lobes: of the one edge along which all of them go; 0 of holes with a pin in each. gap: mm over the angle
    from the line of both axes to the pin, seen from the pins' axis, (n,) rad. lever: mm, and curvature: of both together, 1/mm, where one
    pin alone holds the follower and is pressed hardest.
    """

    pins: Literal["a", "b"]
    lobes: int
    gap: Callable[[Floats], Floats]
    lever: float
    curvature: float


@dataclass(frozen=True)
class EdgePair:
    """Of a Cam: the edges by which a driver moves its follower, each about a pin on what carries both."""

    joint: str
    a: tuple[Edge, ...]  # of the driver
    b: tuple[Edge, ...]  # of the follower
    turns: str  # Pin that holds the driver on the carrier
    swings: str  # Pin that holds the follower there; on the ground where the carrier turns about the same axis

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All of them."""
        return (*self.a, *self.b)


@dataclass(frozen=True)
class EngagedPair(EdgePair):
    """An EdgePair whose edges hold the follower from both sides.

    The follower counts as where its law wants it, as far as `free` is left on either side, mm; else as in the middle. held: ranges
    of the joint's angle in which no more is left, rad; pushed: those in which no more is left on the side from which it is
    moved; period: of the angle after which both stand as before. rates: of driver and
    carrier, turns for one of the joint's angle; a driver of rate 0 is the ground, any other the joint's cam.
    """

    free: float
    held: tuple[tuple[float, float], ...]
    period: float
    carrier: str = "ground"
    rates: tuple[float, float] = (1.0, 0.0)
    tracks: PinTracks | None = None
    # where no joint of the machine says how they move, since it follows from others: a second disc's output
    implied: Cam | None = None
    pushed: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class PawlPair(EdgePair):
    """An EdgePair of a toothed wheel and a pawl that drops behind its teeth, both on the ground, the pawl always on the wheel.

    passes: the sense in which the wheel passes it; first: where a tip points in the wheel's drawing, rad; the next tooth to drop has
    the next number.
    """

    passes: Literal[1, -1]
    teeth: int
    first: float
    end: float  # radius of the pawl's end, mm
    lost: float  # rad, by which the wheel turns back from a drop to the lock
    friction: float  # coefficient at which a tooth is to draw the pawl in by itself


@dataclass(frozen=True)
class SharedFlat:
    """Two parts of one body on one pin with a flat: the first tells where the second stands, whatever its mount says."""

    a: Eye  # its hole in either
    b: Eye
    facing: float  # where the flat faces, rad in both parts' frames


@dataclass(frozen=True)
class Steady:
    """The other end of what a Pin of the ground turns on, in a second plate."""

    joint: str
    near: Eye  # the hole that the joint knows
    far: Eye  # the one in the second plate
    pin: Eye  # what goes through
    # the driven body's eye on the axis, and that of the part which ends there, where it is not one piece
    webs: tuple[Eye, Eye] | None = None


@dataclass(frozen=True)
class Mark:
    """An eye whose centre is a place of an output: a thread guide, the hole of a pen."""

    eye: Eye


Feature = (
    PinEyes
    | SlideFaces
    | SlotFaces
    | CamOutline
    | GearTeeth
    | EngagedPair
    | PawlPair
    | SharedFlat
    | Steady
    | Mark
)


@dataclass(frozen=True)
class Mount:
    """One copy of a part on a body: body = at + exp(i angle) * part, first turned over about its Oy where `flipped`.

    One that is `upright` is first stood up, (x, y, z) -> (x, -z, y): its outline stands on the plane.
    """

    part: str
    body: str
    at: complex = 0j  # mm
    angle: float = 0.0  # rad
    flipped: bool = False
    z: float = 0.0  # height of its underside in the assembly, mm; of its y = 0 where it is upright
    upright: bool = False

    def place(self, z: complex) -> complex:
        """A point of the part in the body's frame, complex mm."""
        return self.at + cmath.exp(1j * self.angle) * (-z.conjugate() if self.flipped else z)

    def direction(self, angle: float) -> float:
        """A direction of the part in the body's frame, rad."""
        return self.angle + (math.pi - angle if self.flipped else angle)


@dataclass(frozen=True)
class PartPose(Pose):
    """A part's pose in the assembly: ground = place + exp(i angle) * part, first turned over about its Oy where `flipped`, or stood up."""

    flipped: bool = False  # x is -x, z is thickness - z
    z: float = 0.0  # height of its underside, mm; of its y = 0 where it is upright
    upright: bool = False  # y is -z, z is y
    standing: bool = False  # all this in a plane that stands: ground = (-z, -x, y) of its points


def heights(stands: Mount | PartPose, part: float, low: float, high: float) -> tuple[float, float]:
    """From where to where in the assembly what reaches from low to high in a part as drawn does, mm; part: its thickness."""
    low, high = (part - high, part - low) if stands.flipped else (low, high)
    return stands.z + low, stands.z + high


@dataclass(frozen=True)
class Demand:
    """What an output has to do."""

    output: str
    # motion(theta, order), (n,), order 0 and 1, mm (complex for a path) or rad; None: that of the machine
    # with all joints in their nominal places
    motion: Callable[[Floats, int], Any] | None = None
    stroke: bool = False  # whether the difference of its extremes is judged
    lash: float = (
        math.inf
    )  # free play that is accepted, mm or rad, never more than half of its range
    lash_of: str = "limits.lash"  # what sets it, as a person reads it
    targets: tuple[Target | Advance, ...] = ()  # what is wanted of it by value
    judged: bool = True  # False for one that follows from another output by what no file shows


@dataclass(frozen=True)
class StandIn:
    """A thing that is not made but in the way of others."""

    name: str
    body: str  # of the model
    discs: tuple[tuple[complex, float, float, float], ...]  # centre, radius, z0, z1, mm
    rolls: bool = False  # whether it is a tip that rolls on parts
    drives: bool = False  # whether it is a motor
    # bands with round ends: both centres, radius, z0, z1, mm
    bars: tuple[tuple[complex, complex, float, float, float], ...] = ()
    whole: str = ""  # what it is a piece of, such as one end of a spring: its pieces may overlap


@dataclass(frozen=True)
class Passing:
    """Two parts, one copy of each, that must not meet as theta goes round; they only shift, neither turns."""

    name: str
    a: str
    b: str
    planes: tuple[float, ...] = (
        0.0,
    )  # heights of the ground at which their sections are compared, mm
    gap: float = 0.0  # least distance that is wanted, mm; 0 where they may slide on each other
    # of a part whose own drawing shows another section, the part whose drawing shows this one, and whether
    # it is the mirror image in Oy
    drawn: Mapping[str, tuple[str, bool]] = field(default_factory=dict)


@dataclass(frozen=True)
class DrumRing:
    """The upper piece of a drum, which sits on the other's core turned over about its own Oy; mm."""

    part: str
    top: float  # height over the drum's lower end of the ring's own z = 0
    key: float  # height at which both are cut across their key
    corner: float  # distance of the key's corners from the axis


@dataclass(frozen=True)
class DrumTrack:
    """Of a Cam: the drum in whose track a roller runs, its axis along the part's z, and where the roller is; mm."""

    part: str
    joint: str
    track: Literal["groove", "rib", "end"]
    # radius half way along it, length, distance of its inner end from the drum's axis, half angle of its cone, deg
    roller: tuple[float, float, float, float]
    rest: float  # place of the roller along the axis, or angle of its arm, rad, at s = 0
    clearance: float = 0.0  # of the roller between both walls
    ripple: float = (
        math.inf
    )  # of the follower's speed, as a share of the greatest, that is accepted
    distance: float | None = None  # of both rollers of a rib
    offset: float = 0.0  # of a slide, beside the drum's axis
    ring: DrumRing | None = (
        None  # the piece with the wall above the roller, where that is one by itself
    )
    # length, and place of the axle beside and along the drum's axis
    arm: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class PlateEdge:
    """Of a Cam that slides along -x: the plate on whose upper edge a round tip runs, and the tip at s = 0; mm."""

    part: str
    joint: str
    radius: float
    rest: complex  # its centre at way 0, of an arm from its axle
    pivot: complex | None = None  # the axle of an arm; None: it slides along y


@dataclass(frozen=True)
class PinRow:
    """Pins that stand out of a part round its axis, each of which bends a tooth's tip aside and then lets it go.

    The tip goes along the line through its place at rest that is square to the radius. Angles are those by which the part has
    turned, in its own sense; the tooth points at it from outside.
    """

    name: str
    part: str
    layer: tuple[int, int]  # of the part, from the bottom, and how many it has
    tip: complex  # place of the tooth's tip at rest, mm about the axis
    sense: int  # of turning, -1 clockwise
    releases: tuple[float, ...]  # at which each pin lets the tooth go, rad, growing
    bend: Law  # how far the tooth is bent aside, mm, over that angle
    bore: Eye  # the part's hole on its axis
    shift: float  # rad, by which a corner that is a mm off its place lets go sooner or later
    rate: float  # rad/s, of turning
    back: float  # rad, by which the part turns until a tooth is at rest again


@dataclass(frozen=True)
class Balance:
    """The first moment that all solids on a body are to have together about the pin on which it turns."""

    body: str
    joint: str
    about: complex  # the pin's place on the body, mm
    moment: complex  # g mm in the body's axes
    density: Mapping[str, float]  # of each part on the body, g/mm^3
    tolerance: float  # of the moment, g mm


@dataclass(frozen=True)
class Strand:
    """A thread that runs straight from post to post."""

    name: str
    posts: tuple[
        tuple[str, int], ...
    ]  # part and copy of each, round ones about their part's origin
    low: float  # heights of the assembly between which it runs, mm
    high: float
    held: float  # how far each post has to stand out over its groove above and below them, mm
    gap: float  # what the thread keeps from all else, mm


Poses = Callable[[Floats], Mapping[str, Sequence[PartPose]]]


# Poses of the model's bodies at theta, (n,) rad, as exact parts move it: each is worked out when asked for.
Courses = Callable[[Floats], Mapping[str, Pose]]


@dataclass(frozen=True)
class SweptMachine:
    """A machine as the sweep of its solids needs it."""

    mounts: Sequence[Mount]
    courses: Courses  # of its bodies
    contacts: Sequence[Passing | Feature]
    stand_ins: Sequence[StandIn]
    gap: float  # what bodies keep that move past each other, mm
    tolerance: float  # how far facets lie off an arc, mm
    angle: str = "cam angle"  # what theta is
    turns: int = 1  # of theta, that are swept
    drive: Callable[[Floats], Floats] = lambda phase: (
        phase
    )  # theta at a phase of the period, (n,) rad
    # bodies whose planes stand, with the places of their origins, and pairs of parts that touch by intent beside them
    planes: Mapping[str, complex] = field(default_factory=dict)
    touching: Sequence[tuple[str, str]] = ()


def judged_outputs(outputs: Iterable[Output], demands: Iterable[Demand]) -> list[Output]:
    """Those that are judged."""
    left_out = {each.output for each in demands if not each.judged}
    return [output for output in outputs if output.name not in left_out]


def eyes(feature: Feature) -> Iterator[Eye]:
    """All eyes of a feature that make its joint; not a cam's bore."""
    names = (each.name for each in fields(feature) if each.name != "bore")
    yield from (value for name in names if isinstance(value := getattr(feature, name), Eye))
    yield from (feature.webs or ()) if isinstance(feature, Steady) else ()
    for edge in feature.edges if isinstance(feature, EdgePair) else ():
        yield from (edge.bore,) if edge.seat is None else (edge.bore, edge.seat)


def parts_of(features: Iterable[Feature]) -> set[str]:
    """Names of the parts that the features are on; of an own tip the cam's alone."""
    features = list(features)
    found = {
        value.part
        for feature in features
        for value in vars(feature).values()
        if isinstance(value, Eye | Faces | Flat)
    }
    for cam in (feature for feature in features if isinstance(feature, CamOutline)):
        found |= {cam.part, cam.tip.part}
    pairs = (feature for feature in features if isinstance(feature, EdgePair))
    found |= {eye.part for pair in pairs for eye in eyes(pair)}
    return {part for part in found if part is not None}


def eyes_of(part: str, features: Iterable[Feature]) -> tuple[tuple[complex, float], ...]:
    """Nominal centres and diameters of a part's eyes, mm.

    A pin's own rim is none: its place is the hole's.
    """
    found = [
        eye
        for feature in features
        for eye in eyes(feature)
        if eye is not getattr(feature, "pin", None)
    ]
    return tuple((eye.at, eye.diameter) for eye in found if eye.part == part)
