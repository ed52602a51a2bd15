"""The output folder appears whole or not at all, and never costs anyone a file."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import resource
import signal
import stat
import subprocess
import sys
import textwrap
from importlib.metadata import version
from pathlib import Path

import pytest

from camgen.errors import FileError
from camgen.files import folder as folders
from camgen.files.folder import MANIFEST, StagingFolder, manifest_files, write_manifest


def tree(folder: Path) -> dict[str, bytes]:
    """All files below a folder, hidden ones too."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def make(target: Path, text: str = "first", extra: str | None = None) -> None:
    """A result as a build makes it."""
    with StagingFolder(target) as folder:
        (folder / "a.txt").write_text(text)
        (folder / "sub").mkdir()
        (folder / "sub" / "b.txt").write_text(text)
        if extra:
            (folder / extra).write_text(text)
        write_manifest(folder, ["numpy"])


def test_result_replaces_an_earlier_one_whole(tmp_path: Path) -> None:
    target = tmp_path / "deep" / "out" / "cam"
    make(target, extra="only-in-the-first.txt")
    make(target, "second")
    assert set(tree(tmp_path)) == {
        f"deep/out/cam/{name}" for name in ("a.txt", "sub/b.txt", "manifest.json")
    }
    assert (target / "a.txt").read_text() == "second"


def test_result_is_as_open_as_the_umask_says(tmp_path: Path) -> None:
    before = os.umask(0o022)
    try:
        make(tmp_path / "cam")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "cam").stat().st_mode) == 0o755


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, MemoryError])
def test_any_exception_leaves_the_earlier_result(
    tmp_path: Path, error: type[BaseException]
) -> None:
    make(tmp_path / "cam")
    before = tree(tmp_path)
    with pytest.raises(error), StagingFolder(tmp_path / "cam") as folder:
        (folder / "a.txt").write_text("half")
        raise error
    assert tree(tmp_path) == before


def test_failure_leaves_no_parents_behind(tmp_path: Path) -> None:
    with pytest.raises(ValueError), StagingFolder(tmp_path / "deep" / "out" / "cam"):
        raise ValueError
    assert list(tmp_path.iterdir()) == []


def test_a_way_through_a_folder_that_is_not_there_yet(tmp_path: Path) -> None:
    target = tmp_path / "x" / ".." / "y" / "cam"
    with pytest.raises(ValueError), StagingFolder(target):
        raise ValueError
    assert list(tmp_path.iterdir()) == []
    make(target)
    assert (
        (tmp_path / "y" / "cam" / "a.txt").read_text() == "first" == (target / "a.txt").read_text()
    )


def test_earlier_result_stays_while_the_new_one_is_made(tmp_path: Path) -> None:
    make(tmp_path / "cam")
    with StagingFolder(tmp_path / "cam") as folder:
        assert (tmp_path / "cam" / "a.txt").read_text() == "first"
        assert os.stat(folder).st_dev == os.stat(tmp_path).st_dev
        (folder / "a.txt").write_text("second")
    assert tree(tmp_path) == {"cam/a.txt": b"second"}


@pytest.fixture
def renames(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """A system that cannot let two folders change places."""
    monkeypatch.setattr(folders, "_exchanged", lambda new, target: False)
    return monkeypatch


def test_result_replaces_an_earlier_one_by_renames(
    tmp_path: Path, renames: pytest.MonkeyPatch
) -> None:
    make(tmp_path / "cam", extra="only-in-the-first.txt")
    make(tmp_path / "cam", "second")
    assert set(tree(tmp_path)) == {
        f"cam/{name}" for name in ("a.txt", "sub/b.txt", "manifest.json")
    }
    assert (tmp_path / "cam" / "a.txt").read_text() == "second"


@pytest.mark.skipif(
    sys.platform != "linux", reason="folders change places in one step on Linux alone"
)
def test_there_is_a_result_at_every_moment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make(tmp_path / "cam")
    monkeypatch.setattr(
        os, "rename", lambda source, target: pytest.fail("a moment without a result")
    )
    make(tmp_path / "cam", "second")
    assert (tmp_path / "cam" / "a.txt").read_text() == "second" and len(
        list(tmp_path.iterdir())
    ) == 1


@pytest.mark.parametrize("failing", [1, 2])
def test_failed_rename_restores_the_earlier_result(
    tmp_path: Path, renames: pytest.MonkeyPatch, failing: int
) -> None:
    monkeypatch = renames
    make(tmp_path / "cam")
    before, calls, rename = tree(tmp_path), [], os.rename

    def broken(source: Path, target: Path) -> None:
        calls.append(target)
        if len(calls) == failing:
            raise OSError(errno.EIO, "Input/output error", str(source))
        rename(source, target)

    monkeypatch.setattr(os, "rename", broken)
    with pytest.raises(FileError, match="Input/output error"):
        make(tmp_path / "cam", "second")
    assert tree(tmp_path) == before


def test_interrupt_between_the_renames_restores_the_earlier_result(
    tmp_path: Path, renames: pytest.MonkeyPatch
) -> None:
    monkeypatch = renames
    make(tmp_path / "cam")
    before, rename = tree(tmp_path), os.rename

    def interrupted(source: Path, target: Path) -> None:
        rename(source, target)
        monkeypatch.undo()
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        make(tmp_path / "cam", "second")
    assert tree(tmp_path) == before


def test_result_that_cannot_be_brought_back_at_once_is_not_thrown_away(
    tmp_path: Path, renames: pytest.MonkeyPatch
) -> None:
    """Every rename after the first fails; the next build finds the earlier result and brings it back."""
    make(tmp_path / "cam")
    before, rename, calls = tree(tmp_path), os.rename, []

    def broken(source: Path, target: Path) -> None:
        calls.append(target)
        if len(calls) > 1:
            raise OSError(errno.EIO, "Input/output error", str(source))
        rename(source, target)

    renames.setattr(os, "rename", broken)
    with pytest.raises(OSError):
        make(tmp_path / "cam", "second")
    assert not (tmp_path / "cam").exists()
    renames.undo()
    with pytest.raises(ValueError), StagingFolder(tmp_path / "cam"):
        raise ValueError
    assert tree(tmp_path) == before


# ---- builds that were killed -----------------------------------------------------------------------------------------

BUILD = """
import os, signal, sys
from pathlib import Path
from camgen.files import folder as folders
target, when = Path(sys.argv[1]), sys.argv[2]
def killed(*_):
    os.kill(os.getpid(), signal.SIGKILL)
rename = os.rename
def first_then_killed(source, to):
    rename(source, to)
    killed()
if when == "between":
    folders._exchanged = lambda new, old: False
    os.rename = first_then_killed
if when == "after":
    folders._remove = killed
with folders.StagingFolder(target) as folder:
    (folder / "a.txt").write_text("killed")
    if when == "work":
        killed()
    if when == "wait":
        print(folder.parent.name, flush=True)
        sys.stdin.read()
    folders.write_manifest(folder, [])
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL")
@pytest.mark.parametrize("when, left", [("work", "first"), ("between", None), ("after", "killed")])
def test_what_a_killed_build_left_is_swept_and_brought_back(
    tmp_path: Path, when: str, left: str | None
) -> None:
    """The next build, of whatever name, finds a result, even if it comes to nothing itself, and nothing else lies about."""
    target = tmp_path / "cam"
    make(target)
    before = tree(tmp_path)
    done = subprocess.run([sys.executable, "-c", BUILD, str(target), when])
    assert done.returncode == -signal.SIGKILL
    assert len(list(tmp_path.iterdir())) == (2 if left else 1) and target.exists() is bool(left)
    if left:
        assert (target / "a.txt").read_text() == left
    with pytest.raises(ValueError), StagingFolder(tmp_path / "other"):
        raise ValueError
    assert [path.name for path in tmp_path.iterdir()] == ["cam"]
    assert left == "killed" or tree(tmp_path) == before
    make(target, "second")
    assert (target / "a.txt").read_text() == "second" and [
        path.name for path in tmp_path.iterdir()
    ] == ["cam"]


def test_folder_of_a_build_that_runs_is_left_alone(tmp_path: Path) -> None:
    """Another process, and another build in this one."""
    with subprocess.Popen(
        [sys.executable, "-c", BUILD, str(tmp_path / "cam"), "wait"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as other:
        assert other.stdin and other.stdout
        name = other.stdout.readline().strip()
        with StagingFolder(tmp_path / "cam") as mine:
            make(tmp_path / "cam", "second")
            assert (tmp_path / name / "new" / "a.txt").read_text() == "killed" and mine.exists()
            write_manifest(mine, [])
    assert other.returncode == 0 and (tmp_path / "cam" / "a.txt").read_text() == "killed"
    assert [path.name for path in tmp_path.iterdir()] == ["cam"]


@pytest.mark.parametrize(
    "name", [".cam-notes", ".cam-abcd1234", ".cam-abcd123", ".other-abcd1234", "cam-abcd1234"]
)
@pytest.mark.parametrize("files", [{}, {"camgen.lock": "mine"}, {"new/a.txt": ""}])
def test_folders_that_only_look_like_camgen_s_are_left_alone(
    tmp_path: Path, name: str, files: dict[str, str]
) -> None:
    for file, text in ({"old/a.txt": "mine"} | files).items():
        (tmp_path / name / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name / file).write_text(text)
    before = tree(tmp_path)
    make(tmp_path / "cam")
    assert {
        key: text for key, text in tree(tmp_path).items() if not key.startswith("cam/")
    } == before


def test_folder_with_more_in_it_is_left_alone(tmp_path: Path) -> None:
    stray = tmp_path / ".cam-abcd1234"
    stray.mkdir()
    (stray / "camgen.lock").write_bytes(folders._MARK)
    (stray / "notes.txt").write_text("mine")
    make(tmp_path / "cam")
    assert (stray / "notes.txt").read_text() == "mine"
    (stray / "notes.txt").unlink()
    make(tmp_path / "cam")
    assert not stray.exists()


# ---- a spec.toml that somebody has edited ----------------------------------------------------------------------------


def with_spec(target: Path, text: str) -> list[str]:
    """A build of a spec; names of what it kept."""
    staged = StagingFolder(target)
    with staged as folder:
        (folder / "spec.toml").write_text(text)
        write_manifest(folder, [])
    return staged.kept


@pytest.mark.parametrize("exchange", [True, False])
def test_edited_spec_is_kept_by_this_build_and_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exchange: bool
) -> None:
    if not exchange:
        monkeypatch.setattr(folders, "_exchanged", lambda new, target: False)
    target = tmp_path / "cam"
    assert with_spec(target, "lift = 1") == with_spec(target, "lift = 2") == []
    (target / "spec.toml").write_text("lift = 3  # better")
    assert with_spec(target, "lift = 2") == ["spec.toml.edited"]
    wanted = {"spec.toml": b"lift = 2", "spec.toml.edited": b"lift = 3  # better"}
    for _ in range(2):
        found = tree(target)
        assert (
            json.loads(found.pop("manifest.json"))["files"].keys() == {"spec.toml"}
            and found == wanted
        )
        assert with_spec(target, "lift = 2") == []
    (target / "spec.toml").write_text("lift = 4")
    assert with_spec(target, "lift = 2") == ["spec.toml.edited-2"]
    assert (
        tree(target)["spec.toml.edited"] == b"lift = 3  # better"
        and tree(target)["spec.toml.edited-2"] == b"lift = 4"
    )
    for same in ("lift = 4", "lift = 5"):  # kept already; and what the new build writes anyway
        (target / "spec.toml").write_text(same)
        assert with_spec(target, "lift = 5") == []


def test_edited_spec_alone_does_not_make_a_folder_camgen_s(tmp_path: Path) -> None:
    (tmp_path / "cam").mkdir()
    (tmp_path / "cam" / "spec.toml.edited").write_text("mine")
    with pytest.raises(FileError, match="not made by camgen"):
        make(tmp_path / "cam")


# ---- files that are not ours -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "files, named",
    [
        ({"letter.txt": "dear"}, "letter.txt"),
        ({"sub/letter.txt": "dear"}, "sub"),
        ({"manifest.json": "{}"}, "manifest.json"),
        ({"manifest.json": "not json"}, "manifest.json"),
        ({"manifest.json": "[1]"}, "manifest.json"),
        ({"manifest.json": '{"files": {"a.txt": {}}, "name": "a web app"}', "a.txt": "x"}, "a.txt"),
    ],
)
def test_folder_that_camgen_did_not_make_is_left_alone(
    tmp_path: Path, files: dict[str, str], named: str
) -> None:
    for name, text in files.items():
        (tmp_path / "cam" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "cam" / name).write_text(text)
    before = tree(tmp_path)
    with pytest.raises(FileError, match="not made by camgen") as caught:
        make(tmp_path / "cam")
    assert caught.value.exit_code == 4
    assert caught.value.path == str(tmp_path / "cam" / named)
    assert tree(tmp_path) == before


@pytest.mark.parametrize("name", ["notes.txt", "sub/notes.txt", ".hidden", "empty/"])
def test_file_added_to_a_result_protects_it(tmp_path: Path, name: str) -> None:
    make(tmp_path / "cam")
    added = tmp_path / "cam" / name
    added.mkdir() if name.endswith("/") else added.write_text("mine")
    before = tree(tmp_path)
    with pytest.raises(FileError) as caught:
        make(tmp_path / "cam", "second")
    assert caught.value.path == str(added)
    assert tree(tmp_path) == before and added.exists()


def test_file_added_while_the_work_is_done_protects_the_folder(tmp_path: Path) -> None:
    make(tmp_path / "cam")
    with pytest.raises(FileError, match="notes.txt"), StagingFolder(tmp_path / "cam"):
        (tmp_path / "cam" / "notes.txt").write_text("mine")
    assert (tmp_path / "cam" / "notes.txt").read_text() == "mine"
    assert (tmp_path / "cam" / "a.txt").read_text() == "first"


def test_empty_folder_and_lost_files_are_no_obstacle(tmp_path: Path) -> None:
    (tmp_path / "cam").mkdir()
    make(tmp_path / "cam")
    (tmp_path / "cam" / "a.txt").unlink()
    make(tmp_path / "cam", "second")
    assert (tmp_path / "cam" / "a.txt").read_text() == "second"


def test_file_or_link_where_the_folder_should_be(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "elsewhere")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    for name in ("file", "link", "dangling"):
        with pytest.raises(FileError, match="not a folder"):
            make(tmp_path / name)
    with pytest.raises(FileError, match="is a file, where the output needs a folder|File exists"):
        make(tmp_path / "file" / "cam")
    assert (tmp_path / "file").read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "dangling",
        "elsewhere",
        "file",
        "link",
    ]


# ---- disks that do not take it ---------------------------------------------------------------------------------------


def test_parent_that_takes_no_folder() -> None:
    with pytest.raises(FileError, match="cannot be written") as caught:
        make(Path("/proc/camgen/cam"))  # no one may write there, root neither
    assert caught.value.exit_code == 4


def test_read_only_parent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(path: object, mode: int = 0o777) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    monkeypatch.setattr(os, "mkdir", refuse)
    with pytest.raises(FileError, match="Permission denied"):
        make(tmp_path / "cam")
    assert list(tmp_path.iterdir()) == []


def test_full_disk_names_the_file_where_it_was_to_be(tmp_path: Path) -> None:
    make(tmp_path / "cam")
    before = tree(tmp_path)
    with pytest.raises(FileError) as caught, StagingFolder(tmp_path / "cam") as folder:
        (folder / "a.txt").write_text("half")
        raise OSError(errno.ENOSPC, "No space left on device", str(folder / "b.stl"))
    assert caught.value.path == str(tmp_path / "cam" / "b.stl")
    assert "No space left" in caught.value.reason
    assert tree(tmp_path) == before


def test_write_that_the_system_cuts_short(tmp_path: Path) -> None:
    """A real failure of a write half way: the size of a file is limited in another process."""
    make(tmp_path / "cam")
    before = tree(tmp_path)
    code = textwrap.dedent(
        """
        import sys
        from pathlib import Path
        from camgen.errors import FileError
        from camgen.files.folder import StagingFolder
        try:
            with StagingFolder(Path(sys.argv[1])) as folder:
                (folder / "big.stl").write_bytes(bytes(1_000_000))
        except FileError as error:
            print(error)
            sys.exit(error.exit_code)
        """
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "cam")],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000)),
    )
    assert done.returncode == 4, done.stderr
    assert "File too large" in done.stdout
    assert tree(tmp_path) == before


# ---- manifest --------------------------------------------------------------------------------------------------------


def test_manifest_lists_every_file_and_is_the_same_each_time(tmp_path: Path) -> None:
    for name in ("one", "two"):
        make(tmp_path / name)
    text = (tmp_path / "one" / "manifest.json").read_bytes()
    assert text == (tmp_path / "two" / "manifest.json").read_bytes()
    found = json.loads(text)
    digest = hashlib.sha256(b"first").hexdigest()
    assert found["files"] == {
        name: {"bytes": 5, "sha256": digest} for name in ("a.txt", "sub/b.txt")
    }
    assert found["packages"] == {"numpy": version("numpy")}
    assert list(found["files"]) == sorted(found["files"])


def test_manifest_of_a_package_that_is_not_there(tmp_path: Path) -> None:
    write_manifest(tmp_path, ["no-such-package-of-anyone", "click"])
    assert list(json.loads((tmp_path / "manifest.json").read_text())["packages"]) == ["click"]


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device")
def test_a_manifest_without_end_is_refused(tmp_path: Path) -> None:
    (tmp_path / MANIFEST).symlink_to("/dev/zero")
    with pytest.raises(FileError, match="pipe or a device"):
        manifest_files(tmp_path)
