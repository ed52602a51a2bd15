"""How bodies touch and where they are: poses, mounts of an assembly, what else is in the way."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from camgen.geometry.outlines import Floats, Points
from camgen.machine.features import Feature


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
        place = self.drive.centre + (np.exp(1j * angle) * self.at if self.at else np.zeros(angle.shape))
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


Contact = Apart


Poses = Callable[[Floats], Mapping[str, Sequence[Pose]]]


@dataclass(frozen=True)
class Moved:
    """A machine as the sweep needs it: its parts' names, their poses, contacts and features, what else is in the way.

    gap: what bodies keep that move past each other, mm; tolerance: how far facets lie off an arc, mm; angle: what theta is.
    """

    parts: Sequence[str]
    poses: Poses
    contacts: Sequence[Contact | Feature]
    stand_ins: Sequence[StandIn]
    gap: float
    tolerance: float
    angle: str = "cam angle"
