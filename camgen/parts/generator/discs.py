"""What turns on the shafts of a linkage as parts: the discs of cams with their rollers, wheels of gears, eccentrics.

eccentric    a pin that is a disc round the shaft of its link, of one piece with that; the strap of another link turns on it
keeper       what lies on the disc, as a head on a pin, on the same shaft
pivot        a pin that is a disc of the ground, on two dowels, in which a shaft turns; the shaft's link lies on it
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Contour, Region, circle
from camgen.machine.features import Mount
from camgen.parts.catalogue import TURNED, dowel
from camgen.parts.disc_cams import CamParts as Disc
from camgen.parts.disc_cams import disc_parts
from camgen.parts.gears import table, windows
from camgen.parts.generator.dowels import (
    disc_dowels,
    dowel_places,
    dowel_span,
    dowelled_span,
    stud_span,
)
from camgen.parts.generator.gears import DowelledWheel, GearWheel
from camgen.parts.generator.genevas import DowelledEdge, GenevaDrive
from camgen.parts.generator.layout import GROUND, Layout, pivot_name
from camgen.parts.generator.pins import MountedPart
from camgen.parts.generator.wheels import (
    EdgeDrive,
    Roller,
    Tip,
    groove_rim,
    groove_wall,
    naming,
    outline,
)
from camgen.parts.hardware import plate, spacer
from camgen.parts.part import GREASED, HoldingNote, Layer, Part, rod
from camgen.parts.wheels import involute
from camgen.tolerances import SAME_POINT

_SUNK = 2.0  # mm, by which a dowel that is sold may end below the upper side of what it holds


class _Disc(Disc):
    """A disc whose bore is turned by so much, rad: its flat fits the shaft of a link that does not lie level."""

    turn: float = 0.0

    def hole(self) -> Contour:
        """The bore."""
        return super().hole().moved(cmath.exp(1j * self.turn))


def cam_parts(layout: Layout, tip: Tip) -> Iterator[MountedPart]:
    """A cam on its link's shaft, and the roller that runs on it."""
    link = tip.joint.cam
    at = layout.at(link, layout.shaft_of(link))
    turned = float(np.angle(tip.turn))
    floor = layout.floor(layout.level[tip.level])
    said = (
        f"drawn at theta = 0, level {layout.level[tip.level]}",
        f"{layout.on_shaft} on the shaft of {link}",
    )
    for part, under, place in _discs(layout, tip):
        part = replace(
            part,
            name=part.name.replace("cam", f"cam-{tip.name}", 1),
        )
        yield (
            replace(part, notes=(*said, *part.notes)),
            Mount(part.name, link, at + place * tip.turn, turned, z=floor - under),
        )
    if tip.rolls:
        yield roller_part(layout, tip.roller)


def roller_part(layout: Layout, roller: Roller) -> MountedPart:
    """A ring on its pin."""
    hole = layout.turning(roller.point) + layout.fits.running_clearance
    low, high = layout.roller_span(roller)
    thick = round(high - low, 9)
    part = spacer(roller.part, "Roller", hole, 2 * roller.radius, thick, layout.min_wall)
    part = replace(part, notes=(HoldingNote(GREASED),)) if layout.metal else part
    return part, Mount(part.name, roller.link, layout.at(roller.link, roller.point), z=low)


def _discs(layout: Layout, tip: Tip) -> Iterator[tuple[Part, float, complex]]:
    """The parts of a cam as drawn at theta = 0, how far the underside of each lies under the level's floor, and where, mm."""
    s = layout.sizes
    play = layout.fits.slide_clearance
    press = layout.fits.press_clearance
    thick = layout.wheel_thickness(tip.joint.cam)
    made = _Disc(
        turn=float(-np.angle(tip.turn)),
        thickness=thick,
        bore=s.shaft_diameter + press,
        bore_shape="keyway" if s.shaft_key else "d-flat",
        flat_depth=s.shaft_flat,
        pin_diameter=s.pin_diameter,
        rim=groove_rim(s),
        back=s.thickness + play,
    )
    edge = outline(tip)
    wall = groove_wall(tip, play)
    name = f"cam {tip.joint.name}"
    with naming(
        name, "draw the follower further from the shaft; of a disc cam: a larger base_radius"
    ):
        parts = disc_parts(
            made, [edge], wall, (2 * tip.radius + play, 2 * tip.radius), layout.min_wall
        )
    if wall is None:
        yield replace(parts[0], notes=()), 0.0, 0j
        return
    for part in parts:
        said = "its 2 pins near the shaft hold the inner wall, the 4 near the rim the outer one"
        part = replace(part, notes=(HoldingNote(said),) if part.name == "back" else ())
        yield replace(part, name=f"cam-{part.name}"), made.back if part.name == "back" else 0.0, 0j
        how = TURNED if s.pin in ("turned", "dowel") else "printed"
        pin = rod("cam-pin", "Pin of the groove cam", s.pin_diameter, made.back + thick)
        pin = replace(pin, process=how)
        yield from ((pin, made.back, place) for place in part.centres[1:] if part.name != "back")


def gear_parts(layout: Layout) -> Iterator[MountedPart]:
    """Wheels of gears on their links' shafts, planets on their pins, all of a set one part; rings and suns on their dowels."""
    on_dowels = {each.wheel: each for each in layout.dowelled_wheels}
    made: dict[str, Part] = {}
    for wheel in layout.gear_wheels:
        if wheel in on_dowels:
            yield from dowelled_parts(layout, on_dowels[wheel])
            continue
        if wheel.part not in made:
            made[wheel.part] = gear_part(layout, wheel)
        start = float(layout.machine.start_of(wheel.link).angle)
        at = layout.at(wheel.link, layout.shaft_of(wheel.link))
        floor = layout.floor(layout.level[wheel.level])
        mount = Mount(wheel.part, wheel.link, at, wheel.turned - start, z=floor)
        yield made[wheel.part], mount


def gear_part(layout: Layout, wheel: GearWheel) -> Part:
    """A gear's wheel as drawn at theta = 0; a planet in its own frame."""
    gear = wheel.gear
    assert isinstance(gear, involute.Wheel), "a ring is made by dowelled_parts"
    sizes = layout.sizes
    start = float(layout.machine.start_of(wheel.link).angle)
    edge = gear.outline().moved(cmath.exp(1j * wheel.tooth))
    bore, wide, held = _wheel_bore(layout, wheel.link, start)
    hub = wide + 2 * sizes.wall
    openings = windows(gear, wheel.spokes, hub, max(sizes.wall, gear.module))
    holes = {"bore": bore} | {f"window {k + 1}": each for k, each in enumerate(openings)}
    planet = wheel.link in layout.planet_pins
    title = f"Planet wheel of {wheel.level}" if planet else f"Wheel of {wheel.link}"
    region = plate(title[0].lower() + title[1:], edge, holes, layout.min_wall)
    level = f"level {layout.level[wheel.level]}"
    notes = (
        f"a tooth on the x axis, {level}" if planet else f"drawn at theta = 0, {level}",
        held,
        *table(wheel.mesh, gear),
    )
    layer = Layer(region, 0.0, layout.wheel_thickness(wheel.link))
    return Part(
        wheel.part,
        title,
        (layer,),
        centres=(0j,),
        notes=notes,
        bore=wide,
        min_wall=layout.min_wall,
    )


def _wheel_bore(layout: Layout, link: str, start: float) -> tuple[Contour, float, str]:
    """The bore of a wheel, its width, mm, and how it is held; start: angle of its link as drawn, rad."""
    sizes = layout.sizes
    press = layout.fits.press_clearance
    if link in layout.freewheels:
        on, clutch = layout.freewheels[link]
        wide = clutch.outside + press
        held = f"turns on the shaft of {on}, a one-way clutch {clutch.name} pressed in"
        return circle(0j, wide / 2), wide, held
    point = layout.shaft_of(link)
    if layout.shafts.get(point) == link:
        wide = sizes.shaft_diameter + press
        bore = sizes.shaft_bore(press).moved(cmath.exp(1j * start))
        return bore, wide, f"{layout.on_shaft} on the shaft of {link}"
    wide = layout.hole(point, link)
    fixed = layout.pressed_in(point) == link
    on = "its pin" if link in layout.planet_pins else f"the shaft at {point}"
    held = f"pressed and glued on {on}" if fixed else f"turns on {on}"
    return circle(0j, wide / 2), wide, held


def _dowelled_region(layout: Layout, dowelled: DowelledWheel | DowelledEdge, name: str) -> Region:
    """A ring, a sun or a lock as drawn at theta = 0."""
    hole = (layout.sizes.pin_diameter + layout.fits.press_clearance) / 2
    holes = {f"dowel {k}": circle(z, hole) for k, z in enumerate(dowelled.dowels, 1)}
    if isinstance(dowelled, DowelledEdge):
        if not dowelled.within:
            return plate(name, dowelled.edge, holes, layout.min_wall)
        holes["opening"] = dowelled.edge
        return plate(name, circle(0j, dowelled.outside), holes, layout.min_wall)
    wheel = dowelled.wheel
    gear = wheel.gear
    if isinstance(gear, involute.Ring):
        edge = circle(0j, dowelled.edge)
        tooth = wheel.tooth + gear.pitch / 2
        holes["teeth"] = gear.outline().moved(cmath.exp(1j * tooth))
    else:
        edge = gear.outline().moved(cmath.exp(1j * wheel.tooth))
        holes["bore"] = circle(0j, dowelled.edge)
    return plate(name, edge, holes, layout.min_wall)


def dowelled_parts(layout: Layout, dowelled: DowelledWheel | DowelledEdge) -> Iterator[MountedPart]:
    """A ring as drawn at theta = 0, a sun or a lock, and the dowels that hold it on its link."""
    wheel = dowelled.wheel
    link = wheel.link
    start = float(layout.machine.start_of(link).angle)
    locks = isinstance(dowelled, DowelledEdge)
    kind = "ring" if dowelled.within else "locking crescent" if locks else "sun"
    above = "which lies under it" if dowelled.lies == "over" else "which lies over it"
    on = "the ground plate" if link == GROUND else f"link {link}, {above}"
    region = _dowelled_region(layout, dowelled, f"{kind} of {link}")
    low, thick = dowelled_span(layout, dowelled)
    count = {2: "two", 3: "three"}[len(dowelled.dowels)]
    rows = () if isinstance(dowelled, DowelledEdge) else table(dowelled.wheel.mesh, dowelled.gear)
    part = Part(
        dowelled.part,
        f"{kind.capitalize()} of {'the ground' if link == GROUND else link}",
        (Layer(region, 0.0, thick),),
        centres=(0j, *dowelled.dowels),
        notes=(
            f"drawn at theta = 0, level {layout.level[wheel.level]}",
            f"{count} dowels hold it on {on}, pressed and glued",
            *rows,
        ),
        min_wall=layout.min_wall,
    )
    at = layout.at(link, layout.axis_of_wheel(wheel))
    yield part, Mount(part.name, link, at, -start, z=low)
    yield from _dowels(layout, dowelled, f"the {part.title.lower()}")


def _dowels(
    layout: Layout, dowelled: DowelledWheel | DowelledEdge, held_one: str
) -> Iterator[MountedPart]:
    """The dowels of what they hold on its link; held_one: that, in words. One that is sold ends below its upper side."""
    sizes = layout.sizes
    link = dowelled.wheel.link
    bottom, top = dowel_span(layout, dowelled)
    length = round(top - bottom, 9)
    held = "pressed and glued in"
    made = "printed" if sizes.pin == "printed" else TURNED
    sold = dowel(sizes.pin_diameter, length) if sizes.pin == "dowel" else 0.0
    if sold and sold >= length - _SUNK:
        length = sold
        held = f"dowel {layout.dowels}, {sizes.pin_diameter:g} m6 x {sold:g}, {held}"
        made = "bought"
    name = f"dowel-{dowelled.part}"
    part = rod(name, f"Dowel of {held_one}", sizes.pin_diameter, length)
    part = replace(part, notes=(held,), process=made)
    yield from ((part, Mount(name, link, z, z=bottom)) for z in dowel_places(layout, dowelled))


def edge_parts(layout: Layout, drive: EdgeDrive) -> Iterator[MountedPart]:
    """What drives and what is driven by its edge, each on its link's shaft; of a Geneva drive the roller too."""
    if isinstance(drive, GenevaDrive) and drive.inner:
        yield from _inner_geneva(layout, drive)
    else:
        for link, edge in zip(drive.links, drive.edges(layout.machine), strict=True):
            yield from _on_shaft(layout, link, drive, edge)
    if isinstance(drive, GenevaDrive):
        yield roller_part(layout, drive.roller)


def _inner_geneva(layout: Layout, drive: GenevaDrive) -> Iterator[MountedPart]:
    """Wheel and lock of an inner Geneva drive, with their dowels."""
    ours = {drive.lock, drive.slotted}
    slotted = drive.joint.follower
    with naming(drive.thing, drive.remedy):
        for each in (each for each in layout.dowelled if each.wheel in ours):
            for part, mount in dowelled_parts(layout, each):
                rows = drive.table(slotted) if part.name == drive.part_on(slotted) else ()
                yield replace(part, notes=(*part.notes, *rows)), mount


def _on_shaft(layout: Layout, link: str, drive: EdgeDrive, edge: Contour) -> Iterator[MountedPart]:
    """A plate on the shaft of one of its links; of one that stands on its link the dowel too."""
    wheel = next(each for each in drive.wheels if each.link == link)
    name = drive.part_on(link)
    sizes = layout.sizes
    start = float(layout.machine.start_of(link).angle)
    press = layout.fits.press_clearance
    wide = sizes.shaft_diameter + press
    holes = {"bore": sizes.shaft_bore(press).moved(cmath.exp(1j * start))}
    level = layout.level[drive.level]
    low = layout.floor(level)
    thick = layout.wheel_thickness(link)
    held = f"{layout.on_shaft} on the shaft of {link}"
    pinned = next((each for each in layout.pinned if each.part == name), None)
    if pinned:
        (dowel_at,) = pinned.dowels
        hole = (sizes.pin_diameter + press) / 2
        holes = {"bore": circle(0j, wide / 2), "dowel": circle(dowel_at, hole)}
        low, thick = dowelled_span(layout, pinned)
        held = f"glued on the shaft of {link}, down on {link}: a dowel holds it there"
        if layout.metal:
            rod_size = f"{sizes.shaft_diameter:g}"
            held += f"; drill its hole with that of {link} in one go, both on a rod of {rod_size}, then ream each"
    with naming(drive.thing, drive.remedy):
        region = plate(wheel.about, edge, holes, layout.min_wall)
    notes = (f"drawn at theta = 0, level {level}", held, *drive.table(link))
    part = Part(
        name,
        wheel.about[:1].upper() + wheel.about[1:],
        (Layer(region, 0.0, thick),),
        centres=(0j, *(pinned.dowels if pinned else ())),
        notes=notes,
        bore=wide,
        min_wall=layout.min_wall,
        role="lock" if pinned else "",
    )
    at = layout.at(link, layout.shaft_of(link))
    yield part, Mount(name, link, at, -start, z=low)
    if pinned:
        yield from _dowels(layout, pinned, link)


def cycloid_pins(layout: Layout) -> Iterator[MountedPart]:
    """Pins of the ground round cycloidal discs, and those of outputs in their holes."""
    made = "printed" if layout.sizes.pin == "printed" else TURNED
    for stud in (stud for drive in layout.cycloid_drives for stud in drive.studs):
        low, high = stud_span(layout, stud)
        part = rod(stud.part, stud.title, 2 * stud.radius, round(high - low, 9))
        grounded = stud.link == GROUND
        on = "the ground plate" if grounded else f"link {stud.link}, from above"
        part = replace(part, notes=(f"pressed and glued into {on}",), process=made)
        yield part, Mount(stud.part, stud.link, stud.at, z=low, flipped=not grounded)


def shaft_cap(layout: Layout, point: str) -> MountedPart:
    """What holds links that turn on a shaft over all that is fixed on it."""
    link = layout.shafts[point]
    bore = layout.sizes.shaft_bore(layout.fits.press_clearance)
    rim = circle(0j, layout.head_radius(point))
    over = " and ".join(layout.over_shafts[point])
    name = f"cap-{link}"
    part = Part(
        name,
        f"Cap of the shaft of {link}",
        (Layer(plate("cap", rim, {"shaft": bore}, layout.min_wall), 0.0, layout.sizes.head),),
        centres=(0j,),
        min_wall=layout.min_wall,
        notes=(HoldingNote(f"glued on the shaft over {over}"),),
    )
    low = layout.on(point)[-1][1]
    return part, Mount(name, layout.carrier(link), layout.at(link, point), z=low)


def wall_of_disc(off: float, wide: float, bore: float, min_wall: float, key: str) -> None:
    """DesignError where a disc has no wall beside its bore, whose centre is so far off; diameters mm."""
    thin = (wide - bore) / 2 - off
    if thin < min_wall - SAME_POINT:
        works = 2 * (min_wall + off) + bore
        raise DesignError(
            "MIN_WALL of the eccentric disc",
            thin,
            min_wall,
            "mm",
            "the thin side of its bore",
            f"D/2 - e - d/2 must reach it: {key} of {works:g} mm or more works",
        )


def disc_layer(layout: Layout, point: str) -> Layer:
    """A pin that is a disc round the shaft of its link, over that link's body."""
    link, shaft = layout.discs[point]
    bore = _bore(layout, link, shaft).moved(1, layout.at(link, shaft))
    off = abs(layout.at(link, point) - layout.at(link, shaft))
    sizes = layout.turning(point), layout.hole(shaft, link), layout.min_wall
    wall_of_disc(off, *sizes, f"parts.discs.{point}")
    rim = circle(layout.at(link, point), layout.turning(point) / 2)
    top = layout.disc_top(point) - layout.floor(layout.level[link])
    return Layer(Region(rim, (bore,)), layout.thickness(link), round(top, 9))


def round_shaft(layout: Layout, point: str) -> Iterator[MountedPart]:
    """What a pin that is a disc has beside the body of its link."""
    if layout.on_ground(point):
        yield from ground_disc(layout, point)
        return
    if point in layout.eccentrics:
        yield eccentric(layout, point)
    if point not in layout.eccentrics.values():
        yield keeper(layout, point)


def eccentric(layout: Layout, point: str) -> MountedPart:
    """An eccentric over another one, pressed on the same shaft; it holds down what turns on that."""
    link, shaft = layout.discs[point]
    off = layout.at(link, point) - layout.at(link, shaft)
    sizes = layout.turning(point), layout.hole(shaft, link), layout.min_wall
    lower = layout.eccentrics[point]
    wall_of_disc(abs(off), *sizes, f"parts.discs.{lower}")
    low = layout.disc_top(lower)
    rim = circle(off, layout.turning(point) / 2)
    region = plate("eccentric", rim, {"shaft": _bore(layout, link, shaft)}, layout.min_wall)
    name = eccentric_name(layout, point)
    part = Part(
        name,
        f"Second eccentric of {link}",
        (Layer(region, 0.0, round(layout.disc_top(point) - low, 9)),),
        centres=(0j, off),
        min_wall=layout.min_wall,
        notes=(HoldingNote(f"glued on the shaft over {_turning_on(layout, lower)}"),),
    )
    return part, Mount(name, layout.carrier(link), layout.at(link, shaft), z=low)


def eccentric_name(layout: Layout, point: str) -> str:
    """Name of the part that an eccentric over another one is."""
    return f"eccentric-{_turning_on(layout, point)}"


def _turning_on(layout: Layout, point: str) -> str:
    """The link that turns on an eccentric."""
    return next(link for link in layout.pivots[point] if link != layout.discs[point][0])


def ground_disc(layout: Layout, point: str) -> Iterator[MountedPart]:
    """A disc of the ground, and the dowels that hold it on the plate."""
    s = layout.sizes
    _, shaft = layout.discs[point]
    at = layout.at(GROUND, point)
    wide = layout.turning(point)
    bore = layout.hole(shaft, GROUND)
    off = layout.at(GROUND, shaft) - at
    wall_of_disc(abs(off), wide, bore, layout.min_wall, f"parts.discs.{point}")
    name = pivot_name(point)
    dowels = disc_dowels(layout, point)
    holes = {"shaft": circle(off, bore / 2)}
    holes |= {f"dowel {k}": circle(z - at, radius) for k, (z, radius) in enumerate(dowels, 1)}
    high = round(layout.disc_top(point) - s.base_thickness, 9)
    part = Part(
        name,
        f"Pivot {point} of the ground",
        (Layer(plate(name, circle(0j, wide / 2), holes, layout.min_wall), 0.0, high),),
        centres=(0j, off),
        notes=("two dowels hold it on the plate; the shaft passes it",),
        min_wall=layout.min_wall,
    )
    yield part, Mount(name, GROUND, at, z=s.base_thickness)
    made = "printed" if s.pin == "printed" else TURNED
    dowel = rod("dowel", "Dowel", s.pin_diameter, high + s.base_thickness)
    dowel = replace(dowel, notes=("pressed and glued in",), process=made)
    yield from ((dowel, Mount("dowel", GROUND, z)) for z, _ in dowels)


def keeper(layout: Layout, point: str) -> MountedPart:
    """What keeps a link on a disc."""
    link, shaft = layout.discs[point]
    at = layout.at(link, shaft)
    rim = circle(layout.at(link, point) - at, layout.head_radius(point))
    region = plate("keeper", rim, {"shaft": _bore(layout, link, shaft)}, layout.min_wall)
    part = Part(
        "keeper",
        "Keeper of a disc",
        (Layer(region, 0.0, layout.sizes.head),),
        centres=(0j,),
        min_wall=layout.min_wall,
        notes=(HoldingNote(f"glued on the shaft over {link}, in line with its disc"),),
        role="keeper",
    )
    return part, Mount(part.name, layout.carrier(link), at, z=layout.disc_top(point))


def _bore(layout: Layout, link: str, shaft: str) -> Contour:
    """A link's hole for its shaft, about its centre."""
    flat = layout.profile(shaft, link)
    return circle(0j, layout.hole(shaft, link) / 2) if flat is None else flat
