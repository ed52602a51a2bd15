"""How parts that go through each other are fixed: glued, pressed, or free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from camgen.geometry.arcs import as_circle
from camgen.machine.features import PinEyes
from camgen.parts.part import ROD, Part, SizeNote
from camgen.parts.standing import Round, Slot

Fit = Literal["glue", "press", "free"]
Joint = Literal["glued", "keyed and glued", "pressed and glued", "pressed", ""]
JOINTS: tuple[Joint, ...] = ("glued", "keyed and glued", "pressed and glued", "pressed")

# Fits of what is fixed in holes H7 of metal. Pins m6, as dowels are sold [ISO 8734, ISO 2338]. A pin through a ball bearing stands
# still while the load turns about its outer ring: g6, where the inner ring is to go on by hand [hchbearing.com, required running
# accuracy and fit, Manuquality.aspx?cid=46&Seccid=229].
PIN = "m6"
JOURNAL = "g6"
# A shaft in a bush with a seat H7 [nodeshk.com/skf/art/20021, of bushes with a layer of PTFE; lagermetall.com/bushings/tunnv_bimet_tol.asp,
# of rolled ones: f7 or e7; of solid ones, ISO 4379, no source was opened]. Ground rods of C45 are sold so
# [hydrauliccylindertubes.com/Chromed-Bar.html].
IN_BUSH = "f7"
_BY_HAND = (JOURNAL, ROD, IN_BUSH)  # never tighter than H7


def joint_of(fit: str, key: bool = False) -> Joint:
    """How what has a fit is fixed in a hole of its size: of what goes in by hand the glue alone holds it, or a key as well."""
    if fit not in _BY_HAND:
        return "pressed and glued"
    return "keyed and glued" if key else "glued"


def is_rod(part: Part) -> bool:
    """Whether a part is cut of rod."""
    return rod_fit(part) != ""


def rod_fit(part: Part) -> str:
    """Fit of the rod of which a part is cut; "" of another part."""
    return next((note.fit for note in part.notes if isinstance(note, SizeNote)), "")


def is_as_sold(part: Part) -> bool:
    """Whether a part is bought and stays as it is, such as a dowel, a bush or a ball bearing: it is cut of no rod and has no flat."""
    contours = (c for layer in part.layers for c in (layer.region.outer, *layer.region.holes))
    return part.process == "bought" and not is_rod(part) and all(map(as_circle, contours))


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
    journals: frozenset[str] = frozenset()  # names of pins through ball bearings

    def how(self, hole: Round | Slot, holder: Part, outline: Round, held: Part) -> Fit:
        """How an outline is fixed in a hole: "free" where it goes through with play, or both are bought to go together."""
        if hole.diameter - outline.diameter > self.play or {holder.name, held.name} & self.dry:
            return "free"
        if holder.process == held.process == "bought" or holder.name in self.rings:
            return "free"  # a bearing's ring turns with its pin, and holds it by nothing
        if holder.role == "sleeve":
            return "free"  # what the head of its pin clamps
        return "press" if held.name in self.rings else "glue"

    def joint(self, hole: Round | Slot, holder: Part, outline: Round, held: Part) -> Joint:
        """The same in words; "" of what is free."""
        how = self.how(hole, holder, outline, held)
        if how != "glue":
            return "pressed" if how == "press" else ""
        if self.metal:
            by_hand = is_rod(held) or held.name in self.journals or holder.role in ("cap", "lock")
        else:
            by_hand = isinstance(hole, Round) and (holder.name, hole.name) in self.by_hand
        seats = {hole.flat, outline.flat} if isinstance(hole, Round) else {""}
        return joint_of(ROD if by_hand else PIN, self.metal and seats == {"key"})


def with_joints(fixing: Fixing, pairs: Sequence[object]) -> Fixing:
    """The fixing that knows the ball bearings of joints, and what is on the shaft of a motor, which no part is."""
    eyes = [each for each in pairs if isinstance(each, PinEyes)]
    driving = (each for each in eyes if each.pin is not None and each.pin.part is None)
    driven = {eye.part for each in driving for eye in (each.a, each.b) if eye.part is not None}
    rings = frozenset(ring.part for each in eyes for ring in each.rings)
    pins = {each.pin.part for each in eyes if each.rings and each.pin is not None}
    journals = frozenset(name for name in pins if name is not None)
    return replace(fixing, rings=fixing.rings | rings, driven=frozenset(driven), journals=journals)
