"""Steps in which the machine round a drum goes together; heights and places are those of its bench."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from camgen.machine.model import GROUND
from camgen.machines.cylinder_cam.bench import CAM, END_PLAY, FOOT, Bench
from camgen.machines.cylinder_cam.pieces import SEAT
from camgen.numerics import Floats
from camgen.parts.steps import COLUMNS, paper
from camgen.study import Doing, Step, Table

_FIRST = "on the table, its key up"
_ASIDE = "on the table beside the machine; step {step} puts it in"


@dataclass(frozen=True)
class _Act:
    """A step of assembly: which part comes where, as the table says it, and what is done.

    aside: laid down beside the machine at first; dry: held without glue, however tight it is; wire: of a spring, (n, 3) mm.
    """

    part: str
    place: str
    done: str
    copies: Sequence[str] = ()
    dry: bool = False
    aside: bool = False
    wire: Floats | None = None

    def with_step(self, number: int) -> _Act:
        """The same with the number of the step that takes along what lies beside the machine."""
        place = self.place.format(step=number)
        return replace(self, place=place, done=self.done.format(step=number))


@dataclass(frozen=True)
class BenchSteps:
    """What is done at a bench, one act after the other."""

    bench: Bench

    def table(self) -> Table:
        """In which order it goes together."""
        acts = [
            *self._ring_acts(),
            *self._lower_acts(),
            *self._follower_acts(),
            *self._drum_acts(),
            *self._upper_acts(),
            *(self._crank_acts() if self.bench.cranked else ()),
        ]
        taken = max(k for k, act in enumerate(acts, 1) if act.part == "drum")
        numbered = [act.with_step(taken) for act in acts]
        rows = [(k, *self._row(act)) for k, act in enumerate(numbered, 1)]
        steps = [
            Step([Doing(act.done)], act.copies, wire=act.wire, dry=act.dry) for act in numbered
        ]
        return Table("Assembly of the machine, from the lower plate up", COLUMNS, rows, steps)

    def _row(self, act: _Act) -> tuple[object, ...]:
        """What the table says of a step, but for its number."""
        if act.wire is not None:
            if self.bench.hung is not None:
                return "extension spring", "Extension spring", act.place, 1, "", "on its side"
            spring = "compression spring", "Compression spring"
            return (*spring, act.place, 1, round(self.bench.carriage_rest, 3), "upright")
        part, mounts = next(each for each in self.bench.made if each[0].name == act.part)
        own = [copy for copy in act.copies if copy in self._copies[act.part]]
        mount = mounts[self._copies[act.part].index(own[0])]
        level = mount.body in (GROUND, CAM) and not mount.upright
        z: object = round(mount.z, 3) if level and not act.aside else ""
        lies = ("turned over" if mount.flipped else "as drawn") if level else "on its side"
        return act.part, part.title, act.place, len(own), z, lies

    @cached_property
    def _copies(self) -> dict[str, list[str]]:
        """Names of each part's copies."""
        return {
            part.name: [f"{part.name}-{k}" for k in range(1, len(mounts) + 1)]
            for part, mounts in self.bench.made
        }

    def _act(self, part: str, place: str, done: str, dry: bool = False) -> _Act:
        """A step in which all copies of a part come."""
        return _Act(part, place, done, self._copies[part], dry)

    def _laid_aside(self, part: str) -> _Act:
        """A step in which what the drum takes along later is laid beside the machine."""
        return _Act(part, _ASIDE, f"lay the {part} {_ASIDE}", self._copies[part], aside=True)

    def _ring_acts(self) -> Iterator[_Act]:
        """Of a drum in two pieces: they become one."""
        on = SEAT.removesuffix(", glued")
        for ring in self.bench.drum[1:]:
            yield _Act("drum", _FIRST, f"lay the drum {_FIRST}", self._copies["drum"], aside=True)
            yield self._act(ring.name, SEAT, f"glue the ring on the drum, {on}")

    def _lower_acts(self) -> Iterator[_Act]:
        """The lower plate with its bearing and the rods."""
        lay = "lay the lower end plate on the table, its seat up"
        yield _Act("end-plate", "seat up", lay, ["end-plate-1"])
        press = "press a ball bearing into its seat, without glue"
        yield _Act("bearing", "pressed into the seat", press, ["bearing-1"])
        rods = len(self._copies["rod"])
        yield self._act(
            "rod",
            "glued into the plate, flush below",
            f"glue {rods} × rod upright into the lower end plate, flush with its underside",
        )

    @property
    def _held(self) -> str:
        """The part that holds the roller."""
        return "arm" if self.bench.track.swings else "carriage"

    def _follower_acts(self) -> Iterator[_Act]:
        """What carries the roller, and an arm on its bracket, beside the machine."""
        pins = len(self._copies["roller-pin"])
        pin = f"{pins} × roller-pin" if pins > 1 else "roller-pin"
        roller = "a roller on each pin" if pins > 1 else "the roller on its pin"
        yield self._laid_aside(self._held)
        flush, where = "flush outside", "flush with its outer side"
        if self.bench.hung is not None:
            flush = where = f"{self.bench.hook:.3g} mm of it out of its outer side"
        yield self._act(
            "roller-pin",
            f"glued into the {self._held}, {flush}",
            f"glue {pin} into the {self._held}, {where}",
        )
        yield self._act(
            "roller",
            "on its pin, its inner end a little over the pin's",
            f"put {roller}: its inner end stands a little over the pin's",
        )
        if not self.bench.track.swings:
            return
        yield self._laid_aside("bracket")
        yield self._act(
            "pivot",
            "glued into the bracket, flush outside",
            "glue the pivot into the bracket, flush with its outer side",
        )
        yield from self._hanging_acts()
        eye = (
            "" if self.bench.hung is None else ", the roller-pin through the free eye of the spring"
        )
        put = f"put the arm on the pivot{eye}, no glue"
        yield self._act("arm", f"on its pin{eye}", put, dry=True)
        yield self._act(
            "cap",
            "glued on the pin, the arm free",
            "glue the cap on the pivot; the arm must turn freely",
        )

    def _hanging_acts(self) -> Iterator[_Act]:
        """Of a spring that pulls the arm: its pin, what keeps the arm off the bracket, and the spring."""
        if self.bench.hung is None:
            return
        yield self._act(
            "spring-pin",
            "glued into the bracket, flush outside",
            "glue the spring-pin into the bracket, flush with its outer side",
        )
        yield self._act(
            "sleeve",
            "glued on the pivot, down on the bracket",
            "glue the sleeve on the pivot, down on the bracket",
        )
        where = "one eye on the spring-pin"
        (wire,) = self.bench.wires()
        yield _Act("spring", where, f"put the extension spring with {where}", wire=wire)

    def _drum_acts(self) -> Iterator[_Act]:
        """The shaft, and on it the drum, which takes the follower along."""
        below = self.bench.plate_thickness - self.bench.bearing.width - FOOT
        yield self._act(
            "shaft",
            "upright in the bearing",
            f"stand the shaft upright in the bearing: it stands out by {below:.3g} mm below that, its lower end {FOOT:g} mm over the table; put a strip that thick under it",
        )
        yield self._act(
            "spacer-below",
            "glued on the shaft over the bearing",
            f"glue spacer-below on the shaft, {END_PLAY:g} mm over the bearing{paper(END_PLAY)}",
        )
        track = "on the drum's end" if self.bench.track.geometry.track == "end" else "in the track"
        bored = "bracket" if self.bench.track.swings else "bores of the carriage"
        into = f"the roller {track} and the {bored} on the two front rods"
        driver = {"plain": "glue", "d-flat": "flat", "keyway": "key"}[self.bench.sizes.bore_shape]
        fixed = "glue in its bore" if driver == "glue" else f"no glue, the {driver} drives it"
        end = "bracket" if self.bench.track.swings else self._held
        if self.bench.hung is not None:
            into += "; lift the arm against its spring till the roller stands there"
        yield _Act(
            "drum",
            f"lowered over the shaft together with the {self._held}, {into}",
            f"lower the drum over the shaft ({fixed}), down on spacer-below, together with the {end}: both at once, {into}",
            [
                *(name for part in self.bench.drum for name in self._copies[part.name]),
                *self._copies[end],
            ],
            dry=driver != "glue",
        )

    def _upper_acts(self) -> Iterator[_Act]:
        """Springs, and the upper plate with its bearing."""
        wires = self.bench.wires() if self._springs_places else []
        for where, wire in zip(self._springs_places, wires, strict=True):
            yield _Act("spring", where, f"put a compression spring {where}", wire=wire)
        yield self._act(
            "spacer-above",
            "on the shaft",
            "put spacer-above on the shaft, down on the drum, no glue",
            dry=True,
        )
        other = "put the other ball bearing on the shaft, no glue"
        yield _Act("bearing", "on the shaft", other, ["bearing-2"])
        rods = len(self._copies["rod"])
        pressing = f"; {self._pressed}" if self._springs_places else ""
        yield _Act(
            "end-plate",
            f"seat down, over bearing and rods at once, glued on the rods, flush above{pressing}",
            f"lower the upper end plate, seat down, over the bearing and all {rods} rods at once; glue it on the rods, flush above{pressing}",
            ["end-plate-2"],
        )

    def _crank_acts(self) -> Iterator[_Act]:
        """The crank that a hand turns."""
        yield self._act("crank", "glued on the shaft", "glue the hand crank on the shaft")
        yield self._act("knob", "glued into the crank", "glue the knob into the crank")

    @property
    def _springs_places(self) -> list[str]:
        """Where both go; nothing without them."""
        if self.bench.spring is None or self.bench.hung is not None:
            return []
        free = self.bench.spring.spring.free
        return [
            f"round {rod}, down on the carriage, {free:.4g} mm long as it is"
            for rod in ("a front rod", "the other front rod")
        ]

    @property
    def _pressed(self) -> str:
        """How the upper plate is put on against both springs."""
        assert self.bench.spring is not None, "nothing presses the carriage"
        length = self.bench.ceiling - self.bench.carriage_rest
        force = 2 * self.bench.spring.spring.force(length)
        return f"it presses both springs to {length:.4g} mm with {force:.3g} N: hold it until the glue holds"
