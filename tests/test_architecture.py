"""The rows of the architecture, held against the imports that the code really makes, lazy ones included."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parent.parent / "camgen"

# Imports go to lower rows only.
ROWS = (
    {"errors", "tolerances", "numerics"},
    {"motion", "findings", "spec", "standards", "machine"},
    {"program", "spring_law", "unloader", "outlines", "sampling", "arcfit", "trimming", "crossing", "distances", "rings"}
    | {"linkages", "dynamics", "landmarks", "tips", "unpacking"},
    {"followers", "parts", "segments", "selftest", "fits", "feed", "synthesis", "stitch", "looper_timing", "nearness"},
    {"mechanism", "hardware", "canvas", "follower_dynamics", "looper_design", "looper_parts", "disc_parts", "sizing"}
    | {"swing_tables"}
    | {"contact_tips"},
    {"solids", "readback", "contact", "contact_faces", "undoing", "closure", "mechanisms"}
    | {"eccentric_study", "feed_study", "looper_study", "swing_machine", "swing_list", "swing_study", "indexing_study"}
    | {"swing_room"},
    {"export", "dxf", "sheet", "drawing", "dimensions", "packing", "lying", "verify", "rolling", "interference", "slabs"}
    | {"sweep", "clearance", "folder", "budget", "outline_files", "follower_table"},
    {"report", "moving", "figures", "jobs", "scope", "expectation"},
    {"making", "judging"},
    {"pipeline", "outline_motion", "terminal", "benchmark"},
    {"benchmark_report"},
    {"cli", "__main__"},
)
# Imports inside a row, each towards what the other is made from.
SAME_ROW = {
    ("sampling", "outlines"),
    ("arcfit", "outlines"),
    ("arcfit", "sampling"),
    ("trimming", "outlines"),
    ("crossing", "outlines"),
    ("crossing", "rings"),
    ("dynamics", "linkages"),
    ("landmarks", "linkages"),
    ("mechanisms", "eccentric_study"),
    ("mechanisms", "feed_study"),
    ("mechanisms", "swing_machine"),
    ("mechanisms", "swing_room"),
    ("swing_machine", "swing_room"),
    ("mechanisms", "swing_list"),
    ("swing_list", "swing_machine"),
    ("mechanisms", "swing_study"),
    ("mechanisms", "indexing_study"),
    ("sweep", "interference"),
    ("sweep", "slabs"),
    ("interference", "slabs"),
    ("mechanisms", "looper_study"),
    ("fits", "parts"),
    ("looper_timing", "stitch"),
    ("packing", "export"),
    ("packing", "lying"),
    ("export", "dxf"),
    ("drawing", "dxf"),
    ("drawing", "dimensions"),
    ("dimensions", "dxf"),
    ("drawing", "sheet"),
    ("sheet", "dxf"),
    ("budget", "rolling"),
    ("report", "moving"),
    ("judging", "making"),
    ("__main__", "cli"),
}
# The judge sees files, the wanted motion and how parts touch; never what made the curve.
JUDGES = {
    "readback",
    "contact",
    "contact_tips",
    "contact_faces",
    "closure",
    "clearance",
    "verify",
    "rolling",
    "interference",
    "slabs",
    "sweep",
    "undoing",
    "rings",
    "distances",
    "unpacking",
}
MAKERS = {
    "outlines", "sampling", "arcfit", "trimming", "followers", "linkages", "parts", "mechanisms", "mechanism", "solids",
    "export", "packing", "lying", "fits", "dxf", "sheet", "drawing", "dimensions", "program", "segments", "crossing",
    "stitch", "looper_design", "looper_parts", "looper_timing",
    "looper_study", "tips", "sizing", "disc_parts", "swing_room", "swing_tables",
}  # fmt: skip
HOW_PARTS_TOUCH = {
    ("mechanism", name)
    for name in ("Apart", "Contact", "Eye", "Moved", "Pin", "Pose", "Poses", "Rolling", "Slide", "StandIn", "Traced")
}
HEAVY = {"ezdxf", "trimesh", "manifold3d", "lib3mf", "mapbox_earcut", "matplotlib", "shapely", "scipy", "rich"}
LIGHT_MODULES = {"__init__", "__main__", "cli", "terminal", "errors", "findings", "folder", "tolerances"}  # no numpy, pydantic

MODULES = {path.relative_to(PACKAGE).with_suffix("").as_posix(): path for path in sorted(PACKAGE.rglob("*.py"))}


def short(module: str) -> str:
    """Name in the rows: `mechanisms` for all that is in that folder."""
    return module.split("/")[0]


def imports(tree: ast.AST) -> set[tuple[str, str]]:
    """All (module, name) that are imported anywhere, type-checking blocks aside; name "" for plain imports."""
    found = set()
    hidden = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if id(node) in hidden:
            continue
        if isinstance(node, ast.Import):
            found |= {(alias.name, "") for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide the row"
            found |= {(node.module or "", alias.name) for alias in node.names}
    return found


def ours(tree: ast.AST) -> set[tuple[str, str]]:
    """The (module of camgen, name) that are imported; `from camgen import x` is module x."""
    found = set()
    for module, name in imports(tree):
        if module == "camgen" and name in {short(each) for each in MODULES} - {"__init__"}:
            found.add((name, ""))
        elif module.startswith("camgen."):
            found.add((module.split(".")[1], name))
    return found


def crossings(module: str, tree: ast.AST) -> list[str]:
    """Imports that do not go down."""
    row = {name: k for k, names in enumerate(ROWS) for name in names}
    here = short(module)
    return [
        f"{module} (row {row[here]}) imports {there} (row {row[there]})"
        for there, _ in sorted(ours(tree))
        if not (row[there] < row[here] or (here, there) in SAME_ROW or (here == there == "machine"))
    ]


def bribes(module: str, tree: ast.AST) -> list[str]:
    """What a judge imports of the makers."""
    if short(module) not in JUDGES:
        return []
    return [f"{module} imports {there}" for there, name in sorted(ours(tree))
            if there in MAKERS and (there, name) not in HOW_PARTS_TOUCH]  # fmt: skip


def heavy_at_top(module: str, tree: ast.Module) -> list[str]:
    """Heavy packages that importing the module would load."""
    top = ast.Module([node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)], [])
    forbidden = HEAVY | ({"numpy", "pydantic"} if module in LIGHT_MODULES else set())
    return [f"{module} imports {name}" for name, _ in sorted(imports(top)) if name.split(".")[0] in forbidden]


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


def tree_of(module: str) -> ast.Module:
    return ast.parse(MODULES[module].read_text(encoding="utf-8"))


@pytest.mark.parametrize("module", MODULES)
def test_module_keeps_the_rules(module: str) -> None:
    tree = tree_of(module)
    assert module == "__init__" or any(short(module) in row for row in ROWS), "a module without a row"
    assert (crossings(module, tree) if module != "__init__" else []) == []
    assert bribes(module, tree) == []
    assert heavy_at_top(module, tree) == []
    assert undocumented(module, tree) == []
    assert len(MODULES[module].read_text(encoding="utf-8").splitlines()) <= 500, "two ideas in one module"


def test_only_figures_imports_matplotlib() -> None:
    packages = {module: {name.split(".")[0] for name, _ in imports(tree_of(module))} for module in MODULES}
    assert {module for module in MODULES if "matplotlib" in packages[module]} <= {"figures"}


def test_modules_stand_in_one_row_and_exceptions_are_used() -> None:
    names = [name for row in ROWS for name in row]
    assert len(names) == len(set(names))
    used = {(short(module), there) for module in MODULES for there, _ in ours(tree_of(module))}
    written = {short(module) for module in MODULES}
    assert {pair for pair in SAME_ROW - used if set(pair) <= written} == set()
    assert set(names) - written == set(), "rows name modules that do not exist"


@pytest.mark.parametrize(
    "rule, module, text",
    [
        (crossings, "motion", "from camgen.geometry.outlines import Line"),
        (crossings, "motion", "def f():\n    import camgen.pipeline.build"),
        (crossings, "findings", "from camgen import spec"),
        (crossings, "mechanism", "def f():\n    from camgen.machines.uniform_swing.mechanism import UniformSwing"),
        (bribes, "verify", "def f():\n    from camgen.machine.cams import DiscCam"),
        (bribes, "readback", "from camgen import arcfit"),
        (bribes, "contact", "from camgen.machines.mechanism import Mechanism"),
        (bribes, "closure", "from camgen.machine.linkages import RRR"),
        (heavy_at_top, "export", "import trimesh.util"),
        (heavy_at_top, "cli", "import numpy as np"),
        (undocumented, "parts", '"""Parts."""\nclass A:\n    """A."""\n    def b(self): ...'),
    ],
)
def test_each_rule_is_seen_to_fail(rule: object, module: str, text: str) -> None:
    assert len(rule(module, ast.parse(text))) == 1  # type: ignore[operator]


def loaded(code: str) -> set[str]:
    """Top-level packages that a fresh interpreter has loaded after the code."""
    code += "\nimport sys\nprint('LOADED', *{name.split('.')[0] for name in sys.modules})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.rpartition("LOADED")[2].split())


def test_help_loads_nothing_heavy() -> None:
    code = "from camgen.cli import main\ntry:\n    main(['--help'])\nexcept SystemExit:\n    pass"
    assert loaded(code) & (HEAVY | {"numpy", "pydantic", "tomllib"}) == set()


def test_dxf_only_run_loads_no_mesh_library(starter: Path, tmp_path: Path) -> None:
    code = (
        "from camgen.cli import main\ntry:\n"
        f"    main(['build', {str(starter)!r}, '--only', 'dxf', '-o', {str(tmp_path)!r}])\n"
        "except SystemExit as done:\n    assert done.code == 0, done.code"
    )
    assert loaded(code) & {"trimesh", "manifold3d", "lib3mf", "mapbox_earcut", "matplotlib", "scipy"} == set()
