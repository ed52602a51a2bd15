"""Threads between posts of known sizes, over machines of two bodies: distances in closed form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import shapely

from camgen.files.threemf import PartCopy, write_3mf
from camgen.findings import Finding
from camgen.geometry.mesh import placing
from camgen.geometry.outlines import Region, circle, polygon
from camgen.judge.strands import judge_strands
from camgen.machine.features import Mount, Strand, SweptMachine
from camgen.machine.model import GROUND, Floats, Pose
from camgen.parts.part import Layer, Part
from camgen.parts.solids import solid

# of the groove, mm
LOW = 10.0
HIGH = 12.0
FINE = 0.002


def post(head: float = 3.0, shoulder: float = 2.5, groove: float = 1.5) -> Part:
    """A round post 20 mm high with a groove."""
    layers = ((0.0, LOW, shoulder), (LOW, HIGH, groove), (HIGH, 20.0, head))
    return Part(
        "post", "", tuple(Layer(Region(circle(0j, radius)), z0, z1) for z0, z1, radius in layers)
    )


def block(z0: float, z1: float, size: float = 4.0) -> Part:
    """A square block about its origin, between two heights over its underside at 0."""
    square = polygon([complex(x, y) * size / 2 for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    return Part("block", "", (Layer(Region(square), z0, z1),))


class Swinging:
    """The body "arm" turns about a centre; the file shows it at theta = 0, already turned by `start`."""

    def __init__(self, centre: complex, start: float) -> None:
        self.centre, self.start = centre, start

    def __call__(self, theta: Floats) -> Mapping[str, Pose]:
        none = np.zeros(theta.shape)
        return {GROUND: Pose(none + 0j, none), "arm": Pose(none + self.centre, self.start + theta)}


def judged(
    folder: Path,
    places: Mapping[str, list[tuple[str, complex]]],
    parts: Mapping[str, Part],
    centre: complex = 0j,
    start: float = 0.0,
    posts: tuple[tuple[str, int], ...] = (("post", 0), ("post", 1)),
    held: float = 0.8,
    gap: float = 0.5,
) -> list[Finding]:
    """Findings of one thread; places: of each part on which body, and where on the ground at theta = 0."""
    items = [
        PartCopy(name, f"{name}-{k + 1}", placing(start if body == "arm" else 0.0, at, 0.0, 0.0))
        for name, all_ in places.items()
        for k, (body, at) in enumerate(all_)
    ]
    write_3mf(
        folder / "x.3mf", {name: solid(part, FINE) for name, part in parts.items()}, items, "key"
    )
    mounts = [Mount(name, body) for name, all_ in places.items() for body, _ in all_]
    machine = SweptMachine(mounts, Swinging(centre, start), (), (), 0.2, FINE)
    return judge_strands(folder / "x.3mf", machine, [Strand("thread", posts, LOW, HIGH, held, gap)])


STANDING = {"post": [(GROUND, -30 + 0j), (GROUND, 30 + 0j)]}


@pytest.mark.parametrize(
    "head, shoulder, held", [(3.0, 2.5, 1.0), (2.2, 4.0, 0.7), (1.5, 3.0, 0.0), (3.0, 1.2, -0.3)]
)
def test_a_post_holds_a_thread_by_its_head_and_its_shoulder(
    tmp_path: Path, head: float, shoulder: float, held: float
) -> None:
    """By what the lesser of both stands out over the groove."""
    findings = judged(tmp_path, STANDING, {"post": post(head, shoulder)})
    for copy, finding in zip((1, 2), findings[:2], strict=True):
        assert (finding.code, str(finding.where)) == ("THREAD_HELD", f"x.3mf, post-{copy}")
        assert finding.measured == pytest.approx(held, abs=2 * FINE) and finding.ok is (held > 0.8)
    if held > 0:
        assert f"a head {head - 1.5:.3g}, a shoulder {shoulder - 1.5:.3g} mm" in findings[0].message


def test_a_post_that_is_not_there_is_told(tmp_path: Path) -> None:
    (finding,) = judged(tmp_path, STANDING, {"post": post()}, posts=(("post", 0), ("post", 2)))
    assert not finding.ok and math.isnan(finding.measured) and str(finding.where) == "x.3mf, post-3"


@pytest.mark.parametrize(
    "z0, z1, at, gap, said",
    [
        (0.0, 6.0, 0j, 4.0, "over block-1"),  # below the thread, under it in plan
        (15.0, 18.0, 0j, 3.0, "under block-1"),
        (
            0.0,
            9.8,
            0j,
            -1.5,
            "beside block-1",
        ),  # nearer than the gap in height: it counts sideways, and is struck
        (0.0, 9.8, 9j, 9 - 2 - 1.5, "beside block-1"),
        (0.0, 18.0, 6j, 6 - 2 - 1.5, "beside block-1"),
        (
            0.0,
            18.0,
            36 + 5j,
            math.hypot(4, 3) - 1.5,
            "beside block-1",
        ),  # beyond the end of the thread
    ],
)
def test_what_stands_still_is_passed_over_under_or_beside(
    tmp_path: Path, z0: float, z1: float, at: complex, gap: float, said: str
) -> None:
    """A block beside the line from axis to axis, less the groove's radius; upright what lies in it in plan."""
    places = STANDING | {"block": [(GROUND, at)]}
    clear = judged(tmp_path, places, {"post": post(), "block": block(z0, z1)})[-1]
    assert clear.code == "THREAD_CLEAR" and said in str(clear.where) and clear.ok is (gap > 0.5)
    assert clear.measured == pytest.approx(gap, abs=2 * FINE)


def test_only_what_is_in_its_heights_counts_sideways(tmp_path: Path) -> None:
    """A tower that is 12 mm wide below, and 4 mm from half a millimetre under the thread."""
    wide = Part("block", "", (*block(0.0, 9.4, 12.0).layers, *block(9.4, 18.0, 4.0).layers))
    clear = judged(tmp_path, STANDING | {"block": [(GROUND, 7j)]}, {"post": post(), "block": wide})[
        -1
    ]
    assert clear.measured == pytest.approx(7 - 2 - 1.5, abs=2 * FINE) and clear.ok


@pytest.mark.long
@pytest.mark.parametrize("centre, start", [(0j, 0.0), (0j, 0.7), (5 - 3j, -2.0)])
def test_the_nearest_is_told_with_its_angle(tmp_path: Path, centre: complex, start: float) -> None:
    """A block that goes round 20 mm from its axle, past a thread 26 mm from that: a corner of it comes nearest, turned to it."""
    near, far = centre + 26j - 40, centre + 26j + 40
    places = {
        "post": [(GROUND, near), (GROUND, far)],
        "block": [("arm", centre + 20 * np.exp(0.4j))],
    }
    clear = judged(tmp_path, places, {"post": post(), "block": block(0.0, 18.0)}, centre, start)[-1]
    corners = 20 * np.exp(0.4j) + np.array([2 + 2j, 2 - 2j, -2 + 2j, -2 - 2j]) * np.exp(1j * start)
    reach = np.max(np.abs(corners))
    assert clear.measured == pytest.approx(26 - reach - 1.5, abs=2e-3)
    degrees = math.degrees(math.pi / 2 - np.angle(corners[np.argmax(np.abs(corners))])) % 360
    assert float(
        str(clear.where).partition("nearest at ")[2].removesuffix(" deg")
    ) == pytest.approx(degrees, abs=0.02)
    assert str(clear.where).startswith("x.3mf, thread post-1 to post-2, beside block-1")


@pytest.mark.parametrize("at", [-24 + 19j, -10 + 24j, -12 + 14j])
def test_a_thread_goes_with_the_post_that_carries_it(tmp_path: Path, at: complex) -> None:
    """From a post that stands to one on an arm, past a block or through it; and on to a third one, of which the whole counts."""
    places = {
        "post": [(GROUND, -40 + 0j), ("arm", 20 + 0j), (GROUND, -40 + 60j)],
        "block": [(GROUND, at)],
    }
    parts = {"post": post(), "block": block(0.0, 18.0)}
    end = 20 * np.exp(1j * np.linspace(0, math.tau, 20_001))
    square = shapely.box(at.real - 2, at.imag - 2, at.real + 2, at.imag + 2)

    def nearest(fixed: complex) -> float:
        ends = np.stack([np.full(end.shape, fixed), end], axis=1)
        return float(
            np.min(
                shapely.distance(
                    square, shapely.linestrings(np.stack([ends.real, ends.imag], axis=2))
                )
            )
        )

    clear = judged(tmp_path, places, parts, posts=(("post", 0), ("post", 1)))[-1]
    assert clear.measured == pytest.approx(nearest(-40) - 1.5, abs=5e-3)
    both = judged(tmp_path, places, parts, posts=(("post", 0), ("post", 1), ("post", 2)))
    assert len(both) == 4 and both[-1].measured == pytest.approx(
        min(nearest(-40), nearest(-40 + 60j)) - 1.5, abs=5e-3
    )
