"""A timing chart: what each segment joins at its ends, and from that its law.

A joint is where one segment ends and the next begins; the first one closes the turn. Its letter (see `tasks`) is the one that a
`task` of either side says; else R beside a dwell, what the values at the joint say, G beside uniform motion, U at a reversal that
a law on either side needs, and R. Velocities and accelerations of joints are those of the spec, per deg.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from camgen.errors import Fault, Key, SpecError, dotted
from camgen.motion.laws import LAWS, Law
from camgen.motion.tasks import (
    CHOICES,
    FAMILIES,
    LETTERS,
    REST,
    End,
    Form,
    PolynomialFamily,
    Trigonometric,
    law_for,
    least,
)

UNIFORM = "uniform"
MATCHED = "matched"
_NEEDS_REVERSAL = {
    name
    for name, family in FAMILIES.items()
    if isinstance(family, Trigonometric) and 0 not in family.reversals
}


@dataclass(frozen=True)
class Rates:
    """Derivatives at a joint, in the spec's unit per deg; None where nothing is said."""

    velocity: float | None = None
    acceleration: float | None = None
    jerk: float | None = None

    @property
    def letter(self) -> str | None:
        """What they make of the joint."""
        if not self.velocity and not self.acceleration:
            return None if self.velocity is None and self.acceleration is None else "R"
        return ("G" if not self.acceleration else "B") if self.velocity else "U"


@dataclass(frozen=True)
class Move:
    """A segment as a spec has it, between known displacements."""

    span: float  # deg
    begin: float
    end: float
    law: str | None  # its name; None: a dwell
    own: Law | None = None  # of a law that is no family's: as it is
    form: Form = Form()
    task: str | None = None
    rates: Rates = Rates()  # at its end

    @property
    def lift(self) -> float:
        """Signed."""
        return self.end - self.begin

    @property
    def chosen(self) -> bool:
        """Whether its law is the least of those that join."""
        return self.law in CHOICES

    @property
    def uniform(self) -> bool:
        """Whether it moves at constant velocity, by its law or as a task that nothing else fixes."""
        return self.law == UNIFORM or (self.chosen and self.task == "GG")

    def serves(self, letter: str, at_end: bool) -> bool:
        """Whether its law can end or begin so."""
        if self.chosen or self.law == MATCHED:
            return True
        family = FAMILIES.get(self.law or "")
        if family is None:
            return letter == ("G" if self.uniform else "R")
        pairs = ((other, letter) if at_end else (letter, other) for other in LETTERS)
        return any(family.serves(*pair) for pair in pairs)


@dataclass(frozen=True)
class Joint:
    """What two segments have in common, per deg; acceleration None: their laws decide."""

    before: str  # letter with which the segment before ends
    after: str  # letter with which the next begins
    velocity: float = 0.0
    acceleration: float | None = 0.0
    jerk: float = 0.0
    decided_by: int | None = None  # segment whose law gives the acceleration


@dataclass(frozen=True)
class Resolved:
    """A segment as it is made: what it joins, its law by name and as it is; law None: matched to its neighbours, or at fault."""

    task: str
    name: str | None = None
    law: Law | None = None
    scale: float = 0.0  # of the law, in the spec's unit: its lift, or of none the greatest rate
    end_acceleration: float | None = None  # at a reversal where it ends, if neither law gives it


@dataclass(frozen=True)
class Chart:
    """Segments round a turn."""

    moves: tuple[Move, ...]
    path: Key  # of the first one's list

    @cached_property
    def resolved(self) -> tuple[list[Resolved], list[Fault]]:
        """What each segment is by its neighbours, and the faults."""
        faults: list[Fault] = []
        joints = [self._joint(k, faults) for k in range(len(self.moves))]
        if not faults:
            joints = [self._with_acceleration(k, joints, faults) for k in range(len(joints))]
        found = []
        for k, move in enumerate(self.moves):
            task = joints[k].after + joints[(k + 1) % len(joints)].before
            try:
                made = self._resolved(k, move, joints) if not faults else Resolved(task)
                found.append(replace(made, end_acceleration=self._open(k, joints)))
            except SpecError as error:
                found.append(Resolved(task))
                faults += [replace(f, path=self._place(k, f.path)) for f in error.faults]
        return found, sorted(faults, key=lambda fault: fault.path[len(self.path)])

    # ---- joints ------------------------------------------------------------------------------------------------------

    def _joint(self, k: int, faults: list[Fault]) -> Joint:
        """The joint before segment k."""
        last = self.moves[k - 1]
        move = self.moves[k]
        row = (k - 1) % len(self.moves)
        typed = (last.task or " ")[-1], (move.task or " ")[0]
        if " " not in typed and typed[0] != typed[1]:
            right = f"a task that begins with {typed[0]}, as the segment before ends"
            faults.append(Fault((*self.path, k, "task"), f"'{move.task}'", right))
        letter = next((x for x in typed if x != " "), None) or self._letter(last, move)
        still = [name for name in (last.law, move.law) if name is None]
        if still and letter != "R":
            at = row if typed[0] != " " else k
            faults.append(Fault((*self.path, at, "task"), "", "R where it joins a dwell"))
        sides = [
            letter if side != " " or each.serves(letter, at_end) else "R"
            for side, each, at_end in zip(typed, (last, move), (True, False), strict=True)
        ]
        rates = self._rates(letter, row, faults)
        if rates.velocity is None and letter == "G":
            uniform = [each.lift / each.span for each in (last, move) if each.uniform]
            if not (uniform or still):
                faults.append(self._speedless(row, k, typed[0] == " "))
            rates = replace(rates, velocity=uniform[0] if uniform else 0.0)
        acceleration = rates.acceleration
        if acceleration is None and letter != "U":
            acceleration = 0.0
        return Joint(sides[0], sides[1], rates.velocity or 0.0, acceleration, rates.jerk or 0.0)

    def _speedless(self, row: int, k: int, begins: bool) -> Fault:
        """Of a joint G with no speed, named where it is typed: where segment k begins, or where the one before it ends."""
        if begins:
            end = dotted((*self.path, row, "end_velocity"))
            right = f"R, or the speed where it begins: {end}"
            return Fault((*self.path, k, "task"), f"'{self.moves[k].task}'", right)
        right = "missing: the velocity of G, as no neighbour is uniform"
        return Fault((*self.path, row, "end_velocity"), "", right)

    def _letter(self, last: Move, move: Move) -> str:
        """Of a joint of which no task says anything."""
        if last.law is None or move.law is None:
            return "R"
        given = last.rates.letter
        if given is not None:
            return given
        if last.uniform or move.uniform:
            return "G"
        turns = last.lift * move.lift < 0
        needed = {last.law, move.law} & _NEEDS_REVERSAL
        return "U" if turns and (needed or (last.chosen and move.chosen)) else "R"

    def _rates(self, letter: str, row: int, faults: list[Fault]) -> Rates:
        """Values given at the end of segment `row`, with what is wrong for the joint's letter."""
        rates = self.moves[row].rates
        wrong = {
            "R": [("end_velocity", rates.velocity), ("end_acceleration", rates.acceleration)],
            "G": [("end_acceleration", rates.acceleration)],
            "U": [("end_velocity", rates.velocity)],
            "B": [],
        }[letter]
        faults += [
            Fault((*self.path, row, key), f"{value:g}", f"no value here: {letter} has 0")
            for key, value in wrong
            if value
        ]
        if letter == "B":
            needed = (("end_velocity", rates.velocity), ("end_acceleration", rates.acceleration))
            faults += [
                Fault((*self.path, row, key), "", "missing: B needs it")
                for key, value in needed
                if value is None
            ]
        return rates

    # ---- accelerations of reversals ------------------------------------------------------------------------------------

    def _with_acceleration(self, k: int, joints: Sequence[Joint], faults: list[Fault]) -> Joint:
        """The joint before segment k, with the acceleration that the laws beside it give.

        A law with a lambda of its own decides; of several that are free the one that is harder at lambda 1/2: the other's lambda
        follows.
        """
        joint = joints[k]
        if joint.acceleration is not None:
            return joint
        n = len(self.moves)
        found = []
        for row, letter, at_end in (((k - 1) % n, joint.before, True), (k, joint.after, False)):
            if letter != "U":
                continue
            try:
                law = self._deciding(row, joints)
            except SpecError:  # told with the segment itself
                return replace(joint, acceleration=0.0)
            if law is None:
                continue
            move = self.moves[row]
            value = float(law(1.0 if at_end else 0.0, 2)) * move.lift / move.span**2
            both = joints[row].after == joints[(row + 1) % n].before == "U"
            set_ = move.form.inflection is not None or move.form.deceleration is not None
            decides = not (both and move.chosen)  # else a polynomial takes both accelerations
            found.append((decides and (set_ or both), abs(value), -row, value, decides))
        if not found:
            row = (k - 1) % n
            if MATCHED not in (self.moves[k - 1].law, self.moves[k].law):
                right = "missing: polynomials leave the acceleration at a reversal open"
                faults.append(Fault((*self.path, row, "end_acceleration"), "", right))
            return replace(joint, acceleration=0.0)
        _, _, row, value, decides = max(found)
        return replace(joint, acceleration=value, decided_by=-row if decides else None)

    def _open(self, k: int, joints: Sequence[Joint]) -> float | None:
        """The acceleration where segment k ends in a reversal, if neither a law nor the spec gives it."""
        end = joints[(k + 1) % len(joints)]
        known = end.decided_by is not None or self.moves[k].rates.acceleration is not None
        return None if known or "U" not in (end.before, end.after) else end.acceleration

    def _deciding(self, row: int, joints: Sequence[Joint]) -> Law | None:
        """The law of a segment that sets its acceleration at a reversal by itself; None for those that take it."""
        move = self.moves[row]
        family = FAMILIES.get(move.law or "")
        if move.law == MATCHED or isinstance(family, PolynomialFamily):
            return None
        return self._resolved(row, move, joints).law

    # ---- laws --------------------------------------------------------------------------------------------------------

    def _ends(self, k: int, joints: Sequence[Joint]) -> tuple[tuple[End, End], float]:
        """What segment k joins, in normal values, and how long a lift these are of."""
        move = self.moves[k]
        start = joints[k]
        end = joints[(k + 1) % len(joints)]
        given = [(start.after, start, k), (end.before, end, k)]
        size = move.lift or max(
            *(abs(joint.velocity) * move.span for _, joint, _ in given),
            *(abs(joint.acceleration or 0.0) * move.span**2 for _, joint, _ in given),
            *(abs(joint.jerk) * move.span**3 for _, joint, _ in given),
        )
        ends = [_end(letter, joint, move.span, size or 1.0, k) for letter, joint, k in given]
        return (ends[0], ends[1]), size or 1.0

    def _resolved(self, k: int, move: Move, joints: Sequence[Joint]) -> Resolved:
        """A segment's law, of a lift of 1; SpecError with the key at fault."""
        (start, end), scale = self._ends(k, joints)
        task = start.letter + end.letter
        if move.law is None:
            return Resolved("RR", None, LAWS[UNIFORM], 0.0)
        if move.law == MATCHED:
            return Resolved(task, MATCHED, None, scale)
        line = move.form.line
        if line is not None and not 0 <= line < 1:
            raise SpecError([Fault(("constant_velocity",), f"{line:g}", "a share >= 0 and < 1")])
        name = move.law
        own = move.own
        if move.chosen:
            alike = move.uniform and start.v == end.v
            name = UNIFORM if alike else least(move.law, start, end, move.form)
            own = LAWS.get(name) if move.form == Form() else None
        if name == UNIFORM and move.task not in (None, "GG"):
            raise SpecError([Fault(("task",), f"'{move.task}'", "GG of a uniform motion")])
        if name == UNIFORM or (own is not None and task == "RR"):
            return Resolved(task, name, own or LAWS[UNIFORM], scale)
        if name not in FAMILIES:
            raise SpecError([Fault(("task",), f"'{task}'", f"RR: '{name}' has no other")])
        law = law_for(name, start, end, move.form, 1.0 if move.lift else 0.0)
        return Resolved(task, name, law, scale)

    def _place(self, k: int, path: Key) -> Key:
        """Of a fault of segment k's law: an acceleration may stand at the segment before."""
        if path != ("end_acceleration",):
            return (*self.path, k, *path)
        move = self.moves[k]
        row = k if move.rates.acceleration is not None else (k - 1) % len(self.moves)
        return (*self.path, row, *path)


def _end(letter: str, joint: Joint, span: float, size: float, k: int) -> End:
    if letter == "R":
        return REST
    a = joint.acceleration
    own = joint.decided_by == k
    return End(
        letter,
        joint.velocity * span / size,
        None if a is None or own else a * span**2 / size,
        joint.jerk * span**3 / size,
    )
