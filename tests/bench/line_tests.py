"""A pytest plugin for mutation tests: which tests run which lines, and how long each test takes.

    LINE_TESTS=map.json LINE_TESTS_OF=camgen/judge python -m pytest -p line_tests tests/judge/test_contact.py

What many tests share (a fixture of a module or a session, a folder made `once`) is run by the first of them alone, and counts
for all of them. Without LINE_TESTS no map is made. Either way examples are the same ones each time, and a failure is not
shrunk: it is only wanted that there is one.
"""

from __future__ import annotations

import json
import os
from collections import defaultdict
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, settings

OUT = os.environ.get("LINE_TESTS", "")


class LineTests:
    """Contexts of coverage: a test by its id, or what tests share by its name; users: of each shared thing, by contexts."""

    def __init__(self, of: list[str]) -> None:
        import coverage

        files = [str(path) for name in of for path in ([Path(name)] if name.endswith(".py") else Path(name).rglob("*.py"))]
        self.files = sorted(files)
        self.coverage = coverage.Coverage(data_file=None, config_file=False, include=[str(Path(f).resolve()) for f in files])
        self.coverage.set_option("run:disable_warnings", ["no-data-collected"])  # tests that run none of these files
        self.users: dict[str, set[str]] = defaultdict(set)
        self.seconds: dict[str, float] = {}
        self._contexts = ["import"]
        self.coverage.start()

    def within(self, context: str, work: Callable[[], Any]) -> Any:
        """The work, whose lines count for the context."""
        self.users[context].add(self._contexts[-1])
        self._contexts.append(context)
        self.coverage.switch_context(context)
        try:
            return work()
        finally:
            self._contexts.pop()
            self.coverage.switch_context(self._contexts[-1])

    def tests(self, context: str) -> set[str]:
        """The tests that a context counts for."""
        if context in self.seconds:
            return {context}
        return set().union(*(self.tests(user) for user in self.users[context] if user != "import"))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        self._contexts.append(item.nodeid)
        self.seconds[item.nodeid] = 0.0
        self.coverage.switch_context(item.nodeid)
        try:
            return (yield)
        finally:
            self._contexts.pop()
            self.coverage.switch_context(self._contexts[-1])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.seconds[report.nodeid] += report.duration

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        for item in session.items:
            for definitions in item._fixtureinfo.name2fixturedefs.values():  # type: ignore[attr-defined]
                self.users[_shared(definitions[-1])].add(item.nodeid)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Generator[None, Any, Any]:
        if fixturedef.scope == "function":
            return (yield)
        name = _shared(fixturedef)
        self._contexts.append(name)
        self.coverage.switch_context(name)
        try:
            value = yield
        finally:
            self._contexts.pop()
            self.coverage.switch_context(self._contexts[-1])
        if fixturedef.argname == "once":
            made = value

            def value(name: str, make: Any) -> Path:
                return Path(self.within(f"once {name}", lambda: made(name, make)))

            fixturedef.cached_result = (value, *fixturedef.cached_result[1:])
        return value

    def pytest_sessionfinish(self) -> None:
        self.coverage.stop()
        data = self.coverage.get_data()
        lines: dict[str, dict[int, list[str]]] = {}
        for file in self.files:
            contexts = data.contexts_by_lineno(str(Path(file).resolve()))
            found = {line: set().union(*map(self.tests, names)) for line, names in contexts.items()}
            lines[file] = {line: sorted(tests) for line, tests in sorted(found.items()) if tests}
        sources = {file: Path(file).read_text(encoding="utf-8") for file in self.files}
        Path(OUT).write_text(json.dumps({"seconds": self.seconds, "lines": lines, "sources": sources}), encoding="utf-8")


def _shared(definition: Any) -> str:
    return f"fixture {definition.baseid} {definition.argname}"


def pytest_configure(config: pytest.Config) -> None:
    settings.register_profile(
        "mutants", derandomize=True, deadline=None, database=None,
        phases=(Phase.explicit, Phase.generate), suppress_health_check=[HealthCheck.too_slow],
    )  # fmt: skip
    settings.load_profile("mutants")
    if OUT:
        config.pluginmanager.register(LineTests(os.environ["LINE_TESTS_OF"].split(os.pathsep)))
