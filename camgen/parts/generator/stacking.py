"""A layout whose levels are found, by way of the stems of what slides and of the heads of the ground's pins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

from camgen.errors import DesignError
from camgen.machine import model as m
from camgen.machine.run import Run
from camgen.parts.generator.connections import GROUND, SecondPlate
from camgen.parts.generator.cures import with_bows
from camgen.parts.generator.guides import COVERED, STEMS
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.pins import refuse, tall
from camgen.parts.generator.plates import columns, over_screws, post_radius
from camgen.parts.generator.things import things
from camgen.parts.level_rules import NoPassage, Things, span
from camgen.parts.levels import cuts, levels, quick_levels

_THINNEST = 1.0  # mm, of a pin that is advised


@dataclass(frozen=True)
class _Laid:
    """A layout on its levels, and what was laid for it: its things meet wherever their levels are."""

    layout: Layout
    content: Things

    @property
    def height(self) -> int:
        """Its highest level."""
        return max(self.layout.given.values())


def with_levels(layout: Layout, run: Run) -> Layout:
    """The layout with the strokes of its slots and slides, stems, heads and levels; run: samples over the whole motion.

    Stems are tried in their order, the first that leaves room for all counts. The ground's pins have their heads on top, or
    under the plate where that saves a level. Where none can be laid, a link is bent; else DesignError of the first layout.
    """
    refuse(layout)
    tries = _with_stems(layout, run)
    for explain in (False, True):
        refused: DesignError | None = None
        for choice in tries:
            try:
                best = _lowest(choice, run, explain)
            except DesignError as error:
                refused = refused or error
                continue
            if best is not None:
                return _with_fitting(best, run)
    assert refused is not None
    if not isinstance(refused, NoPassage):
        raise refused
    for choice in with_bows(tries[0], refused):
        with suppress(DesignError):
            best = _lowest(choice, run, False)
            if best is not None:
                return _with_fitting(best, run)
    raise refused


def _stems(layout: Layout, link: str) -> Sequence[str]:
    """How a link that slides may reach its rails: as asked for, or away from a cam that its own end touches."""
    stem = layout.sizes.shape(link).stem
    if stem is not None:
        return (stem,)
    sides = {tip.leaves for tip in layout.noses(link)}
    if sides or layout.cover is None:
        return tuple("ahead" if side > 0 else "behind" for side in sides) or STEMS
    wide = any(slot.guide.body == link for slot in layout.slots.values())
    return ("both", *COVERED) if wide else COVERED


def _with_stems(layout: Layout, run: Run) -> list[Layout]:
    """The layout with the strokes of its slots and slides, by all choices of their stems."""
    ways = {
        joint.name: run.length(joint.name)[0]
        for joint in run.machine.joints
        if isinstance(joint, m.Slot | m.Slide)
    }
    strokes = {name: (float(way.min()), float(way.max())) for name, way in ways.items()}
    return [
        replace(layout, strokes=strokes, stems=dict(zip(layout.slides, stems, strict=True)))
        for stems in product(*(_stems(layout, link) for link in layout.slides))
    ]


def attempts(layout: Layout) -> list[str]:
    """What `with_levels` has tried where it refuses, in words."""
    found = [
        "all orders of the levels",
        *(["heads over and under the plate"] if layout.sizes.plates < 2 else []),
    ]
    return [*found, *([f"rails {', '.join(STEMS)}"] if layout.slides else []), "bows"]


def first_choice(layout: Layout, run: Run) -> Layout:
    """The layout with the strokes of its slots and slides, and the first choice of their stems."""
    return _with_stems(layout, run)[0]


def has_levels(layout: Layout, run: Run) -> bool:
    """Whether levels are found soon for a layout as `first_choice` gives it."""
    with suppress(DesignError):
        refuse(layout)
        return _lowest(layout, run, False) is not None
    return False


def refusal(layout: Layout, run: Run) -> DesignError | None:
    """Why no levels are found for such a layout; None where they are."""
    try:
        refuse(layout)
        _lowest(layout, run, True)
    except DesignError as error:
        return error
    return None


def _lowest(layout: Layout, run: Run, explain: bool) -> _Laid | None:
    """The layout on fewest levels, by where the ground's pins have their heads; run: samples over the whole motion.

    Where there are none, or they are hard to find: None, or to `explain` a longer search and DesignError.
    """
    ways = [layout]  # heads of the ground's pins over the plate, or under the one that there is
    ways += [replace(layout, sunk=True)] if layout.sizes.plates < 2 else []
    found = [made for each in ways if (made := _with_dowels(each, run, explain))]
    return min(found, key=lambda each: each.height, default=None)


def _with_dowels(layout: Layout, run: Run, explain: bool) -> _Laid | None:
    """The layout on its levels, with room for dowels that stand out of their caps; otherwise as `_lowest`."""
    content = things(layout, run)
    given = (
        levels(content, run.theta, layout.given) if explain else quick_levels(content, layout.given)
    )
    if not given:
        return None
    made = replace(layout, given=given)
    if more := tall(made) - layout.tall:
        return _with_dowels(replace(layout, tall=layout.tall | more), run, explain)
    return _Laid(made, content)


def _with_fitting(laid: _Laid, run: Run) -> Layout:
    """A layout on its levels with what is fitted to it, and with the second plate, where one is asked for; run: samples over the
    whole motion."""
    layout = laid.layout
    content = laid.content
    if layout.fitting is not None:
        own = layout.fitting(layout)
        feet = (*layout.feet, *own.feet)
        keep_outs = (*layout.keep_outs, *own.keep_outs)
        layout = replace(layout, fitted=own, feet=feet, hangs=bool(feet), keep_outs=keep_outs)
        content = things(layout, run)
    if layout.sizes.plates < 2:
        return layout
    points = {axis.name: axis.point for axis in content.axes}
    ends = {points[name]: level for name, level in cuts(content, layout.level).items()}
    places = columns(
        [*content.every, *over_screws(layout)],
        list(layout.points_of(GROUND).values()),
        post_radius(layout.sizes),
        content.gap,
        layout.keep_outs,
    )
    return replace(
        layout,
        second=SecondPlate(
            ends, places, max(span(thing, layout.level)[1] for thing in content.every)
        ),
    )


def lacking(layout: Layout) -> DesignError | None:
    """What to say of joints of which no bodies are made."""
    try:
        layout.gear_pairs  # noqa: B018
    except DesignError as error:
        return error
    for roller in layout.rollers:
        hole = layout.turning(roller.point) + layout.fits.running_clearance
        wall = roller.radius - hole / 2
        if wall < layout.min_wall:
            least = math.floor(100 * (hole / 2 + layout.min_wall) + 1) / 100
            widest = 2 * (roller.radius - layout.min_wall) - layout.fits.running_clearance
            most = math.floor(10 * widest - 1e-6) / 10
            thinner = f", or parts.pin_diameter at most {most:g}" if most >= _THINNEST else ""
            remedy = f"make its radius at least {least:g}{thinner}"
            where = f"roller of {roller.about}"
            return DesignError("wall round the pin", wall, layout.min_wall, "mm", where, remedy)
    slid = next((tip for tip in layout.tips if tip.hung and tip.joint.slide is not None), None)
    if slid is not None:
        return DesignError(
            "bars that cross the shaft",
            1,
            0,
            "",
            f"cam {slid.joint.name}",
            'make the closure of a follower that slides "force" or "groove": between two rollers its bar meets the shaft',
        )
    aside = next((tip for tip in layout.tips if tip.ridden.face_offset), None)
    if aside is not None:
        return DesignError(
            "face_offset",
            aside.ridden.face_offset,
            0,
            "mm",
            f"cam {aside.joint.name}",
            "its line goes through its pivot: use 0",
        )
    held = next((tip for tip in layout.tips if not tip.rolls and tip.closure != "force"), None)
    if held is not None:
        return DesignError(
            f"closure of a {held.shape}",
            1,
            0,
            "",
            f"cam {held.joint.name}",
            'give it a roller, or the closure "force"',
        )
    return None
