"""Error budget: what each stage from law to file adds, in mm of outline and degrees of swing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from camgen.files.formats import DRAWN, FORMATS, SOLID
from camgen.geometry.deviation import outline_error
from camgen.geometry.outlines import Contour, Floats
from camgen.geometry.rings import Ring, Shape
from camgen.judge.cams import judged_angles, judged_way, outline_and_law, s_unit
from camgen.judge.joints import Nominal
from camgen.judge.measured import Sections
from camgen.machine.features import CamOutline
from camgen.numerics import magnitude
from camgen.study import Table


@dataclass(frozen=True)
class Stages:
    """A cam's outline on its way to the files, in the part's frame, mm."""

    exact: Contour
    arcs: Ring  # of drawings
    facets: Ring  # of solids, as they print


def error_budget(
    nominal: Nominal,
    drive: CamOutline,
    stages: Stages,
    files: Mapping[str, Sections],
    numbers: Mapping[str, float],
) -> Table:
    """One row a stage: largest outline error (mm) and largest change of the follower's s (deg, or mm) that it adds.

    files: sections of the part that drives, by kind of FORMATS; numbers: the report's, with what the spec itself undercuts.
    The outline error is the largest anywhere along the exact outline, that of s over the judged cam angles.
    """
    joint = nominal.machine.cam(drive.joint)
    unit, scale = s_unit(joint)
    theta = judged_angles() if drive.way is None else judged_way(drive.way)

    def follow(sections: Sections) -> tuple[Ring, Floats]:
        """The outline about its bore, and s on it."""
        ring, law = outline_and_law(nominal.machine, drive, nominal.mounts, sections)
        return ring, law(theta)

    def off(ring: Ring) -> float:
        return outline_error(stages.exact.counter_clockwise(), ring.counter_clockwise())

    def largest(a: Floats, b: Floats) -> float:
        return scale * float(np.nanmax(np.abs(a - b)))

    exact = (drive.nominal.law or joint.law)(theta, 0)
    rows = [
        (
            "law: undercut that the spec implies",
            numbers.get("undercut_mm", 0.0),
            numbers.get(f"undercut_{unit}", 0.0),
        )
    ]
    for kinds, stage, ring in (
        (DRAWN, "arc fit", stages.arcs),
        (SOLID, "facets", stages.facets),
    ):
        present = [kind for kind in kinds if kind in files]
        if not present:
            continue
        s_of_stage = follow([[Shape(ring, ())]])[1]
        rows.append(
            (f"{stage} ({', '.join(kinds).upper()})", off(ring), largest(s_of_stage, exact))
        )
        for kind in present:
            outline, s = follow(files[kind])
            rows.append(
                (
                    f"{FORMATS[kind].numbers} of {kind.upper()}",
                    _moved(ring, outline),
                    largest(s, s_of_stage),
                )
            )
    return Table("Error budget by stage", ("stage", "outline, mm", f"follower, {unit}"), rows)


def _moved(before: Ring, after: Ring) -> float:
    """Largest distance of a vertex that was read from the nearest one that was made, mm."""
    import shapely

    tree = shapely.STRtree(shapely.points(before.points.real, before.points.imag))
    nearest = before.points[tree.nearest(shapely.points(after.points.real, after.points.imag))]
    return magnitude(after.points - nearest)
