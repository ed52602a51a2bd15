"""Segments of a spec: programs that join, and every fault with its path, value and what would be right."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgen.cli import main
from camgen.errors import FileError, SpecError
from camgen.guide import laws
from camgen.machines.spec_files import with_tables
from camgen.motion.laws import LAWS, modified_sine
from camgen.motion.segments import (
    ABOUT,
    FAMILIES,
    SHOWN,
    LawChoice,
    SegmentTable,
    WholeTurn,
    law_of,
    program,
    program_faults,
)
from camgen.motion.tables import read_points
from camgen.spec import Spec, dump, validate


class Sample(Spec):
    segment: Annotated[tuple[SegmentTable, ...], WholeTurn]

    def faults(self) -> Any:
        return program_faults(self.segment)


def spec(text: str, folder: Path = Path(".")) -> Sample:
    data = {"mechanism": "sample", "name": "sample", **tomllib.loads(text)}
    return validate(Sample, with_tables(data, folder))


def segments(*rows: str) -> str:
    return "\n".join(f"[[segment]]\n{row}" for row in rows)


def faults(*rows: str, folder: Path = Path(".")) -> list[tuple[str, str]]:
    with pytest.raises(SpecError) as error:
        spec(segments(*rows), folder)
    return [(f.key, f"{f.value} | {f.expected} | {f.nearest}") for f in error.value.faults]


RISE = 'kind = "rise"\nspan_deg = 90\nlift = 10\nlaw = "3-4-5"'
DWELL = 'kind = "dwell"\nspan_deg = 90'
BACK = 'kind = "return"\nspan_deg = 180\nto = 0\nlaw = "cycloidal"'


def test_a_program_from_a_spec() -> None:
    made = program(spec(segments(RISE, DWELL, BACK)).segment)
    theta = np.radians([0, 45, 90, 135, 180, 270])
    np.testing.assert_allclose(made(theta), [0, 5, 10, 10, 10, 5], atol=1e-13)
    assert [s.kind for s in made.segments] == ["rise", "dwell", "return"]
    assert made.discontinuities() == []
    turned = program(spec(segments(RISE, DWELL, BACK)).segment, math.radians(1))
    np.testing.assert_allclose(turned(theta), np.radians([0, 5, 10, 10, 10, 5]), atol=1e-14)


def test_a_spec_survives_writing() -> None:
    table = 'kind = "rise"\nspan_deg = 90\nlift = 10\nlaw = { name = "modified-sine", constant_velocity = 0.2 }'
    one = spec(segments(table, DWELL, BACK))
    again = validate(Sample, tomllib.loads(dump(one)))
    assert again == one
    assert program(one.segment).segments[0].law.c_a == modified_sine(0.2).c_a


def test_laws_by_name() -> None:
    for name, law in LAWS.items():
        assert law_of(name) is law
    law = 'law = { name = "fourier", sines = [6.283185307179586] }'
    first = spec(segments(RISE.replace('law = "3-4-5"', law), DWELL, BACK)).segment[0].law
    assert first is not None
    u = np.linspace(0, 1, 99)
    np.testing.assert_allclose(law_of(first)(u), LAWS["cycloidal"](u), atol=1e-15)
    law = 'law = { name = "polynomial", conditions = [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 0]] }'
    first = spec(segments(RISE.replace('law = "3-4-5"', law), DWELL, BACK)).segment[0].law
    assert first is not None
    np.testing.assert_allclose(law_of(first)(u), LAWS["cubic"](u), atol=1e-15)


def matched_row(kind: str, span: float, to: float) -> str:
    return f'kind = "{kind}"\nspan_deg = {span}\nto = {to}\nlaw = "matched"'


def test_matched_segments_take_speed_and_acceleration_from_their_neighbours() -> None:
    uniform = 'kind = "rise"\nspan_deg = 60\nto = 8\nlaw = "uniform"'
    made = program(
        spec(
            segments(
                matched_row("rise", 40, 2),
                uniform,
                matched_row("rise", 40, 10),
                DWELL,
                matched_row("return", 65, 5),
                matched_row("return", 65, 0),
            )
        ).segment
    )
    assert made.discontinuities() == []
    assert float(made(math.radians(40), 1)) == pytest.approx(6 / math.radians(60))
    # across the turn's end: the run of matched segments is one run
    made = program(
        spec(
            segments(
                matched_row("rise", 40, 2),
                uniform,
                matched_row("rise", 40, 10),
                matched_row("return", 220, 0),
            )
        ).segment
    )
    assert made.discontinuities(3)[0].theta == pytest.approx(math.radians(40))
    assert made.discontinuities() == [] and abs(float(made(0.0, 1))) < 1e-12
    whole = program(
        spec(segments(matched_row("rise", 150, 10), matched_row("return", 210, 0))).segment
    )
    assert whole.discontinuities(3) == []


def test_a_dwell_without_a_span_takes_the_rest() -> None:
    free = DWELL.replace("span_deg = 90", "")
    whole = spec(segments(RISE, DWELL, BACK))
    assert spec(segments(RISE, free, BACK)) == whole, "the record has the value"
    assert dump(spec(segments(RISE, free, BACK))) == dump(whole), "and so has the resolved spec"
    wider = spec(segments(RISE.replace("90", "110.3"), free, BACK)).segment
    assert wider[1].span_deg == 69.7
    assert program(wider).joints[-1] == pytest.approx(math.tau, abs=1e-12)


# ---- faults ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "rows, path, says",
    [
        (
            (RISE, BACK),
            "segment",
            "270 deg | span_deg of all segments to add up to 360 (90 deg too little)",
        ),
        (
            (RISE.replace("span_deg = 90", ""), DWELL, BACK),
            "segment.0.span_deg",
            "missing: only one dwell may leave it out",
        ),
        (
            (RISE, DWELL.replace("span_deg = 90", ""), DWELL.replace("span_deg = 90", ""), BACK),
            "segment.2.span_deg",
            "missing: only one dwell may leave it out",
        ),
        (
            (RISE.replace("90", "180"), DWELL.replace("span_deg = 90", ""), BACK),
            "segment.1.span_deg",
            "nothing is left of the turn: the other spans add up to 360 deg",
        ),
        (
            (RISE, DWELL, DWELL, BACK),
            "segment",
            "450 deg | span_deg of all segments to add up to 360 (90 deg too much)",
        ),
        (
            (
                RISE.replace("90", "1.57"),
                DWELL.replace("90", "1.571"),
                BACK.replace("180", "3.142"),
            ),
            "segment",
            "6.283 deg | degrees that add up to 360: these add up to a turn in rad",
        ),
        (
            (RISE, DWELL, BACK.replace("to = 0", "lift = 8")),
            "segment.2",
            "ends at 2 | a last segment that ends at 0",
        ),
        (
            (RISE, DWELL, BACK.replace("to = 0", "to = 12")),
            "segment.2.to",
            "12 | less than 10, where it begins",
        ),
        (
            (RISE.replace("lift = 10", "to = 0"), DWELL, BACK),
            "segment.0.to",
            "0 | more than 0, where it begins",
        ),
        (
            (RISE, DWELL + "\nto = 9", BACK),
            "segment.1.to",
            "9 | 10, where the segment before ends, or leave it out",
        ),
        (
            (RISE, DWELL + "\nlift = 1", BACK),
            "segment.1.lift",
            "no value here: a dwell stays where it is",
        ),
        (
            (RISE, DWELL + '\nlaw = "uniform"', BACK),
            "segment.1.law",
            "no value here: a dwell stays where it is",
        ),
        ((RISE + "\nto = 10", DWELL, BACK), "segment.0.lift", "10 | either lift or to"),
        ((RISE.replace("lift = 10\n", ""), DWELL, BACK), "segment.0.lift", "either lift or to"),
        (
            (RISE, DWELL, BACK.replace("to = 0\n", "")),
            "segment.2.lift",
            "either lift or to; to = 0 goes back to where the turn begins",
        ),
        (
            (RISE.replace('kind = "rise"\n', ""), DWELL, BACK),
            "segment.0.kind",
            'or where it ends; "rise" goes up by 10, "return" down',
        ),
        ((RISE.replace("3-4-5", "cycloidl"), DWELL, BACK), "segment.0.law", "| cycloidal"),
        (
            (
                RISE.replace('"3-4-5"', '{ name = "modified-sin", constant_velocity = 0.1 }'),
                DWELL,
                BACK,
            ),
            "segment.0.law.name",
            "| modified-sine",
        ),
        (
            (RISE.replace('"3-4-5"', "3"), DWELL, BACK),
            "segment.0.law",
            "3 | text or a table with name, ",
        ),
        (
            (RISE.replace('"3-4-5"', '{ nam = "x", name = "cubic" }'), DWELL, BACK),
            "segment.0.law.nam",
            "unknown key",
        ),
        (
            (RISE.replace('"3-4-5"', '{ name = "matched", sines = [1] }'), DWELL, BACK),
            "segment.0.law.sines",
            "no parameters",
        ),
        (
            (RISE.replace('"3-4-5"', '{ name = "table", points = [] }'), DWELL, BACK),
            "segment.0.law.points",
            "0 rows | at least 4 rows",
        ),
        (
            (
                RISE.replace('"3-4-5"', '{ name = "table", points = [], source = "a.csv" }'),
                DWELL,
                BACK,
            ),
            "segment.0.law.points",
            "0 rows in a.csv | at least 4 rows",
        ),
        (
            (RISE.replace('"3-4-5"', '{ name = "fourier", sines = ["a"] }'), DWELL, BACK),
            "segment.0.law.sines.0",
            "a number",
        ),
        (
            (RISE.replace('"3-4-5"', '{ name = "cubic", sines = [1] }'), DWELL, BACK),
            "segment.0.law.sines",
            "no value here: 'cubic' takes lambda",
        ),
        (
            (RISE.replace('"3-4-5"', '"fourier"'), DWELL, BACK),
            "segment.0.law.sines",
            "needs sines or cosines",
        ),
        (
            (RISE.replace('"3-4-5"', '{ name = "fourier", sines = [6] }'), DWELL, BACK),
            "segment.0.law.sines",
            "coefficients that close",
        ),
        (
            (RISE.replace('"3-4-5"', '{ name = "table" }'), DWELL, BACK),
            "segment.0.law.points",
            "needs points or file",
        ),
        (
            (
                RISE.replace(
                    '"3-4-5"', '{ name = "polynomial", conditions = [[0, 0, 0], [1, 0, 2]] }'
                ),
                DWELL,
                BACK,
            ),
            "segment.0.law.conditions",
            "runs from 0 to 2 | a law that runs from 0 to 1",
        ),
        (
            (
                RISE.replace('"3-4-5"', '{ name = "modified-sine", constant_velocity = 1 }'),
                DWELL,
                BACK,
            ),
            "segment.0.law.constant_velocity",
            "1 | a share >= 0 and < 1",
        ),
        (
            (
                RISE.replace(
                    '"3-4-5"', '{ name = "table", points = [[0, 0], [1, 2], [2, 1], [3, 4]] }'
                ),
                DWELL,
                BACK,
            ),
            "segment.0.law.points.2",
            "1 | a table that rises all the way, after 2",
        ),
        (
            (
                RISE.replace(
                    '"3-4-5"', '{ name = "table", points = [[0, 4], [1, 2], [2, 3], [3, 0]] }'
                ),
                DWELL,
                BACK,
            ),
            "segment.0.law.points.2",
            "3 | a table that falls all the way, after 2",
        ),
        (
            (
                RISE.replace(
                    '"3-4-5"', '{ name = "table", points = [[0, 0], [1, 0], [1.1, 1], [2, 1]] }'
                ),
                DWELL,
                BACK,
            ),
            "segment.0.law",
            "runs backwards",
        ),
        (
            (
                RISE.replace('"3-4-5"', '{ name = "fourier", sines = [14, -15.43362938564083] }'),
                DWELL,
                BACK,
            ),
            "segment.0.law",
            "a law that only goes one way in a rise",
        ),
        (
            (RISE.replace("lift = 10", "lift = -1"), DWELL, BACK),
            "segment.0.lift",
            "-1 | a number above 0",
        ),
        (
            (RISE.replace("span_deg = 90", "span_deg = 0"), DWELL, BACK),
            "segment.0.span_deg",
            "0 | a number >= 0.001 and <= 360",
        ),
        (
            (RISE.replace("span_deg = 90", "span_deg = nan"), DWELL, BACK),
            "segment.0.span_deg",
            "nan",
        ),
        (
            (RISE.replace("rise", "raise"), DWELL, BACK),
            "segment.0.kind",
            "'rise', 'dwell', 'return'",
        ),
    ],
)
def test_one_fault(rows: tuple[str, ...], path: str, says: str) -> None:
    found = faults(*rows)
    assert [p for p, _ in found] == [path], found
    assert says in found[0][1], found


def test_all_faults_at_once() -> None:
    back = BACK.replace("to = 0", "lift = 3").replace("180", "200")
    found = faults(RISE.replace("3-4-5", "cycloidl"), DWELL + "\nlift = 2", back)
    assert [path for path, _ in found] == [
        "segment.1.lift",
        "segment.0.law",
        "segment",
        "segment.2",
    ]


def test_no_segments() -> None:
    with pytest.raises(SpecError, match="the spans add up to 0 deg"):
        program(())


def test_every_family_can_be_named() -> None:
    for name in FAMILIES:
        try:
            law_of(name)
        except SpecError as error:
            assert "needs" in str(error) or "one that" in str(error)


@given(st.lists(st.floats(0.5, 10), min_size=2, max_size=12), st.sampled_from(sorted(LAWS)))
def test_spans_of_any_size_that_fill_the_turn_are_accepted(shares: list[float], law: str) -> None:
    spans = [360 * share / sum(shares) for share in shares]
    count = len(spans) - len(spans) % 2
    kinds, named = ("rise", "return"), LawChoice(name=law)
    tables = [
        SegmentTable(kind=kinds[k % 2], span_deg=spans[k], lift=0.1, law=named)
        for k in range(count)
    ]  # type: ignore[arg-type]
    if count < len(spans):
        tables.append(SegmentTable(kind="dwell", span_deg=spans[-1]))
    made = program(tables)
    assert made.joints[-1] == pytest.approx(2 * math.pi, abs=1e-12)
    assert not [jump for jump in made.discontinuities(0)]


# ---- files -----------------------------------------------------------------------------------------------------------

U = np.linspace(0, 1, 41)


@pytest.mark.parametrize(
    "form", ["{0},{1}\n", "{0} {1}\n", "{0}\t{1}\n", "{0}; {1}; note\n", " {0} , {1}\r\n", "comma"]
)
def test_a_table_from_a_file(form: str, tmp_path: Path) -> None:
    rows = [
        (f"{100 + 60 * u:.12g}", f"{25 * s:.12g}") for u, s in zip(U, LAWS["3-4-5"](U), strict=True)
    ]
    if form == "comma":
        text = "".join(f"{x};{y}\n".replace(".", ",") for x, y in rows)
    else:
        text = "".join(form.format(x, y) for x, y in rows)
    (tmp_path / "rise.csv").write_text("# measured\nangle;lift\n\n" + text, newline="")
    table = RISE.replace('"3-4-5"', '{ name = "table", file = "rise.csv" }')
    one = spec(segments(table, DWELL, BACK), tmp_path)
    law = program(one.segment).segments[0].law
    assert law.source == "rise.csv" and len(law.breaks) == 39
    u = np.linspace(0, 1, 997)
    np.testing.assert_allclose(law(u), LAWS["3-4-5"](u), atol=4e-6)
    again = validate(Sample, tomllib.loads(dump(one)))  # needs the file no more
    assert program(again.segment).segments[0].law.source == "rise.csv"
    np.testing.assert_array_equal(program(again.segment)(u), program(one.segment)(u))


def test_a_file_named_to_the_library_is_seen_from_where_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "t.csv").write_text("0 0\n1 1\n2 3\n3 4\n")
    monkeypatch.chdir(tmp_path)
    tables = tomllib.loads(segments(RISE.replace('"3-4-5"', '{ name = "table", file = "t.csv" }')))[
        "segment"
    ]
    law = SegmentTable.model_validate(tables[0]).law
    assert law is not None and law_of(law).c_v > 1


@pytest.mark.parametrize(
    "content, error, says",
    [
        (b"", SpecError, "rows of two numbers"),
        (b"angle,lift\n", SpecError, "rows of two numbers"),
        (b"0,0\n1,1\n2,x\n3\n4,4\n5,nan\n", SpecError, "line 3"),
        (b"\xff\xfe\x00", FileError, "is not text"),
        (None, FileError, "cannot be read: No such file"),
    ],
)
def test_files_that_hold_no_table(
    content: bytes | None, error: type[Exception], says: str, tmp_path: Path
) -> None:
    path = tmp_path / "t.csv"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(error, match=says) as caught:
        read_points(path)
    if says == "line 3":
        assert [f.key for f in caught.value.faults] == [f"t.csv line {k}" for k in (3, 4, 6)]  # type: ignore[attr-defined]


def test_data_that_is_no_table_is_left_for_validation() -> None:
    for value in (3, "x", [1, 2], {"a": 1}, [{"law": 3}], [{"law": {"file": 3}}]):
        assert with_tables({"segment": value}, Path(".")) == {"segment": value}
    assert with_tables({}, Path(".")) == {}


def test_the_list_names_every_law(capsys: pytest.CaptureFixture[str]) -> None:
    """With peaks where they have them, and the keys of those that take parameters."""
    with pytest.raises(SystemExit):
        main(["list"])
    told = capsys.readouterr().out
    rows = {
        line.split()[0]: line
        for line in told[told.index("Laws of motion") :].splitlines()
        if line.startswith("  ")
    }
    assert {*LAWS, *ABOUT} == set(rows) and set(FAMILIES) < set(ABOUT)
    assert all(f"{law.c_a:.4f}" in told and f"{law.c_m:.4f}" in told for _, law in SHOWN)
    assert set(rows) == set(laws()), "each is explained"
    assert all(key in told for keys in FAMILIES.values() for key in keys)
