"""A machine that draws a line with two slides on the plate, each moved by a cam, and a third one across, which carries the pen.

            V1            S shaft of both cams; v slides up and down over it, by the roller T2; h slides along the axis to the right, by
    v  ---- pen Q         the roller T1. The pen's own slide is on v, across, and h's pin K moves it along: K stands in a slot of the
       |     |            pen's slide that is upright. So each cam moves the pen along its own axis, and nothing turns.
      T2     K
       S  T1-+- h         V1 gives v an end over the pen's rails, beyond which its own rails on the plate begin.

A cam whose follower slides keeps to smaller pressure angles than one with an arm: the cams are larger, the play is less.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camgen.design.pen_cams import CAMS, WALLS, closed_rows, groove, likely
from camgen.numerics import Points
from camgen.reading import Data

_STEEP = math.radians(
    28
)  # of the pressure angle in the estimate; the spec's own limit is judged after it
_NEAR = 31.0  # mm, of the pen from the middle of v at least: its rails lie on v
_RAILS = 12.0  # mm, half of the pen's rails across, with air
_SLOT = 12.0  # mm, from the pen's hole to the nearest place of K in its slot
_AIR = 0.5  # mm, of K beyond its way in the slot
_OUT = 30.0  # mm, to the points that say in which direction a slide goes
_STAND = 45.0  # mm, of v's rails on the plate
_PIVOT = 10.0  # mm, from the grooves' plates to a lever's pivot


@dataclass(frozen=True)
class CrossedSlides:
    """Sizes of a machine, mm; line: places of the pen at even angles, in the middle of which is 0."""

    line: Points
    cam: float  # middle distance of the rollers from the shaft
    radius: float  # of the rollers

    @property
    def _half(self) -> complex:
        """Half the width and half the height of the drawing."""
        return complex(np.ptp(self.line.real) / 2, np.ptp(self.line.imag) / 2)

    @property
    def _plates(self) -> float:
        """Radius of the larger groove's outer plate."""
        return self.cam + max(self._half.real, self._half.imag) + WALLS

    @property
    def far(self) -> float:
        """Of a lever's pivot from the shaft, that clears the grooves."""
        return self._plates + _PIVOT

    @property
    def _across(self) -> float:
        """Height of the pen's rails over the shaft, in the middle."""
        return self._plates + self._half.imag + _RAILS

    @property
    def middle(self) -> complex:
        """Where the middle of the drawing is, seen from the shaft: the rails are half-way between the pen and its slot's end."""
        reach = _SLOT + 2 * self._half.imag + _AIR
        return complex(_NEAR + self._half.real, self._across + reach / 2)

    @property
    def longest(self) -> float:
        """Across the longest part: v with its stem, or a groove's outer plate."""
        stem = self._across + _RAILS + 2 * self._half.imag + _STAND - self.cam
        return max(stem, 2 * self._plates)

    @property
    def size(self) -> float:
        """By which machines are tried."""
        return self.cam

    @property
    def likely(self) -> bool:
        """Whether the estimates of its cams hold."""
        ways = (self.line.real, self.line.imag)
        return all(likely(way, self.cam, self.radius, _STEEP) for way in ways)

    @property
    def said(self) -> str:
        """Its sizes, in words."""
        return f"two slides and one across, cams of {self.cam:.4g} mm in the middle"

    def tables(self, rows: int) -> tuple[Data, float]:
        """Points, links, slides, slot, cams, further outputs and parts of the spec, and how far the rows leave the line, mm."""
        start = complex(self.line[0])
        pen = start + self.middle
        up = 1j * start.imag
        pin = complex(pen.real, self.middle.imag - _SLOT - self._half.imag)
        end = 1j * (self._across + _RAILS) + up
        places = {
            "S": 0j,
            "X": complex(self.cam + _OUT),
            "Y": 1j * (self.cam + _OUT),
            "T1": complex(self.cam + start.real),
            "T2": 1j * self.cam + up,
            "K": pin,
            "V1": end,
            "V2": end + _OUT,
            "Q": pen,
            "W": pen - 1j * _OUT,
        }
        links = {
            "ground": ["S", "X", "Y"],
            "disc": ["S"],
            "h": ["T1", "K"],
            "v": ["T2", "V1", "V2"],
            "pen": ["Q", "W"],
        }
        across, across_off = closed_rows(self.line.real, rows)
        along, along_off = closed_rows(self.line.imag, rows)
        tables: Data = {
            "points": places,
            "links": links,
            "slide": [
                {"link": "h", "on": "ground", "along": ["S", "X"]},
                {"link": "v", "on": "ground", "along": ["S", "Y"]},
                {"link": "pen", "on": "v", "along": ["V1", "V2"]},
            ],
            "slot": [{"pin": "K", "link": "pen", "along": ["W", "Q"]}],
            "cam": [
                groove("h", "T1", self.radius, across, "x"),
                groove("v", "T2", self.radius, along, "y"),
            ],
            "output": [{"name": "height", "point": "V1"}],
            "parts": {"pen": {"stem": "behind"}, "v": {"stem": "ahead"}},
        }
        return tables, across_off + along_off


def crossed_slides(line: Points, radius: float) -> list[CrossedSlides]:
    """Those whose estimates hold, the smallest first; line: as of `CrossedSlides`."""
    made = (CrossedSlides(line, cam, radius) for cam in CAMS)
    return [each for each in made if each.likely]
