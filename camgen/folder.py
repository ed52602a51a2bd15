"""The output folder: it appears whole or not at all, replaces only what camgen made, and says what is in it."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from types import TracebackType

from camgen import __version__
from camgen.errors import FileError

MANIFEST = "manifest.json"


class Staged:
    """`with Staged(target) as folder:` gives a fresh folder beside the target; it takes the target's place at the end.

    An earlier result stays as it is until the block has succeeded, and after any exception or Ctrl-C. FileError where
    the target holds anything that its manifest does not list, where it is no folder, and for any OSError in the block.
    """

    def __init__(self, target: Path) -> None:
        self.target = Path(target)
        self._made: list[Path] = []  # parents that did not exist, outermost first

    def __enter__(self) -> Path:
        self._refuse_foreign()
        parent = self.target.parent
        try:
            missing = [folder for folder in (parent, *parent.parents) if not folder.exists()]
            for folder in reversed(missing):
                folder.mkdir()
                self._made.append(folder)
            self._staging = Path(tempfile.mkdtemp(prefix=f".{self.target.name}-", dir=parent))
            self._new = self._staging / "new"
            self._new.mkdir()  # unlike mkdtemp's folder, as open to others as the user's umask says
        except BaseException as error:
            self._discard()
            self._explain(error)
            raise
        return self._new

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        try:
            if error is None:
                self._replace()
            self._explain(error)
        finally:
            self._discard()

    def _replace(self) -> None:
        self._refuse_foreign()  # once more: the work took a while
        old = self._staging / "old"
        try:
            if self.target.exists():
                os.rename(self.target, old)
            os.rename(self._new, self.target)
            self._made.clear()
        except BaseException as error:
            if old.exists() and not self.target.exists():
                os.rename(old, self.target)
            self._explain(error)
            raise

    def _discard(self) -> None:
        """Remove what is not part of the result; what cannot be removed is left behind without a word."""
        if hasattr(self, "_staging"):
            shutil.rmtree(self._staging, ignore_errors=True)
        for folder in reversed(self._made):
            try:
                folder.rmdir()
            except OSError:  # someone else uses it by now
                return

    def _refuse_foreign(self) -> None:
        """FileError where the target is something that camgen did not make."""
        if self.target.is_symlink() or (self.target.exists() and not self.target.is_dir()):
            raise FileError(self.target, "is not a folder; it is left alone, choose another name or output folder")
        try:
            foreign = next(_foreign(self.target), None)
        except OSError as error:
            self._explain(error)
            raise
        if foreign is not None:
            reason = "was not made by camgen, so its folder is left alone; move it away or choose another output folder"
            raise FileError(foreign, reason)

    def _explain(self, error: BaseException | None) -> None:
        """Raise the FileError that stands for an OSError: the path where the result was to be, the system's reason."""
        if isinstance(error, OSError):
            path = str(error.filename or self.target)
            if hasattr(self, "_new"):
                path = path.replace(str(self._new), str(self.target))
            raise FileError(path, f"cannot be written: {error.strerror or error}") from error


def _foreign(folder: Path) -> Iterator[Path]:
    """What is in a folder and not in its manifest; the manifest itself first where it is not camgen's."""
    if not folder.exists():
        return
    listed: set[Path] = set()
    if (folder / MANIFEST).is_file():
        with suppress(FileError):  # not ours, so it is foreign itself
            listed = {folder / name for name in manifest_files(folder)} | {folder / MANIFEST}
    ours = listed | {parent for path in listed for parent in path.parents}
    yield from (path for path in sorted(folder.rglob("*")) if path not in ours)


def manifest_files(folder: Path) -> list[str]:
    """Names of the files that a build listed in its manifest.json; FileError where that is no manifest of camgen's."""
    path = folder / MANIFEST
    try:
        found = json.loads(path.read_bytes())
        if not (isinstance(found, dict) and "camgen" in found and isinstance(found.get("files"), dict)):
            raise ValueError("it does not list the files of a build")
        return list(found["files"])
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise FileError(path, f"is not a manifest of camgen's: {error}") from None


def changed_files(folder: Path) -> list[str]:
    """Names of files that the manifest lists and that are not as the build wrote them."""
    files = json.loads((folder / MANIFEST).read_bytes())["files"]
    return [name for name, entry in files.items()
            if not isinstance(entry, dict) or entry.get("sha256") != hashlib.sha256((folder / name).read_bytes()).hexdigest()]


def write_manifest(folder: Path, packages: Iterable[str]) -> None:
    """Write manifest.json: sha256 and bytes of every file in the folder, versions of the packages that made them.

    packages: distribution names; one that is not installed is left out. No times: the same files give the same bytes.
    """
    from importlib.metadata import PackageNotFoundError, version

    files = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file() and path != folder / MANIFEST):
        content = path.read_bytes()
        name = path.relative_to(folder).as_posix()
        files[name] = {"bytes": len(content), "sha256": hashlib.sha256(content).hexdigest()}
    versions = {}
    for name in sorted(packages):
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            continue
    text = json.dumps({"camgen": __version__, "files": files, "packages": versions}, indent=2, ensure_ascii=False)
    (folder / MANIFEST).write_text(text + "\n", encoding="utf-8")
