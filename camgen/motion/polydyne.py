"""Programs corrected for an elastic follower: the cam moves so that the mass behind the spring does what was asked.

    s_cam = y + c y'',   c = m w^2 / k     y: what the mass is to do over the cam angle; w: the cam's speed, m, k of the follower

At the speed that it is made for the mass then does y without vibration; at others some is left. The mass is to move so smoothly
that s_cam has no jump of speed: y''' without jumps, as of the 4-5-6-7 polynomial; with y'''' too its acceleration has none.
[Dudley 1948; Thoren, Engemann, Stoddart 1952; both as told in Norton et al., the splinedyne method, ASME 2002]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from camgen.motion.laws import Law, Polynomial, measured
from camgen.motion.program import Program, Segment
from camgen.numerics import Floats

NEEDED = "a polynomial whose first three derivatives are 0 at both ends: 4-5-6-7, or one by conditions"


@dataclass(frozen=True)
class Polydyne(Program):
    """A cam's program; wanted: what the mass does by it at the speed that it is made for."""

    wanted: Program = Program(())

    def backwards(self) -> Polydyne:
        """As of any program."""
        made = super().backwards()
        return Polydyne(made.segments, made.begin, self.wanted.backwards())


def rough(segments: Sequence[Segment]) -> list[int]:
    """Segments whose law is not as smooth as it has to be, or has no further derivatives."""
    moving = [(k, s.law) for k, s in enumerate(segments) if s.scale]
    return [k for k, law in moving if not (isinstance(law.formula, Polynomial) and law.smoothness >= 3)]


def polydyne(wanted: Program, stretch: float) -> Polydyne:
    """The cam's program for what the mass is to do; stretch: c, 1 per rad^2. ValueError where a law is too rough."""
    if rough(wanted.segments):
        raise ValueError(f"segments {rough(wanted.segments)}: {NEEDED}")
    segments = [replace(s, law=_corrected(s.law, stretch / s.span**2)) if s.scale else s for s in wanted.segments]
    return Polydyne(tuple(segments), wanted.begin, wanted)


def _corrected(law: Law, share: float) -> Law:
    return measured(f"{law.name}-polydyne", partial(_sum, law, share), f"{law.source}, corrected by {share:.6g} of its bend")


def _sum(law: Law, share: float, u: Floats, order: int) -> Floats:
    return law.formula(u, order) + share * law.formula(u, order + 2)
