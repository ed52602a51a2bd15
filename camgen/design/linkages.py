"""A design of a path search as a spec: points, links, drive, the output that is judged; and whether it can be made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.design.chains import Chain
from camgen.design.paths import Found
from camgen.design.weighed import Weighed, rounded_up
from camgen.numerics import Floats, Points
from camgen.reading import Data
from camgen.report.sketches import Drawn

TRACED, CRANK = "P", "crank"
_STEPS = 2000  # angles at which the worst distance is looked for
_PLACES = 24  # of the wanted path, evenly, that the finished machine is judged at, and the one that it misses most
_DIGITS = 6  # of a coordinate, mm


@dataclass(frozen=True)
class Candidate:
    """A design and the wanted path, as a machine of some spec's other tables."""

    found: Found
    wanted: Points
    tables: Data
    joined: bool = True  # whether lines join the wanted points in their order

    @cached_property
    def path(self) -> Points:
        """What the last point traces over a turn, complex mm."""
        return self.found.chain.trace(np.array([self.found.drawn]), _STEPS)[0][:, 0]

    @cached_property
    def worst(self) -> float:
        """Greatest distance from the path to the wanted one or back, mm."""
        return float(max(np.max(each) for each in self._distances))

    @cached_property
    def _distances(self) -> tuple[Floats, Floats]:
        """How far each place of the path lies from the wanted one, and each wanted place from the path, mm."""
        from scipy.spatial import cKDTree

        a, b = (np.stack([z.real, z.imag], axis=-1) for z in (self.path, self.wanted))
        return cKDTree(b).query(a)[0], cKDTree(a).query(b)[0]

    def data(self, tolerance: float | None = None) -> Data:
        """Tables of the spec; tolerance: of PATH_ERROR, mm, its own worst distance and a fiftieth unless given."""
        even = np.linspace(0, len(self.wanted), _PLACES, endpoint=False).astype(int)
        places = self.wanted[sorted({*even.tolist(), int(np.argmax(self._distances[1]))})]
        borne = tolerance or rounded_up(1.02 * self.worst + 1e-3)
        through = {"at": [_place(z) for z in places], "tolerance": borne}
        drive = {"link": CRANK, **self.tables.get("drive", {})}
        output = [{"name": "path", "point": TRACED, "points": through}]
        drawn = {"points": self.points, "links": self.links, "drive": drive, "output": output}
        return {**{key: value for key, value in self.tables.items() if key not in drawn}, **drawn}

    @property
    def points(self) -> Mapping[str, list[float]]:
        """Points by name, as drawn."""
        return dict(zip(names(self.found.chain), map(_place, self.found.drawn), strict=True))

    @property
    def links(self) -> Mapping[str, list[str]]:
        """Points of each link."""
        named = names(self.found.chain)
        bodies = [[named[k] for k in sorted(body)] for body in self.found.chain.bodies]
        return {"ground": bodies[0], CRANK: bodies[1], **{f"link{k}": body for k, body in enumerate(bodies[2:], 1)}}

    @cached_property
    def weighed(self) -> Weighed:
        """Whether it can be made, and its play."""
        return Weighed(self.data())

    @cached_property
    def drawn(self) -> Drawn:
        """What a sketch shows."""
        chain = self.found.chain
        every = dict(zip(names(chain), self.found.drawn, strict=True))
        still = [name for k, name in enumerate(every) if k == 0 or 2 <= k < chain.base]
        links = [points for name, points in self.links.items() if name != "ground"]
        wanted = self.wanted if self.joined else self.wanted[:0]
        return Drawn(every, links, still, self.path[:: _STEPS // 120], wanted[:: max(1, len(self.wanted) // 200)])

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""
        chain = self.found.chain
        return {
            "design": number, "links": len(chain.bodies), "mean_distance_mm": round(self.found.error / 2, 6),
            "worst_distance_mm": round(self.worst, 6), "bars_mm": round(self.found.bars, 4), **self.weighed.row,
        }  # fmt: skip


def names(chain: Chain) -> list[str]:
    """Names of a chain's points: O and A of the crank, C at rest, B held by pairs, P traced."""
    rest = ["C"] if chain.grounds == 1 else [f"C{k}" for k in range(1, chain.grounds + 1)]
    held = [f"B{k}" if len(chain.pairs) > 2 else "B" for k in range(1, len(chain.pairs))]
    return ["O", "A", *rest, *held, TRACED]


def _place(z: complex) -> list[float]:
    return [round(float(z.real), _DIGITS) + 0.0, round(float(z.imag), _DIGITS) + 0.0]
