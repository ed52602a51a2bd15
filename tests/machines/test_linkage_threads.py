"""Threads of a linkage: their length as an output, from the model and from files, and the posts that carry them."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from judged import wrong

from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.pipeline import build as pipeline
from camgen.spec import validate

BAR: dict[str, Any] = {
    "mechanism": "linkage",
    "name": "threaded",
    "points": {
        "O": [0, 0],
        "C": [70, 0],
        "A": [20, 0],
        "B": [55, 48],
        "P": [22, 60],
        "M": [-40, 30],
        "N": [110, 70],
    },
    "links": {
        "ground": ["O", "C", "M", "N"],
        "crank": ["O", "A"],
        "coupler": ["A", "B", "P"],
        "rocker": ["C", "B"],
    },
    "drive": {"link": "crank", "speed_rpm": 60},
    "output": [{"name": "feed", "thread": ["M", "P", "N"]}, {"name": "eye", "point": "P"}],
}
THETA = np.linspace(0, 2 * np.pi, 37)


def linkage(**tables: Any) -> Linkage:
    return validate(Linkage, {**BAR, **tables})


def test_the_length_and_its_derivatives_are_those_of_the_way_over_the_points() -> None:
    made = linkage()
    eye = made.run(THETA).derivatives("eye")[0]
    np.testing.assert_allclose(
        made.motion(THETA), abs(eye - (-40 + 30j)) + abs(eye - (110 + 70j)), atol=1e-12
    )
    step = 1e-4
    for order in (1, 2):
        ahead, behind = (made.motion(THETA + sign * step, order - 1) for sign in (1, -1))
        np.testing.assert_allclose(
            made.motion(THETA, order), (ahead - behind) / (2 * step), atol=1e-4
        )


def test_a_thread_over_two_posts_of_moving_links_and_a_wish_of_its_length() -> None:
    points = {**BAR["points"], "Q": [62, 20]}
    links = {**BAR["links"], "rocker": ["C", "B", "Q"]}
    output = [{"name": "feed", "thread": ["M", "P", "Q"], "stroke": {"value": 1, "tolerance": 0.1}}]
    made = linkage(points=points, links=links, output=output)
    (missed,) = (finding for finding in made.limits() if finding.code == "STROKE_ERROR")
    assert missed.measured == pytest.approx(np.ptp(made.motion(THETA)) - 1, rel=0.02)
    assert not missed.ok
    (strand,) = made.assembly.strands
    heights = {made.assembly.by_name[part].thickness for part, _ in strand.posts}
    assert len(heights) == 3  # from the plate, and from links on two levels, all up to one height


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sound build, never changed before the last test."""
    place = tmp_path_factory.mktemp("threads")
    report = pipeline.build(copy.deepcopy(BAR), place, frozenset({"dxf", "3mf"}))
    assert report.ok
    held = [finding for finding in report.findings if finding.code == "THREAD_HELD"]
    assert len(held) == 3 and {"THREAD_CLEAR"} <= {finding.code for finding in report.findings}
    return place / "threaded"


@pytest.mark.long
def test_a_post_that_is_off_is_found_at_the_length(folder: Path) -> None:
    """20 um of a guide's hole, in the drawing of the plate: the thread has another length, and nothing else is wrong."""
    path = folder / "threaded-ground.dxf"
    drawing = ezdxf.readfile(path)
    moved = 0
    for hole in drawing.modelspace().query("CIRCLE"):
        if abs(complex(hole.dxf.center.x, hole.dxf.center.y) - (-40 + 30j)) < 1e-6:
            hole.dxf.center = hole.dxf.center + ezdxf.math.Vec3(0.02, 0)
            moved += 1
    assert moved == 1
    drawing.saveas(path)
    assert {(f.code, f.where.output) for f in wrong(folder, "dxf")} == {("MOTION_ERROR", "feed")}


@pytest.mark.long
def test_plain_posts_hold_no_thread(tmp_path: Path) -> None:
    """It may slip down to the heads of the pins, too."""
    tables = {**BAR, "parts": {"thread_posts": {"groove": 0, "diameters": {"P": 3}}}}
    report = pipeline.build(tables, tmp_path, frozenset({"3mf"}))
    assert {finding.code for finding in report.findings if not finding.ok} == {
        "THREAD_HELD",
        "THREAD_CLEAR",
    }


@pytest.mark.parametrize(
    ("change", "key", "right"),
    [
        ({"thread": ["M", "X"]}, "output.0.thread.1", "X"),
        ({"thread": ["M", "B"]}, "output.0.thread.1", "a point of one link alone"),
        ({"thread": ["M", "N"]}, "output.0.thread", "points of two links"),
        ({"thread": ["M", "P", "P"]}, "output.0.thread.2", "another point"),
        ({"thread": ["M", "P"], "point": "P"}, "output.0", "either a point, a link or a thread"),
        ({"thread": ["M"]}, "output.0.thread", "2"),
        (
            {"thread": ["M", "P"], "straightness": {"length": 3, "tolerance": 1}},
            "output.0.straightness",
            "only the path of a point",
        ),
    ],
)
def test_faults_of_a_thread(change: dict[str, Any], key: str, right: str) -> None:
    with pytest.raises(SpecError) as refused:
        linkage(output=[{"name": "feed", **change}])
    assert [fault.key for fault in refused.value.faults] == [key] and right in str(refused.value)


@pytest.mark.parametrize(
    ("sizes", "key"),
    [
        ({"height": 2}, "parts.thread_posts.height"),
        ({"groove": 0.1}, "parts.thread_posts.groove"),
        ({"diameters": {"A": 3}}, "parts.thread_posts.diameters.A"),
    ],
)
def test_faults_of_posts(sizes: dict[str, Any], key: str) -> None:
    with pytest.raises(SpecError) as refused:
        linkage(parts={"thread_posts": sizes})
    assert [fault.key for fault in refused.value.faults] == [key]


def test_heads_are_too_high_for_posts_only_where_there_is_a_thread() -> None:
    linkage(parts={"head": 3}, output=[{"name": "eye", "point": "P"}])
    with pytest.raises(SpecError) as refused:
        linkage(parts={"head": 3})
    assert [fault.key for fault in refused.value.faults] == ["parts.thread_posts.height"]


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"parts": {"plates": 2}}, "second plate"),
        ({"spring": [{"between": ["P", "N"], "rate": 0.1, "preload": 1}]}, "a pin is there"),
    ],
)
def test_posts_without_room_are_refused(tables: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        _ = linkage(**tables).assembly.parts
