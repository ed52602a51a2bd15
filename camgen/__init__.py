"""camgen: cam and linkage CAD geometry from a text spec, with the motion proved from the written files.

    load       spec -> Mechanism: its motion, parts, poses, limits and study as data; `replace` sets keys anew
    build      spec -> files in OUT/<name>/, read back and judged -> Report
    check      folder of an earlier build -> Report, from its files alone
    motion     an outline in any drawing or mesh, a follower -> the follower's motion
    rolls      a drum in any mesh, a roller -> how far its follower is free, over the drum's angle
    drives     two outlines in any drawings or meshes -> where the driven one is free, over the driver's angle
    sweep      spec, values of its keys -> SweepTable: each variant judged, a row each
    design     spec with what is wanted -> DesignResult: the machine that fulfils it
    tolerance  spec -> Report: what print errors do to the motion
    simulate   spec with [walk] -> Report: how the machine walks on a floor, in MuJoCo; files in OUT/<name>-walk/
    explain    code of a finding -> what it means and what helps

Lengths are millimetres and angles radians; keys and figures that end in `_deg` are degrees. Nothing is printed. What a user
can get wrong, an argument of a wrong type too, is a CamgenError: SpecError, DesignError or FileError. Only what a call needs is
imported, when it is called.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, Unpack, cast

from camgen import design as _design  # noqa: F401  wings, loaded first: later on they would take the place of the functions
from camgen import motion as _motion  # noqa: F401  of their names
from camgen import sweep as _sweep  # noqa: F401
from camgen import tolerance as _tolerance  # noqa: F401
from camgen._version import __version__ as __version__
from camgen.arguments import checked
from camgen.errors import ArgumentError, CamgenError, DesignError, Fault, FileError, SpecError
from camgen.progress import silent

if TYPE_CHECKING:
    from camgen.design.run import DesignResult
    from camgen.findings import Finding
    from camgen.guide import Explanation
    from camgen.judge.rolled_drum import Rolled
    from camgen.machine.forces import Forces
    from camgen.machine.run import Play, Run
    from camgen.machines.mechanism import Mechanism
    from camgen.measuring.drives import Driven, DriveOptions
    from camgen.measuring.motion import Recovered
    from camgen.report.report import Report
    from camgen.sweep.results import SweepTable

    class Loaded(Mechanism):
        """A mechanism whose spec's tables are attributes: which ones, its kind says as the program runs."""

        def __getattr__(self, name: str) -> Any: ...


__all__ = [
    "ArgumentError",
    "CamgenError",
    "DesignError",
    "DesignResult",
    "Fault",
    "FileError",
    "Finding",
    "Forces",
    "Play",
    "Report",
    "Run",
    "SpecError",
    "SweepTable",
    "build",
    "check",
    "design",
    "drives",
    "explain",
    "load",
    "motion",
    "rolls",
    "simulate",
    "sweep",
    "tolerance",
]
_LATER = {
    "DesignResult": "design.run",
    "Finding": "findings",
    "Forces": "machine.forces",
    "Play": "machine.run",
    "Report": "report.report",
    "Run": "machine.run",
    "SweepTable": "sweep.results",
}


def __dir__() -> list[str]:
    return ["__doc__", "__file__", "__name__", "__version__", *__all__]


def __getattr__(name: str) -> Any:
    """Types of what calls give, for annotations: imported when they are asked for."""
    if name not in _LATER:
        raise AttributeError(f"module 'camgen' has no attribute '{name}'")
    from importlib import import_module

    return getattr(import_module(f"camgen.{_LATER[name]}"), name)


@checked
def load(spec: str | PathLike[str] | Mapping[str, Any] | Mechanism) -> Loaded:
    """The mechanism that a spec describes: a TOML file by its path, or its tables as a dict; of a mechanism itself.

    It is a frozen record of the spec's keys, defaults filled in. `motion(theta, order)`, theta (n,) rad, gives its output
    (rad or mm) or a derivative to theta, (n,). `solve(theta)` runs its model: a Run with `run["output"]`, (n,) rad or mm (a path:
    complex mm), `.velocity` and `.acceleration` per second, `.forces()` in N and N m, `.play("output")`, `.plot()`. `scene(theta)`, theta in
    rad, is the solids of all bodies as they stand, a trimesh.Scene in mm.
    Raises SpecError with all faults at once, FileError where a file cannot be read.
    """
    from camgen.machines.sources import read_mechanism

    return cast("Loaded", read_mechanism(spec))


@checked
def build(
    spec: str | PathLike[str] | Mapping[str, Any] | Mechanism,
    out: str | PathLike[str] = "out",
    only: str | Iterable[str] | None = None,
    jobs: int = 1,
) -> Report:
    """Make, read back and judge a machine; its folder `out/<name>/` appears, whole, only when all is done.

    spec: path, dict or what `load` gave; only: kinds of files to make, of "dxf", "stl", "3mf", "step", "report", "servo", "mjcf", "plots",
    "picture" (PNG) and "animation" (GIF), the usual ones being "dxf", "stl", "3mf" and "report"; jobs: cores to use, 0: all. The report has `ok`, `findings`, `numbers` (each in the unit that its name ends in), `parts`, `tables`,
    `plots`, and `as_dict()`, which is report.json; a notebook shows it. A finding that fails does not raise.
    Raises SpecError, DesignError where no such mechanism exists, FileError where a file cannot be written.
    """
    from pathlib import Path

    from camgen.pipeline import build as pipeline

    kinds = only.split(",") if isinstance(only, str) else pipeline.KINDS if only is None else only
    return pipeline.build(spec, Path(out), frozenset(map(str, kinds)), jobs=jobs)


@checked
def check(
    folder: str | PathLike[str],
    jobs: int = 1,
    gcode: Iterable[str | PathLike[str]] = (),
    line_width: float | None = None,
) -> Report:
    """Judge the files of an earlier build again, from the folder's files and the spec.toml beside them; writes nothing.

    gcode: of its plates, judged in place of the folder's files; line_width: mm, where it does not say it (CuraEngine).
    Raises SpecError where that spec is wrong, FileError where it or a listed file cannot be read.
    """
    from pathlib import Path

    plates = [Path(each) for each in gcode]
    if plates:
        from camgen.pipeline.sliced import check_gcode

        return check_gcode(Path(folder), plates, line_width)
    from camgen.pipeline import build as pipeline

    return pipeline.check(Path(folder), jobs=jobs)


@checked
def motion(
    file: str | PathLike[str],
    follower: str | PathLike[str] | Mapping[str, Any],
    height: float | None = None,
    layer: str | None = None,
    harmonics: int = 36,
) -> Recovered:
    """Motion of a follower on the outline in a drawing, mesh, G-code, scan or points of any maker, over one turn of the cam, its end left out.

    follower: as `camgen motion --help` says, on one line, "translating,radius=6", as a dict or as a path to a TOML file;
    height: of a mesh's section, mm (half way up); layer: of a DXF (all); harmonics: of a turn, low-pass of the derivatives.
    All (n,): `theta` rad; `s` displacement, rad on an arm and mm on a slide, nan where nothing is touched; `speed` and
    `acceleration`, its low-passed derivatives to theta; `pressure_angle` rad.
    Raises SpecError for the follower, FileError for the file, DesignError where the follower does not reach the outline.
    """
    from pathlib import Path

    from camgen.measuring.motion import roll

    return roll(Path(file), follower, height, layer, harmonics)


@checked
def rolls(
    file: str | PathLike[str],
    roller: str | PathLike[str] | Mapping[str, Any],
    harmonics: int = 36,
) -> Rolled:
    """What is free for the follower of a cylinder cam in a mesh of any maker, over one turn of the drum, its end left out.

    roller: as `camgen motion --help` says of --roller, on one line, "radius=5,length=8,inner=22", as a dict or as a path to a TOML
    file; harmonics: of a turn, low-pass of the derivatives.
    All (n,): `theta` rad; `low`, `high`, `motion` (their middle) and `play`, mm along the axis or rad of an arm, nan where no wall is;
    `speed` and `acceleration`, low-passed derivatives to theta; `pressure_angle` rad, at the roller's inner end; `cut`, where the
    roller cuts into the drum beside its walls. `between`: mm, by which a wall may stand nearer between two angles.
    Raises SpecError for the roller, FileError for the file, DesignError where the drum has no such track.
    """
    from pathlib import Path

    from camgen.measuring.drum import rolls as rolled

    return rolled(Path(file), roller, harmonics)


@checked
def drives(
    driver: str | PathLike[str],
    driven: str | PathLike[str],
    distance: float | None = None,
    **options: Unpack[DriveOptions],
) -> Driven:
    """Where one outline lets another be, over the driver's angle: gears, racks, Geneva wheels, any two contours of any maker.

    Both turn about their files' origins, the driven one `distance` mm to the right; or it slides: slides, direction in rad.
    ratio: driven turns for one of the driver, less than 0 against it; spring: "low" or "high", the end on which the driven one
    is held; inside: the driver runs within the driven contour; start: rad or mm, near which the driven one begins; centre,
    driven_centre: (x, y) of the pivots in their files; height, layer: of a mesh's section, mm, and of a DXF.
    All (n,), every quarter degree: `theta` rad; `low`, `high` and `play` rad or mm, nan where open; `free`; `error`, of the pushing
    flank less ratio x theta, and `transmission_error`, its peak to peak; `proven`, that nothing is skipped between samples.
    Raises SpecError for the options, FileError for a file, DesignError where they never touch or always overlap.
    """
    from pathlib import Path

    from camgen.measuring.drives import drives as pair

    return pair(Path(driver), Path(driven), distance, options)


@checked
def sweep(
    spec: str | PathLike[str] | Mapping[str, Any] | Mechanism,
    vary: Mapping[str, str | Iterable[Any]],
    how: Literal["grid", "zip"] | int = "grid",
    only: str | Iterable[str] = (),
    out: str | PathLike[str] = "out",
    jobs: int = 1,
) -> SweepTable:
    """Judge many variants of a spec: `camgen.sweep(cam, {"geometry.base_radius": range(20, 41, 5)})`.

    vary: values of each key, which is typed as for `--set`, or a text as of `--vary`, "20:40:5"; how: "grid", all values
    with all, "zip", first with first and so on, or the number of variants of a Latin hypercube between two ends of each key;
    only: kinds of files, "dxf", to make, read back and judge of each variant in a folder in `out`: without it closed-form
    limits and figures are judged, and nothing is written; jobs: processes, 0: one for each core.
    Raises SpecError for a key that no spec has; a variant that is wrong or cannot be made is a row that says so.
    """
    from pathlib import Path

    from camgen.sweep.results import swept
    from camgen.sweep.run import task_of
    from camgen.sweep.variants import variants_of
    from camgen.workers import core_count

    kinds = only.split(",") if isinstance(only, str) else tuple(map(str, only))
    task = task_of(spec, variants_of(vary, how), (), (), kinds, Path(out).absolute())
    return swept(task, core_count(jobs))


@checked
def design(
    spec: str | PathLike[str] | Mapping[str, Any] | Mechanism,
    jobs: int = 1,
    say: Callable[[str], None] = silent,
) -> DesignResult:
    """Search for what a spec's table [wanted] asks: a linkage for a path or a function, or values of keys that hold all limits.

    jobs: cores to use, 0: all; say: is handed lines on how it goes, such as print. The result has `machine`, `text`, its
    spec, `front`, all designs that are best in something, and `notes`.
    Raises SpecError with the faults of wish and spec; DesignError, with the nearest that was reached, where nothing fulfils it.
    """
    from camgen.design.run import found
    from camgen.workers import core_count

    return found(spec, jobs=core_count(jobs), say=say)


@checked
def tolerance(
    spec: str | PathLike[str] | Mapping[str, Any] | Mechanism,
    samples: int = 100_000,
    seed: int = 1,
    worst: int = 50,
    judged: int = 50,
) -> Report:
    """What print errors do to the motion: a budget by where they arise, and the yield of many printed copies, as tables.

    samples: copies; seed: the same gives the same copies; worst: how many of the worst are really rolled and closed;
    judged: how many are judged by every finding.
    Raises SpecError; DesignError where no joint bears an error.
    """
    from camgen.tolerance.report import PrintRun
    from camgen.tolerance.report import tolerance as copies

    return copies(spec, (), PrintRun(samples, seed, worst, judged))


@checked
def simulate(
    spec: str | PathLike[str] | Mapping[str, Any] | Mechanism,
    out: str | PathLike[str] = "out",
    copies: int = 0,
    seed: int = 1,
) -> Report:
    """How a machine with a table [walk] walks on a floor, at each friction of it; page, curves and film in OUT/<name>-walk/.

    copies: printed ones that walk as well, with errors and play of the print; seed: the same gives the same copies.
    Needs mujoco-core, the extra simulate.
    Raises SpecError where there is no such table; DesignError; FileError where MuJoCo is not there.
    """
    from pathlib import Path

    from camgen.simulation import walking

    return walking.simulate(spec, Path(out), (), walking.Prints(copies, seed))


@checked
def explain(
    code: str | Finding | None = None,
    spec: str | PathLike[str] | Mapping[str, Any] | Mechanism | None = None,
) -> Explanation:
    """What a finding's code means, its formula, where its limit comes from and what helps; without a code all, a line each.

    spec: explains it in this spec: its numbers before files are made, the key of its limit, and which keys move it by how
    much, found by trying each of them.
    Raises SpecError, with the nearest, for a code that there is none of, and for the spec.
    """
    from camgen.guide import explanation

    return explanation(code if code is None or isinstance(code, str) else code.code, spec)


for _function in (design, motion, sweep, tolerance):
    # by which Python finds the modules of the wing in `import camgen.motion.laws as laws`
    _function.__name__ = f"camgen.{_function.__name__}"
