"""Gears as meshes of other programs, binary STL in single precision and 3MF: sound, and one flank 20 um off."""

from __future__ import annotations

import math
import re
import struct
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from camgen.cli import cli
from camgen.geometry.rings import Floats, Points

sys.path.insert(0, str(Path(__file__).parents[1] / "judge"))
from pair_outlines import Wheel  # noqa: E402

PINION = Wheel(2, 18)
WHEEL = Wheel(2, 36)
DISTANCE = 54.0
TOOTH = 7  # that is damaged
OFF = 0.02  # mm


def outline(wheel: Wheel) -> Points:
    """Chords alone, 16 to a flank."""
    return wheel.ring(16, arcs=False).points


def thinner(wheel: Wheel) -> Points:
    """The rising flank of one tooth, off by OFF along the line of action."""
    points = outline(wheel).copy()
    angles = np.angle(points * np.exp(-1j * math.tau * TOOTH / wheel.z))
    radius = np.abs(points)
    flank = (angles < 0) & (angles > -math.pi / wheel.z) & (radius > wheel.rb)
    points[flank] *= np.exp(1j * OFF / wheel.rb)
    return points


def solid(points: Points, thickness: float = 6.0) -> Floats:
    """Triangles of a prism, (n, 3, 3): fans of both faces about the axis, which every place of the rim sees, and its side."""
    assert (np.angle(np.roll(points, -1) / points) > 0).all()
    low = np.column_stack([points.real, points.imag, np.zeros(len(points))])
    up = np.array([0.0, 0.0, thickness])
    ahead = np.roll(low, -1, axis=0)
    axis = np.zeros_like(low)
    rows = [
        (axis, ahead, low),
        (axis + up, low + up, ahead + up),
        (low, ahead, ahead + up),
        (low, ahead + up, low + up),
    ]
    return np.concatenate([np.stack(row, axis=1) for row in rows])


def stl(path: Path, triangles: Floats) -> None:
    """Binary; normals left 0, as some programs leave them."""
    rows = [struct.pack("<12fH", 0, 0, 0, *each.ravel(), 0) for each in triangles]
    path.write_bytes(bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows))


def threemf(path: Path, triangles: Floats) -> None:
    """The least that the core specification asks for."""
    places, numbers = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    vertices = "".join(f'<vertex x="{x:.5f}" y="{y:.5f}" z="{z:.5f}"/>' for x, y, z in places)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in numbers.reshape(-1, 3))
    core = "http://schemas.microsoft.com/3dmanufacturing"
    package = "http://schemas.openxmlformats.org/package/2006"
    contents = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types">'
        '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
        '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships">'
        f'<Relationship Target="/3D/a.model" Id="a" Type="{core}/2013/01/3dmodel"/></Relationships>',
        "3D/a.model": f'<model unit="millimeter" xmlns="{core}/core/2015/02"><resources><object id="1" type="model">'
        f"<mesh><vertices>{vertices}</vertices><triangles>{faces}</triangles></mesh></object></resources>"
        '<build><item objectid="1"/></build></model>',
    }
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in contents.items():
            archive.writestr(name, f'<?xml version="1.0" encoding="UTF-8"?>{content}')


@pytest.mark.long
@pytest.mark.parametrize("write", [stl, threemf])
def test_gears_in_meshes_are_judged_and_a_flank_off_by_20_um_is_seen(
    tmp_path: Path, write: Callable[[Path, Floats], None]
) -> None:
    limit = math.degrees(OFF / 4 / WHEEL.rb)
    backlash = math.degrees(2 * 0.04 / WHEEL.r)
    ending = {stl: "stl", threemf: "3mf"}[write]
    pinion = tmp_path / f"pinion.{ending}"
    write(pinion, solid(outline(PINION)))
    for name, points, code in (("sound", outline(WHEEL), 0), ("thin", thinner(WHEEL), 1)):
        wheel = tmp_path / f"{name}.{ending}"
        write(wheel, solid(points))
        words = ["motion", str(pinion), "--drives", str(wheel), "--distance", str(DISTANCE)]
        words += ["--ratio", "-18/36", "--tolerance", f"{limit:.6g}", "-o", str(tmp_path / "out")]
        result = CliRunner().invoke(cli, words)
        assert result.exit_code == code, result.output
        least, most = map(float, re.findall(r"play is ([.\d]+) to ([.\d]+) deg", result.output)[0])
        # chords lie within the flank, so that there is more play, by both sagittae at most
        assert backlash - 1e-4 < least < backlash + limit
        if code:
            assert most - least == pytest.approx(math.degrees(OFF / WHEEL.rb), rel=0.1)
            assert "BACK_FLANK_ERROR" in result.output
            told = re.search(r"least like the others is at ([.\d]+) deg: 0.0(19|20)", result.output)
            assert told and float(told[1]) == pytest.approx(TOOTH * 360 / WHEEL.z, abs=5)
