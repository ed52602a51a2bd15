"""Turning on: a freewheel takes the link along while its wheel turns forwards, one on the ground holds it while that turns back.

    wheel     geared to the follower, it swings to and fro, a little further than the link turns
    lost      what it turns forwards before the rollers of the freewheel lock, rad
    engaged   from there to the end of the rise: the link turns with the wheel; else it is held

The freewheel only pushes: where the link needs to be braked it runs ahead. So torque, unloader and friction together have to
leave something to push at every angle. [the source moves a link on by half turns; its own chain is not told in the text]
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from camgen.findings import Finding, Where, at_least, at_most
from camgen.machine.targets import Advance
from camgen.machines.indexing_cam.unloader import Load, SpringTorque, Torques, torques
from camgen.motion.laws import Floats
from camgen.motion.program import Program
from camgen.numerics import halved
from camgen.study import Figure, Plot, Table, figures_in

FORWARDS: Literal[
    -1
] = -1  # sense of the wheel's angle as the follower swings out: it is geared to it
NOTE = (
    "The driven link turns in one sense only: its shaft runs in two freewheels. One is in the wheel that the follower rocks, and takes the "
    "shaft along forwards only; the other is in the plate, and holds it while the wheel goes back. So each turn of the cam "
    "shaft makes one indexing, and the dwell lasts from the end of a rise to the next. The unloader's crank turns with "
    "the link, once for each indexing, and stops unloader.lead_deg before its dead centre: there its spring draws the link "
    "back on the freewheel of the plate, which holds it. In the source's fig. 1 a second cam (3) swings a carrier (8) with "
    "the gears and the spring about the output shaft; we assume that this reverses the spring in the dwell. Here the "
    "crank goes over its dead centre as a turn begins, and no second cam is needed; the price is that the spring pulls back "
    "first. A freewheel cannot brake: what is left of the inertia in the run-down has to be less than the friction of the "
    "link (load.friction_n_m, of a felt under the table say). Errors of the turns add up: a table that has to stop in the "
    "same places needs a notch as well."
)


@dataclass(frozen=True)
class Stepping:
    """The link's turn, by the follower's program.

    rise: span of theta in which it swings out, rad; ratio: wheel to follower; index: turn of the link, lost: as above, rad;
    sense: -1 where theta runs backwards; limit: torque of one freewheel, N m.
    """

    program: Program
    rise: float
    ratio: float
    index: float
    lost: float
    sense: int
    limit: float

    def taken(self, theta: Floats) -> tuple[Floats, Floats, Any]:
        """Turns that are done, turn of the link in this one, rad, and whether the wheel turns it, each (n,)."""
        time = self.sense * np.asarray(theta, float)
        turns = np.floor(time / math.tau)
        rising = time - math.tau * turns < self.rise
        far = self.ratio * self.program(theta) - self.lost
        engaged = rising & (far >= 0)
        return turns, np.where(rising, np.clip(far, 0.0, self.index), self.index), engaged

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        """Angle of the link, 0 at first, or its derivative to theta, (n,) rad."""
        turns, taken, engaged = self.taken(theta)
        if order == 0:
            return np.asarray(FORWARDS * (self.index * turns + taken))
        return np.asarray(
            np.where(engaged, FORWARDS * self.ratio * self.program(theta, order), 0.0)
        )

    @cached_property
    def locks(self) -> float:
        """theta from the begin of a rise to where the freewheel locks, rad."""
        return halved(
            lambda at: (
                self.ratio * float(self.program(np.array([self.sense * at]))[0]) >= self.lost
            ),
            0.0,
            self.rise,
        )

    def wanted(self, tolerance: float) -> Advance:
        """The turn of the link in each turn of the cam, judged on its wheel; tolerance: deg."""
        index = math.degrees(self.index)
        lost = math.degrees(self.lost)
        return Advance(
            value=index,
            tolerance=tolerance,
            lost=lost,
            forwards=FORWARDS,
            time=-1 if self.sense < 0 else 1,
        )

    # ---- torques ----------------------------------------------------------------------------------------------------

    def torques(
        self, theta: Floats, omega: float, load: Load, spring: SpringTorque | None
    ) -> Torques:
        """Of the link while it is turned, and of the follower; omega: of theta, rad/s."""
        _, taken, engaged = self.taken(theta)
        return torques(
            (taken, self.program(theta, 1), self.program(theta, 2)),
            self.index,
            omega,
            load,
            spring,
            engaged,
        )

    def pushes(self, theta: Floats, found: Torques, load: Load, pull: Floats) -> Floats:
        """Torque in the freewheel of the wheel, (n,) N m, nan while it runs free; pull: of the spring on the link, N m."""
        _, _, engaged = self.taken(theta)
        return np.where(engaged, found.inertia + load.friction - pull, np.nan)

    def findings(
        self, theta: Floats, pushing: Floats, load: Load, held: float, process: float, angle: str
    ) -> list[Finding]:
        """Whether the link keeps to its wheel, is held in the dwell, and the freewheels bear it.

        held: torque of the spring that draws the link back in the dwell, process: of the process there, N m.
        """
        worst = int(np.nanargmin(pushing))
        least = float(pushing[worst])
        most = max(float(np.nanmax(pushing)), held + process)
        where = Where("freewheel of the wheel", theta=float(theta[worst]), angle=angle)
        more = load.friction - least
        return [
            at_least(
                "FORCE_CLOSURE",
                least,
                0.0,
                "N m",
                where,
                "torque by which the wheel pushes the link; below 0 the link runs ahead and turns too far: a friction of "
                f"{more:.4g} N m at the link (load.friction_n_m) keeps it on its wheel, or less speed, or another unloader",
            ),
            at_least(
                "FORCE_CLOSURE",
                held + load.friction,
                process,
                "N m",
                Where("freewheel of the plate, in the dwell"),
                "torque of unloader and friction that keeps the link from turning by itself; the limit is the process's torque",
            ),
            at_most(
                "CLUTCH_TORQUE",
                most,
                self.limit,
                "N m",
                Where("freewheels of the driven link"),
                "the greatest torque that they bear; use a thicker parts.shaft_diameter, less speed or less inertia",
            ),
        ]

    # ---- report -----------------------------------------------------------------------------------------------------

    def figures(self, omega: float, pushing: Floats, load: Load, bare: Floats) -> Sequence[Figure]:
        """Advance, dwell, locking; pushing: as above, bare: the same without unloader, N m."""
        slope = float(self.program(np.array([self.sense * self.locks]), 1)[0])
        speed = self.ratio * abs(slope * omega)
        turning = self.rise - self.locks
        least = float(np.nanmin(pushing))
        return [
            Figure("advance a turn", math.degrees(self.index), "deg"),
            Figure("turn to dwell ratio", turning / (math.tau - turning)),
            Figure("dwell share ratio", 1 - turning / math.tau),
            Figure("lost motion", math.degrees(self.lost), "deg"),
            Figure("locking speed", math.degrees(speed), "deg/s"),
            Figure("locking energy", load.inertia * speed**2 / 2, "J"),
            *figures_in(
                "N m",
                freewheel_torque_least=least,
                freewheel_torque_greatest=float(np.nanmax(pushing)),
                brake_needed=max(0.0, load.friction - least),
                brake_needed_without_unloader=max(0.0, load.friction - float(np.nanmin(bare))),
            ),
        ]

    def plots(self, angle: str, theta: Floats, pushing: Floats) -> Sequence[Plot]:
        """The link over the turns of the cam shaft that bring it round once, two at least; what pushes it."""
        turns = min(max(2, math.ceil(math.tau / self.index - 1e-9)), 8)
        x = np.linspace(0, turns * math.tau, 360 * turns + 1)
        link = np.degrees(np.abs(self(self.sense * x)))
        wheel = np.degrees(self.ratio * self.program(self.sense * x))
        curves = [("driven link", np.degrees(x), link), ("its wheel", np.degrees(x), wheel)]
        held = np.nan_to_num(pushing)
        return [
            Plot(
                f"Driven link: steps over {turns} turns of the cam shaft",
                f"{angle} as time goes on, deg",
                "deg",
                curves,
            ),
            Plot(
                "Torque in the freewheel of the wheel",
                f"{angle}, deg",
                "N m",
                [("push", np.degrees(theta), held)],
            ),
        ]

    def table(self, advances: Mapping[str, float]) -> Table:
        """Of each kind of file the turn of the link in a turn of the cam, and how far it is off after ten; rad."""
        rows = [
            [
                kind,
                math.degrees(value),
                math.degrees(value - self.index),
                10 * math.degrees(value - self.index),
            ]
            for kind, value in advances.items()
        ]
        columns = ("file", "advance a turn, deg", "off, deg", "off after ten turns, deg")
        return Table(
            "Turn of the driven link behind its freewheel, as the files give it", columns, rows
        )
