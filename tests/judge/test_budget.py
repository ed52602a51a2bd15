"""The error budget of a cam, stage by stage: a flat face on an eccentric whose files are off by what is put into them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shapes import polygon

from camgen.geometry.arcs import bulges, fit_arcs
from camgen.geometry.outlines import circle
from camgen.geometry.rings import Ring, Shape
from camgen.judge.budget import Stages, error_budget
from camgen.judge.joints import Nominal
from camgen.machine import GROUND, Body, Cam, Drive, Machine, Pin, Place, Pose, Slide
from camgen.machine.features import CamOutline, Flat, Mount, NominalCam
from camgen.machine.model import Floats

OFF = 4.0
RADIUS = 16.0
COUNT = 180


def lift(theta: Floats, order: int = 0) -> Floats:
    return OFF * np.cos(np.asarray(theta) + order * math.pi / 2)


@pytest.mark.parametrize("undercut", [0.0, 0.2])
def test_each_stage_adds_its_own(undercut: float) -> None:
    """Facets inside the circle by their sagitta; an STL whose vertices are off by 3 um, a DXF of exact arcs moved by 0.1 um; what
    the spec itself undercuts stands first, and what the follower loses is counted from there."""
    machine = Machine(
        (Body("cam"), Body("follower")),
        (
            Pin("O", Place(GROUND), Place("cam")),
            Slide("stem", Place(GROUND), Place("follower")),
            Cam("lift", "cam", "follower", lift, slide="stem", rest=RADIUS, closure="force"),
        ),
        (Drive("motor", "cam"),),
        {"cam": Pose(0j, 0.0), "follower": Pose(complex(RADIUS + OFF), 0.0)},
    )
    meant = (
        NominalCam(law=lambda theta, order=0: lift(theta, order) - undercut * (order == 0))
        if undercut
        else NominalCam()
    )
    drive = CamOutline("lift", "cam", "O", None, Flat(None, 0j, math.pi, 30.0), nominal=meant)
    facets = polygon(OFF + RADIUS * np.exp(2j * np.pi * np.arange(COUNT) / COUNT))
    moved = polygon(facets.points + 3e-3 * np.exp(2j * np.pi * np.arange(COUNT) / COUNT))
    drawn = Ring(*bulges(fit_arcs(circle(complex(OFF), RADIUS), 1e-3))).moved(shift=1e-4)
    files = {"dxf": [[Shape(drawn, ())]], "stl": [[Shape(moved, ())]]}
    outline = circle(complex(OFF), RADIUS)
    table = error_budget(
        Nominal(machine, [drive], [Mount("cam", "cam")]),
        drive,
        Stages(outline, Ring(*bulges(fit_arcs(outline, 1e-3))), facets),
        files,
        {"undercut_mm": 0.5 * undercut},
    )
    rows = {str(name): (outline, follower) for name, outline, follower in table.rows}
    sagitta = RADIUS * (1 - math.cos(math.pi / COUNT))
    assert table.columns == ("stage", "outline, mm", "follower, mm")
    assert rows.pop("law: undercut that the spec implies") == (0.5 * undercut, 0.5 * undercut)
    assert rows.pop("arc fit (DXF)") == pytest.approx((0.0, undercut), abs=1e-9)
    assert rows.pop("decimals of DXF") == pytest.approx((1e-4, 1e-4), abs=1e-9)
    assert rows.pop("facets (STL, 3MF)") == pytest.approx((sagitta, undercut or sagitta), rel=1e-2)
    assert rows.pop("float32 of STL") == pytest.approx((3e-3, 3e-3), rel=1e-3)
    assert not rows
