"""A pytest plugin for mutation tests: which tests run which lines, and how long each test takes.

    LINE_TESTS=map.json LINE_TESTS_OF=camgen/judge python -m pytest -p line_tests tests/judge/test_contact.py

What many tests share (a fixture of a module or a session, a folder made `once`) is run by the first of them alone, and counts
for all of them. A test that fails in code without a fault is left out: it would fail in code with one as well. Without
LINE_TESTS no map is made. Either way examples are the same ones each time, and a failure is not shrunk: it is only wanted that
there is one.
"""

from __future__ import annotations

import json
import os
import time
from collections import defaultdict
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, settings

OUT = os.environ.get("LINE_TESTS", "")


class LineTests:
    """Contexts of coverage: a test by its id, or what tests share by its name; users: of each shared thing, by contexts;
    seconds: of each context, less those of the contexts in it."""

    def __init__(self, of: list[str]) -> None:
        import coverage

        named = (
            path
            for name in of
            for path in ([Path(name)] if name.endswith(".py") else Path(name).rglob("*.py"))
        )
        self.files = sorted(map(str, named))
        included = [str(Path(file).resolve()) for file in self.files]
        self.coverage = coverage.Coverage(data_file=None, config_file=False, include=included)
        self.coverage.set_option(
            "run:disable_warnings", ["no-data-collected"]
        )  # tests that run none of these files
        self.users: dict[str, set[str]] = defaultdict(set)
        self.seconds: dict[str, float] = defaultdict(float)
        self._tests: set[str] = set()
        self._contexts = ["import"]
        self._failed: set[str] = set()
        self.coverage.start()

    @contextmanager
    def within(self, context: str) -> Iterator[None]:
        """What is run here counts for the context, and the time that it takes."""
        self.users[context].add(self._contexts[-1])
        self._contexts.append(context)
        self.coverage.switch_context(context)
        start = time.process_time()
        try:
            yield
        finally:
            took = time.process_time() - start
            self._contexts.pop()
            self.seconds[context] += took
            self.seconds[self._contexts[-1]] -= took
            self.coverage.switch_context(self._contexts[-1])

    def tests(self, context: str) -> set[str]:
        """The tests that a context counts for."""
        if context in self._tests or context == "import":
            return {context} & self._tests
        return set().union(*map(self.tests, self.users[context]))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        self._tests.add(item.nodeid)
        with self.within(item.nodeid):
            return (yield)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self._failed.add(report.nodeid)

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        for item in session.items:
            for definitions in item._fixtureinfo.name2fixturedefs.values():  # type: ignore[attr-defined]
                self.users[_shared(definitions[-1])].add(item.nodeid)

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Generator[None, Any, Any]:
        if fixturedef.scope == "function":
            return (yield)
        with self.within(_shared(fixturedef)):
            value = yield
        if fixturedef.argname == "once":
            made = value

            def value(name: str, make: Any) -> Path:
                with self.within(f"once {name}"):
                    return Path(made(name, make))

            fixturedef.cached_result = (value, *fixturedef.cached_result[1:])
        return value

    def pytest_sessionfinish(self) -> None:
        self.coverage.stop()
        self._tests -= self._failed
        data = self.coverage.get_data()
        lines: dict[str, dict[int, list[str]]] = {}
        for file in self.files:
            contexts = data.contexts_by_lineno(str(Path(file).resolve()))
            tests = {line: set().union(*map(self.tests, names)) for line, names in contexts.items()}
            lines[file] = {line: sorted(names) for line, names in sorted(tests.items()) if names}
        needs = defaultdict(list)
        for context in self.seconds.keys() - self._tests - self._failed - {"import"}:
            for test in self.tests(context):
                needs[test].append(context)
        sources = {file: Path(file).read_text(encoding="utf-8") for file in self.files}
        found = {"seconds": self.seconds, "needs": needs, "lines": lines, "sources": sources}
        Path(OUT).write_text(json.dumps(found), encoding="utf-8")


def _shared(definition: Any) -> str:
    return f"fixture {definition.baseid} {definition.argname}"


def pytest_configure(config: pytest.Config) -> None:
    settings.register_profile(
        "mutants",
        derandomize=True,
        deadline=None,
        database=None,
        phases=(Phase.explicit, Phase.generate),
        suppress_health_check=[HealthCheck.too_slow],
    )
    settings.load_profile("mutants")
    if OUT:
        config.pluginmanager.register(LineTests(os.environ["LINE_TESTS_OF"].split(os.pathsep)))
