"""A layout whose levels are found, by way of the stems of what slides and of the heads of the ground's pins."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise, product

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.convex import hull_corners
from camgen.machine import model as m
from camgen.machine.run import Run
from camgen.parts.generator.cures import bent, slimmer, slimmer_pin
from camgen.parts.generator.guides import STEMS
from camgen.parts.generator.joined import GROUND, Second
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.pins import refuse, tall
from camgen.parts.generator.plates import columns, motor_holes, post_radius
from camgen.parts.level_rules import Axis, Band, Crowded, Opening, Thing, Wall, span
from camgen.parts.levels import cuts, levels

_PIECES = 4  # of the band of a link with a strap


def laid(layout: Layout, run: Run) -> Layout:
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
                return covered(best, run)
    assert refused is not None
    if not isinstance(refused, Crowded):
        raise refused
    for choice in bent(tries[0], refused):
        with suppress(DesignError):
            best = _lowest(choice, run, False)
            if best is not None:
                return covered(best, run)
    raise refused


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
        for stems in product(*map(layout.stems_of, layout.slides))
    ]


def attempts(layout: Layout) -> list[str]:
    """What `laid` has tried where it refuses, in words."""
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


def _lowest(layout: Layout, run: Run, explain: bool) -> Layout | None:
    """The layout on fewest levels, by where the ground's pins have their heads; otherwise as `found_levels`."""
    found = [made for each in layout.heads() if (made := _with_dowels(each, run, explain))]
    return min(found, key=lambda each: max(each.given.values()), default=None)


def _with_dowels(layout: Layout, run: Run, explain: bool) -> Layout | None:
    """The layout on its levels, with room for dowels that stand out of their caps; otherwise as `found_levels`."""
    given = found_levels(layout, run, explain)
    if not given:
        return None
    made = replace(layout, given=given)
    more = tall(made) - layout.tall
    return _with_dowels(replace(layout, tall=layout.tall | more), run, explain) if more else made


@dataclass(frozen=True)
class Things:
    """What is to be laid, and pairs of levels of which the first must lie over the second."""

    bands: list[Band]
    axes: list[Axis]
    walls: list[Wall]
    over: list[tuple[str, str]]
    openings: list[Opening]

    @property
    def every(self) -> list[Thing]:
        """All of them."""
        return [*self.bands, *self.axes, *self.walls, *self.openings]


def covered(layout: Layout, run: Run) -> Layout:
    """A layout on its levels with what is fitted to it, and with the second plate, where one is asked for; run: samples over the
    whole motion."""
    if layout.fitting is not None:
        own = layout.fitting(layout)
        feet, kept = (*layout.feet, *own.feet), (*layout.kept, *own.kept)
        layout = replace(layout, fitted=own, feet=feet, hangs=bool(feet), kept=kept)
    if layout.sizes.plates < 2:
        return layout
    t, gap = things(layout, run), layout.fits.slide_clearance
    points = {axis.name: axis.point for axis in t.axes}
    ends = {
        points[name]: at
        for name, at in cuts(t.bands, t.axes, t.walls, gap, layout.level, t.openings).items()
    }
    places = columns(
        t.every,
        list(layout.points_of(GROUND).values()),
        post_radius(layout.sizes),
        gap,
        layout.kept,
    )
    return replace(
        layout, second=Second(ends, places, max(span(thing, layout.level)[1] for thing in t.every))
    )


def found_levels(layout: Layout, run: Run, explain: bool) -> dict[str, int] | None:
    """Level of all that lies on one, those given kept; run: samples over the whole motion.

    Where there are none, or they are hard to find: None, or to `explain` a longer search and DesignError.
    """
    t, gap = things(layout, run), layout.fits.slide_clearance
    return levels(
        t.bands, t.axes, run.theta, gap, layout.given, t.walls, t.over, explain, explain, t.openings
    )


def things(layout: Layout, run: Run) -> Things:
    """What is to be laid; run: samples over the whole motion."""
    bands, axes, over = [], [], []

    def ways(link: str, places: Sequence[complex]) -> np.ndarray:
        """Places of a link on the ground, (k, n)."""
        if link == GROUND:
            return np.array([np.full(run.theta.shape, z, complex) for z in places])
        pose = run.pose(layout.carrier(link))
        return np.asarray(pose.place + np.exp(1j * pose.angle) * np.array(places)[:, None])

    def band(
        name: str, link: str, discs: Sequence[tuple[complex, float]], on: str, slim: str, move: str
    ) -> Band:
        corners = hull_corners([z for z, _ in discs])
        places = ways(link, [discs[k][0] for k in corners])
        return Band(name, places, max(radius for _, radius in discs), on, slim=slim, move=move)

    for link in (link for link in layout.moving if link not in layout.alone):
        arm = None if link in layout.guides else layout.arm_band(link)
        discs = layout.guides[link].bands if link in layout.guides else [layout.hubs(link)]
        if arm is not None:
            reach = arm.width / 2 + arm.sagitta
            discs = [
                *([hub] for hub in layout.hubs(link)),
                *([(a, reach), (b, reach)] for a, b in pairwise(arm.middle())),
            ]
        elif len(layout.hubs(link)) == 2 and not layout.discs.keys().isdisjoint(
            layout.points_of(link)
        ):
            discs = _tapered(*layout.hubs(link))
        bands += [
            replace(band(f"link {link}", link, each, link, *slimmer(layout, link)), link=link)
            for each in discs
        ]
        for start, way, half, length, _ in (
            bar for tip in layout.noses(link) if (bar := layout.arm(tip)) is not None
        ):
            ends = [(start, half), (start + length * way, half)]
            bands.append(
                band(f"face of link {link}", link, ends, link, "", f"other points of link {link}")
            )
    for tip in layout.tips:
        cam, follower = tip.wheel, tip.joint.follower
        at = layout.at(GROUND, layout.shaft_of(cam.link))
        smaller = (
            f"a smaller {cam.about} (points.{tip.point} nearer to its shaft, or a smaller lift)"
        )
        disc = band(
            cam.about,
            GROUND,
            [(at, cam.radius)],
            tip.level,
            smaller,
            f"points.{layout.shaft_of(cam.link)} elsewhere",
        )
        rolls, smaller = (
            [(layout.at(follower, tip.point), tip.radius)],
            f"a smaller radius of the roller of {cam.about}",
        )
        roller = band(
            f"roller of {cam.about}",
            follower,
            rolls,
            tip.level,
            smaller,
            f"points.{tip.point} elsewhere",
        )
        # under a groove's roller there is the back plate, under one that hangs the head of its pin
        bands += [
            replace(disc, below=int(tip.grooved)),
            *([replace(roller, below=int(tip.hung))] if tip.rolls else []),
        ]
        over += (
            []
            if not tip.rolls
            else [(follower, tip.level) if tip.hung or tip.grooved else (tip.level, follower)]
        )
    for wheel in (*(each.wheel for each in layout.toothed), *layout.weights):
        at = layout.at(GROUND, layout.shaft_of(wheel.link))
        how = (
            'counterweight.made = "steel", or a greater thickness'
            if wheel in layout.weights
            else "shafts nearer to each other"
        )
        smaller = f"a smaller {wheel.about} ({how})"
        elsewhere = f"points.{layout.shaft_of(wheel.link)} elsewhere"
        bands.append(
            band(wheel.about, GROUND, [(at, wheel.radius)], wheel.level, smaller, elsewhere)
        )
    for name, spring in layout.springs.items():
        ends = [ways(body, [layout.at(body, point)])[0] for body, point in (spring.a, spring.b)]
        bands.append(
            Band(
                name,
                np.array(ends),
                spring.diameter / 2,
                below=layout.below(spring),
                slim="a thinner spring",
            )
        )
        beside = [
            (*layout.pivots[point], *layout.riders[point]) for _, point in (spring.a, spring.b)
        ]
        over += [
            (name, other) for others in beside for other in others if other not in (GROUND, name)
        ]
    for point, links in layout.pivots.items():
        moving, shaft = tuple(link for link in links if link != GROUND), layout.shafts.get(point)
        moving = tuple(dict.fromkeys(layout.alone.get(link, link) for link in moving))
        upper = layout.alone.get(shaft or "", shaft) or (moving or (GROUND,))[-1]
        hanging = (
            tuple(link for link in moving if link in layout.webs and link != shaft)
            if shaft is not None
            else ()
        )
        thrown = layout.thrown(point)
        if shaft is not None or (layout.slotted_link(point) not in ("", GROUND) and not thrown):
            over += [(upper, link) for link in moving if link not in (upper, *hanging)]
        held = (*moving, *layout.riders.get(point, ()))
        loose = [
            layout.alone[link] for link in layout.freewheels if link in links
        ]  # the shaft is round below and there alone
        over += [
            (name, level)
            for level in loose
            for name in held
            if name != level and (name, level) not in over
        ]
        if shaft is not None and layout.webs.get(shaft):
            over += [(shaft, rider) for rider in layout.riders.get(point, ())]
        elif thrown:  # what turns on a throw, or runs on it, lies between its webs
            low, *high = thrown
            between = [link for link in held if link not in layout.webs]
            over += [(link, low) for link in between] + [
                (web, link) for web in high for link in between
            ]
        place = ways(links[0], [layout.at(links[0], point)])[0]
        wide, name = layout.head_radius(point), f"{'pin' if shaft is None else 'shaft'} {point}"
        if point in layout.discs:
            carrier = layout.discs[point][0]
            over += [(link, carrier) for link in moving if link != carrier]
        strapped = {link: 0 for disc in layout.discs_on(point) for link in layout.pivots[disc]}
        strapped.pop(shaft or "", None)
        over += [(rider, link) for rider in layout.riders.get(point, ()) for link in strapped]
        held = (*held, *strapped)
        low_ends = () if shaft is None else tuple(link for link in held if link not in hanging)
        runs = layout.slotted_link(point) == GROUND
        axes.append(
            Axis(
                name,
                held,
                place,
                wide,
                links[0] == GROUND or runs,
                *layout.beyond(point),
                *slimmer_pin(layout, point),
                layout.between_plates(point),
                low_ends,
                hanging,
                runs,
                f"shaft {layout.discs[point][1]}" if point in layout.discs else "",
                point,
                shaft is not None,
            )
        )
    walls = []
    for link, each in layout.guides.items():
        on = each.joint.guide.body
        base, move = "" if on == GROUND else on, "another line of the slide"
        if each.covered and layout.cover is not None:
            for pair in each.pairs:
                screws = layout.cover.places(pair, layout.sizes.rail_width)
                corners, radius = (
                    ways(on, [screws[k] for k in hull_corners(screws)]),
                    layout.cover.radius,
                )
                cures = "parts.cover = false", move
                walls.append(
                    Wall(
                        f"cover of {link}", corners, radius, link, base, layout.cover.levels, *cures
                    )
                )
        else:
            half, slim = layout.sizes.rail_width / 2, "a smaller parts.rail_width"
            walls += [
                Wall(f"rail of {link}", ways(on, ends), half, link, base, 0, slim, move)
                for ends in each.rails
            ]
        over += [(link, on)] if on != GROUND else []
    over += [(upper, lower) for lower, upper in pairwise(layout.webs)]
    return Things(bands, axes, walls, over, _openings(layout, run.theta.size))


def _tapered(
    one: tuple[complex, float], other: tuple[complex, float]
) -> list[list[tuple[complex, float]]]:
    """The band of a link whose hubs differ much, as a strap's do, in pieces that are not all as wide as the wider one."""
    (a, first), (b, second) = sorted((one, other), key=lambda hub: -hub[1])
    ways = np.linspace(0, 1, _PIECES + 1)
    discs = [(complex(a + t * (b - a)), float(first + t * (second - first))) for t in ways]
    slope = (first - second) * (b - a) / abs(b - a) / _PIECES  # a piece ends so much earlier
    return [[one], [other], *([(x, r), (y - slope, r)] for (x, r), (y, _) in pairwise(discs))]


def _openings(layout: Layout, count: int) -> list[Opening]:
    """Slots and other wide holes of the ground, at so many samples."""
    found = []
    for point, ends in layout.slots_of(GROUND).items():
        corners, half = (
            np.repeat(np.array(ends)[:, None], count, axis=1),
            layout.slot_width(point) / 2 + layout.min_wall / 2,
        )
        move = f"another line of the slot of points.{point}"
        found.append(Opening(f"slot of pin {point}", corners, half, f"pin {point}", move=move))
    motor = layout.shaft_of(layout.driven)
    for z, radius in motor_holes(layout):
        centre, half = np.full((1, count), z), radius + layout.min_wall / 2
        found.append(
            Opening(
                "hole for the motor",
                centre,
                half,
                f"shaft {motor}",
                move=f"points.{motor} elsewhere",
            )
        )
    return found


def lacking(layout: Layout) -> DesignError | None:
    """What to say of joints of which no bodies are made."""
    try:
        layout.toothed  # noqa: B018
    except DesignError as error:
        return error
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
