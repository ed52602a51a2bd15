"""Static plots: every curve of the report in a picture, the same bytes for the same spec, and figures in a notebook."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import camgen
from camgen.plotting import figure_of, image
from camgen.report.page import once
from camgen.study import Plot

SPECS = Path(__file__).resolve().parent.parent / "specs"
DISC = SPECS / "disc-cam.toml"
SVG = "{http://www.w3.org/2000/svg}"
X = np.linspace(0, 360, 91)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[camgen.Report, Path]:
    """The disc cam with its plots, and its folder."""
    out = tmp_path_factory.mktemp("plots")
    return camgen.build(DISC, out, only="plots"), out / "disc-cam"


def words(svg: bytes) -> set[str]:
    return {"".join(each.itertext()) for each in ElementTree.fromstring(svg).iter(f"{SVG}text")}


@pytest.mark.long
def test_each_plot_of_the_report_is_there_once_in_both_formats(
    made: tuple[camgen.Report, Path],
) -> None:
    report, folder = made
    plots = once(report.plots)
    assert len(plots) > 3
    titles = {
        word for path in folder.glob("disc-cam-plot-*.svg") for word in words(path.read_bytes())
    }
    assert {plot.title for plot in plots} <= titles
    names = {path.stem for path in folder.glob("disc-cam-plot-*.svg")}
    assert names == {path.stem for path in folder.glob("disc-cam-plot-*.png")}
    assert len(names) == len(plots) and "disc-cam-plot-pressure-angle" in names


@pytest.mark.long
def test_the_same_bytes_whatever_the_user_has_set(
    made: tuple[camgen.Report, Path], tmp_path: Path
) -> None:
    _, folder = made
    (tmp_path / "matplotlibrc").write_text("font.size: 20\nsvg.hashsalt: x\nsavefig.dpi: 30\n")
    code = f"import camgen; camgen.build({str(DISC)!r}, {str(tmp_path)!r}, only='plots')"
    setting = os.environ | {"MATPLOTLIBRC": str(tmp_path)}
    subprocess.run([sys.executable, "-c", code], check=True, env=setting)
    ours = {path.name: path.read_bytes() for path in folder.iterdir()}
    theirs = {path.name: path.read_bytes() for path in (tmp_path / "disc-cam").iterdir()}
    assert ours == theirs
    assert not any(b"<dc:date>" in data for data in ours.values())


@pytest.mark.long
def test_of_a_folder_the_plot_that_was_changed_is_told_alone(
    made: tuple[camgen.Report, Path], tmp_path: Path
) -> None:
    _, folder = made
    copy = tmp_path / "disc-cam"
    copy.mkdir()
    for path in folder.iterdir():
        (copy / path.name).write_bytes(path.read_bytes())
    picture_file = copy / "disc-cam-plot-pressure-angle.png"
    picture_file.write_bytes(picture_file.read_bytes()[:-1] + b"x")
    failed = [each for each in camgen.check(copy).findings if not each.ok]
    assert [each.code for each in failed] == ["MANIFEST"]  # and not REBUILD
    assert failed[0].message.endswith(picture_file.name)


def test_what_a_picture_shows() -> None:
    plot = Plot(
        "torque_of_a",
        "theta, deg",
        "mm/s^2",
        [("wanted", X, X**2), ("± play", X, np.where(X > 90, np.nan, -X)), ("hits", X, X)],
        marks=[("least", 90.0)],
        dots=("hits",),
        points=[("A", 10.0, 20.0)],
    )
    drawn = figure_of([plot])
    (axes,) = drawn.axes
    assert axes.get_xlim() == (0, 360) and list(axes.get_xticks()) == list(range(0, 361, 45))
    lines = {line.get_label(): line for line in axes.get_lines()}
    assert lines["wanted"].get_ydata() == pytest.approx(X**2)
    assert lines["hits"].get_marker() == "o" and lines["± play"].get_marker() == "None"
    svg = image(drawn, "svg")
    assert {"torque of a", "mm/s²", "wanted", "± play", "least", "A"} <= words(svg)
    assert image(figure_of([plot]), "svg") == svg and image(drawn, "png")[:4] == b"\x89PNG"


def test_a_shape_is_not_distorted_and_axes_may_be_logarithmic() -> None:
    circle = Plot("path", "x, mm", "y, mm", [("p", 50 * np.cos(X), np.sin(X))], equal=True)
    (axes,) = figure_of([circle]).axes
    assert axes.get_aspect() == 1.0
    x = np.geomspace(1e-3, 1e2, 50)
    (axes,) = figure_of([Plot("t", "n", "error", [("a", x, x**2)])], log=True).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")


def test_a_run_draws_its_outputs() -> None:
    run = camgen.load(SPECS / "linkage.toml").solve(theta := np.linspace(0, 2 * np.pi, 73))
    both = run.plot()
    assert len(both.axes) == len(list(run)) == 2 and both._repr_png_()[:4] == b"\x89PNG"
    path, swing = run.plot("pen", "swing").axes
    assert path.get_lines()[0].get_xydata() == pytest.approx(
        np.column_stack([run["pen"].real, run["pen"].imag])
    )
    assert swing.get_lines()[0].get_xydata() == pytest.approx(np.degrees([theta, run["swing"]]).T)
    (rates,) = run.plot("pen", order=1).axes
    assert rates.get_ylabel() == "mm/s"
    assert [line.get_ydata() for line in rates.get_lines()] == [
        pytest.approx(run.velocity["pen"].real),
        pytest.approx(run.velocity["pen"].imag),
    ]
    (swung,) = run.plot("swing", order=2).axes
    assert swung.get_lines()[0].get_ydata() == pytest.approx(np.degrees(run.acceleration["swing"]))
    wrong = [
        (lambda: run.plot("pan"), "did you mean 'pen'"),
        (lambda: run.plot(order=3), "order: 3"),
        (lambda: run.plot(beside=run), "beside: Run - expected runs by what they are called"),
        (lambda: run.plot(beside={"b": camgen.load(SPECS / "walking-leg.toml").solve(0)}), "pen"),
    ]
    for ask, told in wrong:
        with pytest.raises(camgen.SpecError, match=told):
            ask()


def test_a_run_is_drawn_beside_another() -> None:
    machine = camgen.load(SPECS / "linkage.toml")
    theta = np.linspace(0, 2 * np.pi, 73)
    run = machine.solve(theta)
    other = machine.replace({"lengths.A-B": 61}).solve(theta)
    path, swing = run.plot("pen", "swing", beside={"longer": other}).axes
    assert [line.get_label() for line in swing.get_lines()] == ["swing", "longer"]
    own, theirs = (line.get_xydata()[:, 1] for line in swing.get_lines())
    assert own == pytest.approx(np.degrees(run["swing"]))
    assert theirs == pytest.approx(np.degrees(other["swing"])) and np.ptp(own - theirs) > 0.1
    assert path.get_lines()[1].get_xydata() == pytest.approx(
        np.column_stack([other["pen"].real, other["pen"].imag])
    )
    (rates,) = run.plot("pen", order=1, beside={"longer": other}).axes
    labels = [line.get_label() for line in rates.get_lines()]
    assert labels == ["x", "y", "longer x", "longer y"]
