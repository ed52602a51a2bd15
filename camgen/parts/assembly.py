"""A machine as it is made, as data: its model, parts, where they stand, how its joints are measured, what is bought.

A mechanism makes this record once. Whoever draws, weighs, prints, shows or judges the machine takes it from there; `joined`
makes one machine of several, `renamed` puts a machine where it stands in another one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import takewhile
from typing import Any

import numpy as np

from camgen.findings import NotJudged
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Floats, Region, end_point, extent, start_point
from camgen.geometry.rings import Ring
from camgen.machine.features import (
    Balance,
    CamOutline,
    Demand,
    DrumTrack,
    Edge,
    Eye,
    Feature,
    Mount,
    PartPose,
    Passing,
    PinRow,
    PlateEdge,
    StandIn,
    Strand,
    SweptMachine,
    heights,
)
from camgen.machine.joining import Module
from camgen.machine.model import GROUND, Cam, Machine, Pose
from camgen.machine.run import Lazy, solve
from camgen.parts import coils, materials
from camgen.parts.blocks import MUST_NOT_SINK
from camgen.parts.catalogue import NUT_STANDARD, Bearing, Bought
from camgen.parts.coils import Coil
from camgen.parts.fixing import Fixing, with_joints
from camgen.parts.inertia import Solids
from camgen.parts.journals import Journal, MaterialLimits, Post, journals
from camgen.parts.mates import mated, mates_between
from camgen.parts.part import Part
from camgen.parts.screws import round_prism, screw_heads, with_screws
from camgen.parts.set_screws import SetScrewHub
from camgen.parts.sheets import why_not
from camgen.parts.springs import WorkingSpring
from camgen.parts.standing import discs as round_holes
from camgen.parts.standing import standing_copies
from camgen.parts.step_words import ON_BENCH, TWO_PART, called, listed
from camgen.parts.steps import holding_notes, order
from camgen.study import Doing, Later, Mate, Step, Table
from camgen.tolerances import SAME_POINT

TABLE = "table"  # name of what a machine with a stand is put on in the end


@dataclass(frozen=True)
class Cycle:
    """How theta, the angle of the drive, runs over a period."""

    least: float = 0.0  # rad
    greatest: float = math.tau  # rad
    turns: int = 1  # of the drive, after which all is where it was, as far as it is shown
    swept: int = 1  # turns of the drive over which bodies are looked at for what they meet
    sense: int = 1  # of theta: -1 where the input shaft turns clockwise
    name: str = "crank angle"  # of theta, for people
    to_and_fro: bool = False  # the drive goes from the least angle to the greatest and back
    unit: str = "deg"  # what a degree of theta stands for, "mm" of a way

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest theta, rad."""
        return self.least, self.greatest

    @property
    def label(self) -> str:
        """What axes of theta are called."""
        return f"{self.name}, {self.unit}"

    def theta(self, phase: Floats) -> Floats:
        """theta at a phase of the period, (n,) rad: of a drive that goes to and fro a harmonic motion."""
        if not self.to_and_fro:
            return phase
        return np.asarray(self.least + (self.greatest - self.least) * (1 - np.cos(phase)) / 2)


@dataclass(frozen=True)
class Frame:
    """The flat part that stands still under all others; places on the ground, mm."""

    part: str
    fixings: Sequence[tuple[complex, float]] = ()  # holes for screws from behind: place, diameter


@dataclass(frozen=True)
class FlatSeat:
    """A bore of a printed part through which a flat passes on what drives the machine; mm."""

    part: str
    hole: str  # its letter
    diameter: float
    depth: float  # of the flat
    length: float  # of the bore
    drives: tuple[str, ...] = ()  # for which alone it passes that on; () for all


@dataclass(frozen=True)
class MotorSeat:
    """Where a motor or a hand drives the machine."""

    frame: str = ""  # of the motor, such as "nema-17"; "" where none is part of the machine
    reach: float | None = None  # mm, of its shaft over its face, that is needed
    hub: SetScrewHub | None = None  # that a set screw holds on its shaft
    crank: float = 0.0  # mm, from the shaft to the knob of the hand crank; 0: none
    shaft: float = 0.0  # diameter of the motor's, mm
    most: float | None = (
        None  # mm, of its shaft over its face, that has room; None: as long as it is
    )
    under: str = ""  # the part that passes over a shaft so long
    flats: tuple[FlatSeat, ...] = ()  # by which flats turn printed parts, first that on its shaft


@dataclass(frozen=True)
class Shaft:
    """The shaft that drives the machine, where it is a part; bores on it have its flat."""

    part: str
    diameter: float  # mm
    flat: float  # mm, depth of it
    collar: str = "collar"  # part on it, under the frame


@dataclass(frozen=True)
class StandStep:
    """How a part of a stand comes: along which way, and where it is glued, all mm."""

    part: str
    where: str  # in words
    along: tuple[float, float, float]  # a unit vector
    glued: Sequence[tuple[complex, float]]  # middle of each tab, and its height
    thick: float


@dataclass(frozen=True)
class Support:
    """What a machine stands on: which way is down, a unit vector, and its parts in the order in which they come, with where."""

    down: tuple[float, float, float]
    steps: tuple[StandStep, ...]
    parts: frozenset[str]  # names of all that is made for it, of what other parts lie on too


@dataclass(frozen=True)
class Feet:
    """What a machine walks on: which way is down, a unit vector, and the parts that end in soles, by their names."""

    down: tuple[float, float, float]
    parts: frozenset[str]


@dataclass(frozen=True)
class FollowerFacts:
    """What forces need to know of a cam's follower."""

    arm_stiffness: float | None = None  # N m/rad, from its pivot to its tip, by its outline
    roller: Bearing | None = None  # the ball bearing that is its tip
    wish: tuple[float, float, float] | None = None  # spring that is no part: N/mm, least N, mm


@dataclass(frozen=True)
class Process:
    """What the way of making says of a machine."""

    tolerance: float  # mm, by which facets lie off an arc
    gap: float  # mm, that bodies keep which move past each other
    fixing: Fixing  # of parts on each other
    material: str  # of all that is no bought, turned or steel part
    density: float  # kg/m^3, of it
    sheet: float | None = None  # mm, thickness of what a laser cuts; None: it cuts nothing


@dataclass(frozen=True, eq=False)
class Assembly:
    """A machine as it is made; lengths mm, angles rad."""

    machine: Machine  # as wanted, with fits, springs and loads
    parts: Sequence[Part]  # distinct ones, with counts
    process: Process
    cycle: Cycle = Cycle()
    mounts: Sequence[Mount] = ()  # where every copy of every part stands on the machine's bodies
    features: Sequence[Feature] = ()  # of parts, on which the joints are measured
    tracks: Sequence[DrumTrack] = ()  # of drums, in which rollers run
    edges: Sequence[PlateEdge] = ()  # of plates that slide, on which tips run
    rows: Sequence[PinRow] = ()  # of pins that bend teeth aside and let them go
    passing: Sequence[Passing] = ()  # parts that pass by each other without a joint
    demands: Sequence[Demand] = ()  # on the outputs
    stand_ins: Sequence[StandIn] = ()  # what is not made but in the way
    strands: Sequence[Strand] = ()  # threads from post to post
    # bodies that move in a plane that stands, x as -y, y as z and z as -x, with the place of their own plane's origin in it, mm
    planes: Mapping[str, complex] = field(default_factory=dict)
    touching: Sequence[tuple[str, str]] = ()  # parts that touch by intent where planes stand
    balances: Sequence[Balance] = ()  # what the solids of cranks with counterweights are held to
    coils: Sequence[Coil] = ()  # extension springs
    bought: Sequence[Bought] = ()  # by their standards
    springs: Mapping[str, WorkingSpring] = field(
        default_factory=dict
    )  # at work, by names in findings
    journals: Mapping[str, Journal] = field(default_factory=dict)  # plain bearings, by joint
    posts: Sequence[Post] = ()  # pins that only a spring or a roller bends
    frame: Frame | None = None
    motor: MotorSeat = MotorSeat()
    shaft: Shaft | None = None
    follower: FollowerFacts = FollowerFacts()
    support: Support | None = None  # its stand, where it has one
    dowel: float = 0.0  # mm, diameter of the dowels in its parts' round holes of this size
    thread: str = ""  # such as "M6", of the screws whose core holes its parts have
    feet: Feet | None = None  # where it stands on its own feet
    board: str = ""  # what it stands on, as the last step says; "" where nothing is said
    work: Sequence[Table] = ()  # the order of assembly, where it is not by height
    material_limits: MaterialLimits = MaterialLimits()
    included_limits: Mapping[str, MaterialLimits] = field(
        default_factory=dict
    )  # of included machines
    unjudged: Sequence[NotJudged] = ()  # of its limits, such as what presses a follower on its cam
    texts: Mapping[str, str] = field(default_factory=dict)  # text files, by the ends of their names

    @property
    def whole_drums(self) -> Sequence[str]:
        """Names of drums in one piece."""
        return [track.part for track in self.tracks if track.ring is None]

    @cached_property
    def exact(self) -> Machine:
        """The machine as exact parts move it: cams that the spec undercuts give what they can."""
        laws = {name: cam.nominal.law for name, cam in self.outlines.items() if cam.nominal.law}
        joints = [
            replace(joint, law=laws[joint.name])
            if isinstance(joint, Cam) and joint.name in laws
            else joint
            for joint in self.machine.joints
        ]
        return replace(self.machine, joints=tuple(joints)) if laws else self.machine

    @cached_property
    def outlines(self) -> dict[str, CamOutline]:
        """The first outline of each cam, by the name of its joint."""
        return {
            each.joint: each for each in reversed(self.features) if isinstance(each, CamOutline)
        }

    def touched(self, outline: CamOutline) -> Region:
        """The region of a cam's part whose edge its follower touches."""
        part = self.by_name[outline.part]
        return part.region if outline.layer is None else part.layers[outline.layer[0]].region

    def shoe(self, outline: CamOutline) -> Ring | None:
        """The outline of the part that touches a cam with its edge, as it is meant; None where a tip or a face touches."""
        if not isinstance(outline.tip, Edge):
            return None
        rim = self.by_name[outline.tip.part].region.outer.counter_clockwise()
        points = facet_contour(rim, self.process.tolerance)
        return Ring.straight(points)

    @property
    def one_key(self) -> bool:
        """Whether one key goes through all bores: of a groove's walls, or of cams side by side on one seat of a shaft."""
        shafts = (each.shaft for each in self.bought)
        return self.dowel > 0 or any(shaft and len(shaft.bores) == 1 for shaft in shafts)

    @cached_property
    def by_name(self) -> Mapping[str, Part]:
        """Its parts by their names."""
        return {part.name: part for part in self.parts}

    @property
    def down(self) -> tuple[float, float, float]:
        """Which way is down, a unit vector: by its stand, by its feet, or as its plate lies on the table."""
        standing = self.support or self.feet
        return standing.down if standing else (0.0, 0.0, -1.0)

    @property
    def solids(self) -> Solids:
        """Its parts, as masses follow from them."""
        return Solids(self.parts, self.mounts, self.process.density)

    def limits_of(self, joint: str) -> MaterialLimits:
        """What the spec says of a joint's materials, or that of the included machine whose joint it is."""
        return self.included_limits.get(joint, self.material_limits)

    def courses(self, theta: Floats) -> Mapping[str, Pose]:
        """Pose of each body at theta, (n,) rad, as exact parts move it; worked out when asked for."""
        run = solve(self.exact, self.cycle.theta(np.asarray(theta, float)), 0)
        return Lazy((GROUND, *(body.name for body in run.machine.moving)), run.pose)

    def poses(self, theta: Floats) -> Mapping[str, Sequence[PartPose]]:
        """Poses of each part's copies, in the order of their mounts, by name, worked out when asked for; theta: (n,) rad."""
        courses = self.courses(theta)

        def of_part(name: str) -> Sequence[PartPose]:
            """Of its copies."""
            poses = []
            for mount in self.mounts:
                if mount.part == name:
                    body = courses[mount.body]
                    origin = self.planes.get(mount.body, 0j)
                    place = body.place + origin + np.exp(1j * body.angle) * mount.at
                    angle = body.angle + mount.angle
                    stands = mount.flipped, mount.z, mount.upright, mount.body in self.planes
                    poses.append(PartPose(place, angle, *stands))
            return poses

        return Lazy((part.name for part in self.parts), of_part)


def tips(
    features: Iterable[Feature], parts: Sequence[Part], mounts: Sequence[Mount], machine: Machine
) -> list[StandIn]:
    """Each cam's round tip that is not made, as high as the cam that it touches."""
    stand_ins = []
    for cam in features:
        if not (isinstance(cam, CamOutline) and isinstance(cam.tip, Eye) and cam.tip.diameter):
            continue
        if cam.own or cam.inside:
            continue
        part = next(part for part in parts if part.name == cam.part)
        joint = machine.cam(cam.joint)
        mount = [mount for mount in mounts if mount.part == cam.part][cam.copy]
        layer = part.drawn if cam.layer is None else part.layers[cam.layer[0]]
        high = heights(mount, part.thickness, layer.z0, layer.z1)
        disc = (cam.tip.at, cam.tip.diameter / 2, *high)
        name = (
            f"tip on {cam.part}-{1 + cam.copy}" if cam.layer is None else f"tip of {joint.follower}"
        )
        stand_ins.append(StandIn(name, joint.follower, (disc,), rolls=True))
    return stand_ins


def printed_parts(assembly: Assembly) -> list[Part]:
    """Parts that are laid out on plates: not what is bought, or turned, or cut, of a sheet or otherwise."""
    if not materials.of(assembly.process.material).printed:
        return []
    return [
        part
        for part in assembly.parts
        if part.process == "printed" and not cut_of_sheet(assembly, part)
    ]


def cut_of_sheet(assembly: Assembly, part: Part) -> bool:
    """Whether a part is cut of the laser's sheet."""
    sheet = assembly.process.sheet
    return sheet is not None and not why_not(part, sheet)


# ---- several machines on one shaft -----------------------------------------------------------------------------------


def renamed(assembly: Assembly, module: Module) -> Assembly:
    """A machine as it stands in another one: under other names, shifted, raised, ahead in phase.

    What is asked of joints and outputs that it has no more, since links of the other machine carry its bodies, is left out.
    Its journals follow from the whole, see `joined`.
    """
    dropped = module.lost(assembly.machine)
    features = (each for each in assembly.features if getattr(each, "joint", None) not in dropped)
    return Assembly(
        module.machine(assembly.machine),
        [replace(part, name=module.part(part.name)) for part in assembly.parts],
        assembly.process,
        mounts=[module.mount(mount) for mount in assembly.mounts],
        features=[module.renamed(each) for each in features],
        passing=[_passing(each, module) for each in assembly.passing],
        demands=[module.demand(each) for each in assembly.demands if each.output not in dropped],
        stand_ins=[_stand_in(each, module) for each in assembly.stand_ins],
        strands=[_strand(each, module) for each in assembly.strands],
        balances=[_balance(each, module) for each in assembly.balances],
        coils=[each.renamed(module) for each in assembly.coils],
        bought=[
            replace(
                each,
                name=f"{each.name}, {module.prefix}",
                at=tuple((module.part(part), count) for part, count in each.at),
            )
            for each in assembly.bought
        ],
        included_limits={
            module.name(joint.name): assembly.limits_of(joint.name)
            for joint in assembly.machine.joints
        },
        unjudged=assembly.unjudged,
        springs={f"{name} of {module.prefix}": spring for name, spring in assembly.springs.items()},
    )


def _passing(pair: Passing, module: Module) -> Passing:
    sections = {
        module.part(name): (module.part(other), mirrored)
        for name, (other, mirrored) in pair.drawn.items()
    }
    planes = tuple(z + module.z for z in pair.planes)
    return replace(
        pair, a=module.part(pair.a), b=module.part(pair.b), planes=planes, drawn=sections
    )


def _stand_in(thing: StandIn, module: Module) -> StandIn:
    shift = module.at if thing.body == GROUND else 0j
    z = module.z
    discs = tuple((at + shift, radius, low + z, high + z) for at, radius, low, high in thing.discs)
    bars = tuple(
        (a + shift, b + shift, radius, low + z, high + z) for a, b, radius, low, high in thing.bars
    )
    return replace(
        thing, name=module.part(thing.name), body=module.body(thing.body), discs=discs, bars=bars
    )


def _strand(strand: Strand, module: Module) -> Strand:
    posts = tuple((module.part(name), k) for name, k in strand.posts)
    return replace(strand, posts=posts, low=strand.low + module.z, high=strand.high + module.z)


def _balance(balance: Balance, module: Module) -> Balance:
    density = {module.part(name): heavy for name, heavy in balance.density.items()}
    return replace(
        balance, body=module.body(balance.body), joint=module.name(balance.joint), density=density
    )


def joined(host: Assembly, others: Sequence[Assembly], machine: Machine) -> Assembly:
    """One machine of a host and others that are renamed; machine: the model of all.

    The host's frame, motor, shaft and board are those of the whole.
    """
    if not others:
        return host
    all_ = (host, *others)
    lists: dict[str, Any] = {
        key: [thing for each in all_ for thing in getattr(each, key)] for key in _LISTS
    }
    whole = replace(
        host,
        machine=machine,
        included_limits={name: of for each in all_ for name, of in each.included_limits.items()},
        unjudged=Later(lambda: [limit for each in all_ for limit in each.unjudged]),
        springs={name: spring for each in all_ for name, spring in each.springs.items()},
        **lists,
    )
    bearings = journals(machine, whole.features, whole.parts, whole.mounts, host.process.material)
    return replace(whole, journals=bearings)


# Fields of which the whole has what all its machines have, one after the other.
_LISTS = (
    "parts",
    "mounts",
    "features",
    "passing",
    "demands",
    "stand_ins",
    "strands",
    "balances",
    "coils",
    "bought",
)


# ---- in the sweep ----------------------------------------------------------------------------------------------------


def bodies_in_motion(assembly: Assembly) -> SweptMachine:
    """What the sweep of all bodies needs; springs too, as bars from either end."""
    courses = coils.with_ends(assembly.courses, assembly.coils)
    things = [*assembly.stand_ins, *(bar for coil in assembly.coils for bar in coil.stand_ins())]
    pairs = (*assembly.passing, *assembly.features)
    process = assembly.process
    return SweptMachine(
        assembly.mounts,
        courses,
        pairs,
        things,
        process.gap,
        process.tolerance,
        assembly.cycle.name,
        assembly.cycle.swept,
        assembly.cycle.theta,
        assembly.planes,
        assembly.touching,
    )


# ---- steps of assembly -----------------------------------------------------------------------------------------------


Row = tuple[tuple[object, ...], Step]  # of the table, and its picture


def order_of_assembly(assembly: Assembly) -> Table:
    """In which order it goes together, and where."""
    table = _order(assembly)
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    return replace(table, steps=with_screws(table.steps, copies, assembly.bought))


def heads_in_motion(assembly: Assembly) -> SweptMachine:
    """What the sweep of all bodies needs, with the heads of screws beside what is in the way of them."""
    machine = bodies_in_motion(assembly)
    if not any(each.length for each in assembly.bought):
        return machine
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    heads = screw_heads(order_of_assembly(assembly).steps, copies)
    return replace(machine, stand_ins=[*machine.stand_ins, *heads])


def _order(assembly: Assembly) -> Table:
    """The same before the screws have their places."""
    if assembly.work:
        table = assembly.work[0]
        poses = assembly.poses(np.zeros(1))
        copies = standing_copies(assembly.parts, assembly.mounts, poses)
        fixing = assembly.process.fixing
        table = replace(table, steps=mated(table.steps, copies, assembly.features, fixing))
        if len({mount.body for mount in assembly.mounts}) > 1:
            # a machine, whose own steps put in what is bought
            own = zip(map(tuple, table.rows), table.steps, strict=True)
            return numbered(table, [*own, *_on_its_feet(assembly)]) if assembly.feet else table
        own = zip(map(tuple, table.rows), table.steps, strict=True)
        return numbered(table, [*own, *further_rows(assembly)])
    table = by_heights(assembly)
    rows: list[Row] = [
        (tuple(row), step) for row, step in zip(table.rows, table.steps, strict=True)
    ]
    for coil in assembly.coils:
        rows = _with_spring(rows, coil, assembly.courses(np.zeros(1)))
    rows += further_rows(assembly)
    rows += _last_rows(assembly) if assembly.board else []
    return numbered(table, rows)


def _on_its_feet(assembly: Assembly) -> Iterator[Row]:
    """The last row of a machine that walks."""
    fed = any(each.role == "supply" for each in assembly.bought)
    on = "switch it on, at its batteries" if fed else "turn its shaft"
    back = ". It walks the other way with the motor's two wires swapped" if fed else ""
    doings = [Doing("when the glue is hard, set the machine on its feet"), Doing(f"{on}{back}")]
    x, y, z = assembly.feet.down if assembly.feet else (0.0, 0.0, -1.0)
    step = Step(doings, up=(-x, -y, -z))
    yield (0, "table", "On its feet", "", 1, 0.0, "as yours"), step


def numbered(table: Table, rows: Sequence[Row]) -> Table:
    """The table with these rows, counted from 1."""
    counted = tuple((count, *row[1:]) for count, (row, _) in enumerate(rows, 1))
    return replace(table, rows=counted, steps=tuple(step for _, step in rows))


def further_rows(assembly: Assembly) -> Iterator[Row]:
    """Steps of what is bought and goes in with none of the parts: what feeds a motor, or what carries a cam alone."""
    with_last = {"drive", "mount"} if assembly.board else set[str]()
    if assembly.motor.reach is not None:
        with_last |= {"drive"}
    for each in assembly.bought:
        if not each.at and each.role not in {"drive screw", "spring", "own", "aside", *with_last}:
            yield _bought_row(each)


def coupled(assembly: Assembly) -> list[Bought]:
    """What turns its shaft and has no place in it."""
    if assembly.motor.reach is not None:
        return []
    return [each for each in assembly.bought if each.role == "drive"]


def _bought_row(each: Bought) -> Row:
    """A step of what is bought."""
    row = (0, each.name, each.size, each.how, each.count, 0.0, "as bought")
    many = f"{each.count} × {each.name}"
    name = many if each.count > 1 else each.name[:1].upper() + each.name[1:]
    threads = [(each.thread, each.length)] if each.length else []
    said = f"{name}, {each.size}{f'; {each.how}' if each.how else ''}"
    if each.role == "mount":
        said = f"screw in {each.text}{f' {each.how}' if each.how else ''}"
    return row, Step([Doing(said)], threads=threads)


def with_things(row: Row, things: Sequence[Bought]) -> Row:
    """A row, with what is put in at it beside how it lies, and in its step's title."""
    if not things:
        return row
    cells, step = row
    said = f"with {', '.join(each.text for each in things)}"
    text = "; ".join(filter(None, (str(cells[3]), said)))
    cells = (*cells[:3], text, *cells[4:])
    threads = [(each.thread, each.length) for each in things if each.length]
    use = f"use {', '.join(each.text for each in things)}"
    return cells, replace(step.also(use), threads=[*step.threads, *threads])


def _with_spring(rows: Sequence[Row], coil: Coil, poses: Mapping[str, Pose]) -> list[Row]:
    """Rows with a spring before the first head or cap over an eye of it, and pins that come through its eyes."""
    length = coil.length(poses)
    hooked = coil.stringing(length)
    step = Step([Doing(hooked, needs=("pliers",))], wire=coil.wire(poses))
    spring = (0, "extension spring", hooked, "", 1, coil.eyes[0], "as bought"), step
    over = {copy for end in coil.heads for copy in end}
    first = next((k for k, (_, each) in enumerate(rows) if over & set(each.copies)), len(rows))
    found = [*rows[:first], spring]
    before = set[str]()
    for row, each in rows[first:]:
        through = coil.through(each.copies, before, length)
        before |= set(each.copies)
        if through:
            where = ", ".join(filter(None, (str(row[3]), through)))
            row = (*row[:3], where, *row[4:])
            each = each.also(f"it goes {through}")
        found.append((row, each))
    return found


_COLLAR = (
    0.5  # mm, by which a hole is wider than a motor's shaft where the collar round that goes in too
)
_UNDER = ("motor-bar", "battery-frame")  # roles of what goes under a plate as soon as that is there


def _low_mounts(assembly: Assembly) -> list[Mount]:
    """Where parts stand as long as the machine lies on the bench: those of a stand but its panel come later."""
    standing = {each.part for each in assembly.support.steps} if assembly.support else set()
    return [mount for mount in assembly.mounts if mount.part not in standing]


def _resting(assembly: Assembly) -> list[Mount]:
    """What lies on the bench, or on blocks there: a stand's panel, else all copies of the plate."""
    own = assembly.support.parts if assembly.support else frozenset()
    mounts = _low_mounts(assembly)
    name = assembly.frame.part if assembly.frame else GROUND
    panels = [mount for mount in mounts if mount.part in own]
    return panels or [mount for mount in mounts if mount.part == name]


_WIRES = 5.0  # mm, under a motor on its back


def depth_below(assembly: Assembly) -> int:
    """How high blocks under the plate, or under the panel of its stand, are at least, mm; 0 where nothing hangs below it."""
    ends = [mount.z for mount in _low_mounts(assembly)]
    ends += [
        low - (_WIRES if thing.drives else 0.0)
        for thing in assembly.stand_ins
        if thing.body == GROUND and thing.name != TABLE
        for low in (*(disc[2] for disc in thing.discs), *(bar[3] for bar in thing.bars))
    ]
    foot = min((mount.z for mount in _resting(assembly)), default=min(ends))
    return max(0, math.ceil(foot - min(ends) - SAME_POINT))


def _own_order(
    assembly: Assembly,
    before: Mapping[str, int] | None,
    blocks: int,
    by_hand: frozenset[tuple[str, str]],
) -> Table:
    """The order by height of all but the stand and what goes under the plate."""
    roles = {part.name: part.role for part in assembly.parts}
    over = [mount for mount in _low_mounts(assembly) if roles[mount.part] not in _UNDER]
    copies = standing_copies(assembly.parts, over, assembly.poses(np.zeros(1)), before)
    fixing = replace(assembly.process.fixing, by_hand=by_hand)
    return order(copies, assembly.features, fixing, blocks)


def hand_fits(assembly: Assembly) -> frozenset[tuple[str, str]]:
    """Holes of printed parts, by part and letter, in which something is glued where no vice gets in."""
    table = _own_order(assembly, None, 0, frozenset())
    fits = {each for step in table.steps for each in step.hand_fits}
    return frozenset(each for each in fits if assembly.by_name[each[0]].process == "printed")


def by_heights(
    assembly: Assembly,
    before: Mapping[str, int] | None = None,
    blocks: int = 0,
    by_hand: frozenset[tuple[str, str]] | None = None,
) -> Table:
    """The order by height of its own parts but the stand's; before: how many copies of each part are numbered already; blocks:
    height of those under the plate, mm, at least as high as all that hangs below it; by_hand: its hand fits, where these are known."""
    blocks = blocks or depth_below(assembly)
    by_hand = hand_fits(assembly) if by_hand is None else by_hand
    table = _own_order(assembly, before, blocks, by_hand)
    rows: list[Row] = []
    there = set[str]()
    for cells, step in zip(table.rows, table.steps, strict=True):
        coming = len({*step.copies} - there)  # what was loose comes again
        there |= {*step.copies}
        things = [
            replace(each, count=count * coming)
            for each in assembly.bought
            for part, count in each.at
            if part == cells[1] and coming
        ]
        rows.append(with_things((tuple(cells), step), things))
    return numbered(table, _on_plate(rows, assembly, blocks))


def _on_plate(rows: Sequence[Row], assembly: Assembly, blocks: int) -> Sequence[Row]:
    """Rows with what goes under the plate after it, and with blocks under it where something hangs below; blocks: their height, mm."""
    name = assembly.frame.part if assembly.frame else GROUND
    resting = _resting(assembly)
    if not resting:
        return rows
    last = max(k for k, (cells, _) in enumerate(rows) if cells[1] == name)
    last += sum(1 for _ in takewhile(lambda row: row[1].follows, rows[last + 1 :]))
    first = rows[0][0][1] == name  # else a loose shaft stands under it, where no one glues
    frames = [part for part in assembly.parts if part.role == "battery-frame"]
    glued = [_glued_below(part, assembly, first) for part in frames]
    screws = [each for each in assembly.bought if each.role == "mount" and assembly.support]
    under = [_bought_row(each) for each in screws]
    under += _motor_rows(assembly) if assembly.motor.reach is not None else []
    under += glued if first else []
    rows = [*rows[: last + 1], *under, *rows[last + 1 :]]
    if not first:  # what is glued below comes again with the plate
        plate = next(k for k, (cells, _) in enumerate(rows) if cells[1] == name)
        cells, step = rows[plate]
        below = [copy for _, each in glued for copy in each.copies[1:]]
        rows[plate] = cells, replace(step, copies=[*step.copies, *below])
    if blocks:
        lies = resting[0].part
        low = last if lies == name else next(k for k, row in enumerate(rows) if row[0][1] == lies)
        rows, borne = _borne_at_once(rows, low)
        what = "the plate" if lies == name else called(assembly.by_name[lies])
        aside = ", outside of the circle of the hand crank" if assembly.motor.crank else ""
        cells, step = rows[low]
        together = 0 < low == last - 1 and len(under) == len(screws) == 1
        lying = rows[0][0][1] == lies  # else it comes down on them, over shafts that stand there
        place = f"under {what}" if lying else f"on the bench for {what}"
        said = f"put two blocks at least {blocks} mm high {place}{aside}: parts hang below it"
        under_it = [Doing(said), *borne]
        doings = [*step.doings, *under_it] if lying or together else [*under_it, *step.doings]
        rows[low] = cells, replace(step, doings=doings)
        if together:
            rows[low : last + 2] = _screwed_together(rows[low : last + 2], assembly, screws[0])
    return rows if first else [*glued, *rows]


def _screwed_together(rows: Sequence[Row], assembly: Assembly, screw: Bought) -> Iterator[Row]:
    """Rows of a stand's panel and the plate, which go on a loose shaft, and of the screw between both: these are screwed together on the
    bench, for below the machine a screwdriver would push the shaft out."""
    (low, panel), (high, plate), (_, screwed) = rows
    names = [called(assembly.by_name[str(cells[1])]) for cells in (low, high)]
    group = str(low[1])
    laid = Doing("lay ", names[0], ON_BENCH)
    set_on = Doing("set ", f"{names[1]} on {names[0]}", ", hole over hole")
    yield (*low[:3], ON_BENCH.strip(), *low[4:]), Step([laid], panel.copies, group=group)
    cells, _ = with_things(((*high[:3], f"over {group}", *high[4:]), plate), [screw])
    doings = [set_on, *screwed.doings]
    yield cells, Step(doings, plate.copies, group=group, threads=screwed.threads)
    on = str(low[3])
    both = Doing("put ", f"both {on}", ", the panel below, on the two blocks")
    what = f"{low[2]} with {high[1]}"
    yield (
        (0, group, what, on, "", low[5], low[6]),
        replace(
            panel,
            doings=[*panel.doings[1:], both, *plate.doings[1:]],
            copies=[],
            group=group,
            mates=[*panel.mates, *plate.mates],
            hand_fits=[*panel.hand_fits, *plate.hand_fits],
            follows=False,
        ),
    )


def _borne_at_once(rows: Sequence[Row], low: int) -> tuple[list[Row], list[Doing]]:
    """Rows without the blocks under shafts that stand before the blocks under the plate come, each taken away after the last that asks for
    it, and what is done with these blocks."""
    standing = {copy.rpartition("-")[0] for _, step in rows[: low + 1] for copy in step.copies}
    found = list[Row](rows[: low + 1])
    borne = list[Doing]()
    last = dict[str, int]()  # row of the last that is glued on each shaft
    for cells, step in rows[low + 1 :]:
        own = [
            each
            for each in step.doings
            if each.verb.startswith("put ")
            and each.rest.endswith(MUST_NOT_SINK)
            and each.thing in standing
        ]
        borne += [each for each in own if each not in borne]
        last |= {each.thing: len(found) for each in own}
        kept = [each for each in step.doings if each not in own]
        found.append((cells, replace(step, doings=kept) if own else step))
    for shaft, k in last.items():
        cells, step = found[k]
        away = Doing("when the glue is hard, take the block out from under ", shaft)
        found[k] = cells, replace(step, doings=[*step.doings, away])
    return found, borne


def _row_of(part: Part, assembly: Assembly, doing: Doing) -> Row:
    """A row of all copies of a part that comes from below."""
    stands = [mount for mount in assembly.mounts if mount.part == part.name]
    copies = [f"{part.name}-{k}" for k in range(1, len(stands) + 1)]
    row = (0, part.name, holding_notes(part), "", len(copies), stands[0].z, "as drawn")
    return row, Step([doing], copies, 1)


def plate_of(assembly: Assembly) -> tuple[Part, Mount]:
    """The plate of the frame, and how it stands."""
    assert assembly.frame is not None, "nothing goes under no plate"
    name = assembly.frame.part
    return assembly.by_name[name], next(each for each in assembly.mounts if each.part == name)


_ON_GEARBOX = (
    f" on the motor's gearbox from the shaft's end, flush with its front, with {TWO_PART} on the edges of the front alone, none in the "
    "gears: nothing else keeps the motor from sliding out"
)


def _motor_rows(assembly: Assembly) -> Iterator[Row]:
    """A motor under the plate as soon as that is there, for later parts cover its screws; with the bar that lies behind it as one
    step, so that its picture shows both."""
    plate, stands = plate_of(assembly)
    first = [*_shortened(assembly.motor)]
    follows = False
    for part in (each for each in assembly.parts if each.role == "motor-bar"):
        mounts = [each for each in assembly.mounts if each.part == part.name]
        follows = True
        bar = called(part, len(mounts))
        if mounts[0].z + part.thickness < stands.z - SAME_POINT:
            yield _row_of(part, assembly, Doing("put ", bar, " behind the motor"))
        else:
            cells, step = _row_of(part, assembly, Doing("press ", bar, _ON_GEARBOX, (TWO_PART,)))
            yield cells, replace(step, doings=[*first, *step.doings])
            first = []
    motors = [thing for thing in assembly.stand_ins if thing.drives]
    discs = [disc for thing in motors for disc in thing.discs]
    points = {name: stands.place(z) for name, z in plate.points}
    letters = [name for at, *_ in discs for name, z in points.items() if abs(z - at) < SAME_POINT]
    count = sum(each.count for each in assembly.bought if each.role == "drive") or 1
    middle = stands.z + plate.thickness / 2
    through = f" through {listed(letters)}" if letters else ""
    one = f"the motor under the plate, its shaft up{through}"
    many = f"{count} motors under the plate, their shafts up{through}"
    its = "its" if count == 1 else "their"
    step = Step(
        [
            *first,
            *_collared(assembly, plate, letters, its),
            Doing("hold ", one if count == 1 else many, _fastening(assembly, its)),
        ],
        way=1,
        mates=[
            Mate(
                "free",
                name,
                (at.real, at.imag, middle),
                assembly.motor.shaft or 0.0,
                plate.thickness,
                True,
            )
            for name, at in points.items()
            if name in letters
        ],
        shapes=[*_motor_shapes(discs, stands.z, assembly.motor)],
        follows=follows,
    )
    said = "Motor: under the plate, its shaft through it; screw it on now, before parts cover the screws"
    screws = [each for each in assembly.bought if each.role == "drive screw"]
    yield with_things(((0, "motor", said, "", count, 0.0, "as bought"), step), screws)


def _shortened(motor: MotorSeat) -> Iterator[Doing]:
    """What is done with a shaft that what passes over it would meet."""
    if motor.most is not None:
        long = f", from the motor's face: file off what is longer than {motor.most:.4g} mm"
        why = f", for {motor.under} passes over its end. Keep the chips out of the motor"
        yield Doing("measure ", "the motor's shaft", f"{long}{why}", ("caliper", "file"))


def _collared(assembly: Assembly, plate: Part, letters: Sequence[str], its: str) -> Iterator[Doing]:
    """That the collar round a motor's shaft goes into the hole of the plate; letters: of the holes of their shafts, its: whose it is."""
    seats = [z for name, z in plate.points if name in letters]
    wide = max(
        (2 * r for hole in plate.region.holes for z, r in round_holes(hole) if z in seats),
        default=0.0,
    )
    if wide > assembly.motor.shaft + _COLLAR:
        motor = "the motor's" if its == "its" else "a motor's"
        goes = f" goes into {listed(letters)}, {wide:.4g} mm wide: scrape that until it does"
        yield Doing("the collar round ", f"{motor} shaft", goes, ("scraper",))


def _fastening(assembly: Assembly, its: str) -> str:
    """How motors are screwed on the plate, in words, behind where they are held; its: whose things are meant."""
    it = "it" if its == "its" else "them"
    bars = [part for part in assembly.parts if part.role == "motor-bar"]
    nuts = any(
        each.role == "drive screw" and each.standard == NUT_STANDARD for each in assembly.bought
    )
    below = f", its nuts below {called(bars[0])}" if nuts and bars else ""
    fed = any(each.role == "supply" for each in assembly.bought)
    supply = "the batteries" if fed else f"{its} supply"
    trial = f"Hold {its} wires to {supply}"
    if assembly.motor.frame:  # a stepper, which no supply turns by itself
        trial = f"Connect {it} to {its} driver{'' if its == 'its' else 's'}"
    return f", and screw {it} on now, from above{below}. {trial} and let {it} run before you go on: later parts cover the screws for good"


def _motor_shapes(
    discs: Iterable[tuple[complex, float, float, float]], plate: float, motor: MotorSeat
) -> Iterator[tuple[Sequence[complex], float, float]]:
    """Each motor and its shaft as prisms; plate: height of the plate's underside, mm."""
    for at, radius, low, high in discs:
        yield round_prism(at, radius), low, high
        if motor.shaft and motor.reach is not None:
            yield round_prism(at, motor.shaft / 2), high, plate + motor.reach


def _glued_below(part: Part, assembly: Assembly, there: bool) -> Row:
    """A row of what is glued under the plate, with its place by distances that one measures: of two corners of its opening from
    the two lettered holes of the plate that are next to each.

    there: whether the plate is; else it comes too, and once more when it is put in.
    """
    plate, stands = plate_of(assembly)
    mount = next(each for each in assembly.mounts if each.part == part.name)
    points = [(stands.place(z), name) for name, z in plate.points]
    near = list[tuple[float, str]]()
    for piece in part.drawn.region.holes[0].pieces:
        corner = mount.place(start_point(piece))
        (a, one), (b, other) = sorted((abs(z - corner), name) for z, name in points)[:2]
        near.append(
            (a + b, f"{a:.1f} mm from the middle of {one} and {b:.1f} mm from that of {other}")
        )
    (_, one), (_, other) = sorted(near)[:2]
    where = "under the plate" if there else "on it"
    rest = f" {where}. One of its inner corners is {one}, another is {other}"
    cells, step = _row_of(part, assembly, Doing("glue ", called(part), rest))
    sides = [*_glued_sides(part, mount, stands.z)]
    step = replace(step, mates=sides, glued=sides)
    if there:
        return cells, step
    lay = Doing("lay ", called(plate), " on the bench, its underside up")
    copies = [f"{plate.name}-1", *step.copies]
    pressed = list[Doing]()
    if high := _stands_out(assembly, plate, stands):
        least = math.floor(high) + 1
        rest = (
            f", its underside up, on two blocks at least {least} mm high: its pins stick out below"
        )
        pressed = [replace(lay, rest=rest, props=(least, least)), *step.doings]
    return cells, replace(step, doings=[lay, *step.doings], copies=copies, pressed=pressed)


def _glued_sides(frame: Part, mount: Mount, high: float) -> Iterator[Mate]:
    """Where a frame is glued under a plate, for the picture: the middle of each side, at the height of the plate's underside, mm."""
    (opening,) = frame.drawn.region.holes
    wall = extent([frame.drawn.region.outer])[1].real - extent([opening])[1].real
    for piece in opening.pieces:
        middle = (start_point(piece) + end_point(piece)) / 2
        at = mount.place(middle + wall / 2 * middle / abs(middle))
        yield Mate("glue", "", (at.real, at.imag, high), wall, wall)


def _stands_out(assembly: Assembly, plate: Part, stands: Mount) -> float:
    """How far the longest pin stands out of the upper face of a plate into which it is pressed from below, mm; 0 of none."""
    fixing = with_joints(assembly.process.fixing, assembly.features)
    copies = standing_copies(assembly.parts, assembly.mounts, assembly.poses(np.zeros(1)))
    plates = [copy for copy in copies if copy.part is plate]
    top = stands.z + plate.thickness
    return max(
        (
            outline.high - top
            for copy in copies
            if copy.mount.z < stands.z + SAME_POINT
            and any(mate.how != "free" for mate in mates_between([copy], plates, fixing))
            for outline in copy.outlines
        ),
        default=0.0,
    )


def _top(part: Part, mount: Mount) -> float:
    """How high a part reaches where it stands, mm."""
    over = extent([part.region.outer])[1].imag if mount.upright else part.thickness
    return mount.z + over


def _turned_over(assembly: Assembly) -> Doing:
    """That a machine with a stand, which lies face up till then, is turned over, and how deep its front is, with what of the stand
    comes while it lies so."""
    front = max(_top(assembly.by_name[mount.part], mount) for mount in assembly.mounts)
    rest = _resting(assembly)[0]
    high = math.ceil(front - rest.z - assembly.by_name[rest.part].thickness - SAME_POINT)
    on = f"on blocks at least {high} mm high, beside all that moves"
    return Doing(f"turn the machine over, its back up, with the panel's edges {on}")


def _last_rows(assembly: Assembly) -> Iterator[Row]:
    """What the machine is put on at the end."""
    last = (
        (0, "table" if assembly.support else "board", assembly.board, "", 1, 0.0, "as yours"),
        Step([Doing(assembly.board)]),
    )
    if assembly.support is None:
        screws = [each for each in assembly.bought if each.role == "mount"]
        yield with_things(last, [*screws, *coupled(assembly)])
        return
    turned = False  # whether it lies on its front
    for each in assembly.support.steps:
        name, where = each.part, each.where
        mounts = [mount for mount in assembly.mounts if mount.part == name]
        copies = [f"{name}-{k + 1}" for k in range(len(mounts))]
        low = min(mount.z for mount in mounts)
        part = assembly.by_name[name]
        row = 0, name, part.title, where, len(mounts), low, "upright"
        doings = [Doing("glue ", called(part, len(mounts)), f" {where}")]
        if each.along[2] > 0 and not turned:
            dry = "each tab in its slot, dry, and scrape what is tight"
            doings = [_turned_over(assembly), Doing("try ", dry, needs=("scraper",)), *doings]
            turned = True
        mates = [
            Mate("glue", "", (at.real, at.imag, z), 1.5 * each.thick, each.thick)
            for at, z in each.glued
        ]
        below = each.along[2] > 0
        yield row, Step(doings, copies, 1 if below else -1, mates, along=each.along)
    yield with_things(last, coupled(assembly))
