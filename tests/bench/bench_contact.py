"""Prints what contact and reading back cost: cam angles per second against the number of vertices, and STL slicing.

Run from the checkout: python tests/bench/bench_contact.py
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from camgen.files.stl import read_stl, write_stl
from camgen.geometry.mesh import Mesh, mesh_faults, slice_mesh
from camgen.geometry.rings import Ring
from camgen.judge.contact import contact as contact_table
from camgen.judge.contact_tips import ArmTip


def best(work: Callable[[], object], rounds: int = 7) -> float:
    """Least time of some rounds, s."""
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def cam(count: int) -> np.ndarray:
    """A cam-like outline with concave parts, (count,) complex."""
    phi = np.arange(count) / count * 2 * np.pi
    return np.asarray((30 + 8 * np.cos(phi) + 3 * np.sin(3 * phi)) * np.exp(1j * phi))


def contact() -> None:
    """Angles per second, millions."""
    print(
        "millions of angles per second; `touch` with pressure angle and element; `built` 3,600 angles and the table"
    )
    print(f"{'vertices':>9} {'build ms':>9} {'random':>8} {'sorted':>8} {'touch':>8} {'built':>8}")
    theta = np.random.default_rng(1).uniform(0, 2 * np.pi, 10**6)
    ordered, turn = np.sort(theta), theta[:3600]
    for count in (1000, 5000, 10_000, 100_000):
        ring = Ring(cam(count), np.zeros(count))
        setup = (ring, ArmTip(60 + 0j, -60 - 30j, 3.0, 1))
        table = contact_table(*setup)
        build = best(lambda setup=setup: contact_table(*setup))
        rates = [
            len(theta) / best(lambda f=f, t=t: f(t)) / 1e6
            for f, t in ((table.angle, theta), (table.angle, ordered), (table.touch, theta))
        ]
        whole = 3600 / best(lambda setup=setup: contact_table(*setup).angle(turn)) / 1e6
        print(
            f"{count:9} {build * 1e3:9.2f} {rates[0]:8.1f} {rates[1]:8.1f} {rates[2]:8.1f} {whole:8.2f}"
        )


def write_prism(path: Path) -> int:
    """A prism of some 41,000 triangles as STL; their number."""
    count = 10_250
    z = cam(count)
    xy = np.column_stack([z.real, z.imag, np.zeros(count)]).astype(np.float32)
    low, high = np.vstack([xy, [[0, 0, 0]]]), np.vstack([xy, [[0, 0, 0]]]) + np.float32([0, 0, 6])
    vertices = np.vstack([low, high])
    i, j, n = np.arange(count), np.roll(np.arange(count), -1), count + 1
    middle = np.full(count, count)
    faces = np.vstack(
        [
            np.column_stack([i, j, j + n]),
            np.column_stack([i, j + n, i + n]),
            np.column_stack([j, i, middle]),
            np.column_stack([i + n, j + n, middle + n]),
        ]
    )
    write_stl(path, Mesh(vertices.astype(float), faces), "prism")
    return len(faces)


def slicing() -> None:
    """The prism, from the file to rings."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.stl"
        count = write_prism(path)
        mesh = read_stl(path)
        read, cut = best(lambda: read_stl(path)), best(lambda: slice_mesh(mesh, 2.5))
        faults = best(lambda: mesh_faults(mesh))
    print(
        f"{count} triangles: read {read * 1e3:.1f} ms, slice {cut * 1e3:.1f} ms, faults {faults * 1e3:.1f} ms"
    )


if __name__ == "__main__":
    contact()
    slicing()
