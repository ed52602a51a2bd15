"""The two-crank four-bar thread take-up of a sewing machine: its coupler carries a thread eye on a path that crosses itself.

          M                    O fixed pivot (origin) of the input crank O-A, C that of the output crank C-B;
                               A-B-D the bell crank with the eye D, M and N the guides; the thread runs M-D-N.
     A --- O-C                 Stacked from the plate up: output crank, input crank, bell crank, thread.
     |   .
     B------- D                The output crank turns on a disc about C, since the input shaft, 9 mm away, must pass
                               through its bearing: so one plate carries all, and it is open to the front.
  N

As a linkage it has the links crank, coupler and output. The output is the feed L = |M - D| + |D - N|, mm.
[Semin, Korneenko, Kirillov, Mikheeva; see `feed`]
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, Key, SpecError
from camgen.findings import Finding, Where, at_least, at_most
from camgen.machine.closed_form import four_bar, refuse_gap
from camgen.machine.features import Demand
from camgen.machine.model import GROUND, Floats, Machine, Points
from camgen.machines.linkage.weights import under_faults
from camgen.machines.loads.counterweights import Counterweight
from camgen.machines.loads.tables import thin_walls
from camgen.machines.mechanism import refuse_failing
from camgen.machines.template import Template
from camgen.machines.thread_take_up.feed import TakeUp
from camgen.machines.thread_take_up.study import Consumption, Masses, shaft_stress, study
from camgen.machines.thread_take_up.tables import (
    TakeUpGeometry,
    TakeUpLimits,
    TakeUpMotor,
    TakeUpParts,
    Wanted,
)
from camgen.motion.synthesis import Variable, Wish, search
from camgen.parts.assembly import Assembly
from camgen.parts.counterweights import NAME
from camgen.parts.generator.sizes import Parts
from camgen.parts.part import clearance
from camgen.spec import validate
from camgen.study import Study
from camgen.tolerances import SAME_POINT
from camgen.vocabulary import OldWords

_LINKS = {
    GROUND: ("O", "C", "M", "N"),
    "crank": ("O", "A"),
    "coupler": ("A", "B", "D"),
    "output": ("C", "B"),
}
_MOVING = ("crank", "coupler", "output")
# own keys of what the sizes of a linkage call otherwise
_OWN_KEYS: dict[Key, Key] = {
    ("parts", "thread_posts", "height"): ("parts", "thread_height"),
    ("parts", "thread_posts", "groove"): ("parts", "groove"),
    ("parts", "base_thickness"): ("parts", "thickness"),
}
# where gaps are looked for; parts move < 0.2 mm between two
_TURN = np.linspace(0, math.tau, 1440, endpoint=False)


class ThreadTakeUp(Template):
    """Spec and answers of a two-crank four-bar thread take-up; the output is the feed, mm."""

    old_words: ClassVar[OldWords] = {
        **Template.old_words,
        ("motor", "shaft_diameter"): ("parts", "shaft_diameter"),
    }

    geometry: TakeUpGeometry
    motor: TakeUpMotor | None = Field(default=None, description="what turns the input crank")
    masses: Masses | None = Field(
        default=None, description="masses of the links, for forces; default: none"
    )
    consumption: Consumption | None = Field(
        default=None, description="thread that the stitch draws, linear in between"
    )
    wanted: Wanted | None = Field(
        default=None,
        description="what `camgen design` searches for, by moving eye, frame angle and guides",
    )
    counterweight: Counterweight | None = Field(
        default=None, description="a sector of a disc on the shaft of the input crank: balances it"
    )
    making: Annotated[TakeUpParts, Field(alias="parts")] = TakeUpParts.model_construct()
    allowed: Annotated[TakeUpLimits, Field(alias="limits")] = TakeUpLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        nozzle = self.print.nozzle
        wrong = self._sizes.faults(_LINKS, nozzle, self.allowed.min_wall)
        own = {_OWN_KEYS.get(each.path, each.path): each for each in wrong}
        found = [replace(each, path=path) for path, each in own.items()]
        found += thin_walls(self.allowed.min_wall, nozzle)
        weight = self.counterweight
        if weight is not None:
            found += [*weight.faults(), *under_faults(weight, self._sizes)]
        forces = {
            "a counterweight asks": weight is not None and weight.given is None,
            "[masses] ask": self.masses is not None,
        }
        for why in (why for why, needed in forces.items() if needed and self.motor is None):
            right = f"missing: a number > 0, since {why} for the forces"
            found.append(Fault(("motor", "speed_rpm"), "", right))
        return [*found, *(self.consumption.faults() if self.consumption else ())]

    # ---- what it is as a linkage --------------------------------------------------------------------------------------

    def tables(self) -> Mapping[str, Any]:
        """Crank, coupler and output crank as they stand at theta = 0, and the thread over guides and eye."""
        t = self.take_up
        crank, coupler, output = (t.machine.start[link] for link in _MOVING)
        places = {
            "O": crank.place,
            "A": coupler.place,
            "B": output.place + np.exp(1j * output.angle) * t.output,
            "C": output.place,
            "D": coupler.place + np.exp(1j * coupler.angle) * t.eye,
            "M": t.guides[0],
            "N": t.guides[1],
        }
        found: dict[str, Any] = {
            "points": {name: (float(z.real), float(z.imag)) for name, z in places.items()},
            "links": _LINKS,
            "drive": {
                "link": "crank",
                **({} if self.motor is None else {"speed_rpm": self.motor.speed_rpm}),
            },
            "output": ({"name": "feed", "thread": ("M", "D", "N")}, {"name": "eye", "point": "D"}),
            "layers": {"output": 1, "crank": 2, "coupler": 3},
            "parts": self._sizes,
            "limits": self.allowed.model_dump(exclude={"gap", "excess"}, exclude_none=True),
        }
        found |= {"masses": self.masses.of_linkage(t)} if self.masses else {}
        if self.counterweight:
            found["layers"][NAME] = 0
            found["counterweight"] = self.counterweight
        return found

    @property
    def _sizes(self) -> Parts:
        """Those of the linkage."""
        return self.making.of_linkage(self.geometry.frame, self.print, self.allowed.min_wall)

    @cached_property
    def take_up(self) -> TakeUp:
        """The engine for this spec; raises DesignError where the crank cannot turn fully or the chain folds flat."""
        g = self.geometry
        m, n = (complex(*guide) for guide in g.guides)
        found = TakeUp(
            g.input_crank,
            g.coupler,
            g.output_crank,
            g.frame,
            g.eye_distance,
            math.radians(g.eye_angle_deg),
            g.branch,
            (m, n),
            math.radians(g.frame_angle_deg),
            self._sense,
        )
        kind = four_bar(g.frame, g.input_crank, g.coupler, g.output_crank)
        if kind.kind == "change-point":
            raise DesignError(
                "Grashof margin",
                kind.margin,
                SAME_POINT,
                "mm",
                "the fold, where all links lie in one line",
                "the lengths make a change-point mechanism, which may go on either way there: change one of them",
            )
        if not kind.full_turn:
            edges = [
                side * edge + g.frame_angle_deg
                for span in kind.open_deg
                for edge in span
                for side in (1, -1)
            ]
            wide = (
                kind.open_deg[-1][1] == 180
            )  # which of the two critical places is the tighter one
            refuse_gap("B", -kind.slack, (180 if wide else 0) + g.frame_angle_deg, edges)
        return found

    def _found(self) -> Mapping[str, object]:
        """Centres of mass, the moment of a counterweight, and what every mechanism fills in."""
        return {**super()._found(), **(self.masses.centres(self.take_up) if self.masses else {})}

    def _unloaded(self) -> Machine:
        """The linkage, at the motor's speed, rad/s; nan without one."""
        return replace(super()._unloaded(), speed=self._speed)

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Feed (mm) or its derivative to theta, (n,)."""
        return self.take_up.feed(theta, order)

    def demands(self) -> tuple[Demand, ...]:
        """The feed."""
        return (Demand("feed", self.motion, stroke=True, lash=self.allowed.lash),)

    @cached_property
    def assembly(self) -> Assembly:
        """That of the linkage; the thread keeps the gap that is accepted, and nothing is said of a speed without a motor."""
        made = super().assembly
        strands = [replace(each, gap=self.allowed.gap) for each in made.strands]
        size = f"for a {self._sizes.shaft_text}"
        still = self.motor is None
        bought = [
            replace(each, size=size) if still and each.role == "drive" else each
            for each in made.bought
        ]
        return replace(made, strands=strands, bought=bought)

    # ---- checks and figures -------------------------------------------------------------------------------------------

    def findings(self) -> Sequence[Finding]:
        """Fold, gaps between what moves and what stands, excess thread, and the wishes."""
        g = self.geometry
        t = self.take_up
        p = self.making
        margin = four_bar(g.frame, g.input_crank, g.coupler, g.output_crank).margin
        play = 2 * self.print.slide_clearance
        said = (
            "Grashof margin of the lengths; within the play of the four joints (half of it each) the chain could fold and "
            "go on the wrong way"
        )
        findings = [at_least("FOLD_MARGIN", margin, play, "mm", Where("lengths"), said)]
        for name, (gap, theta) in self._gaps(t, _TURN).items():
            where = Where(name, theta=theta, angle="crank angle", digits=2)
            said = "least over the turn, with joints without play; below 0 they overlap"
            findings.append(at_least("GAP", gap, self.allowed.gap, "mm", where, said))
        if self.masses is not None and self.motor is not None:
            thick = p.shaft_diameter - p.shaft_flat
            made = "printed" if p.pins == "printed" else "steel"
            findings.append(shaft_stress(t, self.masses, self.motor.speed_rpm, made, thick))
        if self.consumption is not None:
            findings += self.consumption.findings(t, self.allowed.excess)
        values = self._values(t)
        for wish in self._wishes():
            value = values[wish.name]
            least = "at least " if wish.at_least else ""
            said = f"{value:.6g} {wish.unit}; {least}{wish.wanted:g} wanted"
            off = abs(wish.miss(value)) * wish.tolerance
            code = wish.name.upper()
            where = Where("wanted")
            findings.append(at_most(code, off, wish.tolerance, wish.unit, where, said))
        return findings

    @cached_property
    def _hubs(self) -> Mapping[str, Sequence[tuple[complex, float]]]:
        """Those of each link, in its own axes: centre and radius, mm; the bell crank's eye last."""
        return {link: self.linkage.construction.sketched.round_hubs(link) for link in _MOVING}

    def _gaps(self, t: TakeUp, theta: Floats) -> Mapping[str, tuple[float, float]]:
        """Least gap of pin B and of each guide to what could meet it, mm, and its crank angle, rad."""
        p = self.making
        run = t.run(theta)
        # the bell crank's eye moves in a search, the other hubs do not
        (a, b, (_, rim)) = self._hubs["coupler"]
        links = {**self._hubs, "coupler": (a, b, (t.eye, rim))}

        def air(link: str, places: Points | complex) -> Floats:
            pose = run.pose(link)
            seen = (places - pose.place) * np.exp(-1j * pose.angle)
            return clearance(links[link], np.asarray(seen, complex))

        pin = run.point("coupler", "B")[0]
        gaps = {"pin B and the crank": air("crank", pin) - p.pin_diameter / 2}
        eye = run.point("coupler", "D")[0]
        heads = p.finger_diameter / 2 + 2 * self._sizes.head  # they pass each other
        for name, guide in zip("MN", t.guides, strict=True):
            beside = {f"the link {link}": air(link, guide) for link in links}
            beside["the post of the eye"] = np.abs(eye - guide) - heads
            nearest = min(beside, key=lambda body: float(np.min(beside[body])))
            gaps[f"guide {name} and {nearest}"] = beside[nearest] - p.guide_diameter / 2
        return {
            name: (float(np.min(gap)), float(theta[np.argmin(gap)])) for name, gap in gaps.items()
        }

    def figures(self) -> Study:
        """Near stop, feed diagram, turning, forces, wear and balancing, for both readings of the lengths."""
        rpm = None if self.motor is None else self.motor.speed_rpm
        return study(self.take_up, rpm, self.masses, self.consumption)

    def study(self) -> Study:
        """Its own figures, and those of a linkage, at the motor's speed; without one the linkage's paths alone."""
        if self.motor is not None:
            return super().study()
        return replace(self.figures(), sketches=self.linkage.study().sketches)

    # ---- synthesis ---------------------------------------------------------------------------------------------------

    def _wishes(self) -> list[Wish]:
        if (wanted := self.wanted) is None:
            return []
        asked = (
            ("feed_range", wanted.feed_range, "mm", False),
            ("let_down_ratio", wanted.let_down_ratio, "to 1", False),
            ("dwell_deg", wanted.dwell_deg, "deg", True),
        )
        return [
            Wish(name, value, wanted.tolerance * value, unit, least)
            for name, value, unit, least in asked
            if value
        ]

    def _values(self, t: TakeUp) -> Mapping[str, float]:
        """What wishes are about; the dwell only where it is wished for."""
        if (wanted := self.wanted) is None:
            return {}
        dwell = (
            {}
            if wanted.dwell_deg is None
            else {"dwell_deg": math.degrees(t.lingers(wanted.dwell_radius))}
        )
        return {"feed_range": t.diagram.range, "let_down_ratio": t.diagram.ratio, **dwell}

    def designed(self) -> Self:
        """The spec with eye, frame angle and guides moved as little as fulfils [wanted]; the four lengths stay.

        SpecError where nothing is wanted; DesignError, with the nearest value reached, where the search finds none.
        """
        wishes = self._wishes()
        if not wishes:
            raise SpecError(
                [
                    Fault(
                        ("wanted",),
                        "",
                        "missing: at least one of feed_range, let_down_ratio, dwell_deg",
                    )
                ]
            )
        g = self.geometry
        width, height = self.print.bed
        theta = _TURN[::4]
        base = self.take_up
        p = self.making
        # the plate's hubs, with a screw beyond each
        rim = p.guide_diameter / 2 + 2 * p.wall + p.mount_diameter
        bearing = self.linkage.construction.sketched.hub("C", GROUND)

        def take_up(x: Floats) -> TakeUp:
            return TakeUp(
                base.crank,
                base.coupler,
                base.output,
                base.frame,
                x[0],
                math.radians(x[1]),
                base.branch,
                (complex(x[3], x[4]), complex(x[5], x[6])),
                math.radians(x[2]),
                base.sense,
            )

        def measure(x: Floats) -> tuple[Mapping[str, float], Sequence[float]]:
            t = take_up(x)
            gaps = [gap for gap, _ in self._gaps(t, theta).values()]
            hubs = ((t.pivot, bearing), *((guide, rim) for guide in t.guides))
            corners = np.array(
                [centre + side * r for centre, r in hubs for side in (1 + 1j, -1 - 1j)]
            )
            spare = (width - float(np.ptp(corners.real)), height - float(np.ptp(corners.imag)))
            # 0.1 mm beyond the limit, since a search looks at fewer angles than the check
            short = [min(0.0, gap - self.allowed.gap - 0.1) / 0.1 for gap in gaps] + [
                min(0.0, s) for s in spare
            ]
            return self._values(t), short

        def near(
            start: float, half: float, unit: float, low: float = -math.inf, high: float = math.inf
        ) -> Variable:
            return Variable(start, max(low, start - half), min(high, start + half), unit)

        (mx, my), (nx, ny) = g.guides
        variables = [
            near(g.eye_distance, 0.6 * g.eye_distance, 5.0),
            near(g.eye_angle_deg, 60, 10, -179, 179),
            near(g.frame_angle_deg, 60, 10, -360, 360),
            near(mx, 60, 15),
            near(my, 60, 15),
            near(nx, 90, 30),
            near(ny, 90, 30),
        ]
        x = [round(float(v), 4) for v in search(measure, variables, wishes)]
        data = self.model_dump(by_alias=True, exclude_none=True)
        data["geometry"] |= {
            "eye_distance": x[0],
            "eye_angle_deg": x[1],
            "frame_angle_deg": x[2],
            "guides": [[x[3], x[4]], [x[5], x[6]]],
        }
        result = validate(type(self), data, "design")
        refuse_failing(result)
        return result
