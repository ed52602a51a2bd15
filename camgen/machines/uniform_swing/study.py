"""What follows from a uniform swing: the canvas that it lays, the choice of the reversal blend, its figures, forces and lift-off."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from camgen.errors import DesignError
from camgen.findings import Finding
from camgen.geometry.outlines import Floats
from camgen.machine.cams.bounce import Bounce
from camgen.machine.cams.followers import SwingingArm
from camgen.machine.cams.limits import ARM_PRESSURE, undercut_numbers
from camgen.machine.cams.machine import FollowerLoad, Loaded
from camgen.machine.cams.profile import DiscCam
from camgen.machines.cam_loads import force_plots, lift_off
from camgen.machines.loads.lift_off import bounce_figures
from camgen.machines.uniform_swing.pictures import Model, pictures
from camgen.machines.uniform_swing.tables import SwingGeometry
from camgen.machines.uniform_swing.web_thickness import BAND, STRIPS, blend_choice, canvas
from camgen.numerics import greatest, magnitude
from camgen.study import ROWS, Figure, Figures, Plot, Sketch, Study, Table, figures_in

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
_NO_SPRING = "A sharp reversal needs an infinite force, so no spring keeps the follower on the cam: use a reversal_blend_deg."


# ---- canvas ----------------------------------------------------------------------------------------------------------


def canvas_study(theta: Floats, motion: Mapping[str, Floats]) -> Study:
    """Canvas laid by the motions recovered from files, (n,) rad over a whole turn; one that is not whole is left out."""
    found: list[Figure] = []
    rows: list[tuple[object, ...]] = []
    series = []
    for kind, s in motion.items():
        if not np.all(np.isfinite(s)):
            continue
        for name, flat in (("round", False), ("flat", True)):
            laid = canvas(theta, s, flat, _JET)
            share = 100 * canvas(theta, s, flat, STRIPS).share
            middle = 100 * laid.spread(_MIDDLE)
            found.append(Figure("canvas share {of}", share, "%", name, kind=kind))
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
        Figures(found),
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
    label = "reversal blend, deg"
    here = [("this spec", math.degrees(blend))]
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


# ---- figures ---------------------------------------------------------------------------------------------------------


def figures(cam: DiscCam, g: SwingGeometry, rpm: float) -> Study:
    """The source's angles, speeds at so many turns a minute, sizes of the cam, its pressure angle, undercut and figures 2 to 5."""
    theta = np.linspace(0, math.tau, ROWS)
    swing = math.radians(g.swing_deg)
    speed = magnitude(cam.program(theta, 1))
    radius = np.abs(cam.pitch(theta))
    rise, back = pressure_angles(cam)
    turning = rpm * math.tau / 60
    found = [
        Figure("swing", g.swing_deg, "deg"),
        Figure("speed ratio", 1 / speed),
        *source_figures(g.pivot_distance, g.arm_offset, swing),
        Figure("uniform share", 100 * (1 - g.reversal_blend_deg / 180), "%"),
        Figure("follower speed", math.degrees(speed) * turning, "deg/s"),
        Figure("peak speed", abs(cam.follower.arm) * speed * turning, "mm/s"),
        *figures_in(
            "mm",
            pitch_radius_min=float(np.min(radius)),
            pitch_radius_max=float(np.max(radius)),
            pitch_curvature_radius_min=1 / greatest(cam.curvature, 0.0, math.tau)[1],
            profile_length=cam.outline.length,
        ),
        Figure("profile area", cam.outline.area, "mm²"),
        *figures_in("deg", pressure_angle_rise=rise, pressure_angle_return=back),
        *undercut_numbers([cam]).records,
    ]
    steep = ("exact profile", np.degrees(theta), np.degrees(cam.pressure_angle(theta)))
    drawn = pictures(Model(g.pivot_distance, g.arm_offset, swing, cam))
    return Study(
        Figures(found),
        [Plot("Pressure angle", "cam angle, deg", "deg", [steep]), *drawn],
        _undercuts(cam),
        notes=_notes(cam),
    )


def pressure_angles(cam: DiscCam) -> tuple[float, float]:
    """Largest pressure angle over the rise and over the return, less the undercut, deg."""
    return (
        cam.steepest_between(0.0, math.pi, riding=False)[1],
        cam.steepest_between(math.pi, math.tau, riding=False)[1],
    )


def _undercuts(cam: DiscCam) -> list[Table]:
    columns = ("from, deg", "to, deg", "largest shortfall, deg", "at, deg", "at the tip, mm")
    rows = [
        (*np.degrees([cut.begin, cut.end, cut.shortfall, cut.worst]).tolist(), cut.depth)
        for cut in cam.undercuts
    ]
    return [Table("Undercut of the exact profile", columns, rows)] if rows else []


def _notes(cam: DiscCam) -> list[str]:
    notes = [
        "Source: Sentyakov et al., Vestnik TGTU 2018, 24(4), 698-706, which gives no lengths: these are the spec's own.",
        "MOTION_ERROR compares with the wanted motion less the undercut that the spec implies; UNDERCUT states that loss.",
    ]
    if cam.steepest > ARM_PRESSURE:
        tilt = math.degrees(cmath.phase(-cam.follower.arm))
        notes.append(
            f"The tip's path is tilted by {tilt:.1f} deg against the radius, which helps the rise and harms the return; "
            "the conjugate pair does not change that. Remedies: a smaller swing, another arm_offset / pivot_distance, or "
            "a disc cam with its pivot placed so that the arm is perpendicular to the cam's radius in mid position."
        )
    return notes


def source_figures(pivot: float, offset: float, swing: float) -> list[Figure]:
    """R, and at both ends of the swing alpha (angle OAC), r = OC and beta (of OC from Oy), by equations 2 to 5 of the source."""
    reach = math.hypot(pivot, offset)
    middle = math.atan2(offset, pivot)
    found = [Figure("source r", reach, "mm")]
    for k, alpha in ((1, middle - swing / 2), (2, middle + swing / 2)):
        tip = pivot - cmath.rect(reach, alpha)
        beta = math.atan2(abs(tip.real), -tip.imag)
        found.append(Figure(f"source alpha {k}", math.degrees(alpha), "deg"))
        found.append(Figure(f"source r {k}", abs(tip), "mm"))
        found.append(Figure(f"source beta {k}", math.degrees(beta), "deg"))
    return found


def sketches(arm: SwingingArm, pair: bool, shaft: float) -> tuple[Sketch, Sketch]:
    """Follower and shafts, as the moving picture shows cams alone; pair: of cams; shaft: radius, mm."""
    tip = arm.arm
    strokes = [np.array([0, 1j * tip.imag, tip])]
    circles = [(tip, arm.tip_radius)] if arm.tip_radius else []
    if pair:
        strokes.append(np.conj(strokes[0]))
        circles += [(z.conjugate(), r) for z, r in circles]
    ground = Sketch("ground", (), [(0j, shaft), (arm.pivot, shaft)])
    return Sketch("follower", strokes, circles, "follower"), ground


# ---- forces ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SwingForces:
    """What tip and motor bear over the turn."""

    loaded: Loaded
    load: FollowerLoad
    lever: float | None  # mm, from the pivot to a straight spring that closes the cam; None: a pair
    bounce: Bounce | None  # what it does where that spring does not hold it
    least: float  # share of that spring's force that is to be left to press
    left: list[Finding]  # what of that spring's force is left to press

    def findings(self) -> list[Finding]:
        """LIFT_OFF and SPRING_RESERVE, where a spring closes the cam."""
        less = "less inertia or a longer reversal_blend_deg"
        if self.lever is None:
            return []
        return [
            lift_off(self.loaded, self.load, False, self.bounce, self.least, (_NO_SPRING, less)),
            *self.left,
        ]

    def study(self) -> Study:
        """Curves and figures; where a spring closes the cam also the one that keeps contact."""
        loaded = self.loaded
        found = [
            Figure("inertia", self.load.inertia, "kg m²"),
            Figure("peak contact force", float(np.nanmax(loaded.force)), "N"),
            Figure("peak torque", float(np.nanmax(np.abs(loaded.torque))), "N m"),
        ]
        notes = []
        if loaded.kick:
            found.append(Figure("reversal kick", loaded.kick, "N m s"))
            notes.append(
                f"A sharp reversal gives the follower a kick of {loaded.kick:.3g} N m s; the curves of force and torque leave "
                "it out. A reversal_blend_deg spreads it."
            )
        plots = force_plots(loaded, "tip on cam") if np.any(loaded.effort) else []
        if self.lever is None:
            return Study(Figures(found), plots, notes=notes)
        preload, rate = loaded.spring_needed(self.load)
        force = preload / self.lever * 1e3
        stiff = rate / self.lever**2 * 1e3
        found += [
            Figure("spring preload needed", preload, "N m"),
            Figure("spring rate needed", rate, "N m/rad"),
            Figure("spring force needed", force, "N"),
            Figure("spring rate needed", stiff, "N/mm"),
            *bounce_figures(self.bounce, False),
        ]
        kept = f"What keeps contact: a straight spring on a lever of {self.lever:g} mm that pulls with {force:.3g} N where "
        kept += "the tip is nearest to the shaft (spring.preload)"
        if math.isfinite(rate):
            kept += f" or, the other as given, has a rate of {stiff:.3g} N/mm (spring.rate)"
        said = _NO_SPRING if math.isinf(preload) else f"{kept}."
        return Study(Figures(found), plots, notes=[*notes, said])
