"""Swept interference of a ten-body machine, and of the take-up without a word about what touches: processor time, printed."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

from camgen.geometry.rings import Points, Ring
from camgen.judge.interference import interference, sweep_clearances
from camgen.judge.slabs import Body, Slab, slabs_of
from camgen.parts.solids import solid
from camgen.pipeline import build as pipeline

SWING = 0.26
PIVOT = 60 + 0j
ARM = -60 - 30j


def ring(z: Points) -> Ring:
    return Ring(np.asarray(z, complex), np.zeros(len(z)))


def disc(centre: complex, radius: float, n: int = 400) -> Ring:
    return ring(centre + radius * np.exp(2j * np.pi * np.arange(n) / n))


def around(spine: list[complex], half: float, n: int = 400) -> Ring:
    """Outline at `half` mm round a chain of points, resampled to n points."""
    import shapely

    line = shapely.LineString([(z.real, z.imag) for z in spine]).buffer(half).exterior
    points = shapely.line_interpolate_point(line, np.arange(n) / n, normalized=True)
    return ring(shapely.get_coordinates(points) @ np.array([1, 1j]))


def machine() -> tuple[list[Body], dict[frozenset[str], float]]:
    """Eccentric cam pair on a shaft, two frames swinging with the tips on them, axles in a base with an arc slot, pins."""
    e, r, tip = 8.0, 22.0, 2.5

    def angle(theta: np.ndarray) -> np.ndarray:
        """Tip centre on the circle of radius r + tip about the eccentric's centre: closed form of a triangle."""
        to = e * np.exp(1j * theta) - PIVOT
        reach, arm = np.abs(to), abs(ARM)
        cosine = (reach**2 + arm**2 - (r + tip) ** 2) / (2 * reach * arm)
        return np.angle(to) + np.arccos(cosine) - np.angle(ARM)

    start = float(angle(np.zeros(1))[0])

    def spin(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return theta, np.zeros(theta.shape, complex)

    def swing(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return start + np.angle(np.exp(1j * (angle(theta) - start))), np.full(theta.shape, PIVOT)

    def slab(*rings: Ring, thick: float = 6.0) -> tuple[Slab, ...]:
        return (Slab(0.0, thick, rings),)

    far = 40 + 0j
    mid = np.unwrap(angle(np.linspace(0, 2 * np.pi, 200_001)))
    way = np.linspace(mid.min() - 0.085, mid.max() + 0.085, 200)
    slot = PIVOT + np.concatenate([43.2 * np.exp(1j * way), 36.8 * np.exp(1j * way[::-1])])
    axles = disc(0, 3), disc(far, 3)
    arm = around([ARM, ARM - 25j, 1j * ARM.imag - 25j], 2.45)
    bodies = [
        Body(
            "base", slab(around([-40, 110], 60.0), disc(0, 5), disc(PIVOT, 3.1), ring(slot)), z=-6
        ),
        Body("cam 1", slab(disc(e, r), disc(0, 4), disc(14, 1.5)), spin),
        Body("cam 2", slab(disc(e, r), disc(0, 4), disc(14, 1.5)), spin, z=6.2),
        Body("cam pin", slab(disc(14, 1.5), thick=12), spin),
        Body("shaft", slab(disc(0, 3.98), thick=30), spin, z=-12),
        Body("arm", slab(arm), swing),
        Body("tip", slab(disc(ARM, tip)), swing, z=6.2),
        Body("frame", slab(around([far, 0, 1j * ARM.imag], 5.0), *axles), swing, z=12.4),
        Body("axle", slab(disc(0, 3), thick=20), swing, z=-7),
        Body("slide axle", slab(disc(far, 3), thick=20), swing, z=-7),
    ]
    pairs = [("cam 1", "arm"), ("cam 2", "tip"), ("frame", "axle"), ("frame", "slide axle")]
    pairs += [(other, cam) for other in ("cam pin", "shaft") for cam in ("cam 1", "cam 2")]
    return bodies, {frozenset(pair): 0.02 for pair in pairs}


def take_up() -> tuple[float, list[Body]]:
    """The gap that the thread take-up keeps, and its bodies as designed, on courses from poses alone."""
    mechanism = pipeline.read_mechanism(
        Path(__file__).resolve().parents[2] / "specs" / "thread-take-up.toml"
    )
    start, bodies = mechanism.assembly.poses(np.zeros(1)), []
    for part in mechanism.assembly.parts:
        mesh = solid(part, mechanism.accuracy.chord_tolerance)
        for k, pose in enumerate(start[part.name]):

            def course(
                theta: np.ndarray, name: str = part.name, k: int = k
            ) -> tuple[np.ndarray, np.ndarray]:
                found = mechanism.assembly.poses(theta)[name][k]
                return found.angle, found.place

            slabs = slabs_of(mesh)
            bodies.append(Body(f"{part.name}-{k + 1}", slabs, course, pose.z, pose.flipped))
    return mechanism.assembly.process.gap, bodies


def main() -> None:
    """Print a line for each pair and the time of all."""
    bodies, contacts = machine()
    gap, more = take_up()
    for title, these, touching, needed in (
        ("swing", bodies, contacts, 0.05),
        ("take-up", more, {}, gap),
    ):
        began = time.process_time()
        found = sweep_clearances(these, touching, needed)
        spent = time.process_time() - began
        for c in found:
            print(
                f"{c.a:14} {c.b:14} gap {c.gap:9.4f}  proven {c.proven:9.4f} mm  {c.evaluations:6} evaluations"
            )
        if touching:
            print(*interference(found, needed), sep="\n")
        print(
            f"{title}: {len(these)} bodies, {len(found)} pairs with heights in common: {spent:.2f} s of processor time\n"
        )


if __name__ == "__main__":
    main()
