"""Frozen records, held against the standard library's data classes that they stand for."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from typing import Any

import pytest

from camgen import records
from camgen.machine.model import Place


def made(dataclass: Any) -> tuple[type[Any], type[Any]]:
    """A record and one that is derived from it, by either decorator."""

    @dataclass(frozen=True)
    class Point:
        """A default, one that is made anew, one that is not given, one that does not count."""

        x: float
        y: float = 1.0
        seen: list[int] = dataclasses.field(default_factory=list)
        kind: str = dataclasses.field(default="point", init=False)
        known: dict[int, int] = dataclasses.field(default_factory=dict, init=False, compare=False, repr=False)

        def __post_init__(self) -> None:
            if self.x < 0:
                raise ValueError("x is below 0")

    @dataclass(frozen=True)
    class Far(Point):
        """One field more."""

        z: complex = 0j

    return Point, Far


@pytest.mark.parametrize("which", [0, 1])
def test_a_record_is_what_the_standard_library_makes(which: int) -> None:
    ours, theirs = made(records.dataclass)[which], made(dataclasses.dataclass)[which]
    assert records.dataclass is not dataclasses.dataclass
    given: list[tuple[tuple[Any, ...], dict[str, Any]]] = [((2.0,), {}), ((2.0, 3.0), {"seen": [4]}), ((), {"x": 5.0, "y": 6.0})]
    for args, kwargs in given:
        a, b = ours(*args, **kwargs), theirs(*args, **kwargs)
        assert (repr(a), vars(a)) == (repr(b), vars(b))
        assert a == ours(*args, **kwargs) != ours(9.0)
        assert dataclasses.asdict(dataclasses.replace(a, y=7.0)) == dataclasses.asdict(dataclasses.replace(b, y=7.0))
        assert [each.name for each in dataclasses.fields(a)] == [each.name for each in dataclasses.fields(b)]
    a = ours(2.0)
    a.known[1] = 2
    assert a == ours(2.0), "known is not compared"
    assert ours(2.0).seen is not ours(2.0).seen
    for cls in (ours, theirs):
        for args, kwargs in (((), {}), ((1, 2, [], 4j, 5, 6), {}), ((1,), {"kind": "line"})):
            with pytest.raises(TypeError):
                cls(*args, **kwargs)
        with pytest.raises(TypeError, match="unhashable"):  # for the list that it has
            hash(cls(1))
    with pytest.raises(ValueError, match="below 0"):
        ours(-1.0)


def test_records_of_two_classes_differ_and_neither_can_be_changed() -> None:
    point, far = made(records.dataclass)
    assert point(1.0) != far(1.0)
    for record in (point(1.0), far(1.0)):
        for name in ("x", "new"):
            with pytest.raises(dataclasses.FrozenInstanceError):
                setattr(record, name, 2.0)
            with pytest.raises(dataclasses.FrozenInstanceError):
                delattr(record, name)


def test_a_record_is_a_key_and_goes_to_other_processes() -> None:
    place = Place("crank", 1 + 2j)
    assert {place: 1}[Place("crank", 1 + 2j)] == 1
    assert pickle.loads(pickle.dumps(place)) == copy.deepcopy(place) == place

    @records.dataclass(frozen=True, eq=False)
    class Alone:
        x: int

    assert Alone(1) != Alone(1) and hash(Alone(1)) is not None
