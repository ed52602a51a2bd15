"""What bore and hub leave of a disc cam, by arithmetic: its nearest side lies where its follower stands lowest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgen.findings import Finding, at_least
from camgen.parts.disc_cams import refuse_wide

if TYPE_CHECKING:
    from camgen.machines.disc_cam.mechanism import DiscCamDrive


def walls(drive: DiscCamDrive) -> list[Finding]:
    """MIN_WALL of each cam, bore to nearest side; DesignError where bore, key or hub leaves it.

    Not here, but on the files: how near a keyway, a flat or a groove's pins come.
    """
    made, need, found = drive.making, drive.allowed.min_wall, []
    names = ["inner"] if drive.geometry.closure == "groove" else ["cam"] if len(drive.cams) == 1 else ["cam-1", "cam-2"]
    for cam, name in zip(drive.cams, names, strict=True):
        refuse_wide(name, cam.nearest, made.reach, made.hub_diameter if made.hub_height else 0.0)
        facets = 2 * drive.accuracy.chord_tolerance  # what the files may take of it, as there
        said = "a smaller bore or a larger base_radius widens it"
        where, wall = f"bore and nearest side of {name}", cam.nearest - made.bore / 2
        found.append(at_least("MIN_WALL", wall, need, "mm", where, said, facets))
    return found
