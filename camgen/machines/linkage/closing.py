"""The chain of a linkage, closed as drawn."""

from __future__ import annotations

import math
from dataclasses import replace

from camgen.machine import model as m
from camgen.machine.programs import DriveLaw
from camgen.machine.reach import refuse_folds, refuse_partial
from camgen.machine.stepwise import stays_clear
from camgen.machines.linkage import (
    motors,
    pens,
)
from camgen.machines.linkage.asked_range import refuse_range
from camgen.machines.linkage.spec import LinkageSpec


def closed(spec: LinkageSpec) -> m.Machine:
    """The model, closed as drawn; DesignError where it does not close, is loose or locked, or cannot move as asked.

    Each pin has the play of one that is pressed into one of its links.
    """
    chain = spec.drawn.closed()
    for spring in spec.returning:
        chain = spring.on(chain)
    if len(spec.drives) > 1:
        return motors.driven(chain, spec.drives) if spec.pen is None else pens.led(chain, spec.pen)
    law: m.Law | None
    program = spec.drive.program()
    if program is None:
        law = None
        reach = None if spec.drive.range_deg is None else spec.cycle.range
    else:
        law = DriveLaw(program, chain.start[spec.drive.link].angle)
        reach = law.reach
    clear = stays_clear(chain, *(reach or (0.0, math.tau)))
    if reach is not None:
        refuse_range(chain, spec.drive, *reach)
    elif not clear:
        refuse_partial(chain, spec.allowed.transmission_angle_deg)
    if not clear:
        refuse_folds(chain, *(reach or (0.0, math.tau)))
    law = spec.additions.drive or law
    if law is not None:
        drive, *held = chain.drives
        chain = replace(chain, drives=(replace(drive, law=law), *held))
    return spec.drawn.released(chain)
