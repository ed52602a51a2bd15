"""Machines that everybody knows, drawn roughly in one position with exact lengths; used by the tests of the model."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from hypothesis import strategies as st

from camgen.machine import (
    GROUND,
    Along,
    Angle,
    Body,
    Cam,
    Drive,
    Force,
    Function,
    Gear,
    Gravity,
    Joint,
    Machine,
    Output,
    Path,
    Pin,
    Place,
    Pose,
    Slide,
    Slot,
    Spring,
    Turning,
    thread_length,
)
from camgen.machine.freedom import close_drawing
from camgen.machine.model import Floats


@dataclass(frozen=True)
class Wave:
    """A law: middle + size * cos(times * theta - late)."""

    middle: float
    size: float
    times: float = 1.0
    late: float = 0.0

    def __call__(self, theta: Floats, order: int = 0) -> Floats:
        value = (
            self.size
            * self.times**order
            * np.cos(self.times * theta - self.late + order * math.pi / 2)
        )
        return value + self.middle if order == 0 else value


def linked(
    points: Mapping[str, complex],
    links: Mapping[str, str],
    crank: str,
    lengths: Mapping[str, float] | None = None,
    joints: Sequence[Joint] = (),
    law: Any = None,
    masses: Mapping[str, Mapping[str, Any]] | None = None,
    **keys: Any,
) -> Machine:
    """Links by the points they carry ("A B C"), pinned where they share one; a link's frame: first point, x to the second.

    lengths: "A-B" of a two-point link; the drawing is closed on them.
    """
    named = {name: names.split() for name, names in links.items()}
    lengths = lengths or {}
    bodies, start, holders = [], {}, dict[str, list[str]]()
    for name, carried in named.items():
        for point in carried:
            holders.setdefault(point, []).append(name)
        if name == GROUND:
            bodies.append(Body(GROUND, {p: complex(points[p]) for p in carried}))
            continue
        first = points[carried[0]]
        way = points[carried[1]] - first if len(carried) > 1 else 1.0
        own = {p: (points[p] - first) / (way / abs(way)) for p in carried}
        length = lengths.get("-".join(carried)) if len(carried) == 2 else None
        if length:
            own[carried[1]] = complex(length)
        bodies.append(Body(name, own, **(masses or {}).get(name, {})))
        start[name] = Pose(complex(first), float(np.angle(way)))
    by_name = {body.name: body for body in bodies}
    pins = []
    for point, who in holders.items():
        for k, other in enumerate(who[1:]):
            pins.append(
                Pin(
                    point if k == 0 else f"{point}{k + 1}",
                    by_name[other].at(point),
                    by_name[who[0]].at(point),
                    0.1,
                )
            )
    law = law or Turning(1.0, start[crank].angle)
    outputs = keys.pop("outputs", ())
    drives = keys.pop("drives", (Drive("motor", crank, law),))
    return close_drawing(
        Machine(tuple(bodies), (*pins, *joints), drives, start, outputs=outputs, **keys)
    )


def at(points: Mapping[str, complex], links: Mapping[str, str], name: str, point: str) -> Place:
    """A point in a link's frame, by the drawing."""
    carried = links[name].split()
    if name == GROUND:
        return Place(GROUND, points[point])
    way = points[carried[1]] - points[carried[0]]
    return Place(name, (points[point] - points[carried[0]]) / (way / abs(way)))


def four_bar(
    frame: float, crank: float, coupler: float, rocker: float, branch: int = 1, **keys: Any
) -> Machine:
    """O, C on the ground, crank O-A along x at theta = 0; branch +1: B to the left of the way from A to C."""
    way = frame - crank
    far = abs(way)
    x = (coupler**2 - rocker**2 + far**2) / (2 * far)
    y = math.sqrt(max(coupler**2 - x**2, 0.0))
    b = crank + way / far * complex(x, branch * y)
    points = {"O": 0j, "C": complex(frame), "A": complex(crank), "B": b}
    links = {GROUND: "O C", "crank": "O A", "coupler": "A B", "rocker": "C B"}
    lengths = {"A-B": coupler, "C-B": rocker}
    outputs = (
        Output("rocker", Angle("rocker"), "rad"),
        Output("B", Path(Place("coupler", coupler))),
    )
    return linked(points, links, "crank", lengths, outputs=outputs, **keys)


@st.composite
def closing_four_bars(draw: Any) -> tuple[float, float, float, float]:
    """Frame, crank, coupler, rocker that close over the whole turn with half a millimetre to spare."""
    short, spare = draw(st.floats(5, 30)), draw(st.floats(3, 40))
    frame, crank = draw(st.sampled_from([(short, short + spare), (short + spare, short)]))
    total, differ = frame + crank + draw(st.floats(0.5, 40)), (spare - 0.5) * draw(st.floats(-1, 1))
    return frame, crank, (total + differ) / 2, (total - differ) / 2


def take_up(interchanged: bool = False, low: bool = True) -> Machine:
    """The two-crank take-up of the paper with masses, its eye D and thread over M and N."""
    l2, l3 = (19.0, 30.0) if interchanged else (30.0, 19.0)
    centre = (15 - 10j, l3 / 2) if low else ((30 + 30 - 52j) / 3, l3 / 3)
    eye = Place("coupler", complex(l2, -52))
    guides = (Place(GROUND, 40 + 15j), eye, Place(GROUND, -80 + 160j))
    masses = {
        "coupler": {"mass": 6.3e-3, "centre": centre[0], "inertia": 5.1e-6},
        "rocker": {"mass": 8.3e-3, "centre": centre[1], "inertia": 2.5e-6},
    }
    base = four_bar(9, 30, l2, l3, 1, masses=masses, speed=5000 * math.tau / 60)
    outputs = (
        *base.outputs,
        Output("D", Path(eye)),
        Output("thread", Function(guides, thread_length)),
    )
    return Machine(base.bodies, base.joints, base.drives, base.start, (), outputs, base.speed)


def slider_crank(
    crank: float = 1.5, rod: float = 48.0, offset: float = 0.0, **keys: Any
) -> Machine:
    """In line or offset; the slider's place counts from O along x."""
    b = complex(crank + math.sqrt(rod**2 - offset**2), offset)
    points = {"O": 0j, "A": complex(crank), "B": b}
    links = {GROUND: "O", "crank": "O A", "rod": "A B", "ram": "B"}
    slide = Slide("guide", Place(GROUND, 1j * offset), Place("ram", 0j), clearance=0.05)
    return linked(
        points,
        links,
        "crank",
        {"A-B": rod},
        (slide,),
        outputs=(Output("way", Along("guide")),),
        **keys,
    )


def scotch_yoke(crank: float = 10.0) -> Machine:
    """A pin in a slot across the slide: way = crank cos theta, exactly."""
    bodies = (Body(GROUND), Body("crank", {"O": 0, "A": crank}), Body("yoke", {}, 0.2))
    joints = (
        Pin("O", Place("crank"), Place(GROUND), 0.02),
        Slide("guide", Place(GROUND), Place("yoke"), clearance=0.02),
        Slot("slot", Place("yoke"), Place("crank", crank), math.pi / 2, 0.02),
    )
    start = {"crank": Pose(0j, 0.0), "yoke": Pose(complex(crank), 0.0)}
    return Machine(
        bodies,
        joints,
        (Drive("motor", "crank"),),
        start,
        outputs=(Output("way", Along("guide")),),
        speed=7.0,
    )


def whitworth(crank: float = 20.0, frame: float = 40.0) -> Machine:
    """Crank about O, arm about C at -i frame; the crank's pin slides in the arm's slot (crank-shaper: crank < frame)."""
    bodies = (Body(GROUND), Body("crank", {"A": crank}), Body("arm"))
    joints = (
        Pin("O", Place("crank"), Place(GROUND)),
        Pin("C", Place("arm"), Place(GROUND, -1j * frame)),
        Slot("slot", Place("arm"), Place("crank", crank)),
    )
    start = {"crank": Pose(0j, 0.0), "arm": Pose(-1j * frame, math.atan2(frame, crank))}
    return Machine(
        bodies,
        joints,
        (Drive("motor", "crank"),),
        start,
        outputs=(Output("arm", Angle("arm"), "rad"),),
    )


def peaucellier(long: float = 50.0, short: float = 20.0, ground: float = 25.0) -> Machine:
    """O at 0, Q at `ground`, crank Q-P; long arms from O to A, B; rhombus P A R B. R runs on a straight line."""
    p = ground + ground * np.exp(0.3j)
    middle = abs(p)
    half = (long**2 - short**2 + middle**2) / (2 * middle)
    side = math.sqrt(long**2 - half**2)
    e = p / middle
    points = {
        "O": 0j,
        "Q": complex(ground),
        "P": p,
        "A": e * complex(half, side),
        "B": e * complex(half, -side),
    }
    points["R"] = points["A"] + points["B"] - p
    links = {
        GROUND: "O Q",
        "crank": "Q P",
        "oa": "O A",
        "ob": "O B",
        "pa": "P A",
        "pb": "P B",
        "ra": "R A",
        "rb": "R B",
    }
    lengths = {"Q-P": ground, "O-A": long, "O-B": long} | {
        f"{x}-{y}": short for x in "PR" for y in "AB"
    }
    law = Wave(0.0, 0.6, late=math.pi / 2 - 0.5)  # to and fro
    law = Wave(0.3 - float(law(np.zeros(1))[0]), 0.6, late=math.pi / 2 - 0.5)
    return linked(
        points, links, "crank", lengths, outputs=(Output("R", Path(Place("ra", 0j))),), law=law
    )


def watt_two() -> Machine:
    """A four-bar whose rocker carries a second four-bar: Watt II."""
    points = {
        "O": 0j,
        "A": 15 + 10j,
        "B": 62 + 42j,
        "C": 70 - 5j,
        "E": 98 + 25j,
        "F": 140 + 52j,
        "G": 150 - 8j,
    }
    links = {
        GROUND: "O C G",
        "crank": "O A",
        "coupler": "A B",
        "rocker": "C B E",
        "link": "E F",
        "last": "G F",
    }
    return linked(points, links, "crank", outputs=(Output("last", Angle("last"), "rad"),))


def stephenson_three(driven: str = "last", crank: complex = 3 + 2.6j) -> Machine:
    """A four-bar O A B C, its coupler point D led by E-D to a crank about G; driven there, no dyad is left.

    With the crank 8 + 7j it cannot turn fully.
    """
    points = {
        "O": 0j,
        "A": 20 + 36j,
        "B": 75 + 52j,
        "C": 82 - 4j,
        "D": 50 + 90j,
        "E": 130 + 55j + crank,
        "G": 130 + 55j,
    }
    links = {
        GROUND: "O C G",
        "crank": "O A",
        "coupler": "A B D",
        "rocker": "C B",
        "link": "D E",
        "last": "G E",
    }
    outputs = (
        Output("D", Path(at(points, links, "coupler", "D"))),
        Output("crank", Angle("crank"), "rad"),
    )
    return linked(points, links, driven, outputs=outputs)


def jansen() -> Machine:
    """Theo Jansen's leg with the published lengths; the foot's path is about 68 x 22.5 mm."""
    a, b, c, d, e, f, g, h, i, j, k, el, m = (
        38,
        41.5,
        39.3,
        40.1,
        55.8,
        39.4,
        36.7,
        65.7,
        49,
        50,
        61.9,
        7.8,
        15,
    )

    def meet(p: complex, q: complex, rp: float, rq: float, side: int) -> complex:
        way = q - p
        far = abs(way)
        x = (rp**2 - rq**2 + far**2) / (2 * far)
        return p + way / far * complex(x, side * math.sqrt(rp**2 - x**2))

    o, z = 0j, complex(-a, -el)
    x = complex(m)
    y = meet(x, z, j, b, -1)  # above
    w = meet(z, y, d, e, 1)
    v = meet(x, z, k, c, 1)  # below
    u = meet(w, v, f, g, -1)
    foot = meet(u, v, h, i, -1)
    points = {"O": o, "Z": z, "X": x, "Y": y, "W": w, "V": v, "U": u, "P": foot}
    links = {
        GROUND: "O Z",
        "crank": "O X",
        "j": "X Y",
        "top": "Z Y W",
        "k": "X V",
        "c": "Z V",
        "f": "W U",
        "low": "U V P",
    }
    return linked(
        points, links, "crank", outputs=(Output("foot", Path(at(points, links, "low", "P"))),)
    )


def klann() -> Machine:
    """Klann's leg by its published coordinates (patent US 6,260,862), in units of 100 mm."""
    points = {
        "A": 1.366 + 1.366j,
        "B": 1.009 + 0.574j,
        "O": 1.599 + 0.750j,
        "M": 1.331 + 0.750j,
        "C": 0.741 + 0.750j,
        "D": 0.323 + 0.855j,
        "E": 0.856 + 1.212j,
        "F": 0.0 + 0j,
    }
    points = {name: 100 * p for name, p in points.items()}
    links = {
        GROUND: "O A B",
        "crank": "O M",
        "conn": "M C D",
        "rockb": "B C",
        "rocka": "A E",
        "leg": "D E F",
    }
    return linked(
        points, links, "crank", outputs=(Output("foot", Path(at(points, links, "leg", "F"))),)
    )


def double_butterfly() -> Machine:
    """Eight bodies, three loops of three unknowns each, no dyads at all."""
    points = {
        "O": 0j,
        "C": 60 + 5j,
        "G": 120 + 0j,
        "A": -4 + 8j,
        "B": 30 + 52j,
        "D": 34 + 90j,
        "E": 55 + 40j,
        "F": 66 + 36j,
        "H": 112 + 48j,
        "I": 95 + 92j,
    }
    links = {
        GROUND: "O C G",
        "crank": "O A",
        "left": "A B D",
        "middle": "C E F",
        "right": "G H I",
        "be": "B E",
        "fh": "F H",
        "di": "D I",
    }
    outputs = (
        Output("right", Angle("right"), "rad"),
        Output("D", Path(at(points, links, "left", "D"))),
    )
    return linked(points, links, "crank", outputs=outputs)


def geared_five_bar(ratio: float = -1.0, carrier: str = GROUND) -> Machine:
    """Two cranks about O and C, geared; their pins joined by two links at P."""
    points = {"O": 0j, "C": 60 + 0j, "A": -20 + 0j, "B": 80 + 0j, "P": 30 + 70j}
    links = {GROUND: "O C", "crank": "O A", "other": "C B", "left": "A P", "right": "B P"}
    gear = Gear(
        "gear",
        "crank",
        "other",
        ratio,
        phase=0.0 - ratio * math.pi,
        carrier=carrier,
        clearance=0.001,
    )
    return linked(
        points,
        links,
        "crank",
        joints=(gear,),
        outputs=(Output("P", Path(at(points, links, "left", "P"))),),
    )


def hoeken(scale: float = 10.0) -> Machine:
    """Crank 1, ground 2, coupler 2.5, rocker 2.5, tracing point at 5."""
    machine = four_bar(2 * scale, scale, 2.5 * scale, 2.5 * scale, 1)
    outputs = (*machine.outputs, Output("trace", Path(Place("coupler", 5 * scale))))
    return Machine(machine.bodies, machine.joints, machine.drives, machine.start, outputs=outputs)


def ram_machine() -> Machine:
    """A cam drives a rocker, the rocker a Watt chain with a ram, a gear a drum: masses, springs, gravity."""
    points = {
        "O": 0j,
        "C": 60 + 0j,
        "T": 30 + 32j,
        "E": 88 + 44j,
        "F": 128 + 78j,
        "G": 140 + 5j,
        "H": 168 + 62j,
        "K": 210 + 20j,
        "Z": -40 + 0j,
        "W": -20 + 0j,
    }
    links = {
        GROUND: "O C G Z",
        "disc": "O",
        "rocker": "C T E",
        "link": "E F",
        "last": "G F H",
        "rod": "H K",
        "ram": "K",
        "drum": "Z W",
    }
    rest = float(np.angle(points["T"] - points["C"]))
    rise = Wave(0.0, 0.12, 1.0, 0.0)
    joints = (
        Cam(
            "cam",
            "disc",
            "rocker",
            rise,
            phase=0.4,
            rest=rest - float(rise(np.array([-0.4]))[0]),
            closure="force",
            leaves=1,
        ),
        Slide("guide", Place(GROUND, points["K"]), Place("ram"), angle=0.1),
        Gear("gear", "disc", "drum", -2.0),
    )
    masses = {
        name: {"mass": 0.05, "centre": 8 + 3j, "inertia": 2e-5}
        for name in ("rocker", "link", "last", "rod", "ram", "drum", "disc")
    }
    loads = (
        Gravity(),
        Spring("spring", at(points, links, "rocker", "E"), Place(GROUND, 100 + 120j), 0.6, 30.0),
        Force("work", Place("ram"), -3 + 1j),
    )
    outputs = (Output("way", Along("guide")), Output("drum", Angle("drum"), "rad"))
    machine = linked(
        points,
        links,
        "disc",
        joints=joints,
        law=Turning(),
        masses=masses,
        outputs=outputs,
        speed=20.0,
        loads=loads,
    )
    return machine


def excavator() -> Machine:
    """A driven length in a chain of unknown angles: a ram that lifts an arm."""
    bodies = (Body(GROUND), Body("arm", {"T": 30 + 0j}), Body("tube"), Body("rod"))
    joints = (
        Pin("C", Place("arm"), Place(GROUND)),
        Pin("Z", Place("tube"), Place(GROUND, -40j)),
        Slide("ram", Place("tube"), Place("rod")),
        Pin("T", Place("rod"), Place("arm", 30 + 0j)),
    )
    start = {"arm": Pose(0j, 0.1), "tube": Pose(-40j, 0.9), "rod": Pose(30 + 0j, 0.9)}
    law = Wave(50.0, 12.0)
    return close_drawing(
        Machine(
            bodies,
            joints,
            (Drive("oil", "rod", law, "ram"),),
            start,
            outputs=(Output("arm", Angle("arm"), "rad"), Output("ram", Along("ram"))),
        )
    )


def planetary() -> Machine:
    """A planet on a turning arm, geared 1 : 1 to a sun that stands still."""
    points = {"O": 0j, "P": 30 + 0j, "Q": 45 + 0j}
    gear = Gear("mesh", GROUND, "planet", -1.0, carrier="arm")
    return linked(
        points,
        {GROUND: "O", "arm": "O P", "planet": "P Q"},
        "arm",
        joints=(gear,),
        outputs=(
            Output("Q", Path(Place("planet", 15 + 0j))),
            Output("planet", Angle("planet"), "rad"),
        ),
    )


def wedge() -> Machine:
    """Three slides in a ring: 3 n - 2 j says none, but it moves."""
    bodies = (Body(GROUND), Body("wedge"), Body("lifter"))
    slope = 0.3
    joints = (
        Slide("along", Place(GROUND), Place("wedge")),
        Slide("up", Place(GROUND, 10 + 0j), Place("lifter"), angle=math.pi / 2, turn=0.0),
        Slide("face", Place("wedge"), Place("lifter"), angle=math.atan(slope)),
    )
    start = {"wedge": Pose(0j, 0.0), "lifter": Pose(complex(10, 10 * slope), 0.0)}
    push = Wave(-5.0, 5.0)
    drive = Drive("push", "wedge", push, "along")
    return Machine(bodies, joints, (drive,), start, outputs=(Output("up", Along("up")),))


CHAINS: dict[str, Callable[[], Machine]] = {
    "four-bar": lambda: four_bar(40, 15, 45, 35),
    "take-up": take_up,
    "take-up interchanged": lambda: take_up(True),
    "slider-crank": slider_crank,
    "offset slider-crank": lambda: slider_crank(12, 40, 7),
    "Scotch yoke": scotch_yoke,
    "Whitworth": whitworth,
    "Peaucellier": peaucellier,
    "Watt II": watt_two,
    "Stephenson III": stephenson_three,
    "Stephenson III, stalling": lambda: stephenson_three(crank=8 + 7j),
    "Jansen": jansen,
    "Klann": klann,
    "double butterfly": double_butterfly,
    "geared five-bar": geared_five_bar,
    "Hoeken": hoeken,
    "excavator": excavator,
    "planetary": planetary,
    "cam, rocker, Watt, ram, gear": ram_machine,
}
