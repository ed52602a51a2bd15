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
from camgen.geometry.outlines import Contour, Floats, Region, circle, rectangle
from camgen.machine.features import Mount
from camgen.machine.model import GROUND, Machine
from camgen.machines.coupon.calibration import Calibrated, Feature, Printed, calibrated
from camgen.machines.mechanism import Mechanism, Remarks
from camgen.parts.assembly import Assembly
from camgen.parts.hardware import headed, plate, rounded
from camgen.parts.part import Layer, Part
from camgen.spec import Length, MinWall, Record, quantity, unknown
from camgen.study import Plot, Study, Table

_OFF = 1.0  # mm, by which no printer is off: another size was measured
_SLOT = 6.0  # mm, half the length of a gap
_APART = 10.0  # mm, between plate, disc and pin as they are shown
Sizes = Annotated[tuple[Length, ...], Field(min_length=1, max_length=12)]
Steps = Annotated[
    tuple[Annotated[float, quantity("mm", ge=-1, le=2)], ...], Field(min_length=2, max_length=12)
]


class CouponGeometry(Record):
    """Nominal sizes, mm, each list from small to large."""

    holes: Sizes = Field(default=(3.0, 4.0, 5.0, 6.0, 8.0, 10.0), description="diameters")
    gaps: Sizes = Field(default=(2.0, 4.0, 6.0, 8.0), description="between two straight walls")
    pins: Sizes = Field(
        default=(3.0, 4.0, 5.0, 6.0, 8.0), description="diameters of pins that stand on the plate"
    )
    fit_pin: Length = Field(default=5.0, description="of the loose pin")
    clearances: Steps = Field(
        default=(0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8),
        description="diametral, of the holes for it",
    )
    disc: Length = Field(default=40.0, description="its diameter")
    datum_hole: Length = Field(
        default=8.0, description="diameter of A, B, C and of the disc's bore"
    )
    length: Length = Field(default=90.0, description="from A to B")
    width: Length = Field(default=54.0, description="from A to C")


class CouponParts(Record):
    """The bodies of the parts, mm."""

    thickness: Length = Field(default=4.0, description="of plate and disc")
    pin_height: Length = Field(default=8.0, description="of the standing pins")
    wall: Length = Field(default=3.0, description="between two holes, at least")


class Measured(Record):
    """What was measured; sizes: by feature, one reading or several."""

    caliper: Annotated[float, quantity("mm", gt=0, le=1)] = Field(
        default=0.02, description="standard deviation of one reading"
    )
    runs: Annotated[float, quantity("mm")] | None = Field(
        default=None, description="the tightest of clearances in which the loose pin turns freely"
    )
    holds: Annotated[float, quantity("mm")] | None = Field(
        default=None, description="the widest in which it sits tight"
    )
    sizes: dict[
        str, Length | Annotated[tuple[Length, ...], Field(min_length=1, max_length=100)]
    ] = Field(
        default={},
        description='by feature: one reading, or several: "hole 5" = [4.78, 4.80]; measure as many as you '
        "like",
    )

    @model_validator(mode="before")
    @classmethod
    def _sizes_below(cls, data: Any) -> Any:
        stray = (
            [key for key in data if " " in key or key == "disc"] if isinstance(data, dict) else []
        )
        if stray:
            raise ValueError(f"below the line [measured.sizes]: {', '.join(stray)}")
        return data


class CouponLimits(Record):
    """What the measuring has to reach."""

    uncertainty: Length = Field(
        default=0.05,
        description="of a compensation, 95 %: a quarter of the usual running clearance",
    )
    departure: Length = Field(
        default=0.15, description="by which one size may be off what the values give it"
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
        default=Measured.model_construct(), description="what the caliper said"
    )
    allowed: Annotated[CouponLimits, Field(alias="limits")] = CouponLimits.model_construct()

    def faults(self) -> Sequence[Fault]:
        """What is wrong between keys that are right one by one."""
        g = self.geometry
        m = self.measured
        found = list[Fault]()
        for key in ("holes", "gaps", "pins", "clearances"):
            values = getattr(g, key)
            if any(not float(f"{a:g}") < float(f"{b:g}") for a, b in pairwise(values)):
                found.append(
                    Fault(
                        ("geometry", key), str(list(values)), "sizes from small to large, each once"
                    )
                )
        if g.fit_pin + g.clearances[0] < self.print.nozzle:
            said = f"more than {self.print.nozzle - g.fit_pin:g}: a hole is left"
            found.append(Fault(("geometry", "clearances", 0), f"{g.clearances[0]:g}", said))
        if self.making.wall < self.print.nozzle:
            found.append(
                Fault(
                    ("parts", "wall"),
                    f"{self.making.wall:g}",
                    f"at least the nozzle, {self.print.nozzle:g} mm",
                )
            )
        for key in ("runs", "holds"):
            value = getattr(m, key)
            if value is not None and value not in g.clearances:
                found.append(
                    Fault(
                        ("measured", key),
                        f"{value:g}",
                        f"one of geometry.clearances: {list(g.clearances)}",
                    )
                )
        if m.runs is not None and m.holds is not None and m.holds >= m.runs:
            found.append(
                Fault(
                    ("measured", "holds"),
                    f"{m.holds:g}",
                    f"less than measured.runs, {m.runs:g}: the pin is tight there",
                )
            )
        nominal = {each.name: each.nominal for each in self.sizes}
        for name, size in m.sizes.items():
            if name not in nominal:
                found.append(unknown(("measured", "sizes", name), name, nominal))
                continue
            for value in size if isinstance(size, tuple) else (size,):
                if abs(value - nominal[name]) > _OFF:
                    said = f"within {_OFF:g} mm of {nominal[name]:g}; was another size measured?"
                    found.append(Fault(("measured", "sizes", name), f"{value:g}", said))
        return found

    # ---- sizes ------------------------------------------------------------------------------------------------------

    @cached_property
    def sizes(self) -> Sequence[Feature]:
        """All that can be measured; walls of holes come in, outlines come out."""
        g = self.geometry
        found = [Feature(f"hole {d:g}", d, -2, 0) for d in g.holes]
        found += [Feature(f"gap {w:g}", w, -2, 0) for w in g.gaps]
        found += [Feature(f"pin {d:g}", d, 0, 2) for d in g.pins]
        found += [Feature(f"fit {c:g}", g.fit_pin + c, -2, 0) for c in g.clearances]
        found += [
            Feature("fit pin", g.fit_pin, 0, 2),
            Feature("disc", g.disc, 0, 2),
            Feature("disc bore", g.datum_hole, -2, 0),
        ]
        for axis, way in (("x", g.length), ("y", g.width)):
            found += [
                Feature(f"over {axis}", way + g.datum_hole, -2, 0),
                Feature(f"between {axis}", way - g.datum_hole, 2, 0),
            ]
        return [*found, Feature("disc foot", g.disc, 0, 2)]

    @cached_property
    def calibrated(self) -> Calibrated:
        """What follows from [measured]."""
        p = self.print
        m = self.measured
        named = {each.name: each for each in self.sizes}
        given = {
            name: size if isinstance(size, tuple) else (size,) for name, size in m.sizes.items()
        }
        fits = [None if c is None else named[f"fit {c:g}"] for c in (m.runs, m.holds)]
        step = min(b - a for a, b in pairwise(self.geometry.clearances))
        printed = Printed(p.hole_compensation, p.profile_compensation, p.shrinkage, p.elephant_foot)
        return calibrated(
            [each for each in self.sizes if each.name != "disc foot"],
            given,
            printed,
            m.caliper,
            (named["fit pin"], fits[0], fits[1], step),
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
        self._made  # noqa: B018  refuses what cannot be made
        found = [
            at_most(
                "CALIBRATION",
                value.wide,
                self.allowed.uncertainty,
                "mm",
                Where(f"print.{value.key}"),
                f"{value.value:.4g} mm, known to so much (95 %): measure more sizes, or each one several times",
            )
            for value in self.calibrated.values
            if value.key in ("hole_compensation", "profile_compensation")
        ]
        if self.calibrated.rows:
            name, measured, meant, left = max(self.calibrated.rows, key=lambda row: abs(row[3]))
            said = f"measured {measured:.4g} mm, {meant:.4g} by the values found; measure it again, or print it for itself"
            found.append(
                at_most(
                    "CALIBRATION_FIT", abs(left), self.allowed.departure, "mm", Where(name), said
                )
            )
        return found

    def study(self) -> Study:
        """The values and how well they fit, or what to measure."""
        done = self.calibrated
        numbers = {
            f"print_{each.key}_{'share' if each.unit == '1' else each.unit}": each.value
            for each in done.values
        }
        if not done.rows:
            return Study(notes=self.remarks().printed)
        values = [
            (each.key, each.value, each.measured, each.wide, each.unit, each.source)
            for each in done.values
        ]
        nominal = {each.name: each.nominal for each in self.sizes}
        rows = [(name, nominal[name], *row) for name, *row in done.rows]
        series = ("sizes", np.array([row[1] for row in rows]), np.array([row[-1] for row in rows]))
        plot = Plot("What is left of each size", "nominal, mm", "mm", [series], dots=("sizes",))
        tables = [
            Table(
                "Values for [print]",
                ("key", "value", "measured", "+- (95 %)", "unit", "from"),
                values,
            ),
            Table(
                "Sizes",
                ("feature", "nominal, mm", "measured, mm", "by these values, mm", "left, mm"),
                rows,
            ),
        ]
        return Study(numbers, [plot], tables)

    def remarks(self) -> Remarks:
        """What to paste, line by line, or what to do first."""
        if not self.calibrated.values:
            return Remarks(
                [
                    "nothing is measured yet: print it, measure it, type the sizes into [measured.sizes] and build again"
                ]
            )
        return Remarks(
            ["for [print] of your specs:", *(each.line for each in self.calibrated.values)]
        )

    # ---- parts ------------------------------------------------------------------------------------------------------

    @cached_property
    def assembly(self) -> Assembly:
        """Plate, loose pin and disc, side by side on the bed; the origin is hole A, the pin's and the disc's axis."""
        g = self.geometry
        low = -max(g.datum_hole / 2, _SLOT) - self.making.wall - _APART - g.disc / 2
        beside = complex(g.disc / 2 + _APART + g.fit_pin / 2 + self.making.wall, low)
        mounts = (
            Mount("gauge", GROUND),
            Mount("disc", GROUND, 1j * low),
            Mount("pin", GROUND, beside),
        )
        lines = [each.line for each in self.calibrated.values]
        texts = {"print.toml": "\n".join(["[print]", *lines, ""])} if lines else {}
        return replace(self._assembly(self._made, mounts), texts=texts, work=[self._measuring()])

    def _measuring(self) -> Table:
        """What to measure, and how."""
        how = {
            "gauge": "holes, gaps, fits: the caliper's inner jaws; pins: the outer ones; over x, over y: inner jaws on the far "
            "walls of A and B, of A and C; between x, between y: outer jaws on the near ones",
            "pin": "its shank: fit pin; runs: the tightest hole in which it turns, holds: the widest in which it holds",
            "disc": "disc in the middle of its height, disc foot at its lowest layer, disc bore",
        }
        rows = [(k, part.name, how[part.name]) for k, part in enumerate(self._made, 1)]
        return Table(
            "What to measure, cold",
            ("step", "part", "how"),
            rows,
            [[f"{part.name}-1"] for part in self._made],
        )

    @cached_property
    def _made(self) -> Sequence[Part]:
        g = self.geometry
        p = self.making
        least = self.allowed.min_wall
        datum = g.datum_hole / 2
        holes: dict[str, tuple[complex, Contour]] = {
            name: (z, circle(z, datum))
            for name, z in (("A", 0j), ("B", complex(g.length)), ("C", 1j * g.width))
        }
        y = self._heights()
        for name, x, w in self._row("gap", g.gaps, datum, g.length - datum):
            holes[name] = (
                complex(x, y[0]),
                rectangle(complex(x - w / 2, y[0] - _SLOT), complex(x + w / 2, y[0] + _SLOT)),
            )
        for name, x, d in self._row("hole", g.holes, -datum, g.length + datum):
            holes[name] = complex(x, y[1]), circle(complex(x, y[1]), d / 2)
        for name, x, d in self._row("fit", g.clearances, -datum, g.length + datum, g.fit_pin):
            holes[name] = complex(x, y[2]), circle(complex(x, y[2]), d / 2)
        pins = [
            (name, complex(x, y[3]), d)
            for name, x, d in self._row("pin", g.pins, datum, g.length + datum)
        ]
        left = -datum
        right = g.length + datum
        low = -max(datum, _SLOT)
        high = g.width + max(datum, max(g.pins) / 2)
        corners = (
            complex(left, low),
            complex(right, low),
            complex(right, high),
            complex(left, high),
        )
        outer = rounded([(z, p.wall) for z in corners])
        region = plate(
            "coupon", outer, {name: contour for name, (_, contour) in holes.items()}, least
        )
        stand = (
            Layer(Region(circle(z, d / 2)), p.thickness, p.thickness + p.pin_height)
            for _, z, d in pins
        )
        named = tuple((name, z) for name, (z, _) in holes.items())
        over = [
            f"{axis}: {way + 2 * datum:g} over the far walls of A and {to}, {way - 2 * datum:g} between the near ones"
            for axis, way, to in (("x", g.length, "B"), ("y", g.width, "C"))
        ]
        body = Part(
            "gauge",
            "Plate with holes and pins",
            (Layer(region, 0.0, p.thickness), *stand),
            centres=tuple(z for _, z in named),
            min_wall=least,
            points=(*named, *((name, z) for name, z, _ in pins)),
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
