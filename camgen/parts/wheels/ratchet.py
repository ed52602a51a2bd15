"""Ratchets: a wheel whose teeth a pawl lets pass one way, and locks the other.

face        of a tooth: what the pawl's end stands against; it leans over by `lean`, so that its push draws the pawl in
back        straight from the tip to the next root: it lifts the pawl
drawn in    by the face alone, without a spring: where its normal passes the pawl's pivot on the wheel's side by more than
            the friction angle
seat        where the pawl's end lies in a root, against face and back: there the wheel locks when it is turned back
drop        fall of the pawl as a tip leaves its end: the tip, the end's middle and the pivot are then on one line
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from camgen.errors import DesignError
from camgen.geometry.outlines import Arc, Contour, Line, polygon
from camgen.numerics import Floats, Points

_FALLS = 0.2  # share of the arm: with a shorter lever at a tip the pawl falls freely
_TOUCH = 1e-9  # rad or mm, by which a contact may lie beyond its edge's end
_SAMPLES = 360  # of a tooth, at which the pawl is looked at


@dataclass(frozen=True)
class RatchetWheel:
    """A wheel that turns counter-clockwise past its pawl; the tip of a tooth lies on Ox."""

    teeth: int
    tip: float  # radius, mm
    root: float  # radius, mm
    lean: float = 0.0  # of a face from the radius through its tip, rad, the root under the tooth

    def __post_init__(self) -> None:
        if self.teeth < 3:
            raise DesignError("teeth of a ratchet", self.teeth, 3, "", "", "use more teeth")
        if not 0 < self.root < self.tip:
            raise DesignError("radius of the roots", self.root, self.tip, "mm", "", "make it less")
        if not self.top < self.pitch:
            raise DesignError(
                "angle that a leaning face takes",
                math.degrees(self.top),
                math.degrees(self.pitch),
                "deg",
                "",
                "lean it less, or use fewer teeth",
            )

    @property
    def pitch(self) -> float:
        """From tooth to tooth, rad."""
        return math.tau / self.teeth

    @property
    def top(self) -> float:
        """Angle about the axis from a face's root to its tip, rad."""
        return self.lean_at_root - self.lean

    @property
    def lean_at_root(self) -> float:
        """Of a face from the radius through its root, rad."""
        sine = self.tip * math.sin(self.lean) / self.root
        if not abs(sine) < 1:
            raise DesignError(
                "lean of a face",
                math.degrees(self.lean),
                math.degrees(math.asin(self.root / self.tip)),
                "deg",
                "",
                "lean it less",
            )
        return math.asin(sine)

    def outline(self) -> Contour:
        """The edge, counter-clockwise: tip, back to the next root, face out to the next tip."""
        points = []
        for k in range(self.teeth):
            middle = k * self.pitch
            root = middle + self.pitch + self.top
            points += [cmath.rect(self.tip, middle), cmath.rect(self.root, root)]
        return polygon(points)


@dataclass(frozen=True)
class Pawl:
    """A pawl with a round end that swings about a pivot beside the wheel; places about the wheel's axis, mm."""

    wheel: RatchetWheel
    pivot: complex
    end: float  # radius of its end

    @property
    def seat(self) -> complex:
        """Middle of its end where it rests in the root before the face of the tooth on Ox, mm."""
        root = cmath.rect(self.wheel.root, self.wheel.top)
        face = (self.wheel.tip - root) / abs(self.wheel.tip - root)
        behind = cmath.rect(self.wheel.tip, -self.wheel.pitch) - root
        back = behind / abs(behind)
        half = abs(cmath.phase(back / face)) / 2
        return root + self.end / math.sin(half) * (face + back) / abs(face + back)

    @property
    def push(self) -> complex:
        """Direction of the face's push on the end, unit complex."""
        root = cmath.rect(self.wheel.root, self.wheel.top)
        face = (self.wheel.tip - root) / abs(self.wheel.tip - root)
        return -1j * face

    @property
    def held(self) -> complex:
        """Where the face touches its end in the seat, mm."""
        return self.seat - self.end * self.push

    @property
    def arm(self) -> complex:
        """From the pivot to the middle of its end, in the seat, mm."""
        return self.seat - self.pivot

    @cached_property
    def dropping(self) -> float:
        """Angle of the wheel, from the seat, at which the tip of the tooth on Ox leaves the end: what is lost turning back, rad."""
        far = abs(self.pivot)
        reach = abs(self.arm) + self.end
        tip = self.wheel.tip
        cosine = (tip**2 + far**2 - reach**2) / (2 * tip * far)
        return cmath.phase(self.pivot) + math.acos(cosine)

    @cached_property
    def drop(self) -> float:
        """Angle of the pawl by which it falls there, rad."""
        theta = np.array([self.dropping])
        return float(self.lift(theta + _TOUCH)[0] - self.lift(theta - _TOUCH)[0])

    @cached_property
    def _edges(self) -> tuple[Points, Floats, Points, Floats]:
        """Normals of backs and faces, how far these are from the axis, their first points, and their lengths."""
        k = np.arange(self.wheel.teeth)
        tips = self.wheel.tip * np.exp(1j * k * self.wheel.pitch)
        roots = self.wheel.root * np.exp(1j * ((k + 1) * self.wheel.pitch + self.wheel.top))
        starts = np.concatenate([tips, roots])
        along = np.concatenate([roots, np.roll(tips, -1)]) - starts
        normals = -1j * along / np.abs(along)
        return normals, np.real(np.conj(normals) * starts), starts, np.abs(along)

    def _touches(self, theta: Floats) -> Points:
        """Direction from the pivot to the end's middle where each edge and each tip would stop it, (m, n) rad; nan where none is.

        Edges: the end is its radius off the line. Tips: the triangle of pivot, tip and middle.
        """
        normals, away, starts, lengths = self._edges
        arm = abs(self.arm)
        turn = np.exp(1j * theta)
        n = normals[:, None] * turn
        with np.errstate(invalid="ignore"):
            height = away[:, None] + self.end - np.real(np.conj(n) * self.pivot)
            line = np.angle(n) + np.arccos(height / arm)
            middle = self.pivot + arm * np.exp(1j * line) - self.end * n
            along = np.imag(np.conj(n) * (middle - starts[:, None] * turn))
            line[~((along >= -_TOUCH) & (along <= lengths[:, None] + _TOUCH))] = np.nan
            tips = starts[: self.wheel.teeth, None] * turn
            w = tips - self.pivot
            far = np.abs(w)
            tip = np.angle(w) - np.arccos((arm**2 + far**2 - self.end**2) / (2 * arm * far))
            off = self.pivot + arm * np.exp(1j * tip) - tips
            back = n[: self.wheel.teeth]
            face = np.roll(n[self.wheel.teeth :], 1, axis=0)
            within = (np.imag(np.conj(face) * off) >= -_TOUCH) & (
                np.imag(np.conj(off) * back) >= -_TOUCH
            )
            tip[~within] = np.nan
        return np.concatenate([line, tip])

    def _first(self, theta: Floats) -> tuple[Floats, np.ndarray]:
        """How far the pawl is turned in from its seat, (n,) rad, nan where nothing stops it, and which edge or tip does."""
        beyond = self.wheel.tip + 2 * self.end
        far = abs(self.pivot)
        arm = abs(self.arm)
        cosine = min(1.0, max(-1.0, (far**2 + arm**2 - beyond**2) / (2 * far * arm)))
        out = cmath.phase(-self.pivot) - math.acos(cosine)
        way = np.mod(self._touches(theta) - out, math.tau)
        way[np.isnan(way)] = np.inf
        stop = np.argmin(way, axis=0)
        turned = out + way[stop, np.arange(len(theta))] - cmath.phase(self.arm)
        turned[np.isinf(turned)] = np.nan
        return np.mod(turned + math.pi, math.tau) - math.pi, stop

    def lift(self, theta: Any, order: int = 0) -> Floats:
        """Angle of the pawl on the wheel turned by theta from the seat, (n,) rad, below 0 it is lifted; or a derivative, 1 or 2.

        While it falls freely, over the last of a tip, the derivatives are 0: there the wheel does not lead it.
        """
        flat = np.atleast_1d(np.asarray(theta, float))
        turned, stop = self._first(flat.ravel())
        if order:
            turned = self._derivative(flat.ravel(), turned, stop, order)
        return np.asarray(turned.reshape(np.shape(theta)))

    def _derivative(self, theta: Floats, turned: Floats, stop: Any, order: int) -> Floats:
        """By the velocities at the contact: of the line's normal, or of the way from the tip to the end's middle."""
        normals, _, starts, _ = self._edges
        edge = stop < len(normals)
        arm = self.arm * np.exp(1j * turned)
        turn = np.exp(1j * theta)
        tip = starts[np.where(edge, 0, stop - len(normals))] * turn
        normal = np.where(
            edge,
            normals[np.where(edge, stop, 0)] * turn,
            (self.pivot + arm - tip) / self.end,
        )
        lever = np.real(np.conj(normal) * 1j * arm)
        # along a line the end's middle keeps its distance from it, as seen from the turning wheel
        way = np.where(edge, self.pivot + arm, tip)
        first = np.real(np.conj(normal) * 1j * way) / lever
        falls = np.abs(lever) < _FALLS * abs(self.arm)
        if order == 1:
            return np.where(falls, 0.0, first)
        velocity = 1j * arm * first
        on_line = (
            np.real(np.conj(normal) * (arm * first**2 + 2j * velocity + self.pivot + arm)) / lever
        )
        apart = np.abs(velocity - 1j * tip) ** 2 / self.end
        on_tip = (np.real(np.conj(normal) * (arm * first**2 - tip)) - apart) / lever
        return np.where(falls, 0.0, np.where(edge, on_line, on_tip))

    def outline(self, hub: float) -> Contour:
        """Its edge about the pivot, in the seat, mm: a hub of that radius, and an arm to the end, straight towards the teeth.

        DesignError where the arm would meet a tip.
        """
        length = abs(self.arm)
        self._refuse_near(hub, length)
        # along the arm, the wheel to the left; the inner side runs from the hub's foremost point, the outer one is a tangent
        inner = math.asin(self.end / (length - hub))
        outer = math.asin((hub - self.end) / length)
        right = cmath.rect(1, outer - math.pi / 2)
        left = cmath.rect(1, inner + math.pi / 2)
        pieces = (
            Arc(0j, hub, 0.0, 1.5 * math.pi + outer),
            Line(hub * right, length + self.end * right),
            Arc(complex(length), self.end, outer - math.pi / 2, math.pi + inner - outer),
            Line(length + self.end * left, complex(hub)),
        )
        return Contour(pieces).moved(self.arm / length)

    def _refuse_near(self, hub: float, length: float) -> None:
        """DesignError where a tip comes nearer to the arm's side or the hub than to the end."""
        room = -math.inf
        if length > hub + 2 * self.end:
            theta = np.arange(_SAMPLES) / _SAMPLES * self.wheel.pitch
            k = np.arange(self.wheel.teeth)[:, None]
            tips = self.wheel.tip * np.exp(1j * (k * self.wheel.pitch + theta)) - self.pivot
            tips = tips / (self.arm / length * np.exp(1j * self.lift(theta)))
            way = cmath.rect(1, math.asin(self.end / (length - hub)))
            aside = (tips - hub) / way
            along = math.sqrt((length - hub) ** 2 - self.end**2)
            beside = (aside.real > 0) & (aside.real < along)
            room = float(np.min(aside.imag, where=beside, initial=math.inf))
            room = min(room, abs(self.pivot) - self.wheel.tip - hub)
        if not room > 0:
            raise DesignError(
                "room between the pawl's arm and the teeth",
                room,
                0,
                "mm",
                "",
                "use a greater draw_deg, a smaller depth, or draw the pivot further off",
            )

    @property
    def draw(self) -> float:
        """Angle by which the face's push draws the pawl in, rad: from the push to the line from where it acts to the pivot; below 0
        it throws out.

        Friction at the face takes its angle from it.
        """
        return -cmath.phase(self.push / (self.pivot - self.held))


def pawl_of(wheel: RatchetWheel, distance: float, end: float, draw: float) -> Pawl:
    """The pawl whose pivot is so far from the wheel's axis, mm, and that a face draws in by this angle, rad.

    DesignError where its pivot is too near, where it swings through between two tips, or where it loses a whole tooth.
    """
    if not distance > wheel.tip:
        raise DesignError(
            "distance of the pawl's pivot from the wheel's axis",
            distance,
            wheel.tip,
            "mm",
            "",
            "draw the pivot further off, or use a smaller radius",
        )
    here = Pawl(wheel, complex(distance), end)
    way = here.push * cmath.exp(1j * draw)
    along = here.held * way.conjugate()
    most = distance**2 - along.imag**2
    reach = math.sqrt(max(most, 0.0)) - along.real
    least = 3 * end
    if not abs(here.held) < wheel.tip:
        raise DesignError(
            "radius at which a face holds the pawl's end",
            abs(here.held),
            wheel.tip,
            "mm",
            "",
            "use a smaller end_radius, or a greater depth",
        )
    if not (most > 0 and reach > least):
        raise DesignError(
            "reach of the pawl, from its pivot to the tooth",
            reach,
            least,
            "mm",
            "",
            "draw the pivot further off, or use a smaller radius or draw_deg",
        )
    pawl = Pawl(wheel, here.held + reach * way, end)
    _refuse_loose(pawl)
    return pawl


def _refuse_loose(pawl: Pawl) -> None:
    """DesignError where nothing stops the pawl at some angles of the wheel, or where the drop is no part of a tooth from the lock."""
    pitch = pawl.wheel.pitch
    passes = np.isnan(pawl.lift(np.arange(_SAMPLES) / _SAMPLES * pitch))
    if passes.any():
        raise DesignError(
            "share of a tooth over which the pawl swings through between two tips",
            100 * float(np.mean(passes)),
            0,
            "percent",
            "",
            "use more teeth, or a smaller draw_deg",
        )
    if not pawl.dropping > 0:
        raise DesignError(
            "angle from the lock to the drop",
            math.degrees(pawl.dropping),
            0,
            "deg",
            "",
            "use a greater draw_deg, or a smaller end_radius",
        )
    if not pawl.dropping < pitch:
        raise DesignError(
            "angle that is lost as the wheel turns back",
            math.degrees(pawl.dropping),
            math.degrees(pitch),
            "deg",
            "",
            "use a smaller draw_deg or depth, or fewer teeth",
        )


@dataclass(frozen=True)
class PawlLaw:
    """A pawl's angle over its wheel's, rad, both 0 where it is seated; way: the sense in which the wheel passes it."""

    pawl: Pawl
    way: Literal[1, -1] = 1

    def __call__(self, theta: Any, order: int = 0) -> Floats:
        """Its order-th derivative, 0..2, (n,); below 0 in the sense of `way` it is lifted."""
        turned = self.pawl.lift(self.way * np.asarray(theta, float), order)
        return turned * float(self.way ** (order + 1))
