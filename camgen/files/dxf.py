"""DXF documents: millimetres, every contour one closed entity, the same bytes on every day.

Format R2010: the oldest that LibreCAD, GDAL and the laser shops' programs all read and that carries units.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from camgen.geometry.arcs import as_circle, bulges
from camgen.geometry.outlines import Arc, Contour, end_point, start_point


@contextmanager
def document(path: Path, layers: Mapping[str, tuple[int, int]], box: tuple[complex, complex]) -> Iterator[Any]:
    """An empty modelspace (ezdxf) to fill; saved to `path` on leaving.

    layers: name -> (colour index, line weight in 1/100 mm); box: lower left and upper right corner of the content, mm.
    """
    import ezdxf.filemanagement
    from ezdxf import units
    from ezdxf._options import options

    # No clock and no chance in the file; ezdxf offers this as a global option only.
    kept = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        doc = ezdxf.filemanagement.new("R2010", setup=False)
        doc.units = units.MM
        doc.header["$MEASUREMENT"] = 1
        doc.linetypes.add("CENTER2", [12.0, 8.0, -1.5, 1.0, -1.5], description="Center ____ _ ____ _")
        for name, (colour, weight) in layers.items():
            doc.layers.add(name, color=colour, lineweight=weight)
        space = doc.modelspace()
        space.reset_extents((box[0].real, box[0].imag, 0), (box[1].real, box[1].imag, 0))
        yield space
        # Left alone, ezdxf lists classes in the order of a set of strings, which differs from run to run.
        for name in sorted(doc.entitydb.dxf_types_in_use()):
            doc.classes.add_class(name)
        text = io.StringIO()
        doc.write(text)
    finally:
        options.write_fixed_meta_data_for_testing = kept
    path.write_bytes(text.getvalue().encode("utf-8"))


def add_contour(space: Any, contour: Contour, layer: str) -> None:
    """Add a contour of lines and arcs as ONE entity: a CIRCLE, or a closed LWPOLYLINE with every |bulge| < 1."""
    round_one = as_circle(contour)
    if round_one:
        centre, radius = round_one
        space.add_circle((centre.real, centre.imag), radius, dxfattribs={"layer": layer})
        return
    points, bulge = bulges(contour)
    line = space.add_lwpolyline([], close=True, dxfattribs={"layer": layer})
    # `add_lwpolyline` takes a time that grows with the square of the number of points, this does not.
    corners = zip((points + 0).tolist(), bulge.tolist(), strict=True)
    line.lwpoints.set([(z.real, z.imag, 0.0, 0.0, b) for z, b in corners])


def extent(contours: Sequence[Contour]) -> tuple[complex, complex]:
    """Lower left and upper right corner of the box round contours of lines and arcs, complex mm, exact."""
    points: list[complex] = []
    for piece in (p for contour in contours for p in contour.pieces):
        points += [start_point(piece), end_point(piece)]
        if isinstance(piece, Arc):
            low, high = sorted((piece.t0, piece.t1))
            quarter = math.pi / 2
            turns = range(math.ceil(low / quarter), math.floor(high / quarter) + 1)
            points += [piece.centre + piece.radius * 1j ** (k % 4) for k in turns]
    z = np.array(points)
    return complex(z.real.min(), z.imag.min()), complex(z.real.max(), z.imag.max())
