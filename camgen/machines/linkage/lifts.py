"""What lifts a pen between the lines that it draws: things that are bought, and how they are put in."""

from __future__ import annotations

from collections.abc import Iterator

from camgen.machine.model import GROUND
from camgen.machines.linkage.figures import LinkageMotion
from camgen.parts.catalogue import Bought


def bought(linkage: LinkageMotion) -> Iterator[Bought]:
    """A pen on a spring for each output that draws lines; where a thread lifts it, that and the sleeve that leads it to the pen."""
    for wanted in linkage.wanted:
        if wanted.lines is None:
            continue
        lines = wanted.lines
        lift = next(each for each in linkage.wanted if each.name == lines.lift)
        course = linkage.course_of(lines.lift)
        ends = sorted((course.extreme(-1)[1], course.extreme(1)[1]), reverse=lines.up < lines.down)
        slack = abs(lines.down - ends[0])
        lifts = f"{abs(ends[1] - lines.down):.3g} {course.unit}"
        place = f"in the hole at {wanted.point}"
        size = f"{place}; a light spring presses it down, {lines.lift} lifts it by {lifts}"
        if lift.thread is not None:
            first, *_, last = lift.thread
            moving = next((p for p in (first, last) if not _stands(linkage, p)), last)
            other = first if moving == last else last
            yield Bought("sleeve", "", f"tube 2 x 1 mm, from post {other} to the pen", 1)
            tie = f"0.5 mm, tied to post {moving}, over post {other}, through the sleeve to the pen"
            free = f"slack by {slack:.3g} mm as the pen is down"
            yield Bought("thread", "", f"{tie}; {free}", 1)
        yield Bought("pen with a spring", "", size, 1)


def _stands(linkage: LinkageMotion, point: str) -> bool:
    """Whether a point is one of the ground."""
    ground = next(each for each in linkage.chain.bodies if each.name == GROUND)
    return point in ground.points
