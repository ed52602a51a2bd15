"""How a linkage is closed and made: its chain, its springs, its levels, and the bodies of its parts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.errors import DesignError
from camgen.machine import model as m
from camgen.machine.forces import Forces
from camgen.machine.programs import DriveLaw
from camgen.machine.reach import refuse_folds, refuse_partial
from camgen.machine.run import Run, solve
from camgen.machine.stepwise import stays_clear
from camgen.machines import included as inc
from camgen.machines.linkage import (
    motors,
    pens,
    planets,
)
from camgen.machines.linkage import springs as coils
from camgen.machines.linkage.asked_range import refuse_range
from camgen.machines.linkage.part_names import refuse_alike
from camgen.machines.linkage.spec import LinkageSpec
from camgen.machines.linkage.weights import counterbalanced
from camgen.machines.loads.applied import efforts
from camgen.machines.loads.weights import gravity
from camgen.machines.return_spring import SAMPLES
from camgen.parts import materials
from camgen.parts.catalogue import CLUTCHES
from camgen.parts.generator.beneath import Beneath
from camgen.parts.generator.bodies import Bodies
from camgen.parts.generator.changes import Change
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.stacking import first_choice, lacking, with_levels
from camgen.parts.generator.trials import with_cures
from camgen.parts.inertia import printed_density
from camgen.parts.part import Part

_SAMPLES = np.linspace(
    0, math.tau, 1440, endpoint=False
)  # of a period, at which links are looked at for their levels
_MARK = 0.8  # of a hub's radius, to the hole that shows how what turns on stands


def closed(spec: LinkageSpec) -> m.Machine:
    """The model, closed as drawn; DesignError where it does not close, is loose or locked, or cannot move as asked.

    Each pin has the play of one that is pressed into one of its links.
    """
    chain = spec.drawn.closed()
    for spring in spec.returning:
        chain = spring.on(chain)
    if len(spec.drives) > 1:
        return motors.driven(chain, spec.drives) if spec.pen is None else pens.led(chain, spec.pen)
    law: m.Law | None
    program = spec.drive.program()
    if program is None:
        law = None
        reach = None if spec.drive.range_deg is None else spec.cycle.range
    else:
        law = DriveLaw(program, chain.start[spec.drive.link].angle)
        reach = law.reach
    clear = stays_clear(chain, *(reach or (0.0, math.tau)))
    if reach is not None:
        refuse_range(chain, spec.drive, *reach)
    elif not clear:
        refuse_partial(chain, spec.allowed.transmission_angle_deg)
    if not clear:
        refuse_folds(chain, *(reach or (0.0, math.tau)))
    law = spec.additions.drive or law
    if law is not None:
        drive, *held = chain.drives
        chain = replace(chain, drives=(replace(drive, law=law), *held))
    return spec.drawn.released(chain)


@dataclass(frozen=True)
class Construction:
    """A linkage's chain, closed as drawn, and what is made of it over and under its plate; no machine that it includes."""

    spec: LinkageSpec
    chain: m.Machine
    # parts of the spec with a change, by which a refusal says what mends it; None of a change that is tried
    parts_with: Callable[[Change], Sequence[Part]] | None = None

    @cached_property
    def _density(self) -> float:
        """Of what is printed, kg/m^3."""
        return printed_density(self.spec.material)

    # ---- springs ----------------------------------------------------------------------------------------------------

    @cached_property
    def period(self) -> Run:
        """The chain over a period, of planets until their carrier is back: what levels are found by."""
        return solve(self.chain, self.spec.cycle.theta(_SAMPLES * self.spec.rounds), 0)

    @cached_property
    def springs(self) -> Sequence[coils.MountedSpring]:
        """Springs between links, and those that return followers; DesignError where one of them cannot be made."""
        return [
            *self._hung,
            *(
                each.sprung(self.chain, 0.0 if each.spring.given else self._least_pull(each))
                for each in self.spec.returning
            ),
        ]

    @property
    def closing(self) -> float:
        """What return springs press followers on their cams with at least, N or N m; inf without any."""
        pulls = {each.name: each.spring for each in self.springs}
        found = (each.spring.closing(pulls[each.name]) for each in self.spec.returning)
        return min(found, default=math.inf)

    @cached_property
    def _hung(self) -> Sequence[coils.MountedSpring]:
        """Those of [[spring]]."""
        if not self.spec.springs:
            return ()
        lasting = materials.of(self.spec.material.name).metal
        return coils.sprung(self.spec.springs, self.period, self.spec.making, lasting)

    def _least_pull(self, spring: coils.Returning) -> float:
        """What a return spring must pull with, N, by what all but such springs do."""
        contact = self._unreturned.contacts[spring.cam.name]
        return spring.spring.least_pull(spring.cam.leaves * contact)

    @cached_property
    def _unreturned(self) -> Forces:
        """Of the machine without its return springs, over the turns of its drive."""
        bodies = Bodies(with_levels(self._layout_with(self._hung), self.period))
        machine = self._weighed_with(bodies, self._hung)
        own = () if self.spec.load is None else efforts(self.spec.load.on, machine)
        machine = replace(machine, loads=(*machine.loads, *gravity(self.spec.load), *own))
        return solve(machine, SAMPLES).forces()

    # ---- levels and bodies ------------------------------------------------------------------------------------------

    @cached_property
    def layout(self) -> Layout:
        """What is over the plate, before levels are found."""
        return self._layout_with(self.springs)

    def _layout_with(self, springs: Sequence[coils.MountedSpring]) -> Layout:
        """It with these springs."""
        whole = self._whole_layout(springs)
        if self.beneath is None:
            return whole
        return replace(self.beneath.above, springs=whole.springs)

    @cached_property
    def beneath(self) -> Beneath | None:
        """What hangs under the plate."""
        arm = self.spec.additions.beneath
        return None if arm is None else Beneath(self._whole_layout(()), arm, self.period)

    def _whole_layout(self, springs: Sequence[coils.MountedSpring]) -> Layout:
        """That with what hangs under the plate."""
        spec = self.spec
        diagram = spec.diagram
        return Layout(
            self.chain,
            spec.drive.link,
            spec.making,
            spec.print,
            spec.allowed.min_wall,
            spec.layers,
            {},
            diagram.ridden,
            {gear.joint: gear.wish for gear in spec.gears},
            edges=diagram.edge_wishes,
            planets=tuple(planets.wish(row) for row in spec.planets),
            cycloids=diagram.cycloid_wishes,
            springs={each.name: each.stretched for each in springs},
            freewheels={
                each.wheel: (each.link, CLUTCHES[spec.making.shaft_diameter][0])
                for each in spec.freewheels
            },
            marks={
                each.link: complex(_MARK * hub / 2)
                for each in spec.freewheels
                if (hub := spec.making.shape(each.link).hub_diameter)
            },
            further=tuple(each.link for each in spec.drives[1:]),
            keep_outs=inc.clearings(spec.includes, lambda: spec.host),
            fitting=spec.additions.fitting,
            drawn_poses=spec.drawn.start,
            metal=materials.of(spec.material.name).metal,
        )

    @cached_property
    def sketched(self) -> Layout:
        """Before levels: with the strokes of its slots and slides, and the first choice of their stems."""
        return first_choice(self.layout, self.period)

    @cached_property
    def _laid(self) -> tuple[Bodies, complex]:
        weight = self.spec.counterweight
        if weight is None:
            return Bodies(with_levels(self.layout, self.period)), 0j
        return counterbalanced(weight, self.layout, self.period, self._density, self.weighed)

    @cached_property
    def bare(self) -> Bodies:
        """What is made of it alone; levels that [layers] leaves open are found."""
        unmade = lacking(self.layout)
        if unmade is not None:
            raise unmade
        bodies = self.balanced[0]
        refuse_alike(bodies.parts, self.spec.diagram.links, self.spec.making.discs or ())
        return bodies

    @cached_property
    def balanced(self) -> tuple[Bodies, complex]:
        """The bodies, and the moment that all that turns with a balanced crank is to have, complex g mm; DesignError with what
        mends it, where a change is found that does."""
        try:
            assert self._laid[0].parts
        except DesignError as refused:
            if self.parts_with is None:
                raise
            raise with_cures(refused, self.layout, self.period, self.parts_with) from None
        return self._laid

    def weighed(self, bodies: Bodies) -> m.Machine:
        """The machine of some bodies with their masses and springs."""
        return self._weighed_with(bodies, self.springs)

    def _weighed_with(self, bodies: Bodies, springs: Sequence[coils.MountedSpring]) -> m.Machine:
        machine = bodies.with_masses(self._density, self.spec.masses)
        if self.beneath is not None:
            machine = self.beneath.joined(machine, self._density)
        pulls = (each.pull for each in springs)
        return replace(machine, loads=(*machine.loads, *self.spec.additions.loads, *pulls))
