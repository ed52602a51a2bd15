"""Pictures as a flatbed makes them of a part that is known exactly: pixels that count covered area, blur, uneven light, noise,
dust, a scanner whose two axes differ."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from scipy import ndimage
from scipy.spatial import cKDTree

from camgen.geometry.facets import facet_contour
from camgen.geometry.rings import Floats, Points, Ring
from camgen.judge.follower_table import read_follower
from camgen.measuring.motion import recover
from camgen.pipeline import build as pipeline

SPECS = Path(__file__).resolve().parents[2] / "specs"
FOLLOWER = "oscillating,pivot=60/0,arm=67.08203932499369,at_deg=-153.43494882292202,radius=3"


@cache
def cam() -> tuple[tuple[Points, ...], Callable[[Floats], Floats]]:
    """Edges of the starter's cam, the outline first, within 1e-4 mm; and the motion, rad, of the tip on that exact outline.

    The law itself is up to 0.07 deg off at its sharp reversals, which no cam can follow.
    """
    mechanism = pipeline.read_mechanism(SPECS / "uniform-swing.toml", ["parts.make='cams'"])
    part = mechanism.assembly.parts[0]
    edges = (part.region.outer, *part.region.holes)
    drawn = tuple(facet_contour(edge, 1e-4) for edge in edges)
    ring = Ring(drawn[0], np.zeros(len(drawn[0]))).counter_clockwise()
    exact = recover(ring, read_follower(FOLLOWER))
    return drawn, lambda theta: np.interp(theta, exact.theta, exact.s, period=2 * np.pi)


@dataclass(frozen=True)
class Glass:
    """A scanner and how a part lies on it: pitch across and down as shares of the nominal one, shear, turn, shift in mm."""

    dpi: float = 600
    across: float = 1.0
    down: float = 1.0
    shear: float = 0.0
    turn_deg: float = 0.0
    shift: complex = 0.13 + 0.07j
    blur: float = 0.9  # standard deviation, pixels
    noise: float = 2.0  # grey levels
    specks: int = 0
    light: float = 0.12  # share by which it falls off over the picture
    ground: float = 225.0
    part: float = 60.0
    margin: float = 4.0  # mm
    seed: int = 1

    def seen(self, z: Points) -> Points:
        """Where the scanner sees a place of the part, mm."""
        z = z * np.exp(1j * np.radians(self.turn_deg)) + self.shift
        return np.asarray(self.across * (z.real + self.shear * z.imag) + 1j * self.down * z.imag)


def covered(edges: Sequence[Points], shape: tuple[int, int], low: complex, pitch: float) -> Floats:
    """Share of each pixel that the part covers, by the distance of its middle from the edge; row 0 is the lowest."""
    share = np.zeros(shape)
    for edge in edges:
        z = (edge - low) / pitch  # pixels
        image = Image.new("1", (shape[1], shape[0]))
        ImageDraw.Draw(image).polygon([(p.real, p.imag) for p in z], fill=1)
        mask = np.array(image)
        band = ndimage.binary_dilation(mask, iterations=4) & ~ndimage.binary_erosion(
            mask, iterations=4
        )
        rows, columns = np.nonzero(band)
        step = np.abs(np.roll(z, -1) - z)
        count = np.maximum(1, np.ceil(step / 0.2)).astype(int)
        piece = np.repeat(np.arange(len(z)), count)
        u = (np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count)) / count[piece]
        dense = z[piece] + u * (np.roll(z, -1) - z)[piece]
        at = columns + 1j * rows
        near = cKDTree(np.column_stack([dense.real, dense.imag])).query(
            np.column_stack([columns, rows])
        )[1]
        along = np.roll(dense, -1)[near] - np.roll(dense, 1)[near]
        side = np.imag(
            np.conj(along / np.abs(along)) * (at - dense[near])
        )  # on the left of a counter-clockwise edge
        area = np.sum(np.imag(np.conj(z) * np.roll(z, -1)))
        inner = mask.astype(float)
        inner[rows, columns] = np.clip(np.sign(area) * side + 0.5, 0, 1)
        share = inner if edge is edges[0] else share - inner
    return share


def scan(edges: Sequence[Points], glass: Glass) -> tuple[np.ndarray, Points]:  # type: ignore[type-arg]
    """The picture, row 0 the highest, and the outline as the scanner sees it from the picture's lower left pixel, mm."""
    pitch = 25.4 / glass.dpi
    seen = [glass.seen(edge) for edge in edges]
    low = complex(seen[0].real.min(), seen[0].imag.min()) - glass.margin * (1 + 1j)
    high = complex(seen[0].real.max(), seen[0].imag.max()) + glass.margin * (1 + 1j)
    shape = (int((high - low).imag / pitch), int((high - low).real / pitch))
    share = ndimage.gaussian_filter(covered(seen, shape, low, pitch), glass.blur)
    y, x = (np.linspace(-1, 1, n) for n in shape)
    light = 1 - glass.light * (0.5 * x[None, :] + 0.3 * y[:, None] + 0.2 * x[None, :] ** 2)
    level = (glass.ground + (glass.part - glass.ground) * share) * light
    chance = np.random.default_rng(glass.seed)
    for _ in range(glass.specks):
        row, column, size = (
            chance.integers(0, shape[0]),
            chance.integers(0, shape[1]),
            chance.uniform(0.5, 2.5),
        )
        rows, columns = slice(max(0, row - 4), row + 5), slice(max(0, column - 4), column + 5)
        j, i = np.ogrid[
            rows.start : min(rows.stop, shape[0]), columns.start : min(columns.stop, shape[1])
        ]
        speck = np.exp(-((j - row) ** 2 + (i - column) ** 2) / (2 * size**2))
        level[rows, columns] += (chance.choice([-1, 1]) * 90) * speck
    level += chance.normal(0, glass.noise, shape)
    return np.clip(np.rint(level), 0, 255).astype(np.uint8)[::-1], seen[0] - low


def saved(path: Path, edges: Sequence[Points], glass: Glass) -> Path:
    """The picture as a file, which says its dots per inch."""
    Image.fromarray(scan(edges, glass)[0]).save(path, dpi=(glass.dpi, glass.dpi))
    return path


def apart(found: Floats, wanted: Callable[[Floats], Floats]) -> float:
    """Largest difference of two motions, deg, the place of the part's mark on the glass being unknown: the best phase."""
    theta = np.linspace(0, 2 * np.pi, len(found), endpoint=False)
    whole = wanted(theta)
    start = int(np.argmax(np.fft.irfft(np.fft.rfft(found) * np.conj(np.fft.rfft(whole)))))
    phases = -theta[start] + np.radians(np.linspace(-0.3, 0.3, 601))
    return float(min(np.degrees(np.max(np.abs(found - wanted(theta + phase)))) for phase in phases))
