"""What is wrong between the tables of a disc cam that are right one by one."""

from __future__ import annotations

from collections.abc import Iterator

from camgen.errors import Fault
from camgen.machines.disc_cam.tables import (
    DiscCamGeometry,
    DiscCamParts,
    FollowerTable,
)
from camgen.machines.linkage import sheets
from camgen.parts import materials
from camgen.parts.catalogue import CAM_FOLLOWERS
from camgen.parts.generator.sizes import contour_faults
from camgen.tolerances import SAME_POINT


def follower_faults(f: FollowerTable) -> Iterator[Fault]:
    """Keys of geometry.follower that its motion and shape need and that are missing, or that mean nothing there."""
    slides = not f.swings
    flat = f.shape == "flat"
    drawn = f.shape == "outline"
    pointed = not flat and not drawn
    # key, whether it belongs here, whether it is needed then, what a message says
    for key, belongs, needed, what in (
        ("radius", f.shape == "roller", True, "a roller has a radius"),
        ("offset", slides, False, "a translating follower has an offset"),
        ("pivot_distance", not slides, True, "an oscillating follower has a pivot"),
        (
            "arm",
            not slides and pointed,
            True,
            "an oscillating roller or knife edge has an arm",
        ),
        (
            "outline",
            drawn and f.contours is None,
            True,
            'shape "outline" has an SVG or DXF beside the spec',
        ),
        ("contours", drawn, False, 'shape "outline" has contours'),
        (
            "face_offset",
            flat and not slides,
            False,
            "the flat face of an oscillating follower has it",
        ),
        ("face_width", flat, False, "a flat face has a width"),
    ):
        value = getattr(f, key)
        typed = "outline" if key == "contours" and f.drawn_in else key  # what was read from it
        place = ("geometry", "follower", typed)
        if belongs and needed and value is None:
            yield Fault(place, "", f"missing: {what}")
        elif not belongs and value:
            shown = f"{value:g}" if isinstance(value, float) else ""
            yield Fault(place, shown, f"no value here: only {what}")
    yield from contour_faults(("geometry", "follower", "contours"), f.contours or ())


def closure_faults(geometry: DiscCamGeometry, make: str) -> Iterator[Fault]:
    """Closures and kinds of making that do not go with the follower or with each other."""
    f = geometry.follower
    closure = geometry.closure
    place = ("geometry", "closure")
    if closure == "groove" and f.shape != "roller":
        yield Fault(place, closure, "force or conjugate: only rollers run in grooves")
    if f.shape == "outline" and closure != "force":
        right = "force: a follower with an outline of your own has one cam"
        yield Fault(place, closure, right)
    if f.shape == "outline" and make != "cams":
        right = '"cams": a cam and its shoe; for a machine make the follower a link with parts.LINK.outline'
        yield Fault(("parts", "make"), make, right)
    if make != "laser":
        return
    beside = "with parts.make = 'laser'"
    if not f.swings:
        right = f'"oscillating", or parts.make = "cams", the cam alone: {sheets.NO_RAILS}'
        yield Fault(("geometry", "follower", "motion"), f"{f.motion!r} {beside}", right)
    if closure == "groove":
        right = f'"force" or "conjugate": {sheets.NO_BACK}'
        yield Fault(place, f"{closure!r} {beside}", right)


def key_screw_faults(p: DiscCamParts, material: str) -> Iterator[Fault]:
    """A set screw on a key of what is printed, in which no thread holds."""
    if p.key_screw is not None and not materials.of(material).metal:
        right = (
            f'no value here: on a key its thread is cut in metal, not in {material}; parts.bore_shape = "d-flat" or "plain" has one '
            "with its nut"
        )
        yield Fault(("parts", "set_screw"), repr(p.set_screw), right)


def hub_faults(p: DiscCamParts, closure: str, wall: float) -> Iterator[Fault]:
    """Sizes of hub and pin of cams alone that leave no material; wall: the least, mm."""
    # a bore that is wrong by itself asks for no hub
    round_hub = 0.0 if p.misfits() else 2 * (p.reach + wall)
    if p.hub_height and p.hub_diameter < round_hub:
        usual = {key: field.default for key, field in type(p).model_fields.items()}
        if p.hub_diameter == usual["hub_diameter"] and p.bore != usual["bore"]:
            most = p.bore - (round_hub - p.hub_diameter)
            right = (
                f"at most {most:.4g} mm, by limits.min_wall in a hub of parts.hub_diameter = "
                f"{p.hub_diameter:g}; or parts.hub_diameter = {round_hub:.4g} or more"
            )
            yield Fault(("parts", "bore"), f"{p.bore:g}", right)
        else:
            right = f"at least {round_hub:.4g} mm: limits.min_wall round parts.bore = {p.bore:g}"
            yield Fault(("parts", "hub_diameter"), f"{p.hub_diameter:g}", right)
    if p.hub_height and closure == "groove":
        right = "0: a groove's plates have no hub"
        yield Fault(("parts", "hub_height"), f"{p.hub_height:g}", right)
    if p.pin_diameter >= p.rim:
        right = f"less than the rim, {p.rim:g} mm"
        yield Fault(("parts", "pin_diameter"), f"{p.pin_diameter:g}", right)


def bought_faults(name: str, radius: float, path: tuple[str, ...]) -> Iterator[Fault]:
    """A bought cam follower of another size than the roller for which the cam is made, mm; path: of that roller's radius."""
    right = CAM_FOLLOWERS[name].outside / 2
    if abs(right - radius) <= SAME_POINT:
        return
    doubled = abs(right - radius / 2) <= SAME_POINT
    why = f"{radius:g} is its diameter" if doubled else "half of its diameter"
    expected = f"{right:g}, as load.cam_follower = {name!r}: {why}"
    yield Fault(path, f"{radius:g}", expected)
