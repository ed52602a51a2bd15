"""What a report shows of a thread take-up: its numbers, curves and tables; the source's lengths in both their readings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault
from camgen.findings import Finding, Where, at_least, at_most
from camgen.machine.balancing import balanced, crank_weight
from camgen.machine.closed_form import four_bar, transmission_extremes
from camgen.machine.forces import Forces
from camgen.machine.landmarks import TURN
from camgen.machine.model import Body, Floats, Points
from camgen.machine.strength import SHEAR, shaft_twist
from camgen.machines.thread_take_up.feed import TakeUp
from camgen.machines.thread_take_up.rocker import ANGLES, against
from camgen.parts import materials
from camgen.spec import Coordinate, Distance, Length, Mass, Record, quantity
from camgen.study import Figure, Figures, Later, Plot, Study, Table, figures_in

# The lengths of the source: OA, OC, and AB with BC as it prints them.
_PUBLISHED = (30.0, 9.0)
_PRINTED = (30.0, 19.0)
_EYE = (52.0, math.radians(90))  # its BD, and the angle with BA
_FORCES = np.linspace(
    0, TURN, 7200, endpoint=False
)  # angles at which forces are taken; peaks are flat to 1e-4 N between two
_DRAWN = np.linspace(0, TURN, 721)
_DEGREES = np.degrees(_DRAWN)
_STOPS = (0.25, 1.0)  # mm, circles round the near stop
_ALPHA = "crank angle, deg"
_NOTES = (
    "Source: Semin, Korneenko, Kirillov, Mikheeva, Two-crank four-bar thread take-up of a sewing machine (in Russian).",
    "Feed: straight thread between the centres of guides and finger; the wrap round their radii is left out.",
    "Wear measure: mean over the turn of |reaction| times |relative angular speed| in the joint, N rad/s (load times "
    "sliding distance, to be multiplied by the pin's radius).",
)
# Said of the source's own lengths alone.
_ERRATA = (
    "The source's formula (1) has lost the squares of the lengths under the arccosine and has l0 l1 where l0 l1 and l2 "
    "belong in the denominator; its arctangent jumps by 180 deg. Formula (2) is a reflection unless y' changes sign; the l2 "
    "in y' of (3) is spurious. 'Cranks OA and AB' means OA and BC. The forms used here close the chain and are proved by "
    "doing so.",
    "With the lengths as printed (AB = 30, BC = 19) the eye's path has no double point; with AB and BC interchanged it has "
    "one, and the near stop that the paper describes. The paper's 120 N at C fits the printed lengths. The text cannot "
    "decide: both readings stand side by side here, the printed one for the forces, the interchanged one for the motion.",
    "The source compares with a crank-rocker whose lengths it does not print. Beside one of the same feed, with the least "
    "excess that a search found, two cranks have less excess, less load at C and less wear, as it says; its 37 mm, 190 N and "
    "twice the wear cannot be decided.",
    "Not given by the source, so the spec's own choice: centres of mass, guides, frame angle, consumption of thread.",
)


class Masses(Record):
    """Moving masses; centres in the link's own axes, mm."""

    coupler_g: Mass = Field(description="mass of the bell crank")
    output_crank_g: Mass = Field(description="mass of the output crank")
    coupler_kg_m2: Annotated[float, quantity("kg m^2", gt=0, le=1e3)] = Field(
        description="moment of inertia of the bell crank about its centre of mass"
    )
    output_crank_kg_m2: Annotated[float, quantity("kg m^2", gt=0, le=1e3)] = Field(
        description="moment of inertia of the output crank about its centre of mass"
    )
    coupler_centre: tuple[Coordinate, Coordinate] | None = Field(
        default=None,
        description="centre of mass of the bell crank from A, x towards B; default: centroid of A, B, D",
    )
    output_crank_centre: Coordinate | None = Field(
        default=None,
        description="distance of the output crank's centre of mass from C, towards B; default: a third of BC",
    )
    coupler_weight_radius: Length = Field(
        default=20.0,
        description="distance from B of the counterweight that balances the bell crank",
    )
    output_crank_weight_radius: Length = Field(
        default=15.0,
        description="distance from C of the counterweight that balances the output crank",
    )

    def bodies(self, t: TakeUp, given: bool = True) -> dict[str, Body]:
        """Crank (massless: it only turns evenly), coupler and output crank; given: with the spec's centres of mass."""
        coupler = (t.coupler + t.eye) / 3
        output = t.output / 3
        if given and self.coupler_centre is not None:
            coupler = complex(*self.coupler_centre)
        if given and self.output_crank_centre is not None:
            output = self.output_crank_centre
        return {
            "crank": t.links["crank"],
            "coupler": replace(
                t.links["coupler"],
                mass=self.coupler_g / 1e3,
                centre=coupler,
                inertia=self.coupler_kg_m2,
            ),
            "output": replace(
                t.links["output"],
                mass=self.output_crank_g / 1e3,
                centre=complex(output),
                inertia=self.output_crank_kg_m2,
            ),
        }

    def of_linkage(self, t: TakeUp) -> dict[str, Any]:
        """[masses] of the linkage; the crank's come from its solid."""
        bodies = self.bodies(t)
        return {
            name: {
                "mass_g": 1e3 * body.mass,
                "centre": (body.centre.real, body.centre.imag),
                "inertia_kg_m2": body.inertia,
            }
            for name, body in bodies.items()
            if name != "crank"
        }

    def centres(self, t: TakeUp) -> dict[str, object]:
        """Both centres of mass, by their keys in a spec."""
        bodies = self.bodies(t)
        coupler = bodies["coupler"].centre
        output = bodies["output"].centre
        return {
            "masses.coupler_centre": (coupler.real, coupler.imag),
            "masses.output_crank_centre": output.real,
        }

    def balanced(self, t: TakeUp) -> dict[str, Body]:
        """The bodies with counterweights: the coupler's centre at B, then the output crank's, with the coupler's mass, at C."""
        bodies = self.bodies(t)
        coupler = balanced(bodies["coupler"], t.coupler, self.coupler_weight_radius)
        output = balanced(
            bodies["output"], 0, self.output_crank_weight_radius, coupler.mass, t.output
        )
        return bodies | {"coupler": coupler, "output": output}


class Consumption(Record):
    """Thread that needle and hook have drawn since the feed was greatest, by crank angle, linear in between."""

    angles_deg: Annotated[
        tuple[Annotated[float, quantity("deg", ge=0, lt=360)], ...], Field(min_length=2)
    ] = Field(description="angles of the input crank")
    length_mm: Annotated[tuple[Distance, ...], Field(min_length=2)] = Field(
        description="thread drawn at these angles since the feed was greatest"
    )

    def faults(self) -> list[Fault]:
        """What is wrong between the two lists."""
        faults = []
        if any(b <= a for a, b in zip(self.angles_deg, self.angles_deg[1:], strict=False)):
            faults.append(
                Fault(("consumption", "angles_deg"), "", "angles that grow from one to the next")
            )
        if len(self.angles_deg) != len(self.length_mm):
            count = f"{len(self.length_mm)} lengths"
            faults.append(
                Fault(
                    ("consumption", "length_mm"),
                    count,
                    f"as many as angles_deg, {len(self.angles_deg)}",
                )
            )
        return faults

    def at(self, theta: Floats) -> Floats:
        """Length at theta, (n,) mm."""
        return np.asarray(
            np.interp(np.degrees(theta), self.angles_deg, self.length_mm, period=360.0)
        )

    def extremes(self, t: TakeUp) -> tuple[tuple[float, float], tuple[float, float]]:
        """Least and greatest of supply less consumption, mm, each with its angle, rad: tried every 0.05 deg and at the knots."""
        theta = np.concatenate([_FORCES, np.radians(self.angles_deg), t.diagram.turns])
        excess = t.supply(theta) - self.at(theta)
        low = int(np.argmin(excess))
        high = int(np.argmax(excess))
        return (float(excess[low]), float(theta[low])), (float(excess[high]), float(theta[high]))

    def findings(self, t: TakeUp, limit: float) -> list[Finding]:
        """Thread to spare: nowhere too much, and nowhere less than is drawn."""
        (least, at_), (most, at) = self.extremes(t)
        places = [Where(theta=angle, angle="crank angle", digits=2) for angle in (at, at_)]
        return [
            at_most(
                "THREAD_EXCESS",
                most,
                limit,
                "mm",
                places[0],
                "supply less consumption at its greatest",
            ),
            at_least(
                "THREAD_SHORT",
                round(least, 9) + 0.0,
                0,
                "mm",
                places[1],
                "supply less consumption at its least",
            ),
        ]


def reading(t: TakeUp) -> str:
    """Name of a pair of lengths: the source's two readings, or the lengths themselves."""
    lengths = f"AB = {t.coupler:g}, BC = {t.output:g}"
    if _of_source(t):
        return f"{'as printed' if (t.coupler, t.output) == _PRINTED else 'interchanged'}: {lengths}"
    return lengths


def _of_source(t: TakeUp) -> bool:
    """Whether the lengths are the source's, in one of their two readings."""
    own = (t.crank, t.frame, t.eye_distance, t.eye_angle) == (*_PUBLISHED, *_EYE)
    return own and (t.coupler, t.output) in (_PRINTED, _PRINTED[::-1])


def _readings(t: TakeUp) -> tuple[TakeUp, ...]:
    """The take-up; of the source's lengths also their other reading."""
    return (t, t.interchanged()) if _of_source(t) else (t,)


def study(
    t: TakeUp, rpm: float | None, masses: Masses | None, consumption: Consumption | None
) -> Study:
    """Figures, curves and tables; forces only with masses, and then with a speed."""
    readings = [motion_numbers(each) for each in _readings(t)]
    numbers = readings[0]
    notes = [*_NOTES, *(_ERRATA if _of_source(t) else ())]
    beside = list[Table]()
    if masses is not None and rpm is not None:
        speed = rpm * TURN / 60
        readings = [
            found | force_numbers(each, masses.bodies(each), speed)
            for found, each in zip(readings, _readings(t), strict=True)
        ]
        numbers = readings[0] | balance_numbers(t, masses, speed)
        notes.append(
            f"Forces at {rpm:g} rpm without gravity, friction, thread and the input crank's own mass, as in the source; the "
            "masses are those of the spec, not of the parts made here."
        )
        if _of_source(t):
            drawn = None if consumption is None else consumption.at(ANGLES)
            for each in _readings(t)[::-1]:  # of the spec's own the readings count
                found, table = against(
                    each, masses.bodies(each), rpm * TURN / 60, drawn if each == t else None
                )
                beside.append(replace(table, title=f"{table.title}; {reading(each)}"))
            numbers |= found
    if consumption is not None:
        low, high = consumption.extremes(t)
        numbers |= [*_place("thread excess max", *high), *_place("thread excess min", *low)]

    def plots() -> list[Plot]:
        found = [*_motion_plots(t), _by_frame(t)]
        found += [] if masses is None or rpm is None else [_force_plot(t, masses, rpm * TURN / 60)]
        return found if consumption is None else [*found, _thread_plot(t, consumption)]

    def tables() -> list[Table]:
        found = [_both(t, readings)] if _of_source(t) else []
        found += [_turns(t), _influence(t)]
        if masses is not None and rpm is not None:
            found += [_centres(t, masses, rpm * TURN / 60), _balancing(t, masses, rpm * TURN / 60)]
        return [*found, *beside]

    return Study(numbers, Later(plots), Later(tables), (), notes)


def _both(t: TakeUp, readings: Sequence[Mapping[str, float]]) -> Table:
    """Figures of each reading of the source's lengths."""
    keys = dict.fromkeys(key for found in readings for key in found)
    rows = [[key, *(found.get(key, "") for found in readings)] for key in keys]
    return Table("Both readings of the lengths", ("figure", *map(reading, _readings(t))), rows)


def _thread_plot(t: TakeUp, consumption: Consumption) -> Plot:
    supply = t.supply(_DRAWN)
    drawn = consumption.at(_DRAWN)
    curves = [
        ("supply", _DEGREES, supply),
        ("consumption", _DEGREES, drawn),
        ("excess", _DEGREES, supply - drawn),
    ]
    return Plot("Supply and consumption of thread", _ALPHA, "mm", curves)


def _place(quantity: str, value: float, angle: float, unit: str = "mm") -> list[Figure]:
    """A figure, and at which angle, rad, it is so."""
    at = Figure(f"{quantity} at", math.degrees(angle), "deg")
    return [Figure(quantity, value, unit), at]


def motion_numbers(t: TakeUp) -> Figures:
    """Figures of feed, eye path and turning; those of a loop only where there is one."""
    lengths = (t.frame, t.crank, t.coupler, t.output)
    feed = t.diagram
    stop = t.near_stop
    least, most = transmission_extremes(*lengths)
    cusp = min(
        t.cusps(), key=lambda each: abs(each[0] - t.eye_distance), default=(math.nan, math.nan)
    )
    loop = stop.crossings > 0

    found = [
        Figure("grashof margin", four_bar(*lengths).margin, "mm"),
        Figure("transmission angle min", math.degrees(least), "deg"),
        Figure("transmission angle max", math.degrees(most), "deg"),
        *_place("feed max", *feed.longest),
        *_place("feed min", *feed.shortest),
        Figure("feed range", feed.range, "mm"),
        Figure("let down", math.degrees(feed.let_down), "deg"),
        Figure("let down ratio", feed.ratio),
        Figure("eye path crossings", stop.crossings),
        *figures_in("mm", near_stop_x=stop.centre.real, near_stop_y=stop.centre.imag),
        Figure("near stop from", math.degrees(stop.enters), "deg"),
        Figure("near stop to", math.degrees(stop.leaves), "deg"),
        Figure("loop width", stop.width if loop else math.nan, "mm"),
        Figure("loop height", stop.height if loop else math.nan, "mm"),
    ]
    for radius in _STOPS:
        within = f"{radius:g}".replace(".", "_")
        found.append(Figure(f"dwell within {within} mm", math.degrees(t.lingers(radius)), "deg"))
    found.append(Figure("cusp eye distance", cusp[0], "mm"))
    found.append(Figure("cusp at", math.degrees(cusp[1]), "deg"))
    for link, output in (("coupler", False), ("output", True)):
        slow, fast = t.rate_extremes(output)
        found += [*_place(f"{link} rate min", *slow, ""), *_place(f"{link} rate max", *fast, "")]
    return Figures(each for each in found if not math.isnan(each.value))


def force_numbers(t: TakeUp, bodies: Mapping[str, Body], speed: float) -> Figures:
    """Peak reactions, torque and wear measures at an input speed, rad/s."""
    forces = t.forces(_FORCES, bodies, speed)
    wear = t.wear(_FORCES, forces, speed)
    return Figures(
        [
            *(Figure("reaction {joint}", v, "N", joint=name) for name, v in _peaks(forces).items()),
            Figure("peak torque", _peak(forces.drives["motor"]), "N m"),
            *(Figure("wear {joint}", v, "N rad/s", joint=name) for name, v in wear.items()),
            Figure("wear mean", float(np.mean(list(wear.values()))), "N rad/s"),
        ]
    )


def shaft_stress(t: TakeUp, masses: Masses, rpm: float, made: str, shaft: float) -> Finding:
    """SHAFT_STRESS of a round shaft as thick as the input shaft is over its flat, mm, twisted by the peak torque."""
    torque = 1000 * force_numbers(t, masses.bodies(t), rpm * math.tau / 60)["peak_torque_n_m"]
    bears = SHEAR * (materials.STEEL if made == "steel" else materials.MATERIALS["PLA"]).bears
    remark = f"twisted by {torque:.4g} N mm; a {made} shaft {shaft:g} mm thick bears {bears:.4g} MPa in shear"
    return at_most(
        "SHAFT_STRESS", shaft_twist(torque, shaft), bears, "MPa", Where("input shaft"), remark
    )


_LENGTHS = {"frame": "OC", "crank": "OA", "coupler": "AB", "output": "BC", "eye_distance": "BD"}
_LONGER = 1.0  # mm


def _unevenness(t: TakeUp) -> float:
    """Greatest less least rate of the output crank; nan where it does not turn fully."""
    try:
        (low, _), (high, _) = t.rate_extremes(True)
    except DesignError:
        return math.nan
    return high - low


def _influence(t: TakeUp) -> Table:
    """What each length does, 1 mm longer, to how unevenly the output crank turns, to the feed and to the eye's stop."""

    def figures(each: TakeUp) -> list[float]:
        try:
            return [
                _unevenness(each),
                each.diagram.range,
                each.diagram.ratio,
                math.degrees(each.lingers(1.0)),
            ]
        except DesignError:
            return [math.nan] * 4

    here = figures(t)
    rows: list[Sequence[object]] = [["as it is", *here]]
    for key, name in _LENGTHS.items():
        length = getattr(t, key) + _LONGER
        found = figures(replace(t, **{key: length}))
        rows.append(
            [
                f"{name} = {length:g}",
                *(value - before for value, before in zip(found, here, strict=True)),
            ]
        )
    columns = (
        "length, mm",
        "spread of BC's rate",
        "feed range, mm",
        "let-down ratio",
        "within 1 mm of the stop, deg",
    )
    return Table(f"Influence of each length: what {_LONGER:g} mm more changes", columns, rows)


def _by_frame(t: TakeUp) -> Plot:
    """Spread of the output crank's rate over the frame's length: the source's remark that it matters most."""
    most = min(t.crank, t.coupler, t.output)
    frame = np.linspace(0.05, 0.95, 19) * most
    spread = np.array([_unevenness(replace(t, frame=float(length))) for length in frame])
    label = "rate of BC, greatest less least, per crank"
    return Plot(
        "Unevenness against the frame's length",
        "OC, mm",
        label,
        [("spread", frame, spread)],
        [("this spec", t.frame)],
    )


def _peak(values: Floats | Points) -> float:
    return float(np.nanmax(np.abs(values)))


def _peaks(forces: Forces) -> dict[str, float]:
    return {name: _peak(forces.reactions[name]) for name in "ABC"}


def _motion_plots(t: TakeUp) -> list[Plot]:
    feed = t.diagram
    paths = [(reading(each), each.path(_DRAWN)) for each in _readings(t)]
    coupler, output = t.rates(_DRAWN)
    marks = [("greatest", math.degrees(feed.longest[1])), ("least", math.degrees(feed.shortest[1]))]
    return [
        Plot(
            "Eye path",
            "x, mm",
            "y, mm",
            [(name, path.real, path.imag) for name, path in paths],
            equal=True,
        ),
        Plot(
            "Feed",
            _ALPHA,
            "mm",
            [(reading(each), _DEGREES, each.feed(_DRAWN)) for each in _readings(t)],
            marks,
        ),
        Plot(
            "Rates of turning",
            _ALPHA,
            "per crank",
            [("coupler", _DEGREES, coupler), ("output crank", _DEGREES, output)],
        ),
    ]


def _force_plot(t: TakeUp, masses: Masses, speed: float) -> Plot:
    forces = t.forces(_DRAWN, masses.bodies(t), speed)
    return Plot(
        "Reactions",
        _ALPHA,
        "N",
        [(f"joint {name}", _DEGREES, np.abs(forces.reactions[name])) for name in "ABC"],
    )


def _turns(t: TakeUp) -> Table:
    """Where the feed turns back, in the order of the turn."""
    rows = [
        [math.degrees(a), float(length)]
        for a, length in zip(t.diagram.turns, t.diagram.lengths, strict=True)
    ]
    return Table("Extremes of the feed", (_ALPHA, "feed, mm"), rows)


def _centres(t: TakeUp, masses: Masses, speed: float) -> Table:
    """Peak reactions for each reading of the lengths and both guesses at the centres of mass."""
    rows: list[Sequence[object]] = []
    for each in _readings(t):
        for label, given in (("given", True), ("centroid of A, B, D; a third of BC", False)):
            bodies = masses.bodies(each, given)
            rows.append(
                [reading(each), label, *_peaks(each.forces(_FORCES, bodies, speed)).values()]
            )
    return Table("Peak reactions, N", ("lengths", "centres of mass", "A", "B", "C"), rows)


def balance_numbers(t: TakeUp, masses: Masses, speed: float) -> Figures:
    """Balancing as in the source, recomputed with the counterweights on; and the best weight on the input crank alone."""
    bodies = masses.bodies(t)
    weighted = masses.balanced(t)
    before = t.forces(_FORCES, bodies, speed)
    after = t.forces(_FORCES, weighted, speed)
    moment, left = crank_weight(before.reactions["O"], _FORCES, speed)
    coupler = 1e3 * (weighted["coupler"].mass - bodies["coupler"].mass)
    output = 1e3 * (weighted["output"].mass - bodies["output"].mass)
    return Figures(
        [
            Figure("counterweight {of}", coupler, "g", "coupler"),
            Figure("counterweight {of}", output, "g", "output crank"),
            Figure("shaking force", _peak(before.shaking), "N"),
            Figure("balanced shaking force", _peak(after.shaking), "N"),
            *(
                Figure("balanced reaction {joint}", value, "N", joint=name)
                for name, value in _peaks(after).items()
            ),
            Figure("balanced peak torque", _peak(after.drives["motor"]), "N m"),
            Figure("crank counterweight", 1e3 * abs(moment), "g mm"),
            Figure("crank counterweight at", math.degrees(float(np.angle(moment))), "deg"),
            Figure("reaction {joint}", _peak(before.reactions["O"]), "N", joint="O"),
            Figure("reaction {joint} with crank weight", left, "N", joint="O"),
        ]
    )


def _balancing(t: TakeUp, masses: Masses, speed: float) -> Table:
    """What balancing does to forces and torque, before and after."""
    before, after = (
        force_numbers(t, bodies, speed) for bodies in (masses.bodies(t), masses.balanced(t))
    )
    found = balance_numbers(t, masses, speed)
    rows: list[Sequence[object]] = [[name, value, after[name]] for name, value in before.items()]
    rows.append(["shaking_force_n", found["shaking_force_n"], found["balanced_shaking_force_n"]])
    rows += [
        [name, 0.0, found[name]]
        for name in ("counterweight_coupler_g", "counterweight_output_crank_g")
    ]
    return Table(
        "Balancing of coupler and output crank as in the source", ("", "before", "after"), rows
    )
