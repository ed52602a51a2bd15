"""A machine that parts into dyads, closed and looked at step by step: most do, and it takes a hundredth of the general way.

Only what is clear is decided here. Near a fold, as drawn, closed or on its way, the general way decides: `freedom` and `reach`.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from camgen.errors import DesignError
from camgen.machine.loops import Chain, chain_of, keep_chain
from camgen.machine.model import GROUND, Machine, Pose
from camgen.machine.reach import FAR, LOOKED, determinant
from camgen.machine.state import Direct, Dyad, State
from camgen.numerics import Floats


def closed_by_dyads(machine: Machine) -> Machine | None:
    """The machine with start poses that close it at theta = 0, on the branch as drawn; it is neither loose nor locked.

    None where it does not part into dyads, does not close, or is near a fold as drawn or closed.
    """
    try:
        chain = chain_of(machine)
    except DesignError:
        return None
    if not all(isinstance(s, Direct) or isinstance(s, Dyad) and s.sine > FAR for s in chain.steps):
        return None
    state = _looked(chain, 0.0, math.tau)
    if not _clear(chain, state, slice(1)):
        return None
    with np.errstate(all="ignore"):
        start = {body.name: _pose(machine, state, body.name) for body in machine.moving}
    closed = machine.started(start)
    keep_chain(closed, machine)
    return closed


def stays_clear(machine: Machine, low: float = 0.0, high: float = math.tau) -> bool:
    """Whether the machine parts into dyads none of which comes near a fold over a range of theta, rad: so it closes there."""
    chain = chain_of(machine)
    if not all(isinstance(step, Direct | Dyad) for step in chain.steps):
        return False
    state = _looked(chain, low, high)
    chain.looked = None  # it is large, and not asked for again
    return _clear(chain, state, slice(None))


def _looked(chain: Chain, low: float, high: float) -> State:
    """The chain at angles of a range, the first at its beginning; kept until they are judged."""
    theta = _samples(low, high)
    if chain.looked is None or chain.looked.theta is not theta:
        chain.looked = chain.state(theta, 0)
    return chain.looked


@lru_cache(maxsize=4)
def _samples(low: float, high: float) -> Floats:
    return np.linspace(low, high, LOOKED + 1)


def _clear(chain: Chain, state: State, part: slice) -> bool:
    """Whether all dyads close and keep off their folds at some of the state's angles."""
    return all(
        bool((np.abs(_sine(chain, k, state, part)) > FAR).all())  # nan is not
        for k, step in enumerate(chain.steps)
        if isinstance(step, Dyad)
    )


def _sine(chain: Chain, number: int, state: State, part: slice) -> Floats:
    """Of a dyad's transmission angle, (n,), signed; nan where it does not close."""
    step = chain.steps[number]
    if not isinstance(step, Dyad) or step.kind != "angles":
        return determinant(chain, number, state.theta[part])
    a, b = step.block.angles
    size = abs(state.levers[a]) * abs(state.levers[b])
    sine: Floats = (np.conj(state.spins[a][0][part]) * state.spins[b][0][part]).imag / size
    return sine


def _pose(machine: Machine, state: State, body: str) -> Pose:
    """Of a body at the first angle of the state, turned by no more than half a turn from where it is drawn."""
    group = state.chain.groups.of[body]
    angle = 0.0 if group == GROUND else float(state.direction(group)[0])
    angle += state.chain.groups.excess[body]
    turns = round((float(machine.start_of(body).angle) - angle) / math.tau)
    return Pose(complex(np.ravel(state.origin(body)[0])[0]), angle + math.tau * turns)
