"""What a stage is told to work on: one mechanism in one folder; and how many cores that is worth."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

from camgen import spec as specs
from camgen.files.formats import FORMATS
from camgen.files.shelves import listed, located, shelved
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import read_mechanism
from camgen.parts.part import Part
from camgen.study import Study
from camgen.workers import all_cores, core_count

_FEW = 3  # parts that are made sooner than other processes have begun
_MOST = 4  # cores that one machine's parts and the sweep of them keep busy


@dataclass(frozen=True)
class Case:
    """A mechanism and the folder of its files, `spec.toml` among them; another process reads it anew from there."""

    mechanism: Mechanism
    folder: Path

    @cached_property
    def parts(self) -> dict[str, Part]:
        """The mechanism's parts by name."""
        return {part.name: part for part in self.mechanism.assembly.parts}

    @cached_property
    def key(self) -> str:
        """What the identifiers inside 3MF files are made from."""
        return hashlib.sha256(specs.dump(self.mechanism).encode()).hexdigest()

    @cached_property
    def study(self) -> Study:
        """What the report shows of the mechanism."""
        return self.mechanism.study()

    def file(self, part: str, ending: str) -> Path:
        """Path of a part's file, on its shelf where it is on one."""
        return located(self.folder / f"{self.mechanism.name}-{part}.{ending}")

    def files(self, pattern: str) -> list[Path]:
        """Files by a pattern of their names behind the mechanism's."""
        return listed(self.folder, f"{self.mechanism.name}-{pattern}")

    def place(self, path: Path) -> str:
        """A file of the folder as the manifest names it."""
        return path.relative_to(self.folder).as_posix()

    @property
    def places(self) -> dict[str, str]:
        """Files on shelves by their names, each as the manifest has it."""
        return {path.name: self.place(path) for path in shelved(self.folder)}

    def __reduce__(self) -> tuple[Callable[[Path], Case], tuple[Path]]:
        return _reopened, (self.folder,)


@lru_cache(maxsize=1)
def _reopened(folder: Path) -> Case:
    return Case(read_mechanism(folder / "spec.toml"), folder)


def cores(jobs: int | None, mechanism: Mechanism, kinds: Collection[str]) -> int:
    """How many to use: as many as somebody says, 0: all, else one unless there are several solids, which two make in less time.

    SpecError where what is said is no such number.
    """
    if jobs is not None:
        return core_count(jobs)
    several = len(mechanism.assembly.parts) > _FEW and any(
        kind in FORMATS and FORMATS[kind].solid for kind in kinds
    )
    return min(all_cores(), _MOST) if several else 1
