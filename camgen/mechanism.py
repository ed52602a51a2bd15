"""The one interface: a mechanism is a frozen record whose fields are its spec and which answers six questions as data.

motion(theta, order)   the wanted output
parts()                what to make
poses(theta)           where each body is
contacts()             how parts touch
limits()               closed-form design checks, as findings
study()                named numbers, curves and tables for the report
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import getitem
from typing import Self

import numpy as np

from camgen.findings import Finding
from camgen.outlines import Floats, Points
from camgen.parts import Part
from camgen.spec import Spec, validate
from camgen.standards import DENSITY, Bought


@dataclass(frozen=True)
class Pose:
    """Where a body is over the turn: ground = position + exp(i angle) * body; `flipped`: the body is first mirrored in its Oy.

    angle: (n,) rad; position: (n,) complex mm; z: height of the body's underside in the assembly, mm.
    A flipped part is turned over about Oy (x -> -x, z -> thickness - z).
    """

    angle: Floats
    position: Points
    flipped: bool = False
    z: float = 0.0


@dataclass(frozen=True)
class Rolling:
    """A round tip on a swinging arm, or another follower, on the outline of a part that turns about the origin by theta.

    part: name of the part whose outer outline is touched; flipped: the part is mounted mirrored in its Oy at theta = 0;
    turned: further turn of the mounted part, rad. Tip centre = pivot + arm * exp(i s), s the follower's angle (the
    wanted motion, rad), pivot and arm complex mm; tip_radius mm (0: knife edge); leaves: +1 or -1, sense of s that
    takes the tip off the part; pressure_angle: the largest of the exact part, rad (an outline that is off by e turns
    the follower by e / (|arm| cos pressure_angle)); speed_ripple, lash and undercut: what the designer accepts, as a
    share of the greatest speed and in rad; tip_part: the part whose outline is the tip, its bore at the pivot; seat: the tip
    is a bought roller instead, on a pin in a hole of that part, of this diameter, mm.
    The first contact of a part drives, a further one limits the free play, as does a contact of another part: the second
    cam of a pair, or the outer wall of a groove (inside), whose tip_radius here is that of a tip as wide as the groove.
    slides: tip centre = pivot + arm * s instead, arm a unit vector, s in mm. face: a flat face instead of a tip, through
    that point, its unit normal off the part at s = 0. lever: the least way, mm per unit of s, by which the follower moves
    off the contact's tangent, where it is not |arm| cos pressure_angle. inside: it comes from within to the largest hole,
    the outer wall of a groove. reach: places on the face (as `contact.Touch` counts them) between which it must be touched.
    reachable: s that this part gives by itself where it is exact, if that is not the mechanism's own.
    """

    name: str
    part: str
    pivot: complex
    arm: complex
    tip_radius: float
    leaves: int
    pressure_angle: float
    speed_ripple: float
    lash: float
    undercut: float
    flipped: bool = False
    turned: float = 0.0
    tip_part: str | None = None
    slides: bool = False
    face: complex | None = None
    lever: float | None = None
    inside: bool = False
    reach: tuple[float, float] | None = None
    reachable: Callable[[Floats], Floats] | None = None
    seat: float = 0.0

    @property
    def unit(self) -> tuple[str, float]:
        """What people read s in, and how many of it one unit of s is."""
        return ("mm", 1.0) if self.slides else ("deg", math.degrees(1))


@dataclass(frozen=True)
class Eye:
    """A round feature of a part that belongs to a joint: a hole, or the rim of a disc that is itself the pin (`shaft`).

    part: its name, None for the ground itself (exact, such as a bought motor's shaft); at: centre, complex mm in the
    part's frame (the ground's for None); diameter: nominal, mm. Place and diameter are read from each file; diameter 0 is a
    point of the part's frame, which no file shows.
    """

    part: str | None
    at: complex
    diameter: float
    shaft: bool = False


@dataclass(frozen=True)
class Pin:
    """A turning joint: the centres of two eyes coincide.

    clearance: the diametral play meant between both, mm. Where one eye is a shaft the play is hole less shaft; where
    both are holes, `pin` is the eye (a shaft) that goes through both, and its play in either counts.
    """

    name: str
    a: Eye
    b: Eye
    clearance: float
    pin: Eye | None = None


@dataclass(frozen=True)
class Slide:
    """A straight guide of the ground: the eye's centre stays on the line through `through` at `angle` (rad), unturned.

    The part keeps the angle of its pose. Its two faces are `width` apart, the eye between them; those of the part `rails`
    are clearance (mm) wider. Faces are read from each file, a drawing's only where `drawn` says that it shows the rails;
    so a guide may lie off its line, or lean.
    """

    name: str
    eye: Eye
    through: complex
    angle: float
    width: float
    clearance: float
    rails: str
    drawn: bool = True


@dataclass(frozen=True)
class Traced:
    """What of a linkage is the wanted motion, and what drives it.

    crank: part that turns with theta (its pose's angle at theta = 0 is its mounting); ground: parts that stand still.
    The bodies are these and all parts named by Pin and Slide, one copy of each. eye: the point whose path is traced;
    output(path, *places): the wanted motion from that path, (n,) complex mm in the ground's frame -> (n,) mm, and from the
    places of the eyes that stand `still` (complex mm), such as thread guides;
    gradient(path, *places): its slope, (n,) complex, so that d output = Re(conj(gradient) d path).
    stroke: whether the difference of the output's extremes is what the spec asks for, and judged as STROKE_ERROR.
    lash: free play of the output that the designer accepts, mm; never more than half of its stroke.
    """

    name: str
    crank: str
    ground: tuple[str, ...]
    eye: Eye
    output: Callable[..., Floats]
    gradient: Callable[..., Points]
    stroke: bool = True
    still: tuple[Eye, ...] = ()
    lash: float = math.inf


@dataclass(frozen=True)
class Drive:
    """What bodies turn with: ground = centre + exp(i angle(theta)) * (place on it); angle: (n,) rad -> (n,) rad, continuous."""

    name: str
    centre: complex
    angle: Callable[[Floats], Floats]

    def course(self, theta: Floats) -> tuple[Floats, Points]:
        """Angle, rad, and position, complex mm, of its frame in the ground's; (n,)."""
        return self.angle(theta), np.full(theta.shape, self.centre)


@dataclass(frozen=True)
class Mount:
    """One copy of a part on a drive: drive's frame = at + exp(i turned) * body, first turned over about its Oy if `flipped`.

    z: height of its underside in the assembly, mm. The copies of a part are numbered in the order of their mounts.
    """

    part: str
    drive: Drive
    at: complex = 0j
    turned: float = 0.0
    z: float = 0.0
    flipped: bool = False

    def pose(self, angle: Floats) -> Pose:
        """The same over the turn, in the ground's frame, by the drive's angle, (n,) rad."""
        place = self.drive.centre + np.exp(1j * angle) * self.at
        return Pose(angle + self.turned, np.asarray(place, complex), self.flipped, self.z)


@dataclass(frozen=True)
class StandIn:
    """A body that is not made but in the way of others: discs (centre, radius, z0, z1), mm, in a frame of its own.

    course: (n,) rad -> the frame's angle, (n,) rad, and position, (n,) complex mm, in the ground's. rolls: it is a tip that
    rolls on parts.
    """

    name: str
    course: Callable[[Floats], tuple[Floats, Points]]
    discs: tuple[tuple[complex, float, float, float], ...]
    rolls: bool = False


@dataclass(frozen=True)
class Assembly:
    """A whole machine, laid out for printing: all copies of its parts and what is bought."""

    mounts: tuple[Mount, ...]
    stand_ins: tuple[StandIn, ...]


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


Contact = Rolling | Pin | Slide | Traced | Apart


@dataclass(frozen=True)
class Plot:
    """A figure of the report: series of (label, x, y); `marks` are vertical lines (label, x).

    A plot over the cam angle has x in degrees. equal: a shape, one mm the same both ways.
    """

    title: str
    x_label: str
    y_label: str
    series: Sequence[tuple[str, Floats, Floats]]
    marks: Sequence[tuple[str, float]] = ()
    equal: bool = False


@dataclass(frozen=True)
class Table:
    """A table of the report: rows of text or numbers under the columns' names."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[object]]


@dataclass(frozen=True)
class Sketch:
    """A body that is drawn but not made: strokes (polylines, complex mm) and circles (centre, radius) in its own frame."""

    name: str
    strokes: Sequence[Points] = ()
    circles: Sequence[tuple[complex, float]] = ()


@dataclass(frozen=True)
class Study:
    """What the report shows of a mechanism, without the report knowing the mechanism.

    columns: of motion.csv, where no contact gives them; (1441,) each, every quarter degree of a turn, both ends included.
    """

    numbers: Mapping[str, float] = field(default_factory=dict)
    plots: Sequence[Plot] = ()
    tables: Sequence[Table] = ()
    sketches: Sequence[Sketch] = ()
    notes: Sequence[str] = ()
    columns: Mapping[str, Floats] = field(default_factory=dict)


Poses = Callable[[Floats], Mapping[str, Sequence[Pose]]]


@dataclass(frozen=True)
class Moved:
    """A machine as the sweep needs it: its parts' names, their poses, how they touch, what else is in the way.

    gap: what bodies keep that move past each other, mm; tolerance: how far facets lie off an arc, mm.
    """

    parts: Sequence[str]
    poses: Poses
    contacts: Sequence[Contact]
    stand_ins: Sequence[StandIn]
    gap: float
    tolerance: float


class Mechanism(Spec, ABC):
    """Base of all mechanisms; theta is the input angle, rad, counter-clockwise."""

    @abstractmethod
    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted output and its derivatives to theta, (n,); rad or mm."""

    def reachable(self, theta: Floats) -> Floats:
        """Output that exact parts give: the wanted one, less what the spec itself implies (undercut), (n,)."""
        return self.motion(theta)

    @abstractmethod
    def parts(self) -> Sequence[Part]:
        """Distinct parts, with counts."""

    @abstractmethod
    def poses(self, theta: Floats) -> Mapping[str, Sequence[Pose]]:
        """Poses of each part's copies (in order) and of each sketch, by name."""

    @abstractmethod
    def contacts(self) -> Sequence[Contact]:
        """How parts touch: a cam's Rolling tips, or a linkage's Pins and Slides with the one Traced point."""

    @abstractmethod
    def limits(self) -> Sequence[Finding]:
        """Closed-form design checks; raises DesignError where no such mechanism exists."""

    @abstractmethod
    def study(self) -> Study:
        """Named numbers, curves and tables for the report."""

    @property
    def speed(self) -> float:
        """Speed of the input shaft, rad/s, below 0 where it turns clockwise; nan where the spec gives none."""
        motor = getattr(self, "motor", None)
        return math.nan if motor is None else float(motor.speed_rpm) * math.tau / 60

    @property
    def sense(self) -> int:
        """Sense in which theta runs: -1 where the input shaft turns clockwise."""
        return -1 if self.speed < 0 else 1

    def found(self) -> Mapping[str, object]:
        """What the spec leaves open and camgen found, by dotted keys; DesignError where there is nothing to be found."""
        return {"material.density": self.material.density or DENSITY[self.material.name]}

    def resolved(self) -> Self:
        """The same with everything filled in that was found: a spec that makes the same files."""
        data = self.model_dump(by_alias=True, exclude_none=True)
        for key, value in self.found().items():
            *tables, last = key.split(".")
            reduce(getitem, tables, data)[last] = value
        return validate(type(self), data)

    def assembly(self) -> Assembly | None:
        """The whole machine, laid out for printing; None where only single parts are made."""
        return None

    def stand_ins(self) -> Sequence[StandIn]:
        """What is not made but in the way: unless a mechanism says more, each contact's round tip, as high as its part."""
        assembly = self.assembly()
        if assembly is not None:
            return assembly.stand_ins
        parts, start = {part.name: part for part in self.parts()}, self.poses(np.zeros(1))
        found = []
        for tip in self.contacts():
            if isinstance(tip, Rolling) and tip.tip_part is None and tip.face is None and tip.tip_radius and not tip.inside:
                part, pose = parts[tip.part], next(p for p in start[tip.part] if p.flipped is tip.flipped)
                layer = part.layers[part.cut]
                low, high = (part.thickness - layer.z1, part.thickness - layer.z0) if pose.flipped else (layer.z0, layer.z1)
                disc = (0j if tip.slides else tip.arm, tip.tip_radius, pose.z + low, pose.z + high)
                found.append(StandIn(f"tip on {tip.part}-{1 + tip.flipped}", self._tip_course(tip), (disc,), rolls=True))
        return found

    def _tip_course(self, tip: Rolling) -> Callable[[Floats], tuple[Floats, Points]]:
        output = tip.reachable or self.reachable

        def course(theta: Floats) -> tuple[Floats, Points]:
            s, still = output(theta), np.zeros(theta.shape)
            place: Points = np.asarray(tip.pivot + (tip.arm * s if tip.slides else still), complex)
            return (still if tip.slides else s), place

        return course

    def moved(self) -> Moved:
        """What the sweep needs."""
        names, tolerance = [part.name for part in self.parts()], self.accuracy.chord_tolerance
        return Moved(names, self.poses, self.contacts(), self.stand_ins(), self.running_gap, tolerance)

    @property
    def running_gap(self) -> float:
        """What bodies that move past each other keep, mm: of the play on a side what a coarse print leaves, less facets."""
        return max(0.0, 0.8 * self.print.slide_clearance / 2 - 2 * self.accuracy.chord_tolerance)

    def printed(self) -> Sequence[Part]:
        """Parts that are laid out on plates, with a list of parts: those of a whole machine, unless said otherwise."""
        return [part for part in self.parts() if part.made == "printed"] if self.assembly() is not None else []

    def recovered(self, theta: Floats, motion: Mapping[str, Floats]) -> Study:
        """What follows from the motion recovered from each kind of file, (n,) over a whole turn, both ends included."""
        return Study()

    def bought(self) -> Sequence[Bought]:
        """What is bought, by its standard."""
        return ()
