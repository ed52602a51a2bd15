"""Chains of other programs: read into specs that close, written back, and read again."""

from __future__ import annotations

import json
import math
import tomllib
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_cli import run as run  # noqa: F401  a fixture

from camgen.errors import CamgenError, SpecError
from camgen.machines.linkage import bridges
from camgen.machines.linkage.mechanism import Linkage
from camgen.reading import read
from camgen.spec import validate

THETA = np.linspace(0, math.tau, 73)


@pytest.fixture
def chains(root: Path) -> dict[str, str]:
    return tomllib.loads((root / "tests" / "reference" / "chains.toml").read_text(encoding="utf-8"))


def spec_of(text: str, folder: Path) -> dict[str, Any]:
    file = folder / "chain.txt"
    file.write_text(text, encoding="utf-8")
    return tomllib.loads(bridges.spec_text(bridges.read_chain(file), "own", "chain.txt"))


def test_pylinkages_four_bar(chains: dict[str, str], tmp_path: Path) -> None:
    """Freudenstein's equation with the lengths that it was made from."""
    data = spec_of(chains["pylinkage_four_bar"], tmp_path)
    assert data["drive"]["link"] == "crank" and set(data["links"]) == {
        "ground",
        "crank",
        "coupler",
        "rocker",
    }
    psi = validate(Linkage, data).solve(THETA)["rocker"]
    k3 = (20**2 - 60**2 + 50**2 + 70**2) / (2 * 20 * 50)
    turned = psi + math.pi if data["links"]["rocker"][0].startswith("coupler") else psi
    miss = 70 / 20 * np.cos(turned) - 70 / 50 * np.cos(THETA) + k3 - np.cos(THETA - turned)
    assert np.max(np.abs(miss)) < 1e-9


def test_pylinkages_slider_crank(chains: dict[str, str], tmp_path: Path) -> None:
    data = spec_of(chains["pylinkage_slider_crank"], tmp_path)
    data["output"] = [{"name": "pin", "point": "rod_1"}]
    path = validate(Linkage, data).solve(THETA)["pin"]
    assert np.max(np.abs(path.imag)) < 1e-9
    assert (
        np.max(
            np.abs(path.real - (20 * np.cos(THETA) - np.sqrt(60**2 - (20 * np.sin(THETA)) ** 2)))
        )
        < 1e-9
    )


def test_pmks_lines(chains: dict[str, str], tmp_path: Path) -> None:
    data = spec_of(chains["pmks_crank_rocker"], tmp_path)
    crank, coupler = abs(12.92 + 32.53j), abs(73.28 - 12.92 + (67.97 - 32.53) * 1j)
    machine = validate(Linkage, data)
    assert data["drive"]["link"] == "link_1" and [each["point"] for each in data["output"]] == ["D"]
    pin, far = (
        machine.solve(THETA).point("link_1", "B")[0],
        machine.solve(THETA).point("link_3", "C")[0],
    )
    assert (
        np.max(np.abs(np.abs(pin) - crank)) < 1e-9
        and np.max(np.abs(np.abs(far - pin) - coupler)) < 1e-9
    )
    pen = machine.solve(THETA)["D"]
    assert np.max(np.abs(np.abs(pen - pin) - abs(33.3 - 12.92 + (66.95 - 32.53) * 1j))) < 1e-9


def test_pmks_slots(chains: dict[str, str], tmp_path: Path) -> None:
    machine = validate(Linkage, spec_of(chains["pmks_crank_slider"], tmp_path))
    slot = next(joint for joint in machine.chain.joints if type(joint).__name__ == "Slot")
    assert {slot.guide.body, slot.runner.body} <= {"ground", "link_2", "link_3"}
    run = machine.solve(THETA)
    assert np.max(np.abs(run.point(slot.runner.body, slot.runner.at)[0].imag)) < 1e-9
    assert np.isfinite(np.asarray(run[machine.chain.outputs[0].name])).all()


@pytest.mark.parametrize("name", ["linkage", "walking-leg"])
def test_there_and_back(name: str, root: Path, tmp_path: Path) -> None:
    machine = validate(Linkage, read(root / "specs" / f"{name}.toml"))
    again = validate(Linkage, spec_of(bridges.pmks(machine.chain), tmp_path))
    path = next(output.name for output in machine.chain.outputs if output.unit == "mm")
    traced = next(output.name for output in again.chain.outputs)
    assert (
        np.max(
            np.abs(np.asarray(machine.solve(THETA)[path]) - np.asarray(again.solve(THETA)[traced]))
        )
        < 1e-6
    )


def test_the_picture_shows_each_link_and_point(root: Path) -> None:
    machine = validate(Linkage, read(root / "specs" / "linkage.toml"))
    page = ElementTree.fromstring(bridges.svg(machine.chain))
    told = [text.text for text in page.iter("{http://www.w3.org/2000/svg}text")]
    assert {"ground", "crank", "coupler", "rocker", "O", "A", "B", "C", "P"} == set(told)
    centres = {
        (float(c.get("cx", "")), -float(c.get("cy", "")))
        for c in page.iter("{http://www.w3.org/2000/svg}circle")
    }
    assert (0.0, 0.0) in centres and (70.0, 0.0) in centres and (20.0, 0.0) in centres


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("J[R, P[0, 0], L[ground, a]]\nJ[R, P[0], L[a]]", "line 2"),
        ("J[R, P[0, 0], L[ground, a]]\nhello", "line 2: 'hello'"[:6]),
        ("J[Q, P[0, 0], L[ground, a]]", "R, P or RP"),
        ("J[RP, P[0, 0], L[a]]", "R, P or RP"),
        ("", "PMKS lines such as"),
        ("J[R, P[0, 0], L[a, b]]", "none can be driven"),
        ("{}", "mechanism_to_dict"),
        ('{"joints": 3, "links": 4}', "mechanism_to_dict"),
        ('{"joints": [{"id": "a", "position": [null, 2]}], "links": []}', "mechanism_to_dict"),
        ('{"joints": [], "links": [{"id": "a", "joints": ["b"]}]}', "mechanism_to_dict"),
        (json.dumps({"joints": [], "links": []}), "none can be driven"),
    ],
)
def test_what_is_no_chain(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(SpecError, match="fault") as caught:
        spec_of(text, tmp_path)
    assert said in str(caught.value)


@pytest.mark.parametrize("cut", range(0, 900, 37))
def test_a_broken_file_is_told(cut: int, chains: dict[str, str], tmp_path: Path) -> None:
    for text in (chains["pylinkage_four_bar"], chains["pmks_crank_slider"]):
        try:
            validate(Linkage, spec_of(text[:cut] + text[cut + 5 :], tmp_path))
        except CamgenError:
            continue


def test_the_command(run: Any, chains: dict[str, str], tmp_path: Path) -> None:  # noqa: F811
    source, file = tmp_path / "Crank Rocker.pmks", tmp_path / "mine.toml"
    source.write_text(chains["pmks_crank_rocker"], encoding="utf-8")
    code, out, err = run("new", "linkage", file, "--from", source)
    assert (code, out) == (0, "") and err.startswith(f"wrote {file}, as it was drawn")
    assert validate(Linkage, read(file)).name == "mine"
    code, out, _ = run("new", "linkage", "--from", source)
    assert (
        code == 0
        and 'name = "crank-rocker"' in out
        and "# PMKS lines do not say what drives" in out
    )
    assert run("new", "machine", "--from", source)[:2] == (0, out)
    code, _, err = run("new", "disc-cam", "--from", source)
    assert code == 2 and "only a linkage" in err
