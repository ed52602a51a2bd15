"""Why the crank of a four-bar does not turn fully, and the longest that would, by Grashof."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from camgen.errors import listed
from camgen.machine.closed_form import four_bar
from camgen.machine.model import GROUND, Joint, Machine, Pin, bodies_of


def four_bar_lengths(machine: Machine, crank: str) -> dict[str, float] | None:
    """Lengths, mm, of frame, crank, coupler and output, in this order by their links, of a four-bar that is driven at a
    ground pivot; None of another machine."""
    return _four_bar(machine.joints, crank)


def _four_bar(joints: Sequence[Joint], crank: str) -> dict[str, float] | None:
    """The same of these joints and the bodies that they hold."""
    pins = [joint for joint in joints if isinstance(joint, Pin)]
    ground = [pin for pin in pins if GROUND in (pin.a.body, pin.b.body)]
    moving = dict.fromkeys(body for pin in pins for body in bodies_of(pin) if body != GROUND)
    if not len(joints) == len(pins) == 4 or len(moving) != 3 or len(ground) != 2:
        return None
    lengths: dict[str, float] = {}
    for body in (GROUND, *moving):
        places = [place.at for pin in pins for place in (pin.a, pin.b) if place.body == body]
        if len(places) != 2:
            return None
        lengths[body] = abs(places[1] - places[0])
    output = [
        place.body
        for pin in ground
        for place in (pin.a, pin.b)
        if place.body not in (GROUND, crank)
    ]
    if len(output) != 1:
        return None
    (coupler,) = set(lengths) - {GROUND, crank, output[0]}
    return {name: lengths[name] for name in (GROUND, crank, coupler, output[0])}


def crank_limits(machine: Machine, ends: Iterable[tuple[str, ...]], crank: str) -> str:
    """Why the crank of the first four-bar that opens does not turn fully, and the longest that would; empty where none opens.

    ends: names of the joints that open together, of each place.
    """
    for names in ends:
        bodies = {body for name in names for body in bodies_of(machine.joint(name))}
        bodies |= {crank, GROUND}
        loop = [joint for joint in machine.joints if bodies.issuperset(bodies_of(joint))]
        lengths = _four_bar(loop, crank)
        if lengths is not None and (said := _grashof(lengths, crank)):
            whole = len(loop) == len(machine.joints)
            where = "" if whole else f" in the loop of {listed('link', list(lengths)[1:])}"
            return f": by Grashof's rule{where} {said}"
    return ""


def _grashof(lengths: dict[str, float], crank: str) -> str:
    """Why a four-bar's crank does not turn fully, and the longest that would; "" where it does."""
    bar = four_bar(*lengths.values())
    shortest, *_, longest = sorted(lengths, key=lambda name: lengths[name])
    short = f"{shortest} ({lengths[shortest]:.6g} mm)"
    long = f"{longest} ({lengths[longest]:.6g} mm)"
    most = lengths[crank] + bar.slack
    cure = (
        f"; {crank} turns fully if it is shorter than {most:.6g} mm"
        if lengths[crank] < lengths[GROUND] and most > 0
        else ""
    )
    if bar.margin < 0:
        ends = f"the shortest, {short}, and the longest, {long}"
        return f"{ends}, are together {-bar.margin:.4g} mm longer than the other two{cure}"
    if shortest == crank:
        return ""
    return f"only the shortest link turns fully, and that is {short}, not {crank}{cure}"
