"""The even drive of the cam beside two-crank chains before it: the same motion of the link in time, other cams.

Size and ratio are those at which the pressure angle reaches what is allowed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camgen.errors import DesignError
from camgen.machine.cams.followers import Follower
from camgen.machine.cams.profile import DiscCam
from camgen.machine.cams.sizing import survey
from camgen.machines.indexing_cam.driver import TwoCranks
from camgen.motion.laws import Floats
from camgen.motion.program import Program
from camgen.numerics import halved, magnitude
from camgen.study import Table

_SHARES = (0.0, 0.2, 0.3, 0.4)
# deg of a turn that are tried; halvings; sizes of a cam to begin with
_SHORTEST = 10.0
_LONGEST = 179.0
_STEPS = 16
_SIZES = 24
_NONE = "none"
COLUMNS = (
    "offset / crank",
    "greatest to mean speed of the cam",
    "cam angle of a turn, deg",
    "pressure angle, deg",
    "least base radius, mm",
    "least turn / dwell",
    "peak acceleration of the link, deg/s²",
    "peak torque on the cam shaft without unloader, N m",
    "with unloader, N m",
)


@dataclass(frozen=True)
class Comparison:
    """What is kept: turns of `rise` deg of 180, base radius and roller, mm, the allowed pressure angle, deg.

    program: of the cam by chain and deg of a turn; follower: by base radius; chain: by offset over crank and deg of a turn;
    sizes: least and greatest distance of roller and shaft, mm; ratio: of the link to the follower; speed: rad/s of theta;
    efforts: torque at the follower over theta, (n,) N m, without the unloader and with it.
    """

    program: Callable[[TwoCranks | None, float], Program]
    follower: Callable[[float], Follower]
    chain: Callable[[float, float], TwoCranks | None]
    rise: float
    base: float
    roller: float
    pressure: float
    sizes: tuple[float, float]
    ratio: float
    speed: float
    theta: Floats
    efforts: tuple[Floats, Floats]

    def table(self, own: float | None) -> Table:
        """Even, by chains, and by the one of the spec, each by offset over crank."""
        shares = sorted({*_SHARES, *([] if own is None else [round(own, 9)])})
        title = f"Even drive (0) and two-crank chains before the cam, for the same motion of the link and a pressure angle of at most {self.pressure:g} deg"
        return Table(title, COLUMNS, [self.row(share) for share in shares])

    def row(self, share: float) -> list[object]:
        """Figures of one chain; "none" where nothing keeps to the pressure angle."""
        chain = self.chain(share, self.rise)
        cam = DiscCam(self.program(chain, self.rise), self.follower(self.base))
        even = self.program(None, self.rise)  # so the link moves in time by any chain
        swing = [even(self.theta, order) for order in range(3)]
        rate = np.ones(self.theta.size) if chain is None else chain.cam(self.theta, 1)
        turning = np.abs(swing[1]) > 1e-9
        torques = [
            float(np.max(np.abs(effort * swing[1] / rate)[turning])) for effort in self.efforts
        ]
        turn = self.rise if chain is None else math.degrees(chain.turn)
        return [
            share,
            float(rate.max()),
            turn,
            math.degrees(survey(cam).pressure),
            self._least_base(chain),
            self._least_ratio(share),
            math.degrees(magnitude(swing[2])) * self.ratio * self.speed**2,
            *torques,
        ]

    def _fits(self, cam: DiscCam[Follower]) -> bool:
        seen = survey(cam)
        return (
            seen.pressure <= math.radians(self.pressure)
            and seen.least_radius >= 0
            and seen.clear > 0
        )

    def _least_base(self, chain: TwoCranks | None) -> float | str:
        """By the halving of sizes: the first that fits, counted from below."""
        program = self.program(chain, self.rise)
        low, high = self.sizes

        def fits(size: float) -> bool:
            try:
                return self._fits(DiscCam(program, self.follower(size - self.roller)))
            except DesignError:
                return False

        size = next((size for size in np.linspace(low, high, _SIZES) if fits(float(size))), None)
        if size is None:
            return _NONE
        low = max(low, float(size) - (high - low) / (_SIZES - 1))
        high = float(size)
        return halved(fits, low, high, _STEPS) - self.roller

    def _least_ratio(self, share: float) -> float | str:
        follower = self.follower(self.base)

        def fits(rise: float) -> bool:
            return self._fits(DiscCam(self.program(self.chain(share, rise), rise), follower))

        if not fits(_LONGEST):
            return _NONE
        rise = halved(fits, _SHORTEST, _LONGEST, _STEPS)
        return rise / (180 - rise)
