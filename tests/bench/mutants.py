"""How sure the judge's tests are: small faults put into its code at random, and how many of them some test notices.

    python tests/bench/mutants.py map [TESTS...]            which tests run which line; some minutes, once
    python tests/bench/mutants.py run --seed 1 --count 300  a sample; --again: those of it that were noticed by no test

Needs `pip install cosmic-ray coverage`. The faults are those of cosmic-ray's operators, and a few names that are easily
mistaken for each other (`SWAPS`). A place in the code is drawn first, then what becomes of it, so that an operator with many
replacements counts no more than another. Left out is what does not mean anything: annotations, which are never run, shifts of
bits for numbers, `is` for `<`, names put in by chance.

A place is drawn by the hash of seed, file, line and column: an edit elsewhere in the code leaves a sample as it is. Each fault
is put into a copy of the checkout and only the tests that run its line are run, the quickest first, until one fails: it is
noticed. Those expected to take longer than `--seconds` together are left out. Samples and maps are kept in build/mutants.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from difflib import SequenceMatcher
from pathlib import Path
from queue import Queue
from typing import Any

import parso.python.tree
from cosmic_ray import plugins
from cosmic_ray.ast import ast_nodes, get_ast
from cosmic_ray.mutating import mutate_code
from cosmic_ray.operators.exception_replacer import ExceptionReplacer
from cosmic_ray.operators.operator import Example, Operator

TOP = Path(__file__).resolve().parents[2]
KEPT = TOP / "build" / "mutants"
CODE = ("camgen/judge", "camgen/machine/closing.py", "camgen/machine/constraints.py")
TESTS = (
    "tests/judge",
    "tests/machine",
    "tests/pipeline",
    "tests/files",
    "tests/parts/test_fits.py",
)
SWAPS = {
    ("min", "max"),
    ("minimum", "maximum"),
    ("argmin", "argmax"),
    ("any", "all"),
    ("floor", "ceil"),
    ("real", "imag"),
    ("sin", "cos"),
}
ARITHMETIC = {
    "Add": "Sub",
    "Sub": "Add",
    "Mul": "Div",
    "Div": "Mul",
    "FloorDiv": "Div",
    "Mod": "Mul",
    "Pow": "Mul",
    "BitAnd": "BitOr",
    "BitOr": "BitAnd",
}
ORDER = ("Lt", "LtE", "Gt", "GtE")
MEMORY = 6 << 30  # bytes that a run of tests may take
_HANDLER = "core/ExceptionReplacer"  # the name in samples
_LONGEST = 12  # lines of a statement
_WAITED = 20  # times its processor time that a run of tests may last: others may use the machine
_START = 10.0  # s, that a run of tests may take beside twice what its tests take as a rule


class Swap(Operator):
    """A name for another that is easily mistaken for it."""

    others = dict([*SWAPS, *((b, a) for a, b in SWAPS)])

    def mutation_positions(self, node: Any) -> Iterator[Any]:
        if isinstance(node, parso.python.tree.Name) and node.value in self.others:
            yield node.start_pos, node.end_pos

    def mutate(self, node: Any, index: int) -> Any:
        return parso.python.tree.Name(self.others[node.value], node.start_pos, node.prefix)

    @classmethod
    def examples(cls) -> Sequence[Example]:
        return (Example("x = min(y)", "x = max(y)"),)


class Handler(ExceptionReplacer):
    """The exception that is caught for another one; cosmic-ray's own breaks off at one with a dot in its name."""

    @staticmethod
    def _name_nodes(node: Any) -> Sequence[Any]:
        found = ExceptionReplacer._name_nodes(node)
        return [name for name in found if isinstance(name, parso.python.tree.Name)]


def operators() -> dict[str, Operator]:
    """Those that mean something, by name."""
    found: dict[str, Operator] = {"Swap": Swap(), _HANDLER: Handler()}
    for name in plugins.operator_names():
        kind, _, way = name.removeprefix("core/").partition("_")
        before, _, after = way.partition("_")
        match kind:
            case "ReplaceBinaryOperator":
                sensible = ARITHMETIC.get(before) == after
            case "ReplaceComparisonOperator":
                one_kind = {before, after} <= set(ORDER) or {before, after} in (
                    {"Eq", "NotEq"},
                    {"Is", "IsNot"},
                )
                sensible = one_kind and (before, after) not in (
                    ("Lt", "Gt"),
                    ("Gt", "Lt"),
                    ("LtE", "GtE"),
                    ("GtE", "LtE"),
                )
            case "ReplaceUnaryOperator":
                sensible = way in ("Delete_USub", "Delete_Not", "Delete_Invert")
            case "VariableReplacer" | "VariableInserter" | "ExceptionReplacer":
                sensible = False
            case _:
                sensible = True
        if sensible:
            found[name] = plugins.get_operator(name)()
    return found


@dataclass(frozen=True)
class Mutant:
    """One fault: the occurrence of an operator in a file; line from 1, column from 0."""

    file: str
    operator: str
    occurrence: int
    line: int
    column: int
    text: str  # the line as it is in the file

    @property
    def key(self) -> str:
        """What tells it apart, wherever its line stands."""
        return f"{self.file}|{self.text}|{self.column}|{self.operator}"


def _annotations(source: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Where annotations begin and end."""
    nodes: list[ast.expr | None] = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.arg | ast.AnnAssign):
            nodes.append(node.annotation)
        elif isinstance(node, ast.FunctionDef):
            nodes.append(node.returns)
    return [
        ((n.lineno, n.col_offset), (n.end_lineno or 0, n.end_col_offset or 0))
        for n in nodes
        if n is not None
    ]


def mutants_of(file: str) -> list[Mutant]:
    """All faults that could be put into a file."""
    source = (TOP / file).read_text(encoding="utf-8")
    lines, left_out = source.split("\n"), _annotations(source)
    nodes = list(ast_nodes(get_ast(source)))
    found = []
    for name, operator in operators().items():
        positions = [position for node in nodes for position in operator.mutation_positions(node)]
        for occurrence, ((line, column), _) in enumerate(positions):
            if not any(begin <= (line, column) < end for begin, end in left_out):
                found.append(Mutant(file, name, occurrence, line, column, lines[line - 1].strip()))
    return found


def sample(seed: int, count: int, code: Sequence[str]) -> list[Mutant]:
    """Faults at so many places of the code, drawn at random, each of one kind that is possible there."""

    def drawn(*what: object) -> str:
        return hashlib.sha256(repr((seed, *what)).encode()).hexdigest()

    files = [
        str(p.relative_to(TOP))
        for n in code
        for p in ([TOP / n] if n.endswith(".py") else sorted((TOP / n).glob("*.py")))
    ]
    places: dict[tuple[str, str, int, int], list[Mutant]] = defaultdict(list)
    for file in files:
        seen = Counter[tuple[str, int]]()
        at: dict[tuple[int, int], int] = {}
        for mutant in sorted(mutants_of(file), key=lambda m: (m.line, m.column)):
            if (mutant.line, mutant.column) not in at:
                seen[mutant.text, mutant.column] += 1
                at[mutant.line, mutant.column] = seen[mutant.text, mutant.column]
            places[file, mutant.text, mutant.column, at[mutant.line, mutant.column]].append(mutant)
    chosen = sorted(places, key=lambda place: drawn(*place))[:count]
    return [
        min(places[place], key=lambda m: drawn(*place, m.operator, m.occurrence))
        for place in chosen
    ]


# ---- running -----------------------------------------------------------------------------------------------------------


def copy_tree(to: Path) -> None:
    """The files that git tracks or would track, compiled."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=TOP,
        capture_output=True,
        check=True,
    ).stdout.decode()
    shutil.rmtree(to, ignore_errors=True)
    for name in filter(None, listed.split("\0")):
        if (TOP / name).exists():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(TOP / name, to / name)
    subprocess.run(
        [sys.executable, "-m", "compileall", "-q", "camgen", "tests"], cwd=to, check=True
    )


def pytest_run(
    tree: Path, arguments: Sequence[str], limit: float | None, **variables: str
) -> tuple[int, str]:
    """Exit code of pytest in a copy of the checkout, and what it printed; limit: s, of processor time."""
    path = os.pathsep.join([str(tree), str(tree / "tests" / "bench")])
    env = (
        os.environ
        | {"PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1", "OPENBLAS_NUM_THREADS": "1"}
        | variables
    )

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (round(limit), round(limit) + 5))

    process = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "-p",
            "line_tests",
            "-p",
            "no:cacheprovider",
            "-p",
            "no:xdist",
            *arguments,
        ],
        cwd=tree,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        preexec_fn=bounded,
    )
    try:
        said, _ = process.communicate(timeout=None if limit is None else _WAITED * limit)
    except subprocess.TimeoutExpired:  # waits for what never comes
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return -signal.SIGXCPU, ""
    return process.returncode, said.decode(errors="replace")


@dataclass(frozen=True)
class Map:
    """seconds: of each test, and of what tests share; needs: of each test, what it shares with others; lines: by file and line
    the tests that run it; bodies: by file the first and the last line of what each function does; texts: its lines."""

    seconds: dict[str, float]
    needs: dict[str, list[str]]
    lines: dict[str, dict[int, list[str]]]
    bodies: dict[str, list[tuple[int, int]]]
    texts: dict[str, list[str]]

    @classmethod
    def read(cls, there: Set[str]) -> Map:
        """All maps that were made, as one, of the tests that are still there."""
        seconds: dict[str, float] = {}
        needs: dict[str, list[str]] = {}
        lines: dict[str, dict[int, list[str]]] = defaultdict(lambda: defaultdict(list))
        for path in sorted((KEPT / "map").glob("*.json")):
            data = json.loads(path.read_text(encoding="utf-8"))
            seconds |= data["seconds"]
            needs |= data["needs"]
            for file, found in data["lines"].items():
                now = _lines_now(data["sources"][file], (TOP / file).read_text(encoding="utf-8"))
                for line, tests in found.items():
                    lines[file][now.get(int(line), 0)] += there.intersection(tests)
        sources = {file: (TOP / file).read_text(encoding="utf-8") for file in lines}
        nodes = {file: ast.walk(ast.parse(source)) for file, source in sources.items()}
        bodies = {
            file: [
                (node.body[0].lineno, node.end_lineno or 0)
                for node in each
                if isinstance(node, ast.FunctionDef)
            ]
            for file, each in nodes.items()
        }
        return cls(
            seconds,
            needs,
            lines,
            bodies,
            {file: source.split("\n") for file, source in sources.items()},
        )

    def tests(self, mutant: Mutant, most: float) -> list[str]:
        """Those that run its line, the quickest first, of `most` seconds together; of a line that is run on import those that
        run any line with the name it begins with, or any line of its file."""
        lines = self.lines.get(mutant.file, {})
        bodies = self.bodies.get(mutant.file, ())
        begins = [begin for begin, end in bodies if begin <= mutant.line <= end]
        if begins:
            # of a statement over several lines not every one is told
            first = max(*begins, mutant.line - _LONGEST + 1)
            near = (lines.get(line) for line in range(mutant.line, first - 1, -1))
            own = set(next(filter(None, near), ()))
        else:
            name = re.match(r"\w+", mutant.text)
            used = [
                k
                for k, text in enumerate(self.texts.get(mutant.file, ()), 1)
                if name and re.search(rf"\b{name[0]}\b", text)
            ]
            own = {test for line in used for test in lines.get(line, ())}
            own = own or {test for tests in lines.values() for test in tests}
        chosen: list[str] = []
        for test in sorted(own, key=lambda test: (self.cost([test]), test)):
            if chosen and self.cost([*chosen, test]) > most:
                break
            chosen.append(test)
        return chosen

    def cost(self, tests: Sequence[str]) -> float:
        """Seconds of these tests, and once of what they share."""
        shared = {each for test in tests for each in self.needs.get(test, ())}
        return sum(self.seconds[each] for each in (*tests, *shared))


def _lines_now(before: str, now: str) -> dict[int, int]:
    """Where each line of a file stands that has been edited since, from 1."""
    same = SequenceMatcher(
        None, before.split("\n"), now.split("\n"), autojunk=False
    ).get_matching_blocks()
    return {a + k + 1: b + k + 1 for a, b, size in same for k in range(size)}


def collected(tree: Path) -> set[str]:
    """The tests that are in a copy of the checkout, of files of which a map was made."""
    files = {
        name.partition("::")[0]
        for path in (KEPT / "map").glob("*.json")
        for name in json.loads(path.read_text(encoding="utf-8"))["seconds"]
        if "::" in name
    }
    there = sorted(name for name in files if (tree / name).exists())
    code, said = pytest_run(tree, ["--collect-only", *there], None)
    assert code == 0, f"tests cannot be collected\n{said[-3000:]}"
    return {line for line in said.splitlines() if "::" in line}


def make_map(tests: Sequence[str], jobs: int) -> None:
    """Which tests run which line, a process for each file of tests."""
    files = [
        str(p.relative_to(TOP))
        for n in tests
        for p in ([TOP / n] if n.endswith(".py") else sorted((TOP / n).rglob("test_*.py")))
    ]
    (KEPT / "map").mkdir(parents=True, exist_ok=True)

    def one(file: str) -> str:
        out = KEPT / "map" / f"{file.replace('/', '.')}.json"
        code, said = pytest_run(
            TOP, [file], None, LINE_TESTS=str(out), LINE_TESTS_OF=os.pathsep.join(CODE)
        )
        return f"{file}: {'ok' if code == 0 else said[-2000:]}"

    with ThreadPoolExecutor(jobs) as pool:
        for line in pool.map(one, files):
            print(line, flush=True)


def outcome(mutant: Mutant, tree: Path, known: Map, most: float) -> dict[str, Any]:
    """What became of a mutant, put into a copy of the checkout: noticed, not noticed, or run by no test."""
    path = tree / mutant.file
    source = path.read_text(encoding="utf-8")
    changed = mutate_code(source, operators()[mutant.operator], mutant.occurrence)
    assert changed is not None and changed != source, f"{mutant} changes nothing"
    pairs = [
        (a.strip(), b.strip())
        for a, b in zip(source.split("\n"), changed.split("\n"), strict=False)
        if a != b
    ]
    record = asdict(mutant) | {"becomes": pairs[0][1] if pairs else ""}
    tests = known.tests(mutant, most)
    if not tests:
        return record | {"noticed": False, "by": "no test runs it"}
    path.write_text(changed, encoding="utf-8")
    for stale in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
        stale.unlink()
    try:
        limit = _START + 3 * known.cost(tests)
        code, said = pytest_run(tree, ["-x", "--no-header", "--tb=line", *tests], limit)
    finally:
        path.write_text(source, encoding="utf-8")
    if code == 0:
        return record | {"noticed": False, "by": f"{len(tests)} tests"}
    killed = {
        -signal.SIGXCPU: "too long",
        -signal.SIGKILL: "killed",
        -signal.SIGSEGV: "crash",
        2: "it cannot be imported",
    }
    if "ERROR collecting" in said:
        code = 2
    assert code == 1 or code in killed, f"{mutant}: pytest ended with {code}\n{said[-3000:]}"
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", said, re.MULTILINE)
    return record | {"noticed": True, "by": failed[1] if failed else killed.get(code, "an error")}


def run(mutants: Iterable[Mutant], jobs: int, most: float, kept: Path) -> None:
    """Run what is not in the file yet, and add it there."""
    trees = Queue[Path]()
    done = results(kept)
    waiting = [mutant for mutant in mutants if mutant.key not in done]
    for k in range(min(jobs, len(waiting))):
        copy_tree(KEPT / f"tree-{k}")
        trees.put(KEPT / f"tree-{k}")
    known = Map.read(collected(KEPT / "tree-0") if waiting else set())

    def one(mutant: Mutant) -> dict[str, Any]:
        tree = trees.get()
        try:
            return outcome(mutant, tree, known, most)
        finally:
            trees.put(tree)

    with ThreadPoolExecutor(jobs) as pool, kept.open("a", encoding="utf-8") as file:
        for k, record in enumerate(pool.map(one, waiting), 1):
            file.write(json.dumps(record) + "\n")
            file.flush()
            print(
                f"{k}/{len(waiting)} {'noticed' if record['noticed'] else 'NOT NOTICED'} {record['file']}:{record['line']} "
                f"{record['operator'].removeprefix('core/')} ({record['by']})",
                flush=True,
            )


def results(kept: Path) -> dict[str, dict[str, Any]]:
    """The last outcome of each mutant in a file, by its key."""
    found = {}
    for line in kept.read_text(encoding="utf-8").splitlines() if kept.exists() else ():
        record = json.loads(line)
        found[f"{record['file']}|{record['text']}|{record['column']}|{record['operator']}"] = record
    return found


def show(mutants: Sequence[Mutant], kept: Path) -> None:
    """The share that was noticed, and each that was not."""
    done = results(kept)
    records = [done[mutant.key] for mutant in mutants if mutant.key in done]
    for record in records:
        if not record["noticed"]:
            print(
                f"\n{record['file']}:{record['line']} {record['operator'].removeprefix('core/')}, {record['by']}"
            )
            print(f"  - {record['text']}\n  + {record['becomes']}")
    noticed = sum(record["noticed"] for record in records)
    print(f"\n{noticed} of {len(records)} noticed, {noticed / max(len(records), 1):.1%}")


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("map", "run", "show"))
    parser.add_argument("tests", nargs="*", default=TESTS, help="folders or files of tests (map)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument(
        "--code", nargs="*", default=CODE, help="files or folders to put faults into"
    )
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=40.0, help="of tests for one fault")
    parser.add_argument("--again", action="store_true", help="run again those that no test noticed")
    given = parser.parse_args()
    if given.what == "map":
        make_map(given.tests, given.jobs)
        return
    kept = KEPT / f"sample-{given.seed}.jsonl"
    kept.parent.mkdir(parents=True, exist_ok=True)
    mutants = sample(given.seed, given.count, given.code)
    if given.again:
        sound = [record for record in results(kept).values() if record["noticed"]]
        kept.write_text("".join(json.dumps(record) + "\n" for record in sound), encoding="utf-8")
    if given.what == "run":
        run(mutants, given.jobs, given.seconds, kept)
    show(mutants, kept)


if __name__ == "__main__":
    main()
