"""Where parts are over the turn, what else is in their way, and what passes by what."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

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
class StandIn:
    """A thing that is not made but in the way of others: discs (centre, radius, z0, z1), mm, on a body of the model.

    rolls: it is a tip that rolls on parts.
    """

    name: str
    body: str
    discs: tuple[tuple[complex, float, float, float], ...]
    rolls: bool = False


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


Poses = Callable[[Floats], Mapping[str, Sequence[Pose]]]


@dataclass(frozen=True)
class Moved:
    """A machine as the sweep needs it: its parts' names, contacts and features, what else is in the way, the poses of all.

    gap: what bodies keep that move past each other, mm; tolerance: how far facets lie off an arc, mm; angle: what theta is.
    """

    parts: Sequence[str]
    poses: Poses
    contacts: Sequence[Apart | Feature]
    stand_ins: Sequence[StandIn]
    gap: float
    tolerance: float
    angle: str = "cam angle"
