"""The collar that a set screw holds on the shaft of a motor, over all that sits there."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from camgen.parts.set_screws import SetScrewHub

if TYPE_CHECKING:
    from camgen.parts.generator.layout import Layout


def collar(layout: Layout, point: str) -> SetScrewHub | None:
    """Of the shaft at a point; None where that is no motor's, or nothing asks for it."""
    drives = layout.sizes.face is not None and layout.shafts.get(point) == layout.driven
    return layout.sizes.collar(layout.fits.press_clearance, layout.min_wall) if drives else None


def levels_over(layout: Layout, point: str, least: float) -> int:
    """How many levels, of links as thin as `least`, it takes over the highest link on its shaft."""
    found = collar(layout, point)
    return 0 if found is None else math.ceil(found.height / (least + layout.fits.slide_clearance))
