"""Sizes of a metal cam or drum, and walls of all that is of metal, that its spec leaves open, by camgen's own rules: no standard has them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeGuard

from camgen.machines.cylinder_cam.tables import DrumRollerTable
from camgen.parts import materials
from camgen.parts.catalogue import CAM_FOLLOWERS, DOWELS, SCREWS, Bought
from camgen.parts.disc_cams import CamParts, ShaftBore
from camgen.parts.keyways import keyway
from camgen.parts.motors import SHAFTS, STEPPERS
from camgen.parts.shafts import Seat, retaining_rings, shaft_and_bearings

_WALL = 1.0  # mm, least wall
_CASES = 4.0  # depths of a hardened case: least wall, half of which stays tough
_FACE = 0.6  # of the bore: least thickness
_HUB = 1.8  # of the bore: diameter
_SCREWED = 2.4  # diameters of its set screw: least height of a hub
_END = 3.0  # mm, walls of a drum of any material
_RIM_OF_DEPTH = 0.5  # of the depth of its track: walls of a drum
HEAD_CLEARANCE = 0.4  # mm, between the head of a bought roller and the floor of its track
_GROOVE = 0.05  # mm, by which a milled groove is wider than its roller
_BACK = 0.5  # of the thickness: back plate of a groove; its dowels at least
_LOOSE = 0.6  # mm, by which screws are loose in the rim
_RIM = 2.5  # dowels: width of a groove's rim
_BESIDE = 0.7  # of a bore: from its axis to the wall beside its keyway


def with_walls(data: Any, hardened: bool) -> Any:
    """A spec's tables with the least wall of parts of metal where they leave it open and name a metal: 1 mm.

    hardened: whether it is a cam or drum, of which a case is hardened where followers run; alone it has at least four of its
    depths, in a whole machine walls as its links.
    """
    if not isinstance(data, dict):
        return data
    material = data.get("material")
    name = material.get("name") if isinstance(material, dict) else None
    limits = data.get("limits", {})
    if name is None or not isinstance(limits, dict) or not _is_metal(name):
        return data
    parts = data.get("parts", {})
    alone = isinstance(parts, dict) and parts.get("make") in (None, "cams", "drum")
    least = _least_wall(name) if hardened and alone else _WALL
    return {**data, "limits": {"min_wall": least, **limits}}


def _least_wall(metal: str) -> float:
    """Least wall of a cam or drum, mm."""
    return max(_WALL, _CASES * materials.of(metal).case)


def of_drum(data: Any) -> Any:
    """A spec's tables of a drum with the width of a milled groove and walls as thick as the least and as half of the track's depth, where
    they leave them open and name a metal."""
    if not isinstance(data, dict):
        return data
    material, fits = (data.get(key, {}) for key in ("material", "print"))
    if not (isinstance(material, dict) and isinstance(fits, dict)):
        return data
    name = material.get("name")
    if not _is_metal(name):
        return data
    made = {**_clear_of_head(data), "print": {"slide_clearance": _GROOVE, **fits}}
    parts = data.get("parts", {})
    if not isinstance(parts, dict):
        return made
    wall = max(_END, _least_wall(name), _RIM_OF_DEPTH * _depth(made.get("geometry", {})))
    return {**made, "parts": {"wall": float(math.ceil(wall)), **parts}}


def _clear_of_head(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """The tables with room for the head of the bought roller that the load names, where neither that nor the drum's radius is given; an end
    cam has no floor."""
    geometry, load = data.get("geometry"), data.get("load")
    if not (isinstance(geometry, dict) and isinstance(load, dict)):
        return data
    roller = geometry.get("roller")
    named = CAM_FOLLOWERS.get(str(load.get("cam_follower")))
    floored = geometry.get("track") != "end" and geometry.get("radius") is None
    if named is None or not isinstance(roller, dict) or not floored:
        return data
    clear = {"end_clearance": round(named.beyond + HEAD_CLEARANCE, 3), **roller}
    return {**data, "geometry": {**geometry, "roller": clear}}


def _depth(geometry: Any) -> float:
    """Depth of a drum's track as far as its tables say it, mm."""
    table = geometry.get("roller", {}) if isinstance(geometry, dict) else {}
    if not isinstance(table, dict):
        return 0.0
    fields = DrumRollerTable.model_fields
    length, gap = (table.get(key, fields[key].default) for key in ("length", "end_clearance"))
    known = isinstance(length, int | float) and isinstance(gap, int | float)
    return length + 2 * gap if known else 0.0


def filled(data: Any) -> Any:
    """A spec's tables with these sizes; as they are where nothing is cut of metal or a whole machine is made.

    Thickness: as the roller of the catalogue, at least 0.6 bores. The bore has the keyway of DIN 6885 where the norm has one and the
    base circle leaves a wall of half the bore about it. With a keyway a hub of 1.8 bores, so high that the key is as
    long as the bore is wide, and its set screw has room; none in a groove, or where the base circle has no room for it. A groove has a back of half the
    thickness, dowels as thick at least, as far as the base circle has room for them, and a rim of 2.5 dowels, or with such walls
    beside them.
    """
    if not isinstance(data, dict):
        return data
    parts = data.get("parts", {})
    tables = [data.get(key, {}) for key in ("geometry", "load", "material", "print", "limits")]
    if not all(isinstance(table, dict) for table in (parts, *tables)):
        return data
    geometry, load, material, fits, limits = tables
    if parts.get("make", "cams") != "cams" or not _is_metal(material.get("name")):
        return data
    bore = parts.get("bore", CamParts.model_fields["bore"].default)
    if not isinstance(bore, int | float):
        return data
    least_wall = limits.get("min_wall", _least_wall(material["name"]))
    grooved = geometry.get("closure") == "groove"
    least = CamParts.model_fields["thickness"].default
    thickness = max(least, float(math.ceil(_FACE * bore)), _ring(geometry, load))
    hub = float(math.ceil(_HUB * bore))
    sizes: dict[str, float | str] = {"thickness": thickness, "hub_diameter": hub}
    shape = parts.get("bore_shape", "keyway" if _is_keyed(bore, geometry) else "plain")
    sizes["bore_shape"] = shape
    under_screw = _under_screw(
        parts
    )  # a hub that is asked for, even where it has no room, as is told then
    if (
        shape == "keyway"
        and not grooved
        and (under_screw or not _too_small(geometry, parts.get("hub_diameter", hub)))
    ):
        given = parts.get("thickness", thickness)
        sizes["hub_height"] = (
            max(0.0, bore - given, under_screw) if isinstance(given, int | float) else 0.0
        )
    if grooved:
        given = parts.get("thickness", thickness)
        sizes |= _grooved(given, geometry.get("base_radius"), bore)
        pin = parts.get("pin_diameter", sizes["pin_diameter"])
        if isinstance(pin, int | float) and isinstance(least_wall, int | float):
            rim = float(math.ceil(max(_RIM * pin, pin + _LOOSE + 2 * least_wall)))
            sizes["rim"] = max(CamParts.model_fields["rim"].default, rim)
    made = {**data, "parts": {**sizes, **parts}}
    return {**made, "print": {"slide_clearance": _GROOVE, **fits}} if grooved else made


def _under_screw(parts: Mapping[str, Any]) -> float:
    """Height of a hub that its set screw asks for, mm: more than half its diameter is left on either side of its thread."""
    screw = SCREWS.get(str(parts.get("set_screw")))
    return _SCREWED * screw.nominal if screw else 0.0


def _is_metal(name: object) -> TypeGuard[str]:
    """Whether a material of the list is one."""
    return isinstance(name, str) and name in materials.MATERIALS and materials.of(name).metal


def _grooved(thickness: Any, base: Any, bore: float) -> dict[str, float]:
    """Back, dowels and rim of a groove with walls of a thickness, mm."""
    usual = {key: CamParts.model_fields[key].default for key in ("back", "pin_diameter", "rim")}
    if not isinstance(thickness, int | float):
        return usual
    back = max(usual["back"], float(math.ceil(_BACK * thickness)))
    room = (base - _BESIDE * bore) / 2 if isinstance(base, int | float) else math.inf
    sold = [each for each in DOWELS if usual["pin_diameter"] <= each <= room]
    pin = next((each for each in sold if each >= _BACK * thickness), max(sold, default=0.0))
    return {**usual, "back": back, "pin_diameter": pin or usual["pin_diameter"]}


def _is_keyed(bore: float, geometry: Mapping[str, Any]) -> bool:
    """Whether a bore left open has a keyway: one of the standard, with half the bore about it where the base circle is given."""
    usual = keyway(bore)
    base = geometry.get("base_radius")
    if usual is None:
        return False
    return not isinstance(base, int | float) or base >= bore + usual[1]


def _shaft_of(model: str | None) -> float | None:
    """Diameter of a motor's shaft, mm; None of one whose frame is not known."""
    row = STEPPERS.get(model or "")
    return SHAFTS[row.frame][0] if row else None


def seat_of(bore: ShaftBore, material: str, lengths: Sequence[float], key_fit: str | None) -> Seat:
    """Where bores of these lengths, mm, sit on a shaft of their own; key_fit: of their keyways, unless it is the usual one."""
    key = bore.key_width if bore.bore_shape == "keyway" else 0.0
    fit = "P9" if key_fit == "P9" else "N9"
    return Seat(bore.bore, lengths, key, fit, bool(rings_of(bore, material)))


def shaft_of(
    bore: ShaftBore, material: str, model: str | None, lengths: Sequence[float], key_fit: str | None
) -> list[Bought]:
    """The shaft of cams made alone, with bores of these lengths, mm, and its bearings; nothing where they have none of their own."""
    if not has_own_shaft(bore, material, model):
        return []
    return shaft_and_bearings(seat_of(bore, material, lengths, key_fit))


def has_own_shaft(bore: ShaftBore, material: str, model: str | None) -> bool:
    """Whether cams of metal made alone have a shaft, and sit not on that of their motor."""
    return materials.of(material).metal and _shaft_of(model) != bore.bore


def shaft_notes(bore: ShaftBore, material: str, model: str | None) -> list[str]:
    """Sentences on what is listed, what is yours and what only drawings have where cams made alone have a shaft."""
    if not has_own_shaft(bore, material, model):
        return []
    return [
        "camgen makes the cam, and lists its shaft and bearings. You make the follower, its guide and the frame, and bring a coupling and the motor.",
        "Chamfers and threads are on the drawings alone: no other file has them.",
    ]


def motor_notes(bore: float, model: str | None) -> list[str]:
    """A sentence on a cam that does not fit the shaft of the motor that is named."""
    shaft = _shaft_of(model)
    if shaft in (None, bore):
        return []
    return [
        f'The shaft of motor.model = "{model}" is {shaft:g} mm thick, and parts.bore is {bore:g} mm. '
        f"Set parts.bore = {shaft:g}, or couple the motor to a shaft of {bore:g} mm"
    ]


def rings_of(bore: ShaftBore, material: str) -> list[Bought]:
    """Rings on the shaft that keep a bore in metal from sliding along its key; none where a set screw does, or no ring is known."""
    keyed = materials.of(material).metal and bore.bore_shape == "keyway"
    screwed = isinstance(bore, CamParts) and bore.key_screw is not None
    return retaining_rings(bore.bore) if keyed and not screwed else []


def ring_notes(bore: ShaftBore, material: str) -> Iterator[str]:
    """What the drawing of such a part says of its rings, and of its ends: it fits between them either way round."""
    for rings in rings_of(bore, material):
        yield f"held by {rings.count} rings {rings.standard}, {rings.size}"
        yield "UP stamped on the upper end, away from the coupling"


def bore_notes(bore: ShaftBore, material: str) -> list[str]:
    """A sentence on a bore in metal that turns nothing, slides on its key, or that no drill, reamer and broach makes."""
    if not materials.of(material).metal:
        return []
    if getattr(bore, "key_screw", None) is not None or rings_of(bore, material):
        return []
    if bore.bore_shape == "keyway":
        has_hub = isinstance(bore, CamParts) and bore.hub_height
        screw = " or parts.set_screw" if has_hub else ""
        return [
            f"Nothing keeps the part from sliding along its shaft and key: use a shoulder or a ring on the shaft{screw}."
        ]
    if bore.bore_shape == "plain":
        return [
            'Nothing in the plain bore keeps the part from turning on its shaft: clamp it or shrink it on, or set parts.bore_shape = "keyway".'
        ]
    return [
        f'The flat of a D bore in {material} needs wire erosion; a keyway (parts.bore_shape = "keyway") can be broached.'
    ]


def _ring(geometry: Mapping[str, Any], load: Mapping[str, Any]) -> float:
    """Width of the ring of the bought roller that the load names, or else of one of this size, mm; 0 where there is none."""
    follower = geometry.get("follower")
    radius = follower.get("radius") if isinstance(follower, dict) else None
    named = CAM_FOLLOWERS.get(str(load.get("cam_follower")))
    of_size = [row for row in CAM_FOLLOWERS.values() if radius and row.outside == 2 * radius]
    return float(max((row.width for row in ([named] if named else of_size)), default=0.0))


def _too_small(geometry: Mapping[str, Any], hub: Any) -> bool:
    """Whether a hub of this diameter leaves the base circle."""
    base = geometry.get("base_radius")
    return isinstance(base, int | float) and isinstance(hub, int | float) and hub >= 2 * base - 2
