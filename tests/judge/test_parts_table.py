"""The judge of a parts list: rows as a buyer reads them, each cell damaged by itself."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from camgen.errors import FileError
from camgen.judge.parts_table import judge_list
from camgen.study import Table

HEAD = ("no", "part", "made", "count", "mass_g")
ROWS = (
    (1, "cam", "printed", 1, 12.34),
    (2, "dowel 5 x 20", "bought", 4, 3.081),
    (3, "plate", "cut", 2, 0.0),
)
TABLE = Table("Parts", HEAD, ROWS)


def judged(path: Path, rows: list[list[str]]):  # type: ignore[no-untyped-def]
    with open(path, "w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(rows)
    return judge_list(path, TABLE)


@pytest.fixture
def rows() -> list[list[str]]:
    """As they are written: numbers to three digits."""
    return [
        list(HEAD),
        ["1", "cam", "printed", "1", "12.3"],
        ["2", "dowel 5 x 20", "bought", "4", "3.08"],
        ["3", "plate", "cut", "2", "0"],
    ]


def test_rows_as_they_are_written_hold(tmp_path: Path, rows: list[list[str]]) -> None:
    found = judged(tmp_path / "parts.csv", rows)
    assert found.ok and (found.code, found.measured, str(found.where)) == (
        "PARTS_LIST",
        0,
        "parts.csv",
    )
    assert found.message.startswith("3 rows")


@pytest.mark.parametrize("line", range(4))
@pytest.mark.parametrize("column", range(5))
@pytest.mark.parametrize("cell", ["", "x", "7.5", "nan"])
def test_each_cell_is_read(
    tmp_path: Path, rows: list[list[str]], line: int, column: int, cell: str
) -> None:
    rows[line][column] = cell
    found = judged(tmp_path / "parts.csv", rows)
    assert not found.ok and found.measured == 1
    name = f"{HEAD[column]} " if line else ""
    wanted = ["0" if cell == 0.0 else str(cell) for cell in (HEAD, *ROWS)[line]][column]
    assert found.message == f"line {line + 1} has {name}{cell or 'nothing'} instead of {wanted}"


def test_all_cells_that_differ_are_named_by_their_columns(
    tmp_path: Path, rows: list[list[str]]
) -> None:
    rows[2][3:] = ["5", "3.2"]
    found = judged(tmp_path / "parts.csv", rows)
    assert found.message == "line 3 has count 5 instead of 4; mass_g 3.2 instead of 3.081"


@pytest.mark.parametrize(
    "mass, ok",
    [("12.34", True), ("12.4", True), ("12.28", True), ("12.41", False), ("12.27", False)],
)
def test_a_number_may_be_off_by_its_fourth_digit(
    tmp_path: Path, rows: list[list[str]], mass: str, ok: bool
) -> None:
    """12.34 by no more than 0.0617, the half of what three digits tell at worst."""
    rows[1][4] = mass
    assert judged(tmp_path / "parts.csv", rows).ok is ok


def test_rows_lost_doubled_or_longer_are_told(tmp_path: Path, rows: list[list[str]]) -> None:
    path = tmp_path / "parts.csv"
    assert judged(path, rows[:3]).message == "line 4 has nothing instead of plate, cut, 2"
    more = judged(path, [*rows, rows[3]])
    assert more.measured == 1 and more.message == "line 5 has plate, cut, 2 instead of nothing"
    assert judged(path, [rows[0], *rows[2:]]).measured == 3
    longer = judged(path, [rows[0], [*rows[1], "5"], *rows[2:]])
    assert longer.measured == 1 and longer.message == "line 2 has 6 cells instead of 5"
    assert judged(path, []).measured == 4


@pytest.mark.parametrize("data", [b"\xff\xfe", b'no,"part\n'])
def test_what_is_no_table_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "parts.csv").write_bytes(data)
    with pytest.raises(FileError, match="cannot be read as a parts list"):
        judge_list(tmp_path / "parts.csv", TABLE)
    with pytest.raises(FileError, match="No such file"):
        judge_list(tmp_path / "none.csv", TABLE)
