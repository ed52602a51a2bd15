"""The springs of a layout as coils on its pins."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from camgen.machine.features import Mount
from camgen.machine.model import Place
from camgen.parts.coils import Coil
from camgen.parts.generator.layout import Layout
from camgen.parts.generator.sizes import HOOK_ROOM
from camgen.parts.part import Part
from camgen.tolerances import SAME_POINT


def coils_of(
    layout: Layout,
    parts: Sequence[Part],
    mounts: Sequence[Mount],
    ways: Mapping[str, tuple[float, float]] = MappingProxyType({}),
) -> list[Coil]:
    """Coils from below; ways: shortest and longest, inside their eyes, mm, of those that the sweep sees."""
    coils = []
    for name, spring in sorted(layout.springs.items(), key=lambda each: layout.level[each[0]]):
        title = "Extension spring" if name == "spring" else f"Extension spring {name}"
        _, one = spring.a
        _, other = spring.b
        heads = [list(_heads(layout, parts, mounts, point)) for point in (one, other)]
        ends = (_end(layout, *spring.a), _end(layout, *spring.b))
        reach = _reach(layout, name, *ways[name]) if name in ways else None
        coils.append(
            Coil(
                name,
                title,
                ends,
                (one, other),
                spring.diameter,
                layout.eye(name),
                (tuple(copy for copy, _ in heads[0]), tuple(copy for copy, _ in heads[1])),
                any(cap for each in heads for _, cap in each),
                reach,
            )
        )
    return coils


def _end(layout: Layout, link: str, point: str) -> Place:
    """A point of a link on the body that carries it."""
    return Place(layout.carrier(link), layout.at(link, point))


def _reach(layout: Layout, name: str, shortest: float, longest: float) -> tuple[float, float]:
    """From beside the wider head over its eyes to its middle where it is longest, mm from either pin."""
    spring = layout.springs[name]
    pin = layout.sizes.pin_diameter
    head = max(layout.head_radius(point) for _, point in (spring.a, spring.b))
    start = head + HOOK_ROOM + spring.diameter / 2
    return start, min((longest - pin) / 2, shortest - pin - start)


def _heads(
    layout: Layout, parts: Sequence[Part], mounts: Sequence[Mount], point: str
) -> Iterator[tuple[str, bool]]:
    """Copies of a pin with a head on top, or of caps, at a point, and whether each is a cap."""
    link = layout.pressed_in(point)
    body = layout.carrier(link)
    place = layout.at(link, point)
    roles = {part.name: part.role for part in parts}
    number = Counter[str]()
    for mount in mounts:
        number[mount.part] += 1
        role = roles[mount.part]
        head = role == "cap" or (role == "pin" and mount.flipped)
        if head and mount.body == body and abs(mount.at - place) < SAME_POINT:
            yield f"{mount.part}-{number[mount.part]}", role == "cap"
