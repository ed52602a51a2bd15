"""What a machine is to those that judge its files. Data alone: features that make its joints, parts on bodies, what is asked.

    eye       a round feature of a part: a hole, or the rim of a disc that is itself the pin (`shaft`)
    faces     two parallel straight faces of a part: rails, the walls of a slot, a runner
    outline   what a cam's follower runs on
    teeth     of a wheel: where its outline crosses the pitch circle
    mount     where a part stands on its body: body = at + exp(i turned) * part
    stand-in  a thing that is not made but in the way

Places and diameters here are nominal, mm in the part's frame; the judge reads the true ones from each file.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from camgen.machine.model import Law, Output, Pose
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
    """A hole, or with `shaft` the rim of a disc or of a rounded end.

    part: its name, None for what no file shows and counts as exact, such as a bought motor's shaft; at: centre; diameter:
    mm, 0 for a point of the part's frame, which no file shows either.
    """

    part: str | None
    at: complex
    diameter: float
    shaft: bool = False


@dataclass(frozen=True)
class Faces:
    """Two parallel faces `width` apart, mm, beside the line through `at` at `angle` (rad, part's frame).

    drawn: whether the part's own drawing shows them; otherwise they count as meant in a DXF.
    """

    part: str
    at: complex
    angle: float
    width: float
    drawn: bool = True


@dataclass(frozen=True)
class Flat:
    """One straight face of a follower, `width` long: its middle, and the direction out of its material (rad, part's frame).

    part: None for a face that no file shows and counts as exact, in the follower's own frame.
    """

    part: str | None
    at: complex
    facing: float
    width: float


@dataclass(frozen=True)
class Ring:
    """A ball bearing that is pressed into a hole: its part, bore and outside diameter, mm."""

    part: str
    bore: float
    outside: float


@dataclass(frozen=True)
class PinEyes:
    """Of a Pin: its eyes, in either order. `pin`: the third that goes through both where both are holes.

    rings: the bearings in the holes, in which the pin turns.
    """

    joint: str
    a: Eye
    b: Eye
    pin: Eye | None = None
    rings: tuple[Ring, ...] = ()


@dataclass(frozen=True)
class SlideFaces:
    """Of a Slide: the faces of its rails, and those that run between (or round) them."""

    joint: str
    rails: Faces
    runner: Faces


@dataclass(frozen=True)
class SlotFaces:
    """Of a Slot: its walls, and the eye whose centre runs between them; `pin`: what goes through where that is a hole."""

    joint: str
    walls: Faces
    eye: Eye
    pin: Eye | None = None


@dataclass(frozen=True)
class OwnTip:
    """A follower's tip as a part has it, beside the nominal one, and the part's hole on whose centre it swings.

    radius: mm, of a roller whose seat the tip's eye is; None: the eye's own.
    """

    part: str
    tip: Eye
    bore: Eye
    radius: float | None = None


@dataclass(frozen=True, eq=False)
class CamMeant:
    """What one exact outline gives, and what of it the designer accepts; s in rad, or mm where the follower slides.

    given: s over the cam's angle where that is not the joint's law, which the spec itself undercuts. lever: least way, mm per
    unit of s, by which the follower moves off the contact's tangent; None: as measured. ripple: of the speed, as a share of
    the greatest. undercut: loss of s.
    """

    given: Law | None = None
    lever: float | None = None
    ripple: float = math.inf
    undercut: float = math.inf


@dataclass(frozen=True)
class CamOutline:
    """Of a Cam: the part whose outline is touched, and the follower's tip. A joint's first outline drives; a further one, such
    as the other cam of a pair or the outer wall of a groove, limits its free play.

    turns, swings: the Pins that hold cam and follower on the ground; swings is None for a follower that slides. tip: a round
    one's eye, in the follower's own frame where no part is made; its radius counts as measured, or as the given one (mm) where
    the eye is the seat of a roller; or a flat face. leaves: +1 or -1, the sense of s that takes the tip off the cam. inside:
    it comes from within to the part's largest hole. free: mm, how far the outline lies off a tip that is where its s says: by
    how much a groove is wider than the tip, the air of a pair on either side, below 0 its preload. copy: which of the part's
    mounts on the cam's body it is. bore: the part's own hole on the shaft, where not a pin of the machine tells its place.
    own: the tip as a part has it, judged by itself. roller: the part that runs there, where the tip is its seat.
    """

    joint: str
    part: str
    turns: str
    swings: str | None
    tip: Eye | Flat
    radius: float | None = None
    leaves: Literal[1, -1] = 1
    inside: bool = False
    free: float = 0.0
    copy: int = 0
    bore: Eye | None = None
    own: OwnTip | None = None
    roller: str | None = None
    meant: CamMeant = CamMeant()


@dataclass(frozen=True)
class Teeth:
    """The teeth of a wheel about its part's origin: how many, radius of the pitch circle, thickness there, mm.

    tooth: direction of the middle of one of them, rad in the part's frame.
    """

    part: str
    count: int
    radius: float
    thickness: float
    tooth: float = 0.0


@dataclass(frozen=True)
class GearTeeth:
    """Of a Gear whose wheels mesh outside: their teeth, and the Pins about which they turn on the ground."""

    joint: str
    a: Teeth
    b: Teeth
    turns: tuple[str, str]


@dataclass(frozen=True)
class Keyed:
    """Two parts of one body on one pin with a flat: its hole in either, and where the flat faces, rad in both parts' frames.

    The first part tells where the second one stands, whatever its mount says: hole on hole, flat beside flat.
    """

    a: Eye
    b: Eye
    facing: float


@dataclass(frozen=True)
class Steady:
    """The other end of what a Pin of the ground turns on, in a second plate: the hole that its joint knows, this one, and what
    goes through. webs: the driven body's eye on the axis, and that of the part which ends there, where it is not one piece."""

    joint: str
    near: Eye
    far: Eye
    pin: Eye
    webs: tuple[Eye, Eye] | None = None


@dataclass(frozen=True)
class Mark:
    """An eye whose centre is a place of an output: a thread guide, the hole of a pen."""

    eye: Eye


Feature = PinEyes | SlideFaces | SlotFaces | CamOutline | GearTeeth | Keyed | Steady | Mark


@dataclass(frozen=True)
class Mount:
    """One copy of a part on a body: body = at + exp(i turned) * part, first turned over about its Oy where `flipped`.

    z: height of its underside in the assembly, mm.
    """

    part: str
    body: str
    at: complex = 0j
    turned: float = 0.0
    flipped: bool = False
    z: float = 0.0

    def place(self, z: complex) -> complex:
        """A point of the part in the body's frame, complex mm."""
        return self.at + cmath.exp(1j * self.turned) * (-z.conjugate() if self.flipped else z)

    def direction(self, angle: float) -> float:
        """A direction of the part in the body's frame, rad."""
        return self.turned + (math.pi - angle if self.flipped else angle)


@dataclass(frozen=True)
class PartPose(Pose):
    """A part's pose in the assembly: ground = place + exp(i angle) * part, first turned over about its Oy where `flipped`.

    z: height of its underside, mm. Turned over, x is -x and z is thickness - z.
    """

    flipped: bool = False
    z: float = 0.0


def heights(stands: Mount | PartPose, part: float, low: float, high: float) -> tuple[float, float]:
    """From where to where in the assembly what reaches from low to high in a part as drawn does, mm; part: its thickness."""
    low, high = (part - high, part - low) if stands.flipped else (low, high)
    return stands.z + low, stands.z + high


@dataclass(frozen=True)
class Asked:
    """What is asked of an output beside its motion.

    motion(theta, order): the wanted one, (n,), order 0 and 1, mm (complex for a path) or rad; None: that of the machine with
    all joints where they are meant. stroke: whether the difference of its extremes is judged; lash: free play that the
    designer accepts, mm or rad, never more than half of its range; lash_of: what sets it, as a person reads it; targets: what
    is wanted of it by value. judged: False for one that follows from another output by what no file shows.
    """

    output: str
    motion: Callable[[Floats, int], Any] | None = None
    stroke: bool = False
    lash: float = math.inf
    lash_of: str = "limits.lash"
    targets: tuple[Target | Advance, ...] = ()
    judged: bool = True


@dataclass(frozen=True)
class StandIn:
    """A thing that is not made but in the way of others: discs (centre, radius, z0, z1), mm, on a body of the model.

    rolls: it is a tip that rolls on parts; bars: bands with round ends (both centres, radius, z0, z1), mm; whole: what it is
    a piece of, such as one end of a spring: pieces of one thing may overlap.
    """

    name: str
    body: str
    discs: tuple[tuple[complex, float, float, float], ...]
    rolls: bool = False
    bars: tuple[tuple[complex, complex, float, float, float], ...] = ()
    whole: str = ""


@dataclass(frozen=True)
class Apart:
    """Two parts, one copy of each, that must not meet as theta goes round; they only shift, neither turns.

    planes: heights z of the ground at which their sections are compared, mm; gap: least distance that is wanted, mm,
    0 where they may graze: slide on each other. drawn: parts whose own drawing shows another section ->
    the part whose drawing shows the one that is meant, and whether it is the mirror image in Oy.
    """

    name: str
    a: str
    b: str
    planes: tuple[float, ...] = (0.0,)
    gap: float = 0.0
    drawn: Mapping[str, tuple[str, bool]] = field(default_factory=dict)


@dataclass(frozen=True)
class Balance:
    """The first moment that all solids on a body are to have together about the pin on which it turns, complex g mm in its axes.

    about: the pin's place there, mm; density: of each part on the body, g/mm^3; tolerance: g mm, by which it may be off.
    """

    body: str
    joint: str
    about: complex
    moment: complex
    density: Mapping[str, float]
    tolerance: float


@dataclass(frozen=True)
class Strand:
    """A thread that runs straight from post to post, between two heights of the assembly, mm.

    posts: part and copy of each, round ones about their part's origin; held: how far each has to stand out over its groove
    above and below those heights; gap: what the thread keeps from all else, mm.
    """

    name: str
    posts: tuple[tuple[str, int], ...]
    low: float
    high: float
    held: float
    gap: float


Poses = Callable[[Floats], Mapping[str, Sequence[PartPose]]]


# Poses of the model's bodies at theta, (n,) rad, as exact parts move it: each is worked out when asked for.
Courses = Callable[[Floats], Mapping[str, Pose]]


@dataclass(frozen=True)
class Moved:
    """A machine as the sweep needs it: its parts' mounts, contacts and features, what else is in the way, courses of its bodies.

    gap: what bodies keep that move past each other, mm; tolerance: how far facets lie off an arc, mm; angle: what theta is.
    """

    mounts: Sequence[Mount]
    courses: Courses
    contacts: Sequence[Apart | Feature]
    stand_ins: Sequence[StandIn]
    gap: float
    tolerance: float
    angle: str = "cam angle"


def judged_outputs(outputs: Iterable[Output], asked: Iterable[Asked]) -> list[Output]:
    """Those that are judged."""
    left_out = {each.output for each in asked if not each.judged}
    return [output for output in outputs if output.name not in left_out]


def eyes(feature: Feature) -> Iterator[Eye]:
    """All eyes of a feature that make its joint; not a cam's bore."""
    names = (each.name for each in fields(feature) if each.name != "bore")
    yield from (value for name in names if isinstance(value := getattr(feature, name), Eye))
    yield from (feature.webs or ()) if isinstance(feature, Steady) else ()


def parts_of(features: Iterable[Feature]) -> set[str]:
    """Names of the parts that the features are on; of an own tip the cam's alone."""
    found = {
        value.part
        for feature in features
        for value in vars(feature).values()
        if isinstance(value, Eye | Faces | Flat)
    }
    found |= {feature.part for feature in features if isinstance(feature, CamOutline)}
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
