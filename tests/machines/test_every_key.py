"""Every key of every mechanism, by its schema: what is no value is told by its path, what is extreme ends well."""

from __future__ import annotations

import copy
import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from camgen import reading
from camgen import spec as specs
from camgen.errors import CamgenError, DesignError, SpecError
from camgen.machines import MECHANISMS, load

SPECS = Path(__file__).resolve().parents[2] / "specs"
NOTHING = (math.nan, math.inf, -math.inf, 10**400, {}, {"x": 1}, [[[0]]], [None])
EXTREMES = (0, -1, 1e-9, 1e-3, 0.3, 3, 90, 359, 1e3, 1e6, "x", True, [], [1.0, 2.0])
SWINGING = {
    "motion": "oscillating",
    "shape": "roller",
    "radius": 5.0,
    "pivot_distance": 60.0,
    "arm": 50.0,
}
FACE = {
    "motion": "oscillating",
    "shape": "flat",
    "pivot_distance": 80.0,
    "face_offset": 2.0,
    "face_width": 60.0,
}
VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    **{name: (name, {}) for name in MECHANISMS},
    "disc-cam, groove": ("disc-cam", {"geometry.closure": "groove", "parts.hub_height": 0.0}),
    "disc-cam, pair": ("disc-cam", {"geometry.closure": "conjugate"}),
    "disc-cam, arm": ("disc-cam", {"geometry.follower": SWINGING}),
    "disc-cam, machine": ("disc-cam", {"parts.make": "printed"}),
    "indexing-cam, machine": ("indexing-cam", {"parts.make": "printed"}),
    "cylinder-cam, machine": ("cylinder-cam", {"parts.make": "printed"}),
    "disc-cam, face on an arm": ("disc-cam", {"geometry.follower": FACE}),
}
Leaf = tuple[
    tuple[str | int, ...], dict[str, Any], bool
]  # of a key: its path, its schema, whether it must be given


def leaves(
    node: Any, root: Any, data: Any, path: tuple[str | int, ...] = (), asked: bool = True
) -> Iterator[Leaf]:
    """All keys that are no tables; of a list of tables those of its first and its last one in `data`."""
    while "$ref" in node:
        node = root["$defs"][node["$ref"].rsplit("/", 1)[1]]
    members = [member for key in ("anyOf", "oneOf", "allOf") for member in node.get(key, ())]
    if any("$ref" in member or "items" in member for member in members):
        for member in members:
            yield from leaves(member, root, data, path, False)
    elif "properties" in node:
        for key, value in node["properties"].items():
            if value.get("deprecated"):  # the old name of another
                continue
            inner = data.get(key) if isinstance(data, dict) else None
            given = isinstance(data, dict) and key in data
            yield from leaves(
                value,
                root,
                inner,
                (*path, key),
                asked and given and key in node.get("required", ()),
            )
    elif "items" in node and isinstance(data, list) and data and isinstance(data[0], dict):
        for k in sorted({0, len(data) - 1}):
            yield from leaves(node["items"], root, data[k], (*path, k), False)
    elif node.get("type") != "null":
        yield path, node, asked


@functools.cache
def starter(mechanism: str) -> reading.Data:
    return reading.read(SPECS / f"{mechanism}.toml")


def keys_of(mechanism: str) -> list[Leaf]:
    """Every key once, `mechanism` left out."""
    root = specs.schema(load(mechanism), mechanism)
    found = leaves(root, root, starter(mechanism))
    return list(
        {
            path: (path, node, asked) for path, node, asked in found if path != ("mechanism",)
        }.values()
    )


def beyond(node: dict[str, Any]) -> Iterator[object]:
    """Numbers just outside the bounds, a word that is none of those listed."""
    if "enum" in node or "const" in node:
        yield "no such thing"
    for bound, way in (("minimum", -1), ("maximum", 1)):
        if bound in node:
            yield node[bound] + way * max(1e-6 * abs(node[bound]), 1e-9)
        if f"exclusive{bound.capitalize()}" in node:
            yield node[f"exclusive{bound.capitalize()}"]


def table_of(data: Any, path: tuple[str | int, ...]) -> Any:
    """The table that holds a key, made as needed; a law that is a name becomes a table."""
    for name in path[:-1]:
        if isinstance(data, dict) and isinstance(data.setdefault(name, {}), str):
            data[name] = {"name": data[name]}
        data = data[name]
    return data


def changed(variant: str, path: tuple[str | int, ...], *value: object) -> Any:
    """The mechanism with another value of one key, or without the key."""
    mechanism, settings = VARIANTS[variant]
    data = copy.deepcopy(starter(mechanism))
    for key, setting in settings.items():
        where = tuple(key.split("."))
        table_of(data, where)[where[-1]] = copy.deepcopy(setting)
    table = table_of(data, path)
    if value:
        table[path[-1]] = copy.deepcopy(value[0])
    else:
        del table[path[-1]]
    return specs.validate(load(mechanism), data)


@pytest.mark.long
@pytest.mark.parametrize("mechanism", MECHANISMS)
def test_what_is_no_value_is_told_by_its_path(mechanism: str) -> None:
    for path, node, asked in keys_of(mechanism):
        dotted = ".".join(map(str, path))
        parents = {".".join(map(str, path[:k])) for k in range(1, len(path) + 1)}
        for value in (*NOTHING, *beyond(node)):
            if (
                value == {}
                and not asked
                and ({"additionalProperties", "patternProperties"} & node.keys())
            ):
                continue  # a table of names that a person gives may be empty
            with pytest.raises(SpecError) as caught:
                changed(mechanism, path, value)
            told = [
                fault
                for fault in caught.value.faults
                if fault.key.startswith(dotted) or fault.key in parents
            ]
            assert told and all(fault.expected for fault in told), (path, value, caught.value)
        if asked:
            with pytest.raises(SpecError) as caught:
                changed(mechanism, path)
            assert [
                fault.key for fault in caught.value.faults if fault.expected.startswith("missing")
            ] == [dotted]


# whose figures cost most: each key of theirs gets one extreme, and of four keys one is studied
HEAVY = (
    "indexing-cam, machine",
    "chain-stitch-looper",
    "thread-take-up",
    "uniform-swing",
    "indexing-cam",
)


@pytest.mark.long
@pytest.mark.parametrize("variant", VARIANTS)
def test_extremes_end_well(variant: str) -> None:
    """A fault, a design that does not exist, or a machine all of whose figures are numbers, and a nan has failed; warnings are
    errors. Each key gets two of the extremes, other ones than the key before it; every second key is studied too.
    """
    mechanism, settings = VARIANTS[variant]
    own = {"geometry", "parts", "limits"} if settings else load(mechanism).model_fields
    good, turn = 0, 5 * list(VARIANTS).index(variant)
    for number, (path, _, _) in enumerate(keys_of(mechanism)):
        if path[0] not in own or (settings and number % 2):  # of a whole machine every second key
            continue
        for k in range(1 if variant in HEAVY else 2):
            turn += 5
            value = EXTREMES[turn % len(EXTREMES)]
            try:
                made = changed(variant, path, value)
                studied = (
                    number % 4 == (2 if settings else 1)
                    if variant in HEAVY
                    else k and (number % 2 or settings)
                )
                findings, parts, numbers = (
                    made.limits(),
                    made.assembly.parts,
                    made.study().numbers if studied else {},
                )
                _ = made.assembly.passing, made.assembly.bought
            except SpecError as error:
                assert all(fault.key and fault.expected for fault in error.faults), (path, value)
            except DesignError as error:
                assert error.remedy or error.where, (path, value)
            except CamgenError as error:
                assert str(error)
            else:
                good += 1
                assert not [f.code for f in findings if f.ok and math.isnan(f.measured)], (
                    path,
                    value,
                )
                assert not [name for name, number in numbers.items() if math.isnan(number)], (
                    path,
                    value,
                )
                assert all(0 < part.volume < math.inf for part in parts), (path, value)
    assert good > 0
