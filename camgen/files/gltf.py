"""GLB: the machine with one turn as its animation, for viewers, Blender and the report's own page (glTF 2.0, binary).

    root     turned so that what is up becomes y, and scaled by 0.001: mm become m, as glTF has them
    body     a node that moves, every copy of a part on it a node that stands where it is mounted
    mesh     one for each part, coarse and without normals: flat faces, as glTF says of such meshes

Same machine, same bytes.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camgen._version import __version__
from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError
from camgen.geometry.mesh import Mesh
from camgen.numerics import Floats, Points

SECONDS = 8.0  # a turn takes
# numbers: float32, uint16, uint32
_FLOAT = 5126
_SHORT = 5123
_LONG = 5125
# what a buffer view is for
_VERTICES = 34962
_INDICES = 34963


@dataclass(frozen=True, eq=False)
class Shape:
    """A part: its name, its solid in its own frame, mm, and its colour, #rrggbb."""

    name: str
    mesh: Mesh
    colour: str


@dataclass(frozen=True, eq=False)
class Track:
    """A body over a turn: angle (n,) rad and place (n,) complex mm at even times, the last one before the first again.

    copies: on it, as (name, number of the shape, transform (3, 4) in the body's frame, mm). standing: its plane stands, its x as
    the machine's -y, y as z and z as -x.
    """

    name: str
    angle: Floats
    place: Points
    copies: Sequence[tuple[str, int, Floats]]
    standing: bool = False


# Quaternion (x, y, z, w) of a plane that stands, and how that is read back: within float32 about its own z.
_STANDING = (0.5, -0.5, -0.5, 0.5)
_OFF = 1e-6

LYING = (0.0, 0.0, -1.0)  # which way is down where the plate lies on the table


def upright(down: tuple[float, float, float]) -> list[float]:
    """Quaternion (x, y, z, w) that turns the machine's axes into those of glTF: up is y, what is seen from the front z.

    down: a unit vector, along z or across it. A machine that lies is seen from its -y, one that stands up from its z.
    """
    half = math.sqrt(0.5)
    if down[2]:
        return [math.copysign(half, down[2]), 0, 0, half]
    angle = math.pi / 2 - math.atan2(-down[1], -down[0])
    return [0, 0, math.sin(angle / 2), math.cos(angle / 2)]


def glb(
    name: str,
    shapes: Sequence[Shape],
    bodies: Sequence[Track],
    turns: int = 1,
    down: tuple[float, float, float] = LYING,
) -> bytes:
    """The file's bytes; turns: over which the bodies are given; down: a unit vector, see `upright`."""
    pack = _Pack()
    meshes = []
    materials = []
    for k, shape in enumerate(shapes):
        vertices = _single(shape.mesh.vertices)
        faces = shape.mesh.faces.ravel()
        wide = len(vertices) > 65535
        points = pack.add(vertices, _FLOAT, "VEC3", _VERTICES, bounds=True)
        corners = pack.add(
            faces.astype("<u4" if wide else "<u2"), _LONG if wide else _SHORT, "SCALAR", _INDICES
        )
        primitive = {"attributes": {"POSITION": points}, "indices": corners, "material": k}
        meshes.append({"name": shape.name, "primitives": [primitive]})
        factor = {
            "baseColorFactor": [*_linear(shape.colour), 1],
            "metallicFactor": 0,
            "roughnessFactor": 0.7,
        }
        materials.append({"name": shape.name, "pbrMetallicRoughness": factor})
    nodes: list[dict[str, Any]] = [
        {"name": name, "rotation": upright(down), "scale": [0.001] * 3, "children": []}
    ]
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []
    frames = len(bodies[0].angle) if bodies else 0
    times = np.linspace(0, turns * SECONDS, frames + 1).astype("<f4")
    time = pack.add(times, _FLOAT, "SCALAR", bounds=True) if frames > 1 else -1
    for body in bodies:
        number = len(nodes)
        nodes[0]["children"].append(number)
        quaternions, places = _course(body)
        node: dict[str, Any] = {
            "name": body.name,
            "rotation": quaternions[0].tolist(),
            "translation": places[0].tolist(),
        }
        nodes.append(node)
        for path, values, kind in (
            ("rotation", quaternions, "VEC4"),
            ("translation", places, "VEC3"),
        ):
            if np.ptp(values, axis=0).max() > 1e-7:
                channels.append(
                    {"sampler": len(samplers), "target": {"node": number, "path": path}}
                )
                samplers.append({"input": time, "output": pack.add(values, _FLOAT, kind)})
        node["children"] = list(range(len(nodes), len(nodes) + len(body.copies)))
        for copy, shape_number, transform in body.copies:
            matrix = [
                float(f"{value:z.9g}") for value in np.vstack([transform, [0, 0, 0, 1]]).T.ravel()
            ]
            placing = {} if matrix == np.eye(4).ravel().tolist() else {"matrix": matrix}
            nodes.append({"name": copy, "mesh": shape_number, **placing})
    whole = {
        "asset": {"version": "2.0", "generator": f"camgen {__version__}"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{key: value for key, value in node.items() if value != []} for node in nodes],
        "meshes": meshes,
        "materials": materials,
        **(
            {"animations": [{"name": "one turn", "channels": channels, "samplers": samplers}]}
            if channels
            else {}
        ),
        "accessors": pack.accessors,
        "bufferViews": pack.views,
        "buffers": [{"byteLength": len(pack.data)}],
    }
    text = json.dumps(whole, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(pack.data)
    head = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(pack.data), b"BIN\0") + bytes(pack.data)


class _Pack:
    """The binary chunk, and what stands where in it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, int]] = []
        self.accessors: list[dict[str, Any]] = []

    def add(
        self, values: Any, number: int, kind: str, target: int = 0, bounds: bool = False
    ) -> int:
        """Append an array; the number of its accessor."""
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        if target:
            self.views[-1]["target"] = target
        ends = (
            {
                "min": np.atleast_1d(values.min(0)).tolist(),
                "max": np.atleast_1d(values.max(0)).tolist(),
            }
            if bounds
            else {}
        )
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": number,
                "count": len(values),
                "type": kind,
                **ends,
            }
        )
        self.data += values.tobytes()
        self.data += bytes(-len(self.data) % 4)
        return len(self.accessors) - 1


def _course(body: Track) -> tuple[Any, Any]:
    """Quaternions (n + 1, 4), consecutive ones on one side, and places (n + 1, 3), float32, the end as the start.

    Where the machine cannot go, the body waits where it was last.
    """
    angle = np.asarray(body.angle, float)
    place = np.asarray(body.place, complex)
    valid = np.flatnonzero(np.isfinite(angle) & np.isfinite(place))
    if not len(valid):
        angle = np.zeros(len(angle))
        place = np.zeros(len(angle), complex)
        valid = np.arange(len(angle))
    last = valid[np.maximum(np.searchsorted(valid, np.arange(len(angle)), side="right") - 1, 0)]
    half = np.unwrap(np.append(angle[last], angle[last[0]])) / 2
    place = np.append(place[last], place[last[0]])
    zero = np.zeros(len(half))
    quaternions = np.column_stack([zero, zero, np.sin(half), np.cos(half)])
    if not body.standing:
        return _single(quaternions), _single(np.column_stack([place.real, place.imag, zero]))
    turned = _product(np.array(_STANDING), quaternions)
    return _single(turned), _single(np.column_stack([zero, -place.real, place.imag]))


def _product(first: Floats, then: Floats) -> Floats:
    """The turn `then` and after it `first`; quaternions (x, y, z, w), (4,) and (n, 4)."""
    a = first[:3]
    w = first[3]
    b = then[:, :3]
    v = then[:, 3]
    return np.column_stack([v[:, None] * a + w * b + np.cross(a, b), w * v - b @ a])


def _single(values: Floats) -> Any:
    """Numbers as the binary chunk has them, float32, none of them -0."""
    return np.asarray(values, "<f4") + np.float32(0)


def _linear(colour: str) -> list[float]:
    """A colour of the screen, #rrggbb, as glTF has it: linear, 0..1 each."""
    shares = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    return [
        float(f"{v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4:.6g}") for v in shares
    ]


# ---- read back -------------------------------------------------------------------------------------------------------

_SIZE = Bound("a GLB", 200_000_000)
_HEAD = 20  # bytes of the file's header and of its first chunk's
_MOST_SAID = 10_000_000  # bytes of JSON in a file
# What may be said of the whole and of each kind of node: anything else could move, scale or hide something.
_PARTS = {
    "asset",
    "scene",
    "scenes",
    "nodes",
    "meshes",
    "materials",
    "animations",
    "accessors",
    "bufferViews",
    "buffers",
}
_ROOT = {"name", "rotation", "scale", "children"}
_BODY = {"name", "rotation", "translation", "children"}
_COPY = {"name", "mesh", "matrix"}
_VIEW = {"buffer", "byteOffset", "byteLength", "target"}
_TOOK = {_FLOAT: "<f4", _SHORT: "<u2", _LONG: "<u4"}
_WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


@dataclass(frozen=True, eq=False)
class Course:
    """A body as read: seconds (n,) s, angle (n,) rad and place (n,) complex mm, one of each where it stands still.

    copies: on it, as (name, name of the mesh, transform (3, 4) in the body's frame, mm). standing: as of a track.
    """

    name: str
    seconds: Floats
    angle: Floats
    place: Points
    copies: Sequence[tuple[str, str, Floats]]
    standing: bool = False


def read_glb(path: Path, down: tuple[float, float, float] = LYING) -> list[Course]:
    """The bodies of a machine as `glb` writes it; FileError of a file that holds or says anything else, or has another side
    down."""
    try:
        return _Glb(read_bytes(path, _SIZE)).courses(down)
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        RecursionError,
        TypeError,
        ValueError,
        struct.error,
    ) as error:
        raise FileError(path, f"not a machine in GLB as camgen writes it: {error}") from None


class _Glb:
    """A file's two chunks."""

    def __init__(self, data: bytes) -> None:
        if len(data) < _HEAD:
            raise ValueError(f"it is cut short: {len(data)} bytes")
        mark, version, size, length, kind = struct.unpack_from("<4sIII4s", data)
        if (mark, version, size, kind) != (b"glTF", 2, len(data), b"JSON"):
            raise ValueError("it is no glTF 2.0, or not as long as it says")
        if length > _MOST_SAID:
            raise ValueError(f"{length:,} bytes of JSON; at most {_MOST_SAID:,} are read")
        self.whole = json.loads(data[20 : 20 + length])
        (length_of_rest, kind) = struct.unpack_from("<I4s", data, 20 + length)
        self.data = data[28 + length :]
        if kind != b"BIN\0" or length_of_rest != len(self.data) or not self.whole.keys() <= _PARTS:
            raise ValueError("chunks or tables that do not belong there")
        self.nodes = self.whole["nodes"]

    def array(self, number: int) -> Any:
        """What an accessor tells, (n, k)."""
        accessor = self.whole["accessors"][number]
        view = self.whole["bufferViews"][accessor["bufferView"]]
        if not (
            accessor.keys() <= {"bufferView", "componentType", "count", "type", "min", "max"}
            and view.keys() <= _VIEW
        ):
            raise ValueError(f"accessor {number} says more than what stands where")
        raw = self.data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        values = np.frombuffer(raw, _TOOK[accessor["componentType"]]).reshape(
            -1, _WIDTH[accessor["type"]]
        )
        if len(values) != accessor["count"] or not np.all(np.isfinite(values)):
            raise ValueError(
                f"accessor {number} has {len(values)} finite values instead of {accessor['count']}"
            )
        return values

    def courses(self, down: tuple[float, float, float]) -> list[Course]:
        """All bodies."""
        root = self.node(0, _ROOT)
        if (self.whole["scene"], self.whole["scenes"]) != (0, [{"nodes": [0]}]):
            raise ValueError("another scene")
        if not np.allclose(
            [*root["rotation"], *root["scale"]], [*upright(down), *[0.001] * 3], rtol=0, atol=1e-7
        ):
            raise ValueError("the whole is turned or scaled otherwise")
        tracks = self.moved()
        courses = [self.course(number, tracks) for number in root.get("children", [])]
        if tracks or 1 + len(courses) + sum(len(each.copies) for each in courses) != len(
            self.nodes
        ):
            raise ValueError("a node that is no body and stands on none")
        return courses

    def node(self, number: int, keys: set[str]) -> dict[str, Any]:
        """A node that may have these keys."""
        node: dict[str, Any] = self.nodes[number]
        if not (node.keys() <= keys and isinstance(node["name"], str)):
            raise ValueError(
                f"node {number} has {', '.join(sorted(node.keys() - keys)) or 'no name'}"
            )
        return node

    def moved(self) -> dict[tuple[int, str], tuple[Any, Any]]:
        """Times and values by node and what of it they move."""
        tracks = {}
        for animation in self.whole.get("animations", []):
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                target = channel["target"]
                if (
                    sampler.keys() != {"input", "output"}
                    or (target["node"], target["path"]) in tracks
                ):
                    raise ValueError(
                        "a motion that is not from time to time in straight lines, or twice"
                    )
                tracks[target["node"], target["path"]] = (
                    self.array(sampler["input"]),
                    self.array(sampler["output"]),
                )
        return tracks

    def course(self, number: int, tracks: dict[tuple[int, str], tuple[Any, Any]]) -> Course:
        """A body; what moves it is taken out of `moved`."""
        node = self.node(number, _BODY)
        still = np.zeros((1, 1))
        start = [
            np.array([node.get("rotation", [0, 0, 0, 1])], float),
            np.array([node.get("translation", [0, 0, 0])], float),
        ]
        times, quaternions = tracks.pop((number, "rotation"), (still, start[0]))
        place_times, places = tracks.pop((number, "translation"), (still, start[1]))
        if not all(
            np.array_equal(first[0], course[0])
            for first, course in zip(start, (quaternions, places), strict=True)
        ):
            raise ValueError(f"{node['name']} stands elsewhere than where its motion begins")
        times = times if len(times) > 1 else place_times
        standing = bool(quaternions[:, :2].any())
        if standing:
            back = np.array(_STANDING) * (-1, -1, -1, 1)
            quaternions = _product(back, np.asarray(quaternions, float))
            quaternions[:, :2] *= np.abs(quaternions[:, :2]) > _OFF
            places = np.column_stack([-places[:, 1], places[:, 2], places[:, 0]])
        if quaternions[:, :2].any() or places[:, 2].any():
            raise ValueError(f"{node['name']} moves out of its plane")
        if any(len(each) not in (1, len(times)) for each in (place_times, quaternions, places)):
            raise ValueError(f"{node['name']} has not as many places as times")
        if len(place_times) > 1 and not np.array_equal(times, place_times):
            raise ValueError(f"{node['name']} turns and moves at different times")
        if not np.allclose(np.hypot(quaternions[:, 2], quaternions[:, 3]), 1, rtol=0, atol=1e-6):
            raise ValueError(f"{node['name']} has a turn that is none")
        angle = 2 * np.arctan2(quaternions[:, 2].astype(float), quaternions[:, 3].astype(float))
        place = places[:, 0].astype(float) + 1j * places[:, 1].astype(float)
        n = len(times)
        copies = [self.copy(child) for child in node.get("children", [])]
        return Course(
            node["name"],
            times[:, 0].astype(float),
            np.resize(angle, n),
            np.resize(place, n),
            copies,
            standing,
        )

    def copy(self, number: int) -> tuple[str, str, Floats]:
        """A copy of a part on a body."""
        node = self.node(number, _COPY)
        mesh = self.whole["meshes"][self.node(number, _COPY)["mesh"]]
        matrix = np.array(node.get("matrix", np.eye(4).ravel()), float).reshape(4, 4).T
        if not np.array_equal(matrix[3], [0, 0, 0, 1]) or not np.all(np.isfinite(matrix)):
            raise ValueError(f"node {number} has a matrix that is no placing")
        return node["name"], str(mesh["name"]), matrix[:3]
