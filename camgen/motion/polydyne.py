"""Programs corrected for an elastic follower: the cam moves so that the mass behind the spring does what was asked.

    s_cam = (1 + K / k) y + (c w / k) y' + (m w^2 / k) y''

    y        what the mass is to do over the cam angle
    w        the cam's speed
    m, k     the follower's mass, and its stiffness from the cam to that
    K, c     rate of the spring that presses the mass on, and a drag in proportion to its speed

It is the force on the mass over the follower's stiffness. What is constant, such as the spring's preload, only shifts where the
mass stands. At the speed that it is made for an undamped mass then does y without vibration; at others some is left. The mass is
to move so smoothly that s_cam has no jump of speed: y''' without jumps, as of the 4-5-6-7 polynomial; with y'''' too its
acceleration has none.
[Dudley 1948; Thoren, Engemann, Stoddart 1952; both as told in Norton et al., the splinedyne method, ASME 2002]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from camgen.motion.laws import Law, Polynomial, measured
from camgen.motion.program import Program, Segment
from camgen.numerics import Floats

NEEDED = (
    "a polynomial whose first three derivatives are 0 at both ends: 4-5-6-7, or one by conditions"
)


@dataclass(frozen=True)
class Polydyne(Program):
    """A cam's program."""

    wanted: Program = Program(())  # what the mass does by it at the speed that it is made for

    def backwards(self) -> Polydyne:
        """As of any program."""
        program = super().backwards()
        return Polydyne(program.segments, program.begin, self.wanted.backwards())


def rough(segments: Sequence[Segment]) -> list[int]:
    """Segments whose law is not as smooth as it has to be, or has no further derivatives."""
    moving = [(k, s.law) for k, s in enumerate(segments) if s.scale]
    return [
        k for k, law in moving if not (isinstance(law.formula, Polynomial) and law.smoothness >= 3)
    ]


@dataclass(frozen=True)
class Lag:
    """By how much a cam has to be ahead of its follower's mass."""

    stretch: float  # m w^2 / k, per rad^2 of the mass's acceleration
    drag: float = 0.0  # c w / k, per rad of its speed
    spring: float = 0.0  # K / k, of its displacement


def polydyne(motion: Program, lag: Lag) -> Polydyne:
    """The cam's program for what the mass is to do. ValueError where a law is too rough."""
    if rough(motion.segments):
        raise ValueError(f"segments {rough(motion.segments)}: {NEEDED}")
    return Polydyne(
        tuple(_corrected_segment(segment, lag) for segment in motion.segments), motion.begin, motion
    )


def _corrected_segment(segment: Segment, lag: Lag) -> Segment:
    whole = 1 + lag.spring
    longer = replace(segment, start=whole * segment.start, scale=whole * segment.scale)
    if not segment.scale:
        return longer
    first = lag.drag / segment.span / whole
    second = lag.stretch / segment.span**2 / whole
    law = segment.law
    note = f"corrected by {first:.6g} of its speed and {second:.6g} of its bend"
    return replace(
        longer,
        law=measured(
            f"{law.name}-polydyne", partial(_sum, law, first, second), f"{law.source}, {note}"
        ),
    )


def _sum(law: Law, first: float, second: float, u: Floats, order: int) -> Floats:
    value: Floats = law.formula(u, order) + second * law.formula(u, order + 2)
    return value + first * law.formula(u, order + 1) if first else value
