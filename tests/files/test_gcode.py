"""G-code read back: walls of every dialect as what they print; what says nothing of its walls is refused."""

import math

import numpy as np
import pytest

from camgen.errors import FileError
from camgen.files.gcode import printed_outlines, read_gcode
from camgen.measuring.outlines import read_outline

WIDTH = 0.45
PRUSA = (";TYPE:External perimeter", ";TYPE:Perimeter", f";WIDTH:{WIDTH}")
ORCA = (";TYPE:Outer wall", ";TYPE:Inner wall", f";WIDTH:{WIDTH}")
BAMBU = ("; FEATURE: Outer wall", "; FEATURE: Inner wall", f"; LINE_WIDTH: {WIDTH}")
CURA = (";TYPE:WALL-OUTER", ";TYPE:WALL-INNER", "")


def loop(z):
    """A closed loop, its seam 0.05 mm open, as places."""
    way = (z[0] - z[-1]) / abs(z[0] - z[-1])
    return [*z, z[0] - 0.05 * way]


def circle(radius, n=200, centre=0j):
    return centre + radius * np.exp(2j * math.pi * np.arange(n) / n)


def sliced(path, loops, marks=PRUSA, layers=3, at=100 + 90j, relative=False, scale=1.0, decimals=5):
    """Layers of 0.2 mm; loops: centre lines, the outer one first; after each outer wall an inner one and a wipe."""
    outer, inner, width = marks
    lines = [
        "; made for a test",
        "G21" if scale == 1 else "G20",
        "G90",
        "M83" if relative else "M82",
        "G92 E0",
    ]
    e = 0.0
    for k in range(layers):
        lines += [";LAYER_CHANGE", f"G1 Z{0.2 * (k + 1) / scale:.7f} F7800"]
        for z in loops:
            places = [at + place for place in loop(z)]
            lines.append(
                f"G1 X{places[0].real / scale:.{decimals}f} Y{places[0].imag / scale:.{decimals}f} F7800"
            )
            lines += [outer, *([width] if width else []), "G1 F1800"]
            for a, b in zip(places, places[1:], strict=False):
                step = 0.03 * abs(b - a)
                e = step if relative else e + step
                move = f"X{b.real / scale:.{decimals}f}" + (
                    f" Y{b.imag / scale:.{decimals}f}" if b.imag != a.imag else ""
                )
                lines.append(f"G1 {move} E{e / scale:.6f}".replace("E0.", "E."))
            e = -0.8 if relative else e - 0.8
            lines += [
                f"G1 X{places[1].real / scale:.5f} Y{places[1].imag / scale:.5f} E{e / scale:.5f} ; wipe",
                inner,
            ]
            e = 0.0 if relative else e + 0.8
            lines += [f"G1 E{0.8 if relative else e:.5f}", "G92 E0"]
            e = 0.0
    path.write_text("\n".join(lines) + "\n")
    return path


def tube(path, **how):
    """A disc of radius 20 with a bore of 8: its walls run half a line inside the material."""
    return sliced(path, [circle(20 - WIDTH / 2), circle(4 + WIDTH / 2, 90)[::-1]], **how)


@pytest.mark.parametrize(
    "marks", [PRUSA, ORCA, BAMBU, CURA], ids=["prusa", "orca", "bambu", "cura"]
)
@pytest.mark.parametrize("relative", [False, True], ids=["M82", "M83"])
def test_every_dialect(tmp_path, marks, relative):
    path = tube(tmp_path / "p.gcode", marks=marks, relative=relative)
    rings, said = printed_outlines(path, line_width=WIDTH if marks == CURA else None)
    outer, bore = sorted(rings, key=lambda ring: -ring.area)
    assert np.abs(outer.points).max() == pytest.approx(20, abs=2e-3) and np.abs(
        bore.points
    ).min() == pytest.approx(4, abs=2e-3)
    assert abs(outer.centroid) < 2e-3  # the bore is the origin, though the part lies at 100, 90
    assert "layer 2 of 3" in said and "X 100.0" in said


def test_inches_and_other_layers(tmp_path):
    path = tube(tmp_path / "p.gcode", scale=25.4, decimals=7)
    rings, said = printed_outlines(path, 0.1)
    assert "layer 1 of 3" in said and max(ring.area for ring in rings) == pytest.approx(
        400 * math.pi, rel=1e-3
    )
    with pytest.raises(
        FileError, match="no layer 0.7 mm over the bed; its highest one ends at 0.6"
    ):
        printed_outlines(path, 0.7)


def test_arcs_by_their_centre(tmp_path):
    r = 20 - WIDTH / 2
    lines = [f"G1 X{r} Y0", "G1 Z.2", PRUSA[0], PRUSA[2], "M83"]
    lines += [
        f"G3 X{-r} Y0 I{-r} J0 E3",
        f"G3 X0 Y{-r} I{r} J0 E1.5",
        f"G3 X{r} Y0 I0 J{r} E1.5",
        "G3 Z.6 I1 J0 P1",
    ]
    (tmp_path / "p.gcode").write_text("\n".join(lines))
    (wall,) = read_gcode(tmp_path / "p.gcode")
    assert wall.ring.area == pytest.approx(math.pi * r * r, rel=1e-12)
    (tmp_path / "r.gcode").write_text("\n".join(lines).replace(f"I{-r} J0", f"R{r}"))
    with pytest.raises(FileError, match="arcs by radius"):
        read_gcode(tmp_path / "r.gcode")


def test_overhangs_belong_to_the_wall_that_they_are_part_of(tmp_path):
    path = tube(tmp_path / "p.gcode", layers=1)
    lines = path.read_text().splitlines()
    middle = [k for k, line in enumerate(lines) if line.startswith("G1 X")][60]
    lines[middle:middle] = [";TYPE:Overhang perimeter"]
    lines[middle + 30 : middle + 30] = [PRUSA[0]]
    path.write_text("\n".join(lines))
    assert len(read_gcode(path)) == 2
    path.write_text(path.read_text().replace(PRUSA[0], ";TYPE:Overhang perimeter", 2))
    assert len(read_gcode(path)) == 1  # wholly over the void it may as well be an inner wall


def test_what_is_refused(tmp_path):
    path = tmp_path / "p.gcode"
    path.write_bytes(b"GCDE\x01\x00\x00\x00")
    with pytest.raises(FileError, match="binary G-code: export it as text"):
        read_gcode(path)
    with pytest.raises(FileError, match="binary G-code"):
        (tmp_path / "p.bgcode").write_bytes(b"GCDE")
        read_outline(tmp_path / "p.bgcode")
    tube(path, marks=("; outer", "; inner", ""))
    with pytest.raises(FileError, match="no marks of outer walls"):
        read_gcode(path)
    tube(path, marks=CURA)
    with pytest.raises(FileError, match="--line-width"):
        printed_outlines(path)
    path.write_text(f"{PRUSA[0]}\nG1 X1 Y1 E1\nG1 X50 Y1 E2\nG1 X50 Y20 E3\nG1 X80 Y20 E4\n")
    with pytest.raises(FileError, match="no outer wall that closes"):
        read_gcode(path)
    with pytest.raises(FileError, match="cannot be read"):
        read_gcode(tmp_path / "none.gcode")
    with open(path, "wb") as file:
        file.truncate(201_000_000)
    with pytest.raises(FileError, match="is 201 MB large; at most 200 MB"):
        read_gcode(path)
    with open(path, "wb") as file:
        file.truncate(199_000_000)
    with pytest.raises(FileError, match="line 1 is no text, or has no end"):
        read_gcode(path)


def test_an_outline_of_a_plate_of_two(tmp_path):
    path = sliced(
        tmp_path / "p.gcode",
        [circle(20 - WIDTH / 2), circle(4 + WIDTH / 2, 90)[::-1], circle(10, centre=60 + 0j)],
    )
    assert read_outline(path).ring.area == pytest.approx(400 * math.pi, rel=1e-3)
    other = read_outline(path, contour=2).ring
    assert other.area == pytest.approx((10 + WIDTH / 2) ** 2 * math.pi, rel=1e-3)
    assert other.centroid == pytest.approx(60, abs=0.01)


def test_the_motion_of_a_sliced_disc(tmp_path):
    """An eccentric disc of radius r, e off its bore, lifts a roller of radius p by the slider crank's formula."""
    from camgen.judge.follower_table import read_follower
    from camgen.measuring.motion import recover

    e, r, p = 3.0, 20.0, 5.0
    path = sliced(
        tmp_path / "p.gcode",
        [circle(r - WIDTH / 2, 2000, e + 0j), circle(4 + WIDTH / 2, 400)[::-1]],
    )
    found = recover(
        read_outline(path).ring, read_follower("translating,radius=5,direction_deg=0,at=0")
    )
    wanted = e * np.cos(found.theta) + np.sqrt((r + p) ** 2 - (e * np.sin(found.theta)) ** 2)
    assert np.abs(found.s - wanted).max() < 3e-3  # the seam is 0.05 mm of a chord


@pytest.mark.parametrize(
    "old, new, said",
    [
        ("X", "Xgarbage", "line"),
        ("X", "X-1e5 X", "line"),
        ("X", "Xnan", "line"),
        ("X", "X" + "9" * 400, "beyond"),
        (";WIDTH:", ";WIDTH:500\n;WIDTH:", "500 mm wide"),
        (";WIDTH:", ";WIDTH:0.4.5\n;WIDTH:", "mm wide"),
    ],
)
def test_damaged_numbers_are_no_motion(tmp_path, old, new, said):
    path = tube(tmp_path / "p.gcode", layers=1)
    text = path.read_text()
    at = text.index(old, text.index("G1 X") if old == "X" else 0)
    path.write_text(text[:at] + new + text[at + len(old) :])
    with pytest.raises(FileError, match=said):
        read_gcode(path)


def test_a_bore_laid_as_walls_of_two_widths(tmp_path):
    """Each half's centre line lies half of its own width inside the material: the bore is round; a wall keeps its height."""
    half = [
        (4 + w / 2) * np.exp(1j * np.linspace(a, a + math.pi, 200))
        for w, a in ((0.4, 0.0), (0.6, math.pi))
    ]
    lines = ["M83", *(f"{mark}" for mark in (PRUSA[0], ";WIDTH:0.45"))]
    for k in range(3):
        outer = [*circle(20 - WIDTH / 2, 400), 20 - WIDTH / 2]
        for z, width in ((outer, 0.45), (half[0], 0.4), (half[1], 0.6)):
            lines += (
                []
                if width == 0.6
                else [f"G1 X{z[0].real:.5f} Y{z[0].imag:.5f} Z{0.2 * (k + 1):.1f}"]
            )
            lines += [f";WIDTH:{width}", *(f"G1 X{p.real:.5f} Y{p.imag:.5f} E.01" for p in z[1:])]
        lines.append(f"G1 X{half[0][0].real:.5f} Y0 E.01")
    path = tmp_path / "p.gcode"
    path.write_text("\n".join(lines))
    assert [round(wall.z, 1) for wall in read_gcode(path)] == [0.2, 0.2, 0.4, 0.4, 0.6, 0.6]
    rings, said = printed_outlines(path)
    bore = min(rings, key=lambda ring: abs(ring.area))
    turned = np.abs(np.angle(bore.points)) % math.pi
    round_part = bore.points[(turned > 0.2) & (turned < math.pi - 0.2)]
    assert np.abs(np.abs(round_part) - 4).max() < 2e-3 and "0.4 to 0.6 mm wide" in said
