"""Ratchets: a wheel whose teeth a pawl lets pass one way, and locks the other.

face        of a tooth: what the pawl's end stands against; it leans over by `lean`, so that its push draws the pawl in
back        straight from the tip to the next root: it lifts the pawl
drawn in    by the face alone, without a spring: where its normal passes the pawl's pivot on the wheel's side by more than
            the friction angle
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, polygon


@dataclass(frozen=True)
class RatchetWheel:
    """A wheel that turns counter-clockwise past its pawl; the tip of a tooth lies on Ox."""

    teeth: int
    tip: float  # radius, mm
    root: float  # radius, mm
    lean: float = 0.0  # of a face from the radius through its tip, rad, the root under the tooth

    def __post_init__(self) -> None:
        if self.teeth < 3:
            raise DesignError("teeth of a ratchet", self.teeth, 3, "", "", "use more teeth")
        if not 0 < self.root < self.tip:
            raise DesignError("radius of the roots", self.root, self.tip, "mm", "", "make it less")
        if not self.top < self.pitch:
            raise DesignError(
                "angle that a leaning face takes",
                math.degrees(self.top),
                math.degrees(self.pitch),
                "deg",
                "",
                "lean it less, or use fewer teeth",
            )

    @property
    def pitch(self) -> float:
        """From tooth to tooth, rad."""
        return math.tau / self.teeth

    @property
    def top(self) -> float:
        """Angle about the axis from a face's root to its tip, rad."""
        return self.lean_at_root - self.lean

    @property
    def lean_at_root(self) -> float:
        """Of a face from the radius through its root, rad."""
        sine = self.tip * math.sin(self.lean) / self.root
        if not abs(sine) < 1:
            raise DesignError(
                "lean of a face",
                math.degrees(self.lean),
                math.degrees(math.asin(self.root / self.tip)),
                "deg",
                "",
                "lean it less",
            )
        return math.asin(sine)

    def outline(self) -> Contour:
        """The edge, counter-clockwise: tip, back to the next root, face out to the next tip."""
        points = []
        for k in range(self.teeth):
            middle = k * self.pitch
            root = middle + self.pitch + self.top
            points += [cmath.rect(self.tip, middle), cmath.rect(self.root, root)]
        return polygon(points)


@dataclass(frozen=True)
class Pawl:
    """A pawl with a round end that swings about a pivot beside the wheel; places about the wheel's axis, mm."""

    wheel: RatchetWheel
    pivot: complex
    end: float  # radius of its end

    @property
    def seat(self) -> complex:
        """Middle of its end where it rests in the root before the face of the tooth on Ox, mm."""
        root = cmath.rect(self.wheel.root, self.wheel.top)
        face = (self.wheel.tip - root) / abs(self.wheel.tip - root)
        behind = cmath.rect(self.wheel.tip, -self.wheel.pitch) - root
        back = behind / abs(behind)
        half = abs(cmath.phase(back / face)) / 2
        return root + self.end / math.sin(half) * (face + back) / abs(face + back)

    @property
    def push(self) -> complex:
        """Direction of the face's push on the end, unit complex."""
        root = cmath.rect(self.wheel.root, self.wheel.top)
        face = (self.wheel.tip - root) / abs(self.wheel.tip - root)
        return -1j * face

    @property
    def draw(self) -> float:
        """Angle by which the face's push draws the pawl in, rad: between the push and the line to the pivot; below 0 it throws out.

        Friction at the face takes its angle from it.
        """
        away = self.pivot - self.seat
        inwards = 1 if (away.conjugate() * -self.seat).imag > 0 else -1
        return inwards * cmath.phase(self.push / away)

    def holds(self, friction: float) -> bool:
        """Whether it draws itself in and stays, at a coefficient of friction."""
        return self.draw > math.atan(friction)
