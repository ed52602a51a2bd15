"""Parts that are made alike are one part, or the parts list says which other one they are like."""

from __future__ import annotations

from collections import Counter, defaultdict
from pathlib import Path

import pytest

from camgen.machines.sources import read_mechanism
from camgen.parts.part import Part
from camgen.pipeline.making import parts_table

SPECS = Path(__file__).resolve().parents[3] / "specs"
NUMBERED = ("pin-", "crank-pin-", "spacer-", "cap-", "nut-", "keeper-")
MACHINES = ["gallery/walker", "gallery/heart", "stitch-head", "two-leg-walker"]


def size(part: Part) -> object:
    """Area, edge's length and heights of its layers to a ten-thousandth of a mm: another look than at their curves."""
    layers = tuple(
        tuple(round(v, 4) for v in (each.region.area, each.region.length, each.z0, each.z1))
        for each in part.layers
    )
    return layers, part.process


@pytest.mark.long
@pytest.mark.parametrize("name", MACHINES)
def test_pins_spacers_and_caps_of_one_size_are_copies_of_one_part(name: str) -> None:
    machine = read_mechanism(SPECS / f"{name}.toml")
    alike = defaultdict[object, list[str]](list)
    copies = Counter(mount.part for mount in machine.assembly.mounts)
    for part in machine.assembly.parts:
        if part.name.startswith(NUMBERED):
            alike[size(part)].append(part.name)
            assert part.count == copies[part.name] > 0
    assert alike and max(map(len, alike.values())) == 1, alike


def test_the_list_says_which_parts_of_other_names_are_alike() -> None:
    rows = {
        str(row[1]): str(row[2])
        for row in parts_table(read_mechanism(SPECS / "stitch-head.toml"), {}).rows
    }
    assert rows["roller-upper_cam"].endswith("; same as roller-lower_cam")
    assert "same as" not in rows["roller-lower_cam"]
    assert rows["cam-upper_cam-back"].endswith("; same as cam-lower_cam-back")
    inner = [text for name, text in rows.items() if name.endswith("cam-inner")]
    assert len(inner) == 2 and not any("same as" in text for text in inner), (
        "other laws, other cams"
    )
