"""Designs of a path search as machines: points, links, drive, and the output that is judged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camgen.design import paths
from camgen.design.chains import Chain
from camgen.design.found import CRANK, Found, Judged, place
from camgen.design.offers import Aim, Offer
from camgen.design.paths import ChainDesign
from camgen.design.polish import Goal
from camgen.design.request import Request
from camgen.design.target import Target
from camgen.design.wanted import PathWish
from camgen.design.weighing import Designs
from camgen.errors import DesignError, counted
from camgen.machine.targets import Trace, path_distance
from camgen.numerics import Points
from camgen.reading import Data
from camgen.report.sketches import Sketch
from camgen.workers import Workers

TRACED = "P"
# of the wanted path's longest chord: error, and length of all bars, that a front reaches to
_WORST = 0.2
_MOST = 10.0
_BEHIND = 0.8  # of the error and bars of a design that could be built: the front reaches to those at most so much worse
_STEPS = 2000  # angles of a turn, corners of the line in place of the path
_RESOLUTION = 0.001  # of the distance that is borne, to which the worst one is found
_SKETCHED = 600  # places of the wanted path in a sketch


@dataclass(frozen=True)
class Tracing:
    """The wanted path, and what else designs need to be machines of some spec."""

    wanted: Points  # corners of the wanted path, or its places where no lines join them
    tables: Data  # of the spec, less what is found
    allowance: float  # mm, how far path and wanted one may be apart
    joined: bool = True  # whether lines join the wanted points in their order
    default: str = ""  # what the allowance is where the wish does not say it

    def found(self, design: ChainDesign) -> Found:
        """A design as a machine."""
        chain = design.chain
        path = chain.trace(np.array([design.points]), _STEPS)[0][:, 0]
        worst = self._worst(path)
        values = {"at": [place(z) for z in self.wanted], "joined": self.joined}
        output = {"name": "path", "point": TRACED}
        limits = (Trace.code, worst, self.allowance, "mm", "tolerance", self.default)
        judged = Judged(output, "path", values, *limits)
        figures = {
            "links": len(chain.bodies),
            "worst_distance_mm": worst,
            "mean_distance_mm": design.error / 2,
            "bars_mm": design.bars,
        }
        every = names(chain)
        bodies = [[every[k] for k in sorted(body)] for body in chain.bodies]
        links = {CRANK: bodies[1]} | {f"link{k}": body for k, body in enumerate(bodies[2:], 1)}
        places = dict(zip(every, design.points, strict=True))
        still = [every[k] for k in (0, *range(2, chain.base))]
        step = max(1, len(self.wanted) // _SKETCHED)
        shown = np.append(self.wanted[::step], self.wanted[-1:])
        sketch = Sketch(
            places, list(links.values()), still, path[:: _STEPS // 120], shown, self.joined
        )
        drive = {"link": CRANK, **self.tables.get("drive", {})}
        links = {"ground": bodies[0], **links}
        return Found(places, links, drive, [judged], figures, design.bars, sketch, self.tables)

    def _worst(self, path: Points) -> float:
        """Greatest distance from the path to the wanted one or back, mm: no place of either is farther from the other one."""
        corners = np.append(path, path[:1])
        # a second difference says twice how far the way between bends
        bend = np.abs(np.diff(corners, 2, append=corners[1]))
        resolution = _RESOLUTION * self.allowance
        return path_distance(
            corners, float(np.max(bend)) / 4, self.wanted, self.joined, resolution
        ).proven


def offer(request: Request) -> Offer:
    """Linkages for the path that a spec wants; SpecError, DesignError."""

    def path() -> tuple[PathWish, Points]:
        record: PathWish = request.wish()
        return record, record.line(request.folder)

    sizes, (wish, line) = request.for_linkage(path)
    target = Target(wish.points(line))
    chord = target.chord
    shortest = wish.shortest or sizes.pin_diameter + 2 * sizes.wall  # of a hub
    sine = math.sin(math.radians(max(wish.transmission_deg, 0.1)))
    goal = Goal(target, _WORST * chord, _MOST * chord, shortest, sine)
    kinds = [chain for chain in paths.kinds(wish.bars // 2, 2) if len(chain.bodies) <= wish.bars]
    minutes = "; this takes minutes" if len(kinds) > 1 else ""
    request.say(f"searched: {counted(len(kinds), 'chain')}{minutes}")
    default = "" if wish.tolerance else "a twentieth of the path's longest chord"
    tables = request.with_lash("lash", wish.lash)
    tracing = Tracing(line, tables, wish.allowance(chord), wish.joined, default)
    with Workers(request.jobs) as workers:
        found = paths.search(goal, kinds, wish.effort, wish.seed, workers.map, request.say)
        if not found:
            raise DesignError("designs whose chain closes", 0, 1, "", "wanted", wish.further)
        designs = machines(found, tracing).weighed(workers.map, request.say)
    play = wish.useful_play(chord)
    name = wish.path if isinstance(wish.path, str) else f"{len(wish.path)} points"
    return Offer(
        designs,
        Aim(wish.lash, play, "mm", True, "has the shortest bars", wish.further),
        f"Linkages for the path of {request.data.get('name')}",
        "each comes nearer to the path on average than any design with shorter links. Design 1 is 01.toml, "
        "and so on. Those that can be built come first: by their greatest "
        f"distance from the path those whose play is of use, {play:.4g} mm at most.",
        {
            "worst_distance_mm": "at most {:.3g} mm from the path",
            "bars_mm": "bars of {:.4g} mm",
            "mean_distance_mm": "{:.3g} mm in the mean",
            "lash": "play of {:.3g} mm",
        },
        f"found by camgen design for the path {name}; output.path: that path, and how far this machine's may be from it",
    )


def machines(found: Sequence[ChainDesign], tracing: Tracing) -> Designs:
    """Designs for a path as what is weighed: those on the front or near it that lie apart."""
    near = paths.apart(paths.near(found, paths.front(found), _BEHIND))
    losses = np.array([[each.error, each.bars] for each in near])
    return Designs(losses, lambda k: tracing.found(near[k]))


def names(chain: Chain) -> list[str]:
    """Names of a chain's points: O and A of the crank, C at rest, B held by pairs, P traced."""
    rest = ["C"] if chain.grounds == 1 else [f"C{k}" for k in range(1, chain.grounds + 1)]
    dyads = [f"B{k}" if len(chain.pairs) > 2 else "B" for k in range(1, len(chain.pairs))]
    return ["O", "A", *rest, *dyads, TRACED]
