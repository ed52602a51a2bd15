"""Pins of a single link, on which a spring pulls or a roller turns: no joint of the model has them, yet they bend.

A spring pulls by its eye, a roller presses in its middle. A spring pulls a roller on its cam,
which pushes it back: of the two that bend one pin, against each other, the worse alone is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from camgen.parts.generator.bodies import Bodies
from camgen.parts.journals import Post
from camgen.parts.part import Role

_STEEL = ("turned", "dowel", "shoulder")
_SAME = 1e-6  # mm


def posts(bodies: Bodies, pulls: Mapping[str, float], printed: str) -> Iterator[Post]:
    """All of them; pulls: greatest pull of each spring of the layout, N; printed: the name of their plastic."""
    layout = bodies.layout
    loads: dict[str, list[tuple[str, float, float]]] = {}
    for name, spring in layout.springs.items():
        for _, point in (spring.a, spring.b):
            loads.setdefault(point, []).append((name, pulls[name], layout.eye(name)[1]))
    for roller in layout.rollers:
        floor = layout.floor(layout.level[roller.level])
        middle = floor + layout.wheel_thickness(roller.wheel.link) / 2
        loads.setdefault(roller.point, []).append((roller.joint, 0.0, middle))
    for point, bent in loads.items():
        if len(layout.pivots.get(point, ())) != 1:
            continue
        body = layout.pressed_in(point)
        low = layout.floor(layout.level[body])
        faces = low, low + layout.thickness(body)
        material = "steel" if layout.kind(point) in _STEEL else printed
        pins = (
            each.part
            for each in bodies.of_role("pin", "crank-pin")
            if each.body == layout.carrier(body) and abs(each.at - layout.at(body, point)) < _SAME
        )
        part = next(pins, "")
        role: Role = next((each.role for each in bodies.parts if each.name == part), "")
        for what, pull, at in bent:
            lever = max(0.0, at - faces[1], faces[0] - at)
            yield Post(point, what, layout.turning(point), lever, material, pull, part, role)
