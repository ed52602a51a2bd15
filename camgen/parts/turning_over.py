"""Whether a part that is turned over fits where it belongs, and moves its machine wrongly there.

It fits where a mirror image of its holes is what they are: a round bore always, a bore with one flat about that flat's
normal, several holes where they lie alike. It moves wrongly where the image of its working edge is another edge, or where
pins in it come to other places than the other parts of its body want them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from camgen.geometry.distances import point_to_ring
from camgen.geometry.facets import facet_contour
from camgen.geometry.outlines import Contour, Points
from camgen.machine.features import (
    CamOutline,
    EdgePair,
    EngagedPair,
    Eye,
    Feature,
    GearTeeth,
    Mark,
    Mount,
    PinEyes,
    PinTracks,
    SlotFaces,
)
from camgen.parts.part import Part
from camgen.parts.standing import discs

_FACETS = 0.01  # mm, by which facets lie off the edges that are compared
_FITS = 0.05  # mm, by which a hole may be off what goes through it
_MOVES = 0.05  # mm, by which the image of an edge may be off the edge: what is less is play
_ANGLES = 1 << 15  # directions in which an edge is compared with its image about a round bore


@dataclass(frozen=True)
class _Hole:
    """A round hole with or without a flat: its centre, radius, and the middle of its area from the centre, mm."""

    centre: complex
    radius: float
    leaning: complex

    @property
    def is_flat(self) -> bool:
        """Whether it has a flat or a keyway."""
        return abs(self.leaning) > _FITS / 10

    def is_at(self, place: complex, leaning: complex, radius: float) -> bool:
        """Whether a hole of that kind there is this one."""
        sizes = abs(place - self.centre), abs(leaning - self.leaning), abs(radius - self.radius)
        return max(sizes) < _FITS


@dataclass(frozen=True)
class _Flip:
    """A turn about an axis in the plane, as the top view has it: z -> to + turn * conj(z - at)."""

    at: complex
    to: complex
    turn: complex

    def __call__(self, z: Points) -> Points:
        """Where points come to lie."""
        return np.asarray(self.to + self.turn * np.conj(z - self.at))


def fit_turned_over(
    parts: Sequence[Part], features: Sequence[Feature], mounts: Sequence[Mount] = ()
) -> Iterator[str]:
    """Names of parts that fit turned over and move wrongly then: by the working edge of a cam or a wheel, or by pins of a
    part that a flat or a keyway holds on the shaft of another one with edges or pins."""
    edges = dict[str, list[complex | None]]()
    eyes = dict[str, list[complex]]()
    for feature in features:
        for name, hole in _working(feature):
            edges.setdefault(name, []).append(hole)
        for eye in _eyes(feature):
            eyes.setdefault(eye.part or "", []).append(eye.at)
    bodies = dict[str, set[str]]()
    for part in parts:
        if (part.name in edges or part.name in eyes) and _flat_bores(part):
            for body in {mount.body for mount in mounts if mount.part == part.name}:
                bodies.setdefault(body, set()).add(part.name)
    together = {name for names in bodies.values() if len(names) > 1 for name in names}
    for part in parts:
        flat = part.prismatic and len({(layer.z0, layer.z1) for layer in part.layers}) == 1
        wrong = (_moves_wrongly(part, _edge(part, hole)) for hole in edges.get(part.name, ()))
        pins = part.name in together and _pins_move(part, eyes.get(part.name, ()))
        if flat and (pins or any(wrong)):
            yield part.name


def _eyes(feature: Feature) -> Iterator[Eye]:
    """Eyes of parts of which a feature knows the place."""
    match feature:
        case PinEyes(a=a, b=b):
            yield from (a, b)
        case SlotFaces(eye=eye) | Mark(eye=eye):
            yield eye
        case CamOutline(tip=Eye() as tip):
            yield tip
        case EdgePair():
            yield from (edge.seat for edge in feature.edges if edge.seat is not None)


def _pins_move(part: Part, eyes: Sequence[complex]) -> bool:
    """Whether eyes of a part come to other places where it is turned over about a bore with a flat or a keyway."""
    return any(
        min(abs(complex(flip(np.array(at))) - other) for other in eyes) > _MOVES
        for flip in _flips(_flat_bores(part), np.zeros(0, complex))
        for at in eyes
    )


def _flat_bores(part: Part) -> list[_Hole]:
    """Holes of a part with a flat or a keyway."""
    return [each for each in _holes(part) if each.is_flat]


def _working(feature: Feature) -> Iterator[tuple[str, complex | None]]:
    """Parts whose edges a feature is on, each with the middle of the hole whose edge it is; nan of the largest one."""
    largest = complex(np.nan)
    match feature:
        case CamOutline(part=part, inside=inside):
            yield part, largest if inside else None
        case GearTeeth(a=a, b=b):
            yield from ((each.part, largest if each.inside else None) for each in (a, b))
        case EngagedPair(tracks=PinTracks()):
            return  # a cycloidal disc runs either way up
        case EdgePair():
            yield from ((edge.part, edge.hole) for edge in feature.edges)


def _edge(part: Part, hole: complex | None) -> Contour:
    """The edge that a feature means."""
    if hole is None or not part.region.holes:
        return part.region.outer
    if np.isnan(hole):
        return max(part.region.holes, key=lambda each: abs(each.area))
    return min(part.region.holes, key=lambda each: abs(middle(each) - hole))


def middle(contour: Contour) -> complex:
    """The middle of the area that a contour encloses."""
    z = facet_contour(contour, _FACETS)
    following = np.roll(z, -1)
    parts = z.real * following.imag - following.real * z.imag
    return complex(np.sum((z + following) * parts) / (3 * np.sum(parts)))


def _moves_wrongly(part: Part, edge: Contour) -> bool:
    """Whether it fits turned over in a way in which its edge has another shape."""
    ring = facet_contour(edge, _FACETS)
    return any(
        bool(np.max(point_to_ring(flip(ring), ring)) > _MOVES)
        for flip in _flips(_holes(part, edge), ring)
    )


def _holes(part: Part, edge: Contour | None = None) -> list[_Hole]:
    """Round holes of a part, without one that is its working edge."""
    return [
        _Hole(centre, radius, middle(hole) - centre)
        for hole in part.region.holes
        if hole is not edge
        for centre, radius in discs(hole)
    ]


def _flips(holes: Sequence[_Hole], ring: Points) -> Iterator[_Flip]:
    """The ways to turn a part over in which its holes fit; about one round hole the one that suits the edge best."""
    if not holes:
        return
    first = holes[0]
    flat = next((each for each in holes if each.is_flat), None)
    if flat is not None:
        turns = [_Flip(flat.centre, flat.centre, (flat.leaning / abs(flat.leaning)) ** 2)]
    elif len(holes) == 1:
        turns = [_best(first.centre, ring)]
    else:
        apart = holes[1].centre - first.centre
        turns = [
            _Flip(first.centre, a.centre, (b.centre - a.centre) / np.conj(apart))
            for a in holes
            for b in holes
            if a is not b and abs(abs(b.centre - a.centre) - abs(apart)) < _FITS
        ]
    for flip in turns:
        if all(
            any(
                other.is_at(
                    complex(flip(np.array(each.centre))),
                    flip.turn * np.conj(each.leaning),
                    each.radius,
                )
                for other in holes
            )
            for each in holes
        ):
            yield flip


def _best(centre: complex, ring: Points) -> _Flip:
    """The flip about a round hole in which the image of an edge is most like it, by the distances of its points."""
    z = ring - centre
    angles = np.angle(z)
    sorting = np.argsort(angles)
    even = np.arange(_ANGLES) * (2 * np.pi / _ANGLES)
    radius = np.interp(even, angles[sorting], np.abs(z)[sorting], period=2 * np.pi)
    waves = np.fft.rfft(radius)
    likeness = np.fft.irfft(waves * waves, _ANGLES)  # of r(angle) and r(shift - angle)
    return _Flip(centre, centre, np.exp(1j * even[int(np.argmax(likeness))]))
