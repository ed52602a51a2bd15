"""Error budget: what each stage from law to file adds, in mm of outline and degrees of swing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from camgen.files.formats import DRAWN, FORMATS, SOLID
from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.deviation import outline_error
from camgen.geometry.outlines import Contour, Floats
from camgen.geometry.rings import Ring, Shape
from camgen.judge.cams import judged_angles, rolled, s_unit
from camgen.judge.measured import Sections
from camgen.machine.features import CamOutline, Mount
from camgen.machine.model import Cam, Machine
from camgen.study import Table


def error_budget(
    outline: Contour,
    polygon: Ring,
    machine: Machine,
    drive: CamOutline,
    mounts: Sequence[Mount],
    tolerance: float,
    files: Mapping[str, Sections],
    numbers: Mapping[str, float],
) -> Table:
    """One row a stage: largest outline error (mm) and largest change of the follower's s (deg, or mm) that it adds.

    outline: the exact one; polygon: the facets made of it, as they print; files: sections of the part that drives, by kind
    of FORMATS; numbers: the report's, with what the spec itself undercuts.
    The outline error is the largest anywhere along the exact outline, that of s over the judged cam angles.
    """
    theta, joint = judged_angles(), machine.joint(drive.joint)
    assert isinstance(joint, Cam), f"{drive.joint} is no cam"
    unit, scale = s_unit(joint)

    def follow(sections: Sections) -> tuple[Ring, Floats]:
        """The outline about its bore, and s on it."""
        ring, law = rolled(machine, drive, mounts, sections)
        return ring, law(theta)

    def off(ring: Ring) -> float:
        return outline_error(outline.counter_clockwise(), ring.counter_clockwise())

    def largest(a: Floats, b: Floats) -> float:
        return scale * float(np.nanmax(np.abs(a - b)))

    exact = (drive.meant.given or joint.law)(theta, 0)
    rows = [
        (
            "law: undercut that the spec implies",
            numbers.get("undercut_mm", 0.0),
            numbers.get(f"undercut_{unit}", 0.0),
        )
    ]
    for kinds, stage in ((DRAWN, "arc fit"), (SOLID, "facets")):
        there = [kind for kind in kinds if kind in files]
        if not there:
            continue
        ring = polygon if kinds == SOLID else Ring(*bulges(fit_arcs(outline, tolerance)))
        meant = follow([[Shape(ring, ())]])[1]
        rows.append((f"{stage} ({', '.join(kinds).upper()})", off(ring), largest(meant, exact)))
        for kind in there:
            made, s = follow(files[kind])
            rows.append(
                (
                    f"{FORMATS[kind].numbers} of {kind.upper()}",
                    _moved(ring, made),
                    largest(s, meant),
                )
            )
    return Table("Error budget by stage", ("stage", "outline, mm", f"follower, {unit}"), rows)


def _moved(made: Ring, read: Ring) -> float:
    """Largest distance of a vertex that was read from the nearest one that was made, mm."""
    import shapely

    tree = shapely.STRtree(shapely.points(made.points.real, made.points.imag))
    nearest = made.points[tree.nearest(shapely.points(read.points.real, read.points.imag))]
    return float(np.max(np.abs(read.points - nearest)))
