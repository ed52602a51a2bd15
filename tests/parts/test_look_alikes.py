"""Parts that look alike are told apart by what differs, and only those that are one and the same stand together."""

from __future__ import annotations

import cmath
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import pytest

from camgen import load, starters
from camgen.geometry.outlines import Arc, Contour, Line, Region, circle
from camgen.parts.fixing import Fixing
from camgen.parts.look_alikes import with_sorting
from camgen.parts.part import Layer, Part
from camgen.parts.steps import COLUMNS
from camgen.pipeline.shopping import steps_of_assembly
from camgen.study import Doing, Step, Table

FIRST = Table("order", COLUMNS, [(1, *[""] * 6)], [Step([Doing("lay it")])])


def bore(at: complex, flat: complex | None = None) -> Contour:
    """A hole of 5 mm, with a flat 2 mm from its middle in a direction or without."""
    if flat is None:
        return circle(at, 2.5)
    a, b = (at + flat * (2 + 1.5j * side) for side in (-1, 1))
    start = cmath.phase(flat * (2 + 1.5j))
    sweep = 2 * cmath.pi - 2 * cmath.phase(2 + 1.5j)
    return Contour((Arc(at, 2.5, start, sweep), Line(a, b)))


def bar(name: str, *places: complex, flat: complex | None = None, wide: float = 40.0) -> Part:
    """A round plate with lettered holes, the first of them with a flat or without."""
    holes = tuple(bore(at, flat if not k else None) for k, at in enumerate(places))
    points = tuple(zip("ABCD", places, strict=False))
    return Part(name, "Bar", (Layer(Region(circle(0j, wide), holes), 0, 3),), points=points)


def lines(parts: Sequence[Part]) -> list[str]:
    """What the step that comes first says."""
    found = with_sorting(FIRST, parts, [], Fixing(0.0))
    assert [row[0] for row in found.rows] == [*range(1, len(found.steps) + 1)]
    return found.steps[0].title.rstrip(".").split("\n")[1:] if len(found.steps) > 1 else []


@pytest.mark.parametrize(
    ("one", "other", "said"),
    [
        (
            bar("one", 0, 30),
            bar("other", 0, 32),
            "one: 30.0 mm from A to B; other: 32.0 mm from A to B",
        ),
        (bar("one", 0, 30, 20j), bar("other", 0, 30j, 20), "one or other"),
        (
            bar("one", 0, 30, flat=1),
            bar("other", 0, 30, flat=-1),
            "one: seen from above flats lie A's 0 deg from B; other: seen from above flats lie A's 180 deg from B",
        ),
        (bar("one", 0, 30, flat=1j), bar("other", 0, 30, flat=-1j), "one or other"),
        (
            bar("one", 0, 30),
            bar("other", 0, 30, wide=42),
            "one: 80.0 x 80.0 mm; other: 84.0 x 84.0 mm",
        ),
        (bar("one", 0, 30), bar("other", 0, 36), ""),
        (bar("one", 0, 30), bar("other", 0, 30, 20j), ""),
    ],
)
def test_what_tells_two_links_apart(one: Part, other: Part, said: str) -> None:
    """A length, a mirror image, flats to and from the other hole, flats that a turn brings on each other, an outline; what no eye mistakes."""
    assert lines([one, other]) == ([f"☐ {said}"] if said else [])


def test_what_tells_only_some_of_several_apart_does_not_tell_all() -> None:
    """Of three plates two have as many holes: what they differ in is said too, a hole for a head or else the outline."""
    more = bar("more", 0, 30)
    (layer,) = more.layers
    third = Region(layer.region.outer, (*layer.region.holes, circle(20j, 1)))
    more = replace(more, layers=(replace(layer, region=third),))
    plain = bar("plain", 0, 30)
    wider = Region(layer.region.outer, (bore(0), circle(30, 4)))
    sunk = replace(plain, name="sunk", layers=(*plain.layers, Layer(wider, 3, 5)))
    plain = replace(plain, layers=(*plain.layers, Layer(layer.region, 3, 5)))
    more = replace(more, layers=(*more.layers, Layer(third, 3, 5)))
    assert lines([more, plain, sunk]) == [
        "☐ more: 3 holes, none of them wider at one face; plain: 2 holes, none of them wider at one face; "
        "sunk: 2 holes, 1 of them wider at one face"
    ]
    large = bar("large", 0, 30, wide=42)
    thin = replace(more, layers=more.layers[:1])
    assert lines([thin, bar("plain", 0, 30), large]) == [
        "☐ more: 3 holes, 80.0 x 80.0 mm; plain: 2 holes, 80.0 x 80.0 mm; large: 2 holes, 84.0 x 84.0 mm"
    ]


SIZES: list[tuple[str, Literal["cap", "spacer", "pin"], float, float]] = [
    ("cap-1", "cap", 3.0, 2.85),
    ("spacer-1", "spacer", 3.0, 1.9),
    ("spacer-2", "spacer", 5.0, 1.0),
    ("pin-1", "pin", 3.0, 12.0),
]


def test_round_parts_of_one_diameter_are_told_apart_by_their_heights() -> None:
    rounds = [
        Part(name, name, (Layer(Region(circle(0j, radius)), 0, high),), role=role)
        for name, role, radius, high in SIZES
    ]
    assert lines(rounds) == ["☐ spacer-1 1.9 and cap-1 2.85 mm high"], "a pin is no cap"


def test_links_that_read_their_letters_are_told_apart_by_these_alone() -> None:
    """Two bars of the same holes, A B and A C; with the same letters nothing tells them apart but a measure."""
    one = replace(bar("one", 0, 30), lettered=frozenset("AB"))
    other = replace(
        bar("other", 0, 30), points=(("A", 0j), ("C", 30 + 0j)), lettered=frozenset("AC")
    )
    assert lines([one, other]) == ["☐ letters beside their holes name these: one A B, other A C"]
    bare = replace(other, lettered=frozenset("A"))  # no room for C
    assert lines([one, bare]) == ["☐ one or other"]
    assert lines([one, replace(one, name="twin")]) == ["☐ one or twin"]


def test_holes_that_only_a_pin_tells_apart_are_marked_at_the_printer() -> None:
    """Links of the small walker differ by 0.05 mm in a hole, which nobody sees; those of the large one have letters."""
    first = {
        name: steps_of_assembly(load(tomllib.loads(starters.text(name)))).steps[0].title
        for name in ("two-leg-walker", "walker")
    }
    assert "narrower in F or F2" in first["two-leg-walker"]
    assert "as you take it off the printer's plate" in first["two-leg-walker"]
    assert "narrower" not in first["walker"].lower()
    assert "low1 B C1, low2 B2 C2, low3 B C3, low4 B2 C4" in first["walker"]
