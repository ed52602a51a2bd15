"""Edges of a printed part from flatbed scans: a cam's outline and holes to a fraction of a pixel.

    level     grey levels of part and ground are quadratic fields, so that uneven light does not move the edge, which is
              where the level is half way between them; an error function fitted along the normal gains a fifth where light
              throws shadows (9.3 to 7.4 um rms at 600 dpi) and loses a factor of 2 on glossy edges (4.8 to 8.7): left out
    bore      the round hole nearest the middle of the part; its centre becomes the origin
    scanner   scale and skew, z -> z + m conj(z), from scans of the part turned on the glass: the part is rigid, and what
              turns with it is its own, what does not is the scanner's
    specks    the median of the radius over three scans or more of one part keeps what is printed and drops what is dust

Places are complex numbers, mm, y up as the picture is seen; levels are 0 on the ground and 1 on the part.
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camgen.bounds import Bound, read_bytes
from camgen.errors import FileError, counted
from camgen.extras import install_line
from camgen.geometry.registration import lay, middle, star, straighten
from camgen.geometry.rings import Floats, Points, Ring, fit_circle
from camgen.numerics import coordinates, least_squares, magnitude
from camgen.study import Figure, Figures, figures_in

PICTURES = {".png": ".png", ".jpg": ".jpg", ".jpeg": ".jpg", ".tif": ".tif", ".tiff": ".tif"}
PICTURE_SIZE = Bound("a picture", 200_000_000)
_MOST_PIXELS = 40_000_000  # A4 at 600 dpi is 35 million
_DPI = (50.0, 9600.0)
_COARSE = 400  # pixels across the small picture on which part and ground are told apart
LEAST_CONTRAST = 50.0  # grey levels of 255
_LEVEL = 0.2  # share of the step from ground to part by which a scanner's gamma may move its middle
_SECOND_PART = 0.05  # of the area of the largest: what is smaller is a speck
_SPECK = 0.5  # mm across
_ROUND = 0.02  # of the radius: how far a round hole's edge may stand off its circle
_SAME_PLACE = math.sin(
    math.radians(20)
)  # sine of the turn between scans below which they tell nothing of the scanner
_SCANNER = 0.003  # share by which one axis of a flatbed may be off
_ONE_PART = 0.01  # of its size: what scans of one part may be apart
_STRAYS = 4.0  # robust standard deviations beyond which a point is a speck's
_INCH = 25.4
WALL_OFF = "{of} off"  # of figures: what the wall may be off by the measuring, mm


@dataclass(frozen=True)
class Scanning:
    """How scans are read."""

    dpi: float | None = None  # where the file does not say it
    others: tuple[Path, ...] = ()  # further scans of the same part
    across: float | None = None  # its greatest width, mm


@dataclass(frozen=True)
class Scan:
    """Edges of the one part in a picture: outline and holes, counter-clockwise, mm; width of the blurred edge, mm.

    contrast: grey levels of 255.
    """

    outer: Points
    holes: tuple[Points, ...]
    width: float
    contrast: float
    dpi: float


@dataclass(frozen=True)
class Scanned:
    """One part from its scans: outline first and holes, mm, the bore at the origin; sentences; figures of the scanner."""

    rings: list[Ring]
    remark: str
    contrast: float
    numbers: Figures


# ---- one picture -----------------------------------------------------------------------------------------------------


def read_scan(path: Path, dpi: float | None = None) -> Scan:
    """Edges in a picture of one part on a plain background.

    FileError where it cannot be read, is too large, has little contrast, no part, two, or one that its frame cuts off.
    """
    try:
        import contourpy
        from PIL import Image, UnidentifiedImageError
    except ImportError:
        raise FileError(path, f"needs Pillow and contourpy: {install_line('scan')}") from None
    try:
        content = read_bytes(path, PICTURE_SIZE)
        with warnings.catch_warnings(), _any_size(Image):
            warnings.simplefilter("ignore")
            with Image.open(io.BytesIO(content), formats=("png", "jpeg", "tiff")) as picture:
                entry = picture.info.get("dpi")
                grey = _grey(path, picture)
    except (UnidentifiedImageError, SyntaxError, ValueError, EOFError) as error:
        raise FileError(path, f"is no picture that can be read: {error}") from None
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from None
    pitch = _INCH / _resolution(path, dpi, entry)
    level, (row, column), contrast = _levelled(path, grey)
    lines = contourpy.contour_generator(z=level).lines(0.5)
    height = grey.shape[0]
    closed = []
    for line in lines:
        assert isinstance(line, np.ndarray)
        if len(line) > 8 and np.array_equal(line[0], line[-1]):
            closed.append((line[:-1, 0] + column + 1j * (height - 1 - row - line[:-1, 1])) * pitch)
    rings = sorted(
        (Ring.straight(z).counter_clockwise() for z in closed), key=lambda ring: -ring.area
    )
    if not rings:
        raise FileError(
            path,
            "shows no closed edge: lay the part on a plain background, all of it in the picture",
        )
    outer = rings[0]
    within = [ring for ring in rings[1:] if outer.encloses(complex(ring.points[0]))]
    holes = tuple(ring.points for ring in within if ring.area > math.pi / 4 * _SPECK**2)
    place = np.array(
        [height - 1 - row - outer.points.imag / pitch, outer.points.real / pitch - column]
    )
    width = pitch / _slope(level, place, outer.points)
    return Scan(outer.points, holes, width, contrast, _INCH / pitch)


@contextmanager
def _any_size(library: Any) -> Iterator[None]:
    """Let Pillow open a picture of any size, whose pixels it does not read yet: `_grey` says where it has too many."""
    setting = library.MAX_IMAGE_PIXELS
    library.MAX_IMAGE_PIXELS = None
    try:
        yield
    finally:
        library.MAX_IMAGE_PIXELS = setting


def _resolution(path: Path, dpi: float | None, entry: Any) -> float:
    """Dots per inch, as asked for or as the file says, the same both ways."""
    if dpi is None and entry:
        across, down = (float(each) for each in entry)
        if abs(across - down) > 1e-3 * across:
            raise FileError(
                path,
                f"says {across:.0f} dots per inch across and {down:.0f} down: give one with --dpi",
            )
        dpi = across
    if dpi is None:
        raise FileError(path, "does not say how many dots per inch it has: give them with --dpi")
    if not _DPI[0] <= dpi <= _DPI[1]:
        raise FileError(
            path,
            f"has {dpi:.0f} dots per inch; {_DPI[0]:g} to {_DPI[1]:g} are taken: give them with --dpi",
        )
    return dpi


def _grey(path: Path, picture: Any) -> Any:
    """Grey levels 0 to 255 of a picture that its header tells to be small enough, (rows, columns)."""
    across, down = picture.size
    if across * down > _MOST_PIXELS:
        most = f"at most {_MOST_PIXELS / 1e6:.0f} million are read"
        raise FileError(
            path,
            f"has {across} x {down} pixels; {most}: scan the part's place alone, or with fewer dots per inch",
        )
    if min(across, down) < 50:
        raise FileError(
            path, f"has {across} x {down} pixels: too few for a part, 50 each way at least"
        )
    if picture.mode == "1":
        raise FileError(
            path,
            "is only black and white: scan in grey levels, which show where in a pixel the edge is",
        )
    if picture.mode.startswith(("I", "F")):
        values = np.asarray(picture, np.float32)
        return values / np.float32(
            257.0 if picture.mode.startswith("I") else max(float(values.max()), 1e-9) / 255
        )
    return np.asarray(picture.convert("L"))


def _levelled(path: Path, grey: Any) -> tuple[Any, tuple[int, int], float]:
    """Level of each pixel round the part, row and column of the first of them, and the contrast in grey levels.

    Part and ground are told apart on a small picture, then each grey level is a quadratic field of the place.
    """
    from scipy import ndimage

    step = max(1, math.ceil(max(grey.shape) / _COARSE))
    rows, columns = (n // step for n in grey.shape)
    small = (
        grey[: rows * step, : columns * step]
        .reshape(rows, step, columns, step)
        .mean(axis=(1, 3), dtype=np.float64)
    )
    frame = np.ones(small.shape, bool)
    frame[1:-1, 1:-1] = False
    y, x = np.indices(small.shape)
    lit = small > _between(small)
    part = lit != (np.mean(lit[frame]) > 0.5)
    fields = np.zeros((2, 6))
    for _ in range(4):
        inner = [
            ndimage.binary_erosion(mask, iterations=2, border_value=1) for mask in (~part, part)
        ]
        if min(int(mask.sum()) for mask in inner) < 30:
            raise FileError(
                path, "shows no part: grey levels of two kinds, part and background, were expected"
            )
        fields = np.array(
            [_field(x[mask] / columns, y[mask] / rows, small[mask]) for mask in inner]
        )
        ground, body = (_powers(x / columns, y / rows) @ field for field in fields)
        part = np.abs(small - body) < np.abs(small - ground)
    contrast = float(np.min(np.abs(body - ground)[part]))
    remark = f"the part differs from its background by {contrast:.0f} of 255 grey levels"
    if contrast < LEAST_CONTRAST:
        raise FileError(
            path,
            f"{remark}; at least {LEAST_CONTRAST:.0f} were expected: lay a sheet of the opposite shade over it",
        )
    label, count = ndimage.label(part, np.ones((3, 3)))
    sizes = np.bincount(label.ravel())[1:]
    large = np.flatnonzero(sizes > _SECOND_PART * sizes.max()) + 1
    if np.isin(label[frame], large).any():
        raise FileError(
            path, "shows a part that the picture's frame cuts off: leave a margin all round it"
        )
    if len(large) > 1:
        raise FileError(path, f"shows {len(large)} parts: scan one at a time, or cut the picture")
    box = ndimage.find_objects((label == large[0]).astype(np.int8))[0]
    first = [max(0, (side.start - 3) * step) for side in box]
    last = [min(n, (side.stop + 3) * step) for side, n in zip(box, grey.shape, strict=True)]
    level = np.asarray(grey[first[0] : last[0], first[1] : last[1]], np.float64)
    # a block's middle is (step - 1) / 2 pixels from its first one
    down, across = (
        (np.arange(a, b) - (step - 1) / 2) / step for a, b in zip(first, last, strict=True)
    )
    across = across / columns
    for i, v in enumerate(down / rows):
        ground, body = (_powers(across, np.full(len(across), v)) @ field for field in fields)
        level[i] = (level[i] - ground) / (body - ground)
    return level, (first[0], first[1]), contrast


def _between(values: Floats) -> float:
    """Level that parts values into two kinds [Otsu 1979]."""
    count, edges = np.histogram(values, 256)
    middle = (edges[:-1] + edges[1:]) / 2
    below = np.cumsum(count)
    total = float(count.sum())
    sums = np.cumsum(count * middle)
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = (sums[-1] * below / total - sums) ** 2 / (below * (total - below))
    return float(middle[int(np.nanargmax(np.where(np.isfinite(spread), spread, -1)))])


def _powers(x: Floats, y: Floats) -> Floats:
    return np.stack([np.ones(x.shape), x, y, x * x, x * y, y * y], axis=-1)


def _field(x: Floats, y: Floats, values: Floats) -> Floats:
    """Coefficients of the quadratic field through values at places, specks left out."""
    table = _powers(x, y)
    mask = np.ones(len(values), bool)
    coefficients = np.zeros(6)
    for _ in range(4):
        coefficients = np.asarray(least_squares(table[mask], values[mask]))
        off = np.abs(values - table @ coefficients)
        mask = off <= _STRAYS * 1.4826 * max(float(np.median(off)), 0.25)
    return coefficients


def _slope(level: Any, place: Floats, outline: Points) -> float:
    """Median steepness of the level over an edge, per pixel; place: (2, n) rows and columns of its points."""
    from scipy import ndimage

    along = np.roll(outline, -3) - np.roll(outline, 3)
    across = along / np.abs(along) * -1j
    offset = np.array([-across.imag, across.real])
    sides = [ndimage.map_coordinates(level, place + each * offset, order=1) for each in (-0.5, 0.5)]
    return float(np.median(np.abs(sides[1] - sides[0])))


# ---- one part --------------------------------------------------------------------------------------------------------


def scanned(path: Path, how: Scanning) -> Scanned:
    """One part from one scan or several; FileError as `read_scan`, and where it has no bore."""
    files = (path, *how.others)
    scans = [read_scan(file, how.dpi) for file in files]
    first = scans[0]
    bores = [
        _bore(file, scan.outer, scan.holes)[0] for file, scan in zip(files, scans, strict=True)
    ]
    shapes = [
        [edge - bore for edge in (scan.outer, *scan.holes)]
        for scan, bore in zip(scans, bores, strict=True)
    ]
    contrast = min(scan.contrast for scan in scans)
    figures = [Figure("scan contrast", contrast), Figure("edge width", first.width, "mm")]
    remarks = [f"{first.dpi:.0f} dots per inch, the edge blurred over {first.width:.3f} mm"]
    unknown = _SCANNER
    if how.others:
        shapes[0], resolved = _together(files, shapes, figures, remarks)
        unknown = _SCANNER / 2 if resolved else _SCANNER
    outline, *holes = shapes[0]
    if how.across is not None:
        width = _widest(outline)
        figures.append(Figure("scale", 100 * (width / how.across - 1), "%"))
        outline = outline * (how.across / width)
        holes = [hole * (how.across / width) for hole in holes]
        remarks.append(f"scaled to {how.across:g} mm at its widest, {width:.3f} mm by the dots")
        unknown = 0.0 if unknown < _SCANNER else unknown
    centre, diameter = _bore(path, outline, holes)
    outline = outline - centre
    holes = [hole - centre for hole in holes]
    if unknown:
        off = unknown * magnitude(outline)
        figures.append(Figure(WALL_OFF, off, "mm", "scanner"))
        needs = ["a scan turned by 90 deg (--second-scan)"] * (unknown == _SCANNER)
        needs += ["a caliper (--across)"] * (how.across is None)
        remarks.append(
            f"the scanner's own scale may be off by {100 * unknown:g} %, {off:.3f} mm at the "
            f"farthest point: measure it by {' and '.join(needs)}"
        )
    rings = [Ring.straight(z) for z in (outline, *holes)]
    level_off = _LEVEL * first.width
    figures.append(Figure(WALL_OFF, level_off, "mm", "edge level"))
    figures.append(Figure("bore", diameter, "mm"))
    remarks.append(f"the origin is in the middle of the hole of diameter {diameter:.3f} mm")
    remarks.append(_sizes(holes))
    remarks.append(
        f"the level at which the edge is taken may shift it by {level_off:.3f} mm all round"
    )
    remark = "; ".join(each for each in remarks if each)
    return Scanned(rings, remark, contrast, Figures(figures))


def _together(
    files: Sequence[Path],
    shapes: Sequence[Sequence[Points]],
    figures: list[Figure],
    remarks: list[str],
) -> tuple[list[Points], bool]:
    """One shape of several scans, in the frame of the first, and whether they tell the scanner's scale and skew."""
    placements = lay(shapes[0], shapes[1:])[1]
    resolved = any(abs(math.sin(each.turn)) > _SAME_PLACE for each in placements)
    m = 0j
    if resolved:
        m, placements = lay(shapes[0], shapes[1:], distortion=True)
        figures += figures_in("%", scanner_across=200 * m.real, scanner_shear=200 * m.imag)
        remarks.append(
            f"the scanner's x axis is {200 * m.real:+.3f} % long beside its y axis, its shear {200 * m.imag:+.3f} %"
        )
    else:
        remarks.append(
            "the scans lie alike on the glass, so they do not show the scanner's scale and skew: turn one of them by 90 deg"
        )
    size = magnitude(shapes[0][0])
    for file, each in zip(files[1:], placements, strict=True):
        if each.off > _ONE_PART * size:
            raise FileError(
                file,
                f"does not show the part of {files[0].name}, or its other face: {each.off:.3f} mm apart (rms)",
            )
    outline, *holes = (straighten(edge, m) for edge in shapes[0])
    back = [
        outline,
        *(
            each.back(straighten(shape[0], m))
            for each, shape in zip(placements, shapes[1:], strict=True)
        ),
    ]
    if all(map(star, back)):
        outline, repeat = middle(back)
        figures.append(Figure("edge repeat", repeat, "mm"))
        remarks.append(
            f"{len(files)} scans laid on each other, the middle one taken at each angle; they repeat within "
            f"{repeat:.4f} mm (rms), which says less than what is common to all"
        )
    else:
        remarks.append(
            "rays from the bore meet the outline more than once: that of the first scan is taken"
        )
    return [outline, *holes], resolved


def _widest(outline: Points) -> float:
    """Greatest distance between two points of an outline, mm, as a caliper reads it."""
    from scipy.spatial import ConvexHull

    hull = outline[ConvexHull(coordinates(outline)).vertices]
    return magnitude(hull[:, None] - hull)


def _round(hole: Points) -> tuple[complex, float, float]:
    """Centre and radius, mm, of the circle that most of a hole's edge lies on, and how far it stands off, mm."""
    mask = np.ones(len(hole), bool)
    centre = 0j
    radius = 0.0
    off = math.inf
    for _ in range(6):
        centre, radius, _ = fit_circle(hole[mask])
        miss = np.abs(np.abs(hole - centre) - radius)
        limit = _STRAYS * 1.4826 * float(np.median(miss))
        mask = miss <= limit
        off = float(np.quantile(miss, 0.7))
    return centre, radius, off


def _round_ones(holes: Sequence[Points]) -> list[tuple[complex, float]]:
    """Centres and diameters of the holes that are round, in order."""
    circles = []
    for hole in holes:
        centre, radius, off = _round(hole)
        area = abs(Ring.straight(hole).area)
        if off <= _ROUND * radius and abs(area / (math.pi * radius**2) - 1) < 4 * _ROUND:
            circles.append((centre, 2 * radius))
    return circles


def _bore(path: Path, outline: Points, holes: Sequence[Points]) -> tuple[complex, float]:
    """Centre and diameter of the round hole nearest the middle of an outline; specks at its edge do not count."""
    middle = Ring.straight(outline).centroid
    round_ones = _round_ones(holes)
    if not round_ones:
        reason = f"shows no bore, {counted(len(holes), 'hole')}, none of them round"
        raise FileError(
            path, f"{reason}: take its shaft out, clean it, scan the face on which it is open"
        )
    return min(round_ones, key=lambda each: abs(each[0] - middle))


def _sizes(holes: Sequence[Points]) -> str:
    """Sizes and places of the round holes, in words."""
    remark = (
        f"{size:.3f} mm at {at.real:z.3f}/{at.imag:z.3f}" for at, size in _round_ones(holes)[:12]
    )
    return "round holes: " + ", ".join(remark)
