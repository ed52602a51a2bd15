"""What the report shows of a chain stitch: synchrogram, figures, loops, thread; beside the source's example its errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from camgen.geometry.outlines import Floats
from camgen.machines.chain_stitch_looper.ratio import Condition, ratio_range
from camgen.machines.chain_stitch_looper.stitch import HOLDS, Design, Stitch, thread_per_stitch
from camgen.machines.chain_stitch_looper.timing import FARTHEST, Clock
from camgen.numerics import peak
from camgen.study import ROWS, Figure, Figures, Plot, Study, Table, figures_in

# thickness, length and width of the stitch whose thread the source compares
_EXAMPLE = (2.5, 3.0, 4.0)
_PRINTED_FOUR = 66.0  # mm, its four-thread stitch
_SOURCE = (
    "Source: Horobets, Manoilenko, New method of forming a flat chain stitch. Nose and shank, gaps, radii and the shed angle "
    "are a reconstruction, since the scan has no figures; the loops' shedding is taken as the nose leaving the other needle's "
    "line."
)
_PLANE = (
    "Distances over the turn are those in the needles' plane, where needles and the spreaders' bodies stand. The noses lie "
    "beside it: what is between a nose and the flank of a needle that passes it is side_gap, {:g} mm, whatever the angle."
)


def study(
    given: Stitch,
    made: Design,
    length: float,
    conditions: Sequence[Condition],
    areas: Sequence[Figure],
    rpm: float,
) -> Study:
    """Numbers, plots and tables. made: what the parts follow; length: of a stitch; conditions: of the velocity ratio."""
    tables = [_events(made)]
    if given.of_source:
        printed = given.design(True)
        right = given.design()
        tables += [_beside(printed, right), _errata(given, printed)]
    else:
        tables.append(Table("Figures of the design", ("quantity", "value"), _figures(made)))
    tables += [_loops(made), _tips(made), _thread(given, length), _positions(made)]
    if conditions:
        tables.append(_ratios(conditions, given.ratio))
    numbers = Figures([*_numbers(given, made, length, conditions, rpm), *areas])
    notes = (_SOURCE, _PLANE.format(given.side_gap))
    return Study(numbers, _synchrogram(made), tables, (), notes, _columns(made))


# crank over rod of the source's needles and spreaders, which it then leaves out
SOURCE_DISTORTION = (0.1, 0.2)


def distortion_row(distortion: tuple[float, float], clock: Clock) -> tuple[object, ...]:
    """Crank over rod of needles and spreaders, and what they make of stroke, timing and clearance."""
    d = clock.design
    t = clock.timing()
    strike = math.degrees(min(t.strike_lag, t.strike_lead))
    return (*distortion, d.needle_stroke, *_deg(d.capture), *_deg(d.pierce), clock.gap(), strike)


def distortion_table(rows: Sequence[tuple[object, ...]]) -> Table:
    """What the rods' lengths do."""
    columns = (
        "needles' crank / rod",
        "spreaders'",
        "needle stroke, mm",
        "capture 1, deg",
        "capture 2, deg",
        "pierce 1, deg",
        "pierce 2, deg",
        "least clearance, mm",
        "strikes when off by, deg",
    )
    title = "Driven by cranks and rods: harmonic, as the source has them, and as here"
    return Table(title, columns, rows)


def timing_study(clock: Clock) -> Study:
    """How many degrees the spreaders may run late or early: of a finished machine, and of designs with another lag_deg."""
    rows: list[tuple[object, ...]] = []
    found: list[Figure] = []

    def text(angle: float, digits: int) -> str:
        beyond = f"over {math.degrees(FARTHEST):g}"
        return f"{angle:.{digits}f}" if math.isfinite(angle) else beyond

    for anew, name, of in (
        (False, "timing", "finished machine, spreaders late (lag) or early (lead)"),
        (
            True,
            "designed",
            "timing.lag_deg more or less, noses set to their needles at capture once more",
        ),
    ):
        t = clock.timing(anew)
        for key, until, pair in (
            ("strike", "a needle strikes", (t.strike_lag, t.strike_lead)),
            ("missed loop", "a needle misses its loop", (t.missed_lag, t.missed_lead)),
        ):
            lag, lead = _deg(pair)
            rows.append((of, until, text(lag, 3), text(lead, 3)))
            found.append(Figure(f"{name} lag to {key}", lag, "deg"))
            found.append(Figure(f"{name} lead to {key}", lead, "deg"))
        if not anew:
            found.append(Figure("timing tolerance", math.degrees(t.least), "deg"))
    numbers = Figures(found)
    columns = ("of", "until", "lag, deg", "lead, deg")
    table = Table("Timing: what the spreaders may be off", columns, rows)
    late, early = (text(numbers[f"timing_{way}_to_strike_deg"], 2) for way in ("lag", "lead"))
    note = (
        f"Timing: a needle strikes a spreader that runs late by {late} deg of the shaft or early by {early} deg; with "
        f"the loops, which a needle must not miss, either way {numbers['timing_tolerance_deg']:.2f} deg are left."
    )
    numbers = Figures(each for each in found if math.isfinite(each.value))
    return Study(numbers, tables=[table], notes=[note])


def _columns(d: Design) -> dict[str, Floats]:
    """Positions over the turn, every quarter degree, for motion.csv."""
    phi = np.linspace(0, math.tau, ROWS)
    tips = d.tips(phi)
    noses = d.noses(phi)
    return {
        "theta_deg": np.degrees(phi),
        "needle_mm": d.risen(phi),
        "spreader_mm": d.moved(phi),
        "tip_1_mm": tips[0],
        "tip_2_mm": tips[1],
        "nose_1_mm": noses[0],
        "nose_2_mm": noses[1],
    }


def _positions(d: Design) -> Table:
    """The synchrogram as a table; motion.csv has it every quarter degree."""
    heads = (
        "shaft angle, deg",
        "needles S, mm",
        "spreaders L, mm",
        "tip 1 above the plate's top, mm",
        "tip 2, mm",
        "nose 1 beyond its needle, mm",
        "nose 2, mm",
    )
    columns = (column[:: ROWS // 24].tolist() for column in _columns(d).values())
    return Table("Synchrogram", heads, list(zip(*columns, strict=True)))


def _deg(angles: Sequence[float]) -> list[float]:
    return [math.degrees(angle) for angle in angles]


def _numbers(
    given: Stitch, d: Design, length: float, conditions: Sequence[Condition], rpm: float
) -> list[Figure]:
    phi = np.linspace(0, math.tau, ROWS)
    per_second = rpm * math.tau / 60
    found = [
        *figures_in(
            "mm",
            spreader_height=given.height,
            nose_pitch=given.pitch,
            nose_to_front=d.l1,
            front_length=d.l2,
            loop_seat=d.l3,
            nose_length=d.nose,
        ),
        Figure("front slope", math.degrees(d.slope), "deg"),
        Figure("opening", d.opening, "mm"),
        Figure("{of} stroke", d.needle_stroke, "mm", "needle"),
        Figure("{of} stroke", d.spreader_stroke, "mm", "spreader"),
        Figure("between pierces", given.between, "mm"),
        *figures_in(
            "mm/s",
            needle_peak_speed=peak(d.risen(phi, 1)) * per_second,
            spreader_peak_speed=peak(d.moved(phi, 1)) * per_second,
        ),
    ]
    lengths = {
        "in fabric": d.in_fabric,
        "pierce rise": d.rises,
        "loop margin": d.margins,
        "needed stroke": d.needed,
    }
    angles = {
        "capture": d.capture,
        "pierce": d.pierce,
        "shedding": d.shed,
        "loop angle pierce": d.pierce_angles,
        "loop angle shedding": d.shed_angles,
        "out of fabric": d.out_of_fabric,
    }
    for quantities, unit, written in ((lengths, "mm", float), (angles, "deg", math.degrees)):
        for quantity, pair in quantities.items():
            for stitch, value in zip("12", pair, strict=True):
                found.append(Figure(f"{quantity} {stitch}", written(value), unit))
    thread = thread_per_stitch(given.thickness, length, given.spacing)
    found += [
        Figure("thread {of}", value, "mm", name.replace("-", " ")) for name, value in thread.items()
    ]
    works = ratio_range(conditions, given.ratio) if conditions else None
    for end, (ratio, _) in zip(("min", "max"), works or (), strict=False):
        if math.isfinite(ratio):
            found.append(Figure(f"velocity ratio {end}", ratio))
    return [each for each in found if not math.isnan(each.value)]


def _synchrogram(d: Design) -> list[Plot]:
    phi = np.linspace(0, math.tau, ROWS)
    marks = [
        (f"{event} {number}".strip(), angle)
        for event, number, angle, *_ in _rows(d)
        if not math.isnan(angle)
    ]
    motion = {"needles S": d.risen(phi), "spreaders L": d.moved(phi)}
    tips = {f"tip of needle {k}": y for k, y in enumerate(d.tips(phi), 1)}
    tips |= {f"nose level {k}": np.full(phi.shape, -y) for k, y in enumerate(d.given.levels, 1)}
    noses = {f"nose {k}": way for k, way in enumerate(d.noses(phi), 1)}
    noses["other needle"] = np.full(phi.shape, d.given.spacing)

    def plot(title: str, unit: str, curves: Mapping[str, Floats]) -> Plot:
        series = [(name, np.degrees(phi), y) for name, y in curves.items()]
        return Plot(title, "shaft angle, deg", unit, series)

    return [
        replace(plot("Synchrogram", "mm", motion), marks=marks),
        plot("Tips and nose levels", "mm above the plate's top", tips),
        plot("Noses past their own needle", "mm", noses),
    ]


def _rows(d: Design) -> list[tuple[str, str, float, float, float]]:
    """Events in the order of the turn: what happens, number of nose or needle, angle in deg, S and L there."""
    pairs = (("capture", d.capture), ("pierce", d.pierce), ("shedding", d.shed))
    events = [(name, str(k), phi) for name, pair in pairs for k, phi in enumerate(pair, 1)]
    half = d.given.feed / 2
    events += [("feed begins", "", math.pi - half), ("feed ends", "", math.pi + half)]
    rows = []
    for name, number, phi in events:
        s = math.nan
        moved = math.nan
        if not math.isnan(phi):
            s, moved = (float(f(np.array([phi]))[0]) for f in (d.risen, d.moved))
        rows.append((name, number, math.degrees(phi), s, moved))
    return sorted(rows, key=lambda row: (math.isnan(row[2]), row[2]))


def _events(d: Design) -> Table:
    what = {
        "capture": "nose {0} takes the loop of needle {0}",
        "pierce": "needle {0} comes down into the loop of needle {1}",
        "shedding": "nose {0} leaves the line of needle {1} on its way back",
    }
    rows = []
    for event, number, *places in _rows(d):
        said = "the fabric moves in between"
        if event in what:
            said = what[event].format(number, {"1": 2, "2": 1}[number])
        rows.append((f"{event} {number}".strip(), *places, said))
    heads = ("event", "shaft angle, deg", "needles S, mm", "spreaders L, mm", "what happens")
    return Table("Events of a turn", heads, rows)


def _figures(d: Design) -> list[tuple[str, float]]:
    """Every figure of a design by its name, the source's symbol in it."""
    g = d.given
    one = [
        ("b, mm", g.height),
        ("H, mm", g.pitch),
        ("l1 for the strokes, mm", d.first[0]),
        ("l2 for the strokes, mm", d.first[1]),
        ("A for the strokes, mm", d.first[2]),
        ("needle stroke S_X, mm", d.needle_stroke),
        ("spreader stroke L_X, mm", d.spreader_stroke),
        ("L_X / S_X", d.spreader_stroke / d.needle_stroke),
        ("ratio for l1 and l2", d.ratio),
        ("l1, mm", d.l1),
        ("l2, mm", d.l2),
        ("l3, mm", d.l3),
        ("A, mm", d.nose),
        ("alpha, deg", math.degrees(d.slope)),
        ("opening f, mm", d.opening),
        ("DS, mm", g.between),
    ]
    two = [
        ("S_m{}, mm", d.in_fabric),
        ("S_B{}, mm", d.rises),
        ("capture phi3{}, deg", _deg(d.capture)),
        ("pierce phi4{}, deg", _deg(d.pierce)),
        ("L_C{}, mm", d.behind),
        ("L_X{} needed for a loop held at the root, mm", d.needed),
        ("loop angle at the pierce {}, deg", _deg(d.pierce_angles)),
        ("loop angle at shedding {}, deg", _deg(d.shed_angles)),
        ("needle {} out of the fabric, deg", _deg(d.out_of_fabric)),
    ]
    return one + [(name.format(k + 1), value) for name, pair in two for k, value in enumerate(pair)]


def _beside(printed: Design, right: Design) -> Table:
    """Every figure as the source finds it, and corrected."""
    figures = zip(_figures(printed), _figures(right), strict=True)
    rows = [(name, value, corrected) for (name, value), (_, corrected) in figures]
    return Table("Published and corrected", ("quantity", "published", "corrected"), rows)


def _errata(g: Stitch, d: Design) -> Table:
    """The source's seven errors; g, d: its own example and design."""

    def shown(*values: float) -> str:
        return " and ".join(f"{value:.6g}" for value in values)

    thread = thread_per_stitch(*_EXAMPLE)
    wrong6 = 100 * (_PRINTED_FOUR - thread["new"]) / thread["new"]
    right6 = 100 * (_PRINTED_FOUR - thread["new"]) / _PRINTED_FOUR
    s1, s2 = g.rise
    slide = [g.spacing / way if way > 0 else math.inf for way in g.approach]
    s_x = d.needle_stroke
    true = g.in_fabric(g.plate)
    way = g.spacing + d.first[2]
    strokes = (
        s_x * (d.behind[1] + way) / (d.rises[1] - s1),
        s_x * (d.behind[0] + way) / (d.rises[0] - s2),
    )
    r = d.spreader_stroke / s_x
    new = max(g.reach) * r, g.height * r
    rows: list[tuple[object, ...]] = [
        (
            1,
            "S_m1, S_m2, S_X, mm",
            shown(*d.in_fabric, s_x),
            shown(*true, g.needle_stroke(true)),
            "made with e = 4 instead of the adopted plate_to_spreader",
        ),
        (
            2,
            "pierce angles, deg",
            shown(*_deg(d.pierce)),
            shown(*_deg([3 * math.pi - angle for angle in d.pierce])),
            "wrong branch, 180 deg + arccos instead of 360 deg - arccos; right here at the published S_X and S_B, in the table "
            "above at the corrected ones",
        ),
        (
            3,
            "S_B2, mm",
            shown(d.rises[1]),
            shown(g.pierce_rises[1]),
            "too high by H + l_H",
        ),
        (
            4,
            "L_X1, L_X2, mm",
            shown(*d.needed),
            shown(*strokes),
            "lacks a factor 2, and 0.003 stands for 0.03; in step no cosine is needed",
        ),
        (
            5,
            "ratio, l1, l2, A, mm",
            shown(d.ratio, d.l1, d.l2, d.nose),
            shown(r, *new, sum(new)),
            "dS/dL taken for dL/dS",
        ),
        (
            6,
            "thread saved, %",
            shown(wrong6),
            shown(right6),
            "divides by the new stitch's thread instead of the four-thread one's",
        ),
        (
            7,
            "least ratio for both loops",
            "any",
            shown(max(slide)),
            "both conditions cannot hold for a loop held at the nose's root; for one that slides along the nose the ratio must be "
            f"above {shown(*slide)}",
        ),
    ]
    return Table(
        "Errata of the source", ("no.", "quantity", "published", "corrected", "what is wrong"), rows
    )


def _loops(d: Design) -> Table:
    low, high = (math.degrees(angle) for angle in HOLDS)

    def holds(angle: float) -> str:
        return "stays" if angle <= HOLDS[0] else "may slide" if angle <= HOLDS[1] else "slides"

    rows = [
        (k, margin, seat, math.degrees(pierce), math.degrees(shed), holds(shed))
        for k, margin, seat, pierce, shed in zip(
            (1, 2), d.margins, d.seat_margins, d.pierce_angles, d.shed_angles, strict=True
        )
    ]
    columns = (
        "loop",
        "nose past the other needle, mm (> 0: a sliding loop is pierced)",
        "seat past it, mm (> 0: one held at the root is)",
        "angle at the pierce, deg",
        "angle at shedding, deg",
        f"at shedding on the nose ({low:.0f} to {high:.0f} deg hold)",
    )
    return Table("Loops", columns, rows)


def _tips(d: Design) -> Table:
    """Where tips are to P6 along the stroke, at nose level and at the height of C; below 0 inside the spreader."""
    r = d.spreader_stroke / d.needle_stroke
    rows = [(pair, gap, gap + d.l2 - r * d.given.height) for pair, gap in d.offsets().items()]
    heads = ("pair", "at nose level, mm", "at the height of C, mm")
    return Table("Needle's tip before P6, along the stroke", heads, rows)


def _thread(g: Stitch, length: float) -> Table:
    rows = [
        (f"{m:g}, {t:g}, {z:g}", *thread_per_stitch(m, t, z).values())
        for m, t, z in ((g.thickness, length, g.spacing), _EXAMPLE)
    ]
    columns = (
        "thickness, length, width, mm",
        "new stitch, mm",
        "type 406, mm",
        "four-thread, mm (66 printed for the last row)",
    )
    return Table("Thread of a stitch", columns, rows)


def _ratios(conditions: Sequence[Condition], ratio: float) -> Table:
    rows = []
    for each in conditions:
        roots = " and ".join(f"{root:.9g}" for root in sorted(each.roots) if root > 0)
        rows.append((each.name, "yes" if each.spare(ratio) >= -1e-12 else "no", roots or "-"))
    heads = ("so that", f"kept at {ratio:.9g}", "changes at")
    return Table("Velocity ratio, laws in step", heads, rows)
