"""What keeps a machine on the bench from sticking or standing on what moves: strips under links in which a pin is glued from above, and blocks under one that lies on its front."""

from __future__ import annotations

from pathlib import Path

import pytest

from camgen.machines.sources import read_mechanism
from camgen.pipeline.shopping import steps_of_assembly

GALLERY = Path(__file__).resolve().parents[2] / "specs" / "gallery"


@pytest.fixture(scope="module")
def bird() -> list[str]:
    return [
        step.title
        for step in steps_of_assembly(read_mechanism(GALLERY / "flapping-bird.toml")).steps
    ]


@pytest.mark.parametrize(
    ("pin", "under"),
    [
        ("glue it into left_wing", "between ground and left_wing under L"),
        ("glue it into crank", "between ground and crank under A"),
        ("glue it into right_wing", "between ground and right_wing under R"),
    ],
)
def test_a_strip_lies_under_what_moves_on_the_plate(bird: list[str], pin: str, under: str) -> None:
    """Wings and crank lie on the ground plate and swing on it: their pins are glued in from above, flush below."""
    (step,) = (each for each in bird if pin in each)
    assert 0 <= step.index("of a plastic bag") < step.index(under) < step.index(pin)


def test_no_strip_lies_under_a_plate_that_stands_on_the_bench(bird: list[str]) -> None:
    """The pins on which the wings turn are glued into the plate, and nothing lies under it there."""
    (step,) = (each for each in bird if "glue it into ground" in each)
    assert "plastic bag" not in step


def test_blocks_under_what_lies_on_its_front_are_higher_than_what_comes_there(
    bird: list[str],
) -> None:
    """Pin heads stand 14.3 in front of the panel, and the foot, which is glued on while it lies so, 16.38 [its drawing]."""
    (turned,) = (each for each in bird if "Turn the machine over" in each)
    assert "blocks at least 17 mm high" in turned
