"""A calibration coupon: a plate with holes, gaps and standing pins, a loose pin for a row of fits, and a disc; nothing moves.

    C   p p p p p          row by row, from the top: pins that stand on the plate; holes from tight to loose for the loose pin;
        f f f f f          holes; gaps. A, B and C are alike: "over x" is between the far walls of A and B, "between x" between
        o o o o o          the near ones, and so along y. The origin is A.
    A   | | | |    B

What was measured goes into [measured]; what follows of it, into [print] of every other spec.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from camgen.errors import DesignError, Fault
from camgen.findings import Finding, Where, at_most
from camgen.geometry.outlines import Floats, Region, circle, rectangle
from camgen.machine.features import Mount
from camgen.machine.model import GROUND, Machine
from camgen.machines.coupon.calibration import Calibration, Feature, Printed, calibrate
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.parts.assembly import Assembly
from camgen.parts.hardware import headed, plate, rounded
from camgen.parts.part import Layer, Part
from camgen.spec import Length, MinWall, Record, quantity, unknown
from camgen.study import Doing, Figure, Figures, Plot, Step, Study, Table

_OFF = 1.0  # mm, by which no printer is off: another size was measured
_SLOT = 6.0  # mm, half the length of a gap
_APART = 10.0  # mm, between plate, disc and pin as they are shown
Sizes = Annotated[tuple[Length, ...], Field(min_length=1, max_length=12)]
Steps = Annotated[
    tuple[Annotated[float, quantity("mm", ge=-1, le=2)], ...], Field(min_length=2, max_length=12)
]


class CouponGeometry(Record):
    """Nominal sizes, mm, each list from small to large."""

    holes: Sizes = Field(
        default=(3.0, 4.0, 5.0, 6.0, 8.0, 10.0), description="diameters of the holes"
    )
    gaps: Sizes = Field(
        default=(2.0, 4.0, 6.0, 8.0),
        description="widths of the gaps, each between two straight walls",
    )
    pins: Sizes = Field(
        default=(3.0, 4.0, 5.0, 6.0, 8.0), description="diameters of pins that stand on the plate"
    )
    fit_pin: Length = Field(default=5.0, description="diameter of the loose pin")
    clearances: Steps = Field(
        default=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8),
        description="diametral clearances of the holes for the loose pin",
    )
    disc: Length = Field(default=40.0, description="diameter of the disc")
    datum_hole: Length = Field(
        default=8.0, description="diameter of A, B, C and of the disc's bore"
    )
    length: Length = Field(default=90.0, description="distance from A to B")
    width: Length = Field(default=54.0, description="distance from A to C")


class CouponParts(Record):
    """The bodies of the parts, mm."""

    thickness: Length = Field(default=4.0, description="thickness of plate and disc")
    pin_height: Length = Field(default=8.0, description="height of the standing pins")
    wall: Length = Field(default=3.0, description="least wall between two holes")


class Measured(Record):
    """What was measured; sizes: by feature, one reading or several."""

    caliper: Annotated[float, quantity("mm", gt=0, le=1)] = Field(
        default=0.02, description="standard deviation of one reading"
    )
    runs: Annotated[float, quantity("mm")] | None = Field(
        default=None, description="tightest of clearances in which the loose pin turns freely"
    )
    holds: Annotated[float, quantity("mm")] | None = Field(
        default=None, description="widest of clearances in which the loose pin sits tight"
    )
    sizes: dict[
        str, Length | Annotated[tuple[Length, ...], Field(min_length=1, max_length=100)]
    ] = Field(
        default={},
        description='readings by feature, one or several: "hole 5" = [4.78, 4.80]; measure as many '
        "as you like",
    )

    @model_validator(mode="before")
    @classmethod
    def _sizes_below(cls, data: Any) -> Any:
        keys = data if isinstance(data, dict) else ()
        stray = [key for key in keys if " " in key or key == "disc"]
        if stray:
            raise ValueError(f"below the line [measured.sizes]: {', '.join(stray)}")
        return data


class CouponLimits(Record):
    """What the measurement must reach."""

    uncertainty: Length = Field(
        default=0.05,
        description="greatest uncertainty of a compensation, 95 %: a quarter of the usual running "
        "clearance",
    )
    departure: Length = Field(
        default=0.15,
        description="how far one size may be from the size that the fitted values give",
    )
    min_wall: MinWall = 0.8


class Coupon(Mechanism):
    """Spec and answers of a coupon."""

    geometry: CouponGeometry = Field(
        default=CouponGeometry.model_construct(),
        description="nominal sizes, each list from small to large",
    )
    making: Annotated[CouponParts, Field(alias="parts")] = CouponParts.model_construct()
    measured: Measured = Field(
        default=Measured.model_construct(), description="sizes measured with a caliper"
    )
    allowed: Annotated[CouponLimits, Field(alias="limits")] = CouponLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        m = self.measured
        nozzle = self.print.nozzle
        faults: list[Fault] = []
        for key in ("holes", "gaps", "pins", "clearances"):
            values = getattr(g, key)
            if any(not float(f"{a:g}") < float(f"{b:g}") for a, b in pairwise(values)):
                right = "sizes from small to large, each once"
                faults.append(Fault(("geometry", key), str(list(values)), right))
        tightest = g.clearances[0]
        if g.fit_pin + tightest < nozzle:
            right = f"more than {nozzle - g.fit_pin:g}: a hole is left"
            faults.append(Fault(("geometry", "clearances", 0), f"{tightest:g}", right))
        wall = self.making.wall
        if wall < nozzle:
            right = f"at least the nozzle, {nozzle:g} mm"
            faults.append(Fault(("parts", "wall"), f"{wall:g}", right))
        for key in ("runs", "holds"):
            value = getattr(m, key)
            if value is not None and value not in g.clearances:
                right = f"one of geometry.clearances: {list(g.clearances)}"
                faults.append(Fault(("measured", key), f"{value:g}", right))
        if m.runs is not None and m.holds is not None and m.holds >= m.runs:
            right = f"less than measured.runs, {m.runs:g}: the pin is tight there"
            faults.append(Fault(("measured", "holds"), f"{m.holds:g}", right))
        nominal = {each.name: each.nominal for each in self.sizes}
        for name, readings in self._readings.items():
            path = ("measured", "sizes", name)
            if name not in nominal:
                faults.append(unknown(path, name, nominal))
                continue
            right = f"within {_OFF:g} mm of {nominal[name]:g}; was another size measured?"
            for value in readings:
                if abs(value - nominal[name]) > _OFF:
                    faults.append(Fault(path, f"{value:g}", right))
        return faults

    @property
    def _readings(self) -> dict[str, tuple[float, ...]]:
        """What was measured, mm, by feature."""
        sizes = self.measured.sizes
        return {name: size if isinstance(size, tuple) else (size,) for name, size in sizes.items()}

    # ---- sizes ------------------------------------------------------------------------------------------------------

    @cached_property
    def sizes(self) -> Sequence[Feature]:
        """All that can be measured; walls of holes come in, outlines come out."""
        g = self.geometry
        return [
            *(Feature(f"hole {d:g}", d, -2, 0) for d in g.holes),
            *(Feature(f"gap {w:g}", w, -2, 0) for w in g.gaps),
            *(Feature(f"pin {d:g}", d, 0, 2) for d in g.pins),
            *(Feature(f"fit {c:g}", g.fit_pin + c, -2, 0) for c in g.clearances),
            Feature("fit pin", g.fit_pin, 0, 2),
            Feature("disc", g.disc, 0, 2),
            Feature("disc bore", g.datum_hole, -2, 0),
            Feature("over x", g.length + g.datum_hole, -2, 0),
            Feature("between x", g.length - g.datum_hole, 2, 0),
            Feature("over y", g.width + g.datum_hole, -2, 0),
            Feature("between y", g.width - g.datum_hole, 2, 0),
            Feature("disc foot", g.disc, 0, 2),
        ]

    @cached_property
    def calibration(self) -> Calibration:
        """What follows from [measured]."""
        p = self.print
        m = self.measured
        features = {each.name: each for each in self.sizes}
        fits = [None if c is None else features[f"fit {c:g}"] for c in (m.runs, m.holds)]
        step = min(b - a for a, b in pairwise(self.geometry.clearances))
        printed = Printed(p.hole_compensation, p.profile_compensation, p.shrinkage, p.elephant_foot)
        return calibrate(
            [each for each in self.sizes if each.name != "disc foot"],
            self._readings,
            printed,
            m.caliper,
            (features["fit pin"], fits[0], fits[1], step),
            ("disc foot", "disc"),
        )

    # ---- answers ----------------------------------------------------------------------------------------------------

    def _unloaded(self) -> Machine:
        """Nothing moves."""
        return Machine((), (), (), {})

    def motion(self, theta: Floats, order: int = 0) -> Floats:
        """None, (n,)."""
        return np.zeros(np.shape(theta))

    def limits(self) -> Sequence[Finding]:
        """CALIBRATION of each value in mm, CALIBRATION_FIT of the size that is farthest off the fit."""
        self._bodies  # noqa: B018  refuses what cannot be made
        findings = [
            at_most(
                "CALIBRATION",
                value.uncertainty,
                self.allowed.uncertainty,
                "mm",
                Where(f"print.{value.key}"),
                f"{value.value:.4g} mm; the limit is its 95 % interval: measure more sizes, or each one several times",
            )
            for value in self.calibration.values
            if value.key in ("hole_compensation", "profile_compensation")
        ]
        if self.calibration.rows:
            name, measured, fit, rest = max(self.calibration.rows, key=lambda row: abs(row[3]))
            remark = f"measured {measured:.4g} mm, {fit:.4g} by the values found; measure it again, or print it by itself"
            limit = self.allowed.departure
            findings.append(at_most("CALIBRATION_FIT", abs(rest), limit, "mm", Where(name), remark))
        return findings

    def study(self) -> Study:
        """The values and how well they fit, or what to measure."""
        calibration = self.calibration
        if not calibration.rows:
            return Study(notes=self.remarks().printed)
        figures = []
        values = []
        for each in calibration.values:
            unit = "share" if each.unit == "1" else each.unit
            figures.append(Figure("print {of}", each.value, unit, each.key))
            values.append(
                (each.key, each.value, each.measured, each.uncertainty, each.unit, each.source)
            )
        nominal = {each.name: each.nominal for each in self.sizes}
        rows = [(name, nominal[name], *row) for name, *row in calibration.rows]
        series = ("sizes", np.array([row[1] for row in rows]), np.array([row[-1] for row in rows]))
        plot = Plot("Error left in each size", "nominal, mm", "mm", [series], dots=("sizes",))
        tables = [
            Table(
                "Values for [print]",
                ("key", "value", "measured", "+- (95 %)", "unit", "from"),
                values,
            ),
            Table(
                "Sizes",
                (
                    "feature",
                    "nominal, mm",
                    "measured, mm",
                    "expected by these values, mm",
                    "error left, mm",
                ),
                rows,
            ),
        ]
        return Study(Figures(figures), [plot], tables)

    def remarks(self) -> Remarks:
        """What to paste, line by line, or what to do first."""
        if not self.calibration.values:
            first = "nothing is measured yet: print the coupon, measure it, write the sizes into [measured.sizes] and build again"
            return Remarks([first])
        lines = (each.line for each in self.calibration.values)
        return Remarks(["for [print] of your specs:", *lines])

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def assembly(self) -> Assembly:
        """Plate, loose pin and disc, side by side on the bed; the origin is hole A, the pin's and the disc's axis."""
        g = self.geometry
        low = -max(g.datum_hole / 2, _SLOT) - self.making.wall - _APART - g.disc / 2
        beside = complex(g.disc / 2 + _APART + g.fit_pin / 2 + self.making.wall, low)
        mounts = [Mount("gauge", GROUND), Mount("disc", GROUND, 1j * low)]
        mounts.append(Mount("pin", GROUND, beside))
        lines = [each.line for each in self.calibration.values]
        texts = {"print.toml": "\n".join(["[print]", *lines, ""])} if lines else {}
        return replace(self._assembly(self._bodies, mounts), texts=texts, work=[self._measuring()])

    def _measuring(self) -> Table:
        """What to measure, and how."""
        how = {
            "gauge": "holes, gaps and fits: with the caliper's inner jaws; pins: with the outer jaws; over x and over y: inner jaws on the far "
            "walls of A and B, and of A and C; between x and between y: outer jaws on their near walls",
            "pin": "fit pin: its shank; runs: the tightest hole in which it turns; holds: the widest hole in which it holds",
            "disc": "disc: half way up; disc foot: at the lowest layer; disc bore: its bore",
        }
        names = [part.name for part in self._bodies]
        rows = [(k, name, how[name]) for k, name in enumerate(names, 1)]
        steps = [Step([Doing(f"{name}: {how[name]}")], [f"{name}-1"]) for name in names]
        return Table("What to measure, cold", ("step", "part", "how"), rows, steps)

    @cached_property
    def _bodies(self) -> Sequence[Part]:
        g = self.geometry
        p = self.making
        least = self.allowed.min_wall
        datum = g.datum_hole / 2
        left = -datum
        right = g.length + datum
        points = {"A": 0j, "B": complex(g.length), "C": 1j * g.width}
        holes = {name: circle(z, datum) for name, z in points.items()}
        y = self._heights()
        for name, x, w in self._row("gap", g.gaps, datum, g.length - datum):
            z = points[name] = complex(x, y[0])
            half = complex(w / 2, _SLOT)
            holes[name] = rectangle(z - half, z + half)
        round_holes = [
            *self._row("hole", g.holes, left, right),
            *self._row("fit", g.clearances, left, right, g.fit_pin),
        ]
        for k, (name, x, d) in enumerate(round_holes):
            z = points[name] = complex(x, y[1 if k < len(g.holes) else 2])
            holes[name] = circle(z, d / 2)
        low = -max(datum, _SLOT)
        high = g.width + max(datum, max(g.pins) / 2)
        corners = [
            complex(x, y) for x, y in ((left, low), (right, low), (right, high), (left, high))
        ]
        outer = rounded([(z, p.wall) for z in corners])
        region = plate("coupon", outer, holes, least)
        stand = []
        pins = []
        for name, x, d in self._row("pin", g.pins, datum, right):
            z = complex(x, y[3])
            pins.append((name, z))
            top = p.thickness + p.pin_height
            stand.append(Layer(Region(circle(z, d / 2)), p.thickness, top))
        over = [
            f"{axis}: {way + 2 * datum:g} over the far walls of A and {to}, {way - 2 * datum:g} between the near ones"
            for axis, way, to in (("x", g.length, "B"), ("y", g.width, "C"))
        ]
        body = Part(
            "gauge",
            "Plate with holes and pins",
            (Layer(region, 0.0, p.thickness), *stand),
            centres=tuple(points.values()),
            min_wall=least,
            points=(*points.items(), *pins),
            notes=tuple(over),
        )
        pin = headed(
            "pin",
            "Loose pin",
            g.fit_pin,
            p.thickness + p.pin_height,
            g.fit_pin + 2 * p.wall,
            p.wall,
        )
        round_ = plate("disc", circle(0j, g.disc / 2), {"bore": circle(0j, datum)}, least)
        disc = Part(
            "disc",
            "Disc",
            (Layer(round_, 0.0, p.thickness),),
            centres=(0j,),
            bore=g.datum_hole,
            min_wall=least,
        )
        return body, pin, disc

    def _row(
        self, kind: str, values: Sequence[float], low: float, high: float, more: float = 0.0
    ) -> Iterator[tuple[str, float, float]]:
        """Name, place and width of each of a row between two abscissas, mm, evenly spaced; DesignError where it is too short."""
        widths = [value + more for value in values]
        air = (high - low - sum(widths)) / (len(widths) + 1)
        if min(widths) <= 0 or air < self.making.wall:
            needed = self.geometry.length + (len(widths) + 1) * (self.making.wall - air)
            raise DesignError(
                "geometry.length",
                self.geometry.length,
                needed,
                "mm",
                f"the row of {kind} {values[-1]:g}",
                "make it longer, or leave sizes out",
            )
        x = low
        for value, width in zip(values, widths, strict=True):
            yield f"{kind} {value:g}", x + air + width / 2, width
            x += air + width

    def _heights(self) -> Sequence[float]:
        """Ordinates of the rows, mm, from gaps to pins, evenly spaced; DesignError where they do not fit."""
        g = self.geometry
        fits = g.fit_pin + g.clearances[-1]
        halves = (
            max(_SLOT, g.datum_hole / 2),
            max(g.holes) / 2,
            fits / 2,
            max(g.datum_hole, *g.pins) / 2,
        )
        air = (g.width - halves[0] - 2 * halves[1] - 2 * halves[2] - halves[3]) / 3
        if air < self.making.wall:
            needed = g.width + 3 * (self.making.wall - air)
            remedy = "make it wider, or leave the largest sizes out"
            raise DesignError("geometry.width", g.width, needed, "mm", "four rows", remedy)
        first = halves[0] + air + halves[1]
        return 0.0, first, first + halves[1] + air + halves[2], g.width
