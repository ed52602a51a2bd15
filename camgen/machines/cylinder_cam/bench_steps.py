"""Steps in which the machine round a drum goes together; heights and places are those of its bench."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from camgen.machine.model import GROUND
from camgen.machines.cylinder_cam.bench import AIR, CAM, END_PLAY, FOOT, Bench
from camgen.machines.cylinder_cam.pieces import GLUED, SEAT
from camgen.numerics import Floats
from camgen.parts.reaming import running, running_size
from camgen.parts.step_words import between, gauge_tools, thickness_gauge
from camgen.parts.steps import COLUMNS
from camgen.study import Doing, Mate, Step, Table

_FIRST = "on the table, its core up"
# What goes on shaft or rods in the machine, where no vice gets in.
_BY_HAND = ("end-plate", "spacer-below", "spacer-above", "drum", "bracket", "crank")
_TELLS = 1.0  # mm, by which a track is nearer to one end than to the other one, so that one sees it
_INWARDS = (-1.0, 0.0, 0.0)  # from the roller's side to the drum


@dataclass(frozen=True)
class _Act:
    """A step of assembly: which part comes where, as the table says it, and what is done.

    apart: what is built beside the machine, its outer side down; joins: what was, and comes too; first: its copies come
    once more; dry: held without glue, however tight it is; follows: in one go with the act before it; wire: of a spring, (n, 3) mm.
    """

    part: str
    place: str
    done: str
    copies: Sequence[str] = ()
    dry: bool = False
    first: bool = False
    apart: str = ""
    joins: str = ""
    follows: bool = False
    wire: Floats | None = None
    glued: Sequence[Mate] = ()  # what is glued in a part that stands
    needs: tuple[str, ...] = ()  # tools

    @property
    def step(self) -> Step:
        """For the pictures."""
        return Step(
            [Doing(self.done, needs=self.needs)],
            self.copies,
            apart=self.apart,
            up=_INWARDS if self.apart not in ("", _beside("drum")) else Step.up,
            joins=self.joins,
            follows=self.follows,
            wire=self.wire,
            glued=self.glued,
            dry=(self.part,) if self.dry else (),
            hand_fits=[(self.part, "")] if self.part in _BY_HAND else (),
        )


def _beside(part: str) -> str:
    """What is built beside the machine, by its first part."""
    return f"{part} beside the machine"


@dataclass(frozen=True)
class BenchSteps:
    """What is done at a bench, one act after the other."""

    bench: Bench

    def table(self) -> Table:
        """In which order it goes together."""
        acts = [
            *self._cleaning_acts(),
            *self._ring_acts(),
            *self._lower_acts(),
            *self._follower_acts(),
            *self._drum_acts(),
            *self._upper_acts(),
            *(self._crank_acts() if self.bench.cranked else ()),
        ]
        rows = [(k, *self._row(act)) for k, act in enumerate(acts, 1)]
        steps = [act.step for act in acts]
        return Table("Assembly of the machine, from the lower plate up", COLUMNS, rows, steps)

    def _row(self, act: _Act) -> tuple[object, ...]:
        """What the table says of a step, but for its number."""
        if act.wire is not None:
            if self.bench.hung is not None:
                return "extension spring", "Extension spring", act.place, 1, "", "on its side"
            spring = "compression spring", "Compression spring"
            return (*spring, act.place, 1, round(self.bench.carriage_rest, 3), "upright")
        part, mounts = next(each for each in self.bench.made if each[0].name == act.part)
        copies = self._copies[act.part]
        own = [
            copy for copy in act.copies if copy in copies
        ] or copies  # all, where they were built
        mount = mounts[copies.index(own[0])]
        level = mount.body in (GROUND, CAM) and not mount.upright
        stands = not act.apart if act.joins else not act.first and act.place != _FIRST
        z: object = round(mount.z, 3) if level and stands else ""
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

    def _cleaning_acts(self) -> Iterator[_Act]:
        """Of a drum as it comes from its printer."""
        track = "wavy end" if self.bench.track.geometry.track == "end" else "track"
        made = "its pieces" if len(self.bench.drum) > 1 else "the drum"
        yield _Act(
            "drum",
            f"clean, its {track} smooth",
            f"break the supports off {made}, and scrape the {track} clean until the roller runs along all of it by hand",
            first=True,
        )

    @property
    def _driven(self) -> bool:
        """Whether the drum's bore turns it, so that it goes on its shaft without glue."""
        return self.bench.sizes.bore_shape != "plain"

    def _ring_acts(self) -> Iterator[_Act]:
        """Of a drum in two pieces: they become one."""
        for ring in self.bench.drum[1:]:
            laid = self._beside("drum", "drum", _FIRST, f"lay it {_FIRST}")
            yield replace(laid, dry=self._driven)
            glued = self._beside(ring.name, "drum", GLUED, f"glue the ring on the drum, {SEAT}")
            yield replace(glued, follows=True)

    def _lower_acts(self) -> Iterator[_Act]:
        """The lower plate with its bearing and the rods."""
        lay = "lay the lower end plate on the table, its seat up"
        yield _Act("end-plate", "seat up", lay, ["end-plate-1"])
        press = "press a ball bearing into its seat, without glue"
        yield _Act("bearing", "pressed into the seat", press, ["bearing-1"], follows=True)
        rods = len(self._copies["rod"])
        yield self._act(
            "rod",
            "glued into the plate, flush below",
            f"glue {rods} × rod upright into the lower end plate, flush with its underside. "
            "The two farther from the bearing are the front rods. Put the upper end plate loosely on their upper ends, dry, until "
            "the glue is hard: it keeps them upright. Then take it off",
        )

    @property
    def _held(self) -> str:
        """The part that holds the roller."""
        return "arm" if self.bench.track.swings else "carriage"

    def _follower_acts(self) -> Iterator[_Act]:
        """What carries the roller, and an arm on its bracket, each built beside the machine."""
        held = self._held
        lying = "on the table, the bore for the pin upright"
        yield self._beside(held, held, lying, f"{self._reamed}lay it {lying}")
        pins = len(self._copies["roller-pin"])
        pin = f"{pins} × roller-pin" if pins > 1 else "roller-pin"
        bore = "its narrower bore" if self.bench.track.swings else "it"
        hook = self.bench.hook
        stands = f"{hook:.3g} mm of it out" if hook else "flush"
        down = (
            f"down to the table, with the {held} on two strips {hook:.3g} mm thick: so much of it stands out below"
            if hook
            else f"down to the table: {stands} below"
        )
        yield self._beside(
            "roller-pin",
            held,
            f"glued into the {held}, {stands} outside",
            f"glue {pin} into {bore} from above, {down}, on its outer side",
        )
        place, said = self._roller_words(pins > 1)
        yield self._beside("roller", held, place, said)
        if not self.bench.track.swings:
            return
        yield self._beside("bracket", "bracket", lying, f"lay it {lying}")
        yield self._beside(
            "pivot",
            "bracket",
            "glued into the bracket, flush outside",
            f"glue the pivot into its {self._pivot_bore}bore from above, down to the table: flush below, on its outer side",
        )
        yield from self._hanging_acts()
        hung = self.bench.hung is not None
        eye = ", the roller-pin through the free eye of the spring" if hung else ""
        on = f"put the arm on the pivot, its roller up{eye}, no glue"
        arm = self._beside("arm", "bracket", f"on its pin{eye}", on)
        yield replace(arm, copies=(), joins=_beside("arm"), dry=True)
        yield self._beside(
            "cap",
            "bracket",
            "glued on the pin, flush with its end, the arm free",
            "glue the cap on the pivot, flush with its upper end; the arm must turn freely",
        )

    @property
    def _reamed(self) -> str:
        """What is done first with the bores of a carriage; "" of an arm, which has none."""
        if self.bench.track.swings:
            return ""
        size = running_size(self.bench.sizes.rod_diameter, self.bench.fits.slide)
        return f"open its two bores to {running(size)}: it must slide on the rods by its own weight. Then "

    def _beside(self, part: str, built: str, place: str, done: str) -> _Act:
        """A step in which all copies of a part come, of what is built beside the machine; built: by the name of its first part."""
        return replace(self._act(part, place, done), apart=_beside(built))

    def _roller_words(self, several: bool) -> tuple[str, str]:
        """Where the roller goes on its pin, and what is done."""
        roller = "a roller on each pin" if several else "the roller on its pin"
        over = self.bench.pin_below
        if next(part for part, _ in self.bench.made if part.name == "roller").process == "bought":
            place = f"glued on its pin, its inner end {over:.3g} mm over the pin's"
            return place, (
                f"put a drop of retaining glue or superglue on the pin, and push {roller.replace(' on ', ', a ball bearing, on ', 1)}. Only its "
                f"inner ring gets glue. Its upper end stands {over:.3g} mm over the pin's"
            )
        place = f"on its pin, its inner end {over:.3g} mm over the pin's"
        return place, (
            f"put {roller}, its narrow collar down, no glue: it must turn freely. Its upper end stands {over:.3g} mm over "
            "the pin's; the drum keeps it there later"
        )

    @property
    def _pivot_bore(self) -> str:
        """Which of a bracket's bores is the pivot's; "" where there is no other one."""
        return "" if self.bench.hung is None else "upper "

    def _hanging_acts(self) -> Iterator[_Act]:
        """Of a spring that pulls the arm: its pin, what keeps the arm off the bracket, and the spring."""
        if self.bench.hung is None:
            return
        yield self._beside(
            "spring-pin",
            "bracket",
            "glued into the bracket, flush outside",
            "glue the spring-pin into its lower bore from above, down to the table",
        )
        yield self._beside(
            "sleeve",
            "bracket",
            "glued on the pivot, down on the bracket",
            "glue the sleeve on the pivot, down on the bracket",
        )
        where = "one eye on the spring-pin"
        (wire,) = self.bench.wires()
        said = f"put the extension spring with {where}"
        yield _Act("spring", where, said, wire=wire, apart=_beside("bracket"))

    def _drum_acts(self) -> Iterator[_Act]:
        """The shaft, and on it the drum, which takes the follower along."""
        shaft = self._act(
            "shaft",
            "upright in the bearing",
            f"lay {thickness_gauge(FOOT)}, {FOOT:g} mm in all, under the bearing's bore. Stand the shaft upright in the "
            f"bearing, down on the paper. Leave the paper there until the {self._last} is on and the glue is hard",
        )
        yield replace(shaft, needs=gauge_tools(FOOT))
        spacer = self._act(
            "spacer-below",
            "glued on the shaft over the bearing",
            f"glue spacer-below on the shaft, {END_PLAY:g} mm over the bearing{between(END_PLAY)}",
        )
        yield replace(spacer, needs=gauge_tools(END_PLAY))
        track = "on the drum's end" if self.bench.track.geometry.track == "end" else "in the track"
        end = "bracket" if self.bench.track.swings else self._held
        into = f"the roller {track} and the bores of the {end} on the two front rods"
        driver = {"plain": "glue", "d-flat": "flat", "keyway": "key"}[self.bench.sizes.bore_shape]
        fixed = "glue in its bore" if driver == "glue" else f"no glue, the {driver} drives it"
        lift = ""
        if self.bench.hung is not None:
            lift = ", the arm lifted against its spring"
            into += lift
        pieces = () if len(self.bench.drum) > 1 else self._copies["drum"]  # that are not there yet
        yield _Act(
            "drum",
            f"with the roller {track}{lift}",
            f"hold it, {self._end_up}, and set the roller {track}{lift}",
            pieces,
            dry=self._driven,
            first=True,
            apart=_beside("drum"),
            joins=_beside(end),
        )
        yield _Act(
            "drum",
            f"lowered over the shaft together with the {end}, {into}",
            f"lower the drum and the {end} at once: the drum over the shaft ({fixed}), down on spacer-below, and the bores of the "
            f"{end} over the two front rods{self._bracket_high}",
            first=True,
            dry=self._driven,
            joins=_beside("drum"),
            glued=self._glued_bracket,
        )

    @property
    def _glued_bracket(self) -> list[Mate]:
        """Where a bracket is glued on the front rods; nothing of a carriage."""
        bench = self.bench
        if not bench.track.swings:
            return []
        middle = bench.base + bench.track.height
        return [
            Mate(
                "glue", "", (at.real, at.imag, middle), bench.sizes.rod_diameter, bench.block_height
            )
            for at in bench.rods[:2]
        ]

    @property
    def _end_up(self) -> str:
        """Which end of the drum is up, and how one sees it."""
        bench = self.bench
        geometry = bench.track.geometry
        if geometry.track == "end":
            return "its wavy end up"
        if len(bench.drum) > 1:
            return "its ring up"
        said = "the end up that was up as it was printed"
        if bench.sizes.bore_shape == "plain":
            return said
        flat = bench.track.height + float(bench.track.program(np.array([1.5 * math.pi]))[0])
        if abs(2 * flat - bench.track.length) < 2 * _TELLS:
            return said
        where = {"d-flat": "flat", "keyway": "keyway"}[bench.sizes.bore_shape]
        return f"{said}: in line with the bore's {where} the middle of its {geometry.track} is {flat:.3g} mm from the lower end"

    @property
    def _bracket_high(self) -> str:
        """How high a bracket is glued on its rods; "" of a carriage, which runs on them."""
        bench = self.bench
        if not bench.track.swings:
            return "; the carriage must slide on them freely"
        deepest = min(at.imag for at in bench.bracket_pins) - bench.pin / 2 - bench.sizes.wall
        under = min(-bench.block_height / 2, deepest)
        over = bench.base + bench.track.height + under - bench.plate_thickness
        return f"; glue the bracket on them, its underside {over:.4g} mm over the lower end plate"

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
            f"lower the upper end plate, seat down, over the bearing and all {rods} rods at once; glue it on the rods, flush above{pressing}. "
            f"The shaft must turn freely: {END_PLAY:g} mm of play along it remains",
            ["end-plate-2"],
        )

    @property
    def _last(self) -> str:
        """The part that comes last on the shaft."""
        return "crank" if self.bench.cranked else "upper end plate"

    def _crank_acts(self) -> Iterator[_Act]:
        """The crank that a hand turns."""
        flush = "flush with its upper end"
        said = f"glue the hand crank on the shaft, {flush}: it is {AIR:.3g} mm over the upper end plate"
        yield self._act("crank", f"glued on the shaft, {flush}", said)
        over = "over the outer hole of the crank"
        yield self._act("knob", over, f"put the knob {over}, no glue", dry=True)
        said = "put the pin through the knob and glue it into the crank alone, flush with its underside: the knob turns. "
        said += "When the glue is hard, take the paper from under the shaft. Then turn the crank once round, slowly: nothing may be stiff"
        pin = self._act("knob-pin", "through the knob, glued into the crank", said)
        yield replace(pin, follows=True)

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
