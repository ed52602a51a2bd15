"""Both needle threads of the chain stitch over a turn, in the plane of the needles, and the seam that they make.

    down      a needle carries its thread below the plate; its eye is the point's length over the tip, and its loop reaches there,
              a leg beside the needle, where the nose finds it over the eye
    caught    from the capture on the loop lies on its spreader: straight under its own needle until the root of the nose, l1
              behind the tip, takes it along; as the nose goes back it stays there, or, where the other needle would miss it
              there, keeps its length and slides along the nose to its tip
    pierced   once the other needle is in it, that needle holds it as the nose goes back
    shed      the nose leaves it there, and it is pulled up to the fabric until the needles are at their lowest again

A loop's legs run from the hole in the plate to the spreader's nose level: at the pierce, for a loop held at the root, under the
angle gamma' of the tables. The bulge by which a nose finds the loop lies across this plane.
[Horobets, Manoilenko, figures 1 and 4]
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from camgen.geometry.outlines import Floats, Points
from camgen.machines.chain_stitch_looper.stitch import Design
from camgen.study import Figure, Figures, Plot, Sketch, Table

_OVER = 6.0  # mm, by which what is drawn of a thread ends over its eye's highest place
STITCHES = 3  # of the seam that is drawn
_HALF = math.pi
_ROUND = np.linspace(0, math.tau, 7201)


def loop_shift(d: Design, k: int, phi: Floats) -> Floats:
    """How far the nose of spreader k (0, 1) has taken its loop towards the other needle, (n,) mm; phi: 0 to 2 pi."""
    nose = d.noses(phi)[k]
    way = d.noses(_ROUND)[k]
    most = float(way.max())
    shift = np.maximum(nose - d.l1, 0.0)
    if d.margins[k] >= d.l1:
        return shift
    # where it takes the loop along
    seat = min(d.l1, max(0.0, most - d.given.spacing - d.given.needle))
    back = phi > float(_ROUND[int(np.argmax(way))])
    slides = np.clip(nose, 0.0, most - seat)
    return np.asarray(np.where(back, slides, np.maximum(nose - seat, 0.0)))


def loop(d: Design, k: int, phi: Floats) -> tuple[Floats, Floats]:
    """How far the loop of needle k (0, 1) reaches towards the other needle, and how deep, mm, (n,) each; phi: 0 to 2 pi."""
    g = d.given
    level = g.levels[k]
    depth = g.point[k] + d.tips(phi)[k]
    begin = d.capture[k]
    end = d.shed[k]
    end = math.tau - begin if math.isnan(end) or end < _HALF else end
    on = (phi >= begin) & (phi < end)
    out = np.where(on, loop_shift(d, k, phi), 0.0)
    out = np.where(on & (phi >= d.entries[k]), np.maximum(out, g.spacing), out)
    left = np.clip((math.tau - phi) / (math.tau - end), 0.0, 1.0)  # of what is to be pulled up
    out = np.where(phi >= end, g.spacing, out)
    deep = np.where(on, level, np.where(phi >= end, level * left, np.clip(-depth, 0.0, level)))
    return np.asarray(out), np.asarray(deep)


def course(d: Design, k: int, theta: Floats) -> Points:
    """The thread of needle k over the shaft's angle, (n, 9) complex mm: from above by the eye and three loops to its end.

    The loops are that of the needle on its way down, the one that is being made, and the finished one of the last stitch.
    """
    phi = np.mod(theta, math.tau)
    g = d.given
    x = k * g.spacing
    side = 1 - 2 * k
    eye = d.tips(phi)[k] + g.point[k]
    top = float(d.needle_stroke - g.depths[k] + g.point[k] + _OVER)
    hole = np.full(phi.shape, x + 0j)
    rising = phi < _HALF
    out, deep = loop(d, k, phi)
    dip = x + 1j * np.minimum(eye, 0.0)
    rows = (
        np.full(phi.shape, x + 1j * top),
        x + 1j * np.maximum(eye, g.thickness),
        hole,
        np.where(rising, hole, dip),
        hole,
        np.where(rising, dip, hole),
        x + side * out - 1j * deep,
        hole,
        np.full(phi.shape, x + side * g.spacing + 0j),
    )
    return np.stack(rows, axis=-1)


def sketches(d: Design) -> list[Sketch]:
    """Both threads for the moving picture."""
    return [Sketch(f"thread {k + 1}", course=partial(course, d, k)) for k in (0, 1)]


def lengths(d: Design) -> tuple[Figures, Table]:
    """Of both loops at capture, at the pierce and at shedding: two legs each, mm."""
    rows = []
    found = []
    events = {"capture": d.capture, "pierce": d.entries, "shedding": d.shed}
    for k in (0, 1):
        for event, angles in events.items():
            phi = angles[k]
            if math.isnan(phi):
                continue
            out, deep = (float(each[0]) for each in loop(d, k, np.array([phi])))
            length = 2 * math.hypot(out, deep)
            found.append(Figure(f"loop length {event} {k + 1}", length, "mm"))
            name = f"loop {k + 1}, {event}"
            tilt = math.degrees(math.atan2(out, deep))
            rows.append((name, math.degrees(phi), out, deep, length, tilt))
    columns = (
        "loop",
        "shaft angle, deg",
        "towards the other needle, mm",
        "deep, mm",
        "both legs, mm",
        "to the vertical, deg",
    )
    return Figures(found), Table("Loops in the moving picture", columns, rows)


def seam(d: Design, stitch: float) -> Plot:
    """Figure 1, e: the finished seam from below: thread on top along the feed, loops from hole to hole under the fabric."""
    one = 0.0
    two = d.given.spacing
    rows = np.arange(STITCHES + 1) * stitch
    gap = complex(math.nan, math.nan)

    aside = 0.03 * stitch  # by which the two legs of a loop are drawn apart

    def under(a: float, b: float) -> Points:
        legs: list[complex] = []
        for y in rows[:-1]:
            legs += [complex(a, y + aside), complex(b, y + stitch), complex(a, y - aside), gap]
        return np.array(legs)

    curves = {
        "loops of thread 1": under(one, two),
        "loops of thread 2": under(two, one),
        "on top, both": np.concatenate([one + 1j * rows, [gap], two + 1j * rows]),
    }
    series = [(name, np.real(z), np.imag(z)) for name, z in curves.items()]
    points = [
        (f"{name}{k}", x, float(y))
        for name, x in (("N1.", one), ("N2.", two))
        for k, y in enumerate(rows, 1)
    ]
    title = "Source, figure 1, e: the seam from below, thread on top 2t and under the fabric 4q a stitch"
    return Plot(title, "across, mm", "along the feed, mm", series, equal=True, points=points)


def moments(d: Design) -> Sequence[Plot]:
    """Figure 4: needles and both threads at the capture of loop 1 and at its pierce."""
    plots = []
    g = d.given
    for which, event, phi in (("a", "capture", d.capture[0]), ("b", "pierce", d.entries[0])):
        if math.isnan(phi):
            continue
        theta = np.array([phi])
        tip1, tip2 = (float(height[0]) for height in d.tips(theta))
        nose1, nose2 = (float(way[0]) for way in d.noses(theta))
        threads = [course(d, k, theta)[0] for k in (0, 1)]
        series = [(f"thread {k}", z.real, z.imag) for k, z in enumerate(threads, 1)]
        low, high = g.levels
        noses = (
            np.array([nose1 - d.nose, nose1], complex) - 1j * low,
            np.array([0, d.nose]) + g.spacing - nose2 - 1j * high,
        )
        series += [(f"spreader {k}", z.real, z.imag) for k, z in enumerate(noses, 1)]
        points = [
            ("N1", 0.0, tip1),
            ("N2", g.spacing, tip2),
            ("P1", nose1, -low),
            ("P2", g.spacing - nose2, -high),
        ]
        title = f"Source, figure 4, {which}: {event} of loop 1, {math.degrees(phi):.1f} deg"
        plots.append(
            Plot(title, "across, mm", "over the plate, mm", series, equal=True, points=points)
        )
    return plots
