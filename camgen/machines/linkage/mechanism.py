"""Any planar machine from a spec: `mechanism = "linkage"`.

    signal     one number over theta that an output gives: an angle, a place, or a coordinate of a path

theta is the driven link's angle from its drawn position; where a program moves it, the angle of the period, which is time. Of a
drive that goes to and fro the poses are asked for over a
whole period: a harmonic motion from the least angle of the range to the greatest and back.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from camgen.errors import CamgenError, DesignError, Fault, SpecError
from camgen.findings import Finding, NotJudged
from camgen.geometry.outlines import Floats
from camgen.machine import model as m
from camgen.machine.features import CamOutline, Demand
from camgen.machine.freewheels import Ratchet
from camgen.machine.joining import Module, joined
from camgen.machine.run import Run, solve
from camgen.machines import included as inc
from camgen.machines.linkage import (
    bridges,
    faults,
    figures,
    lifts,
    pens,
    walking,
)
from camgen.machines.linkage import springs as coils
from camgen.machines.linkage.assembling import (
    arm_stiffness,
    balance,
    driving_text,
    mirror,
    supply_volts,
    with_engraving,
    with_letters,
)
from camgen.machines.linkage.construction import Construction, closed
from camgen.machines.linkage.spec import LinkageSpec
from camgen.machines.loads.bearing import LoadCheck
from camgen.machines.loads.counterweights import found_moment
from camgen.machines.loads.lift_off import by_force, lift_off, reserves, restitution_of
from camgen.machines.loads.weights import PULL, Masses, gravity, with_masses
from camgen.machines.mechanism import Remarks
from camgen.parts import assembly as assemblies
from camgen.parts.assembly import Assembly, Feet, FollowerFacts, Frame, MotorSeat
from camgen.parts.generator import wheels
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.changes import Change
from camgen.parts.generator.coils import coils_of
from camgen.parts.generator.cures import frames
from camgen.parts.generator.joints import part_name
from camgen.parts.generator.mounted import upper_end
from camgen.parts.generator.plates import with_battery
from camgen.parts.generator.posts import posts
from camgen.parts.generator.stacking import lacking
from camgen.parts.generator.table_stand import TableStand, on_stand
from camgen.parts.generator.trials import tried
from camgen.parts.journals import journals
from camgen.parts.motor_shafts import with_shaft_limit
from camgen.parts.sides import PREFIX as FAR
from camgen.parts.sides import both_sides
from camgen.spec import Checked, validate
from camgen.study import ROWS, Figures, Later, Study, together

_SHOWN_TURNS = 8  # of the drive, at most
_SWEPT_TURNS = 100  # of the drive, at most


class Linkage(LinkageSpec):
    """Spec and answers of a linkage; angles rad, places mm."""

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        return faults.faults(self)

    def faults_beside(self, before: Checked, changed: Collection[str]) -> Sequence[Fault]:
        """Of other lengths alone: whether links can have them."""
        assert isinstance(before, Linkage)
        return faults.faults_beside(self, before, changed)

    @cached_property
    def chain(self) -> m.Machine:
        """The model, closed as drawn; DesignError where it does not close, is loose or locked, or cannot move as asked."""
        return closed(self)

    @cached_property
    def construction(self) -> Construction:
        """How it is made."""
        return Construction(self, self.chain, lambda change: self._with(change).assembly.parts)

    # ---- motion -----------------------------------------------------------------------------------------------------

    def _unloaded(self) -> m.Machine:
        """The model with its parts' masses and the play of their fits, its far side, and what is included; DesignError where no
        such parts can be made."""
        own = self.construction.weighed(self.bodies)
        if self._far is not None:
            own = joined(own, dict.fromkeys(self._far_modules, self._far[1]))
        return joined(own, {each.module: each.mechanism.model for each in self.modules})

    @cached_property
    def modules(self) -> Sequence[inc.IncludedMachine]:
        """The machines of other specs, each above those before it."""
        if not self.includes:
            return ()
        bare = self.construction.bare
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
    def _whole(self) -> m.Machine:
        own = joined(self.chain, dict.fromkeys(self._far_modules, self.chain))
        return joined(own, {each.module: each.mechanism.model for each in self.modules})

    def run(self, theta: ArrayLike, order: int = 2) -> Run:
        """The chain of this spec alone at theta, (n,) rad."""
        return solve(self.chain, theta, order)

    @cached_property
    def _moving(self) -> figures.LinkageMotion:
        """It without what is included, as figures see it."""
        even = not self.programmed
        springs = bool(self.springs or self.returning)
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
        bare = self.construction.bare
        if not stands:
            return bare
        return Bodies(replace(bare.layout, stands=stands), bare.weight, bare.under)

    @cached_property
    def assembly(self) -> Assembly:
        """Ground plate, links, pins, spacers, shaft and collar, and what is included; DesignError where there are joints of
        which no bodies are made."""
        own = self._made_of(self.bodies, self.model)
        if self._far is not None:
            far = self._made_of(*self._far)
            between = mirror(self.bodies.layout)
            own = replace(both_sides(own, far, between, self.model), feet=self._feet)
        own = replace(own, parts=with_letters(self, own.parts))
        whole = assemblies.joined(own, [each.assembly for each in self.modules], self.model)
        name = self.angle_name(any(isinstance(each, CamOutline) for each in whole.features))
        swept = self.rounds if self.rounds <= _SWEPT_TURNS else 1
        cycle = replace(self.cycle, name=name, turns=self.turns, swept=swept)
        whole = replace(whole, cycle=cycle)
        if self.making.stand == "none":
            return whole
        sizes = self.bodies.sizes
        kind = self.making.stand
        return on_stand(
            TableStand(whole, kind, sizes, self.print, self.allowed.min_wall, -self.down)
        )

    @property
    def _far_modules(self) -> Sequence[Module]:
        """How the far side stands in the whole, if there is one."""
        phase = math.radians(self.making.side_phase_deg)
        return () if self.making.sides == 1 else (Module(FAR, phase=phase),)

    @cached_property
    def _far(self) -> tuple[Bodies, m.Machine] | None:
        """The far side before it is reflected, on the same levels without what drives, and its model with masses; None of one side."""
        if self.making.sides == 1:
            return None
        near = self.bodies.layout
        bodies = Bodies(with_battery(replace(near, sizes=near.sizes.driven_by_shaft)))
        return bodies, self.construction.weighed(bodies)

    @property
    def _feet(self) -> Feet:
        """What a machine of two sides walks on."""
        soled = (name for name, shape in self.making.shapes.items() if shape.sole_diameter)
        near = [part_name(link) for link in soled if link in self.links]
        far = [module.part(part) for module in self._far_modules for part in near]
        return Feet((self.down.real, self.down.imag, 0.0), frozenset([*near, *far]))

    @cached_property
    def _demands(self) -> Sequence[Demand]:
        """What is asked of the outputs of one side."""
        return figures.demands(self._moving, self.allowed)

    def _made_of(self, bodies: Bodies, machine: m.Machine) -> Assembly:
        """What is made without what is included; machine: its model."""
        plastic = self.material.name
        sizes = bodies.sizes
        construction = self.construction
        springs = construction.springs
        weight = self.counterweight
        features = bodies.features()
        frame = sizes.motor if sizes.can is None else ""
        motor = (
            MotorSeat(crank=sizes.hand_crank)
            if sizes.face is None
            else MotorSeat(frame, bodies.shaft_reach, bodies.collar, shaft=sizes.shaft_diameter)
        )
        motor = replace(motor, flats=tuple(bodies.flat_seats()))
        feet = len(bodies.layout.feet)
        ends = bodies.parts[0].centres[-sizes.mount_screws - feet :]
        screws = ends[: sizes.mount_screws] if bodies.layout.screwed else ()
        fixings = tuple((z, sizes.mount_diameter) for z in screws)
        sprung = [each.bought(sizes.pin_diameter) for each in springs]
        ways = {each.name: each.way(sizes.pin_diameter) for each in springs}
        made = Assembly(
            machine,
            with_engraving(self, bodies, features),
            self._process,
            self.cycle,
            bodies.mounts,
            features,
            demands=self._demands,
            stand_ins=bodies.stand_ins(),
            strands=bodies.strands(),
            balances=()
            if weight is None
            else (balance(weight, construction.balanced[1], bodies, self._process.density),),
            coils=coils_of(bodies.layout, bodies.parts, bodies.mounts, ways=ways),
            bought=[
                *bodies.bought(driving_text(self), supply_volts(self)),
                *sprung,
                *lifts.bought(self._moving),
            ],
            springs=coils.mounted(springs, by_force(self.chain), sizes.pin_diameter),
            journals=journals(machine, features, bodies.parts, bodies.mounts, plastic),
            posts=tuple(posts(bodies, {each.name: each.forces()[1] for each in springs}, plastic)),
            frame=Frame(bodies.parts[0].name, fixings),
            motor=motor,
            shaft=bodies.shaft,
            board=bodies.stands,
            material_limits=self._material_limits,
            unjudged=Later(lambda: [*self._unswept, *self._pressed.not_judged]),
            texts={"chain.svg": bridges.svg(self.chain), "chain.pmks": bridges.pmks(self.chain)},
            follower=FollowerFacts(arm_stiffness(self, bodies)),
        )
        made = with_shaft_limit(made, bodies.layout.fits.slide_clearance)
        beneath = construction.beneath
        return made if beneath is None else beneath.added(made)

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

    @property
    def _unswept(self) -> Iterator[NotJudged]:
        """What the sweep leaves out of carriers that come round after many turns alone."""
        if self.rounds > _SWEPT_TURNS:
            why = f"bodies are moved over one turn of {self.rounds}, after which all are back"
            yield NotJudged("INTERFERENCE", why, f"a ratio of at most {_SWEPT_TURNS} whole turns")

    def _with(self, change: Change) -> Self:
        """The spec so changed, on the same chain, its parts made by no further cures; DesignError or SpecError where it has none."""
        other = validate(
            type(self), change.tables(self.model_dump(by_alias=True, exclude_none=True))
        )
        vars(other).update(chain=self.chain, additions=self.additions)
        vars(other)["construction"] = Construction(other, self.chain)
        assert other.assembly.parts
        return other

    def on_a_frame(self) -> tuple[Self, Change]:
        """The spec as it is, or with the first other plates and shaft that it leaves open by which it has parts, and that change.

        DesignError where there is none: that of the spec as it is, with what was tried.
        """
        layout = self.construction.layout
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

    def _found(self) -> Mapping[str, object]:
        """Levels, bows, the included specs and where they stand, and what every mechanism fills in."""
        levels: dict[str, object] = {
            f"layers.{link}": level for link, level in self.bodies.layout.given.items()
        }
        weight = {} if self.counterweight is None else found_moment(self.construction.balanced[1])
        tables = [inc.resolved_table(each) for each in self.modules]
        sizes = self.bodies.layout.sizes
        bases = self.drawn.bases
        levels |= {
            f"cam.{k}.base_radius": bases[name]
            for k, name in enumerate(self.diagram.named_cams)
            if name in bases
        }
        if sizes != self.making:  # a link is bent
            levels["parts"] = sizes.model_dump(by_alias=True, exclude_none=True)
        return {**super()._found(), **levels, **weight, **({"include": tables} if tables else {})}

    def resolved(self) -> Self:
        """The spec with the levels that camgen finds, on the same chain."""
        found = super().resolved()
        # cached: nothing that they depend on was filled in
        same = vars(self).keys() & {"chain", "additions", "construction", "bodies", "modules"}
        found.__dict__.update({name: vars(self)[name] for name in same})
        return found

    def limits(self) -> Sequence[Finding]:
        """Targets by the model as designed, and how near each loop comes to a fold."""
        least = self.allowed.transmission_angle_deg
        found = [
            *figures.targets(self._moving),
            *figures.transmission_angles(self._moving, least),
            *(() if self.pen is None else pens.stretches(self.chain, self.pen, least)),
            *wheels.limits(self.construction.layout.tips),
            *wheels.plate_limits(self.construction.layout.plates),
        ]
        return [*found, *self._pressed.findings, *self._included_limits]

    def limits_of(self, code: str) -> Sequence[Finding]:
        """Design checks of one code; of LIFT_OFF without the profiles of cams, which take longer."""
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
        if not cams or lacking(self.construction.layout) is not None:
            return LoadCheck()
        theta = np.linspace(*self.cycle.range, ROWS)
        kicks = self.diagram.kicks()
        bounces = restitution_of(self.load)
        angle = self.angle_name(True)
        found = lift_off(self._pulled, cams, kicks, theta, angle, bounces)
        left = reserves(self._pulled, cams, theta, angle, self.allowed.reserve(self.material.name))
        unit = self.cycle.unit
        told = [
            replace(each, where=replace(each.where, unit=unit)) for each in (*found.findings, *left)
        ]
        return replace(found, findings=told)

    def remarks(self) -> Remarks:
        """Followers that stand elsewhere than drawn, and how many links are closed together on what each kind of file shows."""
        return Remarks(links=len(self.diagram.links), warnings=self.drawn.shifted())

    def study(self) -> Study:
        """Outputs, curves and paths, the class of a four-bar; those of what is included; all outputs over one turn."""
        own = figures.study(self._moving, self._made, lambda: self.assembly.cycle.label)
        if self._pressed.figures:
            own = together([own, Study(Figures(self._pressed.figures))])
        if self.walk is not None:
            own = together([own, walking.study(self._standing)])
        if (pen := self.pen) is not None:
            own = together([own, Study(plots=Later(lambda: [pens.reach_of(self.chain, pen)]))])
        if not self.includes:
            return own
        whole = self.solve(np.linspace(*self.cycle.range, ROWS), 0)
        timing = figures.timing(whole, self.drive.link)
        return together([own, *map(inc.study, self.modules), timing])

    @cached_property
    def _standing(self) -> walking.Standing | None:
        """How it stands on the feet of both sides, if it walks."""
        if self.walk is None:
            return None
        solids = self.assembly.solids
        machine = with_masses(self.assembly.exact, solids, self.load).machine
        far = {f"{FAR}_{foot}" for foot in self.walk.feet}
        feet = [*self.walk.feet, *(each.name for each in machine.outputs if each.name in far)]
        return walking.standing(machine, solids, self.walk, feet, self.down)

    def weighed(self, model: m.Machine) -> Masses:
        """The model with its masses; one that walks has its weight too, and stands on the floor."""
        masses = super().weighed(model)
        floor = () if self._standing is None else self._standing.floor
        if not floor:
            return masses
        weight = () if gravity(self.load) else (m.Gravity(PULL * self.down),)
        machine = replace(masses.machine, loads=(*masses.machine.loads, *weight, *floor))
        return replace(masses, machine=machine)

    @property
    def _made(self) -> figures.Build | None:
        """What is made; None where there are joints of which no bodies are made."""
        if lacking(self.construction.layout) is not None:
            return None
        machine = replace(self.model, loads=(*self.model.loads, *gravity(self.load)))
        return figures.Build(self.bodies.layout, machine, self.construction.springs, self.slots)
