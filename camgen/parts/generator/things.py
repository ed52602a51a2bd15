"""What of a layout is to be laid on levels: bands, pins, rails and openings over the whole motion, and what must lie over what."""

from __future__ import annotations

import cmath
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from camgen.geometry.convex import hull_corners
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour
from camgen.machine.run import Run
from camgen.numerics import Points, coordinates
from camgen.parts.generator.connections import GROUND
from camgen.parts.generator.cures import slimmer, slimmer_pin
from camgen.parts.generator.gears import DowelledWheel
from camgen.parts.generator.genevas import DowelledEdge, GenevaDrive
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.link_outlines import arm_band, link_hubs, own_contours, tip_bar
from camgen.parts.generator.pins import levels_beyond
from camgen.parts.generator.plates import motor_holes
from camgen.parts.generator.ratchets import RatchetDrive
from camgen.parts.generator.wheels import Roller, Wheel
from camgen.parts.level_rules import Axis, Band, Opening, Things, Wall

_COARSE = 0.1  # mm, by which the corners of an own outline's hull may lie off it
_ALL = 99  # levels: more than there are
_PIECES = 4  # of the band of a link with a strap
_CHORDS = 24  # of a ring
_NEARER = "shafts nearer to each other"
Over = list[tuple[str, str]]  # levels, of which the first must lie over the second


def things(layout: Layout, run: Run) -> Things:
    """What is to be laid; run: samples over the whole motion."""
    courses = _Courses(layout, run)
    cams, over_cams = _cams(courses)
    genevas, over_genevas = _genevas(courses)
    springs, over_springs = _springs(courses)
    before = [*over_cams, *over_genevas, *over_springs]
    axes, over_axes = _axes(courses, before)
    walls, over_walls = _walls(courses)
    studs, over_studs = _studs(courses)
    axes += studs
    over = [*before, *over_axes, *over_walls, *over_studs]
    over += [(upper, lower) for lower, upper in pairwise(layout.webs)]
    dowelled = _dowelled(courses)
    collars, over_collars = _collars(courses)
    walls += collars
    over += over_collars
    bands = [*_links(courses), *cams, *_gears(courses), *dowelled, *genevas, *springs]
    openings = _openings(layout, run.theta.size)
    # a ring hangs under its link, a lock stands on it, a ring or sun of the ground on the plate
    stacked = []
    for each in (*layout.dowelled, *layout.pinned):
        link = "" if each.wheel.link == GROUND else each.wheel.link
        if each.lies != "below":
            on_each_other = (link, each.wheel.level)
            stacked.append(on_each_other if each.lies == "under" else on_each_other[::-1])
    stacked += [
        (upper, lower) for drive in layout.cycloid_drives for lower, upper in pairwise(drive.discs)
    ]
    return Things(bands, axes, layout.fits.slide_clearance, walls, over, openings, stacked)


@dataclass(frozen=True)
class _Courses:
    """A layout over its motion."""

    layout: Layout
    run: Run  # samples of all of it

    def ways(self, link: str, places: Sequence[complex]) -> Points:
        """Places of a link on the ground, (k, n)."""
        if link == GROUND:
            return np.array([np.full(self.run.theta.shape, z, complex) for z in places])
        pose = self.run.pose(self.layout.carrier(link))
        return np.asarray(pose.place + np.exp(1j * pose.angle) * np.array(places)[:, None])

    def way(self, link: str, point: str) -> Points:
        """A point of a link on the ground, (n,)."""
        return np.asarray(self.ways(link, [self.layout.at(link, point)])[0])

    def band(self, name: str, link: str, discs: Sequence[tuple[complex, float]], on: str) -> Band:
        """Of a link's discs, on a level."""
        corners = hull_corners([z for z, _ in discs])
        places = self.ways(link, [discs[k][0] for k in corners])
        return Band(name, places, max(radius for _, radius in discs), on)


def _links(courses: _Courses) -> list[Band]:
    """Links, and their faces."""
    layout = courses.layout
    bands: list[Band] = []
    for link in layout.moving:
        if link in layout.alone:
            continue
        arm = None if link in layout.guides else arm_band(layout, link)
        own = own_contours(layout, link)
        discs = layout.guides[link].bands if link in layout.guides else [link_hubs(layout, link)]
        if own:
            discs = [_round_hull(own[0])]
        elif arm is not None:
            reach = arm.width / 2 + arm.sagitta
            discs = [
                *([hub] for hub in link_hubs(layout, link)),
                *([(a, reach), (b, reach)] for a, b in pairwise(arm.middle())),
            ]
        elif len(link_hubs(layout, link)) == 2 and not layout.discs.keys().isdisjoint(
            layout.points_of(link)
        ):
            discs = _tapered(*link_hubs(layout, link))
        slim, move = slimmer(layout, link)
        for each in discs:
            band = courses.band(f"link {link}", link, each, link)
            bands.append(replace(band, slim=slim, move=move, link=link))
        bars = [bar for tip in layout.noses(link) if (bar := tip_bar(layout, tip)) is not None]
        for start, way, half, length, _ in bars:
            ends = [(start, half), (start + length * way, half)]
            face = courses.band(f"face of link {link}", link, ends, link)
            bands.append(replace(face, move=f"other points of link {link}"))
    return bands


def _round_hull(outline: Contour) -> list[tuple[complex, float]]:
    """Few discs in whose band an outline lies."""
    import shapely

    edge = facet_contour(outline, _COARSE)
    hull = shapely.MultiPoint(coordinates(edge)).convex_hull
    corners = shapely.get_coordinates(hull.exterior.simplify(_COARSE))[:-1]
    return [(complex(x, y), 2 * _COARSE) for x, y in corners.tolist()]


def _tapered(
    one: tuple[complex, float], other: tuple[complex, float]
) -> list[list[tuple[complex, float]]]:
    """The band of a link whose hubs differ much, as a strap's do, in pieces that are not all as wide as the wider one."""
    (a, first), (b, second) = sorted((one, other), key=lambda hub: -hub[1])
    ways = np.linspace(0, 1, _PIECES + 1)
    discs = [(complex(a + t * (b - a)), float(first + t * (second - first))) for t in ways]
    slope = (first - second) * (b - a) / abs(b - a) / _PIECES  # a piece ends so much earlier
    return [[one], [other], *([(x, r), (y - slope, r)] for (x, r), (y, _) in pairwise(discs))]


def _cams(courses: _Courses) -> tuple[list[Band], Over]:
    """Cams with their rollers. Under a groove's roller there is the back plate, under one that hangs the head of its pin."""
    layout = courses.layout
    bands: list[Band] = []
    over = Over()
    for tip in layout.tips:
        cam = tip.wheel
        follower = tip.joint.follower
        shaft = layout.shaft_of(cam.link)
        disc = courses.band(cam.about, GROUND, [(layout.at(GROUND, shaft), cam.radius)], tip.level)
        smaller = (
            f"a smaller {cam.about} (points.{tip.point} nearer to its shaft, or a smaller lift)"
        )
        move = f"another place for points.{shaft}"
        bands.append(replace(disc, below=int(tip.grooved), slim=smaller, move=move))
        if tip.rolls:
            bands.append(_rolling(courses, tip.roller))
            above = tip.hung or tip.grooved
            over.append((follower, tip.level) if above else (tip.level, follower))
    for plate in layout.plates:
        bands.append(_rolling(courses, plate.roller))
        over.append((plate.level, plate.joint.follower))
    return bands, over


def _rolling(courses: _Courses, roller: Roller) -> Band:
    rolls = [(courses.layout.at(roller.link, roller.point), roller.radius)]
    band = courses.band(f"roller of {roller.about}", roller.link, rolls, roller.level)
    smaller = f"a smaller radius of the roller of {roller.about}"
    move = f"another place for points.{roller.point}"
    return replace(band, below=int(roller.hung), slim=smaller, move=move)


def _genevas(courses: _Courses) -> tuple[list[Band], Over]:
    """Geneva drives: the roller stands over its crank, on the level of the wheel."""
    layout = courses.layout
    bands = []
    over = Over()
    for drive in layout.drives_of(GenevaDrive):
        bands += [_wheel(courses, wheel, GROUND, _NEARER) for wheel in drive.wheels]
        bands.append(_rolling(courses, drive.roller))
        over.append((drive.level, drive.joint.cam))
    return bands, over


def _wheel(courses: _Courses, wheel: Wheel, on: str, how: str) -> Band:
    """A wheel about its shaft on a link, and how it may become smaller."""
    shaft = courses.layout.shaft_of(wheel.link)
    disc = [(courses.layout.at(on, shaft), wheel.radius)]
    band = courses.band(wheel.about, on, disc, wheel.level)
    smaller = f"a smaller {wheel.about} ({how})"
    return replace(band, slim=smaller, move=f"another place for points.{shaft}")


def _gears(courses: _Courses) -> list[Band]:
    """Wheels of gears, counterweights."""
    layout = courses.layout
    others = [tip.wheel for tip in layout.tips]
    others += [drive.wheels[1] for drive in layout.drives_of(RatchetDrive)]
    bands = [_pawl(courses, drive) for drive in layout.drives_of(RatchetDrive)]
    for wheel in (each for each in layout.wheels if each not in others):
        weighs = wheel in layout.weights
        how = 'counterweight.made = "steel", or a greater thickness' if weighs else _NEARER
        on = wheel.link if wheel.link in layout.planet_pins else GROUND
        bands.append(_wheel(courses, wheel, on, how))
    return bands


def _pawl(courses: _Courses, drive: RatchetDrive) -> Band:
    """The pawl of a ratchet, where it swings."""
    layout = courses.layout
    link = drive.joint.follower
    here = layout.at(link, layout.shaft_of(link))
    arm = drive.arm(layout.machine)
    wheel = drive.wheels[1]
    discs = [(here, drive.hub), (here + arm, drive.pawl.end)]
    band = courses.band(wheel.about, link, discs, wheel.level)
    move = f"another place for points.{layout.shaft_of(link)}"
    return replace(band, slim="a smaller parts.shaft_diameter", move=move)


def _dowelled(courses: _Courses) -> list[Band]:
    """Rings: chords of them, for what moves inside; suns on the ground, locks."""
    layout = courses.layout
    bands = []
    for each in layout.dowelled:
        wheel = each.wheel
        about = f"{_kind(each)} of {wheel.link}"
        smaller = f"a smaller {about} (a shorter distance of its pair's axes)"
        for discs in _chords(layout, each):
            band = courses.band(about, GROUND, discs, wheel.level)
            bands.append(replace(band, slim=smaller))
    return bands


def _kind(dowelled: DowelledWheel | DowelledEdge) -> str:
    """What dowels hold, in messages."""
    if dowelled.within:
        return "ring"
    return "locking crescent" if isinstance(dowelled, DowelledEdge) else "sun"


def _chords(
    layout: Layout, dowelled: DowelledWheel | DowelledEdge
) -> list[list[tuple[complex, float]]]:
    """Discs on the ground in whose bands a ring is, one band a chord of it; the disc that a sun or a lock is in."""
    at = layout.at(GROUND, layout.axis_of_wheel(dowelled.wheel))
    if not dowelled.within:
        return [[(at, dowelled.outside)]]
    half = (dowelled.outside - dowelled.within) / 2
    middle = dowelled.within + half
    radius = half + middle * (1 - math.cos(math.pi / _CHORDS))
    ends = [(at + cmath.rect(middle, math.tau * k / _CHORDS), radius) for k in range(_CHORDS + 1)]
    return [list(pair) for pair in pairwise(ends)]


def _collars(courses: _Courses) -> tuple[list[Wall], Over]:
    """Rings that go up past a carrier or a pin's head to their links."""
    layout = courses.layout
    walls = []
    over = Over()
    for each in (each for each in layout.dowelled if each.lies == "below"):
        wheel = each.wheel
        order = [name for name in (wheel.link, each.between, wheel.level) if name]
        over += [*pairwise(order)]
        name = f"ring of {wheel.link}"
        for discs in _chords(layout, each):
            corners = courses.ways(GROUND, [z for z, _ in discs])
            walls.append(Wall(name, corners, discs[0][1], wheel.link, wheel.level))
    return walls, over


def _springs(courses: _Courses) -> tuple[list[Band], Over]:
    """Springs: over all else on their pins."""
    layout = courses.layout
    bands = []
    over = Over()
    for name, spring in layout.springs.items():
        ends = np.array([courses.way(*end) for end in (spring.a, spring.b)])
        below = layout.below(spring)
        places = [f"points.{point}" for _, point in (spring.a, spring.b)]
        move = f"another place for {spring.key or ' or '.join(places)}"
        band = Band(name, ends, spring.diameter / 2, below=below, slim="a thinner spring")
        bands.append(replace(band, move=move))
        for _, point in (spring.a, spring.b):
            beside = (*layout.pivots[point], *layout.riders[point])
            over += [(name, other) for other in beside if other not in (GROUND, name)]
    return bands, over


def _axes(courses: _Courses, before: Over) -> tuple[list[Axis], Over]:
    """Pins and shafts; before: what is known to lie over what."""
    layout = courses.layout
    found = list[Axis]()
    over = Over()
    for point, links in layout.pivots.items():
        moving = tuple(link for link in links if link != GROUND)
        shaft = layout.shafts.get(point)
        moving = tuple(dict.fromkeys(layout.alone.get(link, link) for link in moving))
        hanging = (
            tuple(link for link in moving if link in layout.webs and link != shaft)
            if shaft is not None
            else ()
        )
        if point in layout.eccentrics:  # it begins over the one beneath
            moving = tuple(link for link in moving if link != layout.discs[point][0])
        held = (*moving, *layout.riders.get(point, ()))
        known = {*before, *over}
        over += _over_on_pin(layout, point, moving, hanging, known)
        strapped = _strapped(layout, point)
        if point in layout.discs:
            carrier = layout.discs[point][0]
            over += [(link, carrier) for link in moving if carrier not in (link, GROUND)]
        over += [(rider, link) for rider in layout.riders.get(point, ()) for link in strapped]
        held = (*held, *strapped)
        runs = layout.slotted_link(point) == GROUND
        found.append(
            Axis(
                f"{'pin' if shaft is None else 'shaft'} {point}",
                held,
                courses.way(links[0], point),
                layout.head_radius(point),
                links[0] == GROUND or runs,
                *levels_beyond(layout, point),
                *slimmer_pin(layout, point),
                layout.between_plates(point),
                () if shaft is None else tuple(link for link in held if link not in hanging),
                hanging,
                runs,
                f"shaft {layout.discs[point][1]}" if point in layout.discs else "",
                point,
                shaft is not None,
            )
        )
    for point, link in layout.thread_posts.items():
        if link != GROUND:  # those of the ground pass all levels, whichever order these have
            name = f"post {point}"
            half = layout.sizes.thread_post_sizes.diameter_at(point) / 2
            found.append(
                Axis(name, (link,), courses.way(link, point), half, over=_ALL, point=point)
            )
    return found, over


def _studs(courses: _Courses) -> tuple[list[Axis], Over]:
    """Pins of cycloidal drives: those of the ground go up to the disc, those of the output, which lies over it, down to it."""
    layout = courses.layout
    axes = []
    over = Over()
    for drive in layout.cycloid_drives:
        over += [(upper, lower) for lower, upper in pairwise(drive.discs)]
        over += [] if drive.wish.output is None else [(drive.wish.output, drive.discs[-1])]
        for k, stud in enumerate(drive.studs, 1):
            grounded = stud.link == GROUND
            held = drive.discs if grounded else (stud.link, *drive.discs)
            way = courses.ways(stud.link, [stud.at])[0]
            name = f"{stud.part} {k}"
            axes.append(Axis(name, held, way, stud.radius, grounded, over=0))
    return axes, over


def _strapped(layout: Layout, point: str) -> list[str]:
    """Links at the eccentrics on the shaft of a point, but for what it turns."""
    links = [link for disc in layout.discs_on(point) for link in layout.pivots[disc]]
    return [link for link in dict.fromkeys(links) if link not in (GROUND, layout.shafts.get(point))]


def _over_on_pin(
    layout: Layout,
    point: str,
    moving: Sequence[str],
    hanging: Sequence[str],
    known: Collection[tuple[str, str]],
) -> Over:
    """What must lie over what on a pin or shaft.

    moving: levels of its links; hanging: of those that hang from above; known: what is known already.
    """
    shaft = layout.shafts.get(point)
    webs = layout.webs_at(point)
    over = Over()
    upper = layout.alone.get(shaft or "", shaft) or (*moving[-1:], GROUND)[0]
    above = layout.over_shafts.get(point, ())
    over += [(link, upper) for link in above]
    if shaft is not None or (layout.slotted_link(point) not in ("", GROUND) and not webs):
        over += [(upper, link) for link in moving if link not in (upper, *hanging, *above)]
    held = (*moving, *layout.riders.get(point, ()))
    # the shaft is round below and there alone
    loose = [layout.alone[link] for link in layout.freewheels if link in layout.pivots[point]]
    for level in loose:
        pairs = [(name, level) for name in held if name != level]
        over += [pair for pair in pairs if pair not in (*known, *over)]
    if shaft is not None and layout.webs.get(shaft):
        over += [(shaft, rider) for rider in layout.riders.get(point, ())]
    elif webs:  # what turns on a throw, or runs on it, lies between its webs
        low, *high = webs
        between = [link for link in held if link not in layout.webs]
        over += [(link, low) for link in between]
        over += [(web, link) for web in high for link in between]
    return over


def _walls(courses: _Courses) -> tuple[list[Wall], Over]:
    """Rails and covers of what slides."""
    layout = courses.layout
    walls = []
    over = Over()
    for link, each in layout.guides.items():
        on = each.joint.guide.body
        base = "" if on == GROUND else on
        move = "another line of the slide"
        if each.covered and layout.cover is not None:
            cover = layout.cover
            for pair in each.pairs:
                screws = cover.places(pair, layout.sizes.rail_width)
                corners = courses.ways(on, [screws[k] for k in hull_corners(screws)])
                cures = ("parts.cover = false", move)
                name = f"cover of {link}"
                walls.append(Wall(name, corners, cover.radius, link, base, cover.levels, *cures))
        else:
            half = layout.sizes.rail_width / 2
            slim = "a smaller parts.rail_width"
            for ends in each.rails:
                rail = courses.ways(on, ends)
                walls.append(Wall(f"rail of {link}", rail, half, link, base, 0, slim, move))
        if base:
            over.append((link, base))
    return walls, over


def _openings(layout: Layout, count: int) -> list[Opening]:
    """Slots and other wide holes of the ground, at so many samples."""
    openings = []
    for point, ends in layout.slots_of(GROUND).items():
        corners = np.repeat(np.array(ends)[:, None], count, axis=1)
        half = layout.slot_width(point) / 2 + layout.min_wall / 2
        move = f"another line of the slot of points.{point}"
        name = f"slot of pin {point}"
        openings.append(Opening(name, corners, half, f"pin {point}", move=move))
    for motor, z, radius in motor_holes(layout):
        centre = np.full((1, count), z)
        half = radius + layout.min_wall / 2
        move = f"another place for points.{motor}"
        openings.append(Opening("hole for the motor", centre, half, f"shaft {motor}", move=move))
    return openings
