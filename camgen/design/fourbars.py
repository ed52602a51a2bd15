"""Four-bars at the positions where something is wanted of them, many at once: their defects, and how well they transmit.

    O, C    pivots of crank and rocker       A, B    crank's and rocker's joint with the coupler       P    a point of the coupler

bounds         a link or a pivot is not where the wish lets it be
circuit        some position is reached only by taking the four-bar apart
branch         a dead point lies between two positions
order          the crank does not come to the positions in their order within one turn
turn           the crank does not turn all round, where that is wanted
transmission   the angle between coupler and rocker is too small somewhere on the way
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camgen.numerics import Floats, Points

Flags = NDArray[np.bool_]

DEFECTS = ("bounds", "circuit", "branch", "order", "turn", "transmission")
_ROUNDING = 1e-6  # mm, by which a length may leave its bounds
_ON_THE_WAY = 90  # crank angles at which the coupler's turn is followed
_FLAT = 60.0  # allowances, as much as which a cosine counts that is 1 too great
_SPARE = 1e-3  # of an allowance: by so much a search stays within its bounds, for what is least ends a little beyond them
_CHANGE_POINT = 1e-6  # of all lengths: a margin by Grashof that is less is none


@dataclass(frozen=True)
class FourBars:
    """m four-bars at n positions; complex mm."""

    o: Points  # (m,)
    c: Points  # (m,)
    a: Points  # (n, m), at each position
    b: Points  # (n, m)
    p: Points  # (n, m)

    def those(self, which: NDArray[np.intp] | Flags) -> FourBars:
        """Some of them, by numbers or by flags."""
        joints = (self.a, self.b, self.p)
        return FourBars(self.o[which], self.c[which], *(each[:, which] for each in joints))

    @cached_property
    def lengths(self) -> Floats:
        """Frame, crank, coupler and rocker, (4, m)."""
        sides = (self.c - self.o, self.a[0] - self.o, self.b[0] - self.a[0], self.b[0] - self.c)
        return np.asarray(np.abs(np.stack(sides)))

    @cached_property
    def bars(self) -> Floats:
        """Lengths of all bars together, those from A and B to P among them, (m,)."""
        arms = np.abs(self.p[0] - self.a[0]) + np.abs(self.p[0] - self.b[0])
        return np.asarray(np.sum(self.lengths[1:], axis=0) + arms)

    @cached_property
    def turns(self) -> Flags:
        """Whether the crank turns all round: it or the frame is the shortest, and Grashof holds with some margin."""
        length = np.sort(self.lengths, axis=0)
        margin = length[1] + length[2] - length[0] - length[3]
        shortest = np.argmin(self.lengths, axis=0)
        return np.asarray((margin > _CHANGE_POINT * length.sum(axis=0)) & (shortest <= 1))

    @cached_property
    def angles(self) -> Floats:
        """Crank angles from the first position, (n, m) rad, on the way on which the chain closes.

        Of a crank that turns they grow, or fall, within one turn if its order allows. One that does not turn stays on its
        side of the frame's line, or crosses it where the chain closes there.
        """
        frame, crank, coupler, rocker = self.lengths
        from_frame = np.angle((self.a - self.o) * np.conj(self.c - self.o))
        across = np.abs(frame - crank) >= np.abs(coupler - rocker)  # closes on the frame's line
        swung = np.where(across, from_frame, np.mod(from_frame, math.tau))
        swung = swung - swung[0]
        forwards = np.mod(from_frame - from_frame[0], math.tau)
        backwards = forwards - math.tau * (forwards > 0)
        falls = np.sum(np.diff(backwards, axis=0) > 0, axis=0)
        rises = np.sum(np.diff(forwards, axis=0) < 0, axis=0)
        turned = np.where(falls < rises, backwards, forwards)
        return np.asarray(np.where(self.turns, turned, swung))

    @cached_property
    def side(self) -> Floats:
        """On which side of the coupler the rocker goes on at B, (n, m): 1 or -1, the branch."""
        return np.asarray(np.sign(np.imag(np.conj(self.b - self.a) * (self.c - self.b))))

    @property
    def in_order(self) -> Flags:
        """Whether the crank comes to the positions in their order, (m,)."""
        steps = np.diff(self.angles, axis=0)
        return np.asarray((steps > 0).all(axis=0) | (steps < 0).all(axis=0))

    def transmission(self, all_round: bool) -> Floats:
        """Least angle between coupler and rocker, (m,) rad: over a turn, or from the least to the greatest crank angle.

        -1 where the chain opens. The way from A to C is longest and shortest on the frame's line or at an end.
        """
        frame, crank, coupler, rocker = self.lengths
        begin = np.angle((self.a[0] - self.o) * np.conj(self.c - self.o))
        low = begin + np.min(self.angles, axis=0)
        high = begin + np.max(self.angles, axis=0)
        cosines = np.stack([np.cos(low), np.cos(high)])
        passed = [np.ceil((low - each) / math.tau) * math.tau + each <= high for each in (0, np.pi)]
        near = passed[0] | all_round
        far = passed[1] | all_round
        most = np.where(near, 1.0, cosines.max(axis=0))
        least = np.where(far, -1.0, cosines.min(axis=0))
        ways = frame**2 + crank**2 - 2 * frame * crank * np.stack([most, least])
        with np.errstate(divide="ignore", invalid="ignore"):  # links of no length
            cosine = (coupler**2 + rocker**2 - ways) / (2 * coupler * rocker)
        flattest = np.max(np.abs(cosine), axis=0)
        return np.where(flattest <= 1, np.arccos(np.minimum(flattest, 1)), -1.0)

    def driven(self, theta: Floats) -> FourBars:
        """The same at other crank angles, (n',) rad from the first position, on the branch of that."""
        _, _, coupler, rocker = self.lengths
        a = self.o + (self.a[0] - self.o) * np.exp(1j * theta[:, None])
        b = closed(a, self.c, coupler, rocker, self.side[0])
        p = a + (b - a) * ((self.p[0] - self.a[0]) / (self.b[0] - self.a[0]))
        return FourBars(self.o, self.c, a, b, p)

    def with_cognates(self) -> FourBars:
        """These, the two cognates of each, and all of them driven by their rockers, (6 m).  [Roberts]"""
        toward_a = (self.p - self.a) / (self.b - self.a)
        toward_b = (self.p - self.b) / (self.a - self.b)
        third = self.o + (self.c - self.o) * toward_a[0]
        a = self.o + self.p - self.a
        b = self.c + self.p - self.b
        at_o = FourBars(self.o, third, a, a + (self.a - self.o) * toward_a, self.p)
        at_c = FourBars(self.c, third, b, b + (self.b - self.c) * toward_b, self.p)
        cognates = joined(joined(self, at_o), at_c)
        back = FourBars(cognates.c, cognates.o, cognates.b, cognates.a, cognates.p)
        return joined(cognates, back)

    def defects(self) -> Mapping[str, Flags]:
        """Which have which defect besides bounds and the transmission angle, (m,).

        A Grashof four-bar whose coupler or rocker is the shortest has two circuits, one on each side of the frame's line;
        with another shortest link its circuits are the branches of a crank that turns.
        """
        length = np.sort(self.lengths, axis=0)
        grashof = length[0] + length[3] < length[1] + length[2]
        above = np.imag((self.a - self.o) * np.conj(self.c - self.o)) > 0
        sided = grashof & (np.argmin(self.lengths, axis=0) >= 2) & (above != above[0]).any(axis=0)
        branches = (self.side != self.side[0]).any(axis=0)
        return {
            "circuit": sided | (grashof & self.turns & branches),
            "branch": branches,
            "order": ~self.in_order,
        }


@dataclass(frozen=True)
class Room:
    """Where a four-bar may be, and how large: lengths in mm, both pivots within a box; transmission: least angle, rad.

    turns: whether the crank is to turn all round; None: where it can.
    """

    low: complex
    high: complex
    shortest: float
    longest: float
    transmission: float
    turns: bool | None

    def wider(self, times: float, pivots: bool, longest: bool) -> Room:
        """The same with so many times as wide a box for the pivots, so many times as long links, or both."""
        middle = (self.low + self.high) / 2
        to_corner = times * (self.high - middle) if pivots else self.high - middle
        length = times * self.longest if longest else self.longest
        return replace(self, low=middle - to_corner, high=middle + to_corner, longest=length)

    def outside(self, places: Points) -> Floats:
        """How far places lie outside the box, mm."""
        x = np.maximum(self.low.real - places.real, places.real - self.high.real)
        y = np.maximum(self.low.imag - places.imag, places.imag - self.high.imag)
        return np.asarray(np.maximum(np.maximum(x, y), 0.0))

    def excess(self, lengths: Floats) -> Floats:
        """How much lengths are too long or too short, mm."""
        beyond = np.maximum(lengths - self.longest, self.shortest - lengths)
        return np.asarray(np.maximum(beyond, 0.0))

    def lack(self, bars: FourBars, all_round: Flags, allowance: float) -> tuple[Floats, Floats]:
        """What four-bars lack of the room, and of the transmission angle, (rows, m) each, 0 where all is well: for a search.

        all_round: which are to transmit over a whole turn; allowance: mm, of which lengths and pivots count as shares.
        """
        frame, crank, coupler, rocker = bars.lengths
        ends = np.stack([np.abs(frame - crank), frame + crank])
        flattest = math.cos(self.transmission)

        def flat(ways: Floats) -> Floats:
            cosine = (coupler**2 + rocker**2 - ways**2) / (2 * coupler * rocker)
            return np.asarray(_FLAT * np.clip(np.abs(cosine) - flattest, 0.0, 9.0))

        steep = [flat(np.abs(bars.c - bars.a)), flat(ends) * all_round]
        out = self._within(_SPARE * allowance)._beyond(bars)
        return out / allowance, np.concatenate(steep)

    def bounds(self, bars: FourBars) -> Flags:
        """Which are not where they may be, or not of a length that they may have, (m,)."""
        return np.asarray((self._beyond(bars) > _ROUNDING).any(axis=0))

    def _within(self, margin: float) -> Room:
        """The same with bounds of lengths and pivots that are closer by a margin, mm."""
        corner = complex(margin, margin)
        return replace(
            self,
            low=self.low + corner,
            high=self.high - corner,
            shortest=self.shortest + margin,
            longest=self.longest - margin,
        )

    def _beyond(self, bars: FourBars) -> Floats:
        """How much lengths and pivots of four-bars are out of bounds, (rows, m) mm."""
        arms = np.abs(np.stack([bars.p[0] - bars.a[0], bars.p[0] - bars.b[0]]))
        pivots = self.outside(np.stack([bars.o, bars.c]))
        return np.concatenate([self.excess(bars.lengths), self.excess(arms), pivots])

    def judged(self, bars: FourBars) -> Verdict:
        """Which four-bars have no defect, how they are driven, and what stops the others."""
        flags = {"bounds": self.bounds(bars), **bars.defects()}
        return verdict_of(flags, bars.turns, bars.transmission, self)


@dataclass(frozen=True)
class Verdict:
    """What a room says of m four-bars."""

    free: NDArray[np.intp]  # numbers of those without a defect
    all_round: Flags  # which turn, (m,); the others go to and fro
    transmission: Floats  # least angle on the way, (m,) rad
    defects: Mapping[str, int]  # how many are stopped by which: each by the first that it has


@dataclass(frozen=True)
class Motion:
    """How one four-bar is driven: all round, or from its least to its greatest crank angle and back."""

    bars: FourBars  # one
    all_round: bool

    @property
    def theta(self) -> Floats:
        """Crank angle of each position, (n,) rad from the first."""
        return np.asarray(self.bars.angles[:, 0])

    @property
    def ends(self) -> tuple[float, float]:
        """Least and greatest crank angle, rad."""
        if self.all_round:
            return 0.0, math.tau
        return float(np.min(self.theta)), float(np.max(self.theta))

    @property
    def sense(self) -> int:
        """Of a crank that comes to the positions in their order: 1 counter-clockwise, -1 clockwise."""
        return 1 if self.theta[-1] >= 0 else -1

    def path(self, count: int) -> Points:
        """What P traces, (count,) complex mm."""
        return np.asarray(self.bars.driven(np.linspace(*self.ends, count)).p[:, 0])

    @property
    def coupler(self) -> Floats:
        """How far the coupler has turned at each position, (n,) rad from the first, whole turns counted."""
        return np.array([self._turned(end) for end in self.theta])

    def _turned(self, end: float) -> float:
        on_the_way = self.bars.driven(np.linspace(0.0, end, _ON_THE_WAY))
        arm = (on_the_way.b - on_the_way.a)[:, 0]
        return float(np.unwrap(np.angle(arm / arm[0]))[-1])


def closed(a: Points, c: Points, coupler: Floats, rocker: Floats, sides: Floats) -> Points:
    """B of each position, (n, m), on its side of A-C; where the chain is open, the nearest to both on the line A-C."""
    way = c - a
    span = np.maximum(np.abs(way), 1e-12)
    along = (span**2 + coupler**2 - rocker**2) / (2 * span)
    up = np.sqrt(np.maximum(coupler**2 - along**2, 0.0))
    return np.asarray(a + way / span * (along - 1j * sides * up))


def joined(one: FourBars, other: FourBars) -> FourBars:
    """Those of both, at the same positions."""
    return FourBars(
        np.concatenate([one.o, other.o]),
        np.concatenate([one.c, other.c]),
        np.concatenate([one.a, other.a], axis=1),
        np.concatenate([one.b, other.b], axis=1),
        np.concatenate([one.p, other.p], axis=1),
    )


def verdict_of(
    flags: Mapping[str, Flags],
    turns: Flags,
    transmission: Callable[[bool], Floats],
    room: Room,
) -> Verdict:
    """Of linkages whose other defects are known: each is driven all round where it can be and that is not refused.

    transmission: least angle, rad, over a turn (True) or over the positions' range (False).
    """
    over_turn = transmission(True)
    over_range = transmission(False)
    if room.turns:
        all_round = turns
    else:
        all_round = turns & (over_turn >= room.transmission) & (room.turns is None)
    reached = np.where(all_round, over_turn, over_range)
    every = {
        **flags,
        "turn": ~turns & bool(room.turns),
        "transmission": reached < room.transmission,
    }
    stopped = np.zeros(turns.shape, bool)
    counts = {}
    for name in (name for name in DEFECTS if name in every):
        counts[name] = int(np.sum(every[name] & ~stopped))
        stopped = stopped | every[name]
    return Verdict(np.flatnonzero(~stopped), all_round, reached, counts)
