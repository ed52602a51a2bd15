"""The paper of a drawing: sizes of its sheets, and where on one a part is drawn. Coordinates: mm of paper."""

from __future__ import annotations

from dataclasses import dataclass

from camgen.files.measures import Measure, Room, dimension
from camgen.files.sheet import Sheet

# Standard scales, mm of paper for a mm of the part. [ISO 5455]
SCALES = (
    50.0,
    20.0,
    10.0,
    5.0,
    2.0,
    1.0,
    0.5,
    0.2,
    0.1,
    0.05,
    0.02,
    0.01,
    0.005,
    0.002,
    0.001,
    0.0005,
    0.0002,
    0.0001,
    0.00005,
    0.00002,
)  # a drum of the longest length of a spec fits
SIZES = {"A4": (297.0, 210.0), "A3": (420.0, 297.0)}
LARGE = {"A2": (594.0, 420.0), "A1": (841.0, 594.0)}  # of a whole machine
# Frame: 20 mm at the filing edge, 10 mm elsewhere. [ISO 5457]
FILING = 20.0
MARGIN = 10.0
BESIDE_CASE = 2.0  # from a face that is hardened to the line that shows it
TABLE_WIDTHS = (10.0, 17.0, 17.0, 58.0)  # columns of the table of holes


@dataclass(frozen=True)
class Page:
    """A sheet with a part on it: its scale, where the part's origin is, and room between the views."""

    sheet: Sheet
    datum: complex  # the part's origin in the plan view
    scale: float  # mm of paper for a mm of the part
    tolerance: str  # general, of dimensions
    side_x: float  # the part's face at z = 0 in the view from the left
    room_above: float  # over the plan view
    room_below: float  # between the plan view and what is below it
    inner: float  # from the view from the left to the first diameters of bosses
    table_x: float  # left edge of the tables

    def paper(self, z: complex) -> complex:
        """A point of the part in the plan view on the paper."""
        return self.datum + self.scale * z

    def dimension(
        self,
        a: complex,
        b: complex,
        away: complex,
        measure: Measure,
        left: float = FILING + 1,
    ) -> None:
        """A linear dimension of the views; left: edge of the paper that is free."""
        dimension(self.sheet, (a, b), away, measure, self.tolerance, Room(left))
