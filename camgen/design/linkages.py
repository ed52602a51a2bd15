"""A design of a path search as a spec: points, links, drive, the output that is judged; and whether it can be made."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camgen.design.chains import Chain
from camgen.design.paths import Found
from camgen.errors import CamgenError
from camgen.numerics import Points
from camgen.spec import Data

TRACED, CRANK = "P", "crank"
_STEPS = 2000  # angles at which the worst distance is looked for
_PLACES = 24  # of the wanted path that the finished machine is judged at
_DIGITS = 6  # of a coordinate, mm


@dataclass(frozen=True)
class Candidate:
    """A design and the wanted path, as a machine of some spec's other tables."""

    found: Found
    wanted: Points
    tables: Data

    @cached_property
    def worst(self) -> float:
        """Greatest distance from the path to the wanted one or back, mm."""
        from scipy.spatial import cKDTree

        path = self.found.chain.trace(np.array([self.found.drawn]), _STEPS)[0][:, 0]
        a, b = (np.stack([z.real, z.imag], axis=-1) for z in (path, self.wanted))
        return float(max(np.max(cKDTree(b).query(a)[0]), np.max(cKDTree(a).query(b)[0])))

    def data(self, tolerance: float | None = None) -> Data:
        """Tables of the spec; tolerance: of PATH_ERROR, mm, its own worst distance and a fiftieth unless given."""
        places = self.wanted[np.linspace(0, len(self.wanted), _PLACES, endpoint=False).astype(int)]
        borne = tolerance or _rounded_up(1.02 * self.worst + 1e-3)
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
    def refused(self) -> str:
        """Why parts of it cannot be made or do not pass each other; empty where they can."""
        from camgen.machines import MECHANISMS, load
        from camgen.spec import choose, validate

        data = self.data()
        try:
            mechanism = validate(load(choose(data, MECHANISMS)), data)
            mechanism.parts()
        except CamgenError as error:
            return str(error).partition("\n")[0]
        failing = [finding for finding in mechanism.limits() if not finding.ok]
        return "; ".join(f"{each.code} {each.measured:.4g}, the limit is {each.limit:.4g} {each.unit}" for each in failing)

    def row(self, number: int) -> dict[str, Any]:
        """What a table of the front shows."""
        chain = self.found.chain
        return {
            "design": number, "links": len(chain.bodies), "mean_distance_mm": round(self.found.error / 2, 6),
            "worst_distance_mm": round(self.worst, 6), "bars_mm": round(self.found.bars, 4),
            "verdict": "holds" if not self.refused else "refused", "reason": self.refused,
        }  # fmt: skip


def names(chain: Chain) -> list[str]:
    """Names of a chain's points: O and A of the crank, C at rest, B held by pairs, P traced."""
    rest = ["C"] if chain.grounds == 1 else [f"C{k}" for k in range(1, chain.grounds + 1)]
    held = [f"B{k}" if len(chain.pairs) > 2 else "B" for k in range(1, len(chain.pairs))]
    return ["O", "A", *rest, *held, TRACED]


def _place(z: complex) -> list[float]:
    return [round(float(z.real), _DIGITS) + 0.0, round(float(z.imag), _DIGITS) + 0.0]


def _rounded_up(value: float) -> float:
    """To two digits, upwards."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit) * unit:.3g}")
