"""How good a front of designs is, as one number."""

from __future__ import annotations

from collections.abc import Iterable

from camgen.design.paths import ChainDesign, front
from camgen.design.polish import Goal


def area(designs: Iterable[ChainDesign], goal: Goal) -> float:
    """Share of the field below (worst error, most bars) that a front dominates, 0 to 1."""
    dominant = [
        each for each in front(designs) if each.error < goal.worst and each.bars < goal.most
    ]
    if not dominant:
        return 0.0
    ends = [each.error for each in dominant[1:]] + [goal.worst]
    dominated = sum(
        (end - each.error) * (goal.most - each.bars)
        for each, end in zip(dominant, ends, strict=True)
    )
    return dominated / (goal.worst * goal.most)
