"""What bore, key, hub and a groove's pins leave of a disc cam, by arithmetic: its nearest side lies where its follower stands
lowest. Where that leaves open whether a keyway or a pin comes too near to a side further on, its holes are laid in its outline.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgen.findings import Finding, Where, at_least
from camgen.geometry.distances import thinnest_wall
from camgen.geometry.facets import facet_contour
from camgen.parts.disc_cams import pins_beside, refuse_wide
from camgen.tolerances import WALL_FACETS

if TYPE_CHECKING:
    from camgen.machines.disc_cam.mechanism import DiscCamDrive

_REMEDY = "a smaller bore or a larger base_radius widens it"


def walls(drive: DiscCamDrive) -> list[Finding]:
    """MIN_WALL of each cam; DesignError where bore, key, pin or hub leaves it."""
    made, need, found = drive.making, drive.allowed.min_wall, []
    grooved = drive.geometry.closure == "groove"
    names = ["inner"] if grooved else ["cam"] if len(drive.cams) == 1 else ["cam-1", "cam-2"]
    widest = pins_beside(made, need) + made.pin_diameter / 2 if grooved else made.reach
    facets = 2 * max(
        WALL_FACETS, drive.accuracy.chord_tolerance
    )  # what the files may take of a wall, as there
    for cam, name in zip(drive.cams, names, strict=True):
        refuse_wide(name, cam.nearest, made.reach, made.hub_diameter if made.hub_height else 0.0)
        where, wall = Where(f"holes and nearest side of {name}"), cam.nearest - widest
        if wall < need and (grooved or made.shaft != "plain"):
            return [*_laid(drive, facets), *_rim(drive, facets)]
        found.append(at_least("MIN_WALL", wall, need, "mm", where, _REMEDY, facets))
    return [*found, *_rim(drive, facets)]


def _laid(drive: DiscCamDrive, facets: float) -> list[Finding]:
    """The same of the plates as they are made, facet by facet."""
    found = []
    for part in drive.assembly.parts:
        outer, *holes = (
            facet_contour(each, facets / 2) for each in (part.region.outer, *part.region.holes)
        )
        where, wall = (
            Where(f"between the contours of {part.name}", part=part.name),
            thinnest_wall(outer, holes),
        )
        found.append(
            at_least("MIN_WALL", wall, drive.allowed.min_wall, "mm", where, _REMEDY, facets)
        )
    return found


def _rim(drive: DiscCamDrive, facets: float) -> list[Finding]:
    """MIN_WALL from the pins in a groove's rim to its edge."""
    if drive.geometry.closure != "groove":
        return []
    made, need = drive.making, drive.allowed.min_wall
    said = "a wider parts.rim or a smaller parts.pin_diameter widens it"
    return [
        at_least(
            "MIN_WALL",
            (made.rim - made.pin_diameter) / 2,
            need,
            "mm",
            Where("pins and edge of outer"),
            said,
            facets,
        )
    ]
