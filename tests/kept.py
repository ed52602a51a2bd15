"""What is done once in a process of tests: work that gives the same where all that it depends on is the same."""

from __future__ import annotations

import pickle
from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from camgen.files import drawing, dxf, step
from camgen.pipeline import summary
from camgen.pipeline.case import Case


class Kept:
    """The latest results, by keys that say all that they depend on."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._results: OrderedDict[Hashable, tuple[Any, object]] = OrderedDict()

    def once(self, key: Hashable, work: Callable[[], Any], held: object = None) -> Any:
        """What the work gives, done once for a key; held: the objects whose ids are in the key, which live as long."""
        if key not in self._results:
            self._results[key] = work(), held
            while len(self._results) > self._most:
                self._results.popitem(last=False)
        self._results.move_to_end(key)
        return self._results[key][0]

    def forget(self) -> None:
        """Keep nothing of it."""
        self._results.clear()


_DRAWINGS = Kept(200)
_READINGS = Kept(500)
_read_dxf, _read_contours, _read_step = dxf.read_dxf, dxf.read_contours, step.read_step


def draw_part(case: Case, name: str, folder: Path) -> None:
    """As `summary.draw_part`: a part of the same name, shape and facts is drawn once."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drawing, "write_drawing", partial(_write_drawing, drawing.write_drawing))
        summary.draw_part(case, name, folder)


def _write_drawing(write: Callable[..., list[Path]], folder: Path, *facts: object) -> list[Path]:
    def files() -> dict[str, bytes]:
        return {path.name: path.read_bytes() for path in write(folder, *facts)}

    try:
        key = write, pickle.dumps(facts)
    except (pickle.PicklingError, AttributeError, TypeError):  # a law that is a function of a test
        return write(folder, *facts)
    for name, data in _DRAWINGS.once(key, files).items():
        (folder / name).write_bytes(data)
    return [folder / name for name in _DRAWINGS.once(key, files)]


def read_dxf(path: str | Path, engraving: bool = False, any_curves: bool = False) -> dxf.Drawing:
    """As `dxf.read_dxf`: the same bytes are read once."""
    key = "cut", engraving, any_curves, _bytes(path)
    drawn: dxf.Drawing = _READINGS.once(key, lambda: _read_dxf(path, engraving, any_curves))
    return drawn


def read_contours(path: Path) -> tuple[list[Any], list[str]]:
    """As `dxf.read_contours`, likewise."""
    rings, messages = _READINGS.once(("shown", _bytes(path)), lambda: _read_contours(path))
    return [*rings], [*messages]


def read_step(path: Path) -> tuple[dict[str, Any], list[Any], list[str]]:
    """As `step.read_step`, likewise."""
    bodies, copies, remarks = _READINGS.once(("exact", _bytes(path)), lambda: _read_step(path))
    return {**bodies}, [*copies], [*remarks]


def _bytes(path: str | Path) -> bytes | None:
    return Path(path).read_bytes() if Path(path).is_file() else None
