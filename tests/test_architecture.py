"""The wings, held against the imports that the code really makes, lazy ones included."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "camgen"

# What each wing may import, besides itself and the ground; the modules at the top and those of the ground have no wing.
WINGS = {
    "geometry": set(),
    "motion": set(),
    "machine": {"geometry", "motion"},
    "parts": {"geometry", "machine"},
    "files": {"geometry", "parts"},
    "machines": {"geometry", "motion", "machine", "parts"},
    "judge": {"geometry", "machine", "files"},
    "report": {"geometry", "machine", "files"},
    "measuring": {"geometry", "machine", "files", "machines", "judge", "report"},
    "tolerance": {"geometry", "machine", "parts", "machines", "judge", "report"},
    "pipeline": {
        "geometry",
        "motion",
        "machine",
        "parts",
        "files",
        "machines",
        "judge",
        "report",
        "tolerance",
    },
    "sweep": {
        "geometry",
        "motion",
        "machine",
        "parts",
        "files",
        "machines",
        "judge",
        "report",
        "pipeline",
    },
    "simulation": {
        "geometry",
        "machine",
        "machines",
        "parts",
        "files",
        "report",
        "tolerance",
        "pipeline",
    },
    "design": {"geometry", "motion", "machine", "machines", "report", "pipeline"},
    "live": {"motion", "machines", "report", "pipeline"},
}
GROUND = {
    "",
    "_version",
    "arguments",
    "bounds",
    "edits",
    "errors",
    "extras",
    "findings",
    "metal_comments",
    "numerics",
    "plotting",
    "progress",
    "reading",
    "schemas",
    "settings",
    "spec",
    "study",
    "tolerances",
    "vocabulary",
    "workers",
}
TOP = {"__init__", "__main__", "cli", "commands", "guide", "starters"}
# Of a machine the judge sees what it is, what of it is measured and wanted, and the conditions of its joints: never what made
# a curve, nor the route by which the maker closes it. Of a format it takes the reading, and what is said of it in the list.
SEEN = {"model", "features", "targets", "constraints", "closing"}
FACTS = {
    ("formats", "FORMATS"),
    ("formats", "READABLE"),
    ("formats", "DRAWN"),
    ("formats", "SOLID"),
    ("threemf", "Item"),
    ("threemf", "Package"),  # what reading a 3MF gives
}
HEAVY = {
    "ezdxf",
    "trimesh",
    "manifold3d",
    "lib3mf",
    "mapbox_earcut",
    "shapely",
    "scipy",
    "rich",
    "matplotlib",
}
LIGHT = {
    "__init__",
    "__main__",
    "cli",
    "guide.__init__",
    "errors",
    "extras",
    "findings",
    "tolerances",
    "report.terminal",
    "files.folder",
    "files.formats",
}

MODULES = {
    path.relative_to(PACKAGE).with_suffix("").as_posix().replace("/", "."): path
    for path in sorted(PACKAGE.rglob("*.py"))
}


def imports(tree: ast.AST) -> set[str]:
    """Modules that are imported anywhere, `from a import b` as a.b, type-checking blocks aside."""
    hidden = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
        for inner in ast.walk(node)
    }
    found = set()
    for node in (node for node in ast.walk(tree) if id(node) not in hidden):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide the wing"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def ours(tree: ast.AST) -> set[tuple[str, str, str]]:
    """(wing, module, name) of what is imported of camgen; the wing is "" for `from camgen import __version__`."""
    found = {tuple(name.split(".")[1:4]) for name in imports(tree) if name.startswith("camgen.")}
    known = {*WINGS, *GROUND, *TOP}
    return {(*parts, "", "")[:3] if parts[0] in known else ("", parts[0], "") for parts in found}  # type: ignore[misc]


def upward(module: str, tree: ast.AST) -> list[str]:
    """Imports that do not go down."""
    here = module.split(".")[0]
    if here in TOP:
        return []
    allowed = GROUND | {here} | WINGS.get(here, set())
    return [f"{module} imports {wing}" for wing, *_ in sorted(ours(tree)) if wing not in allowed]


def bribes(module: str, tree: ast.AST) -> list[str]:
    """What a judge imports of the makers: of files anything but functions that read."""
    if not module.startswith("judge."):
        return []
    return [
        f"{module} imports {wing}.{name}.{what}".rstrip(".")
        for wing, name, what in sorted(ours(tree))
        if (wing == "machine" and name not in SEEN)
        or (wing == "files" and not what.startswith("read_") and (name, what) not in FACTS)
    ]


def heavy_at_top(module: str, tree: ast.Module) -> list[str]:
    """Heavy packages that importing the module would load."""
    top = ast.Module(
        [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)], []
    )
    forbidden = HEAVY | (
        {"numpy", "pydantic"} if module in LIGHT or module.startswith("commands.") else set()
    )
    return [
        f"{module} imports {name}"
        for name in sorted(imports(top))
        if name.split(".")[0] in forbidden
    ]


PROSE = {
    "where",
    "message",
    "remedy",
    "sentence",
    "title",
    "label",
    "name",
}  # of findings, errors, tables, plots, parts: for people, or to tell one from another
PARSING = {
    *("startswith", "endswith", "removeprefix", "removesuffix", "find", "index"),
    *("split", "rsplit", "partition", "rpartition", "splitlines", "count"),
}


def reads_prose(module: str, tree: ast.AST) -> list[str]:
    """Texts for people, and names, that are taken apart again: what they say is a field of its own."""

    def prose(node: ast.AST) -> bool:
        text = isinstance(node, ast.Call) and ast.unparse(node.func) == "str"
        if isinstance(node, ast.Call) and text and node.args:
            node = node.args[0]
        if isinstance(node, ast.Name):
            return node.id in PROSE - {"name"}
        return isinstance(node, ast.Attribute) and node.attr in PROSE

    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            of, method = node.func.value, node.func.attr
            reads = ast.unparse(of) == "re" and method != "escape"
            by_pattern = reads and any(map(prose, node.args))
            if by_pattern or (method in PARSING and prose(of)):
                found.append(f"{module} reads {ast.unparse(node)}")
        elif isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
            if prose(node.comparators[0]):
                found.append(f"{module} reads {ast.unparse(node)}")
    return found


PIECE = re.compile("_[a-z0-9_]*|[a-z0-9_]*_")  # of a key, such as _deg


def reads_keys(module: str, tree: ast.AST) -> list[str]:
    """Keys of figures that are taken apart: quantity, unit, what it is of and the kind of file are fields of a Figure.

    A name may be written with spaces: replace("_", " ").
    """
    found = []
    for node in ast.walk(tree):
        pieces: list[ast.expr] = []
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr in PARSING:
                pieces = node.args
            elif node.func.attr == "replace" and list(map(ast.unparse, node.args[:1])) != ["'_'"]:
                pieces = node.args[:1]
        elif isinstance(node, ast.Compare) and isinstance(node.ops[0], ast.In | ast.NotIn):
            pieces = [node.left]
        texts = [
            each.value
            for piece in pieces
            for each in (piece.elts if isinstance(piece, ast.Tuple) else [piece])
            if isinstance(each, ast.Constant) and isinstance(each.value, str)
        ]
        if any(PIECE.fullmatch(text) for text in texts):
            found.append(f"{module} reads {ast.unparse(node)}")
    return found


def undocumented(module: str, tree: ast.Module) -> list[str]:
    """Public modules, classes and functions without a docstring."""
    found = [] if ast.get_docstring(tree) else [module]
    holders: list[ast.Module | ast.ClassDef] = [tree]
    while holders:
        for node in holders.pop().body:
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
                found += [] if ast.get_docstring(node) else [f"{module}.{node.name}"]
                holders += [node] if isinstance(node, ast.ClassDef) else []
    return found


@pytest.mark.long
def test_every_module_keeps_the_rules() -> None:
    trees = {
        module: ast.parse(path.read_text(encoding="utf-8")) for module, path in MODULES.items()
    }
    rules = (upward, bribes, heavy_at_top, undocumented, reads_prose, reads_keys)
    assert [
        line for rule in rules for module, tree in trees.items() for line in rule(module, tree)
    ] == []


def test_wings_are_all_that_there_is() -> None:
    assert {module.split(".")[0] for module in MODULES} == {*WINGS, *TOP, *(GROUND - {""})}


def circles(trees: Mapping[str, ast.AST]) -> list[set[str]]:
    """Groups of modules that import each other, by whatever way, imports for types alone and lazy ones included."""
    names = [f"camgen.{module}".removesuffix(".__init__") for module in trees]
    graph = np.zeros((len(names), len(names)), bool)
    for k, tree in enumerate(trees.values()):
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                targets = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                inner = [f"{node.module}.{alias.name}" for alias in node.names]
                targets = [each if each in names else str(node.module) for each in inner]
            else:
                continue
            graph[k, [names.index(each) for each in targets if each in names]] = True
    _, group = connected_components(graph, connection="strong")
    together = [
        [name for name, of in zip(names, group, strict=True) if of == k] for k in set(group)
    ]
    return [{name.removeprefix("camgen.") for name in each} for each in together if len(each) > 1]


@pytest.mark.long
def test_modules_import_each_other_in_no_circle() -> None:
    trees = {
        module: ast.parse(path.read_text(encoding="utf-8")) for module, path in MODULES.items()
    }
    assert circles(trees) == []


def test_a_circle_for_types_alone_is_seen() -> None:
    back = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from camgen.a import A"
    texts = {"a": "def f():\n    from camgen.w import b", "w.b": "import camgen.c", "c": back}
    assert circles({name: ast.parse(text) for name, text in texts.items()}) == [{"a", "w.b", "c"}]


@pytest.mark.parametrize(
    "rule, module, text",
    [
        (upward, "geometry.arcs", "from camgen.parts.part import Part"),
        (upward, "motion.laws", "def f():\n    import camgen.pipeline.build"),
        (upward, "findings", "from camgen.geometry import rings"),
        (
            upward,
            "machine.model",
            "def f():\n    from camgen.machines.disc_cam.mechanism import DiscCam",
        ),
        (upward, "judge.contact", "from camgen.parts import fits"),
        (upward, "judge.contact", "from camgen.machines.mechanism import Mechanism"),
        (
            bribes,
            "judge.round_trip",
            "def f():\n    from camgen.machine.cams.profile import DiscCam",
        ),
        (bribes, "judge.motion", "from camgen.machine import loops"),
        (bribes, "judge.motion", "from camgen.machine import solve"),
        (bribes, "judge.motion", "from camgen.machine.run import solve"),
        (bribes, "judge.motion", "from camgen.machine.order import relations"),
        (bribes, "judge.motion", "from camgen.files.stl import write_stl"),
        (bribes, "judge.motion", "from camgen.files import stl"),
        (bribes, "judge.motion", "import camgen.files.formats"),
        (bribes, "judge.motion", "from camgen.files.formats import write_part"),
        (heavy_at_top, "files.stl", "import trimesh.util"),
        (heavy_at_top, "cli", "import numpy as np"),
        (heavy_at_top, "commands.building", "import pydantic"),
        (reads_prose, "report.page", "last = finding.where.endswith('deg')"),
        (reads_prose, "report.page", "kind = str(finding.where).rpartition('.')"),
        (reads_prose, "parts.plates", "if 'stand' not in error.where: pass"),
        (reads_prose, "findings", "kind = re.sub('[0-9]', '#', finding.message)"),
        (reads_prose, "report.page", "said = re.sub('x', '', finding.message)"),
        (reads_prose, "report.plots", "parts = re.fullmatch('(x |y )?(.*)', label)"),
        (reads_prose, "parts.springs", "known = self.name.startswith(('spring', RETURN))"),
        (reads_keys, "report.page", "unit = key.endswith('_mm')"),
        (reads_keys, "report.page", "end = key.rpartition('_')[2]"),
        (reads_keys, "report.page", "drawn = '_dxf_' in key"),
        (reads_keys, "measuring.motion", "effect = key.replace('_off_mm', '_in_motion_mm')"),
        (reads_keys, "tolerance.report", "of = key.endswith(('_percent', '_deg'))"),
        (undocumented, "parts.part", '"""Parts."""\nclass A:\n    """A."""\n    def b(self): ...'),
    ],
)
def test_each_rule_is_seen_to_fail(rule: object, module: str, text: str) -> None:
    assert len(rule(module, ast.parse(text))) == 1  # type: ignore[operator]


def loaded(code: str) -> set[str]:
    """Top-level packages that a fresh interpreter has loaded after the code."""
    code += "\nimport sys\nprint('LOADED', *{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, encoding="utf-8"
    )
    assert done.returncode == 0, done.stderr
    return set(done.stdout.rpartition("LOADED")[2].split())


def test_help_loads_nothing_heavy() -> None:
    code = "from camgen.cli import main\ntry:\n    main(['--help'])\nexcept SystemExit:\n    pass"
    assert loaded(code) & (HEAVY | {"numpy", "pydantic", "tomllib"}) == set()


@pytest.mark.long
def test_dxf_only_run_loads_no_mesh_library(starter: Path, tmp_path: Path) -> None:
    code = (
        "from camgen.cli import main\ntry:\n"
        f"    main(['build', {str(starter)!r}, '--only', 'dxf', '-o', {str(tmp_path)!r}])\n"
        "except SystemExit as done:\n    assert done.code == 0, done.code"
    )
    assert loaded(code) & {"trimesh", "manifold3d", "lib3mf", "mapbox_earcut", "scipy"} == set()


def test_functions_are_short_and_take_few_arguments() -> None:
    """ruff holds the package to a complexity of 12 and six arguments, and nothing excuses a file or a line."""
    limits = ["--select", "C901,PLR0913", "--config", "lint.per-file-ignores = {}", "--ignore-noqa"]
    command = [sys.executable, "-m", "ruff", "check", *limits, "camgen"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0, done.stdout


def careless(tree: ast.AST) -> Iterator[str]:
    """Calls that open a text file and leave its encoding, or the line ends it is written with, to the system."""
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call):
            continue
        name = call.func.attr if isinstance(call.func, ast.Attribute) else ast.unparse(call.func)
        mode = next(
            (str(each.value) for each in call.args[1:2] if isinstance(each, ast.Constant)), ""
        )
        is_open = isinstance(call.func, ast.Name) and name == "open"
        if name not in ("read_text", "write_text") and not is_open or is_open and "b" in mode:
            continue
        keys = {key.arg for key in call.keywords}
        if (
            "encoding" not in keys
            or "newline" not in keys
            and (name == "write_text" or "w" in mode)
        ):
            yield ast.unparse(call)


@pytest.mark.long
def test_a_file_is_written_the_same_on_every_system() -> None:
    written = 'open(p, "w", encoding="utf-8")', "p.read_text()", 'p.write_text(t, encoding="utf-8")'
    assert all(list(careless(ast.parse(text))) == [text.replace('"', "'")] for text in written)
    assert not list(careless(ast.parse('open(p, "rb"), p.read_text(encoding="utf-8")')))
    trees = {name: ast.parse(path.read_text("utf-8")) for name, path in MODULES.items()}
    found = [f"{name}: {call}" for name, tree in trees.items() for call in careless(tree)]
    own = "write_text(path, "  # report.write_text sees to both
    assert [each for each in found if own not in each] == [
        "cli: open(os.devnull, 'w', encoding='utf-8')",
        "extras: distribution('camgen').read_text('direct_url.json')",
    ]
