"""What an indexing cam asks of its drive: torques with and without the unloader, closure in the dwells, the law's figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.findings import Finding, Where, at_least, at_most
from camgen.machine.cams.machine import ROUNDING
from camgen.machine.cams.profile import DiscCam
from camgen.machines.indexing_cam.card import card
from camgen.machines.indexing_cam.stepping import NOTE as STEPS
from camgen.machines.indexing_cam.stepping import Stepping
from camgen.machines.indexing_cam.unloader import Load, SpringTorque, Torques, peak, torques
from camgen.motion.laws import Floats, Law, largest
from camgen.motion.program import Program
from camgen.motion.spring_law import trade_off
from camgen.numerics import magnitude
from camgen.study import ROWS, Figure, Figures, Later, Plot, Study, Table, figures_in
from camgen.tolerances import LAW_CLOSES

_FINE = 14_400  # cam angles at which peaks are looked for
_SPEEDS = (50, 75, 90, 100, 110, 125)  # percent of the speed, at which the same spring is tried
_Z = 30  # steps of the source's table over the run-up
_ARRANGEMENT = (
    "The driven link turns to and fro: one cam rocks the follower, whose gear segment turns the link by gear_ratio times the "
    "swing; each turn of the cam shaft makes two indexings by the same law, one forwards, one back. The spring stays geared to "
    "the link all the time and its torque is antisymmetric about the middle of the stroke, so it helps both ways. This is the "
    "simplest arrangement with the source's unbroken connection of cam, link and unloader. In the source's fig. 1 a second cam "
    "(3) swings a carrier (8) with the gears and the spring about the output shaft; we assume that this reverses the spring "
    "during the dwell, so that the link can go on in the same sense. The text does not say so, and it is not made here."
)
_ERRATA = (
    "Law MR-13: the source prints A6 = +0.025629, which leaves the law's ends with speed 1.6e-3; A6 = -0.025629 closes it to "
    "2.8e-8. The printed peaks 1.891, 6.149, 8.020 are those of the 61-point table; the law itself has 1.8917, 6.1501, 8.0491."
)


@dataclass(frozen=True)
class IndexingStudy:
    """Numbers, curves and findings of an indexing drive.

    swing: of the follower, rad; omega: cam shaft, rad/s, below 0 clockwise; dwell_torque: of the process on the link in a
    dwell, N m; closing: torque at the follower that presses it on the one cam, N m, None for a conjugate pair; ideal: a
    spring, which no one makes, that does by itself what the law asks: what a real one is compared with. It may be `spring`.
    angle: what theta is called, shaft: what turns by it; step: of a link that turns on.
    """

    program: Program
    law: Law
    swing: float
    omega: float
    load: Load
    spring: SpringTorque | None
    dwell_torque: float
    closing: float | None
    ideal: SpringTorque
    angle: str = "cam angle"
    shaft: str = "cam shaft"
    step: Stepping | None = None

    def at(self, theta: Floats, speed: float = 1.0, spring: SpringTorque | None = None) -> Torques:
        """Torques over cam angles (n,), the shaft at a multiple of its speed; with another spring where one is given."""
        if self.step is not None:
            return self.step.torques(theta, speed * self.omega, self.load, spring or self.spring)
        s = [self.program(theta, order) for order in range(3)]
        return torques(s, self.swing, speed * self.omega, self.load, spring or self.spring)

    @cached_property
    def _fine(self) -> tuple[Floats, Any, Torques]:
        """Cam angles, mask of those at which the link turns, torques; joints are looked at from either side."""
        joints = self.program.joints
        beside = np.concatenate([joints - 1e-9, joints + 1e-9])
        even = (np.arange(_FINE) + 0.5) * (math.tau / _FINE)
        even = even[
            np.min(np.abs(even[:, None] - joints), axis=1) > 1e-9
        ]  # at a joint itself there is no one torque
        theta = np.sort(np.mod(np.concatenate([even, beside]), math.tau))
        turning = np.zeros(len(theta), bool)
        for segment, begin in zip(self.program.segments, joints, strict=False):
            if segment.scale and (self.step is None or segment.kind == "rise"):
                turning |= (theta > begin) & (theta < begin + segment.span)
        return theta, turning, self.at(theta)

    @property
    def fine(self) -> Floats:
        """Cam angles at which torques are looked at, (n,) rad, the joints from either side."""
        return self._fine[0]

    @property
    def residual(self) -> float:
        """Peak of the demand while the link turns, as a share of that without the unloader."""
        _, turning, found = self._fine
        return peak(found.follower, turning) / peak(found.follower_bare, turning)

    @property
    def _kind(self) -> str:
        if self.spring is self.ideal:
            return 'an ideal spring, which cannot be built (unloader.torque = "law"); "crank" is one that can'
        return "the spring of the spec"

    @property
    def _spans(self) -> tuple[float, float]:
        """Cam angle in which the link turns forwards, and back, rad."""
        rise, back = (
            next(s.span for s in self.program.segments if s.kind == kind)
            for kind in ("rise", "return")
        )
        return rise, back

    # ---- findings -----------------------------------------------------------------------------------------------------

    def findings(self, jump_limit: float, residual_limit: float) -> Sequence[Finding]:
        """Joints, residual torque, force closure in the dwells (and over the turn on a single cam)."""
        found = [
            *self._joints(jump_limit),
            *([] if self.step and self.closing is None else [self._closure()]),
        ]
        if self.step is not None:
            back = 0.0 if self.spring is None else -float(self.spring(np.zeros(1))[0])
            found += self.step.findings(
                self.fine, self._pushing()[0], self.load, back, self.dwell_torque, self.angle
            )
        if self.spring is not None:
            found.append(
                at_most(
                    "RESIDUAL_TORQUE",
                    self.residual,
                    residual_limit,
                    "share",
                    Where("follower, while the link turns"),
                    f"share of the peak torque that is left to the cam with the unloader, by {self._kind}; "
                    "friction and another speed than the spring's raise it",
                )
            )
        return found

    def _joints(self, limit: float) -> list[Finding]:
        unit = self.swing / min(self._spans)
        jumps = self.program.discontinuities(2)
        found = []
        for order, most, name in ((1, LAW_CLOSES, "speed"), (2, limit, "acceleration")):
            scale = unit / min(self._spans) ** (order - 1)
            sized = [(abs(jump.size) / scale, jump.theta) for jump in jumps if jump.order == order]
            worst, theta = max(sized, default=(0.0, 0.0))
            said = (
                "none"
                if not sized
                else f"{len(sized)} joints, "
                + (
                    "by the law's design: the unloader already pulls in the dwell"
                    if self.spring and order == 2
                    else "an impact at each"
                    if order == 1
                    else "the acceleration jumps at each: choose a law that starts with acceleration 0"
                )
            )
            found.append(
                at_most(
                    "JOINT_JUMP",
                    worst,
                    most,
                    "1",
                    Where(name, theta=theta, angle=self.angle),
                    f"jump in units of the stroke and the turn's period: {said}",
                )
            )
        return found

    def _closure(self) -> Finding:
        """Whether the follower is pressed on its cam in the dwells, whatever the process does; at the follower's axle."""
        theta, turning, found = self._fine
        held = self.load.ratio * self.dwell_torque
        if self.closing is None:
            pressed = float(np.min(np.abs(found.follower[~turning]))) if not turning.all() else 0.0
            place = (
                "by the unloader"
                if self.spring
                else "no unloader presses: the pair holds with its lash"
            )
            return at_least(
                "FORCE_CLOSURE",
                pressed,
                held,
                "N m",
                Where("dwells, at the follower's axle"),
                f"torque that presses the rollers on the pair of cams, {place}; the limit is the process's torque",
            )
        seat = found.follower + self.closing - np.where(turning, 0.0, held)
        worst = int(np.argmin(seat))
        return at_least(
            "FORCE_CLOSURE",
            float(seat[worst]),
            0.0,
            "N m",
            Where("follower's axle", theta=float(theta[worst]), angle=self.angle),
            f"torque between roller and cam with a closing torque of {self.closing:g} N m; "
            f"more than {max(0.0, self.closing - float(seat[worst])):.4g} N m would keep it from leaving the cam",
        ).within(-ROUNDING * magnitude(seat))

    def _pushing(self) -> tuple[Floats, Floats]:
        """Torque in the freewheel that turns the link, with the unloader and without it, (n,) N m, nan while it runs free."""
        assert self.step is not None
        theta, _, found = self._fine
        return self.step.pushes(theta, found, self.load, found.spring), self.step.pushes(
            theta, found, self.load, 0 * theta
        )

    # ---- study --------------------------------------------------------------------------------------------------------

    def study(
        self, cams: Mapping[str, DiscCam], asked: tuple[Sequence[float], int, int] | None
    ) -> Study:
        """Numbers, plots, tables and notes; asked: weights, sines and cosines of laws to look for."""
        table, curves, printed = card(self.law)

        def tables() -> list[Table]:
            sprung = [self._unloaders(), self._speeds()] if self.spring else []
            asked_for = (
                []
                if asked is None or self.spring is None
                else [self._synthesis(self.spring, *asked)]
            )
            return [self._peaks(), table, *sprung, *asked_for]

        notes = [_ARRANGEMENT if self.step is None else STEPS]
        if self.law.name == "mr-13":
            notes.append(_ERRATA)
        if self.law(np.zeros(1), 2)[0] > LAW_CLOSES:
            notes.append(
                f"The law starts with c = {float(self.law(0.0, 2)):.6g}: it assumes that the spring pulls before the link moves, "
                "so that the cam gives way rather than pushes. Without the unloader each end of the turn is a knock."
            )
        numbers = Figures([*self._figures(), *printed])
        if self.step is not None:
            pushing, bare = self._pushing()
            numbers |= self.step.figures(self.omega, pushing, self.load, bare)

        def plots() -> list[Plot]:
            stepping = (
                []
                if self.step is None
                else self.step.plots(self.angle, self.fine, self._pushing()[0])
            )
            return [*stepping, *self._plots(cams), *curves]

        return Study(numbers, Later(plots), Later(tables), (), notes)

    def _figures(self) -> list[Figure]:
        _, turning, found = self._fine
        rise, back = self._spans
        stroke = self.load.ratio * self.swing
        still = ~turning
        fastest, hardest = (
            self.load.ratio * abs(self.omega) ** order * self.program.peak(order)
            for order in (1, 2)
        )
        dwells = math.tau - rise - back
        listed = [
            *figures_in(
                "s", turn_period=rise / abs(self.omega), return_period=back / abs(self.omega)
            ),
            Figure("turn to dwell ratio", (rise + back) / dwells if still.any() else math.inf),
            Figure("link peak speed", math.degrees(fastest), "deg/s"),
            Figure("link peak acceleration", math.degrees(hardest), "deg/s²"),
            Figure("kinetic energy", self.load.inertia * fastest**2 / 2, "J"),
            *figures_in(
                "N m",
                inertia_torque_peak=peak(found.inertia, turning),
                follower_torque_peak_without=peak(found.follower_bare, turning),
                follower_torque_peak_with=peak(found.follower, turning),
                shaft_torque_peak_without=peak(found.shaft_bare, turning),
                shaft_torque_peak_with=peak(found.shaft, turning),
            ),
        ]
        if self.spring is not None:
            a = np.linspace(0, 0.5, 2001)
            energy = float(np.trapezoid(self.spring(a), a)) * stroke
            listed += [
                Figure("residual share", 100 * self.residual, "%"),
                Figure("spring torque peak", magnitude(self.spring(a)), "N m"),
                Figure("spring energy", energy, "J"),
                Figure("spring torque in dwell", float(self.spring(np.zeros(1))[0]), "N m"),
                Figure("follower torque in dwell", peak(found.follower, still), "N m"),
            ]
        return listed

    def _plots(self, cams: Mapping[str, DiscCam]) -> list[Plot]:
        theta = np.linspace(0, math.tau, ROWS)
        x = np.degrees(theta)
        label = f"{self.angle}, deg"
        found = self.at(theta)
        ratio = self.load.ratio
        link = [
            np.degrees(ratio * self.program(theta, order) * self.omega**order) for order in range(4)
        ]
        units = ("deg", "deg/s", "deg/s²", "deg/s³")
        turned = "Driven link" if self.step is None else "Wheel of the freewheel"
        names = [
            f"{turned}: {name}"
            for name in ("angle", "speed", "acceleration", "jerk, jumps left out")
        ]
        plots = [
            Plot(name, label, unit, [("wanted", x, y)])
            for name, unit, y in zip(names, units, link, strict=True)
        ]

        def pair(bare: Floats, helped: Floats) -> list[tuple[str, Floats, Floats]]:
            return [
                ("without unloader", x, bare),
                *([("with unloader", x, helped)] if self.spring else []),
            ]

        plots += [
            Plot(
                "Torque at the follower's axle, positive outwards",
                label,
                "N m",
                pair(found.follower_bare, found.follower),
            ),
            Plot(f"Torque on the {self.shaft}", label, "N m", pair(found.shaft_bare, found.shaft)),
        ]
        if self.spring is not None:
            kappa = np.linspace(0, 1, 601)
            position = self.law(kappa)
            rise = self._spans[0]
            if self.step is not None:
                position = np.clip(
                    (position * ratio * self.swing - self.step.lost) / self.step.index, 0, 1
                )
            inertia = (
                self.load.inertia
                * ratio
                * self.swing
                * (self.omega / rise) ** 2
                * self.law(kappa, 2)
            )
            name = "ideal spring" if self.spring is self.ideal else "spring"
            curves = [("inertia", position, inertia), (name, position, self.spring(position))]
            plots.append(
                Plot("Torque on the driven link, forwards", "share of the stroke", "N m", curves)
            )
        pressure = [(name, x, np.degrees(cam.pressure_angle(theta))) for name, cam in cams.items()]
        return [*plots, Plot("Pressure angle", "cam angle, deg", "deg", pressure)]

    def _peaks(self) -> Table:
        """Peaks of the law on its 61-point table and on the continuum."""
        points = np.arange(2 * _Z + 1) / (2 * _Z)
        law = self.law
        breaks = self.law.breaks
        rows = []
        curves: Sequence[tuple[str, Callable[[Floats], Floats]]] = (
            ("speed |b|", lambda u: law(u, 1)),
            ("acceleration |c|", lambda u: law(u, 2)),
            ("power |b c|", lambda u: law(u, 1) * law(u, 2)),
        )
        for name, f in curves:
            rows.append([name, magnitude(f(points)), largest(f, breaks)])
        return Table(
            f"Peaks of the law {law.name}",
            ("invariant", f"{len(points)}-point table", "continuum"),
            rows,
        )

    def _unloaders(self) -> Table:
        """The spring beside none, and beside the ideal one."""
        theta, turning, found = self._fine
        bare = peak(found.follower_bare, turning)
        ideal = peak(self.at(theta, spring=self.ideal).follower, turning)
        rows = [
            ["none", bare, 100.0],
            ["ideal: what the law asks, cannot be built", ideal, 100 * ideal / bare],
        ]
        if self.spring is not self.ideal:
            rows.append(["this spring", peak(found.follower, turning), 100 * self.residual])
        return Table(
            "Peak torque at the follower, by the unloader's spring",
            ("spring", "N m", "left, %"),
            rows,
        )

    def _speeds(self) -> Table:
        """The same spring at other speeds: inertia goes with their square, the spring does not."""
        theta, turning, _ = self._fine
        rows = []
        for percent in _SPEEDS:
            found = self.at(theta, percent / 100)
            bare = peak(found.follower_bare, turning)
            left = peak(found.follower, turning)
            rows.append([percent, bare, left, 100 * left / bare])
        columns = ("speed, %", "without, N m", "with, N m", "left, %")
        return Table(
            "Peak torque at the follower with the same spring at other speeds", columns, rows
        )

    def _synthesis(
        self, spring: SpringTorque, weights: Sequence[float], sines: int, cosines: int
    ) -> Table:
        rows = [
            [s.weight, s.peak, s.rest, s.objective, *s.sines, *s.cosines]
            for s in trade_off(spring, weights, sines, cosines)
        ]
        names = [f"A{k + 2}" for k in range(sines)] + [f"B{k + 1}" for k in range(cosines)]
        return Table(
            "Laws for this spring: Q = C² + q Y²", ("q", "peak C", "rest Y", "Q", *names), rows
        )
