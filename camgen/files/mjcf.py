"""MJCF: the machine as MuJoCo simulates it, a text with a mesh for each part.   [MuJoCo documentation, XML Reference]

    frame    what stands still, turned so that up is z; fixed in the world, or free on a floor
    link     a moving body on its parent, by a hinge, a slide or nothing; at zero it stands as at the start
    loop     two sites of two bodies that stay together
    coupling joints whose weighted sum stays zero, as a tendon of fixed length
    foot     a capsule across the plane of motion; nothing else touches the floor

Here lengths are mm, masses kg; the file has m. Loops are as stiff as the integrator allows: softer ones let a leg with a small
transmission angle snap over to its other branch. Same machine, same bytes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal
from xml.etree import ElementTree as ET

import numpy as np

from camgen.files.gltf import Shape, upright
from camgen.numerics import Floats
from camgen.parts.inertia import MassMoments

MESHES = "meshes"  # folder of the meshes beside the text
_MM = 1e-3
_FINEST = 1.75e-3  # rad, 0.1 deg, that the drive turns in a step at most: a foot's error goes with the square
_STEPS = (5e-4, 2.5e-4, 1e-4, 5e-5, 2.5e-5, 1e-5)  # s
_SPEED_GAIN = 1.0  # N m s/rad, of a drive that holds its speed
_SLIDING = (
    3.0  # rad/s, at which a machine turns whose drive slides, as far as the step is concerned
)

Freedom = Literal["fixed", "plane", "space"]


@dataclass(frozen=True)
class Hinge:
    """Turns about z at the link's own place `at`, complex mm; a spring draws it to `rest`, rad, with `stiffness`, N m/rad."""

    name: str
    at: complex = 0j
    stiffness: float = 0.0
    rest: float = 0.0


@dataclass(frozen=True)
class Slider:
    """Slides along a direction of the link's frame, a unit complex."""

    name: str
    along: complex


@dataclass(frozen=True)
class Foot:
    """A capsule: its axis at `at` of its link, complex mm, from low to high, mm; its radius, mm."""

    name: str
    at: complex
    low: float
    high: float
    radius: float


@dataclass(frozen=True, eq=False)
class Link:
    """A moving body: where its frame is on its parent's, how it moves on it, its mass, and what is on it.

    copies: of parts, as (name, number of the shape, transform (3, 4) in the link's frame, mm); sites: places with names, mm.
    """

    name: str
    parent: str
    at: complex
    angle: float
    joint: Hinge | Slider | None
    mass: MassMoments
    copies: Sequence[tuple[str, int, Floats]] = ()
    sites: Sequence[tuple[str, complex]] = ()
    feet: Sequence[Foot] = ()


@dataclass(frozen=True)
class Coil:
    """A spring between two sites, N/mm, free length mm."""

    name: str
    ends: tuple[str, str]
    rate: float
    free: float


@dataclass(frozen=True)
class Rub:
    """A pin that rubs: the hinge of that name, or a loop's pin, with the shares of hinges whose angles sum up to its own."""

    name: str
    radius: float  # of its friction circle, mm
    shares: Mapping[str, float] | None = None  # of a loop's


@dataclass(frozen=True)
class Motor:
    """What drives a joint: at `speed`, rad/s (mm/s of a slide); by a line from `stall`, N m, to `no_load`, rad/s, where known."""

    joint: str
    speed: float
    stall: float | None = None
    no_load: float = math.inf
    slides: bool = False

    @property
    def control(self) -> float:
        """The value of MuJoCo's ctrl at which it runs as wanted."""
        if self.stall is not None:
            return math.copysign(1.0, self.speed)
        return self.speed * (_MM if self.slides else 1.0)


@dataclass(frozen=True, eq=False)
class Model:
    """A machine: its frame first, of which parent, place and joint say nothing, then its links, each behind its parent.

    down: a unit vector of the machine; height: of the frame's origin over the floor, mm; friction: of feet on it.
    """

    name: str
    shapes: Sequence[Shape]
    frame: Link
    links: Sequence[Link]
    loops: Sequence[tuple[str, str, str]]  # name, and both sites
    couplings: Mapping[str, Mapping[str, float]]  # shares by joint
    coils: Sequence[Coil]
    motor: Motor
    down: tuple[float, float, float]
    freedom: Freedom = "fixed"
    height: float = 0.0
    friction: float = 0.6
    remarks: Sequence[str] = ()
    rubs: Sequence[Rub] = ()  # which the text leaves out: MJCF has constant friction alone

    @property
    def mass(self) -> float:
        """Of all, kg."""
        return sum(link.mass.mass for link in (self.frame, *self.links))

    @property
    def width(self) -> float:
        """Of the feet over all, across the plane of motion, mm; 0 without feet."""
        ends = [z for link in self.links for foot in link.feet for z in (foot.low, foot.high)]
        return max(ends, default=0.0) - min(ends, default=0.0)

    @property
    def bare(self) -> Model:
        """The same without meshes, which only show."""
        links = [replace(link, copies=()) for link in self.links]
        return replace(self, shapes=(), frame=replace(self.frame, copies=()), links=links)

    @property
    def step(self) -> float:
        """Seconds of a step."""
        motor = self.motor
        turning = abs(motor.speed) if motor.stall is None else motor.no_load
        turning = _SLIDING if motor.slides else turning
        return next((step for step in _STEPS if step * turning <= _FINEST), _STEPS[-1])


def text(model: Model) -> str:
    """The file's text."""
    root = ET.Element("mujoco", model=model.name)
    for remark in model.remarks:
        root.append(ET.Comment(f" {remark.replace('--', '-')} "))
    _settings(root, model)
    asset = ET.SubElement(root, "asset")
    for shape in model.shapes:
        scale = _numbers([_MM] * 3)
        ET.SubElement(asset, "mesh", name=shape.name, file=f"{shape.name}.stl", scale=scale)
    world = ET.SubElement(root, "worldbody")
    if model.freedom != "fixed":
        colour = "0.85 0.86 0.84 1"
        ET.SubElement(
            world, "geom", {"name": "floor", "class": "floor", "size": "0 0 0.1", "rgba": colour}
        )
    nodes = {model.frame.name: _frame(world, model)}
    for link in model.links:
        node = ET.SubElement(nodes[link.parent], "body", {"name": link.name} | _stand(link))
        nodes[link.name] = node
        _joint(node, link.joint)
        _content(node, link, model.shapes)
    _ties(root, model)
    _drive(root, model.motor)
    ET.indent(root, "  ")
    return ET.tostring(root, encoding="unicode") + "\n"


def _settings(root: ET.Element, model: Model) -> None:
    """Units, the integrator, and how stiff loops and contacts are."""
    ET.SubElement(
        root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false", meshdir=MESHES
    )
    option = {"timestep": _number(model.step), "integrator": "discrete", "solver": "Newton"}
    option |= {"iterations": "100", "tolerance": "1e-12", "cone": "elliptic", "impratio": "10"}
    ET.SubElement(root, "option", option, gravity="0 0 -9.80665")
    default = ET.SubElement(root, "default")
    stiff = {"solref": _numbers([2 * model.step, 1]), "solimp": "0.9999 0.9999 0.0001 0.5 2"}
    ET.SubElement(default, "equality", stiff)
    ET.SubElement(default, "site", size="0.001", group="4")
    look = ET.SubElement(default, "default", {"class": "part"})
    seen = {"type": "mesh", "contype": "0", "conaffinity": "0", "mass": "0", "group": "2"}
    ET.SubElement(look, "geom", seen)
    touch = {"condim": "3", "friction": f"{_number(model.friction)} 0.001 0.0001"}
    touch |= {"solref": "0.004 1", "solimp": "0.95 0.99 0.0005 0.5 2"}
    kinds = {
        "floor": {"type": "plane", "contype": "0", "conaffinity": "1"},
        "foot": {"type": "capsule", "contype": "1", "conaffinity": "0", "group": "3"},
    }
    for name, kind in kinds.items() if model.freedom != "fixed" else ():
        ET.SubElement(ET.SubElement(default, "default", {"class": name}), "geom", kind | touch)


def _frame(world: ET.Element, model: Model) -> ET.Element:
    """What stands still, or on the floor."""
    half = math.sqrt(0.5)
    stands = _product((half, 0.0, 0.0, half), upright(model.down))
    place = {"pos": _numbers([0, 0, _MM * model.height]), "quat": _quaternion(stands)}
    node = ET.SubElement(world, "body", {"name": model.frame.name} | place)
    if model.freedom == "space":
        ET.SubElement(node, "freejoint", name="free")
    if model.freedom == "plane":
        for name, kind, axis in (
            ("forward", "slide", "1 0 0"),
            ("upward", "slide", "0 1 0"),
            ("tilt", "hinge", "0 0 1"),
        ):
            ET.SubElement(node, "joint", name=name, type=kind, axis=axis)
    _content(node, model.frame, model.shapes)
    return node


def _stand(link: Link) -> dict[str, str]:
    """Where a link's frame is on its parent's."""
    turn = (0.0, 0.0, math.sin(link.angle / 2), math.cos(link.angle / 2))
    return {"pos": _place(link.at), "quat": _quaternion(turn)}


def _joint(node: ET.Element, joint: Hinge | Slider | None) -> None:
    if isinstance(joint, Slider):
        axis = _numbers([joint.along.real, joint.along.imag, 0])
        ET.SubElement(node, "joint", name=joint.name, type="slide", axis=axis)
    elif joint is not None:
        spring = {"stiffness": _number(joint.stiffness), "springref": _number(joint.rest)}
        held = {"name": joint.name, "type": "hinge", "axis": "0 0 1", "pos": _place(joint.at)}
        ET.SubElement(node, "joint", held | (spring if joint.stiffness else {}))


def _content(node: ET.Element, link: Link, shapes: Sequence[Shape]) -> None:
    """Mass, parts, sites and feet of a body."""
    tensor = 1e-6 * link.mass.tensor
    rows = (0, 1, 2, 0, 0, 1)
    columns = (0, 1, 2, 1, 2, 2)
    ET.SubElement(
        node,
        "inertial",
        pos=_numbers(_MM * link.mass.centre),
        mass=_number(link.mass.mass),
        fullinertia=_numbers(tensor[rows, columns]),
    )
    for name, number, transform in link.copies:
        shape = shapes[number]
        place = {
            "pos": _numbers(_MM * transform[:, 3]),
            "quat": _quaternion(_rotation(transform[:, :3])),
        }
        colour = _numbers([*(int(shape.colour[k : k + 2], 16) / 255 for k in (1, 3, 5)), 1])
        ET.SubElement(
            node,
            "geom",
            {"name": name, "class": "part", "mesh": shape.name, **place, "rgba": colour},
        )
    for name, at in link.sites:
        ET.SubElement(node, "site", name=name, pos=_place(at))
    for foot in link.feet:
        ends = [
            _MM * value for z in (foot.low, foot.high) for value in (foot.at.real, foot.at.imag, z)
        ]
        size = _number(_MM * foot.radius)
        ET.SubElement(
            node,
            "geom",
            {"name": foot.name, "class": "foot", "fromto": _numbers(ends), "size": size},
        )


def _ties(root: ET.Element, model: Model) -> None:
    """Springs, couplings and loops."""
    if model.coils or model.couplings:
        tendons = ET.SubElement(root, "tendon")
        for coil in model.coils:
            rate = {"stiffness": _number(coil.rate / _MM), "springlength": _number(_MM * coil.free)}
            spatial = ET.SubElement(tendons, "spatial", {"name": coil.name} | rate)
            for end in coil.ends:
                ET.SubElement(spatial, "site", site=end)
        for name, shares in model.couplings.items():
            fixed = ET.SubElement(tendons, "fixed", name=name)
            for joint, share in shares.items():
                ET.SubElement(fixed, "joint", joint=joint, coef=_number(share))
    if model.loops or model.couplings:
        equality = ET.SubElement(root, "equality")
        for name, a, b in model.loops:
            ET.SubElement(equality, "connect", name=name, site1=a, site2=b)
        for name in model.couplings:
            ET.SubElement(equality, "tendon", name=name, tendon1=name)


def _drive(root: ET.Element, motor: Motor) -> None:
    """The motor, and a key frame at which it is on."""
    actuator = ET.SubElement(root, "actuator")
    if motor.stall is None:
        gain = _number(_SPEED_GAIN / _MM if motor.slides else _SPEED_GAIN)
        ET.SubElement(actuator, "velocity", name="drive", joint=motor.joint, kv=gain)
    else:
        line = {"gainprm": _number(motor.stall), "biastype": "affine"}
        line["biasprm"] = _numbers([0, 0, -motor.stall / motor.no_load])
        ET.SubElement(actuator, "general", {"name": "drive", "joint": motor.joint} | line)
    ET.SubElement(ET.SubElement(root, "keyframe"), "key", name="on", ctrl=_number(motor.control))


# ---- numbers ---------------------------------------------------------------------------------------------------------


def _number(value: float) -> str:
    """Twelve digits, never -0."""
    return f"{float(value):z.12g}"


def _numbers(values: Sequence[float] | Floats) -> str:
    """Several, what rounds to nothing beside the largest as 0."""
    row = np.asarray(values, float)
    row = np.where(np.abs(row) < 1e-15 * np.max(np.abs(row), initial=0.0), 0.0, row)
    return " ".join(map(_number, row))


def _place(at: complex) -> str:
    """A place of the plane of motion, m; to 1e-12 m, where other processors' last digits do not show."""
    return _numbers([round(_MM * at.real, 12), round(_MM * at.imag, 12), 0])


def _quaternion(xyzw: Sequence[float]) -> str:
    """As MuJoCo writes it, w first."""
    x, y, z, w = (round(value, 12) for value in xyzw)
    return _numbers([w, x, y, z])


def _product(a: Sequence[float], b: Sequence[float]) -> list[float]:
    """The turn b and then a; quaternions (x, y, z, w)."""
    u = np.array(a[:3])
    v = np.array(b[:3])
    vector = a[3] * v + b[3] * u + np.cross(u, v)
    return [*map(float, vector), float(a[3] * b[3] - np.sum(u * v))]


def _rotation(matrix: Floats) -> list[float]:
    """Quaternion (x, y, z, w) of a rotation (3, 3), by its largest component."""
    trace = float(np.trace(matrix))
    squares = np.array([*(1 + 2 * np.diag(matrix) - trace), 1 + trace]) / 4
    products = np.empty((4, 4))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        products[i, j] = products[j, i] = (matrix[i, j] + matrix[j, i]) / 4
        products[k, 3] = products[3, k] = (matrix[j, i] - matrix[i, j]) / 4
    products[np.diag_indices(4)] = squares
    largest = int(np.argmax(squares))
    row = products[largest]
    return [float(value) for value in row / math.sqrt(squares[largest])]
