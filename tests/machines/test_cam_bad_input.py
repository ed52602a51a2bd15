"""Every key of the disc cam's and the indexing cam's specs: what is no value is told by its path, what is extreme ends well."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from camgen import spec as specs
from camgen.errors import CamgenError, SpecError
from camgen.machines import load

SPECS = Path(__file__).resolve().parents[2] / "specs"
NOTHING = (math.nan, math.inf, -math.inf, 1e12, 10**400, {}, {"x": 1}, [[[0]]], [None])
EXTREMES = (0, -1, 1e-9, 1e-3, 0.5, 3, 90, 359, 1e3, 1e6, "x", True, [], [1.0, 2.0])
SWINGING = {"motion": "oscillating", "shape": "roller", "radius": 5.0, "pivot_distance": 60.0, "arm": 50.0}
FACE = {"motion": "oscillating", "shape": "flat", "pivot_distance": 80.0, "face_offset": 2.0, "face_width": 60.0}
VARIANTS: dict[str, tuple[str, dict[str, Any]]] = {
    "disc-cam": ("disc-cam", {}),
    "disc-cam, groove": ("disc-cam", {"geometry.closure": "groove", "parts.hub_height": 0.0}),
    "disc-cam, pair": ("disc-cam", {"geometry.closure": "conjugate"}),
    "disc-cam, arm": ("disc-cam", {"geometry.follower": SWINGING}),
    "disc-cam, face on an arm": ("disc-cam", {"geometry.follower": FACE}),
    "indexing-cam": ("indexing-cam", {}),
}


def put(data: Any, path: str, value: Any) -> None:
    """Set a value below tables and lists, tables made as needed; a law that is a name becomes a table."""
    *tables, key = path.split(".")
    for name in tables:
        if isinstance(data, dict) and isinstance(data.setdefault(name, {}), str):
            data[name] = {"name": data[name]}
        data = data[int(name)] if isinstance(data, list) else data[name]
    data[key] = value


def leaves(node: Any, root: Any, path: tuple[str, ...] = ()) -> Iterator[str]:
    """Paths of all keys that are no tables; of a list of tables those of the first and the third."""
    if "$ref" in node:
        node = root["$defs"][node["$ref"].rsplit("/", 1)[1]]
    members = [member for key in ("anyOf", "oneOf", "allOf") for member in node.get(key, ())]
    if members:
        for member in members:
            yield from leaves(member, root, path)
    elif "properties" in node:
        for key, value in node["properties"].items():
            yield from leaves(value, root, (*path, key))
    elif path == ("segment",):
        for k in "02":
            yield from leaves(node["items"], root, ("segment", k))
    else:
        yield ".".join(path)


def keys_of(mechanism: str) -> list[str]:
    """Keys of the mechanism's own tables."""
    root = load(mechanism).model_json_schema()
    shared = ("print", "material", "accuracy", "output", "mechanism", "name")
    return [key for key in dict.fromkeys(leaves(root, root)) if not key.startswith(shared)]


def changed(variant: str, path: str, value: object) -> Any:
    mechanism, settings = VARIANTS[variant]
    data = specs.read(SPECS / f"{mechanism}.toml")
    for key, setting in settings.items():
        put(data, key, copy.deepcopy(setting))
    put(data, path, copy.deepcopy(value))
    return specs.validate(load(mechanism), data)


@pytest.mark.parametrize("path", keys_of("disc-cam"))
def test_no_value_of_a_disc_cam(path: str) -> None:
    each_is_told("disc-cam", path)


@pytest.mark.parametrize("path", keys_of("indexing-cam"))
def test_no_value_of_an_indexing_cam(path: str) -> None:
    each_is_told("indexing-cam", path)


def each_is_told(variant: str, path: str) -> None:
    for value in NOTHING:
        with pytest.raises(SpecError) as caught:
            changed(variant, path, value)
        parents = tuple(".".join(path.split(".")[:k]) for k in range(1, path.count(".") + 2))
        assert any(fault.path.startswith(path) or fault.path in parents for fault in caught.value.faults), (value, caught.value)


def cases() -> Iterator[tuple[str, str, object]]:
    """Each key of each variant with two of the extremes, others for each key: all extremes come up many times."""
    turn = 0
    for variant, (mechanism, settings) in VARIANTS.items():
        own = ("geometry", "parts", "limits") if settings else ("",)
        for path in keys_of(mechanism):
            if path.startswith(own):
                for _ in range(2):
                    yield variant, path, EXTREMES[turn % len(EXTREMES)]
                    turn += 5


@pytest.mark.parametrize("variant", VARIANTS)
def test_extremes_end_well(variant: str) -> None:
    """A fault, a design that does not exist, or a mechanism all of whose figures are numbers; warnings are errors."""
    good = 0
    for _, path, value in (case for case in cases() if case[0] == variant):
        try:
            made = changed(variant, path, value)
            findings, study = made.limits(), made.study()
            made.parts()
            made.contacts()
        except CamgenError:
            continue
        good += 1
        assert not [f.code for f in findings if math.isnan(f.measured)], (path, value)
        assert not [name for name, number in study.numbers.items() if math.isnan(number)], (path, value)
    assert good > 0
