"""What the five papers print, row by row, beside what camgen finds: agrees, refuted with the reason, or not decidable.

A row that is refuted must not agree: a slip in our own formulas shows as well as one in theirs.

    U  Sentyakov et al., Mathematical model of the cam profile of the swing mechanism (2018)
    E  Sviridov, Vladimirov, Chusovitin, Crank-slider mechanism of a tattoo machine
    S  Horobets, Manoilenko, New method of forming a flat chain stitch
    I  Analysis and recommendations for choosing cam mechanisms of pad-printing machines (law MR-13)
    T  Semin, Korneenko, Kirillov, Mikheeva, Two-crank four-bar thread take-up
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from camgen.machine.cams.followers import SwingingArm
from camgen.machine.cams.profile import DiscCam
from camgen.machine.closed_form import slider_travel
from camgen.machines.chain_stitch_looper.stitch import SOURCE, thread_per_stitch
from camgen.machines.chain_stitch_looper.threads import STITCHES, seam
from camgen.machines.eccentric_drive.mechanism import EccentricDrive
from camgen.machines.eccentric_drive.study import PAPER_SPEED, PUBLISHED
from camgen.machines.thread_take_up.feed import TakeUp
from camgen.machines.thread_take_up.rocker import ANGLES, against
from camgen.machines.thread_take_up.study import Masses, balance_numbers
from camgen.machines.uniform_swing.pictures import Model, pictures
from camgen.motion.laws import LAWS, MR_13_COSINES, MR_13_SINES, end_speed
from camgen.motion.program import uniform_swing
from camgen.numerics import Points, peak

_CUT = "cut off, not rounded"
_NO_LENGTHS = "its lengths are not printed, this is of one of the same feed"


@dataclass(frozen=True)
class Row:
    """A published number beside ours; unless it is refuted or undecided the two are to agree."""

    what: str
    published: str  # a text: its last decimal says how exact it is; "-" where none is printed, "3 to 4" of a range
    ours: float  # as computed here
    refuted: str = ""  # why the published value is wrong
    undecided: str = ""  # why nobody can tell

    @property
    def agrees(self) -> bool:
        """Whether ours rounds to the published value, by half a unit of its last decimal and a hair, or lies in its range."""
        if self.published == "-":
            return False
        low, ranges, high = self.published.partition(" to ")
        if ranges:
            return float(low) <= self.ours <= float(high)
        mantissa, _, exponent = self.published.partition("e")
        unit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
        return bool(abs(self.ours - float(self.published)) <= 0.5001 * unit)

    @property
    def ok(self) -> bool:
        """Whether it is as it is said to be: a value that is refuted may not agree."""
        return bool(self.undecided) or self.agrees != bool(self.refuted)

    @property
    def verdict(self) -> str:
        """In a few words."""
        if not self.ok:
            return "OFF"
        if self.refuted:
            return f"refuted: {self.refuted}"
        return f"not decidable: {self.undecided}" if self.undecided else "agrees"


def rows() -> Iterator[Row]:
    """All of them, paper by paper."""
    yield from _swing()
    yield from _eccentric()
    yield from _stitch()
    yield from _indexing()
    yield from _take_up()


# ---- U: uniform swing ------------------------------------------------------------------------------------------------


def _swing() -> Iterator[Row]:
    """The source gives formulas without lengths: they are tried at L = 60, H = 30, Delta = 15 deg, phi = 50 deg."""
    pivot = 60.0
    width = 30.0
    half = math.radians(15)
    reach = math.hypot(pivot, width)
    middle = math.atan2(width, pivot)
    phi = math.radians(50)
    ratio = math.pi / (2 * half)

    def tip(alpha: float) -> complex:
        return pivot - reach * cmath.exp(1j * alpha)

    def steps(sign: float) -> complex:
        """The point of the profile by (8) and (11), x sin with this sign in the row of y."""
        d = tip(middle - half) - pivot
        a = -phi / ratio
        angle = phi - phi / ratio
        x = d.real * math.cos(angle) + d.imag * math.sin(angle) + pivot * math.cos(phi)
        y = d.imag * math.cos(angle) + sign * (d.real * math.sin(angle) + pivot * math.sin(phi))
        assert math.isclose(angle, phi + a)
        return complex(x, y)

    true = tip(middle - half + phi / ratio) * cmath.exp(-1j * phi)  # the tip, seen from the cam
    low = tip(middle - half)
    beta = math.acos(reach / abs(low) * math.sin(middle - half))
    yield Row(
        "U eq. 2: R less the tip's distance from A, mm", "0.000000000", reach - abs(low - pivot)
    )
    yield Row(
        "U eq. 4: r at alpha_1 by the cosine rule less OC, mm",
        "0.000000000",
        math.sqrt(pivot**2 + reach**2 - 2 * pivot * reach * math.cos(middle - half)) - abs(low),
    )
    yield Row(
        "U eq. 5: C by r_1, beta_1 less C, mm",
        "0.000000000",
        abs(-abs(low) * complex(math.sin(beta), math.cos(beta)) - low),
    )
    yield Row(
        "U eq. 8, 11: profile less the tip's path, mm",
        "0.000",
        abs(steps(1) - true),
        refuted="as printed its matrix is no rotation: x sin needs the other sign in y",
    )
    yield Row("U eq. 8, 11 with that sign: the same, mm", "0.000000000", abs(steps(-1) - true))
    cam = DiscCam(
        uniform_swing(2 * half, 0.0),
        SwingingArm(complex(pivot), -complex(pivot, width), 0.0, leaves=1),
    )
    swung = Model(pivot, width, 2 * half, cam)
    forth, back = (
        {name: complex(x, y) for name, x, y in plot.points} for plot in pictures(swung)[-2:]
    )
    high = tip(middle + half)
    beta = math.acos(reach / abs(high) * math.sin(middle + half))
    again = abs(high) * complex(-math.sin(beta), math.cos(beta))
    yield Row(
        "U eq. 6, fig. 4: C where the first cycle begins, mm off the picture",
        "0.000000000",
        abs(forth["C0"] - low),
    )
    yield Row(
        "U fig. 5: A where the second cycle begins, mm off -L",
        "0.000000000",
        abs(back["A0"] + pivot),
    )
    yield Row(
        "U eq. 9, fig. 5: C there, mm off the picture", "0.000000000", abs(back["C0"] - again)
    )
    yield Row("U canvas on the running machine, 2 mm of 25, %", "8", 100 * 2 / 25)


# ---- E: eccentric drive ----------------------------------------------------------------------------------------------


def _eccentric() -> Iterator[Row]:
    crank = 1.5
    rod = 48.0
    printed = "13000 / 60 is revolutions a second, the formula wants rpm: 1361 rad/s"
    yield Row("E crank speed, rad/s", "22.6", math.pi * 13000 / 30, refuted=printed)
    yield Row("E strokes a second at the printed 22.6 rad/s", "3 to 4", PAPER_SPEED / math.tau)
    yield Row(
        "E strokes a second at 13000 rpm",
        "3 to 4",
        13000 / 60,
        refuted="13000 rpm are 216.7 strokes a second, not 3.6",
    )
    yield Row(
        "E stroke of an eccentric 1.5 mm off, mm", "3", float(slider_travel(math.pi, crank, rod))
    )
    drive = EccentricDrive.model_validate(
        {
            "mechanism": "eccentric-drive",
            "name": "paper",
            "geometry": {
                "eccentricity": crank,
                "rod": rod,
                "eccentric_diameter": 9,
                "shaft_diameter": 2,
            },
            "motor": {"speed_rpm": 13000},
            "parts": {"tube_length": 10},
        }
    )
    assert drive.needle is not None
    yield Row("E fig. 4: needle's point out of its tube at most, mm", "3", drive.needle.out[1])
    yield Row(
        "E angle of the greatest speed, deg",
        "90",
        _fastest(crank / rod),
        refuted="the rod's tilt moves it to 88.2 deg",
    )
    yield Row(
        "E wall of a 5 mm disc on a 2 mm shaft, mm",
        "-",
        5 / 2 - crank - 1,
        undecided="not printed; the paper's disc leaves none, so it cannot be printed",
    )
    for degrees, speed, tilt, rate in PUBLISHED:
        p = math.radians(degrees)
        sine = math.sin(p) * crank / rod
        cosine = math.sqrt(1 - sine * sine)
        exact = crank * PAPER_SPEED * (math.sin(p) + sine * math.cos(p) / cosine)
        mirrored = "mirrored from 180 deg less it" if degrees in (30, 60, 300, 330) else ""
        yield Row(f"E v3 at {degrees} deg, mm/s", _printed(speed), exact, refuted=mirrored)
        angle = -math.degrees(math.asin(sine))
        sign = "its sign contradicts the closure of eq. 2" if tilt else ""
        yield Row(f"E phi2 at {degrees} deg, deg", _printed(tilt), angle, refuted=sign)
        turning = -PAPER_SPEED * crank / rod * math.cos(p) / cosine
        # The crank turns clockwise in the source, so that phi2' has the sign of -w.
        yield Row(f"E phi2' at {degrees} deg, rad/s", _printed(rate), -turning)


def _printed(value: float) -> str:
    """A number of the table with the decimals that it is printed with."""
    return f"{value:g}" if value else "0.0"


def _fastest(share: float) -> float:
    """Crank angle of the greatest speed, deg: of x = sin^2, share^4 x^3 - share^2 x^2 - x + 1 = 0."""
    found = np.roots([share**4, -(share**2), -1.0, 1.0])
    x = min((float(z.real) for z in found if abs(z.imag) < 1e-9), key=lambda x: abs(x - 1))
    return math.degrees(math.asin(math.sqrt(x)))


# ---- S: flat chain stitch --------------------------------------------------------------------------------------------


def _stitch() -> Iterator[Row]:
    g = SOURCE
    d = SOURCE.design()
    thread = thread_per_stitch(2.5, 3.0, 4.0)
    yield Row("S thread of a stitch, new, mm", "46", thread["new"])
    yield Row("S thread of a stitch, type 406, mm", "47", thread["406"])
    yield Row(
        "S thread of a stitch, four threads, mm",
        "66",
        thread["four-thread"],
        undecided="its formula is hardly read in the scan; as read it gives 64",
    )
    series = {name: x + 1j * y for name, x, y in seam(replace(g, spacing=4.0).design(), 3.0).series}
    along = sum(float(np.nansum(np.abs(np.diff(way)))) for way in series.values()) / STITCHES
    yield Row("S fig. 1: thread along the fabric, 2t + 4q, as drawn, mm", "26", along)
    yield Row(
        "S fig. 1: legs of thread through the fabric in a stitch",
        "8",
        4.0,
        undecided="the seam as drawn has 4; the figure is not in the scan",
    )
    yield Row(
        "S thread saved against type 406, a little over, %",
        "2",
        100 * (1 - thread["new"] / thread["406"]),
    )
    yield Row(
        "S thread saved against four threads, %",
        "43",
        100 * (66 - thread["new"]) / 66,
        refuted="divides by the new stitch's thread: it is 30.3",
    )
    yield Row("S dS/dL, e / z", "1.25", g.plate / g.spacing)
    yield Row("S dL/dS", "0.8", g.ratio)
    for name, text, ours in (
        ("b", "3.5", g.height),
        ("H", "4.5", g.pitch),
        ("l1", "8", d.l1),
        ("l2", "2.8", d.l2),
    ):
        yield Row(f"S {name}, mm", text, ours)
    yield Row("S A, mm", "10.8", d.nose)
    small = "made with e = 4 instead of the adopted 8"
    yield Row("S S_m1, mm", "24", d.in_fabric[0], refuted=small)
    yield Row("S S_m2, mm", "25.5", d.in_fabric[1], refuted=small)
    yield Row("S phi_m, deg", "120", 180 - math.degrees(g.feed) / 2)
    yield Row("S S_X, mm", "34", d.needle_stroke, refuted=small)
    yield Row("S S_X of the printed S_m2, mm", "34", g.needle_stroke((24.0, 25.5)))
    at = 34.0  # the printed stroke, with which the source goes on

    def arc(s: float) -> float:
        return math.degrees(math.acos(1 - 2 * s / at))

    yield Row("S capture phi3_1 at S_X = 34, deg", "28.1", arc(g.rise[0]))
    yield Row("S capture phi3_2 at S_X = 34, deg", "42.7", arc(g.rise[1]))
    yield Row("S S_B1, mm", "16.5", d.rises[0])
    yield Row("S S_B2, mm", "23.5", d.rises[1], refuted="too high by H + l_H")
    branch = "wrong branch of the arccosine"
    yield Row("S pierce phi4_1 at S_X = 34, deg", "268.3", 360 - arc(16.5), refuted=branch)
    yield Row("S pierce phi4_2 at S_X = 34, deg", "292.5", 360 - arc(23.5), refuted=branch)
    yield Row("S DS r, mm", "3.6", g.between * g.ratio)
    way = g.spacing + d.nose
    lost = "lacks a factor 2"
    yield Row("S L_X1 at S_X = 34, mm", "41.7", at * (3.6 + way) / (23.5 - g.rise[0]), refuted=lost)
    yield Row(
        "S L_X2 at S_X = 34, mm",
        "23.3",
        at * way / (16.5 - g.rise[1]),
        refuted=f"{lost}, and 0.03 is 0.003",
    )
    new = 41.7 / 34
    wrong = "dS/dL taken for dL/dS"
    yield Row("S new l1, mm", "8.1", max(g.reach) * new, refuted=wrong)
    yield Row("S new l2, mm", "2.8", g.height * new, refuted=wrong)
    yield Row("S new A, mm", "10.9", (max(g.reach) + g.height) * new, refuted=wrong)
    yield Row("S f, mm", "1.4", d.opening)
    one, two = (math.degrees(angle) for angle in d.pierce_angles)
    yield Row(
        "S Omega, to which a loop stays on a cylinder, rad",
        "0.4 to 0.8",
        math.nan,
        undecided="taken from another source, by thread and surface; the report judges by both ends",
    )
    yield Row("S loop angle gamma'_1, deg", "38.6", one, refuted=_CUT)
    yield Row("S loop angle gamma'_2, deg", "38.6", two, refuted=_CUT)


# ---- I: indexing cam -------------------------------------------------------------------------------------------------


def _indexing() -> Iterator[Row]:
    law = LAWS["mr-13"]
    kappa = np.arange(61) / 60
    b = law(kappa, 1)
    c = law(kappa, 2)
    printed = (*MR_13_SINES[:-1], -MR_13_SINES[-1])
    yield Row(
        "I speed at the ends, A6 as printed",
        "0.000000",
        abs(end_speed(printed, MR_13_COSINES)),
        refuted="it closes with A6 = -0.025629 alone",
    )
    yield Row(
        "I speed at the ends, A6 = -0.025629",
        "0.000000",
        abs(end_speed(MR_13_SINES, MR_13_COSINES)),
    )
    yield Row("I B, greatest |b| of 61 positions", "1.891", peak(b), refuted=_CUT)
    yield Row("I C, greatest |c| of 61 positions", "6.149", peak(c))
    yield Row("I D, greatest |b c| of 61 positions", "8.020", peak(b * c))
    fine = np.linspace(0, 1, 200_001)
    for label, text, order in (("C", "6.149", 2), ("D", "8.020", 0)):
        curve = law(fine, 2) if order else law(fine, 1) * law(fine, 2)
        yield Row(
            f"I {label} of the law itself",
            text,
            peak(curve),
            refuted="the peak of its table",
        )
    yield Row("I B1 = c(0)", "2.550126", float(law(0.0, 2)))
    yield Row("I gamma, rad", "0.3141592", math.pi / 10, refuted=_CUT)
    yield Row("I lambda, spring over crank", "4", 120 / 30)
    yield Row("I x0, stretch over crank", "0.2", 6 / 30)
    yield Row(
        "I Y, factor of P = Y G",
        "4.640648",
        math.nan,
        undecided="G, the unloader's effort that it multiplies, is not printed",
    )
    yield Row(
        "I a, b, c at z = 0 to 30",
        "-",
        math.nan,
        undecided="the table is not in the scan; the law's own values serve",
    )


# ---- T: thread take-up -----------------------------------------------------------------------------------------------


def _take_up() -> Iterator[Row]:
    printed = TakeUp(30.0, 30.0, 19.0, 9.0, 52.0, math.radians(90), 1, (40 + 15j, -80 + 160j))
    yield from _take_up_formulas(printed)
    yield from _take_up_paths(printed)
    yield from _take_up_masses(printed)


def _take_up_formulas(printed: TakeUp) -> Iterator[Row]:
    """Formulas (1) to (3), of the chain as printed."""
    theta = np.radians([0.0, 60.0, 200.0])
    side = np.sqrt(81 + 900 - 540 * np.cos(theta))

    def gap(cosine: np.ndarray) -> float:
        """How far B by formula (1) is from being 19 mm from C, mm; with the arctangent of two arguments."""
        with np.errstate(invalid="ignore"):
            phi = np.arctan2(-30 * np.sin(theta), 9 - 30 * np.cos(theta)) + np.arccos(cosine)
        gaps = np.abs(np.abs(30 * np.exp(1j * theta) + 30 * np.exp(1j * phi) - 9) - 19)
        return float(np.max(np.where(np.isnan(gaps), 19.0, gaps)))

    lost = (9 + 30 + 30 - 19 - 540 * np.cos(theta)) / (540 * side)
    right = (81 + 900 + 900 - 361 - 540 * np.cos(theta)) / (60 * side)
    yield Row(
        "T eq. 1: gap of the chain at B, mm",
        "0.000",
        gap(lost),
        refuted="the squares are lost, and l0 l1 stands for l2",
    )
    yield Row("T eq. 1 with both: gap at B, mm", "0.000000000", gap(right))
    beta = math.radians(90)
    arm = 52.0

    def at(x: float, y: float) -> Points:
        """D by formula (2) from its place in the coupler's axes."""
        phi = np.angle(30 * np.exp(1j * theta) * -1 + 9) + np.arccos(right)
        here = 30 * np.exp(1j * theta)
        return np.asarray(here + x * np.exp(1j * phi) + y * (np.sin(phi) - 1j * np.cos(phi)))

    spurious = (30 - arm * math.cos(beta), 30 - arm * math.sin(beta))
    meant = (30 - arm * math.cos(beta), arm * math.sin(beta))
    yield Row(
        "T eq. 3: BD of its x' and y' less 52, mm",
        "0.000",
        math.hypot(spurious[0] - 30, spurious[1]) - arm,
        refuted="the l2 in y' is one too many",
    )
    yield Row(
        "T eq. 3 without it: BD less 52, mm",
        "0.000000000",
        math.hypot(meant[0] - 30, meant[1]) - arm,
    )
    yield Row(
        "T eq. 2, y' right of AB: eye off the chain's, mm",
        "0.000000000",
        peak(at(*meant) - printed.path(theta)),
    )
    yield Row(
        "T eq. 2, y' left of it, as in any axes: the same, mm",
        "0.000",
        peak(at(meant[0], -meant[1]) - printed.path(theta)),
        refuted="it is a reflection, no turn: y' counts to the other side",
    )


def _take_up_paths(printed: TakeUp) -> Iterator[Row]:
    """What is said of the eye's path and of the second crank's turning."""
    yield Row(
        "T double points of the eye's path",
        "1",
        float(printed.near_stop.crossings),
        refuted="none with AB = 30, BC = 19 as printed",
    )
    yield Row(
        "T the same, AB and BC interchanged", "1", float(printed.interchanged().near_stop.crossings)
    )
    spread = [
        np.ptp(
            TakeUp(30.0, 30.0, 19.0, frame, 52.0, 1.57, 1, printed.guides).rate_extremes(True),
            axis=0,
        )[0]
        for frame in (1.0, 5.0, 9.0, 13.0, 17.0)
    ]
    yield Row(
        "T a longer frame turns BC less evenly, of 4 steps", "4", float(np.sum(np.diff(spread) > 0))
    )


def _take_up_masses(printed: TakeUp) -> Iterator[Row]:
    """Balance, reactions and wear, and the same of a crank-rocker."""
    speed = math.tau * 5000 / 60
    masses = Masses(
        coupler_g=6.3,
        output_crank_g=8.3,
        coupler_kg_m2=5.1e-6,
        output_crank_kg_m2=2.5e-6,
        coupler_centre=(15.0, -10.0),
        output_crank_centre=9.5,
    )
    bodies = masses.bodies(printed)
    found = balance_numbers(printed, masses, speed)
    yield Row(
        "T inertia force of the balanced group, N", "0.000000000", found["balanced_shaking_force_n"]
    )
    before = printed.forces(ANGLES, bodies, speed)
    grown = sum(
        found[f"balanced_reaction_{x.lower()}_n"] > peak(before.reactions[x]) for x in "ABC"
    )
    yield Row("T reactions that grow by it, of A, B and C", "3", float(grown))
    single = balance_numbers(printed.interchanged(), masses, speed)["crank_counterweight_g_mm"]
    yield Row(
        "T single mass for both cranks, interchanged, g mm",
        "-",
        single,
        undecided="its shape and size are left to further work, and masses' centres not printed",
    )
    rocker, _ = against(printed, bodies, speed, None)
    ratio = rocker["rocker_reaction_c_n"] / peak(before.reactions["C"])
    wear = 3 * rocker["rocker_wear_n_rad_s"] / sum(printed.wear(ANGLES, before, speed).values())
    for what, text, ours, why in (
        (
            "reaction at C at 5000 rpm, N",
            "120",
            math.nan,
            "centres of mass are not printed; 118 and 123 with two fair guesses",
        ),
        ("the same of the crank-rocker over it", "1.58", ratio, f"{_NO_LENGTHS}; more, as it says"),
        (
            "letting down over pulling up, angles",
            "2",
            printed.interchanged().diagram.ratio,
            "the guides are not printed; so with ours",
        ),
        ("excess of thread, mm", "7", math.nan, "neither guides nor the consumption are printed"),
        (
            "the same of the crank-rocker, mm",
            "37",
            math.nan,
            f"{_NO_LENGTHS}; the take-up's report has one of the same feed",
        ),
        ("wear of the crank-rocker over it", "2", wear, f"{_NO_LENGTHS}; more, as it says"),
    ):
        yield Row(f"T {what}", text, ours, undecided=why)
