"""[counterweight]: a body on an evenly turning crank's shaft that gives the whole crank a wanted first moment.

    wanted    moment of all that turns with the crank, about its shaft: g mm and where, in the crank's own axes. Unless the spec
              says it, what least loads the crank's bearing, or least shakes the ground; less what `other_g_mm` says sits on
              the shaft
    sector's  wanted less what the crank's own parts have; so pins, hubs and holes count

Against the bearing or the frame: seen from the crank a counterweight pulls with one constant force, so the best is the centre
of the smallest circle round all forces, as the crank sees them, and what remains is its radius.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine.balancing import crank_weight, with_weight
from camgen.machine.features import Balance
from camgen.machine.model import Body, Machine, Pin
from camgen.machine.run import solve
from camgen.machines.loads.tables import Direction
from camgen.numerics import peak
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import CUT
from camgen.parts.counterweights import NAME, Sector, counterweight
from camgen.parts.hardware import FACETS
from camgen.parts.inertia import Solids, centre_of
from camgen.parts.materials import STEEL
from camgen.parts.part import Layer, Part
from camgen.spec import Length, Print, Record, quantity
from camgen.study import Figure, Figures, Plot, Study, Table

_SHARE = 0.01  # of the wanted moment, or the counterweight's own, by which that of the written solids may be off
_G = 1e3  # g in a kg
_ARM = 10.0  # mm, at which what else sits on the shaft counts as a point: on an even crank it could be any
_TURN = np.linspace(0, math.tau, 1441)
_EVEN = 1e-9  # of its rate, by which a crank may turn unevenly
Moment = Annotated[float, quantity("g mm", ge=0, le=1e9)]


@dataclass(frozen=True)
class ShaftSeat:
    """Where a counterweight is pressed on a shaft; mm."""

    hub: float  # radius
    bore: Contour
    thickness: float  # unless the spec says it
    min_wall: float
    fits: Print
    note: str  # how it is held


class Counterweight(Record):
    """A sector of a disc on the crank's shaft; it gives all that turns with the crank the moment asked for."""

    against: Literal["bearing", "frame"] = Field(
        default="bearing",
        description='whose load it lowers most: the crank\'s "bearing", or the "frame", which carries the '
        "whole machine",
    )
    moment_g_mm: Moment | None = Field(
        default=None,
        description="moment about the shaft of all that turns with the crank; default: camgen finds it",
    )
    at_deg: Direction | None = Field(
        default=None,
        description="direction of that moment, from the crank's own x axis; goes with moment_g_mm",
    )
    other_g_mm: Moment = Field(
        default=0.0,
        description="moment of anything else on the shaft, such as a needle's crank; it is balanced too",
    )
    other_deg: Direction = Field(
        default=0.0, description="direction of that other moment, from the crank's own x axis"
    )
    made: Literal["printed", "steel"] = Field(
        default="printed", description='"printed"; or "steel": cut from plate, so smaller'
    )
    thickness: Length | None = Field(
        default=None, description="thickness of the sector; default: that of the links"
    )
    half_angle_deg: Annotated[float, quantity("deg", ge=10, le=150)] = Field(
        default=90.0, description="angle of the sector to each side of its middle"
    )
    pins: Annotated[int, Field(ge=0, le=12)] = Field(
        default=0, description="number of steel pins, pressed in along the rim of a printed one"
    )
    pin_diameter: Length = Field(default=6.0, description="diameter of those pins")

    def faults(self) -> list[Fault]:
        """What does not go together."""
        if (self.moment_g_mm is None) != (self.at_deg is None):
            right = "moment_g_mm and at_deg together: how much and where"
            return [Fault(("counterweight",), "", right)]
        return []

    @property
    def given(self) -> complex | None:
        """The moment of all that turns with the crank, complex g mm in its axes; None where it is to be found."""
        if self.moment_g_mm is None or self.at_deg is None:
            return None
        return cmath.rect(self.moment_g_mm, math.radians(self.at_deg))

    def best(self, machine: Machine, link: str, pin: str) -> complex:
        """The best moment of all that turns with the crank, complex g mm in its axes, for this machine.

        machine: with the masses of what else moves; link, pin: the crank and its joint with the ground. DesignError where it
        does not turn evenly.
        """
        light = [
            replace(body, mass=0.0, inertia=0.0) if body.name == link else body
            for body in machine.bodies
        ]
        run = solve(replace(machine, bodies=tuple(light)), _TURN)
        angle, rate, _ = run.angle(link)
        uneven = float(np.ptp(rate))
        if not (rate[0] and uneven <= _EVEN * abs(rate[0])):
            raise DesignError(
                "unevenness of the balanced crank",
                uneven,
                0,
                "per turn of the drive",
                f"link {link}",
                "give counterweight.moment_g_mm and at_deg, or balance a crank that turns evenly: on any other "
                "a weight does not pull with one constant force",
            )
        if not (math.isfinite(machine.speed) and machine.speed):
            raise DesignError(
                "speed",
                machine.speed,
                0,
                "rad/s",
                NAME,
                "give the motor's speed, or counterweight.moment_g_mm and at_deg",
            )
        forces = run.forces()
        pull = -forces.shaking
        if self.against == "bearing":
            joint = machine.joint(pin)
            assert isinstance(joint, Pin), f"{pin} is no pin"
            pull = forces.reactions[pin] * (1 if joint.a.body == link else -1)
        return _G * crank_weight(pull, angle, machine.speed * float(rate[0]))[0]

    @property
    def other(self) -> complex:
        """Of what else sits on the shaft, complex g mm."""
        return cmath.rect(self.other_g_mm, math.radians(self.other_deg))

    def fitted(
        self, wanted: complex, own: complex, seat: ShaftSeat, density: float
    ) -> tuple[Part, list[tuple[Part, complex]], float]:
        """The counterweight, its pins with their places, and its radius, mm, in the crank's axes, the shaft at the origin.

        wanted: moment of all parts that turn with the crank; own: that of those that there are without it, complex g mm.
        density: of what is printed, kg/m^3.
        """
        of_sector = (1e3 * STEEL.density if self.made == "steel" else density) * 1e-6  # g/mm^3
        thickness = self.thickness or seat.thickness
        disc = Part(NAME, "", (Layer(Region(circle(0j, seat.hub), (seat.bore,)), 0.0, thickness),))
        sector = Sector(
            seat.hub,
            thickness,
            math.radians(self.half_angle_deg),
            of_sector,
            self.pins,
            self.pin_diameter,
            seat.fits.press_clearance,
            STEEL.density * 1e-3,
            max(seat.min_wall, seat.fits.nozzle) + 2 * FACETS,
        )
        made = "printed" if self.made == "printed" else CUT
        moment = wanted - own - of_sector * disc.volume * centre_of(disc)
        return counterweight(sector, seat.bore, moment, made, seat.min_wall, seat.note)


def first_moment(body: str, about: complex, solids: Solids) -> complex:
    """Of all that is mounted on a body, about a place of it, complex g mm."""
    made = solids.body(Body(body))
    return _G * made.mass * (made.centre - about)


def found_moment(whole: complex) -> dict[str, object]:
    """The moment that was found, by its keys."""
    return {
        "counterweight.moment_g_mm": abs(whole),
        "counterweight.at_deg": math.degrees(cmath.phase(whole)),
    }


def balance_of(body: str, joint: str, about: complex, moment: complex, solids: Solids) -> Balance:
    """What the written solids of a crank are held to."""
    parts = {mount.part for mount in solids.mounts if mount.body == body}
    density = {
        part.name: 1e-6 * solids.density_of(part) for part in solids.parts if part.name in parts
    }
    weights = [part for part in solids.parts if part.role == "counterweight"]
    own = first_moment(body, about, replace(solids, parts=weights))
    return Balance(body, joint, about, moment, density, _SHARE * max(abs(moment), abs(own)))


def study(assembly: Assembly, spec: Counterweight | None, machine: Machine) -> Study:
    """Loads on the crank's bearing and on the frame, without the counterweight and with it; machine: with all its masses."""
    if spec is None:
        return Study()
    balance = assembly.balances[0]  # its own; those of included machines follow
    rest = [part for part in assembly.parts if part.role != "counterweight"]
    other = spec.other / _G / _ARM

    def laden(body: Body) -> Machine:
        place = balance.about + (_ARM * other / abs(other) if other else 0)
        loaded = with_weight(body, abs(other), place)
        bodies = (loaded if each.name == balance.body else each for each in machine.bodies)
        return replace(machine, bodies=tuple(bodies))

    theta = np.linspace(*assembly.cycle.range, len(_TURN))
    full = machine.body(balance.body)
    bare = replace(assembly.solids, parts=rest).body(full)
    forces = [solve(laden(body), theta).forces() for body in (bare, full)]
    reaction = f"reaction at {balance.joint}"
    curves = {
        reaction: [np.abs(each.reactions[balance.joint]) for each in forces],
        "shaking force": [np.abs(each.shaking) for each in forces],
    }
    peaks = {name: [peak(value) for value in values] for name, values in curves.items()}
    drive = machine.drives[0].name
    torque = [peak(each.drives[drive]) for each in forces]
    with_it, without = (body.mass * (body.centre - balance.about) for body in (full, bare))
    moment = _G * (with_it - without)
    numbers = Figures(
        [
            Figure("counterweight", _G * (full.mass - bare.mass), "g"),
            Figure("counterweight", abs(moment), "g mm"),
            Figure("counterweight at", math.degrees(cmath.phase(moment)), "deg"),
            Figure("crank moment asked", abs(balance.moment), "g mm"),
            Figure("crank moment asked at", math.degrees(cmath.phase(balance.moment)), "deg"),
            Figure("counterweight shaking before", peaks["shaking force"][0], "N"),
            Figure("counterweight shaking after", peaks["shaking force"][1], "N"),
            Figure("counterweight bearing before", peaks[reaction][0], "N"),
            Figure("counterweight bearing after", peaks[reaction][1], "N"),
        ]
    )
    degrees = np.degrees(theta)
    plots = [
        Plot(
            f"Counterweight: {name}",
            assembly.cycle.label,
            "N",
            [("without", degrees, before), ("with", degrees, after)],
        )
        for name, (before, after) in curves.items()
    ]
    rows = [(f"{name}, N", *values) for name, values in peaks.items()]
    rows.append(("torque of the drive, N m", *torque))
    title = f"Counterweight against the load of the {spec.against}: greatest of a turn, by the masses of the table of masses"
    return Study(numbers, plots, [Table(title, ("", "without", "with"), rows)])
