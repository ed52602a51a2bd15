"""Links that are not as the others: thickness, width and bow of one link, built to files and green."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from camgen.errors import DesignError, SpecError
from camgen.machines.linkage.mechanism import Linkage
from camgen.parts.generator import layout as lo
from camgen.pipeline.build import build
from camgen.reading import read
from camgen.spec import validate

PLAY = 0.2


def green(spec: Path, folder: Path, *sets: str) -> Linkage:
    """The machine of a green build, its written assembly swept."""
    report = build(spec, folder, frozenset({"3mf"}), list(sets))
    assert report.ok, [finding for finding in report.findings if not finding.ok]
    assert "INTERFERENCE" in {finding.code for finding in report.findings}
    return validate(Linkage, read(folder / spec.stem / "spec.toml"))


def stacks(machine: Linkage) -> list[list[tuple[float, float]]]:
    """Of each pin: bottom and top of all links and spacers on it, mm, by the mounts of the solids."""
    parts, found = {part.name: part for part in machine.assembly.parts}, []
    chain, poses = machine.chain, machine.chain.start
    links = {
        mount.part: mount
        for mount in machine.assembly.mounts
        if mount.part in (*poses, "plate", "ground")
    }

    def place(body: str, at: complex) -> complex:
        return at if body == "ground" else poses[body].place + np.exp(1j * poses[body].angle) * at

    for point, on in machine.bodies.layout.pivots.items():
        here = place(on[0], complex(chain.body(on[0]).points[point]))
        mounts = [links[link] for link in on]
        mounts += [
            mount
            for mount in machine.assembly.mounts
            if mount.part.startswith("spacer") and abs(place(mount.body, mount.at) - here) < 1e-6
        ]
        found.append(
            sorted((mount.z, mount.z + parts[mount.part].layers[0].z1) for mount in mounts)
        )
    return found


@pytest.mark.long
@pytest.mark.parametrize(
    ("spec", "sets"),
    [
        ("linkage", ["parts.crank.thickness=7.5", "parts.coupler.thickness=1"]),
        (
            "walking-leg",
            ["parts.shoulder.thickness=6", "parts.foot.thickness=2", "parts.crank.thickness=1.2"],
        ),
    ],
)
def test_links_of_unequal_thickness_lie_on_each_other(
    root: Path, tmp_path: Path, spec: str, sets: list[str]
) -> None:
    printed = ("parts.pin=printed", f"print.slide_clearance={PLAY}", "limits.lash=20")
    machine = green(root / "specs" / f"{spec}.toml", tmp_path, *sets, *printed)
    thickness = {part.name: part.thickness for part in machine.assembly.parts}
    for each in sets:
        key, _, value = each.partition("=")
        assert thickness[key.split(".")[1]] == float(value)
    for stack in stacks(machine):
        gaps = [low - top for (_, top), (low, _) in zip(stack, stack[1:], strict=False)]
        # one play between faces that run on each other, and what is too thin for a spacer
        assert all(PLAY - 1e-9 <= gap <= 2 * PLAY + machine.making.thickness / 4 for gap in gaps)


@pytest.mark.long
def test_levels_of_one_height_for_links_of_two_collide(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        lo.Layout, "_heights", property(lambda self: [self.sizes.base_thickness, 4.0, 4.0, 4.0])
    )
    report = build(
        root / "specs" / "linkage.toml", tmp_path, frozenset({"3mf"}), ["parts.crank.thickness=7"]
    )
    assert "INTERFERENCE" in {finding.code for finding in report.findings if not finding.ok}


@pytest.mark.long
@pytest.mark.parametrize("sets", [["bow=10"], ["bow=-8", "width=5"]])
def test_links_bent_and_slim_are_built(root: Path, tmp_path: Path, sets: list[str]) -> None:
    machine = green(
        root / "specs" / "linkage.toml", tmp_path, *(f"parts.rocker.{each}" for each in sets)
    )
    plain = validate(Linkage, read(root / "specs" / "linkage.toml"))
    (own,), (straight,) = (
        [part for part in each.assembly.parts if part.name == "rocker"] for each in (machine, plain)
    )
    asked = {key: float(value) for key, value in (each.split("=") for each in sets)}
    ends = [z for z in own.centres]
    at = (ends[0] + ends[1]) / 2 + 1j * asked[
        "bow"
    ]  # the axes' x runs from the first hole to the second
    ring = np.concatenate(
        [
            piece.at(np.linspace(piece.t0, piece.t1, 999))
            for piece in own.layers[0].region.outer.pieces
        ]
    )
    assert np.abs(ring - at).min() == pytest.approx(asked.get("width", 9.2) / 2, abs=1e-3)
    assert own.centres == straight.centres


@pytest.mark.parametrize(
    ("shapes", "error", "said"),
    [
        ({"coupler": {"bow": 3.0}}, DesignError, "parts.coupler.bow.*two round holes"),
        (
            {"rocker": {"width": 20.0}},
            DesignError,
            "parts.rocker.width is 20 mm.*limit: at most 9.2 mm",
        ),
        ({"rocker": {"thickness": 0.3}}, SpecError, "parts.rocker.thickness.*nozzle"),
        ({"rocker": {"width": 0.3}}, SpecError, "parts.rocker.width.*min_wall"),
        ({"ground": {"thickness": 6.0}}, SpecError, "parts.ground.thickness.*parts.base_thickness"),
    ],
)
def test_shapes_that_cannot_be(
    root: Path, shapes: dict[str, Any], error: type[Exception], said: str
) -> None:
    with pytest.raises(error, match=said):
        _ = validate(Linkage, {**read(root / "specs" / "linkage.toml"), "parts": shapes}).assembly
