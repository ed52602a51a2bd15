"""A two-crank chain before the cam, so that it turns fastest where run-up passes into run-down: Whitworth's turning block.

    crank    turns evenly about P, twice while the cam turns once; its pin is `crank` from there
    arm      turns about Q, `offset` from P, the crank's pin in its slot; it drives the cam's shaft 2 to 1, in its own sense
    psi      angle of the arm, 0 where it is fastest: the middle of a turn of the driven link, forwards and back
    tau      that of the crank: tau = psi - asin(e sin psi), e = offset / crank; there d psi / d tau = 1 / (1 - e)

The cam's law is the wanted one over the time, so the driven link moves as by an even drive; only the cam's angle is another.
[recommended by the source for periodic turns: smaller size, wider range of the ratio turn / dwell]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.errors import Fault
from camgen.machine.model import Turning
from camgen.machines.indexing_cam.drawing import Drawing
from camgen.machines.indexing_cam.tables import Driver
from camgen.motion.laws import Floats, Law, measured
from camgen.study import Figure, Sketch

CRANK = "crank"
ARM = "arm"
CHAIN = (
    "A crank that turns evenly, twice while the cam turns once, drives the cam through an arm in whose slot its pin runs "
    "(Whitworth's turning block), 2 to 1. Angles of the report grow evenly with the time; those of the outlines and of the "
    "pressure angle are the cam's own. "
)
NOT_MADE = 'The chain is not made, with a belt or an idler between arm and cam; parts.make = "printed" makes it, with two wheels.'
MADE = (
    "The arm's axle stands inside the path of the crank, so crank and arm are held from either side: the arm's shaft from the "
    "plate above them, the crank's from a bracket below. The arm's wheel turns the cam's, so they turn against each other."
)
_MOST = 0.8  # of the crank, that the offset may be: there the cam turns five times as fast as on average


@dataclass(frozen=True)
class TwoCranks:
    """Sizes in mm, crank > offset > 0; half: angle of the crank from the begin of a turn of the link to its middle, rad;
    sense: -1 where the cam turns clockwise; at: place of the arm's axle on the ground, complex mm; against: whether the arm
    turns against the cam, as two wheels do."""

    crank: float
    offset: float
    half: float
    sense: int
    at: complex
    against: bool = False

    @property
    def share(self) -> float:
        """e = offset / crank."""
        return self.offset / self.crank

    def tau(self, psi: Floats) -> list[Floats]:
        """Angle of the crank at an angle of the arm, and its derivatives of order 1..3, each (n,) rad."""
        e = self.share
        s = np.sin(psi)
        c = np.cos(psi)
        x = [e * s, e * c, -e * s, -e * c]  # sin of the angle between both, and its derivatives
        w = 1 / np.sqrt(1 - x[0] ** 2)
        first = x[1] * w
        second = x[2] * w + x[0] * x[1] ** 2 * w**3
        third = (
            x[3] * w
            + (3 * x[0] * x[1] * x[2] + x[1] ** 3) * w**3
            + 3 * x[0] ** 2 * x[1] ** 3 * w**5
        )
        return [psi - np.arcsin(x[0]), 1 - first, -second, -third]

    def psi(self, tau: float) -> float:
        """Angle of the arm at one of the crank, -pi..pi, rad."""
        return cmath.phase(cmath.exp(1j * tau) - self.share)

    def cam(self, theta: Floats, order: int = 0) -> Floats:
        """Cam angle at theta, which grows evenly with the time and once while the cam turns once, or its slope, (n,) rad."""
        spin = np.exp(1j * (2 * np.asarray(theta, float) - self.sense * self.half))
        if order == 1:
            return np.asarray((spin / (spin - self.share)).real)
        return np.asarray(
            theta
            + (np.angle((spin - self.share) / spin) + self.sense * (self.turn - self.half)) / 2
        )

    @property
    def turn(self) -> float:
        """Cam angle in which the driven link turns, rad."""
        return self.psi(self.half)

    def paced(self, law: Law, sized: bool = True) -> Law:
        """A law of the time as one of the cam's angle over a turn of the link; sized: whether with its peaks, else nan."""
        far = self.turn

        def formula(u: Floats, order: int) -> Floats:
            tau = self.tau(far * (2 * u - 1))
            # inside 0..1 at its ends too, where rounding would leave them
            kappa = np.clip((tau[0] / self.half + 1) / 2, 0.0, 1.0)
            k1, k2, k3 = (tau[k] * (2 * far) ** k / (2 * self.half) for k in (1, 2, 3))
            if order == 0:
                return law(kappa)
            if order == 1:
                return np.asarray(law(kappa, 1) * k1)
            if order == 2:
                return np.asarray(law(kappa, 2) * k1**2 + law(kappa, 1) * k2)
            return np.asarray(
                law(kappa, 3) * k1**3 + 3 * law(kappa, 2) * k1 * k2 + law(kappa, 1) * k3
            )

        breaks = tuple((self.psi(self.half * (2 * b - 1)) / far + 1) / 2 for b in law.breaks)
        name = f"{law.name}, on a cam that turns unevenly"
        if sized:
            return measured(name, formula, law.source, breaks, law.ends)
        return Law(name, formula, -1, math.nan, math.nan, math.nan, law.source, breaks, law.ends)

    @property
    def _way(self) -> int:
        """-1 where the arm turns against the cam."""
        return -1 if self.against else 1

    @property
    def drive(self) -> Turning:
        """Angle of the crank, over theta: evenly, twice while the cam turns once."""
        return Turning(2.0 * self._way, -self._way * self.sense * self.half)

    def draw(self, drawing: Drawing) -> None:
        """Add crank and arm, which then drive, to a linkage."""
        points = drawing.points
        links = drawing.links
        points["motor"] = self.at - self.offset
        points["pin"] = points["motor"] + self.crank * cmath.exp(1j * self.drive.start)
        points["arm"] = self.at
        psi = -self._way * self.sense * self.turn
        points["end"] = self.at + (self.crank + self.offset) * cmath.exp(1j * psi)
        links["ground"] += ["motor", "arm"]
        links[CRANK] = ["motor", "pin"]
        links[ARM] = ["arm", "end"]
        drawing.gears.append({"name": "two_to_one", "a": ARM, "b": "cam", "ratio": self._way / 2})
        block = {"name": "block", "pin": "pin", "link": ARM, "along": ("arm", "end")}
        drawing.others["slot"] = [block]
        drawing.others["drive"] |= {"link": CRANK}

    @property
    def figures(self) -> list[Figure]:
        """For the report."""
        return [
            Figure("driver offset to crank", self.share),
            Figure("driver fastest to mean speed", 1 / (1 - self.share)),
            Figure("driver slowest to mean speed", 1 / (1 + self.share)),
            Figure("cam turn", math.degrees(self.turn), "deg"),
        ]

    def sketches(self) -> tuple[Sketch, Sketch]:
        """Crank and arm, which are not made."""
        hub = self.crank / 4
        crank = Sketch(
            CRANK, [np.array([0j, self.crank])], [(0j, hub), (complex(self.crank), hub / 2)], CRANK
        )
        return crank, Sketch(ARM, [np.array([0j, self.crank + self.offset])], [(0j, hub / 2)], ARM)


def driver_faults(driver: Driver, spans: Sequence[float]) -> list[Fault]:
    """What is wrong with [driver]; spans: of rise, dwell and return, deg."""
    found = []
    rise, dwell, back = spans
    if not driver.offset <= _MOST * driver.crank:
        right = f"at most {_MOST:g} of the crank, {driver.crank:g} mm: beyond, the arm does not turn with it, or by jerks"
        found.append(Fault(("driver", "offset"), f"{driver.offset:g}", right))
    if abs(rise + dwell - 180) > 1e-9:
        right = f"180 less rise_deg, {180 - rise:g}, with [driver]: its chain turns twice while the cam turns once"
        found.append(Fault(("geometry", "dwell_deg"), f"{dwell:g}", right))
    if abs(rise - back) > 1e-9:
        found.append(
            Fault(("geometry", "return_deg"), f"{back:g}", f"rise_deg, {rise:g}, with [driver]")
        )
    return found
