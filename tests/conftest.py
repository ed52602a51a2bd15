"""What all tests share."""

from __future__ import annotations

import gc
import hashlib
import os
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from zlib import crc32

import pytest
from hypothesis import HealthCheck, settings

# However long examples take, for a machine may be busy; on a build server the same ones each time, so that a red run can be
# run again, elsewhere new ones.
settings.register_profile(
    "camgen",
    derandomize=bool(os.environ.get("CI")),
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("camgen")
os.environ.setdefault(
    "OPENBLAS_NUM_THREADS", "1"
)  # before numpy: each core has a process of its own
gc.set_threshold(
    1_000_000, 50, 100
)  # Python's own 700 collects so often that it takes a tenth of the time of what builds

MOST_WAITED = 6000  # times 0.05 s, for a folder that another process makes
ROOT = Path(__file__).resolve().parent.parent


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--share", metavar="K/N", help="of what is long only share K, 0 to N - 1, of N"
    )


def _share(config: pytest.Config) -> tuple[int, int]:
    """Share K and their number N, of `--share`; the only one of one without it."""
    share, count = map(int, (config.getoption("share") or "0/1").split("/"))
    return share, count


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Keeps all short tests, and the long ones of a share of the files: what a file builds is built in one share.

    A hash of the file's path says which share is its own, and of one parameter too where the mark names it, `long(by="name")`;
    all shares together are all tests. The path is read backwards: so no share is much longer than another one.
    """
    share, count = _share(config)
    kept = []
    left = []
    for item in items:
        mark = item.get_closest_marker("long")
        (kept if mark is None or _hash(item, mark) % count == share else left).append(item)
    items[:] = kept
    if left:
        config.hook.pytest_deselected(items=left)


def _hash(item: pytest.Item, mark: pytest.Mark) -> int:
    """The same of all tests that belong in one share."""
    path = item.nodeid.split("::")[0]
    by = mark.kwargs.get("by")
    name = path if by is None else f"{path} {item.callspec.params[by]}"  # type: ignore[attr-defined]
    return crc32(name[::-1].encode())


@pytest.fixture(scope="session")
def share_of(pytestconfig: pytest.Config) -> Callable[[Sequence[str]], Sequence[str]]:
    """Every Nth of some names, from the Kth on, for `--share K/N`; all without it."""
    share, count = _share(pytestconfig)
    return lambda names: names[share::count]


@pytest.fixture
def root() -> Path:
    return ROOT


@pytest.fixture
def starter() -> Path:
    return ROOT / "specs" / "uniform-swing.toml"


@pytest.fixture(scope="session", autouse=True)
def one_core() -> Iterator[None]:
    """Where each core has a process of tests, a build that takes all of them takes a quarter more of their time."""
    with pytest.MonkeyPatch.context() as patch:
        if "PYTEST_XDIST_WORKER" in os.environ:
            patch.setattr("camgen.pipeline.case.all_cores", lambda: 1)
        yield


@pytest.fixture(scope="session", autouse=True)
def flat() -> Iterator[None]:
    """Builds lie flat, by whatever number of files, but for the tests of shelves: one name, one path."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("camgen.files.shelves.MOST_FLAT", 10**6)
        yield


@pytest.fixture(scope="session", autouse=True)
def drawn_and_read_once() -> Iterator[None]:
    """Builds of one process have many parts in common: each is drawn once, and each drawing and exact solid read once.

    What `check` makes anew, to hold it against the files, is drawn anew.
    """
    import kept

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("camgen.pipeline.making.draw_part", kept.draw_part)
        patch.setattr("camgen.judge.round_trip.read_contours", kept.read_contours)
        patch.setattr("camgen.files.step.read_step", kept.read_step)
        for user in ("files.dxf", "judge.machine_tables", "judge.sheets", "pipeline.machining"):
            patch.setattr(f"camgen.{user}.read_dxf", kept.read_dxf)
        yield


Built = Callable[..., Path]
Once = Callable[[str, Callable[[Path], None]], Path]


@pytest.fixture(scope="session")
def once(tmp_path_factory: pytest.TempPathFactory) -> Once:
    """once("name", make): a folder that make(folder) fills, once for all tests, in whatever process they run."""
    own = tmp_path_factory.getbasetemp()
    shared = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own

    def folder(name: str, make: Callable[[Path], None]) -> Path:
        out, lock = shared / name, shared / f"{name}.lock"
        for _ in range(MOST_WAITED):
            try:
                lock.mkdir()  # one process alone can
                break
            except FileExistsError:
                time.sleep(0.05)
        else:
            raise TimeoutError(f"{lock}: whoever makes this folder has not ended")
        try:
            if not out.exists():
                make(out)
        finally:
            lock.rmdir()
        return out

    return folder


@pytest.fixture(scope="session")
def built(once: Once) -> Built:
    """built("disc-cam", *settings): the folder of a sound build of a starter spec, all kinds of files.

    To be read, and copied where it is to be damaged.
    """

    def folder(spec: str, *settings: str) -> Path:
        from camgen.pipeline.build import KINDS, build

        def make(out: Path) -> None:
            report = build(ROOT / "specs" / f"{spec}.toml", out, frozenset(KINDS), settings)
            assert report.ok, [finding for finding in report.findings if not finding.ok]

        (made,) = once(
            f"built-{hashlib.sha256(repr((spec, settings)).encode()).hexdigest()[:12]}", make
        ).iterdir()
        return made

    return folder
