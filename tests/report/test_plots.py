"""Plots show what the data say: ticks, curves that coincide once, bands that hold what oscillates, shapes at one scale."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from matplotlib.font_manager import findfont
from PIL import ImageFont

from camgen.findings import Where, at_least
from camgen.report.colours import part_colour
from camgen.report.plots import plot_figure, simplification, ticks
from camgen.report.tables import _cell, value_text
from camgen.report.words import rounded, rows
from camgen.study import Figure, Figures, Plot

THETA = np.linspace(0, 360, 1441)


def drawn(text: str) -> list[np.ndarray]:
    """Points (n,) complex of each curve or band of a plot, in numbers of its axes."""
    scale = re.search(r'data-axes="([^"]*)"', text)
    assert scale
    left, right, x0, x1, low, top, y0, y1 = map(float, scale[1].split())
    found = []
    for path in re.findall(
        r'class="(?:curve|band)"[^>]* d="M([-\d. LM]*)Z?"', text[text.index("data-axes") :]
    ):
        at = np.array([[float(n) for n in pair.split()] for pair in re.split("[LM]", path)])
        x = x0 + (at[:, 0] - left) / (right - left) * (x1 - x0)
        found.append(x + 1j * (y0 + (low - at[:, 1]) / (low - top) * (y1 - y0)))
    return found


def test_a_turn_has_its_ticks_a_cursor_and_a_name_for_all() -> None:
    text = plot_figure(
        Plot(
            "Swing <wanted>",
            "cam angle, deg",
            "$deg$",
            [("a & <b>", THETA, np.sin(THETA))],
            [("reversal", 60.0)],
        )
    )
    root = ElementTree.fromstring(text)
    texts = ["".join(each.itertext()) for each in root.iter("text")]
    assert [t for t in texts if t.isdigit()][:9] == [str(tick) for tick in range(0, 361, 45)]
    assert {"reversal", "cam angle, deg", "$deg$"} <= set(texts)
    assert root.find(".//path[@class='cursor']") is not None and root.attrib["class"] == "plot turn"
    assert "a & <b>" in "".join(root.find(".//ul").itertext())  # type: ignore[union-attr]
    assert "cursor" not in plot_figure(Plot("t", "place, mm", "mm", [("a", THETA / 9, THETA)]))


@pytest.mark.parametrize(
    "wave",
    [np.sin(np.radians(THETA)), np.where(THETA < 180, THETA, 360 - THETA), np.exp(THETA / 90)],
)
def test_a_drawn_curve_is_the_curve(wave: np.ndarray) -> None:
    (line,) = drawn(plot_figure(Plot("t", "x", "y", [("a", THETA, wave)])))
    assert len(line) < 500
    np.testing.assert_allclose(
        np.interp(THETA, line.real, line.imag), wave, atol=2e-3 * np.ptp(wave)
    )


def test_curves_that_coincide_are_drawn_once_under_all_names() -> None:
    wave = np.sin(np.radians(THETA))
    series = [
        ("wanted", THETA, wave),
        ("from DXF", THETA, wave + 1e-4),
        ("from STL", THETA, wave + 0.1),
    ]
    sources = {"wanted": ("", "wanted"), "from DXF": ("", "DXF"), "from STL": ("", "STL")}
    text = plot_figure(Plot("t", "x", "y", series, sources=sources))
    assert len(drawn(text)) == 2 and "wanted = DXF" in text and "from STL" in text
    pair = [
        ("x from DXF", THETA, wave * 0),
        ("y from DXF", THETA, wave * 0),
        ("x from STL", THETA, wave),
    ]
    sources = {f"{axis} from DXF": (axis, "DXF") for axis in "xy"}
    assert "x DXF = y DXF" in plot_figure(Plot("t", "x", "y", pair, sources=sources))
    assert "x from DXF = y from DXF" in plot_figure(Plot("t", "x", "y", pair))
    gaps = [("a", THETA, wave), ("b", THETA, np.where(THETA > 90, wave, np.nan))]
    assert len(re.findall("<li", plot_figure(Plot("t", "x", "y", gaps)))) == 2


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 1.0))
@settings(max_examples=30, deadline=None)
def test_what_oscillates_is_a_band_that_holds_it_and_is_no_wider(seed: int, size: float) -> None:
    noise = size * np.random.default_rng(seed).uniform(-1, 1, len(THETA)) + np.sin(
        np.radians(THETA)
    )
    text = plot_figure(Plot("t", "x", "y", [("a", THETA, noise)]))
    upper = re.search(r'class="band" data-upper="(\d+)"', text)
    if upper is None:  # too fine to be seen against the rest
        assert size < 0.1
        return
    (ring,) = drawn(text)
    top, bottom = ring[: int(upper[1])], ring[int(upper[1]) :][::-1]
    slack = 2e-3 * (2 + 2 * size)
    assert np.all(np.interp(THETA, top.real, top.imag) >= noise - slack)
    assert np.all(np.interp(THETA, bottom.real, bottom.imag) <= noise + slack)
    assert ring.imag.max() <= noise.max() + slack and ring.imag.min() >= noise.min() - slack


@pytest.mark.parametrize("places, fills", [(True, True), (False, False)])
def test_a_motion_far_from_zero_fills_its_plot_and_an_amount_is_seen_as_a_share_of_itself(
    places: bool, fills: bool
) -> None:
    angle = 263 - 10 * np.cos(np.radians(THETA))
    text = plot_figure(
        Plot("Wing", "cam angle, deg", "deg", [("wanted", THETA, angle)], places=places)
    )
    *_, low, high = map(float, re.search(r'data-axes="([^"]*)"', text)[1].split())  # type: ignore[index]
    assert (253 - 5 < low < 253 and 273 < high < 273 + 5) == fills
    assert (low < 0) == (not fills)


def test_a_path_is_drawn_at_one_scale_and_its_points_as_dots() -> None:
    turn = np.exp(1j * np.radians(THETA)) * 10
    plot = Plot(
        "Path",
        "x, mm",
        "y, mm",
        [("path", turn.real, turn.imag), ("every", turn.real[::60], turn.imag[::60])],
        (),
        True,
    )
    text = plot_figure(plot)
    left, right, x0, x1, low, top, y0, y1 = map(
        float, re.findall(r'data-axes="([^"]*)"', text)[0].split()
    )
    assert (right - left) / (x1 - x0) == pytest.approx((low - top) / (y1 - y0), rel=1e-6)
    assert "<circle" not in text
    dotted = plot_figure(Plot("Path", "x, mm", "y, mm", plot.series, (), True, ("every",)))
    assert dotted.count("<circle") == len(turn[::60]) and len(drawn(dotted)) == 1


def test_plots_of_nothing_known_and_of_nothing() -> None:
    gap = np.full(10, math.nan)
    for y in (gap, gap * 0 + np.inf, np.zeros(10)):
        assert "nan" not in plot_figure(Plot("t", "x", "y", [("a", np.arange(10.0), y)]))
    assert "<svg" in plot_figure(Plot("t", "x", "y", []))


@example(65536.78125, 0.00390625)
@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
def test_ticks_are_round_and_within(low: float, size: float) -> None:
    found = ticks(low, low + size)
    if size < 1e-9 * abs(low):
        return
    assert 1 <= len(found) <= 7 and all(
        low - 1e-6 * size <= t <= low + size * (1 + 1e-6) for t in found
    )
    if len(found) > 1:
        step = found[1] - found[0]
        rounding = 1e-5  # of the step: either tick is rounded to 1e-16 of its size, which is up to 1e10 steps
        mantissa = step / 10 ** math.floor(math.log10(step) + rounding)
        assert min(abs(mantissa / each - 1) for each in (1, 2, 2.5, 5)) < rounding
    assert ticks(1.0, 1.0) == [] and ticks(math.nan, 1.0) == []


@given(st.lists(st.floats(-100, 100), min_size=2, max_size=60), st.floats(0.01, 5))
def test_no_point_is_farther_than_the_tolerance_from_the_simplified_line(
    heights: list[float], tolerance: float
) -> None:
    z = np.arange(len(heights)) + 1j * np.array(heights)
    few = simplification(z, tolerance)
    assert few[0] == z[0] and few[-1] == z[-1]
    kept = few.real.astype(int)
    for a, b in zip(kept[:-1], kept[1:], strict=True):
        chord = z[b] - z[a]
        if b - a > 1:
            assert np.all(
                np.abs((np.conj(chord) * (z[a:b] - z[a])).imag) <= tolerance * abs(chord) * 1.001
            )


def test_parts_have_colours_of_their_own_neighbours_ones_far_apart() -> None:
    for dark in (False, True):
        colours = [part_colour(k, dark) for k in range(60)]
        rgb = np.array([[int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in colours], float)
        apart = np.abs(rgb[:, None] - rgb[None]).sum(axis=2) + 1e3 * np.eye(60)
        assert apart.min() >= 8 and len(set(colours)) == 60
        assert min(apart[k, k + 1] for k in range(59)) > 90


def test_a_life_of_more_than_ten_years_is_told_no_more_exactly() -> None:
    assert value_text(1.939e8, "h", 4) == "over 100 000"
    for least, said in ((2e4, "over 100 000"), (2e5, "193 900 000")):
        life = at_least("BEARING_LIFE", 1.939e8, least, "h", Where("roller"), "")
        assert f">{said}<" in _cell([life], "")
    assert value_text(8766.0, "h", 4) == "8766" and value_text(1.939e8, "mm", 4) == "193 900 000"


def test_figures_have_words_units_and_the_kinds_of_files_side_by_side() -> None:
    numbers = Figures(
        [
            Figure("motion error {of}", 1e-14, "mm", "needle_bar", kind="dxf"),
            Figure("motion error {of}", 2e-3, "mm", "needle_bar", kind="stl"),
            Figure("peak torque", 0.1, "N m"),
            Figure("strokes", 2.0, "1/s"),
            Figure("spring rate needed", 3.0, "N/mm"),
            Figure("spring rate needed", 4.0, "N m/rad"),
            Figure("let down ratio", 2.0),
            Figure("reaction {joint}", 5.0, "N", joint="C of shoulder", module="leg"),
            Figure("{of} peak acceleration", 6.0, "mm/s²", "foot_x"),
        ]
    )
    assert list(numbers) == [
        "motion_error_needle_bar_dxf_mm",
        "motion_error_needle_bar_stl_mm",
        "peak_torque_n_m",
        "strokes_per_s",
        "spring_rate_needed_n_mm",
        "spring_rate_needed_n_m_per_rad",
        "let_down_ratio",
        "leg_reaction_c_of_shoulder_n",
        "foot_x_peak_acceleration_mm_s2",
    ]
    assert numbers["leg_reaction_c_of_shoulder_n"] == 5.0
    listed = [(row.name, row.unit, row.group) for row in rows(numbers)]
    assert listed == [
        ("Motion error: needle bar", "mm", "From the files"),
        ("Peak torque", "N m", "Forces and drive"),
        ("Strokes", "1/s", "Motion"),
        ("Spring rate needed at this preload", "N/mm", "Forces and drive"),
        ("Spring rate needed at this preload", "N m/rad", "Forces and drive"),
        ("Payout ratio", "", "Motion"),
        ("Leg reaction C of shoulder", "N", "Forces and drive"),
        ("Foot x peak acceleration", "mm/s²", "Motion"),
    ]
    assert rows(numbers)[0].values == {"dxf": 1e-14, "stl": 2e-3}


def test_the_stroke_of_a_path_in_files_is_named_by_the_axis_along_which_it_is_measured() -> None:
    """A way of 30 along y and 40 along x is 50 long: the files' 40 are no other stroke, but that along x."""

    def path(of: str, x: float, y: float, alone: bool = False) -> list[Figure]:
        measured = Figure("stroke recovered {of}", max(x, y), "mm", "" if alone else of, kind="dxf")
        sides = [Figure("{of} x stroke", x, "mm", of), Figure("{of} y stroke", y, "mm", of)]
        return [Figure("{of} stroke", math.hypot(x, y), "mm", of), *sides, measured]

    ram = Figure("stroke recovered {of}", 7.0, "mm", "ram", kind="dxf")
    found = {row.name: row.values for row in rows(Figures([*path("left_tip", 40, 30), ram]))}
    assert (
        found["Left tip x stroke, from the file"]
        == {"dxf": 40}
        == {"dxf": found["Left tip x stroke"][""]}
    )
    assert found["Stroke, from the file: ram"] == {"dxf": 7}
    alone = [row.name for row in rows(Figures(path("pen", 3, 4, alone=True)))]
    assert alone[-1] == "Pen y stroke, from the file"


def test_settings_of_the_printer_are_a_group_and_a_share_is_in_percent() -> None:
    quantities = ("print layer", "print nozzle", "print infill", "print time")
    numbers = Figures([Figure(quantity, 0.4) for quantity in quantities])
    assert {row.group for row in rows(numbers)} == {"Printing"}
    assert [(row.unit, row.values) for row in rows(numbers)][2] == ("%", {"": 40.0})


def test_extremes_and_joints_are_named_in_words() -> None:
    figures = [
        Figure("coupler rate max at", 1.0, "deg"),
        Figure("curvature radius min", 2.0, "mm"),
        Figure("reaction {joint}", 3.0, "N", joint="A of left_rod"),
        Figure("{of} length", 4.0, "mm", "left_tip"),
    ]
    assert [row.name for row in rows(Figures(figures))] == [
        "Coupler rate, where greatest",
        "Curvature radius, least",
        "Reaction A of left rod",
        "Left tip path length",
    ]


def test_a_path_that_turns_on_the_spot_has_no_least_radius_to_show() -> None:
    both = [Figure("{of} least radius", value, "mm", of) for of, value in (("a", 0.0), ("b", 2.0))]
    assert [row.name for row in rows(Figures(both))] == ["B least radius"]


@pytest.mark.parametrize(
    "value, text",
    [
        (0.0, "0"),
        (1.9e-14, "0"),
        (36.118473, "36.12"),
        (1917993.1, "1 918 000"),
        (0.00151756, "0.001518"),
        (-12.5, "−12.5"),
        (math.nan, "–"),
        (-math.inf, "−∞"),
        (4.003e-5, "4·10⁻⁵"),
        (99.75, "99.75"),
        (5550.147, "5550"),
    ],
)
def test_values_are_rounded_to_what_is_known(value: float, text: str) -> None:
    assert rounded(value) == text


def test_named_points_stand_where_they_are_and_within_the_frame() -> None:
    shape = Plot(
        "t",
        "x, mm",
        "y, mm",
        [("way", np.array([0.0, 10.0]), np.array([0.0, 0.0]))],
        equal=True,
        points=[("A", 0.0, 0.0), ("far <C>", 10.0, 30.0)],
    )
    root = ElementTree.fromstring(plot_figure(shape))[-1]
    rounds = [each for each in root.iter("circle") if each.get("class") == "named"]
    (ax, ay), (cx, cy) = ((float(each.get("cx", "")), float(each.get("cy", ""))) for each in rounds)
    line = next(
        each
        for each in root.iter("path")
        if each.get("class") == "curve" and "M" in (each.get("d") or "")
    )
    assert line.get("d", "").startswith(
        f"M{ax:g} {ay:g}L{cx:g} {ay:g}"
    ) and ay - cy == pytest.approx(3 * (cx - ax), abs=0.1)
    texts = {each.text: each for each in root.iter("text")}
    assert texts["A"].get("class") == "start" and 46 <= cx <= 322 and 22 <= cy <= 164
    assert "far <C>" in texts


def test_levels_stand_in_place_of_a_scale() -> None:
    x = np.linspace(0, 360, 361)
    strips = [("a, mm", x, x / 360), ("b, deg", x, 2 - x / 360)]
    figure = plot_figure(
        Plot("Strips", "cam angle, deg", "each", strips, levels=[("19.4", 0.5), ("7.8", 1.5)])
    )
    assert ">19.4<" in figure and ">7.8<" in figure
    assert ">1<" not in figure and "<output>" not in figure  # no value of a scale that is none


@given(
    places=st.lists(st.floats(0, 360), min_size=2, max_size=6),
    words=st.lists(
        st.sampled_from(["rise", "dwell", "return", "harmonic", "s max"]), min_size=6, max_size=6
    ),
)
@example(
    [100.0, 120.0, 205.0, 280.0, 0.0, 360.0], ["rise", "dwell", "return", "dwell", "rise", "return"]
)
@settings(max_examples=50, deadline=None)
def test_names_of_marks_stand_clear_of_each_other(places: list[float], words: list[str]) -> None:
    """In DejaVu Sans, one of the widest of a system's fonts, at the page's 11 px."""
    font = ImageFont.truetype(findfont("DejaVu Sans"), 11)
    marks = list(zip(words, places, strict=False))
    text = plot_figure(Plot("t", "cam angle, deg", "mm", [("a", THETA, np.sin(THETA))], marks))
    rows: dict[str, list[tuple[float, float]]] = {}
    for side, x, y, word in re.findall(
        r'class="mark"[^>]*/><text class="(\w+)" x="([-\d.]+)" y="([-\d.]+)">([^<]*)<', text
    ):
        wide = font.getlength(word)
        left = float(x) - wide * (side == "end")
        rows.setdefault(y, []).append((left, left + wide))
    assert sum(map(len, rows.values())) == len(marks)
    for row in map(sorted, rows.values()):
        assert all(after[0] - before[1] > 2 for before, after in pairwise(row))


def test_a_mark_s_name_begins_at_it_unless_the_frame_ends_there() -> None:
    """So a segment's name stands over the segment that begins there."""
    marks = [("rise", 0.0), ("dwell", 120.0), ("return", 180.0), ("dwell", 300.0), ("rise", 350.0)]
    text = plot_figure(Plot("t", "cam angle, deg", "mm", [("a", THETA, np.sin(THETA))], marks))
    names = re.findall(r'class="mark" d="M([\d.]+) [^>]*/><text class="(\w+)" x="([\d.]+)"', text)
    sides = [(side, float(x) - float(at)) for at, side, x in names]
    assert sides == [*[("start", pytest.approx(3))] * 4, ("end", pytest.approx(-3))]
