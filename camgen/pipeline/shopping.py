"""What is bought for a machine, and the steps that put it in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import order_of_assembly
from camgen.parts.bench_steps import at_bench
from camgen.parts.catalogue import CAM_FOLLOWERS, Bought
from camgen.parts.keyways import parallel_keys
from camgen.parts.look_alikes import with_sorting
from camgen.parts.reaming import with_cutting, with_reaming
from camgen.parts.standing import standing_copies
from camgen.parts.steps import with_joints
from camgen.study import Table


def bought_things(mechanism: Mechanism) -> list[Bought]:
    """What is bought for a machine, beside its parts: keys in keyways and the rollers that its load names too."""
    assembly = mechanism.assembly
    things = [*assembly.bought, *parallel_keys(assembly.parts, bool(assembly.dowel))]
    rollers = [cam.roller for cam in assembly.outlines.values()]
    named = None if mechanism.load is None else mechanism.load.cam_follower
    if named and rollers and not any(rollers):
        rolls = CAM_FOLLOWERS[named].bought(len(rollers))
        things.append(replace(rolls, how="in your follower, its ring on the cam"))
    return things


def steps_of_assembly(mechanism: Mechanism) -> Table:
    """In which order a machine goes together, with all that is bought for it, as a person at the bench takes it."""
    assembly = replace(mechanism.assembly, bought=bought_things(mechanism))
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    fixing = with_joints(assembly.process.fixing, assembly.features)
    cut = with_cutting(order_of_assembly(assembly), assembly.parts)
    reamed = with_reaming(cut, copies, fixing)
    return at_bench(with_sorting(reamed, assembly.parts, copies, fixing))
