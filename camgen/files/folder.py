"""The output folder: it appears whole or not at all, replaces only what camgen made, and says what is in it.

target    where the result is to be
staging   folder beside it, `.<name>-xxxxxxxx`, with `new`, the result that is being made; a lock that lives as long as
          the build tells others that it is in use
exchange  target and `new` change places in one step where the system can; elsewhere the target is moved to `old` first,
          and a build that is killed in between leaves it there for the next one to bring back
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import suppress
from itertools import count
from pathlib import Path
from types import MappingProxyType, TracebackType
from typing import Any, BinaryIO

from camgen._version import __version__
from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError
from camgen.files.shelves import located

MANIFEST = "manifest.json"
_MANIFEST_SIZE = Bound("a manifest", 10_000_000)
SPEC = "spec.toml"

_LONGEST_NAME = 50  # characters
_STAGING = re.compile(r"\.(.+)-[a-z0-9_]{8}")
_EDITED = re.compile(r"spec\.toml\.edited(-\d+)?")
_LOCK = "camgen.lock"
_MARK = b"a build of camgen works here\n"
# of renameat2 [linux/fcntl.h, linux/fs.h]
_AT_CWD = -100
_EXCHANGE = 2
_in_use: set[Path] = (
    set()
)  # staging folders of this process, whose locks do not hold against itself


def name_of(path: Path) -> str:
    """Name of a folder for what is read from a file: its stem in small letters, digits and hyphens, at most 50 characters.

    Blanks are hyphens. Where more is left out, six digits of the stem's SHA-256 stand behind it: no two such stems share a folder.
    """
    stem = path.stem.lower().replace(" ", "-")
    name = re.sub("[^a-z0-9]+", "-", stem).strip("-")
    if name == stem and len(name) <= _LONGEST_NAME:
        return name
    digest = hashlib.sha256(stem.encode("utf-8", "surrogateescape")).hexdigest()[:6]
    return "-".join(filter(None, (name[: _LONGEST_NAME - 7].rstrip("-"), digest)))


class StagingFolder:
    """`with StagingFolder(target) as folder:` gives a fresh folder beside the target; it takes the target's place at the end.

    An earlier result stays as it is until the block has succeeded, and after any exception or Ctrl-C. FileError where
    the target holds anything that its manifest does not list, where it is no folder, and for any OSError in the block.
    A spec.toml that somebody has changed since is kept beside the new one; `kept` names what it is called there; `gone` are
    files of the earlier result that the new one has not.
    """

    def __init__(self, target: Path) -> None:
        self.target = Path(target)
        self.kept: list[str] = []
        self.gone: list[str] = []
        self._made: list[Path] = []  # parents that did not exist, outermost first

    def __enter__(self) -> Path:
        self._sweep()
        self._refuse_foreign()
        parent = self.target.parent
        try:
            missing = [folder for folder in (parent, *parent.parents) if not folder.exists()]
            for folder in reversed(missing):
                if not folder.exists():  # x/.. of a missing x is there as soon as x is
                    folder.mkdir()
                    self._made.append(folder)
            self._staging = Path(tempfile.mkdtemp(prefix=f".{self.target.name}-", dir=parent))
            self._guard = _guarded(self._staging)
            self._new = self._staging / "new"
            self._new.mkdir()  # unlike mkdtemp's folder, as open to others as the user's umask says
        except BaseException as error:
            self._discard()
            self._explain(error)
            raise
        return self._new

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            if error is None:
                self._replace()
            self._explain(error)
        finally:
            self._discard()

    def _replace(self) -> None:
        self._refuse_foreign()  # once more: the work took a while
        self._keep_edited()
        old = self._staging / "old"
        try:
            if not (self.target.exists() and _exchanged(self._new, self.target)):
                if self.target.exists():
                    os.rename(self.target, old)
                os.rename(self._new, self.target)
            self._made.clear()
        except BaseException as error:
            if old.exists() and not self.target.exists():
                os.rename(old, self.target)
            self._explain(error)
            raise

    def _keep_edited(self) -> None:
        """Take over edited specs that earlier builds kept, and a spec.toml that is not as its build wrote it; note what goes."""
        if not (self.target / MANIFEST).is_file():
            return
        self.gone = [
            name
            for name in manifest_files(self.target)
            if not located(self._new / Path(name).name).is_file()
        ]
        texts = {
            path.name: path.read_bytes()
            for path in sorted(self.target.iterdir())
            if _EDITED.fullmatch(path.name)
        }
        spec = self.target / SPEC
        new_spec = self._new / SPEC
        if spec.is_file() and SPEC in changed_files(self.target, {SPEC}):
            text = spec.read_bytes()
            if text not in texts.values() and not (
                new_spec.is_file() and new_spec.read_bytes() == text
            ):
                name = next(name for name in _edited_names() if name not in texts)
                texts[name] = text
                self.kept.append(name)
        for name, text in texts.items():
            (self._new / name).write_bytes(text)

    def _sweep(self) -> None:
        """Remove the staging folders of killed builds, of any name; bring back a result that one of them had moved away."""
        with suppress(OSError):
            for staging in sorted(self.target.parent.iterdir()):
                match = _STAGING.fullmatch(staging.name)
                guard = _abandoned(staging) if match else None
                if match is None or guard is None:
                    continue
                target = staging.with_name(match[1])
                with guard, suppress(OSError):
                    if (staging / "old").is_dir() and not os.path.lexists(target):
                        os.rename(staging / "old", target)
                _remove(staging, target)

    def _discard(self) -> None:
        """Remove what is not part of the result; what cannot be removed is left behind without a word."""
        if hasattr(self, "_staging"):
            if hasattr(self, "_guard"):
                self._guard.close()
            _in_use.discard(self._staging)
            _remove(self._staging, self.target)
        for folder in reversed(self._made):
            try:
                folder.rmdir()
            except OSError:  # someone else uses it by now
                return

    def _refuse_foreign(self) -> None:
        """FileError where the target is something that camgen did not make."""
        if self.target.is_symlink() or (self.target.exists() and not self.target.is_dir()):
            raise FileError(
                self.target,
                "is not a folder, and camgen did not touch it; choose another name or output folder",
            )
        try:
            foreign = next(_foreign(self.target), None)
        except OSError as error:
            self._explain(error)
            raise
        if foreign is not None:
            reason = "was not made by camgen, so camgen did not touch its folder; move the file away or choose another output folder"
            raise FileError(foreign, reason)

    def _explain(self, error: BaseException | None) -> None:
        """Raise the FileError that stands for an OSError: the path where the result was to be, the system's reason."""
        if isinstance(error, OSError):
            path = str(error.filename or self.target)
            if hasattr(self, "_new"):
                path = path.replace(str(self._new), str(self.target))
            file = next((each for each in self.target.parents if each.is_file()), None)
            if file is not None:
                raise FileError(file, "is a file, where the output needs a folder") from error
            raise FileError(path, f"cannot be written: {error.strerror or error}") from error


def _remove(staging: Path, target: Path) -> None:
    """Remove a staging folder, unless it holds the only copy of an earlier result."""
    if os.path.lexists(target) or not (staging / "old").exists():
        shutil.rmtree(staging, ignore_errors=True)


def _exchanged(new: Path, target: Path) -> bool:
    """Whether two folders have changed places in one step; False, and nothing is changed, where the system cannot do that."""
    if sys.platform != "linux":
        return False
    import ctypes

    swap = getattr(ctypes.CDLL(None), "renameat2", None)
    return (
        swap is not None
        and swap(_AT_CWD, os.fsencode(new), _AT_CWD, os.fsencode(target), _EXCHANGE) == 0
    )


def _guarded(staging: Path) -> BinaryIO:
    """A staging folder's lock, held by this process until it is closed, or the process ends in whatever way."""
    _in_use.add(staging)
    guard = open(staging / _LOCK, "w+b")  # noqa: SIM115
    locked(guard, wait=True)
    guard.write(_MARK)  # after the lock: what is not marked yet is not taken for left behind
    guard.flush()
    return guard


def _abandoned(staging: Path) -> BinaryIO | None:
    """The lock, taken over, of a staging folder whose build has been killed; None where it is in use, or not surely camgen's."""
    try:
        names = {path.name for path in staging.iterdir()}
        if (
            staging in _in_use
            or staging.is_symlink()
            or not {_LOCK} <= names <= {_LOCK, "new", "old"}
        ):
            return None
        guard = open(staging / _LOCK, "r+b")  # noqa: SIM115
    except OSError:
        return None
    try:
        if locked(guard, wait=False) and guard.read() == _MARK:
            return guard
    except OSError:
        pass
    guard.close()
    return None


def locked(file: BinaryIO, wait: bool) -> bool:
    """Whether this process holds the lock of an open file now; where the file system knows no locks nobody does."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.lockf(
                file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB)
            )  # not flock, which workers would inherit
    except OSError:
        return False
    return True


def _edited_names() -> Iterator[str]:
    yield f"{SPEC}.edited"
    yield from (f"{SPEC}.edited-{k}" for k in count(2))


def _foreign(folder: Path) -> Iterator[Path]:
    """What is in a folder and not in its manifest; the manifest itself first where it is not camgen's."""
    if not folder.exists():
        return
    manifest: set[Path] = set()
    if (folder / MANIFEST).is_file():
        with suppress(FileError):  # not ours, so it is foreign itself
            manifest = {folder / name for name in manifest_files(folder)} | {folder / MANIFEST}
            manifest |= {
                path for path in folder.iterdir() if _EDITED.fullmatch(path.name) and path.is_file()
            }
    ours = manifest | {parent for path in manifest for parent in path.parents}
    yield from (path for path in sorted(folder.rglob("*")) if path not in ours)


def read_manifest(folder: Path) -> Mapping[str, Any]:
    """What a build wrote down of itself, see `write_manifest`; FileError where that is no manifest of camgen's."""
    path = folder / MANIFEST
    try:
        manifest = json.loads(read_bytes(path, _MANIFEST_SIZE))
        if not (
            isinstance(manifest, dict)
            and "camgen" in manifest
            and isinstance(manifest.get("files"), dict)
        ):
            raise ValueError("it does not list the files of a build")
    except (ValueError, RecursionError) as error:
        raise FileError(path, f"is not a manifest of camgen's: {error}") from None
    return manifest


def manifest_files(folder: Path) -> list[str]:
    """Names of the files that a build listed in its manifest.json; FileError where that is no manifest of camgen's."""
    return list(read_manifest(folder)["files"])


def changed_files(folder: Path, among: Container[str] | None = None) -> list[str]:
    """Names of files (among these) that the manifest lists and that are not as the build wrote them."""
    return [
        name
        for name, entry in read_manifest(folder)["files"].items()
        if among is None or name in among
        if not isinstance(entry, dict) or entry.get("sha256") != _digest(folder / name)
    ]


def _digest(path: Path) -> str:
    """SHA-256 of a file, however large it has become."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def versions(packages: Iterable[str]) -> dict[str, str]:
    """Of packages, distribution names, in their order; one that is not installed is left out."""
    from importlib.metadata import PackageNotFoundError, version

    numbers = {}
    for name in sorted(packages):
        try:
            numbers[name] = version(name)
        except PackageNotFoundError:
            continue
    return numbers


def write_manifest(
    folder: Path, packages: Iterable[str], about: Mapping[str, object] = MappingProxyType({})
) -> None:
    """Write manifest.json: sha256 and bytes of every file in the folder, versions of the packages that made them, and more about
    them. No times: the same files give the same bytes."""
    files = {}
    for path in sorted(
        path for path in folder.rglob("*") if path.is_file() and path != folder / MANIFEST
    ):
        content = path.read_bytes()
        name = path.relative_to(folder).as_posix()
        files[name] = {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    whole = {"camgen": __version__, **about, "files": files, "packages": versions(packages)}
    (folder / MANIFEST).write_text(
        json.dumps(whole, indent=2, ensure_ascii=False) + "\n", encoding="utf-8", newline="\n"
    )
