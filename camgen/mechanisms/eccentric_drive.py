"""The eccentric drive of a needle machine: an eccentric disc on the motor's shaft, a rod with a strap round it, a slider.

       .---.
      /  E--\\------------------------- P ==>     O shaft (origin), E the disc's centre, OE = eccentricity,
      \\  O  /                         slider      EP = rod, P the slider's pin on the guide y = offset, along x
       '---'

A slider-crank: the disc is a crank as long as its centre is off the shaft, however large it is. The output is the way of
P from its outermost place towards the shaft, mm.
[Sviridov, Vladimirov, Chusovitin, study of the crank-slider mechanism of a tattoo machine, with its table corrected]
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Annotated

import numpy as np
from pydantic import Field

from camgen import dynamics
from camgen.errors import DesignError, Fault
from camgen.findings import Finding, at_least
from camgen.landmarks import refuse_open, zeros
from camgen.linkages import RRP, Crank, Fixed, Jet, Linkage, slider_travel
from camgen.mechanism import Contact, Eye, Mechanism, Pin, Plot, Pose, Slide, Study, Table, Traced
from camgen.outlines import Floats, Points, Region, circle, polygon
from camgen.parts import Layer, Part, hull
from camgen.spec import Length, Mass, Record
from camgen.tolerances import SAME_POINT

_PAPER = (1.5, 48.0, 0.0)
_PAPER_SPEED = 22.6  # rad/s: 13000/60 taken for rpm
# Published: angle deg, v3 mm/s, phi2 deg, phi2' rad/s.
_PUBLISHED = (
    (30, 16.49, 0.9, 0.61), (60, 28.9, 1.55, 0.35), (90, 33.9, 1.79, 0.0), (120, 28.9, 1.55, -0.35), (150, 16.49, 0.9, -0.61),
    (180, 0.0, 0.0, -0.7), (210, -16.49, -0.9, -0.61), (240, -28.9, -1.55, -0.35), (270, -33.9, -1.79, 0.0),
    (300, -28.9, -1.55, 0.35), (330, -16.49, -0.9, 0.61), (360, 0.0, 0.0, 0.7),
)  # fmt: skip
_ERRATA = (
    "Erratum 1: the published v3 at 30 and 330 deg is 5.28 % low, at 60 and 300 deg 3.08 % low: the table mirrors 150 and "
    "120 deg.",
    "Erratum 2: phi2 is printed without its minus sign, which contradicts the closure; the header gives phi2' in degrees, it is "
    "rad/s.",
    "Erratum 3: 22.6 rad/s puts 13000/60, revolutions per second, into a formula that wants rpm. The motor's real speed is "
    "1361.357 rad/s; 22.69 rad/s is 216.67 rpm, 3.6 strokes per second.",
    "Erratum 4: the greatest speed is not at 90 deg but at 88.212 deg.",
    "Erratum 5: the speed curve is not a sine: it has a second harmonic of about half of eccentricity / rod.",
    "Erratum 6: an eccentric disc of 5 mm, bored 1.5 mm off centre for a 2 mm shaft, leaves a wall of 2.5 - 1.5 - 1 = 0 mm. A "
    "printable one is larger, with a strap round it; the motion does not change.",
)


class Geometry(Record):
    """Lengths of the mechanism."""

    eccentricity: Length
    rod: Length
    offset: Annotated[float, Field(ge=-1e6, le=1e6)] = 0.0
    eccentric_diameter: Length
    shaft_diameter: Length


class Motor(Record):
    """What drives the disc; boss_diameter is the collar by which the motor sits in the body."""

    speed_rpm: Annotated[float, Field(gt=0, le=1e6)]
    boss_diameter: Length = 6.0


class Parts(Record):
    """The bodies of the parts."""

    strap_wall: Length = 2.0
    rod_thickness: Length = 3.0
    flange: Length = 1.0
    pin_diameter: Length = 3.0
    slider_width: Length = 8.0
    slider_thickness: Length = 4.0
    wire_diameter: Length = 1.5
    rail_width: Length = 6.0
    cover_length: Length = 10.0
    screw_diameter: Length = 2.2
    body_thickness: Length = 5.0


class Masses(Record):
    """What moves, for forces; the rod's centre of mass from the disc's centre, and its inertia about it."""

    rod_g: Mass
    rod_centre: Annotated[float, Field(ge=-1e6, le=1e6)]
    rod_inertia_g_mm2: Annotated[float, Field(ge=0, le=1e12)]
    slider_g: Mass


class Limits(Record):
    """What the designer accepts; a finding fails beyond it."""

    transmission_angle_deg: Annotated[float, Field(gt=0, le=90)] = 45.0
    min_wall: Length = 0.8


class EccentricDrive(Mechanism):
    """Spec and answers of an eccentric drive; the output is the slider's way from its outermost place, mm."""

    geometry: Geometry
    motor: Motor
    making: Annotated[Parts, Field(alias="parts")] = Parts()
    masses: Masses | None = None
    allowed: Annotated[Limits, Field(alias="limits")] = Limits()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        p, nozzle, slide = self.making, self.print.nozzle, self.print.slide_clearance
        checks = [
            (self.allowed.min_wall >= nozzle, "limits.min_wall", self.allowed.min_wall, f"at least the nozzle, {nozzle:g} mm"),
            (p.strap_wall >= nozzle, "parts.strap_wall", p.strap_wall, f"at least the nozzle, {nozzle:g} mm"),
            (
                p.flange < p.slider_thickness + slide,
                "parts.flange",
                p.flange,
                f"less than {p.slider_thickness + slide:g} mm, so that it clears the body",
            ),
            (p.wire_diameter < p.slider_thickness, "parts.wire_diameter", p.wire_diameter, "less than slider_thickness"),
            (p.pin_diameter < p.slider_width, "parts.pin_diameter", p.pin_diameter, "less than slider_width"),
            (p.wire_diameter < p.slider_width, "parts.wire_diameter", p.wire_diameter, "less than slider_width"),
            (p.screw_diameter < p.rail_width, "parts.screw_diameter", p.screw_diameter, "less than rail_width"),
            (p.screw_diameter < p.cover_length, "parts.screw_diameter", p.screw_diameter, "less than cover_length"),
        ]
        return [Fault(path, f"{value:g}", expected) for fine, path, value, expected in checks if not fine]

    # ---- motion -----------------------------------------------------------------------------------------------------

    @cached_property
    def linkage(self) -> Linkage:
        """O, E, P as a dyad on a crank; raises DesignError with the angles where the rod does not reach the guide."""
        g = self.geometry
        linkage = Linkage({"O": Fixed(0), "E": Crank("O", g.eccentricity), "P": RRP("E", g.rod, 1j * g.offset, 0.0)})
        refuse_open(linkage)
        spare = g.rod - g.eccentricity - abs(g.offset)
        if spare <= SAME_POINT:
            raise DesignError(
                "geometry.rod", g.rod, g.eccentricity + abs(g.offset), "mm",
                f"crank angle {270 if g.offset > 0 else 90} deg",
                "these lengths make a change point: the rod stands square to the guide, the slider can stall; use a longer rod",
            )  # fmt: skip
        return linkage

    @cached_property
    def _outermost(self) -> float:
        """The slider pin's greatest x, mm: crank and rod in one line."""
        g = self.geometry
        return math.sqrt((g.rod + g.eccentricity - g.offset) * (g.rod + g.eccentricity + g.offset))

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Way of the slider from its outermost place towards the shaft, mm, or its derivative to theta, (n,)."""
        g = self.geometry
        if order == 0:
            begun = 0.0
            if g.offset:  # at theta = 0 the slider is not outermost; the difference of two squares, without cancellation
                at_zero = g.eccentricity + math.sqrt((g.rod - g.offset) * (g.rod + g.offset))
                begun = self._outermost - at_zero
            return begun + slider_travel(theta, g.eccentricity, g.rod, g.offset)
        return -np.real(self.linkage.point("P")(theta, order))

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def _bore(self) -> float:
        return self.geometry.shaft_diameter + self.print.press_clearance

    @cached_property
    def _inner(self) -> tuple[float, float]:
        """Least x of the slider and greatest of the rod's end, mm."""
        g, p = self.geometry, self.making
        x_in = math.sqrt((g.rod - g.eccentricity) ** 2 - g.offset**2)
        return x_in - p.slider_width / 2, self._outermost + max(self._eye_radius, p.pin_diameter / 2 + 1)

    @cached_property
    def _eye_radius(self) -> float:
        p = self.making
        return (p.pin_diameter + self.print.slide_clearance) / 2 + p.strap_wall

    @cached_property
    def _strap_radius(self) -> float:
        return (self.geometry.eccentric_diameter + self.print.slide_clearance) / 2 + self.making.strap_wall

    @cached_property
    def _slider_front(self) -> float:
        """How far the slider reaches outwards from its pin, mm: past rod and cover at its innermost place."""
        start, rod_end = self._inner
        return rod_end + 1 + self.making.cover_length - (start + self.making.slider_width / 2)

    def parts(self) -> Sequence[Part]:
        """Body with guide rails, slider, disc with flange, rod with strap, keeper washer, cover and pin: from below."""
        return self._parts

    @cached_property
    def _parts(self) -> tuple[Part, ...]:
        g, p, wall = self.geometry, self.making, self.allowed.min_wall
        self._check_sizes()
        slide, press = self.print.slide_clearance, self.print.press_clearance
        bore, pin_hole = circle(0j, self._bore / 2), p.pin_diameter + press
        keeper = Region(circle(complex(g.eccentricity), self._strap_radius), (bore,))
        rim = Region(circle(complex(g.eccentricity), g.eccentric_diameter / 2), (bore,))
        disc_height = p.rod_thickness + slide
        disc = Part(
            "disc", "Eccentric disc", (Layer(keeper, 0.0, p.flange), Layer(rim, p.flange, p.flange + disc_height)),
            centres=(0j, complex(g.eccentricity)), min_wall=wall, cut=1,
            notes=("press on the motor's shaft, flange below", "cut from sheet, the flange is a second washer"),
        )  # fmt: skip
        washer = Part(
            "washer", "Keeper washer", (Layer(keeper, 0.0, p.flange),), centres=(0j,),
            notes=("press on the shaft above the disc, in line with its flange",), min_wall=wall,
        )  # fmt: skip
        outline = hull([(0j, self._strap_radius), (complex(g.rod), self._eye_radius)])
        eyes = (circle(0j, (g.eccentric_diameter + slide) / 2), circle(complex(g.rod), (p.pin_diameter + slide) / 2))
        rod = Part(
            "rod", "Connecting rod with strap", (Layer(Region(outline, eyes), 0.0, p.rod_thickness),),
            centres=(0j, complex(g.rod)), min_wall=wall,
        )  # fmt: skip
        return self._body(), self._slider(pin_hole), disc, rod, washer, self._cover(), self._pin()

    def _check_sizes(self) -> None:
        """Raise DesignError where the disc has no wall, the strap meets the guide, or rod and slider cannot be made."""
        g, need = self.geometry, self.allowed.min_wall
        thin = g.eccentric_diameter / 2 - g.eccentricity - self._bore / 2
        if thin < need - SAME_POINT:
            works = 2 * (need + g.eccentricity + self._bore / 2)
            raise DesignError(
                "MIN_WALL of the eccentric disc", thin, need, "mm", "the thin side of its bore",
                f"D/2 - e - d/2 must reach it: geometry.eccentric_diameter of {works:g} mm or more works",
            )  # fmt: skip
        self.linkage  # noqa: B018  refuses what does not close, before roots of negative numbers are taken
        room = self._inner[0] - self._strap_radius - g.eccentricity
        if room < self.print.slide_clearance:
            raise DesignError(
                "geometry.rod", g.rod, g.rod - room + self.print.slide_clearance, "mm", "the slider's innermost place",
                "the flange would meet the slider: use a longer rod or a smaller disc",
            )  # fmt: skip

    def _slider(self, pin_hole: float) -> Part:
        """Block on the guide: pin hole at the origin, a hole and a groove along x for the needle's wire."""
        p, front = self.making, self._slider_front
        half, groove = p.slider_width / 2, p.wire_diameter / 2
        hook = self._inner[1] - self._outermost + 1 + p.wire_diameter
        outer = [complex(-half, -half), complex(front, -half), complex(front, half), complex(-half, half)]
        slot = [complex(front, -groove), complex(hook, -groove), complex(hook, groove), complex(front, groove)]
        pin = circle(0j, pin_hole / 2)
        floor = p.slider_thickness - p.wire_diameter
        return Part(
            "slider", "Needle holder",
            (
                Layer(Region(polygon(outer), (pin,)), 0.0, floor),
                Layer(Region(polygon([*outer[:2], *slot, *outer[2:]]), (pin,)), floor, p.slider_thickness),
            ),
            centres=(0j,), notes=("the needle's wire lies in the groove, held by the cover",), min_wall=self.allowed.min_wall,
        )  # fmt: skip

    def _pin(self) -> Part:
        """Pin with a head, printed head down, put in from above."""
        p, slide = self.making, self.print.slide_clearance
        shank = p.slider_thickness + 3 * slide + p.rod_thickness
        layers = (
            Layer(Region(circle(0j, p.pin_diameter / 2 + 1)), 0.0, 1.0),
            Layer(Region(circle(0j, p.pin_diameter / 2)), 1.0, 1.0 + shank),
        )
        return Part("pin", "Slider pin", layers, centres=(0j,), notes=("press into the slider through the rod",), cut=1)

    @cached_property
    def _rail(self) -> tuple[float, float, float]:
        """Where the rails begin and end along x, and the middle of a rail from the guide's axis, mm."""
        p = self.making
        start = self._inner[0]
        end = start + p.slider_width / 2 + self._slider_front
        return start, end, (p.slider_width + self.print.slide_clearance + p.rail_width) / 2

    def _cover(self) -> Part:
        p = self.making
        middle = self._rail[2]
        x, y = p.cover_length / 2, middle + p.rail_width / 2
        outer = polygon([complex(-x, -y), complex(x, -y), complex(x, y), complex(-x, y)])
        screws = tuple(circle(1j * side * middle, p.screw_diameter / 2) for side in (-1, 1))
        layer = Layer(Region(outer, screws), 0.0, p.rod_thickness)
        return Part("cover", "Guide cover", (layer,), centres=(-1j * middle, 1j * middle), min_wall=self.allowed.min_wall)

    def _body(self) -> Part:
        """Plate with the motor's seat at the origin and the two rails of the guide."""
        g, p, slide = self.geometry, self.making, self.print.slide_clearance
        start, end, middle = self._rail
        seat = (self.motor.boss_diameter + self.print.press_clearance) / 2
        top, bottom = g.offset + middle + p.rail_width / 2, g.offset - middle - p.rail_width / 2
        top, bottom, left = max(top, seat + 3), min(bottom, -seat - 3), -seat - 3
        r = 2.0
        plate = hull([(complex(x, y), r) for x in (left + r, end - r) for y in (bottom + r, top - r)])
        screws = [complex(end - p.cover_length / 2, g.offset + side * middle) for side in (-1, 1)]
        height = p.body_thickness + p.slider_thickness + slide
        holes = (circle(0j, seat), *(circle(z, p.screw_diameter / 2) for z in screws))
        layers = [Layer(Region(plate, holes), 0.0, p.body_thickness)]
        for side, screw in zip((-1, 1), screws, strict=True):
            y0, y1 = sorted(g.offset + side * (middle + s * p.rail_width / 2) for s in (-1, 1))
            bar = [complex(start, y0), complex(end - r, y0), complex(end - r, y1), complex(start, y1)]
            layers.append(Layer(Region(polygon(bar), (circle(screw, p.screw_diameter / 2),)), p.body_thickness, height))
        return Part(
            "body", "Body plate with guide", tuple(layers), centres=(0j, *screws),
            notes=("the motor's collar sits in the hole at the origin, from below",), min_wall=self.allowed.min_wall,
        )  # fmt: skip

    # ---- assembly ---------------------------------------------------------------------------------------------------

    def poses(self, theta: Floats) -> Mapping[str, Sequence[Pose]]:
        """Disc and washer turn, the rod follows, slider and pin shift; body and cover stand still."""
        p, slide = self.making, self.print.slide_clearance
        theta = np.asarray(theta, float)
        still: Points = np.zeros(theta.shape, complex)
        flat: Floats = np.zeros(theta.shape)
        at = self.linkage.solve(theta)
        e, pin = at["E"][0], at["P"][0]
        bed = p.body_thickness
        rod_z = bed + p.slider_thickness + 2 * slide
        _, end, _ = self._rail
        cover = complex(end - p.cover_length / 2, self.geometry.offset)
        return {
            "disc": [Pose(theta, still, z=rod_z - p.flange)],
            "washer": [Pose(theta, still, z=rod_z + p.rod_thickness + slide)],
            "rod": [Pose(np.angle(pin - e), e, z=rod_z)],
            "slider": [Pose(flat, pin, z=bed)],
            "pin": [Pose(flat, pin, flipped=True, z=bed)],
            "cover": [Pose(flat, still + cover, z=bed + p.slider_thickness + slide)],
            "body": [Pose(flat, still)],
        }

    def contacts(self) -> Sequence[Contact]:
        """The shaft in disc and body, the disc in the strap, the pin in rod and slider, the slider on its guide."""
        g, p, slide, press = self.geometry, self.making, self.print.slide_clearance, self.print.press_clearance
        boss = self.motor.boss_diameter
        slider = Eye("slider", 0j, p.pin_diameter + press)
        return (
            # the motor is the pin: its collar in the body, its shaft in the disc, and the mean of both counts twice
            Pin(
                "shaft", Eye("disc", 0j, self._bore), Eye("body", 0j, boss + press), 2 * press,
                Eye(None, 0j, (g.shaft_diameter + boss) / 2, shaft=True),
            ),
            Pin(
                "strap", Eye("disc", complex(g.eccentricity), g.eccentric_diameter, shaft=True),
                Eye("rod", 0j, g.eccentric_diameter + slide), slide,
            ),
            Pin(
                "slider pin", Eye("rod", complex(g.rod), p.pin_diameter + slide), slider, slide + press,
                Eye("pin", 0j, p.pin_diameter, shaft=True),
            ),
            Slide("guide", slider, 1j * g.offset, 0.0, p.slider_width, slide, "body", drawn=False),
            Traced(
                "travel", "disc", ("body", "cover"), Eye("slider", 0j, 0.0),
                lambda path: self._outermost - path.real, lambda path: np.full(path.shape, -1 + 0j),
            ),
        )  # fmt: skip

    # ---- checks and study -------------------------------------------------------------------------------------------

    def limits(self) -> Sequence[Finding]:
        """Least transmission angle: of the rod against the square to the guide."""
        g = self.geometry
        self.linkage  # noqa: B018
        reach = (g.eccentricity + abs(g.offset)) / g.rod
        worst = math.degrees(math.acos(reach))
        where = "crank angle 270 deg" if g.offset > 0 else "crank angle 90 deg"
        message = "90 deg less the rod's greatest tilt; a longer rod enlarges it"
        return [at_least("TRANSMISSION_ANGLE", worst, self.allowed.transmission_angle_deg, "deg", where, message)]

    @cached_property
    def _peak(self) -> tuple[float, float]:
        """Crank angle, rad, and size, mm/rad, of the greatest speed; the first of equal ones."""

        def slope(theta: Floats, order: int) -> Floats:
            return self.motion(theta, 2) if order == 0 else np.full(theta.shape, np.nan)

        found = zeros(slope)
        speeds = np.abs(self.motion(found, 1))
        k = int(np.argmax(speeds > speeds.max() * (1 - 1e-12)))
        return float(found[k]), float(speeds[k])

    def study(self) -> Study:
        """Stroke, peak speed and its angle, harmonics, travel; the published table where the lengths are the paper's."""
        g = self.geometry
        degrees = np.linspace(0, 360, 1441)
        theta = np.radians(degrees)
        speed = self.motor.speed_rpm * math.tau / 60
        at, top = self._peak
        x_in = self._inner[0] + self.making.slider_width / 2
        wave = np.abs(np.fft.rfft(self.motion(np.linspace(0, math.tau, 4096, endpoint=False), 1)))
        numbers = {
            "stroke_mm": self._outermost - x_in,
            "motor_speed_rad_s": speed,
            "strokes_per_second": self.motor.speed_rpm / 60,
            "peak_speed_mm_s": top * speed,
            "peak_speed_angle_deg": math.degrees(at),
            "peak_speed_over_e_w": top / g.eccentricity,
            "acceleration_outermost_mm_s2": float(self.motion(np.zeros(1), 2)[0]) * speed**2,
            "second_harmonic_share": float(wave[2] / wave[1]),
            "disc_wall_mm": g.eccentric_diameter / 2 - g.eccentricity - self._bore / 2,
        }
        label = "crank angle, deg"
        plots = [
            Plot(title, label, unit, [("exact", degrees, self.motion(theta, order) * speed**order * 1e-3)])
            for order, title, unit in ((1, "Slider speed", "m/s"), (2, "Slider acceleration", "m/s²"))
        ]
        turn = theta[::120]
        units = (1.0, speed, speed**2 * 1e-3)
        rows = np.column_stack([degrees[::120], *(_clean(self.motion(turn, k) * unit) for k, unit in enumerate(units))])
        columns = ("crank angle, deg", "travel, mm", "speed, mm/s", "acceleration, m/s²")
        tables = [Table("Travel from the outermost place, at the motor's speed", columns, rows.tolist())]
        notes: tuple[str, ...] = ()
        if (g.eccentricity, g.rod, g.offset) == _PAPER:
            numbers |= {"paper_speed_rad_s": _PAPER_SPEED, "paper_peak_speed_mm_s": top * _PAPER_SPEED}
            tables.append(self._published())
            source = "Source: Sviridov, Vladimirov, Chusovitin, study of the crank-slider mechanism of a tattoo machine."
            notes = (source, *_ERRATA)
        if self.masses is not None:
            forces = self._forces(theta, speed, self.masses)
            peaks = {f"peak_force_{name}_N": float(np.max(np.abs(force))) for name, force in forces.reactions.items()}
            numbers |= {**peaks, "peak_torque_N_m": float(np.max(np.abs(forces.torque)))}
            plots += [
                Plot("Joint forces", label, "N", [(name, degrees, np.abs(f)) for name, f in forces.reactions.items()]),
                Plot("Driving torque", label, "N m", [("torque", degrees, forces.torque)]),
            ]
        return Study(numbers, plots, tables, (), notes)

    def _published(self) -> Table:
        """The paper's table beside exact values at the paper's speed; v3 positive towards the shaft, as printed."""
        theta = np.radians([row[0] for row in _PUBLISHED])
        at: dict[str, Jet] = self.linkage.solve(theta, 1)
        rod = at["P"] - at["E"]
        tilt, rate = np.degrees(np.angle(rod[0])), np.imag(rod[1] / rod[0]) * _PAPER_SPEED
        exact = zip(*(_clean(values) for values in (self.motion(theta, 1) * _PAPER_SPEED, tilt, rate)), strict=True)
        rows = [
            [angle, v, x, round((v / x - 1) * 100, 9) + 0.0 if x else 0.0, phi, y, dphi, z]
            for (angle, v, phi, dphi), (x, y, z) in zip(_PUBLISHED, exact, strict=True)
        ]
        columns = (
            "crank angle, deg", "published v3, mm/s", "exact v3, mm/s", "v3 off by, %", "published phi2, deg",
            "exact phi2, deg", "published phi2', rad/s", "exact phi2', rad/s",
        )  # fmt: skip
        return Table(f"Published table and exact values at {_PAPER_SPEED:g} rad/s", columns, rows)

    def _forces(self, theta: Floats, speed: float, masses: Masses) -> dynamics.Forces:
        """Joint forces and torque of the running drive; the disc counts as balanced."""
        bodies = {
            "disc": dynamics.Body("O", "E", 0.0),
            "rod": dynamics.Body("E", "P", masses.rod_g * 1e-3, masses.rod_centre, masses.rod_inertia_g_mm2 * 1e-9),
            "slider": dynamics.Body("P", "P", masses.slider_g * 1e-3),
        }
        pins = [dynamics.Pin("O", "disc"), dynamics.Pin("E", "rod", "disc"), dynamics.Pin("P", "slider", "rod")]
        guide = [dynamics.Slide("P", "slider", 0.0)]
        return dynamics.kinetostatics(self.linkage.solve(theta, 2), bodies, pins, guide, "disc", speed)


def _clean(values: Floats) -> list[float]:
    """Values of a table, rounding noise beside its greatest made zero."""
    return [float(v) for v in np.where(np.abs(values) < 1e-13 * np.max(np.abs(values)), 0.0, values)]
