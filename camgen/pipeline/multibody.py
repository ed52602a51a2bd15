"""The machine as MuJoCo simulates it: bodies with the masses of their solids as a tree, loops closed by sites, its drive.

Left out of the file, and told there: friction, play and bending of joints, and loads that are not springs. Which pins rub, and how
much, the model has beside it, for a simulation that follows their reactions.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from camgen._version import __version__
from camgen.errors import Fault, SpecError
from camgen.files import mjcf
from camgen.files.gltf import Shape, Track
from camgen.geometry.distances import inside, point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.machine.features import heights
from camgen.machine.model import (
    GROUND,
    Body,
    Gravity,
    Machine,
    Pin,
    Pose,
    Slide,
    Spring,
    TorsionSpring,
)
from camgen.machine.model import Path as Course
from camgen.machine.run import solve
from camgen.machine.tree import Branch, Coupling, Tree, tree_of
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.loads.drive import motor_of
from camgen.machines.loads.rubbing import with_friction
from camgen.machines.loads.tables import Drives
from camgen.machines.loads.weights import with_masses
from camgen.machines.mechanism import Mechanism
from camgen.parts.assembly import Assembly
from camgen.parts.inertia import MassMoments, mass_moments, masses_together
from camgen.parts.sides import PREFIX
from camgen.pipeline.case import Case
from camgen.pipeline.shown import solids

FOLDER = "mjcf"
_BLOCK = MassMoments(1e-4, np.zeros(3), np.diag([1e-3, 1e-3, 1e-3]))  # kg, of what runs in a slot
_FACETS = 1e-3  # mm, of an outline whose distance from a foot is looked for


@dataclass(frozen=True)
class Standing:
    """How a machine stands on a floor: outputs that are its feet, on both sides; frictions that are looked at; what it carries.

    payload: kg, at a place of the ground, mm, None: at the shaft, in the middle between the feet.
    """

    feet: Sequence[str]
    frictions: Sequence[float]
    payload: float
    payload_at: complex | None
    freedom: mjcf.Freedom  # in its plane alone where it has one side
    down: complex  # where gravity points, a unit complex


def standing_of(mechanism: Mechanism) -> Standing | None:
    """What a spec's table [walk] says; None where it has none."""
    table = mechanism.walk if isinstance(mechanism, Linkage) else None
    if table is None:
        return None
    outputs = {output.name for output in mechanism.assembly.machine.outputs}
    far = [name for foot in table.feet if (name := f"{PREFIX}_{foot}") in outputs]
    at = complex(*table.payload_at) if table.payload_at else None
    freedom: mjcf.Freedom = "space" if far else "plane"
    deg = None if mechanism.load is None else mechanism.load.gravity_deg
    down = -1j if deg is None else cmath.rect(1.0, math.radians(deg))
    carried = 1e-3 * table.payload_g
    return Standing([*table.feet, *far], table.friction, carried, at, freedom, down)


def make_mjcf(case: Case, build: Path) -> None:
    """Write the folder of the simulation into that of a build: the text, and a mesh for each part; SpecError where the machine has no such form."""
    from camgen.files.stl import write_stl

    model = simulated(case.mechanism, standing_of(case.mechanism))
    folder = build / FOLDER
    (folder / mjcf.MESHES).mkdir(parents=True)
    name = f"{case.mechanism.name}.xml"
    (folder / name).write_text(mjcf.text(model), encoding="utf-8", newline="\n")
    for shape in model.shapes:
        write_stl(folder / mjcf.MESHES / f"{shape.name}.stl", shape.mesh, shape.name)


def mjcf_files(build: Path) -> list[Path]:
    """Those files, as far as they are there."""
    return sorted(path for path in (build / FOLDER).rglob("*") if path.is_file())


def simulated(
    mechanism: Mechanism, standing: Standing | None = None, copy: Machine | None = None
) -> mjcf.Model:
    """The machine at the start of its period, fixed in the world, or on its feet; SpecError where it cannot be told.

    copy: of it, whose pins are a little elsewhere.
    """
    assembly = mechanism.assembly
    machine = with_masses(copy or assembly.exact, assembly.solids, mechanism.load).machine
    tree = tree_of(machine)
    if tree.left_out:
        right = "a machine of pins, slides, slots and gears, driven evenly: MJCF has no form of"
        raise SpecError([Fault(("only",), "mjcf", f"{right} {', '.join(tree.left_out)}")])
    return _Simulated(mechanism, assembly, machine, tree, standing).model()


@dataclass(frozen=True, eq=False)
class _Simulated:
    """What the model is made of."""

    mechanism: Mechanism
    assembly: Assembly
    machine: Machine
    tree: Tree
    standing: Standing | None

    def model(self) -> mjcf.Model:
        """The records of the file."""
        standing = self.standing
        feet = [] if standing is None else [*map(self._foot, standing.feet)]
        links = [self._link(branch, feet) for branch in self.tree.branches]
        mass = masses_together([self._mass_of(GROUND), *self._payload([foot for _, foot in feet])])
        fixed = self._link(Branch(GROUND, GROUND, None), feet)
        return mjcf.Model(
            self.mechanism.name,
            self._solids[0],
            replace(fixed, mass=mass),
            links,
            [(joint.name, *_sites(joint)) for joint in self.tree.closing],
            {each.name: self._of_joints(each) for each in self.tree.couplings},
            [
                mjcf.Coil(load.name, _sites(load), load.rate, load.free)
                for load in self.machine.loads
                if isinstance(load, Spring)
            ],
            self._motor,
            self.assembly.down
            if standing is None
            else (standing.down.real, standing.down.imag, 0.0),
            "fixed" if standing is None else standing.freedom,
            self._height([foot for _, foot in feet]),
            0.6 if standing is None else standing.frictions[len(standing.frictions) // 2],
            remarks=self._remarks,
            rubs=self._rubs,
        )

    @cached_property
    def _solids(self) -> tuple[list[Shape], list[Track]]:
        """Meshes of the parts, and where copies of them are on the bodies."""
        return solids(self.mechanism, 1)

    @cached_property
    def _poses(self) -> Mapping[str, Pose]:
        """Where bodies and blocks are at the start, scalars."""
        run = solve(self.machine, self.assembly.cycle.theta(np.zeros(1)), 0)
        names = (GROUND, *(body.name for body in self.machine.moving))
        poses = {name: run.pose(name) for name in names}
        return {
            name: Pose(complex(pose.place[0]), float(pose.angle[0]))
            for name, pose in self.tree.with_blocks(poses).items()
        }

    def _mass_of(self, body: str) -> MassMoments:
        """Mass of what is mounted on a body; of a moving one as the model has it in the plane."""
        shapes, tracks = self._solids
        parts = self.assembly.solids
        copies = next((track.copies for track in tracks if track.name == body), ())
        masses = masses_together(
            [
                mass_moments(
                    shapes[number].mesh.moved(transform),
                    parts.density_of(parts.by_name[shapes[number].name]),
                )
                for _, number, transform in copies
                if parts.weighs(parts.by_name[shapes[number].name])
            ]
        )
        planar = Body(body) if body == GROUND else self.machine.body(body)
        return masses.fitted(parts.body(planar) if body == GROUND else planar)

    def _link(self, branch: Branch, feet: Sequence[tuple[str, mjcf.Foot]]) -> mjcf.Link:
        """A body of the tree."""
        name = branch.body
        own = self._poses[name]
        parent = self._poses[branch.parent]
        at = cmath.exp(-1j * parent.angle) * (own.place - parent.place)
        blocks = name in self.tree.blocks
        return mjcf.Link(
            name,
            branch.parent,
            at,
            own.angle - parent.angle,
            self._joint(branch),
            _BLOCK if blocks else self._mass_of(name),
            next((track.copies for track in self._solids[1] if track.name == name), ()),
            [
                (site, place.at)
                for tie in (*self.tree.closing, *self.machine.loads)
                if isinstance(tie, Pin | Spring)
                for site, place in zip(_sites(tie), (tie.a, tie.b), strict=True)
                if place.body == name
            ],
            [foot for body, foot in feet if body == name],
        )

    def _joint(self, branch: Branch) -> mjcf.Hinge | mjcf.Slider | None:
        """How a body moves on its parent."""
        joint = branch.joint
        if isinstance(joint, Slide):
            if joint.runner.body == branch.body:
                return mjcf.Slider(joint.name, cmath.exp(1j * (joint.angle - joint.turn)))
            return mjcf.Slider(joint.name, -cmath.exp(1j * joint.angle))
        if joint is None:
            return None
        at = next(place.at for place in (joint.a, joint.b) if place.body == branch.body)
        spring = self._torsion_springs.get(branch.body)
        if spring is None:
            return mjcf.Hinge(joint.name, at)
        turned = self._poses[branch.body].angle - self._poses[branch.parent].angle
        free = spring.free if spring.a == branch.body else -spring.free
        return mjcf.Hinge(joint.name, at, spring.rate, free - turned)

    @cached_property
    def _torsion_springs(self) -> Mapping[str, TorsionSpring]:
        """Those between a body and its parent in the tree, by that body."""
        return {
            branch.body: load
            for branch in self.tree.branches
            for load in self.machine.loads
            if isinstance(load, TorsionSpring)
            and isinstance(branch.joint, Pin)
            and {load.a, load.b} == {branch.body, branch.parent}
        }

    @property
    def _rubs(self) -> list[mjcf.Rub]:
        """Pins of the tree, and those that close loops, as far as their bearings are known."""
        mechanism = self.mechanism
        journals = self.assembly.journals
        rubbing = with_friction(self.machine, journals, mechanism.load, mechanism.material.name)
        circles = {pin.name: pin.friction for pin in rubbing.joints if isinstance(pin, Pin)}
        hinges = (each.joint for each in self.tree.branches if isinstance(each.joint, Pin))
        rubs = [mjcf.Rub(pin.name, circles.get(pin.name, 0.0)) for pin in hinges]
        for pin in self.tree.closing:
            turning = Coupling(pin.name, {pin.a.body: 1.0, pin.b.body: -1.0})
            rubs.append(mjcf.Rub(pin.name, circles.get(pin.name, 0.0), self._of_joints(turning)))
        return [each for each in rubs if each.radius]

    def _of_joints(self, coupling: Coupling) -> dict[str, float]:
        """Shares of the joints whose angles sum up to those of the coupled bodies."""
        shares: dict[str, float] = {}
        for body, share in coupling.shares.items():
            for pin in self.tree.turning(body):
                shares[pin.name] = shares.get(pin.name, 0.0) + share
        return {name: share for name, share in shares.items() if share}

    @cached_property
    def _motor(self) -> mjcf.Motor:
        """The first drive, by the line of the motor where that is known."""
        drive = self.machine.drives[0]
        rate = float(drive.law(np.zeros(1), 1)[0])
        speed = rate * (self.machine.speed if math.isfinite(self.machine.speed) else 1.0)
        if drive.slide:
            return mjcf.Motor(drive.slide, speed, slides=True)
        joint = next(self.tree.turning(drive.body)).name
        table = getattr(self.mechanism, "motor", None)
        drives = table if isinstance(table, Drives) else None
        motor = motor_of(drives, self.assembly.motor.crank)
        if motor is None or not math.isfinite(motor.no_load):
            return mjcf.Motor(joint, speed)
        return mjcf.Motor(joint, speed, motor.stall, motor.no_load)

    def _foot(self, name: str) -> tuple[str, mjcf.Foot]:
        """The body of a foot, and its capsule: as high as the part that ends there, with the radius of its end."""
        course = self.machine.output(name).of
        assert isinstance(course, Course), f"{name} is no path"
        place = course.of
        reach = []
        for mount in self.assembly.mounts:
            if mount.body != place.body:
                continue
            part = self.assembly.by_name[mount.part]
            outer = part.drawn.region.outer
            ring = facet_contour(outer, _FACETS)
            at = np.array([place.at])
            own = np.array([mount.place(complex(z)) for z in ring])
            if inside(at, own)[0]:
                low, high = heights(mount, part.thickness, part.drawn.z0, part.drawn.z1)
                reach.append((float(point_to_ring(at, own)[0]), low, high))
        radius, low, high = max(reach)
        return place.body, mjcf.Foot(name, place.at, low, high, radius)

    def _payload(self, feet: Sequence[mjcf.Foot]) -> list[MassMoments]:
        """What the frame carries, as a point."""
        standing = self.standing
        if standing is None or not standing.payload:
            return []
        shaft = next(self.tree.turning(self.machine.drives[0].body))
        seat = next(place.at for place in (shaft.a, shaft.b) if place.body == GROUND)
        at = seat if standing.payload_at is None else standing.payload_at
        middle = float(np.mean([(foot.low + foot.high) / 2 for foot in feet]))
        centre = np.array([at.real, at.imag, middle])
        return [MassMoments(standing.payload, centre, np.zeros((3, 3)))]

    def _height(self, feet: Sequence[mjcf.Foot]) -> float:
        """Of the frame's origin over a floor that the lowest foot touches at the start, mm; 0 without a floor."""
        if self.standing is None:
            return 0.0
        up = -self.standing.down
        run = solve(self.machine, self.assembly.cycle.theta(np.zeros(1)), 0)
        low = [float(np.real(run[foot.name][0] * up.conjugate())) - foot.radius for foot in feet]
        return -min(low)

    @property
    def _remarks(self) -> list[str]:
        """What the file says of itself."""
        springs = {each.name for each in self._torsion_springs.values()}
        names = [
            load.name
            for load in self.machine.loads
            if not isinstance(load, Spring | Gravity) and load.name not in springs
        ]
        return [
            f"Made by camgen {__version__}. Lengths m, masses kg; the frame is that of the report.",
            "Play and friction of joints are left out" + "".join(f", {name}" for name in names),
        ]


def _sites(tie: Pin | Spring) -> tuple[str, str]:
    """Names of both ends."""
    return f"{tie.name} a", f"{tie.name} b"
