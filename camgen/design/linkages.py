"""A design of a path search as a spec: points, links, drive, the output that is judged; and whether it can be made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.design.chains import Chain
from camgen.design.paths import ChainDesign
from camgen.design.prototype import Prototype, miss, prototype, rounded_up
from camgen.machine.targets import Trace, path_distance
from camgen.numerics import Points
from camgen.reading import Data
from camgen.report.sketches import Sketch

TRACED = "P"
CRANK = "crank"
_STEPS = 2000  # angles of a turn, corners of the line in place of the path
_RESOLUTION = 0.001  # of the distance that is borne, to which the worst one is found
_DIGITS = 6  # of a coordinate, mm
_SKETCHED = 600  # places of the wanted path in a sketch


@dataclass(frozen=True)
class Candidate:
    """A design and the wanted path, as a machine of some spec's other tables."""

    design: ChainDesign
    wanted: Points  # corners of the wanted path, or its places where no lines join them
    tables: Data  # of the spec, less what is found
    allowance: float  # mm, how far path and wanted one may be apart
    joined: bool = True  # whether lines join the wanted points in their order
    tolerance: float | None = None  # mm, that the wish says

    @cached_property
    def path(self) -> Points:
        """What the last point traces over a turn, complex mm."""
        return self.design.chain.trace(np.array([self.design.points]), _STEPS)[0][:, 0]

    @cached_property
    def worst(self) -> float:
        """Greatest distance from the path to the wanted one or back, mm: no place of either is farther from the other one."""
        corners = np.append(self.path, self.path[:1])
        bend = np.abs(
            np.diff(corners, 2, append=corners[1])
        )  # twice what a second difference says of the way between
        return path_distance(
            corners, float(np.max(bend)) / 4, self.wanted, self.joined, _RESOLUTION * self.allowance
        ).proven

    @property
    def least_tolerance(self) -> float:
        """A tolerance that it keeps, mm: its worst distance and a fiftieth."""
        return rounded_up(1.02 * self.worst + 1e-3)

    def data(self, tolerance: float | None = None) -> Data:
        """Tables of the spec; tolerance: of PATH_ERROR, mm, unless given the wish's, or what it keeps and no more than is borne."""
        tolerance = tolerance or self.tolerance or min(self.least_tolerance, self.allowance)
        trace = {
            "at": [_place(z) for z in self.wanted],
            "joined": self.joined,
            "tolerance": tolerance,
        }
        drive = {"link": CRANK, **self.tables.get("drive", {})}
        output = [{"name": "path", "point": TRACED, "path": trace}]
        own = {"points": self.points, "links": self.links, "drive": drive, "output": output}
        return {**{key: value for key, value in self.tables.items() if key not in own}, **own}

    @property
    def points(self) -> Mapping[str, list[float]]:
        """Points by name, as drawn."""
        return dict(zip(names(self.design.chain), map(_place, self.design.points), strict=True))

    @property
    def links(self) -> Mapping[str, list[str]]:
        """Points of each link."""
        points = names(self.design.chain)
        bodies = [[points[k] for k in sorted(body)] for body in self.design.chain.bodies]
        return {
            "ground": bodies[0],
            CRANK: bodies[1],
            **{f"link{k}": body for k, body in enumerate(bodies[2:], 1)},
        }

    @property
    def miss(self) -> str:
        """What of the wish it does not keep; empty where it keeps it."""
        return miss(Trace.code, self.worst, self.allowance, "mm")

    @cached_property
    def prototype(self) -> Prototype:
        """Whether it can be made, and its play."""
        return prototype(self.data(self.least_tolerance), self.miss)

    @cached_property
    def sketch(self) -> Sketch:
        """What a sketch shows."""
        chain = self.design.chain
        every = dict(zip(names(chain), self.design.points, strict=True))
        still = [name for k, name in enumerate(every) if k == 0 or 2 <= k < chain.base]
        links = [points for name, points in self.links.items() if name != "ground"]
        step = max(1, len(self.wanted) // _SKETCHED)
        return Sketch(
            every,
            links,
            still,
            self.path[:: _STEPS // 120],
            np.append(self.wanted[::step], self.wanted[-1:]),
            self.joined,
        )

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""
        chain = self.design.chain
        return {
            "design": number,
            "links": len(chain.bodies),
            "worst_distance_mm": round(self.worst, 6),
            "mean_distance_mm": round(self.design.error / 2, 6),
            "bars_mm": round(self.design.bars, 4),
            **self.prototype.row,
        }


def names(chain: Chain) -> list[str]:
    """Names of a chain's points: O and A of the crank, C at rest, B held by pairs, P traced."""
    rest = ["C"] if chain.grounds == 1 else [f"C{k}" for k in range(1, chain.grounds + 1)]
    dyads = [f"B{k}" if len(chain.pairs) > 2 else "B" for k in range(1, len(chain.pairs))]
    return ["O", "A", *rest, *dyads, TRACED]


def _place(z: complex) -> list[float]:
    return [round(float(z.real), _DIGITS) + 0.0, round(float(z.imag), _DIGITS) + 0.0]
