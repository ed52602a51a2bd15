"""The two-thread flat chain stitch: figures of its two needles and two spreaders, as printed and as they should be.

    needle 1, 2       stand `spacing` apart across the feed; phi is the shaft's angle, 0 with the needles at their lowest
    spreader 1, 2     catch the loop of their own needle with the nose, carry it to the other needle's line, widen it, shed it
    S, L              how far needles have risen and spreaders moved, mm; S_X, L_X their strokes; r = dL/dS
    capture, pierce   the nose takes the loop (needle risen by S0); a needle enters the other spreader's loop (risen by S_B)
    nose level        of the upper spreader 2 at -(e + b) below the plate's top, of spreader 1 a height H lower
    u, y              in a spreader: rearward from the nose's tip along the stroke, upwards from nose level
    P6                the slanting front of the spreader's body, from B (l1, 0) up to C (A, b)

A pair is always (of needle or spreader 1, of 2). Lengths mm, angles rad.
[Horobets, Manoilenko: New method of forming a flat chain stitch; its seven errors are corrected]
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.motion.laws import LAWS, Law, reversed_law, slider_crank
from camgen.motion.program import Program, Segment
from camgen.numerics import Floats, roots

Pair = tuple[float, float]

HOLDS = (0.4, 0.8)  # rad, up to which a loop stays where it is on a cylinder, by thread and surface
_USUAL_E = 4.0  # mm, middle of the usual 3 to 5, which the source puts into S_m in place of its own
_STEPS = 7200  # of the turn, between which a position is bracketed
# into which a bracket is cut, and how often: to the last bit
_PARTS = 256
_ROUNDS = 6
HAIR = 1e-12  # share of the stroke
VANISHING = 1e-9  # share of the stroke that is none


def to_and_fro(law: Law, back: Law | None = None) -> Program:
    """Rise by 1 over the first half turn and return over the second, by the same law or another."""
    return Program(
        (
            Segment("rise", math.pi, 0.0, 1.0, law),
            Segment("return", math.pi, 1.0, -1.0, back or law),
        )
    )


def crank_driven(distortion: float) -> Program:
    """Rise by 1 and return by crank and rod, crank over rod = distortion: the return is the rise passed backwards."""
    law = slider_crank(distortion)
    return to_and_fro(law, reversed_law(law)) if distortion else HARMONIC


HARMONIC = to_and_fro(LAWS["simple-harmonic"])


@dataclass(frozen=True)
class Stitch:
    """What the designer gives, with the source's symbol beside each name."""

    spacing: float  # z
    point: Pair  # h, tip to top of the eye
    over_eye: Pair  # a, nose above the top of the eye at capture
    rise: Pair  # S0, needle's rise at capture
    needle: float  # d, largest diameter
    plate: float  # e, top of the plate to top of the upper spreader
    protrusion: float  # l_H
    feed: float  # phi_t
    thickness: float  # m
    ratio: float  # r
    side_gap: float = 0.0  # c_g, between needle and nose
    setback: float = 0.0  # of P6 behind the way of the needle that comes nearest to it
    stroke: float | None = None  # S_X; None: as large as the feed asks for
    needle_program: Program = HARMONIC  # 0 to 1 over the turn
    spreader_program: Program = HARMONIC
    lag: float = 0.0  # by which the spreaders come after the needles

    @property
    def of_source(self) -> bool:
        """Whether these are the inputs of the source's worked example; the gap beside a nose is not in it."""
        return replace(self, side_gap=0.0) == SOURCE

    @property
    def differences(self) -> Pair:
        """Da and Dh: of the noses above the eyes, and of the points."""
        return self.over_eye[1] - self.over_eye[0], self.point[1] - self.point[0]

    @property
    def height(self) -> float:
        """Height b of a spreader above nose level; of two conditions that contradict each other the least-squares answer."""
        da, dh = self.differences
        return da + 0.5 * dh

    @property
    def pitch(self) -> float:
        """Height H between the two nose levels."""
        return self.height + self.protrusion

    @property
    def between(self) -> float:
        """DS, the needle's way between the two pierces."""
        return 2 * self.pitch - sum(self.differences)

    @property
    def reach(self) -> Pair:
        """a + h: how far a needle rises from capture until its tip is at its own spreader's nose level."""
        return self.over_eye[0] + self.point[0], self.over_eye[1] + self.point[1]

    @property
    def levels(self) -> Pair:
        """Nose level of each spreader below the plate's top."""
        upper = self.plate + self.height
        return upper + self.pitch, upper

    @property
    def depths(self) -> Pair:
        """How far below the plate's top each needle's tip is at its lowest."""
        one, two = self.levels
        up1, up2 = self.reach
        s1, s2 = self.rise
        return one + up1 + s1, two + up2 + s2

    @property
    def entry(self) -> Pair:
        """Rise of the other needle (2 for spreader 1) when its tip is at a spreader's nose level."""
        return self.depths[1] - self.levels[0], self.depths[0] - self.levels[1]

    @property
    def approach(self) -> Pair:
        """Way of the needles from a spreader's capture until the other needle's tip is at its nose level."""
        return self.entry[0] - self.rise[0], self.entry[1] - self.rise[1]

    @property
    def pierce_rises(self) -> Pair:
        """S_B, rise of the needles when each enters the other spreader's loop."""
        return (
            self.reach[0] + self.rise[0] + 2 * self.pitch,
            self.reach[1] + self.rise[1] + self.height,
        )

    def in_fabric(self, plate: float) -> Pair:
        """S_m, way of each needle from its lowest point out of the fabric, for e = plate."""
        one, two = self.pierce_rises
        return one + plate + self.thickness, two + plate + self.thickness

    def needle_stroke(self, in_fabric: Pair) -> float:
        """S_X at which the needle that is longer in the fabric is out of it while the feed moves."""
        return max(in_fabric) / self.free_share if self.stroke is None else self.stroke

    @cached_property
    def free_share(self) -> float:
        """Share of their stroke above which the needles are for the feed's angle."""
        if self.needle_program is HARMONIC:
            return math.cos(self.feed / 4) ** 2  # half of 1 - cos phi_m, without cancellation

        def longer(share: float) -> float:
            up, down = (_angle(self.needle_program, share, falling) for falling in (False, True))
            return float(np.nan_to_num(down - up)) - self.feed

        if longer(1 - HAIR) >= 0:  # a dwell at the top, as long as the feed
            return 1 - HAIR
        if longer(VANISHING) < 0:
            _refuse(
                "feed_deg",
                math.degrees(self.feed),
                (0.0, math.degrees(longer(VANISHING) + self.feed)),
                "deg",
                "shaft angle over which the needles are off their lowest point",
                "let them dwell there for less",
            )
        ends = np.array([VANISHING]), np.array([1 - HAIR])
        return float(roots(lambda share, _: (np.array([longer(share[0])]), np.zeros(1)), *ends)[0])

    def design(self, published: bool = False) -> Design:
        """All figures, corrected or as printed; DesignError where no such mechanism exists."""
        if not self.height > 0:
            raise DesignError(
                "b",
                self.height,
                0.0,
                "mm",
                "height of a spreader, (a2 - a1) + (h2 - h1)/2",
                "it must be positive: give needle 2 the longer point (point_lengths) or the higher nose (nose_over_eye)",
            )
        if not self.spacing > self.needle:
            raise DesignError(
                "needle_spacing",
                self.spacing,
                self.needle,
                "mm",
                "the needles' diameter",
                "the needles would meet",
            )
        return _published(self) if published else _corrected(self)


SOURCE = Stitch(
    6.4, (4.0, 6.0), (1.5, 4.0), (2.0, 4.5), 0.9, 8.0, 1.0, math.radians(120), 3.5, 0.8
)  # its worked example


@dataclass(frozen=True)
class Design:
    """Figures that follow."""

    given: Stitch
    ratio: float  # r that l1 and l2 are made with
    l1: float
    l2: float
    opening: float  # f
    in_fabric: Pair  # S_m
    needle_stroke: float  # S_X
    spreader_stroke: float  # L_X
    rises: Pair  # S_B
    capture: Pair  # phi3
    pierce: Pair  # phi4
    behind: Pair  # L_C
    needed: Pair  # L_X1, L_X2, strokes for a loop held at the nose's root
    first: tuple[float, float, float]  # l1, l2, A that the strokes are made with

    @property
    def l3(self) -> float:
        """From the nose's tip to the thread's seat."""
        return self.l1 - self.given.needle

    @property
    def nose(self) -> float:
        """A, from the nose's tip to the upper end of P6."""
        return self.l1 + self.l2

    @property
    def slope(self) -> float:
        """alpha of P6 above the stroke, rad."""
        return math.atan2(self.given.height, self.l2)

    # ---- motion ------------------------------------------------------------------------------------------------------

    def risen(self, phi: Floats, order: int = 0) -> Floats:
        """S, how far the needles are above their lowest point, mm, or its derivative to phi; (n,)."""
        return self.needle_stroke * self.given.needle_program(phi, order)

    def moved(self, phi: Floats, order: int = 0) -> Floats:
        """L, how far the spreaders have moved, mm, or its derivative to phi; (n,)."""
        return self.spreader_stroke * self.given.spreader_program(
            np.asarray(phi, float) - self.given.lag, order
        )

    @cached_property
    def before(self) -> Pair:
        """L0, how far each spreader moves before its nose is at its needle."""
        one, two = self.moved(np.array(self.capture))
        return float(one), float(two)

    def tips(self, phi: Floats) -> tuple[Floats, Floats]:
        """Height of each needle's tip above the plate's top, mm; (n,) each."""
        s = self.risen(phi)
        one, two = self.given.depths
        return s - one, s - two

    def noses(self, phi: Floats) -> tuple[Floats, Floats]:
        """Way of each spreader's nose beyond its own needle, towards the other one, mm; (n,) each."""
        moved = self.moved(phi)
        one, two = self.before
        return moved - one, moved - two

    def angle(self, risen: float, falling: bool = False) -> float:
        """phi at which the needles have risen so far, first while rising or last while falling; nan where they never do."""
        return _angle(self.given.needle_program, risen / self.needle_stroke, falling)

    # ---- loops -------------------------------------------------------------------------------------------------------

    @cached_property
    def entries(self) -> Pair:
        """phi at which the other needle's tip comes down to the nose level of spreader 1, of 2; nan where it never does."""
        one, two = (self.angle(s, falling=True) for s in self.given.entry)
        return one, two

    def margins_of(self, noses: Callable[[Floats], tuple[Floats, Floats]]) -> Pair:
        """How far each nose is past the other needle's axis when that needle's tip comes down to nose level, mm.

        noses: way of each nose beyond its own needle at phi, (n,) rad -> (n,) mm each. Positive: a loop that slides along the
        nose is pierced. nan: the tip is never there.
        """
        one, two = noses(np.nan_to_num(self.entries))
        gap = np.where(np.isnan(self.entries), math.nan, [one[0], two[1]]) - self.given.spacing
        return float(gap[0]), float(gap[1])

    @property
    def margins(self) -> Pair:
        """How far each nose is past the other needle's axis when that comes down to it, as `margins_of` has it."""
        return self.margins_of(self.noses)

    @property
    def seat_margins(self) -> Pair:
        """How far each seat at l3 is past that axis, mm: there lies a loop held at the nose's root."""
        one, two = self.margins
        return one - self.l3, two - self.l3

    @property
    def pierce_angles(self) -> Pair:
        """gamma', of the loops' legs to the vertical at the pierce, rad; they should be equal."""
        way = self.given.spacing + self.l2
        lower, upper = self.given.levels
        return math.atan2(way + self.behind[0], upper), math.atan2(way + self.behind[1], lower)

    @property
    def shed_angles(self) -> Pair:
        """gamma'', of the loops' legs to the vertical at shedding, rad: from the own needle's line down to the nose's tip under the other's."""
        one, two = (math.atan2(self.given.spacing, level) for level in self.given.levels)
        return one, two

    @property
    def shed(self) -> Pair:
        """phi at which each nose leaves the other needle's line on its way back; nan where it never gets there."""
        g = self.given
        wanted = [(l0 + g.spacing) / self.spreader_stroke for l0 in self.before]
        one, two = ((_angle(g.spreader_program, x, True) + g.lag) % math.tau for x in wanted)
        return one, two

    @property
    def out_of_fabric(self) -> Pair:
        """Shaft angle over which each needle is out of the fabric, rad; a hair is spared, for near the top a rounding tells."""
        heights = [s - HAIR * self.needle_stroke for s in self.in_fabric]
        one, two = (
            float(np.nan_to_num(self.angle(s, falling=True) - self.angle(s))) for s in heights
        )
        return one, two

    # ---- what a ratio must keep --------------------------------------------------------------------------------------

    def offsets(self) -> dict[str, float]:
        """Needle's tip before P6, along the stroke at nose level, mm, when both move in step; by "N1/P2"."""
        g = self.given
        r = self.spreader_stroke / self.needle_stroke
        ways = {
            "N1/P1": g.reach[0] * r,
            "N2/P1": g.approach[0] * r - g.spacing,
            "N2/P2": g.reach[1] * r,
            "N1/P2": g.approach[1] * r - g.spacing,
        }
        return {pair: self.l1 - way for pair, way in ways.items()}


def _angle(program: Program, share: float, falling: bool) -> float:
    """phi at which a program passes `share`, bracketed on even steps, then on finer ones; nan where it never does."""
    if not 0 <= share <= 1:
        return math.nan
    sign = -1 if falling else 1
    phi = np.linspace(0, math.tau, _STEPS + 1)[:-1]
    over = sign * (program(phi) - share)
    after = np.roll(over, -1)
    steps = np.flatnonzero((over <= 0) & (after >= 0) & (over < after))
    if not len(steps):
        return math.nan
    low = float(phi[steps[-1 if falling else 0]])
    high = low + math.tau / _STEPS
    for _ in range(_ROUNDS):
        grid = np.linspace(low, high, _PARTS + 1)
        past = sign * (program(grid) - share) >= 0
        k = max(1, int(np.argmax(past))) if past.any() else _PARTS
        low = float(grid[k - 1])
        high = float(grid[k])
    return (low + high) / 2


def _refuse(quantity: str, value: float, limits: Pair, unit: str, where: str, remedy: str) -> None:
    """DesignError unless the value lies between the limits."""
    low, high = limits
    if not low < value < high:
        raise DesignError(quantity, value, low if not value > low else high, unit, where, remedy)


def _seat(l1: float, needle: float) -> None:
    _refuse(
        "l3",
        l1 - needle,
        (0.0, math.inf),
        "mm",
        "thread's seat behind the nose's tip, l1 - d",
        "it must be positive: use a larger velocity_ratio or a thinner needle",
    )


def _within(stroke: float, pierces: Pair, captures: Pair) -> None:
    """DesignError unless the needles rise so far."""
    for name, s in zip(("S_B1", "S_B2", "S01", "S02"), (*pierces, *captures), strict=True):
        _refuse(
            name,
            s,
            (0.0, stroke),
            "mm",
            "the needles, whose stroke S_X is the limit",
            "use a longer needle_stroke",
        )


def _corrected(g: Stitch) -> Design:
    r = g.ratio
    in_fabric = g.in_fabric(g.plate)
    l1 = max(g.reach) * r + g.setback
    l2 = g.height * r
    _seat(l1, g.needle)
    stroke = g.needle_stroke(in_fabric)
    rises = g.pierce_rises
    _within(stroke, rises, g.rise)
    capture1, capture2 = (_angle(g.needle_program, s / stroke, False) for s in g.rise)
    pierce1, pierce2 = (_angle(g.needle_program, s / stroke, True) for s in rises)
    behind = (0.0, g.between * r)
    opening = (g.needle + g.side_gap) * (g.spacing + max(behind)) / g.spacing
    share = g.spreader_program(np.array([capture1, capture2, pierce1, pierce2]) - g.lag)
    left = (float(share[3] - share[0]), float(share[2] - share[1]))
    return Design(
        g,
        r,
        l1,
        l2,
        opening,
        in_fabric,
        stroke,
        r * stroke,
        rises,
        (capture1, capture2),
        (pierce1, pierce2),
        behind,
        _strokes(g.spacing + l1 + l2, behind, left),
        (l1, l2, l1 + l2),
    )


def _strokes(way: float, behind: Pair, shares: Pair) -> Pair:
    """Strokes L_X1 and L_X2 from what of them is left between a capture and the pierce by the other needle."""
    for k, share in enumerate(shares):
        _refuse(
            f"f2(phi4{2 - k}) - f2(phi3{k + 1})",
            share,
            (VANISHING, math.inf),
            "",
            f"stroke L_X{k + 1} of spreader {k + 1}",
            "the pierce must find the spreader farther out than the capture did: change loop_rise or nose_over_eye",
        )
    return (behind[1] + way) / shares[0], (behind[0] + way) / shares[1]


def _published(g: Stitch) -> Design:
    """The source's own way, its errors and its rounding included."""
    in_fabric = g.in_fabric(_USUAL_E)  # erratum 1
    stroke = g.needle_stroke(in_fabric)
    l1 = max(g.reach) * g.ratio
    l2 = g.height * g.ratio
    _seat(l1, g.needle)
    rises = (  # erratum 3: H + l_H too much
        g.reach[0] + g.rise[0] + 2 * g.pitch,
        g.reach[1] + g.rise[1] + g.pitch + g.between,
    )
    _within(stroke, rises, g.rise)

    def arc(s: float) -> float:
        return math.acos(1 - 2 * s / stroke)

    capture = arc(g.rise[0]), arc(g.rise[1])
    pierce = math.pi + arc(rises[0]), math.pi + arc(rises[1])  # erratum 2
    behind = (0.0, g.between * g.ratio)

    def cosine(angle: float) -> float:
        # as far as it is printed
        return round(math.cos(math.radians(round(math.degrees(angle), 1))), 3)

    slipped = 0.1 * cosine(pierce[0])  # 0.003 for 0.03
    shares = cosine(capture[0]) - cosine(pierce[1]), cosine(capture[1]) - slipped
    # erratum 4: f2 is 1 - cos, so half of it is the share
    needed = _strokes(g.spacing + l1 + l2, behind, shares)
    spreader_stroke = round(max(needed), 1)
    # erratum 5: dS/dL in place of dL/dS, cut off after two places
    inverse = math.floor(100 * stroke / spreader_stroke) / 100
    new1 = round(max(g.reach) * inverse, 1)
    new2 = round(g.height * inverse, 1)
    _seat(new1, g.needle)
    opening = g.needle * (g.spacing + max(behind)) / g.spacing
    return Design(
        g,
        inverse,
        new1,
        new2,
        opening,
        in_fabric,
        stroke,
        spreader_stroke,
        rises,
        capture,
        pierce,
        behind,
        needed,
        (l1, l2, l1 + l2),
    )


def thread_per_stitch(thickness: float, length: float, width: float) -> dict[str, float]:
    """Thread of one stitch, mm: the new one, type 406 of three threads, and one of four threads.

    The last formula is read from a bad scan: for 2.5, 3, 4 mm it gives 64, where the source prints 66.
    """
    q = math.hypot(width, length)
    return {
        "new": 8 * thickness + 2 * length + 4 * q,
        "406": 8 * thickness + 6 * length + q + width,
        "four-thread": 8 * thickness + 8 * length + 4 * q,
    }
