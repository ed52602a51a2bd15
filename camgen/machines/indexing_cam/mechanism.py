"""The indexing cam: it turns a driven link by a given angle, holds it, turns it back and holds it; a spring bears the inertia.

               return roller ( )                    O cam shaft (origin), A the follower's axle at (L, 0); the follower's
                               \\                    gear segment turns the driven link by gear_ratio times its angle
          O                     A ===(gears)=== driven link, with the spring unloader
                               /
                    roller ( )                      s = 0 in the inner dwell; the roller leaves the cam as s grows

The driven link swings to and fro, so one cam turn makes two indexings by the same law. With closure "conjugate" a second
cam beside the first carries the return roller. [Analysis and recommendations for choosing cam mechanisms for the drive of
pad-printing machines, combined with unloading devices (in Ukrainian); MR-13 is its law, A6 with the corrected sign]
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import Field

from camgen.errors import DesignError, Fault, SpecError
from camgen.findings import Finding
from camgen.geometry.outlines import Floats, Region
from camgen.machine import model as m
from camgen.machine.cams.limits import Advice, ExactCam, cam_findings, undercut_numbers
from camgen.machine.cams.machine import CamTouch, cam_outline
from camgen.machine.cams.profile import DiscCam, SwingingArm
from camgen.machine.features import Demand, Mount
from camgen.machine.run import solve
from camgen.machine.targets import advance
from camgen.machines.cam_tables import CamTables
from camgen.machines.free_play import between
from camgen.machines.indexing_cam import tables as t
from camgen.machines.indexing_cam.comparison import Comparison
from camgen.machines.indexing_cam.drawing import Drawing
from camgen.machines.indexing_cam.driver import ARM, CHAIN, MADE, NOT_MADE, TwoCranks, driver_faults
from camgen.machines.indexing_cam.stepping import Stepping
from camgen.machines.indexing_cam.study import IndexingStudy
from camgen.machines.indexing_cam.unloader import (
    LINK,
    CrankSpring,
    Load,
    OnLink,
    SpringTorque,
    fitting,
    law_torque,
    peak,
)
from camgen.machines.indexing_cam.unloader_crank import UnloaderCrank
from camgen.machines.metal import shaft_notes, shaft_of
from camgen.motion.laws import Law
from camgen.motion.program import Program, Segment
from camgen.motion.segments import law_of
from camgen.motion.spring_law import trade_off
from camgen.parts.assembly import Assembly
from camgen.parts.catalogue import CLUTCHES
from camgen.parts.disc_cams import holes_in, roller_note, turning_note
from camgen.parts.engraving import with_upper_sides
from camgen.parts.generator.beneath import room
from camgen.parts.part import Layer, Part, windows
from camgen.spec import validate
from camgen.study import Figure, Figures, Later, Plot, Sketch, Study, Table, figures_in

if TYPE_CHECKING:
    from camgen.machines.linkage.spec import Additions

FOLLOWER = "follower"
WHEEL = "drive_wheel"
_EVEN = "angle of the even drive", "even drive, once a turn of the cam"
_NOT_MADE = 'The unloader is not made, and the driven link goes without it: unloader.torque = "crank" is one that can be made.'
_SPRING_POINTS = 101  # of a table that stands for a spring
_ADVICE = Advice(
    "a larger base_radius, gear_ratio or rise_deg",
    "a larger base_radius or a smaller roller",
    "a geometry.law that ends smoother joins them",
)


class IndexingCam(CamTables):
    """Spec and answers of an indexing cam; the output is the follower's angle s, rad, 0 in the inner dwell."""

    doubled: ClassVar[Collection[str]] = ("thickness", "wall")

    geometry: t.IndexingGeometry
    motor: t.IndexingMotor = t.IndexingMotor()
    driver: t.Driver | None = Field(
        default=None,
        description="a two-crank chain in front of the cam: the cam then turns fastest in the middle of each turn of the table, and the "
        'table moves as before; for rise_deg + dwell_deg = 180 there and back, with make = "cams"',
    )
    freewheel: t.Freewheels | None = Field(
        default=None,
        description="the table turns on instead of to and fro: the follower's wheel takes it along by "
        "a one-way clutch as it swings out, a second clutch in the plate holds it; 180 deg "
        "each turn of the cam",
    )
    load: t.LoadTable
    unloader: t.UnloaderTable = t.UnloaderTable()
    synthesis: t.SynthesisTable | None = Field(
        default=None,
        description="laws sought for this spring, one for each weight q of Q = C^2 + q Y^2, listed in "
        "the report;\n"
        "camgen design SPEC writes the spec with the law of the last weight",
    )
    making: Annotated[t.IndexingParts, Field(alias="parts")] = t.IndexingParts()
    allowed: Annotated[t.IndexingLimits, Field(alias="limits")] = t.IndexingLimits()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        p = self.making
        u = self.unloader
        nozzle = self.print.nozzle
        checks = [
            (
                self.standing or p.wall >= nozzle,
                ("parts", "wall"),
                p.wall,
                f"at least the nozzle, {nozzle:g} mm",
            ),
            (
                self.allowed.min_wall >= nozzle,
                ("limits", "min_wall"),
                self.allowed.min_wall,
                f"at least the nozzle, {nozzle:g} mm",
            ),
            (
                g.closure == "force" or not self.load.closing_n_m,
                ("load", "closing_n_m"),
                self.load.closing_n_m,
                'no value here: closure "conjugate" needs no spring',
            ),
        ]
        found = [
            Fault(path, f"{value:g}", expected)
            for fine, path, value, expected in checks
            if not fine
        ]
        found += u.faults(self.freewheel is not None)
        if self.load.gravity_deg is not None:
            why = "no value here: camgen calculates an indexing cam as lying flat"
            found.append(Fault(("load", "gravity_deg"), f"{self.load.gravity_deg:g}", why))
        if self.freewheel is not None and self.sizes.shaft_diameter not in CLUTCHES:
            sold = ", ".join(f"{bore:g}" for bore in CLUTCHES)
            found.append(
                Fault(
                    ("parts", "shaft_diameter"),
                    f"{self.sizes.shaft_diameter:g}",
                    f"a bore of freewheels, {sold} mm",
                )
            )
        if self.synthesis is not None and u.torque == "none":
            found.append(Fault(("synthesis",), "", 'an unloader: its torque is "none"'))
        if self.driver is not None:
            found += driver_faults(self.driver, (g.rise_deg, g.dwell_deg, g.back_deg))
            between = room(self.sizes, self.print, self.driver.crank, self.driver.offset)
            wall = self.sizes.wall
            if self.standing and between < wall:
                right = f"at most {self.driver.offset - wall + between:.4g}: slot and shaft of the arm need a wall of {wall:g} mm"
                found.append(
                    Fault(
                        ("driver", "offset"),
                        f"{self.driver.offset:g}",
                        right + "; or a longer driver.crank",
                    )
                )
        return [*found, *self.size_faults(FOLLOWER, "driven-link"), *g.faults()]

    def designed(self) -> Self:
        """This spec with the law that [synthesis] finds for its spring and its last weight; a spring of the old law stays,
        as a table. SpecError without [synthesis].
        """
        wanted = self.synthesis
        spring = self.unloading
        if wanted is None or spring is None:
            raise SpecError(
                [Fault(("synthesis",), "", "missing: weights of the law to be looked for, [q]")]
            )
        found = trade_off(spring, wanted.weights, wanted.sines, wanted.cosines)[-1]
        data = self.model_dump(by_alias=True, exclude_none=True)
        data["geometry"]["law"] = {
            "name": "fourier",
            "sines": list(found.sines),
            "cosines": list(found.cosines),
        }
        if self.unloader.torque == "law":
            a = (
                0.5 * np.linspace(0, 1, _SPRING_POINTS) ** 2
            )  # the torque starts as the root of the position
            data["unloader"] = {
                "torque": "table",
                "points": np.column_stack([a, spring(a)]).tolist(),
            }
        return validate(type(self), data)

    # ---- motion -----------------------------------------------------------------------------------------------------

    @cached_property
    def law(self) -> Law:
        """The law of the turn; the return runs through the same one."""
        return law_of(self.geometry.law)

    @property
    def swing(self) -> float:
        """The follower's swing, rad."""
        lost = 0.0 if self.freewheel is None else self.freewheel.lost_deg
        return math.radians((self.geometry.index_deg + lost) / self.geometry.gear_ratio)

    @cached_property
    def program(self) -> Program:
        """Rise from theta = 0, outer dwell, return, inner dwell; where theta runs clockwise backwards."""
        g = self.geometry
        return self.turns(self.law, g.rise_deg, g.dwell_deg, self.geometry.back_deg)

    @cached_property
    def cam_program(self) -> Program:
        """The same over the cam's own angle, which with [driver] is not theta."""
        return self.program if self.two_cranks is None else self.paced(self.two_cranks)

    def paced(self, chain: TwoCranks, sized: bool = True) -> Program:
        """Over the cam's angle behind a chain; sized: whether its laws know their peaks."""
        turn = math.degrees(chain.turn)
        return self.turns(chain.paced(self.law, sized), turn, 180 - turn, turn)

    def turns(self, law: Law, *degrees: float) -> Program:
        """There and back by a law: rise, dwell and return of so many degrees."""
        spans = [*degrees, 360 - math.fsum(degrees)]
        swing = self.swing
        shape = [
            ("rise", 0.0, swing),
            ("dwell", swing, 0.0),
            ("return", swing, -swing),
            ("dwell", 0.0, 0.0),
        ]
        segments = [
            Segment(kind, math.radians(span), start, scale, law)
            for span, (kind, start, scale) in zip(spans, shape, strict=True)
            if span > 1e-9
        ]
        made = Program(tuple(segments))
        return made if self._sense > 0 else made.backwards()

    @cached_property
    def two_cranks(self) -> TwoCranks | None:
        """The chain before the cam."""
        if self.driver is None:
            return None
        return self.chain(self.driver.crank, self.driver.offset, self.geometry.rise_deg)

    def chain(self, crank: float, offset: float, rise_deg: float) -> TwoCranks:
        """A chain of these sizes, mm, for turns of the driven link in so many degrees of 180."""
        far = complex(self.geometry.follower.pivot_distance)
        at = far / 2 if self.standing else -far
        return TwoCranks(crank, offset, math.radians(rise_deg), self._sense, at, self.standing)

    # ---- what it is as a linkage ------------------------------------------------------------------------------------

    def tables(self) -> Mapping[str, Any]:
        """Cams, follower, gears and driven link; the chain before them, freewheels and unloader where there are such."""
        from camgen.machines.linkage.tables import LinkageLimits

        g = self.geometry
        f = self.geometry.follower
        first = self.arm(g.base_radius)
        turned = LINK if self.freewheel is None else WHEEL
        points = {
            "shaft": 0j,
            "pivot": first.pivot,
            "level": first.pivot + f.arm,  # the follower's angle is 0 in the inner dwell
            "tip": first.pivot + first.arm,
            "axle": self.link_centre,
        }
        links = {
            "ground": ["shaft", "pivot", "axle"],
            "cam": ["shaft"],
            FOLLOWER: ["pivot", "level", "tip"],
            LINK: ["axle"],
        }
        gears = [{"name": "gears", "a": FOLLOWER, "b": turned, "ratio": -g.gear_ratio}]
        inertia = {
            LINK: self.load.inertia_kg_m2,
            FOLLOWER: self.load.follower_inertia_kg_m2,
        }
        shapes = {LINK: {"hub_diameter": f.arm}}
        found: dict[str, Any] = {
            "drive": {"link": "cam", "speed_rpm": self.motor.speed_rpm},
            "cam": [self._cam_table()],
            "output": [{"name": "swing", "link": FOLLOWER}, {"name": "link", "link": LINK}],
            "masses": {
                link: {"mass_g": 0.0, "centre": (0.0, 0.0), "inertia_kg_m2": value}
                for link, value in inertia.items()
                if value
            },
            "parts": {**shapes, **self._linkage_sizes},
            "limits": self.allowed.model_dump(include={*LinkageLimits.model_fields}),
        }
        if self.freewheel is not None:
            links[WHEEL] = ["axle"]
            found["output"].append({"name": "wheel", "link": WHEEL})
            own = {"name": "freewheels", "wheel": WHEEL, "link": LINK, "turns": "clockwise"}
            found["freewheel"] = [{**own, "lost_deg": self.freewheel.lost_deg}]
        drawing = Drawing(points, links, gears, found)
        if self.two_cranks is not None:
            self.two_cranks.draw(drawing)
        if self.standing and self.unloader_crank is not None:
            self.unloader_crank.draw(drawing)
        return drawing.tables()

    @property
    def _linkage_sizes(self) -> dict[str, Any]:
        """[parts] of the linkage; of cams alone only what turns on by freewheels asks for."""
        if not self.standing:
            return {} if self.freewheel is None else {"shaft_diameter": self.making.shaft_diameter}
        return {key.replace("-", "_"): value for key, value in self.sizes.of_linkage().items()}

    def _cam_table(self) -> dict[str, Any]:
        """[[cam]]; behind a chain its program is given beside the tables."""
        g = self.geometry
        returned = self.standing and g.closure == "force"
        moving = {"lift_deg": math.degrees(self.swing), "law": g.law}
        forward = self.program if self._sense > 0 else self.program.backwards()
        return {
            "name": "contact",
            "cam": "cam",
            "follower": FOLLOWER,
            "at": "tip",
            "radius": g.follower.roller_radius,
            "closure": g.closure,
            "tip_clearance": g.tip_clearance,
            **({"spring": {"preload": self.load.closing_n_m}} if returned else {}),
            "segment": [
                {
                    "kind": each.kind,
                    "span_deg": math.degrees(each.span),
                    **(moving if each.scale else {}),
                }
                for each in forward.segments
            ],
        }

    def additions(self) -> Additions:
        """What loads the link; with a chain the cams' program behind it, and the law of its crank."""
        from camgen.machines.linkage.spec import Additions

        found = Additions(loads=self._loads, advice=_ADVICE)
        if self.two_cranks is None:
            return found
        programs = {"contact": self.cam_program}
        beneath = ARM if self.standing else None
        return replace(found, programs=programs, drive=self.two_cranks.drive, beneath=beneath)

    @property
    def _loads(self) -> tuple[m.Load, ...]:
        """Friction of the link, torque of an unloader that is not made, and of a spring that closes cams alone."""
        made = self.standing and self.unloader_crank is not None
        law = None
        if self.unloading is not None and not made:
            way = -math.radians(self.geometry.index_deg)
            law = OnLink(self.unloading, way)
        name = "unloader and friction"
        borne = m.Resistance(name, m.Angle(LINK), friction=self.load.friction_n_m, law=law)
        if self.standing or not self.load.closing_n_m:
            return (borne,)
        return borne, m.Resistance("load", m.Angle(FOLLOWER), -self.load.closing_n_m)

    @cached_property
    def unloader_crank(self) -> UnloaderCrank | None:
        """The unloader of a machine that is made; None where its spring is none that can be."""
        if not isinstance(self.unloading, CrankSpring):
            return None
        f = self.geometry.follower
        ratio = self.geometry.gear_ratio
        wheel = (self.link_centre.real - f.pivot_distance) * ratio / (1 + ratio)
        cams = [*self.cams.values()]
        return UnloaderCrank(
            self.unloading, self.link_centre, f.arm / 2, wheel, cams, self.swing, self.sizes
        )

    def _unloaded(self) -> m.Machine:
        """Of what is made, or where that is the cams alone as designed: exact, without play."""
        if self.standing:
            return super()._unloaded()
        chain = self.linkage.chain
        touches = tuple(CamTouch(cam) for cam in self.cams.values())
        joints = tuple(
            replace(joint, touches=touches)
            if isinstance(joint, m.Cam)
            else replace(joint, clearance=0.0)
            for joint in chain.joints
        )
        return replace(chain, joints=joints, loads=self._loads)

    def _found(self) -> Mapping[str, object]:
        """The span of the return and the spring by the law, and what every mechanism fills in."""
        steepest = self.allowed.cam_limits.steepest(self.cams["cam"])
        found = {
            **super()._found(),
            "geometry.return_deg": self.geometry.back_deg,
            "limits.pressure_angle_deg": steepest,
            **({"parts.base_thickness": self.sizes.base_thickness} if self.standing else {}),
        }
        if self.unloader.torque == "law":
            found |= {"unloader.balance": self._balance, "unloader.design_rpm": self._design_rpm}
        elif isinstance(self.unloading, CrankSpring):
            found["unloader.stiffness_n_mm"] = self.unloading.stiffness
        return found

    @property
    def _balance(self) -> float:
        return 1.0 if self.unloader.balance is None else self.unloader.balance

    @property
    def _design_rpm(self) -> float:
        return (
            abs(self.motor.speed_rpm)
            if self.unloader.design_rpm is None
            else self.unloader.design_rpm
        )

    @cached_property
    def cams(self) -> Mapping[str, DiscCam]:
        """The cam engine for each cam by its part's name; DesignError where there is no such follower."""
        f = self.geometry.follower
        air = self.geometry.tip_clearance
        first = self.arm(self.geometry.base_radius)
        if self.geometry.closure == "force":
            return {"cam": DiscCam(self.cam_program, first)}
        back = first.arm.conjugate() * cmath.exp(-1j * self.swing)
        second = SwingingArm(first.pivot, back, f.roller_radius, leaves=-1)
        return {
            "cam": DiscCam(self.cam_program, first, air),
            "return-cam": DiscCam(self.cam_program, second, air),
        }

    def arm(self, base: float) -> SwingingArm:
        """The follower on a base circle; DesignError where it cannot stand or swing there."""
        f = self.geometry.follower
        low = abs(f.pivot_distance - f.arm)
        high = f.pivot_distance + f.arm
        radius = base + f.roller_radius
        if not low < radius < high:
            raise DesignError(
                "geometry.base_radius and roller_radius together",
                radius,
                low if radius <= low else high,
                "mm",
                "the inner dwell",
                "arm and pivot_distance make no triangle with it: change one of them",
            )
        drawn = SwingingArm(complex(f.pivot_distance), complex(f.arm), f.roller_radius, leaves=1)
        found = drawn.on_base(base)
        inner = cmath.phase(-found.arm)
        if inner + self.swing >= math.pi:
            raise DesignError(
                "the follower's swing",
                math.degrees(self.swing),
                math.degrees(math.pi - inner),
                "deg",
                "the outer dwell",
                "the arm would pass the line of shaft and axle: use a larger gear_ratio or a smaller index_deg",
            )
        return found

    @cached_property
    def sizes(self) -> t.IndexingParts:
        """[parts]; a plate is as thick as the freewheel in it."""
        given = self.making
        freewheel = CLUTCHES.get(given.shaft_diameter)
        if (
            self.freewheel is None
            or freewheel is None
            or "base_thickness" in given.model_fields_set
        ):
            return given
        return given.model_copy(update={"base_thickness": freewheel[0].width})

    @cached_property
    def stepping(self) -> Stepping | None:
        """How the link turns on; None where it goes to and fro."""
        if self.freewheel is None:
            return None
        g = self.geometry
        return Stepping(
            self.program,
            math.radians(g.rise_deg),
            g.gear_ratio,
            math.radians(g.index_deg),
            math.radians(self.freewheel.lost_deg),
            self._sense,
            CLUTCHES[self.sizes.shaft_diameter][1],
        )

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """Wanted angle s of the follower (rad) or its derivative to theta, (n,)."""
        return self.program(theta, order)

    # ---- parts ------------------------------------------------------------------------------------------------------

    def _cams(self) -> Sequence[Part]:
        """The cam, and with closure "conjugate" the return cam that sits beside it on the same key."""
        return [self._part(name, cam) for name, cam in self.cams.items()]

    def _part(self, name: str, cam: DiscCam) -> Part:
        p = self.making
        holes = holes_in(
            p, name, cam.outline, lambda rim, reach: windows(rim, reach, p.windows, p.wall)
        )
        title = "Return cam" if name == "return-cam" else "Indexing cam"
        return Part(
            name,
            title,
            (Layer(Region(cam.outline, holes), 0.0, p.thickness),),
            centres=(0j,),
            notes=(
                turning_note(self._sense),
                *roller_note(2 * self.geometry.follower.roller_radius),
                *p.notes(),
            ),
            bore=p.bore,
            min_wall=self.allowed.min_wall,
        )

    # ---- assembly ---------------------------------------------------------------------------------------------------

    @property
    def link_centre(self) -> complex:
        """Axle of the driven link, on the ground, mm."""
        f = self.geometry.follower
        return complex(f.pivot_distance + 0.75 * f.arm)

    @cached_property
    def assembly(self) -> Assembly:
        """The whole machine, or the cams alone."""
        if self.standing:
            return super().assembly
        limits = self.allowed.cam_limits
        bore = self.making.bore
        outlines = [cam_outline(cam, name, limits, bore) for name, cam in self.cams.items()]
        beside = self.making.thickness + self.print.slide_clearance
        mounts = [Mount(name, "cam", z=0.0 if name == "cam" else beside) for name in self.cams]
        made = self._assembly(with_upper_sides(self._cams(), outlines), mounts, outlines)
        cycle = replace(made.cycle, turns=self.linkage.turns)
        length = self.making.thickness + beside * (len(self.cams) - 1)
        carried = shaft_of(
            self.making, self.material.name, self.motor.model, [length], self.drawing.key_fit
        )
        return replace(made, demands=self.demands(), cycle=cycle, bought=carried)

    def demands(self) -> tuple[Demand, ...]:
        """The play of the follower that is borne; the link of cams alone follows by gears that are not made."""
        swing = math.radians(self.allowed.lash_deg)
        link = swing * self.geometry.gear_ratio
        driven = Demand("link", lash=link) if self.standing else Demand("link", judged=False)
        if self.stepping is None:
            return Demand("swing", lash=swing), driven
        wanted = (self.stepping.wanted(self.allowed.advance_deg),)
        wheel = Demand("wheel", judged=False)
        if self.standing:
            wheel = Demand("wheel", lash=link, targets=wanted)
        return Demand("swing", lash=swing), driven, wheel

    # ---- checks and study -------------------------------------------------------------------------------------------

    @cached_property
    def indexing(self) -> IndexingStudy:
        """What is asked of the drive."""
        load = self.load
        spring = self.unloading
        omega = self._speed
        given = Load(
            load.inertia_kg_m2,
            load.follower_inertia_kg_m2,
            load.friction_n_m,
            self.geometry.gear_ratio,
        )
        return IndexingStudy(
            self.program,
            self.law,
            self.swing,
            omega,
            given,
            spring,
            load.dwell_torque_n_m,
            self._closing,
            self._ideal,
            *(("cam angle", "cam shaft") if self.driver is None else _EVEN),
            self.stepping,
        )

    @property
    def _closing(self) -> float | None:
        """Least torque at the follower's axle of the spring that presses it on its cam, N m; None of a pair of cams."""
        if self.geometry.closure != "force":
            return None
        return self.linkage.construction.closing if self.standing else self.load.closing_n_m

    @cached_property
    def unloading(self) -> SpringTorque | None:
        """Torque on the link over the share of its turn."""
        u = self.unloader
        if u.torque == "law":
            return self._ideal
        spring = u.spring(math.radians(self.geometry.index_deg), self.freewheel is not None)
        if isinstance(spring, CrankSpring) and u.stiffness_n_mm is None:
            return fitting(spring, self.law, self._unit)
        return spring

    @property
    def _unit(self) -> float:
        """Torque of the inertia on the driven link where the law's c is 1, N m."""
        period = math.radians(self.geometry.rise_deg) / (self._design_rpm * math.tau / 60)
        return self.load.inertia_kg_m2 * math.radians(self.geometry.index_deg) / period**2

    @cached_property
    def _ideal(self) -> SpringTorque:
        """A spring, which cannot be built, that does by itself what the law asks."""
        return law_torque(self.law, self._balance * self._unit)

    def findings(self) -> Sequence[Finding]:
        """Jumps at the joints; residual torque and force closure."""
        return self.indexing.findings(self.allowed.acceleration_jump, self.allowed.residual)

    def limits(self) -> Sequence[Finding]:
        """Pressure angle, undercut, of cams alone room at the axle; and its own."""
        if self.standing:
            return super().limits()
        cams = [ExactCam(f"exact {name}", cam, _ADVICE) for name, cam in self.cams.items()]
        facets = self.accuracy.chord_tolerance
        return [
            *cam_findings(cams, self.allowed.cam_limits, chord_tolerance=facets),
            *self.findings(),
        ]

    def forecast(self) -> Sequence[Finding]:
        """The same, and of a pair of cams alone the free play of the follower between them."""
        if self.standing:
            return super().forecast()
        return [
            *self.limits(),
            *between(
                [*self.cams.values()],
                self.geometry.tip_clearance,
                math.radians(self.allowed.lash_deg),
            ),
        ]

    def study(self) -> Study:
        """Its own figures, and of a machine those of a linkage."""
        return super().study() if self.standing else self.figures()

    def figures(self) -> Study:
        """Torques with and without the unloader, the law's curves, and what was taken from the source."""
        cams = {name.replace("-", "_"): cam for name, cam in self.cams.items()}
        own = [
            Figure("index", self.geometry.index_deg, "deg"),
            Figure("swing", math.degrees(self.swing), "deg"),
            *(
                Figure("{of} pressure angle", cam.steepest, "deg", name)
                for name, cam in cams.items()
            ),
            *(
                Figure("{of} least radius", cam.least_radius, "mm", name)
                for name, cam in cams.items()
                if math.isfinite(cam.least_radius)
            ),
            *undercut_numbers([*self.cams.values()]).records,
        ]
        if isinstance(self.unloading, CrankSpring):
            low, high = self.unloading.stretches
            stiffness = self.unloading.stiffness
            own += figures_in("mm", spring_stretch_least=low, spring_stretch_greatest=high)
            own.append(Figure("spring force, least", stiffness * low, "N"))
            own.append(Figure("spring force, greatest", stiffness * high, "N"))
        wanted = self.synthesis
        asked = (wanted.weights, wanted.sines, wanted.cosines) if wanted else None
        found = self.indexing.study(self.cams, asked)
        theta = self.indexing.fine
        forces = solve(self.model, theta).forces()
        pressing = forces.pressing["contact"]
        held = np.isfinite(pressing)
        bare = peak(forces.reactions["shaft"], held)
        numbers = Figures(own) | found.numbers
        numbers |= [
            Figure("peak contact force", peak(pressing, held), "N"),
            Figure("reaction {joint} without friction", bare, "N", joint="shaft"),
        ]
        drawn = Plot(
            "Contact force",
            f"{self.indexing.angle}, deg",
            "N",
            [("rollers on cams", np.degrees(theta), pressing)],
        )
        sketches = () if self.standing else self._sketches()
        notes = [
            *found.notes,
            *(
                [_NOT_MADE]
                if self.standing and self.unloading and self.unloader_crank is None
                else []
            ),
        ]
        if self.two_cranks is not None:
            numbers |= self.two_cranks.figures
            notes.append(CHAIN + (MADE if self.standing else NOT_MADE))
        plots = Later(lambda: [*found.plots, drawn])
        tables = Later(lambda: [*found.tables, *self._compared()])
        if not self.standing:
            notes += shaft_notes(self.making, self.material.name, self.motor.model)
        return Study(numbers, plots, tables, sketches, notes)

    def _compared(self) -> Sequence[Table]:
        """The even drive beside uneven ones; nothing of a program that no chain of two turns to one of the cam serves."""
        g = self.geometry
        f = self.geometry.follower
        spans = g.rise_deg, g.dwell_deg, self.geometry.back_deg
        if driver_faults(t.Driver(crank=1.0, offset=0.1), spans):
            return []
        theta = np.linspace(0, math.tau, 1441)
        torques = self.indexing.at(theta)
        low = abs(f.pivot_distance - f.arm)
        high = f.pivot_distance + f.arm

        def program(chain: TwoCranks | None, rise: float) -> Program:
            if chain is None:
                return self.turns(self.law, rise, 180 - rise, rise)
            return self.paced(chain, False)

        def chain(share: float, rise: float) -> TwoCranks | None:
            return self.chain(1.0, share, rise) if share else None

        found = Comparison(
            program,
            self.arm,
            chain,
            g.rise_deg,
            g.base_radius,
            f.roller_radius,
            self.allowed.cam_limits.steepest(self.cams["cam"]),
            (max(1.001 * low, 1.05 * f.roller_radius), 0.999 * high),
            g.gear_ratio,
            self._speed,
            theta,
            (torques.follower_bare, torques.follower),
        )
        return [found.table(None if self.two_cranks is None else self.two_cranks.share)]

    def recovered(self, theta: Floats, motion: Mapping[str, Floats]) -> Study:
        """The driven link's turn as the files give it."""
        step = self.stepping
        ratio = self.geometry.gear_ratio
        if step is None:
            turn = {kind: ratio * float(np.ptp(s)) for kind, s in motion.items()}
        else:
            turn = {
                kind: advance(ratio * s[:: self._sense], step.lost) for kind, s in motion.items()
            }
        found = Figures(
            Figure("index recovered", math.degrees(value), "deg", kind=kind)
            for kind, value in turn.items()
        )
        return Study(found, (), [] if step is None else [step.table(turn)])

    def _sketches(self) -> Sequence[Sketch]:
        rollers = [(cam.follower.arm, cam.follower.tip_radius) for cam in self.cams.values()]
        strokes = [np.array([0j, arm]) for arm, _ in rollers]
        size = self.geometry.follower.arm / 2
        arrow = [np.array([-size + 0j, size]), np.array([0.5j * size, size, -0.5j * size])]
        table = Sketch("driven-link", arrow, [(0j, size)], LINK)
        bore = self.making.bore / 4
        pivot = complex(self.geometry.follower.pivot_distance)
        chain = () if self.two_cranks is None else self.two_cranks.sketches()
        return (
            *chain,
            Sketch("follower", strokes, rollers, "follower"),
            table,
            Sketch("ground", (), [(0j, bore), (pivot, bore)]),
        )
