"""How the disc that locks a Geneva wheel fits its hollows where the sizes on all sheets are at their limits.

The hollows may be wider than drawn by the tolerance of a profile, the lock thinner by as much. Off their places, by half of each zone,
are the hollows about their bore, the lock about its own, one bore of the plate from the other, and each bush within itself. What is
glued sits off its shaft by half of what bore and shaft leave, and a bore that is not square to the plate leans its shaft. A shaft gives
way in the play of its bush, over the plate by more than in it, for it leans there: a thin shaft always by more than a part is off it.
"""

from __future__ import annotations

import cmath
import math

from camgen.files.dimensions import SlottedWheel, lock_of, slotted_wheel
from camgen.files.limits import deviations
from camgen.files.title_block import LockLimits
from camgen.machine.features import EdgePair
from camgen.machine.model import GROUND
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import BUSH
from camgen.parts.part import Part, SquareNote

TRUE = 0.03  # mm, run-out of a bush's bore where it is pressed in: camgen's own rule
_BUSHED = "H8"  # fit of that bore: camgen's own rule


def lock_limits(
    assembly: Assembly, part: Part, zones: tuple[float, float], fits: tuple[str, str]
) -> LockLimits | None:
    """Of a lock whose shaft and that of its wheel turn in bushes of one plate; None of any other part.

    zones: tolerance of the profile, and of the position of the plate's bores, mm; fits: of the bores of lock and wheel, of their shafts.
    """
    lock = lock_of(part.region.outer) if part.role == "lock" else None
    wheel = _wheel(assembly, part)
    bushes = [each for each in assembly.mounts if each.part == BUSH]
    if lock is None or wheel is None or not part.bore or len(bushes) < 2:
        return None
    bore, shaft, bushed = (deviations(part.bore, fit) for fit in (*fits, _BUSHED))
    profile, position = zones
    if not (profile and bore and shaft and bushed):
        return None
    hollow = wheel.hollows[0]
    drawn = hollow.radius - lock[0].radius
    off = profile + position / 2 + TRUE
    off += 2 * _off_axis(assembly, part, bore[1], bushed[0] - shaft[1])
    end = complex(hollow.at(hollow.t0, 0)) - hollow.centre
    half = abs(cmath.phase(-end / hollow.centre))  # of the hollow about its own centre
    lever = abs(hollow.centre) * math.sin(half)
    loose = drawn + 2 * profile + bushed[1] - shaft[0]  # of both shafts half their play
    return LockLimits(drawn - off, TRUE, 2 * loose / lever)


def _off_axis(assembly: Assembly, lock: Part, bored: float, play: float) -> float:
    """By how much a part on the lock's level is off the axis of its bush after its shaft has given way, mm.

    bored: by which its own bore is too wide; play: the least of its shaft in the bush.
    """
    plates = [each for each in assembly.mounts if each.body == GROUND]
    notes = [note for each in plates for note in assembly.by_name[each.part].notes]
    square = max((note.zone for note in notes if isinstance(note, SquareNote)), default=0.0)
    high = max(each.z + lock.thickness for each in assembly.mounts if each.part == lock.name)
    long = assembly.by_name[BUSH].thickness
    over = (high - long / 2) / long  # in lengths of the bush from its middle
    return bored / 2 + square * over + play / 2 * (1 - max(1.0, 2 * over))


def _wheel(assembly: Assembly, lock: Part) -> SlottedWheel | None:
    """The slotted wheel that a part locks."""
    pairs = [each for each in assembly.features if isinstance(each, EdgePair)]
    own = [pair for pair in pairs if lock.name in {edge.part for edge in pair.a}]
    driven = [assembly.by_name[edge.part] for pair in own for edge in pair.b]
    return next(filter(None, (slotted_wheel(each.region.outer) for each in driven)), None)
