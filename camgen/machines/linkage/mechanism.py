"""Any planar machine from a spec: `mechanism = "linkage"`.

    signal     one number over theta that an output gives: an angle, a place, or a coordinate of a path

theta is the driven link's angle from its drawn position; where a program moves it, the angle of the period, which is time. Of a
drive that goes to and fro the poses are asked for over a
whole period: a harmonic motion from the least angle of the range to the greatest and back.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from camgen.errors import CamgenError, DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine import model as m
from camgen.machine.features import Balance, CamOutline, Feature
from camgen.machine.forces import Forces
from camgen.machine.freewheels import Ratchet
from camgen.machine.joining import Module, joined
from camgen.machine.programs import DriveLaw
from camgen.machine.reach import refuse_folds, refuse_partial
from camgen.machine.run import Run, solve
from camgen.machine.stepwise import stays_clear
from camgen.machines import included as inc
from camgen.machines.linkage import (
    bridges,
    faults,
    figures,
    lifts,
    motors,
    pens,
    planets,
    walking,
)
from camgen.machines.linkage import springs as coils
from camgen.machines.linkage import tables as t
from camgen.machines.linkage.asked_range import refuse_range
from camgen.machines.linkage.part_names import refuse_alike
from camgen.machines.linkage.spec import LinkageSpec
from camgen.machines.linkage.weights import counterbalanced
from camgen.machines.loads.applied import efforts
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.counterweights import Counterweight, balance_of, found_moment
from camgen.machines.loads.lift_off import by_force, lift_off, restitution_of
from camgen.machines.loads.weights import gravity, with_masses
from camgen.machines.mechanism import Remarks
from camgen.machines.return_spring import SAMPLES
from camgen.parts import assembly as assemblies
from camgen.parts import materials
from camgen.parts.assembly import Assembly, Feet, FollowerFacts, Frame, MotorSeat
from camgen.parts.catalogue import CLUTCHES, Bearing, turning_text
from camgen.parts.generator import wheels
from camgen.parts.generator.beneath import Beneath
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.changes import Change
from camgen.parts.generator.coils import coils_of
from camgen.parts.generator.cures import frames
from camgen.parts.generator.joints import part_name, pivot_of
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.mounted import upper_end
from camgen.parts.generator.plates import with_battery
from camgen.parts.generator.posts import posts
from camgen.parts.generator.stacking import first_choice, lacking, with_levels
from camgen.parts.generator.table_stand import TableStand, on_stand
from camgen.parts.generator.trials import tried, with_cures
from camgen.parts.journals import journals
from camgen.parts.motors import GEARED, HOLES_UNKNOWN
from camgen.parts.part import Part
from camgen.parts.sides import PREFIX as FAR
from camgen.parts.sides import Mirror, both_sides
from camgen.parts.stiffness import bending_stiffness
from camgen.parts.turning_over import fit_turned_over
from camgen.spec import Checked, validate
from camgen.study import ROWS, Figures, Later, Study, together

_SAMPLES = np.linspace(
    0, math.tau, 1440, endpoint=False
)  # of a period, at which links are looked at for their levels


_MOST_ROUNDS = 200  # of a drive, that bring round the carrier of planets
_SHOWN_TURNS = 8  # of the drive, at most
_SWEPT_TURNS = 100  # of the drive, at most
_MARK = 0.8  # of a hub's radius, to the hole that shows how what turns on stands


class Linkage(LinkageSpec):
    """Spec and answers of a linkage; angles rad, places mm."""

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        return faults.faults(self)

    def faults_beside(self, before: Checked, changed: Collection[str]) -> Sequence[Fault]:
        """Of other lengths alone: whether links can have them."""
        assert isinstance(before, Linkage)
        return faults.faults_beside(self, before, changed)

    # ---- motion -----------------------------------------------------------------------------------------------------

    def _unloaded(self) -> m.Machine:
        """The model with its parts' masses and the play of their fits, its far side, and what is included; DesignError where no
        such parts can be made."""
        own = joined(self._fitted, {far: self._far_fitted for far in self._far_module})
        return joined(own, {each.module: each.mechanism.model for each in self.modules})

    @cached_property
    def modules(self) -> Sequence[inc.IncludedMachine]:
        """The machines of other specs, each above those before it."""
        if not self.includes:
            return ()
        bare = self._bare
        top = max(high for _, high in inc.heights(bare.parts, bare.mounts))
        play = self.print.slide_clearance
        end = upper_end(bare.layout)
        modules = inc.stack(self.includes, self.host, self.chain, top, play, end)
        inc.distinct(
            modules,
            bare.parts,
            lambda: joined(self.chain, {each.module: each.mechanism.model for each in modules}),
        )
        return modules

    @cached_property
    def _fitted(self) -> m.Machine:
        return self._weighed(self.bodies)

    def _weighed(self, bodies: Bodies) -> m.Machine:
        """The machine of some bodies with their masses and springs."""
        return self._weighed_with(bodies, self.sprung)

    def _weighed_with(self, bodies: Bodies, springs: Sequence[coils.MountedSpring]) -> m.Machine:
        machine = bodies.with_masses(self._process.density, self.masses)
        if self._beneath is not None:
            machine = self._beneath.joined(machine, self._process.density)
        pulls = (each.pull for each in springs)
        return replace(machine, loads=(*machine.loads, *self.additions.loads, *pulls))

    @property
    def closing(self) -> float:
        """What return springs press followers on their cams with at least, N or N m; inf without any."""
        pulls = {each.name: each.spring for each in self.sprung}
        found = (each.spring.closing(pulls[each.name]) for each in self._returning)
        return min(found, default=math.inf)

    @cached_property
    def sprung(self) -> Sequence[coils.MountedSpring]:
        """Springs between links, and those that return followers; DesignError where one of them cannot be made."""
        return [
            *self._hung,
            *(
                each.sprung(self.chain, 0.0 if each.spring.given else self._least_pull(each))
                for each in self._returning
            ),
        ]

    @cached_property
    def _period(self) -> Run:
        """The chain over a period, of planets until their carrier is back: what levels are found by."""
        return self.run(self.cycle.theta(_SAMPLES * self.rounds), 0)

    @cached_property
    def _hung(self) -> Sequence[coils.MountedSpring]:
        """Those of [[spring]]."""
        if not self.springs:
            return ()
        return coils.sprung(self.springs, self._period, self.making)

    @cached_property
    def _returning(self) -> Sequence[coils.Returning]:
        """Where the springs hang that return followers."""
        if not self.diagram.returns:
            return ()
        play = self.print.slide_clearance
        return coils.returning(self.diagram.machine(), self.diagram, self.making, play)

    def _least_pull(self, spring: coils.Returning) -> float:
        """What a return spring must pull with, N, by what all but such springs do."""
        contact = self._unreturned.contacts[spring.cam.name]
        return spring.spring.least_pull(spring.cam.leaves * contact)

    @cached_property
    def _unreturned(self) -> Forces:
        """Of the machine without its return springs, over the turns of its drive."""
        bodies = Bodies(with_levels(self._layout_with(self._hung), self._period))
        machine = self._weighed_with(bodies, self._hung)
        own = () if self.load is None else efforts(self.load.on, machine)
        machine = replace(machine, loads=(*machine.loads, *gravity(self.load), *own))
        return solve(machine, SAMPLES).forces()

    @cached_property
    def chain(self) -> m.Machine:
        """The model, closed as drawn; DesignError where it does not close, is loose or locked, or cannot move as asked.

        Each pin has the play of one that is pressed into one of its links.
        """
        chain = self.diagram.machine()
        for spring in self._returning:
            chain = spring.on(chain)
        if len(self.drives) > 1:
            return (
                motors.driven(chain, self.drives) if self.pen is None else pens.led(chain, self.pen)
            )
        law: m.Law | None
        program = self.drive.program()
        if program is None:
            law = None
            reach = None if self.drive.range_deg is None else self.cycle.range
        else:
            law = DriveLaw(program, chain.start[self.drive.link].angle)
            reach = law.reach
        clear = stays_clear(chain, *(reach or (0.0, math.tau)))
        if reach is not None:
            refuse_range(chain, self.drive, *reach)
        elif not clear:
            refuse_partial(chain, self.allowed.transmission_angle_deg)
        if not clear:
            refuse_folds(chain, *(reach or (0.0, math.tau)))
        law = self.additions.drive or law
        if law is not None:
            drive, *held = chain.drives
            chain = replace(chain, drives=(replace(drive, law=law), *held))
        return self.diagram.released(chain)

    @cached_property
    def _whole(self) -> m.Machine:
        own = joined(self.chain, dict.fromkeys(self._far_module, self.chain))
        return joined(own, {each.module: each.mechanism.model for each in self.modules})

    def run(self, theta: ArrayLike, order: int = 2) -> Run:
        """The chain of this spec alone at theta, (n,) rad."""
        return solve(self.chain, theta, order)

    @cached_property
    def _moving(self) -> figures.LinkageMotion:
        """It without what is included, as figures see it."""
        even = not self.programmed
        springs = bool(self.springs or self._returning)
        return figures.LinkageMotion(
            self.chain, self.cycle, [each.link for each in self.drives], self.wanted, even, springs
        )

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """The first signal over a period, rad or mm; its derivatives are to theta."""
        found: Floats = self._moving.signals[0].rows(
            self.run(self.cycle.theta(np.asarray(theta, float)), order)
        )[order]
        return found

    # ---- bodies -----------------------------------------------------------------------------------------------------

    @cached_property
    def bodies(self) -> Bodies:
        """What is made of it, and what holds machines that stand on it."""
        stands = tuple(each.stand for each in self.modules if each.stand is not None)
        return (
            Bodies(replace(self._bare.layout, stands=stands), self._bare.weight, self._bare.under)
            if stands
            else self._bare
        )

    @cached_property
    def assembly(self) -> Assembly:
        """Ground plate, links, pins, spacers, shaft and collar, and what is included; DesignError where there are joints of
        which no bodies are made."""
        own = self._made_of(self.bodies, self.model)
        if self._far_bodies is not None:
            far = self._made_of(self._far_bodies, self._far_fitted)
            own = replace(both_sides(own, far, self._mirror, self.model), feet=self._feet)
        whole = assemblies.joined(own, [each.assembly for each in self.modules], self.model)
        name = self._angle_name(any(isinstance(each, CamOutline) for each in whole.features))
        swept = self.rounds if self.rounds <= _SWEPT_TURNS else 1
        cycle = replace(self.cycle, name=name, turns=self.turns, swept=swept)
        whole = replace(whole, cycle=cycle)
        if self.making.stand == "none":
            return whole
        sizes = self.bodies.sizes
        kind = self.making.stand
        return on_stand(
            TableStand(whole, kind, sizes, self.print, self.allowed.min_wall, -self._down)
        )

    def _angle_name(self, cams: bool) -> str:
        """What theta is called; cams: whether any are made."""
        if isinstance(self.drive, t.SlidingDrive):
            return "travel of the drive"
        if self.drive.range_deg is not None or self.programmed:
            return "drive angle"
        return "cam angle" if cams else "crank angle"

    @property
    def _feet(self) -> Feet:
        """What a machine of two sides walks on."""
        soled = (name for name, shape in self.making.shapes.items() if shape.sole_diameter)
        near = [part_name(link) for link in soled if link in self.links]
        far = [module.part(part) for module in self._far_module for part in near]
        return Feet((self._down.real, self._down.imag, 0.0), frozenset([*near, *far]))

    @property
    def _down(self) -> complex:
        """Where gravity points, a unit complex."""
        deg = None if self.load is None else self.load.gravity_deg
        return -1j if deg is None else cmath.exp(1j * math.radians(deg))

    @cached_property
    def rounds(self) -> int:
        """Turns of the drive that bring round carriers and rings of planets, and cycloidal discs; 1 where none are known."""
        moving = [link for row in self.planets for link in (row.carrier, row.ring) if link]
        moving += [row.disc for row in self.cycloids]
        rates = [rate for link in moving if (rate := self.diagram.turns_of(link)) is not None]
        return math.lcm(
            *(Fraction(rate).limit_denominator(_MOST_ROUNDS).denominator for rate in rates)
        )

    @property
    def turns(self) -> int:
        """Of the drive, that bring round what turns on by freewheels, or with planets; 1 where eight do not."""
        if 1 < self.rounds <= _SHOWN_TURNS:
            return self.rounds
        laws = [each.law for each in self.chain.joints if isinstance(each, m.Clutch)]
        steps = [law.advance / math.tau for law in laws if isinstance(law, Ratchet)]
        whole = (
            n
            for n in range(1, _SHOWN_TURNS + 1)
            if all(abs(n * s - round(n * s)) < 1e-9 for s in steps)
        )
        return next(whole, 1)

    # ---- the far side -----------------------------------------------------------------------------------------------

    @cached_property
    def _far_bodies(self) -> Bodies | None:
        """The far side before it is reflected: the same on the same levels, without what drives; None where there is none."""
        if self.making.sides == 1:
            return None
        near = self.bodies.layout
        return Bodies(with_battery(replace(near, sizes=near.sizes.driven_by_shaft)))

    @cached_property
    def _far_fitted(self) -> m.Machine:
        """The far side's model with its masses, in step with the near one's."""
        assert self._far_bodies is not None, "asked for with two sides alone"
        return self._weighed(self._far_bodies)

    @property
    def _far_module(self) -> Sequence[Module]:
        """How the far side stands in the whole, if there is one."""
        phase = math.radians(self.making.side_phase_deg)
        return () if self.making.sides == 1 else (Module(FAR, phase=phase),)

    @property
    def _mirror(self) -> Mirror:
        """Half-way between both second plates; DesignError where no shaft gets there."""
        end = upper_end(self.bodies.layout)
        assert end is not None, "a fault of the spec"
        if end.axis is None:
            raise DesignError(
                "shafts in the second plate",
                0,
                1,
                "",
                f"link {self.drive.link}",
                'set parts.shaft = "interrupted": its upper end goes on into the far side',
            )
        phase = math.radians(self.making.side_phase_deg)
        gap = self.making.side_gap
        return Mirror(end.top + gap / 2, end.shaft, phase, gap)

    def _made_of(self, bodies: Bodies, machine: m.Machine) -> Assembly:
        """What is made without what is included; machine: its model."""
        plastic = self.material.name
        sizes = bodies.sizes
        features = bodies.features()
        frame = sizes.motor if sizes.can is None else ""
        motor = (
            MotorSeat(crank=sizes.hand_crank)
            if sizes.face is None
            else MotorSeat(frame, bodies.shaft_reach, bodies.collar)
        )
        feet = len(bodies.layout.feet)
        ends = bodies.parts[0].centres[-sizes.mount_screws - feet :]
        screws = () if bodies.layout.hangs else ends[: sizes.mount_screws]
        fixings = tuple((z, sizes.mount_diameter) for z in screws)
        sprung = [each.bought(sizes.pin_diameter) for each in self.sprung]
        ways = {each.name: each.way(sizes.pin_diameter) for each in self.sprung}
        made = Assembly(
            machine,
            self._engraved(bodies.parts, features),
            self._process,
            self.cycle,
            bodies.mounts,
            features,
            demands=figures.demands(self._moving, self.allowed),
            stand_ins=bodies.stand_ins(),
            strands=bodies.strands(),
            balances=()
            if self.counterweight is None
            else (self._balance(self.counterweight, bodies),),
            coils=coils_of(bodies.layout, bodies.parts, bodies.mounts, ways=ways),
            bought=[*bodies.bought(self._driving_text), *sprung, *lifts.bought(self._moving)],
            springs=coils.mounted(self.sprung, by_force(self.chain), sizes.pin_diameter),
            journals=journals(machine, features, bodies.parts, bodies.mounts, plastic),
            posts=tuple(
                posts(bodies, {each.name: each.forces()[1] for each in self.sprung}, plastic)
            ),
            frame=Frame(bodies.parts[0].name, fixings),
            motor=motor,
            shaft=bodies.shaft,
            board=bodies.stands,
            material_limits=self._material_limits,
            unjudged=Later(lambda: [*self._unswept, *self._pressed.not_judged]),
            texts={"chain.svg": bridges.svg(self.chain), "chain.pmks": bridges.pmks(self.chain)},
            follower=FollowerFacts(self._arm_stiffness),
        )
        return made if self._beneath is None else self._beneath.added(made)

    @property
    def _driving_text(self) -> str:
        """What its drive is to do, in words."""
        drive = self.drive
        if isinstance(drive, t.Drive):
            turning = turning_text(drive.speed_rpm)
            model = self.motor.model if self.motor else None
            if model is None or model.lower() == self.making.motor or self.making.hand_crank:
                return turning
            return ", ".join((f"{model} ({HOLES_UNKNOWN})" if model in GEARED else model, turning))
        low, high = drive.range
        return f"linear, {high - low:g} mm at {drive.speed:g} mm/s, on link {drive.link}"

    @property
    def _unswept(self) -> Iterator[NotJudged]:
        """What the sweep leaves out of carriers that come round after many turns alone."""
        if self.rounds > _SWEPT_TURNS:
            why = f"bodies are moved over one turn of {self.rounds}, after which all are back"
            yield NotJudged("INTERFERENCE", why, f"a ratio of at most {_SWEPT_TURNS} whole turns")

    def _engraved(self, parts: Sequence[Part], features: Sequence[Feature]) -> Sequence[Part]:
        """Parts with what is engraved in them: a text in a link, letters of holes in what has named points, and what says the
        upper side of a cam or wheel that fits turned over as well; of sheet only where engraving is cut too.
        """
        texts = {
            part_name(link): (shape.engrave, f"parts.{link}.engrave")
            for link in self.diagram.links
            if (shape := self.making.shape(link)).engrave
        }
        letters = bool(self.files.hole_letters)
        reversible = set(fit_turned_over(parts, features))
        if not (texts or letters or reversible):
            return parts
        from camgen.parts.engraving import engraved, with_upper_side

        engraves = self.files.engrave or not self.making.of_sheet
        mark = self.files.up_marks and engraves and self.making.sides == 1
        lettered = (engraved(part, letters, *texts.get(part.name, ())) for part in parts)
        return [
            with_upper_side(part, mark) if part.name in reversible else part for part in lettered
        ]

    @property
    def _arm_stiffness(self) -> float | None:
        """Of the follower that swings on the one cam of the machine, N m/rad; None of another, or where there are several."""
        swinging = [cam for cam in self.cams if self.diagram.slide_of(cam.follower) is None]
        if len(self.cams) != 1 or not swinging:
            return None
        (cam,) = swinging
        points = self.bodies.layout.points_of(cam.follower)
        pivot = self.diagram.pivot(cam.follower) or ""
        if not {pivot, cam.at} <= points.keys():
            return None
        name = part_name(cam.follower)
        arm = next(part for part in self.bodies.parts if part.name == name)
        held = points[pivot]
        pushed = points[cam.at]
        modulus = materials.of(self.material.name).elastic.modulus
        return bending_stiffness(arm, held, pushed, modulus) * abs(pushed - held) ** 2 * 1e-3

    def _balance(self, weight: Counterweight, made: Bodies) -> Balance:
        """What the solids of the driven link with its counterweight are held to."""
        link = self.drive.link
        whole = self._balanced[1]
        origin = made.layout.at(link, made.layout.shaft_of(link))
        pivot = pivot_of(made.layout, link)
        solids = made.solids(self._process.density)
        return balance_of(link, pivot, origin, whole - weight.other, solids)

    @cached_property
    def _bare(self) -> Bodies:
        """What is made of it alone; levels that [layers] leaves open are found."""
        unmade = lacking(self._layout)
        if unmade is not None:
            raise unmade
        bodies = self._balanced[0]
        refuse_alike(bodies.parts, self.diagram.links, self.making.discs or ())
        return bodies

    @cached_property
    def _balanced(self) -> tuple[Bodies, complex]:
        """The bodies, and the moment that all that turns with a balanced crank is to have, complex g mm; DesignError with what
        mends it, where a change is found that does."""
        try:
            assert self._laid[0].parts
        except DesignError as refused:
            raise with_cures(refused, self._layout, self._period, self._parts_with) from None
        return self._laid

    def _parts_with(self, change: Change) -> Sequence[Part]:
        """Those of the spec so changed, see `_with`."""
        return self._with(change).assembly.parts

    def _with(self, change: Change) -> Self:
        """The spec so changed, on the same chain, its parts made by no further cures; DesignError or SpecError where it has none."""
        other = validate(
            type(self), change.tables(self.model_dump(by_alias=True, exclude_none=True))
        )
        vars(other).update(chain=self.chain, additions=self.additions)
        vars(other)["_balanced"] = other._laid
        assert other.assembly.parts
        return other

    def on_a_frame(self) -> tuple[Self, Change]:
        """The spec as it is, or with the first other plates and shaft that it leaves open by which it has parts, and that change.

        DesignError where there is none: that of the spec as it is, with what was tried.
        """
        layout = self._layout
        as_it_is = Change("")
        others = frames(self.making, layout.driven not in layout.slides)
        refused: CamgenError | None = None
        for change in (as_it_is, *others):
            try:
                return self._with(change), change
            except (DesignError, SpecError) as error:
                refused = refused or error
        assert refused is not None
        raise tried(refused, layout, others)

    @cached_property
    def _laid(self) -> tuple[Bodies, complex]:
        run = self._period
        if self.counterweight is None:
            return Bodies(with_levels(self._layout, run)), 0j
        return counterbalanced(
            self.counterweight, self._layout, run, self._process.density, self._weighed
        )

    @property
    def _layout(self) -> Layout:
        return self._layout_with(self.sprung)

    def _layout_with(self, springs: Sequence[coils.MountedSpring]) -> Layout:
        """What is over the plate, with these springs."""
        whole = self._whole_layout(springs)
        if self._beneath is None:
            return whole
        return replace(self._beneath.above, springs=whole.springs)

    @cached_property
    def _beneath(self) -> Beneath | None:
        """What hangs under the plate."""
        arm = self.additions.beneath
        if arm is None:
            return None
        run = self._period
        return Beneath(self._whole_layout(()), arm, run)

    def _whole_layout(self, springs: Sequence[coils.MountedSpring]) -> Layout:
        cams = self.diagram.ridden
        gears = {gear.joint: gear.wish for gear in self.gears}
        sets = tuple(planets.wish(row) for row in self.planets)
        return Layout(
            self.chain,
            self.drive.link,
            self.making,
            self.print,
            self.allowed.min_wall,
            self.layers,
            {},
            cams,
            gears,
            genevas=self.diagram.named_genevas,
            noncirculars=self.diagram.noncircular_pairs,
            mutilated=self.diagram.mutilated_laws,
            ratchets=self.diagram.ratchet_wishes,
            planets=sets,
            cycloids=self.diagram.cycloid_wishes,
            springs={each.name: each.stretched for each in springs},
            freewheels={each.wheel: (each.link, self._clutch) for each in self.freewheels},
            marks={
                each.link: complex(_MARK * hub / 2)
                for each in self.freewheels
                if (hub := self.making.shape(each.link).hub_diameter)
            },
            further=tuple(each.link for each in self.drives[1:]),
            keep_outs=inc.clearings(self.includes, lambda: self.host),
            fitting=self.additions.fitting,
            drawn_poses=self.diagram.drawn_poses,
        )

    @property
    def _clutch(self) -> Bearing:
        """In wheel and plate, of each freewheel."""
        return CLUTCHES[self.making.shaft_diameter][0]

    @cached_property
    def sketched(self) -> Layout:
        """Before levels: with the strokes of its slots and slides, and the first choice of their stems."""
        return first_choice(self._layout, self._period)

    def _found(self) -> Mapping[str, object]:
        """Levels, bows, the included specs and where they stand, and what every mechanism fills in."""
        levels: dict[str, object] = {
            f"layers.{link}": level for link, level in self.bodies.layout.given.items()
        }
        weight = {} if self.counterweight is None else found_moment(self._balanced[1])
        tables = [inc.resolved_table(each) for each in self.modules]
        sizes = self.bodies.layout.sizes
        bases = self.diagram.bases
        levels |= {
            f"cam.{k}.base_radius": bases[name]
            for k, name in enumerate(self.diagram.named_cams)
            if name in bases
        }
        if sizes != self.making:  # a link is bent
            levels["parts"] = sizes.model_dump(by_alias=True, exclude_none=True)
        return {**super()._found(), **levels, **weight, **({"include": tables} if tables else {})}

    def resolved(self) -> Self:
        """The same with its levels, on the same chain."""
        found = super().resolved()
        # cached: nothing that they depend on was filled in
        same = vars(self).keys() & {
            "chain",
            "additions",
            "bodies",
            "_bare",
            "_balanced",
            "_laid",
            "modules",
            "sprung",
        }
        found.__dict__.update({name: vars(self)[name] for name in same})
        return found

    def limits(self) -> Sequence[Finding]:
        """Targets by the model as designed, and how near each loop comes to a fold."""
        least = self.allowed.transmission_angle_deg
        found = [
            *figures.targets(self._moving),
            *figures.transmission_angles(self._moving, least),
            *(() if self.pen is None else pens.stretches(self.chain, self.pen, least)),
            *wheels.limits(self._layout.tips),
            *wheels.plate_limits(self._layout.plates),
        ]
        return [*found, *self._pressed.findings, *self._included_limits]

    def limits_of(self, code: str) -> Sequence[Finding]:
        """Those of one code; of LIFT_OFF without the profiles of cams, which take longer."""
        if code != "LIFT_OFF":
            return super().limits_of(code)
        found = (*self._pressed.findings, *self._included_limits)
        return [finding for finding in found if finding.code == code]

    @property
    def _included_limits(self) -> Sequence[Finding]:
        return [finding for each in self.modules for finding in inc.limits(each, self.chain)]

    @cached_property
    def _pressed(self) -> LoadCheck:
        """What holds its own cams' followers; those of what is included are judged there."""
        cams = by_force(self.chain)
        if not cams or lacking(self._layout) is not None:
            return LoadCheck()
        theta = np.linspace(*self.cycle.range, len(_SAMPLES) + 1)
        kicks = self.diagram.kicks()
        bounces = restitution_of(self.load)
        found = lift_off(self._pulled, cams, kicks, theta, self._angle_name(True), bounces)
        unit = self.cycle.unit
        told = [replace(each, where=replace(each.where, unit=unit)) for each in found.findings]
        return replace(found, findings=told)

    def remarks(self) -> Remarks:
        """Followers that stand elsewhere than drawn, and how many links are closed together on what each kind of file shows."""
        return Remarks(links=len(self.diagram.links), warnings=self.diagram.shifted())

    def study(self) -> Study:
        """Outputs, curves and paths, the class of a four-bar; those of what is included; all outputs over one turn."""
        own = figures.study(self._moving, self._made, lambda: self.assembly.cycle.label)
        if self._pressed.figures:
            own = together([own, Study(Figures(self._pressed.figures))])
        if self.walk is not None:
            own = together([own, self._walk(self.walk)])
        if (pen := self.pen) is not None:
            own = together([own, Study(plots=Later(lambda: [pens.reach_of(self.chain, pen)]))])
        if not self.includes:
            return own
        whole = self.solve(np.linspace(*self.cycle.range, ROWS), 0)
        timing = figures.timing(whole, self.drive.link)
        return together([own, *map(inc.study, self.modules), timing])

    def _walk(self, walk: t.Walk) -> Study:
        """How it walks if it goes slowly, on the feet of both sides."""
        solids = self.assembly.solids
        machine = with_masses(self.assembly.exact, solids, self.load).machine
        far = {f"{FAR}_{foot}" for foot in walk.feet}
        feet = [*walk.feet, *(each.name for each in machine.outputs if each.name in far)]
        return walking.study(machine, solids, walk, feet, self._down)

    @property
    def _made(self) -> figures.Build | None:
        """What is made; None where there are joints of which no bodies are made."""
        if lacking(self._layout) is not None:
            return None
        machine = replace(self.model, loads=(*self.model.loads, *gravity(self.load)))
        return figures.Build(self.bodies.layout, machine, self.sprung, self.slots)
