"""How parts that go through each other are fixed: glued, pressed, or free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from camgen.machine.features import PinEyes
from camgen.parts.part import Part
from camgen.parts.standing import Round, Slot

Fit = Literal["glue", "press", "free"]


@dataclass(frozen=True)
class Fixing:
    """What of two parts that go through each other is fixed."""

    play: float  # greatest of a hole that is tight, mm
    rings: frozenset[str] = frozenset()  # names of ball bearings, which are pressed and not glued
    driven: frozenset[str] = frozenset()  # names of parts in which the shaft of a motor ends
    dry: frozenset[str] = frozenset()  # names of parts that are held without glue
    # holes, by part and letter, that are opened until what is glued in them goes in by hand
    by_hand: frozenset[tuple[str, str]] = frozenset()
    metal: bool = False  # whether parts are of metal: a feeler gauge sets their gaps, and no end that is flush does

    def how(self, hole: Round | Slot, holder: Part, outline: Round, held: Part) -> Fit:
        """How an outline is fixed in a hole: "free" where it goes through with play, or both are bought to go together."""
        if hole.diameter - outline.diameter > self.play or {holder.name, held.name} & self.dry:
            return "free"
        if holder.process == held.process == "bought" or holder.name in self.rings:
            return "free"  # a bearing's ring turns with its pin, and holds it by nothing
        return "press" if held.name in self.rings else "glue"


def with_joints(fixing: Fixing, pairs: Sequence[object]) -> Fixing:
    """The fixing that knows the ball bearings of joints, and what is on the shaft of a motor, which no part is."""
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    driving = (each for each in eyes if each.pin is not None and each.pin.part is None)
    driven = {eye.part for each in driving for eye in (each.a, each.b) if eye.part is not None}
    rings = frozenset(ring.part for each in eyes for ring in each.rings)
    return replace(fixing, rings=fixing.rings | rings, driven=frozenset(driven))
