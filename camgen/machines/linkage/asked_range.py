"""A range of the drive that is asked for, held against what the chain has."""

from __future__ import annotations

import math

from camgen.errors import DesignError, listed
from camgen.machine.model import Machine
from camgen.machine.reach import reach
from camgen.machines.linkage.tables import OneDrive


def refuse_range(machine: Machine, drive: OneDrive, least: float, most: float) -> None:
    """Raise DesignError where the range asked for, rad, is more than the chain has."""
    can = reach(machine)
    key = "drive.segment" if drive.segments else f"drive.{drive.range_key}"
    low = math.degrees(can.low)
    high = math.degrees(can.high)
    asked = (math.degrees(least), math.degrees(most))
    said = f"it closes from {low:.6g} to {high:.6g} {drive.unit}"
    for value, limit, beyond, joints in (
        (asked[0], low, asked[0] < low, can.ends[0]),
        (asked[1], high, asked[1] > high, can.ends[1]),
    ):
        if not can.full and beyond:
            where = listed("joint", joints)
            raise DesignError(
                key,
                value,
                limit,
                drive.unit,
                where,
                "ask for a range within it",
            ).saying(
                f"{key} goes from {asked[0]:.6g} to {asked[1]:.6g} {drive.unit}, more than the chain has: {said}, and "
                f"opens at {where}"
            )
