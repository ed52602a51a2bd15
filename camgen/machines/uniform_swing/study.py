"""What follows from a uniform swing: the canvas that it lays, the choice of the reversal blend, forces and lift-off."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Floats
from camgen.machine.cams.machine import FollowerLoad, Loaded, loaded
from camgen.machine.cams.profile import DiscCam
from camgen.machine.model import Machine
from camgen.machines.cam_loads import force_plots
from camgen.machines.uniform_swing.web_thickness import BAND, STRIPS, blend_choice, canvas
from camgen.study import ROWS, Plot, Study, Table

_BLENDS = (
    0.0,
    1.0,
    2.0,
    3.5,
    5.0,
    7.5,
    10.0,
    15.0,
    20.0,
    30.0,
    45.0,
    60.0,
    90.0,
)  # deg, at which the choice is shown
_MIDDLE = 0.9  # share of the width over which the spread is stated: at the very edge it depends on how wide a strip is
_JET = 100  # strips in which thickness is drawn and its spread stated: a jet is no finer
NO_SPRING = "A sharp reversal needs an infinite force, so no spring keeps the follower on the cam: use a reversal_blend_deg."


def canvas_study(theta: Floats, motion: Mapping[str, Floats]) -> Study:
    """Canvas laid by the motions recovered from files, (n,) rad over a whole turn; one that is not whole is left out."""
    numbers: dict[str, float] = {}
    rows: list[tuple[object, ...]] = []
    series = []
    for kind, s in motion.items():
        if not np.all(np.isfinite(s)):
            continue
        for name, flat in (("round", False), ("flat", True)):
            laid = canvas(theta, s, flat, _JET)
            share, middle = 100 * canvas(theta, s, flat, STRIPS).share, 100 * laid.spread(_MIDDLE)
            numbers[f"canvas_share_{name}_{kind}_percent"] = share
            rows.append((f"{name} collector, from {kind.upper()}", share, middle))
            series.append((f"{name}, {kind.upper()}", laid.place, laid.thickness))
    if not series:
        return Study()
    ends = np.array([-1.0, 1.0])
    kept = series[-2:]  # the kinds differ by less than a line's width
    bounds = [(f"{sign} {BAND:.0%}", ends, np.full(2, 1 + float(f"{sign}{BAND}"))) for sign in "+-"]
    plot = Plot(
        "Canvas over the width",
        "place, share of half the width",
        "thickness / median",
        [*kept, *bounds],
    )
    columns = ("canvas", f"width within {BAND:.0%}, %", f"spread of the middle {_MIDDLE:.0%}, %")
    return Study(
        numbers,
        [plot],
        [Table("Thickness of the canvas, from the recovered motion", columns, rows)],
    )


def blend_study(cam: DiscCam, blend: float) -> Study:
    """Undercut, peak acceleration and share of the canvas against the reversal blend, rad; gaps where no cam exists."""
    swing = float(np.ptp(cam.program(np.array([0.0, math.pi]))))
    degrees = sorted({*_BLENDS, round(math.degrees(blend), 9)})
    table = np.full((4, len(degrees)), math.nan)
    for k, each in enumerate(np.radians(degrees)):
        try:
            table[:, k] = blend_choice(swing, cam.follower, float(each))
        except DesignError:
            continue
    x = np.array(degrees)
    undercut, acceleration, share_round, share_flat = table
    undercut = np.degrees(undercut)
    finite = np.where(np.isfinite(acceleration), acceleration, math.nan)
    label, here = "reversal blend, deg", [("this spec", math.degrees(blend))]
    shares = [("round collector", x, 100 * share_round), ("flat collector", x, 100 * share_flat)]
    columns = (
        "blend, deg",
        "undercut, deg",
        "peak acceleration, 1/rad",
        "round, % of width",
        "flat, % of width",
    )
    rows = [
        tuple(map(float, row))
        for row in zip(x, undercut, acceleration, 100 * share_round, 100 * share_flat, strict=True)
    ]
    return Study(
        plots=[
            Plot("Undercut against the blend", label, "deg", [("undercut", x, undercut)], here),
            Plot(
                "Peak acceleration against the blend",
                label,
                "1/rad",
                [("d2s/dtheta2", x, finite)],
                here,
            ),
            Plot(
                f"Canvas within {BAND:.0%} against the blend", label, "% of the width", shares, here
            ),
        ],
        tables=[Table("Choice of the reversal blend", columns, rows)],
    )


def forces(machine: Machine, cam: DiscCam, load: FollowerLoad) -> Loaded:
    """What tip and motor bear over the turn."""
    return loaded(machine, cam, load, np.linspace(0, 2 * math.pi, ROWS))


def force_study(found: Loaded, load: FollowerLoad, lever: float | None) -> Study:
    """Curves and figures of the forces; with a lever, mm, also the spring there that keeps contact (force closure)."""
    numbers = {
        "inertia_kg_m2": load.inertia,
        "peak_contact_force_n": float(np.nanmax(found.force)),
        "peak_torque_n_m": float(np.nanmax(np.abs(found.torque))),
    }
    notes = []
    if found.kick:
        numbers["reversal_kick_n_m_s"] = found.kick
        notes.append(
            f"A sharp reversal gives the follower a kick of {found.kick:.3g} N m s; the curves of force and torque leave it "
            "out. A reversal_blend_deg spreads it."
        )
    if lever is not None:
        preload, rate = found.spring_needed(load)
        numbers |= {
            "spring_preload_needed_n_m": preload,
            "spring_rate_needed_n_m_per_rad": rate,
            "spring_force_needed_n": preload / lever * 1e3,
            "spring_rate_needed_n_mm": rate / lever**2 * 1e3,
        }
        ways = [
            f"pulls with {preload / lever * 1e3:.3g} N where the tip is nearest to the shaft (spring.preload)"
        ]
        if math.isfinite(rate):
            ways.append(f"has a rate of {rate / lever**2 * 1e3:.3g} N/mm (spring.rate)")
        notes.append(
            NO_SPRING
            if math.isinf(preload)
            else f"What keeps contact: a straight spring on a lever of {lever:g} mm that {' or, the other as given, '.join(ways)}."
        )
    return Study(
        numbers, force_plots(found, "tip on cam") if np.any(found.effort) else (), notes=notes
    )


def source_figures(pivot: float, offset: float, swing: float) -> dict[str, float]:
    """R, and at both ends of the swing alpha (angle OAC), r = OC and beta (of OC from Oy), by equations 2 to 5 of the source."""
    reach, middle = math.hypot(pivot, offset), math.atan2(offset, pivot)
    numbers = {"source_r_mm": reach}
    for k, alpha in ((1, middle - swing / 2), (2, middle + swing / 2)):
        tip = pivot - cmath.rect(reach, alpha)
        numbers |= {
            f"source_alpha_{k}_deg": math.degrees(alpha),
            f"source_r_{k}_mm": abs(tip),
            f"source_beta_{k}_deg": math.degrees(math.atan2(abs(tip.real), -tip.imag)),
        }
    return numbers
