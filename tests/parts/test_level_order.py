"""What must lie over what, against all choices of levels."""

from __future__ import annotations

from itertools import product

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from camgen.parts.level_order import lowest_levels
from camgen.parts.level_program import least_levels
from camgen.parts.level_rules import Axis, Band, Rule, Thing, Things, Wall, holds

NAMES = ("a", "b", "c", "d")
MOST = 4  # levels of the trials
PLACE = np.zeros(1, complex)
BANDS = [Band(name, PLACE[None], 1.0) for name in NAMES]

links = st.lists(st.sampled_from(NAMES), min_size=1, max_size=2, unique=True).map(tuple)
pins = st.builds(
    lambda on, ground, over: Axis(f"pin {on}", on, PLACE, 1.0, ground, over),
    links,
    st.booleans(),
    st.integers(0, 1),
)
walls = st.builds(
    lambda link, on: Wall(f"wall {link}", PLACE[None], 1.0, link, on if on != link else "", 1),
    st.sampled_from(NAMES),
    st.sampled_from(("", *NAMES)),
)
things = st.one_of(st.sampled_from(BANDS), pins, walls)
rules = st.lists(
    st.tuples(things, things).map(lambda pair: Rule(*pair, 0.0, 1.0, 0)), min_size=1, max_size=6
)


def sound(level: dict[str, int], every: list[Rule], over: list[tuple[str, str]]) -> bool:
    return all(holds(rule, level, {}) for rule in every) and all(
        level[upper] > level[lower] for upper, lower in over
    )


@given(
    rules,
    st.lists(st.tuples(st.sampled_from(NAMES), st.sampled_from(NAMES)), max_size=1),
    st.dictionaries(st.sampled_from(NAMES), st.integers(1, 3), max_size=1),
)
def test_no_choice_of_levels_is_under_the_bounds(
    every: list[Rule], over: list[tuple[str, str]], fixed: dict[str, int]
) -> None:
    axes: list[Axis] = [
        thing for rule in every for thing in (rule.a, rule.b) if isinstance(thing, Axis)
    ]
    least = least_levels(Things(BANDS, axes))
    assume(all(fixed[name] >= least[name] for name in fixed))
    bounds = lowest_levels(least, every, over, fixed)
    ranges = [[fixed[name]] if name in fixed else range(least[name], MOST + 1) for name in NAMES]
    for choice in product(*ranges):
        level = dict(zip(NAMES, choice, strict=True))
        if sound(level, every, over):
            assert bounds is not None
            assert all(bounds[name] <= level[name] for name in NAMES)


def lowest(*pairs: tuple[Thing, Thing], **fixed: int) -> dict[str, int] | None:
    every = [Rule(a, b, 0.0, 1.0, 0) for a, b in pairs]
    return lowest_levels(dict.fromkeys(NAMES, 1), every, [], fixed)


def test_a_link_that_meets_two_pins_of_the_ground_in_turn_has_no_level() -> None:
    """a passes the pin that holds b, and b the pin that holds a: each would lie over the other."""
    a, b, c, _ = BANDS
    pin_a, pin_b = (Axis(f"pin {name}", (name,), PLACE, 1.0, True) for name in "ab")
    assert lowest((a, pin_b)) == {"a": 3, "b": 1, "c": 1, "d": 1}
    assert lowest((a, pin_b), (b, pin_a)) is None
    assert lowest((pin_a, pin_b)) is None  # both begin at the plate
    # c lies under the loose pin through a and b or over it; with a and b under a given level 1 only over
    loose = Axis("pin ab", ("a", "b"), PLACE, 1.0, over=1)
    assert lowest((c, loose), a=1) == {"a": 1, "b": 1, "c": 3, "d": 1}
    assert lowest((c, loose), a=1, c=2) is None


def test_what_follows_from_one_rule_decides_another() -> None:
    """a lies over b's pin; so of a and the wall of b, which meet too, a is the upper one, and c, on a's pin, follows."""
    a, b, c, _ = BANDS
    assert lowest((c, Axis("pin a", ("a",), PLACE, 1.0, True)), (a, c), (a, b), b=1) == {
        "a": 2,
        "b": 1,
        "c": 4,
        "d": 1,
    }


def test_what_is_stacked_is_the_next_level() -> None:
    """b lies right on a, d on the plate: nothing can come between."""
    least = dict.fromkeys(NAMES, 1)
    bounds = lowest_levels(least, [], [("a", "c")], {"c": 3}, [("b", "a"), ("d", "")])
    assert bounds == {"a": 4, "b": 5, "c": 3, "d": 1}
    assert lowest_levels(least, [], [("b", "c"), ("c", "a")], {}, [("b", "a")]) is None
