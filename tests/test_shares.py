"""Shares of the long tests, which `.ci/run` takes one of."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import conftest


@dataclass(frozen=True)
class _Test:
    nodeid: str
    long: bool
    spec: str | None = None  # the parameter by which it belongs in a share

    def get_closest_marker(self, name: str) -> Any:
        assert name == "long"
        return SimpleNamespace(kwargs={"by": "name"} if self.spec else {}) if self.long else None

    @property
    def callspec(self) -> Any:
        return SimpleNamespace(params={"name": self.spec})


def _kept(tests: list[_Test], share: str | None) -> list[Any]:
    left: list[_Test] = []
    hook = SimpleNamespace(pytest_deselected=lambda items: left.extend(items))
    config: Any = SimpleNamespace(getoption=lambda name: share, hook=hook)
    kept: Any = list(tests)
    conftest.pytest_collection_modifyitems(config, kept)
    assert sorted(each.nodeid for each in [*kept, *left]) == [each.nodeid for each in tests]
    return list(kept)


def test_eight_shares_hold_each_long_test_once_and_each_short_one_always() -> None:
    tests = [
        _Test(f"tests/test_{k:03}.py::test_{name}", k % 3 == 0) for k in range(300) for name in "ab"
    ]
    shares = [_kept(tests, f"{k}/8") for k in range(8)]
    for test in tests:
        assert sum(test in share for share in shares) == (1 if test.long else 8)
    assert all(10 < sum(test.long for test in share) < 50 for share in shares)


def test_the_long_tests_of_a_file_are_of_one_share() -> None:
    tests = [_Test(f"tests/test_one.py::test_{k:02}", True) for k in range(20)]
    assert sorted(len(_kept(tests, f"{k}/8")) for k in range(8)) == [0] * 7 + [20]


def test_tests_of_a_file_that_go_by_a_parameter_are_of_the_share_of_its_value() -> None:
    specs = [f"spec-{k:02}" for k in range(40)]
    tests = [
        _Test(f"tests/test_one.py::test_{name}[{spec}]", True, spec)
        for name in "ab"
        for spec in specs
    ]
    shares = [{test.spec for test in _kept(tests, f"{k}/8")} for k in range(8)]
    assert sorted(spec for share in shares for spec in share) == sorted(specs)
    assert all(len(share) < 15 for share in shares)


def test_without_a_share_all_are_kept() -> None:
    tests = [_Test("a", True), _Test("b", False)]
    assert _kept(tests, None) == tests
