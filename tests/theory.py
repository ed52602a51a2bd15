"""The figures of the guide's pages, drawn from the specs in specs/ and in the guide. Run `python tests/theory.py` to make them again.

Joints stand where the machine closes at the angle drawn, profiles are those of the cams: nothing is drawn by hand but what
a sign is written beside. A test compares them.
"""

from __future__ import annotations

import cmath
import math
import tomllib
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

import camgen
from camgen.geometry.facets import facet_contour
from camgen.machine.run import solve
from camgen.machines.uniform_swing.pictures import Model

TOP = Path(__file__).resolve().parent.parent
_STYLE = (
    "svg{background:#fff;font:15px Helvetica,Arial,sans-serif}path,circle{fill:none;stroke:#1d2530;stroke-width:1.5}"
    ".link{stroke-width:4;stroke-linecap:round;stroke:#0b5cad}.part{fill:#0b5cad;fill-opacity:.12;stroke:#0b5cad}"
    ".other{stroke:#b4560f}.thin{stroke-width:1;stroke:#5b6675}.dash{stroke-width:1;stroke:#5b6675;stroke-dasharray:6 4}"
    ".joint{fill:#fff;stroke-width:1.8}.dot{fill:#1d2530}text{fill:#1d2530;text-anchor:middle;dominant-baseline:central}"
    ".sign{font-style:italic}.small{font-size:13px}.head{fill:#5b6675;stroke:none}"
)

Place = Callable[[complex], complex]  # from mm, y up, to px, y down


class Picture:
    """Lines, circles, joints and signs in mm, y up. wide: of the picture, px."""

    def __init__(self, title: str, wide: float = 520.0) -> None:
        self.title, self.wide = title, wide
        self.drawn: list[Callable[[Place], str]] = []
        self.reach: list[complex] = []

    def line(self, kind: str, *places: complex, closed: bool = False) -> None:
        """Straight from place to place."""
        self.reach += places
        end = "Z" if closed else ""
        self.drawn.append(
            lambda at: f'<path class="{kind}" d="M{"L".join(_xy(at(z)) for z in places)}{end}"/>'
        )

    def curve(self, kind: str, places: Any, closed: bool = False) -> None:
        """Through many places, (n,) complex."""
        self.line(kind, *np.asarray(places, complex).tolist(), closed=closed)

    def circle(self, kind: str, middle: complex, radius: float) -> None:
        """About a middle."""
        self.curve(kind, middle + radius * np.exp(2j * np.pi * np.arange(96) / 96), closed=True)

    def joint(
        self, name: str, place: complex, beside: complex = 14 + 12j, kind: str = "joint"
    ) -> None:
        """A named point; beside: from it to its name, px, y up."""
        self.reach.append(place)
        radius = 4 if kind == "joint" else 2.5
        self.drawn.append(
            lambda at: (
                f'<circle class="{kind}" cx="{at(place).real:.1f}" cy="{at(place).imag:.1f}" r="{radius}"/>'
            )
        )
        self.sign(name, place, beside, "name")

    def sign(self, text: str, place: complex, beside: complex = 0j, kind: str = "sign") -> None:
        """A sign so many px beside a place, y up; one word after _ stands lower."""
        self.reach.append(place)
        head, _, rest = escape(text).partition("_")
        low, _, tail = rest.partition(" ")
        low = f'<tspan font-size="11" dy="5">{low}</tspan>' if low else ""
        tail = f'<tspan dy="-5"> {tail}</tspan>' if tail else ""

        def drawn(at: Place) -> str:
            z = at(place) + beside.conjugate()
            return (
                f'<text class="{kind}" x="{z.real:.1f}" y="{z.imag:.1f}">{head}{low}{tail}</text>'
            )

        self.drawn.append(drawn)

    def named(self, text: str, place: complex, beside: complex) -> None:
        """What a curve is called, at the end of a thin line from a place on it, px, y up."""
        self.reach.append(place)

        def drawn(at: Place) -> str:
            z = at(place)
            end = z + beside.conjugate()
            anchor, gap = ("start", 4) if beside.real > 0 else ("end", -4)
            return (
                f'<path class="thin" d="M{_xy(z)}L{_xy(end)}"/><circle class="dot" cx="{z.real:.1f}" cy="{z.imag:.1f}" r="1.8"/>'
                f'<text class="small" style="text-anchor:{anchor}" x="{end.real + gap:.1f}" y="{end.imag:.1f}">'
                f"{escape(text)}</text>"
            )

        self.drawn.append(drawn)

    def angle(
        self, text: str, corner: complex, a: complex, b: complex, radius: float, beyond: float = 14
    ) -> None:
        """An arc about a corner from the direction of a to that of b, the shorter way, its sign so many px beyond the middle."""
        begin, sweep = cmath.phase(a - corner), cmath.phase((b - corner) / (a - corner))
        self.curve("thin", corner + radius * np.exp(1j * (begin + sweep * np.linspace(0, 1, 25))))
        way = cmath.rect(1, begin + sweep / 2)
        self.sign(text, corner + radius * way, beyond * way)

    def size(
        self, text: str, a: complex, b: complex, away: complex = 0j, beside: complex = 0j
    ) -> None:
        """A distance between two places, drawn so far (mm) from them; beside: its sign from its middle, px, y up."""
        for end in (a, b) if away else ():
            self.line("thin", end, end + 1.1 * away)
        self.arrow("thin", a + away, b + away, both=True)
        way = away / abs(away) if away else 1j * (b - a) / abs(b - a)
        self.sign(text, (a + b) / 2 + away, beside or 13 * way)

    def arrow(self, kind: str, a: complex, b: complex, both: bool = False) -> None:
        """A line with a head at b, or at both ends."""
        self.line(kind, a, b)
        self.drawn.append(lambda at: _head(at(b), at(a)) + (_head(at(a), at(b)) if both else ""))

    def svg(self) -> str:
        """The picture as a file of its own."""
        reach = np.array(self.reach)
        margin, left, top = 32.0, reach.real.min(), reach.imag.max()
        scale = (self.wide - 2 * margin) / np.ptp(reach.real)
        tall = scale * np.ptp(reach.imag) + 2 * margin
        inside = "".join(
            draw(
                lambda z: complex(margin + scale * (z.real - left), margin + scale * (top - z.imag))
            )
            for draw in self.drawn
        )
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.wide:.0f} {tall:.0f}" width="{self.wide:.0f}" '
            'role="img">'
            f"<title>{escape(self.title)}</title><style>{_STYLE}</style>{inside}</svg>\n"
        )


def _xy(z: complex) -> str:
    return f"{z.real:.1f} {z.imag:.1f}"


def _head(tip: complex, tail: complex) -> str:
    """An arrowhead of 8 px."""
    way = (tail - tip) / abs(tail - tip)
    return f'<path class="head" d="M{_xy(tip)}L{_xy(tip + way * (8 + 2.6j))}L{_xy(tip + way * (8 - 2.6j))}Z"/>'


def _load(name: str, **changed: Any) -> Any:
    """A spec of specs/, tables merged with what is changed."""
    spec = camgen.load(TOP / "specs" / f"{name}.toml")
    if not changed:
        return spec
    given: Any = spec.model_dump(by_alias=True, exclude_none=True)
    for key, value in changed.items():
        given[key] = given[key] | value
    return camgen.load(given)


def _joints(mechanism: Any, theta: float, *names: tuple[str, str]) -> list[complex]:
    """Places of (body, point) at the angle theta of the drive, mm."""
    run = solve(mechanism.model, np.array([theta]))
    return [complex(np.ravel(run.point(body, point))[0]) for body, point in names]


# ---- the figures -----------------------------------------------------------------------------------------------------


def disc_cam() -> Picture:
    """A sliding roller beside the shaft, in the middle of its rise."""
    spec = _load(
        "disc-cam",
        geometry={
            "base_radius": 18,
            "follower": {"motion": "translating", "shape": "roller", "radius": 8, "offset": 5},
        },
    )
    cam, base, roller, beside = spec.cams[0], 18.0, 8.0, 5.0
    theta = math.radians(50)
    turn = cmath.exp(1j * theta)
    trace, touch = turn * complex(cam.pitch(theta)), turn * complex(cam.profile(theta))
    rest = math.sqrt((base + roller) ** 2 - beside**2)
    all_round = np.linspace(0, math.tau, 361)
    fig = Picture("Disc cam with a sliding roller: circles, curves and pressure angle", 600)
    fig.reach.append(-46 + 0j)  # room for names
    fig.curve("part", turn * facet_contour(cam.outline, 0.05), closed=True)
    fig.curve("dash", turn * cam.pitch(all_round), closed=True)
    fig.circle("thin", 0j, base)
    fig.circle("thin", 0j, base + roller)
    fig.circle("other", trace, roller)
    fig.line("dash", beside - 1j * 8, complex(beside, trace.imag + 30))
    fig.line("link", trace, trace + 26j)
    normal = (trace - touch) / abs(trace - touch)
    fig.arrow("other", touch, trace + 26 * normal)
    fig.angle("α", trace, trace + 1j, trace + normal, 20)
    fig.named("push", trace + 22 * normal, -16 - 6j)
    fig.named("profile", turn * complex(cam.profile(math.radians(170))), 64 - 12j)
    fig.named("pitch curve", turn * complex(cam.pitch(math.radians(185))), 26 - 22j)
    fig.named("base circle", cmath.rect(base, math.radians(165)), -62 - 12j)
    fig.named("prime circle", cmath.rect(base + roller, math.radians(140)), -24 + 24j)
    fig.line("thin", 8 + 1j * rest, complex(beside + 32, rest))
    fig.line("thin", trace, trace + 32)
    fig.size("s", complex(beside + 28, rest), complex(beside + 28, trace.imag), beside=12 + 0j)
    fig.line("thin", 0j, complex(base + 32))
    fig.size("d", complex(beside + 28, 0), complex(beside + 28, rest), beside=-12 + 0j)
    fig.size("e", -6j, beside - 6j, beside=-12j)
    for radius, deg, text in ((base, 200, "r_b"), (base + roller, 225, "r_p")):
        end = cmath.rect(radius, math.radians(deg))
        fig.arrow("thin", 0j, end)
        fig.sign(text, 0.6 * end, 12j * end / abs(end))
    fig.arrow("thin", trace, trace + cmath.rect(roller, math.radians(165)))
    fig.sign("r_f", trace + cmath.rect(roller, math.radians(165)), -12 + 0j)
    fig.arrow(
        "thin", cmath.rect(base + 16, math.radians(-62)), cmath.rect(base + 16, math.radians(-55))
    )
    fig.curve("thin", (base + 16) * np.exp(1j * np.radians(np.linspace(-85, -57, 25))))
    fig.sign("θ", cmath.rect(base + 16, math.radians(-72)), 12 - 16j)
    fig.joint("O", 0j, 12 + 12j)
    fig.joint("T", trace, 14 + 12j)
    return fig


def first_cam() -> Picture:
    """The cam of specs/disc-cam.toml at the end of its rise, and beside it how high its follower stands over the turn."""
    spec = _load("disc-cam")
    cam = spec.cams[0]
    roller = spec.geometry.follower.radius
    base = spec.geometry.base_radius
    spans = [(each.kind, math.degrees(each.span)) for each in spec.program.segments]
    theta = math.radians(spans[0][1])
    turn = cmath.exp(1j * theta)
    trace = turn * complex(cam.pitch(theta))
    wide = 0.3  # mm of the chart for a degree
    origin = base + 30 + 1j * base  # of the chart: its heights are those of the follower beside it
    fig = Picture("A cam and its follower's motion: rise, dwell, return, dwell", 640)
    fig.curve("part", turn * facet_contour(cam.outline, 0.05), closed=True)
    fig.circle("thin", 0j, base)
    fig.circle("part", 0j, spec.making.bore / 2)
    fig.circle("other", trace, roller)
    fig.line("link", trace, trace + 18j)
    fig.named("cam", turn * complex(cam.profile(math.radians(200))), 20 - 14j)
    fig.named("base circle", cmath.rect(base, math.radians(250)), 26 + 30j)
    fig.named("follower", trace + 15j, -24 + 6j)
    way = np.linspace(0, 360, 721)
    lift = np.asarray(spec.program(np.radians(way)), float)
    fig.curve("link", origin + wide * way + 1j * lift)
    fig.arrow("thin", origin - 4j, origin + wide * 385 - 4j)
    fig.sign("cam angle", origin + wide * 340 - 4j, -12j, "small")
    fig.line(
        "dash",
        trace - roller * 1j,
        complex((origin + wide * spans[0][1]).real, (trace - roller * 1j).imag),
    )
    begin = 0.0
    for kind, span in spans:
        fig.line("dash", origin + wide * begin - 4j, origin + wide * begin + 1j * (lift.max() + 12))
        middle = origin + wide * (begin + span / 2) + 1j * (lift.max() + 9)
        fig.sign(kind, middle, 8j, "small")
        fig.sign(f"{span:.0f} deg", middle, -8j, "small")
        begin += span
    peak = origin + wide * 370
    fig.size("lift", peak, peak + 1j * float(lift.max()), beside=20 + 0j)
    return fig


def swinging_roller() -> Picture:
    """An arm with a roller, in the middle of its rise."""
    base, roller, c, a, theta = 30.0, 8.0, 70.0, 56.0, math.radians(50)
    follower = {
        "motion": "oscillating",
        "shape": "roller",
        "radius": roller,
        "pivot_distance": c,
        "arm": a,
    }
    segments = [
        {"kind": "rise", "span_deg": 100, "lift": 24, "law": "cycloidal"},
        {"kind": "return", "span_deg": 100, "to": 0, "law": "cycloidal"},
        {"kind": "dwell", "span_deg": 160},
    ]
    geometry = {"base_radius": base, "follower": follower}
    spec = camgen.load(
        {"mechanism": "disc-cam", "name": "arm", "geometry": geometry, "segment": segments}
    )
    cam = spec.cams[0]
    turn = cmath.exp(1j * theta)
    trace, touch = turn * complex(cam.pitch(theta)), turn * complex(cam.profile(theta))
    normal, pivot = (trace - touch) / abs(trace - touch), complex(c)
    rest = pivot - a * cmath.exp(1j * math.acos((c**2 + a**2 - (base + roller) ** 2) / (2 * c * a)))
    way = -1j * (trace - pivot) / a  # of the trace point, as the arm rises
    way = -way if (way / normal).real < 0 else way
    fig = Picture("Disc cam with a swinging roller: arm, angle, pressure angle", 600)
    fig.reach.append(-66 + 0j)  # room for names
    fig.curve("part", turn * facet_contour(cam.outline, 0.05), closed=True)
    fig.curve("dash", turn * cam.pitch(np.linspace(0, math.tau, 361)), closed=True)
    fig.circle("thin", 0j, base + roller)
    fig.line("thin", 0j, pivot)
    fig.line("dash", pivot, rest)
    fig.line("link", pivot, trace)
    fig.circle("other", trace, roller)
    fig.arrow("other", touch, trace + 26 * normal)
    fig.line("dash", trace, trace + 26 * way)
    fig.angle("α", trace, trace + way, trace + normal, 20)
    fig.named("push", trace + 22 * normal, 18 - 6j if normal.real > way.real else -18 - 6j)
    fig.angle("γ_0", pivot, 0j, rest, 14)
    fig.angle("γ", pivot, 0j, trace, 24)
    fig.sign("a", (trace + pivot) / 2, 12j * (trace - pivot) / a)
    fig.sign("c", 0.62 * pivot, 11j)
    end = cmath.rect(base + roller, math.radians(125))
    fig.arrow("thin", 0j, end)
    fig.sign("r_p", 0.6 * end, 12j * end / abs(end))
    fig.named("prime circle", cmath.rect(base + roller, math.radians(152)), -24 + 14j)
    fig.named("pitch curve", turn * complex(cam.pitch(math.radians(150))), -22 - 12j)
    fig.named("profile", turn * complex(cam.profile(math.radians(165))), 26 + 4j)
    fig.joint("O", 0j, -12 + 12j)
    fig.joint("C", pivot, 14 + 10j)
    fig.joint("T", trace, -14 - 6j)
    return fig


def flat_face() -> Picture:
    """A flat face touches beside its middle."""
    spec = _load(
        "disc-cam",
        geometry={"base_radius": 40, "follower": {"motion": "translating", "shape": "flat"}},
    )
    cam = spec.cams[0]
    theta = math.radians(40)
    touch = cmath.exp(1j * theta) * complex(cam.profile(theta))
    fig = Picture("Disc cam with a flat face: it touches at ds/dθ beside the middle")
    fig.curve("part", cmath.exp(1j * theta) * facet_contour(cam.outline, 0.05), closed=True)
    fig.circle("thin", 0j, spec.base_radius)
    fig.line("link", complex(-18, touch.imag), complex(26, touch.imag))
    fig.line("link", 1j * touch.imag, 1j * (touch.imag + 18))
    fig.line("dash", -8j, 1j * touch.imag)
    fig.size("ds/dθ", 1j * touch.imag, touch, 8j, 12j)
    fig.line("thin", 0j, 62 + 0j)
    fig.line("thin", complex(26, touch.imag), complex(62, touch.imag))
    fig.size("h", 56 + 0j, complex(56, touch.imag), beside=12 + 0j)
    fig.arrow("thin", 0j, cmath.rect(spec.base_radius, math.radians(200)))
    fig.sign("r_b", cmath.rect(0.6 * spec.base_radius, math.radians(200)), 12j)
    fig.joint("O", 0j)
    fig.joint("", touch, 0j, "dot")
    return fig


def uniform_swing() -> Picture:
    """Cam and follower in the middle of the swing, the tip at both ends."""
    spec = _load("uniform-swing")
    g = spec.geometry
    model = Model(g.pivot_distance, g.arm_offset, math.radians(g.swing_deg), spec.cam)
    ends = model.alpha_1, model.alpha_1 + model.swing
    middle = model.alpha_1 + model.swing / 2
    tips, b, c = (
        [complex(model.tip(a)) for a in ends],
        complex(model.corner(middle)),
        complex(model.tip(middle)),
    )
    a = complex(model.pivot)
    fig = Picture("Uniform swing: cam, follower ABC in its middle, its tip at both ends", 640)
    fig.curve("part", np.exp(0.5j * math.pi) * facet_contour(spec.cam.outline, 0.05), closed=True)
    fig.curve("dash", model.tip(np.linspace(*ends, 61)))
    fig.line("thin", 0j, a)
    fig.line("thin", 0j, -1.2j * abs(tips[1]))
    for k, tip in enumerate(tips, 1):
        fig.line("thin", a, tip)
        fig.line("thin", 0j, tip)
        fig.sign(f"r_{k}", 0.5 * tip, (-14 + 4j, 16 + 6j)[k - 1])
        fig.angle(f"α_{k}", a, 0j, tip, (34, 22)[k - 1])
        fig.angle(f"β_{k}", 0j, -1j, tip, (11, 36)[k - 1])
        fig.joint(f"C_{k}", tip, (-18 + 0j, 16 - 8j)[k - 1], "dot")
    fig.line("link", a, b, c)
    fig.circle("other", c, g.tip_radius)
    fig.sign("R", (a + tips[1]) / 2, -4 - 14j)
    fig.size("L", 0j, a, 10j)
    fig.size("H", a, b, 8 + 0j)
    fig.sign("L", (b + c) / 2, -14j)
    fig.joint("O", 0j, -12 + 12j)
    fig.joint("A", a)
    fig.joint("B", b, 14 - 10j)
    fig.joint("C", c, -18 - 14j)
    return fig


def eccentric_drive() -> Picture:
    """Lengths changed for the eye: the true eccentricity is a thirtieth of the rod."""
    spec = _load("eccentric-drive")
    names = ("disc", "O"), ("disc", "E"), ("rod", "P")
    o, e, _ = _joints(spec, math.radians(60), *names)
    e, rod = 12 * e, 60.0  # drawn so
    p = complex(e.real + math.sqrt(rod**2 - e.imag**2), 0)
    fig = Picture("Eccentric drive: the crank is a disc about E")
    fig.circle("part", e, 26)
    fig.line("dash", o - 12, p + 20)
    fig.line("link", e, p)
    fig.line("other", o, e)
    fig.curve("part", [p - 5 - 4j, p + 9 - 4j, p + 9 + 4j, p - 5 + 4j], closed=True)
    fig.angle("p", o, p, e, 9)
    fig.sign("l_1", (o + e) / 2, -12 + 8j)
    fig.sign("l_2", (e + p) / 2, 8 + 14j)
    fig.size("x", o, p, -14j)
    fig.arrow("other", p + 9, p + 20)
    fig.joint("O", o, -13 - 12j)
    fig.joint("E", e, 2 + 16j)
    fig.joint("P", p, 2 + 30j)
    return fig


def thread_take_up() -> Picture:
    """The four-bar with its eye, the guides drawn nearer."""
    spec = _load("thread-take-up")
    o, a, b, c, d = _joints(
        spec,
        math.radians(75),
        ("crank", "O"),
        ("crank", "A"),
        ("coupler", "B"),
        ("ground", "C"),
        ("coupler", "D"),
    )
    fig = Picture("Thread take-up: four-bar O-A-B-C with the eye D, thread from M over D to N", 420)
    m, n = _joints(spec, 0.0, ("ground", "M"), ("ground", "N"))
    towards_n = d + 72 * (n - d) / abs(n - d)  # it is far
    fig.line("part", a, b, d, closed=True)
    fig.line("link", o, a)
    fig.line("link", a, b)
    fig.line("link", b, d)
    fig.line("link", c, b)
    fig.line("thin", o, c)
    fig.line("dash", a, c)
    fig.line("other", m, d)
    fig.arrow("other", d, towards_n)
    fig.sign("l_1", (o + a) / 2, -13 + 0j)
    fig.sign("l_2", (a + b) / 2, 13j)
    fig.sign("l_3", (b + c) / 2, 14 + 0j)
    fig.sign("l_0", (o + c) / 2, -13j)
    fig.sign("q", (a + c) / 2, -10 - 6j)
    fig.angle("θ", o, c, a, 5)
    fig.angle("μ", b, a, c, 6)
    fig.angle("β", b, a, d, 11)
    for name, place, beside in (
        ("O", o, -13 - 10j),
        ("A", a, -14 + 8j),
        ("B", b, 14 + 8j),
        ("C", c, 18 + 2j),
        ("D", d, 14 - 8j),
    ):
        fig.joint(name, place, beside)
    fig.joint("M", m, 14 + 8j, "dot")
    fig.sign("to N", towards_n, 26 + 0j, "name")
    return fig


def chain_stitch() -> Picture:
    """The lower spreader from the side at the capture: its nose's tip on its needle's line."""
    spec = _load("chain-stitch-looper")
    d, g = spec.design, spec.stitch
    h, over = g.point[0], g.over_eye[0]
    fig = Picture("Chain stitch: a spreader at the capture, from the side")
    side, front = spec.bodies.side_outline(), spec.bodies.section_outline()
    far = d.nose + 5  # the blade is drawn as far as this
    for kind, contour in (("part", side), ("part other", front)):
        z = facet_contour(contour, 0.05)
        fig.curve(kind, [complex(min(w.real, far), w.imag) for w in z.tolist()], closed=True)
    fig.line("dash", -4, complex(far))
    wide = g.needle / 2
    fig.curve(
        "part",
        [
            -1j * (over + h),
            wide - 1j * (over + h - 2),
            wide + 5j,
            -wide + 5j,
            -wide - 1j * (over + h - 2),
        ],
        closed=True,
    )
    fig.curve(
        "other",
        [
            complex(x, -over + y)
            for x, y in ((-wide / 3, 0), (wide / 3, 0), (wide / 3, -1), (-wide / 3, -1))
        ],
        closed=True,
    )
    fig.size("h", -1j * over, -1j * (over + h), -2.5)
    fig.size("a", 0j, -1j * over, -2.5)
    low, c = complex(d.l1), complex(d.nose, g.height)
    fig.size("l_1", 0j, low, -1j * (g.protrusion + 2.4))
    fig.size("l_2", low, complex(c.real, 0), -1j * (g.protrusion + 2.4))
    fig.size("A", 0j, complex(c.real, 0), -1j * (g.protrusion + 4.6))
    fig.size("l_3", 0j, complex(d.l3), -1j * (g.protrusion + 0.7), -13j)
    fig.size("b", complex(far, 0), complex(far, g.height), 1.2)
    fig.size("l_H", complex(far, -g.protrusion), complex(far, 0), 1.2)
    fig.joint("V_0", 0j, -20 + 10j, "dot")
    fig.joint("V_1", complex(d.l3), -8 + 14j, "dot")
    fig.joint("B", low, 6 - 14j, "dot")
    fig.joint("C", c, 4 + 14j, "dot")
    return fig


def indexing_cam() -> Picture:
    """Cam, follower with its wheel, and the table's pinion."""
    spec = _load("indexing-cam")
    cam = next(iter(spec.cams.values()))
    follower = cam.follower
    theta = math.radians(40)
    o, a, table = 0j, complex(follower.pivot), complex(spec.link_centre)
    turn = cmath.exp(1j * theta)
    c = turn * complex(cam.pitch(theta))
    ratio = spec.geometry.gear_ratio
    pinion = abs(table - a) / (1 + ratio)
    fig = Picture("Indexing cam: cam, follower with its wheel, table with its pinion")
    fig.curve("part", turn * facet_contour(cam.outline, 0.05), closed=True)
    fig.circle("thin", a, pinion * ratio)
    fig.circle("thin", table, pinion)
    fig.line("dash", o, table + 1.6 * pinion)
    fig.line("link", a, c)
    fig.circle("other", c, follower.tip_radius)
    fig.size("pivot distance", o, a, -1j * 1.25 * pinion * ratio, -12j)
    fig.sign("arm", (a + c) / 2, -8 + 14j)
    fig.sign("cam", -0.5 * pinion * ratio, 0j, "small")
    fig.named("gear", a + cmath.rect(pinion * ratio, math.radians(125)), -20 + 22j)
    fig.named("pinion", table + pinion * 1j, 6 + 34j)
    fig.joint("O", o)
    fig.joint("A", a)
    fig.joint("C", c, 18 - 6j)
    fig.joint("T", table, 16 - 14j)
    return fig


def four_bar() -> Picture:
    """The four-bar of specs/linkage.toml."""
    o, a, b, c = _joints(
        _load("linkage"),
        math.radians(60),
        ("crank", "O"),
        ("crank", "A"),
        ("coupler", "B"),
        ("ground", "C"),
    )
    fig = Picture("Four-bar: crank a, coupler b, rocker c, ground d, diagonal q")
    for p, r in ((o, a), (a, b), (b, c)):
        fig.line("link", p, r)
    fig.line("thin", o, c)
    fig.line("dash", a, c)
    fig.circle("dash", o, abs(a))
    for text, p, r, beside in (
        ("a", o, a, -12 + 6j),
        ("b", a, b, 13j),
        ("c", b, c, 14 + 0j),
        ("d", o, c, -13j),
        ("q", a, c, 8 + 10j),
    ):
        fig.sign(text, (p + r) / 2, beside)
    fig.angle("θ", o, c, a, 8)
    fig.angle("μ", b, a, c, 10)
    for name, place, beside in (
        ("O", o, -14 - 10j),
        ("A", a, -10 + 14j),
        ("B", b, 10 + 14j),
        ("C", c, 14 - 10j),
    ):
        fig.joint(name, place, beside)
    return fig


def own_linkage() -> Picture:
    """The four-bar of the guide's page on linkages, with what its tables say."""
    page = (TOP / "camgen" / "guide" / "own-linkage.md").read_text(encoding="utf-8")
    block = page.partition("```toml\n")[2].partition("```")[0]
    tables = tomllib.loads(block)
    spec = camgen.load(tables)
    links = {name: points for name, points in tables["links"].items() if name != "ground"}
    carriers = {point: name for name, points in links.items() for point in points}
    names = ("O", "A", "B", "C")
    places = dict(
        zip(names, _joints(spec, 0.0, *((carriers[name], name) for name in names)), strict=True)
    )
    fig = Picture("A four-bar by its points, links and lengths", 520)
    for beside, (name, (a, b)) in zip((-14j, 34 - 8j, -30 - 8j), links.items(), strict=True):
        fig.line("link", places[a], places[b])
        fig.sign(name, (places[a] + places[b]) / 2, beside, "small")
    for key, length in tables["lengths"].items():
        a, b = (places[name] for name in key.split("-"))
        fig.size(f"{length:g}", a, b, away=8j * (b - a) / abs(b - a) * (1 if key == "A-B" else -1))
    for name in tables["links"]["ground"]:
        for k in range(5):
            foot = places[name] - 6j + 2.5 * (k - 2)
            fig.line("thin", foot, foot - 2 - 3j)
        fig.line("thin", places[name], places[name] - 5 - 6j, places[name] + 5 - 6j, closed=True)
    fig.sign("ground", (places["O"] + places["C"]) / 2 - 8j, 0j, "small")
    for name, beside in (("O", -16 + 4j), ("A", 12 - 14j), ("B", 14 + 12j), ("C", 20 - 12j)):
        fig.joint(name, places[name], beside)
    turn = 12 * np.exp(1j * np.radians(np.linspace(15, 100, 25)))
    fig.curve("other", turn)
    fig.arrow("other", complex(turn[-2]), complex(turn[-1]))
    fig.sign("drive", complex(turn[12]), 12 + 20j, "small")
    return fig


def quick_return() -> Picture:
    """The arm of specs/quick-return.toml at both ends of its swing, and between."""
    o, d, a, e = _joints(
        _load("quick-return"),
        math.radians(75),
        ("crank", "O"),
        ("arm", "D"),
        ("crank", "A"),
        ("arm", "E"),
    )
    half = math.asin(abs(a - o) / abs(d - o))
    fig = Picture("Quick return: the arm swings by α", 380)
    fig.circle("dash", o, abs(a))
    for side in (1, -1):
        way = cmath.rect(1, math.pi / 2 + side * half)
        fig.line("thin", d, d + abs(e - d) * way)
        fig.line("dash", o, d + math.sqrt(abs(o - d) ** 2 - abs(a - o) ** 2) * way)  # square to it
    fig.line("link", d, e)
    fig.line("other", o, a)
    fig.line("dash", o, d)
    fig.angle(
        "", d, d + cmath.rect(1, math.pi / 2 + half), d + cmath.rect(1, math.pi / 2 - half), 24
    )
    fig.sign("α", d + cmath.rect(24, math.pi / 2 - half / 2), 14j)
    fig.sign("a", (o + a) / 2, -12 + 4j)
    fig.sign("d", (o + d) / 2, -10 - 30j)
    for name, place, beside in (
        ("O", o, -14 - 8j),
        ("A", a, 14 + 2j),
        ("D", d, 14 - 8j),
        ("E", e, 14 + 8j),
    ):
        fig.joint(name, place, beside)
    return fig


FIGURES: Mapping[str, Callable[[], Picture]] = {
    "first-cam": first_cam,
    "own-linkage": own_linkage,
    "disc-cam": disc_cam,
    "swinging-roller": swinging_roller,
    "flat-face": flat_face,
    "uniform-swing": uniform_swing,
    "eccentric-drive": eccentric_drive,
    "thread-take-up": thread_take_up,
    "chain-stitch-looper": chain_stitch,
    "indexing-cam": indexing_cam,
    "four-bar": four_bar,
    "quick-return": quick_return,
}


def path(name: str) -> Path:
    """Where the guide finds it."""
    return TOP / "camgen" / "guide" / f"{name}.svg"


if __name__ == "__main__":
    for name, made in FIGURES.items():
        path(name).write_text(made().svg(), encoding="utf-8")
