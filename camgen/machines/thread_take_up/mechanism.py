"""The two-crank four-bar thread take-up of a sewing machine: its coupler carries a thread eye on a path that crosses itself.

          M                    O fixed pivot (origin) of the input crank O-A, C that of the output crank C-B;
                               A-B-D the bell crank with the eye D, M and N the guides; the thread runs M-D-N.
     A --- O-C                 Stacked from the frame up: frame, output crank, input crank, bell crank, thread. A layer
     |   .                     is one thickness and one play high, so that flat faces run on each other.
     B------- D
                               The output crank turns on a disc ("pivot") about C, since the input shaft, 9 mm away,
  N                            must pass through its bearing: so all is carried by one frame and open to the front.
                               Pins, finger and guides have heads: nothing lifts off, and the thread, laid round finger
                               and guides, does not slip off them. The frame is screwed on from behind.

The output is the feed L = |M - D| + |D - N|, mm.   [Semin, Korneenko, Kirillov, Mikheeva; see `feed`]
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Self

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding, Where, at_least, at_most
from camgen.machine.closed_form import four_bar, refuse_gap, transmission_extremes
from camgen.machine.features import Demand
from camgen.machine.model import Floats, Machine, Points
from camgen.machines.loads.counterweights import Counterweight, found_moment
from camgen.machines.mechanism import Mechanism, refuse_failing
from camgen.machines.thread_take_up.bodies import HEAD, LINKS, Bodies, features_of
from camgen.machines.thread_take_up.feed import TakeUp
from camgen.machines.thread_take_up.study import (
    Consumption,
    Masses,
    force_numbers,
    shaft_stress,
    study,
)
from camgen.machines.thread_take_up.tables import (
    TakeUpGeometry,
    TakeUpLimits,
    TakeUpMotor,
    TakeUpParts,
    Wanted,
)
from camgen.motion.synthesis import Variable, Wish, search
from camgen.parts.assembly import Assembly, Frame, Shaft
from camgen.parts.catalogue import Bought, screw_for, turning_text
from camgen.parts.part import clearance
from camgen.spec import validate
from camgen.study import Sketch, Study
from camgen.tolerances import SAME_POINT

_TURN = np.linspace(
    0, math.tau, 1440, endpoint=False
)  # where gaps are looked for; parts move < 0.2 mm between two


class ThreadTakeUp(Mechanism):
    """Spec and answers of a two-crank four-bar thread take-up; the output is the feed, mm."""

    geometry: TakeUpGeometry
    motor: TakeUpMotor | None = Field(default=None, description="what turns the input crank")
    masses: Masses | None = Field(default=None, description="for forces; left out: none")
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
        p, nozzle, found = self.making, self.print.nozzle, []
        weight, collar, below = self.counterweight, "the collar", p.thickness
        if weight is not None:
            found += weight.faults()
            collar, below = "the counterweight", weight.thickness or p.thickness
            if self.motor is None and weight.given is None:
                found.append(
                    Fault(
                        ("motor", "speed_rpm"),
                        "",
                        "missing: a number > 0, since a counterweight asks for the forces",
                    )
                )
        room = p.shaft_length - below - self.print.slide_clearance
        above, thin_groove = 2 * HEAD + self.allowed.gap, f"at least the nozzle, {nozzle:g} mm"
        thin = {("limits", "min_wall"): self.allowed.min_wall}
        thin |= {("parts", key): getattr(p, key) for key in ("wall", "thickness", "thread_height")}
        checks = (
            *(
                (value >= nozzle, path, value, f"at least the nozzle, {nozzle:g} mm")
                for path, value in thin.items()
            ),
            (
                0.05 * p.shaft_diameter <= p.shaft_flat < 0.5 * p.shaft_diameter,
                ("parts", "shaft_flat"),
                p.shaft_flat,
                "between a twentieth and half of shaft_diameter, so that it turns the crank",
            ),
            (
                p.groove == 0 or p.groove >= nozzle,
                ("parts", "groove"),
                p.groove,
                f"{thin_groove}, or 0: none",
            ),
            (
                not p.groove or p.thread_height >= p.groove + above,
                ("parts", "thread_height"),
                p.thread_height,
                f"at least {p.groove + above:g} mm: groove, shoulder, and the heads under it with limits.gap",
            ),
            (
                room > 0,
                ("parts", "shaft_length"),
                p.shaft_length,
                f"more than {p.shaft_length - room:g} mm: {collar} below the frame, and its play",
            ),
        )
        found += [
            Fault(path, f"{value:g}", expected)
            for fine, path, value, expected in checks
            if not fine
        ]
        if self.masses is not None and self.motor is None:
            found.append(
                Fault(
                    ("motor", "speed_rpm"),
                    "",
                    "missing: a number > 0, since [masses] ask for the forces",
                )
            )
        if self.consumption is not None:
            found += self.consumption.faults()
        return found

    # ---- motion ------------------------------------------------------------------------------------------------------

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
        weight = found_moment(self.bodies.weight.moment) if self.bodies.weight else {}
        return {
            **super()._found(),
            **(self.masses.centres(self.take_up) if self.masses else {}),
            **weight,
        }

    def _unloaded(self) -> Machine:
        """Input crank, bell crank (coupler) and output crank; outputs "feed", mm, and the path "eye"."""
        t, play, press = self.take_up, self.print.slide_clearance, self.print.press_clearance
        made = t.loaded(self.masses.bodies(t) if self.masses else t.links, self._speed)
        pins = [
            replace(pin, clearance=play + (0 if pin.name == "C" else press)) for pin in made.joints
        ]  # C has no pin
        return replace(made, joints=tuple(pins))

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Feed (mm) or its derivative to theta, (n,)."""
        return self.take_up.feed(theta, order)

    # ---- parts -------------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> Bodies:
        """What its parts are."""
        return Bodies(self)

    @cached_property
    def assembly(self) -> Assembly:
        """Five flat parts, and the round ones: shaft with its collar or counterweight, pins, dowels, finger and guides.

        Every part is on its layer: frame 0, output crank and pivot 1, input crank 2, bell crank 3, thread above.
        """
        t, bodies = self.take_up, self.bodies
        fixings = tuple(
            (z, self.making.mount_diameter) for z in bodies.mount_holes(t.pivot, t.guides)
        )
        made = self._assembly(bodies.parts, bodies.mounts, features_of(self))
        return replace(
            made,
            demands=(Demand("feed", self.motion, stroke=True, lash=self.allowed.lash),),
            balances=(bodies.weight.balance(made.solids),) if bodies.weight else (),
            strands=(bodies.strand,),
            bought=self._bought(),
            frame=Frame("frame", fixings),
            shaft=Shaft("shaft", self.making.shaft_diameter, self.making.shaft_flat),
        )

    def _bought(self) -> Sequence[Bought]:
        """Motor, and screws for mounting."""
        p = self.making
        screw = f"{screw_for(p.mount_diameter)}, at most {p.thickness:g} into the frame"
        drive = "" if self.motor is None else f"{turning_text(self.motor.speed_rpm)}, "
        if self.masses is not None and self.motor is not None:
            figures = force_numbers(self.take_up, self.masses.bodies(self.take_up), self._speed)
            drive += f"{figures['peak_torque_n_m']:.3g} N m at its peak, "
        return (
            Bought(
                "drive",
                "",
                f"{drive}for a shaft of {p.shaft_diameter:g} with a flat {p.shaft_flat:g} deep",
                1,
                "drive",
            ),
            Bought("screw of the frame, from behind", "", screw, 3, "mount"),
        )

    # ---- assembly ----------------------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Fold, transmission angle, gaps between what moves and what stands, excess thread, and the wishes."""
        g, t = self.geometry, self.take_up
        margin = four_bar(g.frame, g.input_crank, g.coupler, g.output_crank).margin
        play = 2 * self.print.slide_clearance
        least, most = np.degrees(
            transmission_extremes(g.frame, g.input_crank, g.coupler, g.output_crank)
        )
        fold = math.radians((0 if least < 180 - most else 180) + g.frame_angle_deg)
        findings = [
            at_least(
                "FOLD_MARGIN",
                margin,
                play,
                "mm",
                Where("lengths"),
                "Grashof margin of the lengths; within the play of the four joints (half of it each) the chain could fold and "
                "go on the wrong way",
            ),
            at_least(
                "TRANSMISSION_ANGLE",
                min(least, 180 - most),
                self.allowed.transmission_angle_deg,
                "deg",
                Where(theta=fold, angle="crank angle", digits=None),
                f"between coupler and output crank, {least:.4f} to {most:.4f} deg over the turn",
            ),
        ]
        for name, (gap, theta) in self._gaps(t, _TURN).items():
            where = Where(name, theta=theta, angle="crank angle", digits=2)
            remark = "least over the turn, by joints without play; under 0 they overlap"
            findings.append(at_least("GAP", gap, self.allowed.gap, "mm", where, remark))
        p, weight = self.making, self.bodies.weight_radius
        if weight:
            nearest = (
                min(map(abs, self.bodies.mount_holes(t.pivot, t.guides)))
                - p.mount_diameter
                - weight
            )
            remark = 'beside a head twice as wide as its hole; counterweight.made = "steel" or more thickness makes it smaller'
            findings.append(
                at_least(
                    "GAP",
                    nearest,
                    self.allowed.gap,
                    "mm",
                    Where("counterweight and the frame's screws"),
                    remark,
                )
            )
        if self.masses is not None and self.motor is not None:
            findings.append(
                shaft_stress(
                    t, self.masses, self.motor.speed_rpm, p.pins, p.shaft_diameter - p.shaft_flat
                )
            )
        if self.consumption is not None:
            findings += self.consumption.findings(t, self.allowed.excess)
        figures = self._figures(t)
        for wish in self._wishes():
            value = figures[wish.name]
            remark = f"{value:.6g} {wish.unit}; {'at least ' if wish.at_least else ''}{wish.wanted:g} wanted"
            off = abs(wish.miss(value)) * wish.tolerance
            findings.append(
                at_most(wish.name.upper(), off, wish.tolerance, wish.unit, Where("wanted"), remark)
            )
        return findings

    def _gaps(self, t: TakeUp, theta: Floats) -> Mapping[str, tuple[float, float]]:
        """Least gap of pin B and of each guide to what could meet it, mm, and its crank angle, rad."""
        p, run = self.making, t.run(theta)
        links = {
            name: self.bodies.bands[name][0]
            for name in ("input-crank", "output-crank", "bell-crank")
        }
        # the bell crank's eye moves in a search, the other hubs do not
        links["bell-crank"] = (*links["bell-crank"][:2], (t.eye, links["bell-crank"][2][1]))

        def air(link: str, places: Points | complex) -> Floats:
            pose = run.pose(LINKS[link])
            return clearance(
                links[link], np.asarray((places - pose.place) * np.exp(-1j * pose.angle), complex)
            )

        gaps = {
            "pin B and the input crank": air("input-crank", run.point("coupler", "B")[0])
            - p.pin_diameter / 2
        }
        eye = run.point("coupler", "D")[0]
        for name, guide in zip("MN", t.guides, strict=True):
            beside = {link.replace("-", " "): air(link, guide) for link in links}
            beside["finger"] = (
                np.abs(eye - guide) - p.finger_diameter / 2 - 2 * HEAD
            )  # head beside head
            nearest = min(beside, key=lambda body: float(np.min(beside[body])))
            gaps[f"guide {name} and the {nearest}"] = beside[nearest] - p.guide_diameter / 2
        return {
            name: (float(np.min(gap)), float(theta[np.argmin(gap)])) for name, gap in gaps.items()
        }

    def study(self) -> Study:
        """Eye path, near stop, feed diagram, turning, forces, wear and balancing, for both readings of the lengths."""
        rpm = None if self.motor is None else self.motor.speed_rpm
        found = study(self.take_up, rpm, self.masses, self.consumption)
        path = self.take_up.path(np.linspace(0, math.tau, 721))
        drawn = Sketch("eye path", (path,)), Sketch("thread", course=self.take_up.thread)
        return Study(found.numbers, found.plots, found.tables, drawn, found.notes)

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

    def _figures(self, t: TakeUp) -> Mapping[str, float]:
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
        g, (width, height) = self.geometry, self.print.bed
        theta, rim = _TURN[::4], self.making.guide_diameter / 2 + self.making.wall
        mount = self.making.mount_diameter / 2 + self.making.wall
        base = self.take_up

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
            mounts = ((z, mount) for z in self.bodies.mount_holes(t.pivot, t.guides))
            hubs = ((t.pivot, self.bodies.bearing), *((guide, rim) for guide in t.guides), *mounts)
            corners = np.array(
                [centre + side * r for centre, r in hubs for side in (1 + 1j, -1 - 1j)]
            )
            spare = (width - float(np.ptp(corners.real)), height - float(np.ptp(corners.imag)))
            # 0.1 mm beyond the limit, since a search looks at fewer angles than the check
            short = [min(0.0, gap - self.allowed.gap - 0.1) / 0.1 for gap in gaps] + [
                min(0.0, s) for s in spare
            ]
            return self._figures(t), short

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
