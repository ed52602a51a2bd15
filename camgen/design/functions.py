"""A four-bar whose rocker turns as a function of its crank, by pairs of angles.

    |d + c exp(i psi) - a exp(i phi)| = b:      K1 cos psi - K2 cos phi + K3 = cos(phi - psi)
    K1 = d / a     K2 = d / c     K3 = (a^2 - b^2 + c^2 + d^2) / (2 a c)

a crank, b coupler, c rocker, d frame O-C; phi, psi: angles of crank and rocker from the way O to C. Where the first pair
stands, phi0 and psi0, is free; given both, the K are linear: closed form for three pairs, least squares for more. A grid of
both gives drawings to start from, their lengths brought within the bounds. From there two problems are solved by SLSQP, in
phi0 and the lengths: the least worst error with the transmission angle and the lengths within bounds, and the greatest
transmission angle with the error within one.   [Freudenstein 1955]
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from camgen.design.found import CRANK, Found, Judged
from camgen.design.offers import Aim, Offer
from camgen.design.request import Request
from camgen.design.wanted import FunctionWish
from camgen.design.weighing import Designs
from camgen.errors import DesignError
from camgen.machine.targets import Function
from camgen.numerics import Floats, magnitude, solve
from camgen.reading import Data
from camgen.report.sketches import Sketch
from camgen.workers import Workers

ROCKER = "rocker"
_GRID = 90  # places of each of phi0 and psi0
_APART = 4  # places of the grid between two drawings to start from
_STARTS = 16  # by their error; half as many by their transmission angle
_LEVELS = 8  # transmission angles between both ends of the front
_BETWEEN = (
    181  # crank angles over the range at which a chain must close and its transmission angle counts
)
_COARSE = 31  # of them while a design is polished
_MARGIN = math.radians(0.05)  # of the transmission angle, for what lies between those
_WIDE = math.radians(
    1
)  # error up to which the transmission angle is raised where no tolerance is wanted, or _TIMES the least
_TIMES = 4.0
_ROUNDING = 1e-9  # by which a length may leave its bounds
_SEEN = 60  # places of the rocker's way in a sketch


@dataclass(frozen=True)
class Generator:
    """A four-bar on a frame of length 1: phi0, rad; side, +1 or -1, of the branch, see `_closed`; crank, coupler, rocker;
    worst error, rad; least transmission angle, rad."""

    phi0: float
    side: float
    lengths: tuple[float, float, float]
    error: float
    transmission: float

    def rocker(self, turns: Floats) -> Floats:
        """Its angle after turns of the crank, (m,) rad."""
        numbers = np.array([self.phi0, self.side, *self.lengths])[:, None]
        return np.asarray(_close(numbers, turns)[0][:, 0])

    def places(self, frame: float) -> Mapping[str, complex]:
        """Its points as drawn, at the first pair; frame: mm."""
        crank, _, rocker = self.lengths
        a = crank * np.exp(1j * self.phi0)
        b = 1 + rocker * np.exp(1j * self.rocker(np.zeros(1))[0])
        return {"O": 0j, "C": complex(frame), "A": complex(frame * a), "B": complex(frame * b)}


def offer(request: Request) -> Offer:
    """Four-bars for the function that a spec wants; SpecError, DesignError."""
    wish: FunctionWish
    _, wish = request.for_linkage(request.wish)
    found = partial(machine, wish, request.with_lash("lash_deg", wish.lash))
    searched = search(wish)
    losses = np.array([[each.error, -each.transmission] for each in searched])
    with Workers(request.jobs) as workers:
        designs = Designs(losses, lambda k: found(searched[k])).weighed(workers.map, request.say)
    best_in = "transmits best"
    error_counts = wish.tolerance is None
    return Offer(
        designs,
        Aim(wish.lash, wish.useful_play, "deg", error_counts, best_in, wish.further),
        f"Four-bars for the function of {request.data.get('name')}",
        "each comes nearer to the function than any design with a greater transmission angle. Design 1 is "
        "01.toml, and so on. Those that can be built come first.",
        {
            "worst_error_deg": "at most {:.4g} deg off at the pairs",
            "transmission_deg": "transmission angle {:.4g} deg and more",
            "lash": "play of {:.3g} deg",
        },
        "found by camgen design for a function; output.function: its pairs, and how far this machine may be off",
    )


def machine(wish: FunctionWish, tables: Data, each: Generator) -> Found:
    """A four-bar for the function as a machine of a spec's other tables."""
    turns = [x for x, _ in wish.turns]
    values = {"at": [list(pair) for pair in wish.turns]}
    default = "" if wish.tolerance else "a twentieth of the rocker's swing"
    off = (math.degrees(each.error), wish.allowance, "deg", "tolerance", default)
    judged = Judged({"name": "function", "link": ROCKER}, "function", values, Function.code, *off)
    crank, coupler, rocker = (wish.frame * length for length in each.lengths)
    figures = {
        "worst_error_deg": math.degrees(each.error),
        "transmission_deg": math.degrees(each.transmission),
        "crank_mm": crank,
        "coupler_mm": coupler,
        "rocker_mm": rocker,
    }
    places = each.places(wish.frame)
    moving = {CRANK: ["O", "A"], "coupler": ["A", "B"], ROCKER: ["C", "B"]}
    psi = each.rocker(np.radians(np.linspace(min(turns), max(turns), _SEEN)))
    way = np.asarray(wish.frame + rocker * np.exp(1j * psi))
    sketch = Sketch(places, list(moving.values()), ["O", "C"], way, way[:0])
    drive = {"link": CRANK, "range_deg": [min(turns), max(turns)], **tables.get("drive", {})}
    links = {"ground": ["O", "C"], **moving}
    return Found(places, links, drive, [judged], figures, -each.transmission, sketch, tables)


def search(wish: FunctionWish) -> list[Generator]:
    """Four-bars for the function: a front from the least error to the greatest least transmission angle; DesignError."""
    pairs = np.radians(np.array(wish.turns))
    least = math.radians(wish.transmission_deg)
    starts = _starts(pairs, wish)
    pool = [_polish(begin, pairs, wish, angle=least) for begin in starts]
    numbers = np.array(pool).T
    error, transmission = _judge(numbers, pairs, wish)
    steep_enough = transmission >= least
    nearest = float(np.min(error[steep_enough] if steep_enough.any() else error))
    allowance = math.radians(wish.tolerance or 0)
    useless = 0.5 * magnitude(pairs[:, 1])  # a rocker that rests is off by twice that
    if nearest > 0.98 * allowance:  # none wanted, or none within it
        allowance = min(max(_WIDE, _TIMES * nearest), useless)
    order = np.lexsort([error, np.maximum(0, least - transmission)])
    begins = [*numbers.T[order[: _STARTS // 2]], *starts[_STARTS:]]
    steep = [_polish(begin, pairs, wish, error=0.98 * allowance) for begin in begins]
    _, angles = _judge(np.array(steep).T, pairs, wish)
    pool += steep
    top = steep[int(np.argmax(angles))]
    first = max(least, float(transmission[order[0]]))
    for angle in np.linspace(max(angles), first, _LEVELS + 2)[
        1:-1
    ]:  # down from the best transmission angle
        top = _polish(top, pairs, wish, angle=angle)
        pool += [top, _polish(numbers[:, order[0]], pairs, wish, angle=angle)]
    numbers = np.array(pool).T
    error, transmission = _judge(numbers, pairs, wish)
    front: list[Generator] = []
    useful = error <= useless
    fit = np.flatnonzero(useful & (transmission >= least))
    for k in sorted(fit, key=lambda k: (round(float(error[k]), 9), -transmission[k])):
        if not front or transmission[k] > front[-1].transmission + math.radians(0.5):
            phi, side, *lengths = (float(each) for each in numbers[:, k])
            front.append(
                Generator(
                    phi,
                    side,
                    (lengths[0], lengths[1], lengths[2]),
                    float(error[k]),
                    float(transmission[k]),
                )
            )
    remedy = f"{wish.further}, or a function over smaller angles or with less curvature"
    if not useful.any():
        off = math.degrees(min(error))
        raise DesignError(
            "error at the pairs", off, math.degrees(useless), "deg", "wanted.function", remedy
        )
    if not front:
        best = math.degrees(float(np.max(transmission[useful])))
        raise DesignError(
            "least transmission angle",
            best,
            wish.transmission_deg,
            "deg",
            "wanted.function",
            remedy,
        )
    return front


def _starts(pairs: Floats, wish: FunctionWish) -> list[Floats]:
    """Drawings to polish, (5,) each, apart from each other: those of least error first, then those that transmit best."""
    places = math.tau * np.arange(_GRID) / _GRID
    phi0, psi0 = (each.ravel() for each in np.meshgrid(places, places))
    lengths = np.clip(_freudenstein(phi0, psi0, pairs), *wish.shares)
    back = lengths[0] * np.exp(1j * phi0) - 1  # from C to the crank's end
    side = np.sign(np.imag(np.conj(back) * np.exp(1j * psi0)))
    drawings = np.stack([phi0, np.where(side == 0, 1.0, side), *lengths])
    error, transmission = _judge(drawings, pairs, wish)
    short = np.maximum(0, math.radians(wish.transmission_deg) - transmission)
    near = error <= max(math.radians(wish.tolerance or 0), 2 * float(np.min(error)), 1e-9)
    starts: list[int] = []
    for worth, many in (
        (error + short, _STARTS),
        (np.where(near, -transmission, math.inf), _STARTS // 2),
    ):
        free = np.isfinite(worth)
        free[starts] = False
        for _ in range(many):
            candidates = np.flatnonzero(free)
            if not candidates.size:
                break
            starts.append(int(candidates[np.argmin(worth[candidates])]))
            away = [
                np.abs((each[starts[-1]] - each + math.pi) % math.tau - math.pi)
                for each in (phi0, psi0)
            ]
            free &= np.maximum(*away) > _APART * math.tau / _GRID
    return [drawings[:, k] for k in starts]


def _polish(
    begin: Floats,
    pairs: Floats,
    wish: FunctionWish,
    angle: float | None = None,
    error: float | None = None,
) -> Floats:
    """A design, (5,), of least worst error with at least that transmission angle, or of greatest angle within that error, rad.

    Unknowns: phi0, the lengths' logarithms, the worst error, the greatest cosine of a transmission angle. That cosine goes on
    smoothly where the chain does not close, above 1.
    """
    from scipy.optimize import minimize

    goal = 4 if error is None else 5
    turns = np.concatenate(
        [pairs[:, 0], np.linspace(pairs[:, 0].min(), pairs[:, 0].max(), _COARSE)]
    )

    def bounded(x: Floats) -> Floats:
        """What lies within plus and minus the error, and within plus and minus the cosine, (k, n), of unknowns (4, n)."""
        numbers = np.stack([x[0], np.full(x.shape[1], begin[1]), *np.exp(x[1:])])
        psi, cosine = _close(numbers, turns)
        return np.concatenate(
            [_wrap(psi[1 : len(pairs)] - psi[:1] - pairs[1:, 1:]), cosine[len(pairs) :]]
        )

    at_pairs = np.arange(len(pairs) - 1 + _COARSE) < len(pairs) - 1
    limits = np.stack([at_pairs, ~at_pairs], axis=1).astype(
        float
    )  # which of error and cosine limits what

    def room(x: Floats) -> Floats:
        value = bounded(x[:4, None])[:, 0]
        reach = limits @ x[4:]
        return np.concatenate([reach - value, reach + value])

    def slopes(x: Floats) -> Floats:
        step = 1e-6 * np.eye(4)
        ends = bounded(np.concatenate([x[:4, None] + step, x[:4, None] - step], axis=1))
        slope = (ends[:, :4] - ends[:, 4:]) / 2e-6
        return np.block([[-slope, limits], [slope, limits]])

    lengths = np.log(np.array(wish.shares))
    most = math.pi if error is None else error
    flattest = 1.0 if angle is None else math.cos(min(angle + _MARGIN, math.pi / 2))
    bounds = [(None, None), *[(lengths[0], lengths[1])] * 3, (0.0, most), (0.0, flattest)]
    start = np.concatenate([begin[:1], np.clip(np.log(begin[2:]), *lengths)])
    values = np.abs(bounded(start[:, None])[:, 0])
    start = np.append(
        start, [min(most, max(values[at_pairs])), min(flattest, max(values[~at_pairs]))]
    )
    within = {"type": "ineq", "fun": room, "jac": slopes}
    end = minimize(
        lambda x: x[goal],
        start,
        jac=lambda x: np.eye(6)[goal],
        bounds=bounds,
        constraints=within,
        method="SLSQP",
        options={"maxiter": 40, "ftol": 1e-15},
    )
    return (
        np.array([end.x[0], begin[1], *np.exp(end.x[1:4])]) if np.isfinite(end.x).all() else begin
    )


def _freudenstein(phi0: Floats, psi0: Floats, pairs: Floats) -> Floats:
    """Crank, coupler and rocker on a frame of 1 for places of the first pair, (n,) rad each: (3, n), nan where there are none."""
    phi = phi0[:, None] + pairs[:, 0]
    psi = psi0[:, None] + pairs[:, 1]
    table = np.stack([np.cos(psi), -np.cos(phi), np.ones(phi.shape)], axis=-1)
    right = np.cos(phi - psi)
    if len(pairs) > 3:  # normal equations: three unknowns, each of size 1
        right = np.sum(table * right[..., None], axis=1)
        table = np.sum(table[:, :, :, None] * table[:, :, None, :], axis=1)
    k1, k2, k3 = solve(table, right).T
    with np.errstate(all="ignore"):
        crank = 1 / k1
        rocker = 1 / k2
        coupler = np.sqrt(crank**2 + rocker**2 + 1 - 2 * crank * rocker * k3)
        return np.where((crank > 0) & (rocker > 0), np.stack([crank, coupler, rocker]), math.nan)


def _close(numbers: Floats, turns: Floats) -> tuple[Floats, Floats]:
    """Rocker's angle, and cosine of the transmission angle, (m, n), of designs (5, n) after turns of the crank, (m,).

    The rocker stays to one side of the way from its pivot to the crank's end: +1 counter-clockwise of it. A cosine beyond
    -1 to 1 is that of a chain that does not close there.
    """
    phi0, side, crank, coupler, rocker = numbers
    way = 1 - crank * np.exp(1j * (phi0 + turns[:, None]))  # from the crank's end to C
    span = np.maximum(np.abs(way), 1e-12)
    at_pivot = (span**2 + rocker**2 - coupler**2) / (
        2 * span * rocker
    )  # between the way back and the rocker
    psi = np.angle(-way) + side * np.arccos(np.clip(at_pivot, -1, 1))
    return psi, (rocker**2 + coupler**2 - span**2) / (2 * rocker * coupler)


def _wrap(angle: Floats) -> Floats:
    """Within half a turn, rad."""
    return np.asarray(np.mod(angle + math.pi, math.tau) - math.pi)


def _judge(numbers: Floats, pairs: Floats, wish: FunctionWish) -> tuple[Floats, Floats]:
    """Worst error at the pairs and least transmission angle over the range, rad, (n,); inf and -1 where a design is none."""
    sides = np.array([*numbers[2:], np.ones(numbers.shape[1])])
    least = wish.shares[0] - _ROUNDING
    greatest = wish.shares[1] + _ROUNDING
    fit = (
        np.isfinite(sides).all(axis=0)
        & (sides.min(axis=0) >= least)
        & (sides.max(axis=0) <= greatest)
    )
    feasible = np.flatnonzero(fit)
    error = np.full(fit.size, math.inf)
    transmission = np.full(fit.size, -1.0)
    psi, _ = _close(numbers[:, feasible], pairs[:, 0])
    error[feasible] = np.max(np.abs(_wrap(psi - psi[:1] - pairs[:, 1:])), axis=0)
    _, cosine = _close(
        numbers[:, feasible], np.linspace(pairs[:, 0].min(), pairs[:, 0].max(), _BETWEEN)
    )
    flattest = np.max(np.abs(cosine), axis=0)
    transmission[feasible] = np.where(flattest > 1, -1.0, np.arccos(np.minimum(flattest, 1)))
    return error, transmission
