"""Words of a spec that have another name: an old one is taken, with a note, and faults keep the word that was typed.

What else people call a value is not taken, for it may mean several: a fault names them.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from camgen.errors import Fault, Key, dotted
from camgen.reading import Data

# Of a table, ("output",), of a key in one, ("parts", "flange"), or of its value, ("parts", "make", "machine"): the word of today.
OldWords = Mapping[tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True)
class Wording:
    """The tables of a spec in the words of today, and how they were typed."""

    data: Data
    typed: Mapping[Key, Key]  # of a key of today: as it was typed
    notes: tuple[str, ...]  # what to tell of old words

    def as_typed(self, fault: Fault) -> Fault:
        """The fault by the key that the person typed."""
        known = next((n for n in (2, 1) if fault.path[:n] in self.typed), 0)
        return replace(fault, path=self.typed.get(fault.path[:known], ()) + fault.path[known:])


def wording(data: Data, old_words: OldWords) -> Wording:
    """Read the old words of a spec's tables; what stands under both words is that of the old one, such as of `--set`.

    Where a list stands under the old word of a table, or a table under that of a key, it is another thing, and is left.
    """
    typed: dict[Key, Key] = {}
    notes = []
    for old, new in old_words.items():
        source = data.get(old[0])
        if not isinstance(source, dict) or (len(old) > 1 and not _has(source, *old[1:])):
            continue
        target = data.get(new[0], {})
        if not isinstance(target, dict):
            continue
        moved = {key: key for key in source} if len(old) == 1 else {old[1]: new[1]}
        left = {key: value for key, value in source.items() if key not in moved}
        into = left if old[0] == new[0] else target
        beside = [dotted((new[0], key)) for key in moved.values() if key in into]
        data = {key: value for key, value in data.items() if key != old[0]}
        if len(old) > 1:
            data[old[0]] = left
        data[new[0]] = {**into, **{key: (*new[2:], source[word])[0] for word, key in moved.items()}}
        typed |= {(new[0], key): (old[0], word) for word, key in moved.items()}
        if not into:
            typed[new[:1]] = old[:1]
        place = f", in place of {', '.join(beside)} beside it" if beside else ""
        notes.append(f"{_written(old)} is read as {_written(new)}{place}")
    return Wording(data, typed, tuple(notes))


def _has(table: Data, key: str, *value: str) -> bool:
    """Whether a table has a key that is no table; with that value, if one is given."""
    return key in table and not isinstance(table[key], dict) and value in ((), (table[key],))


def _written(word: tuple[str, ...]) -> str:
    """A table, key or value as a person writes it."""
    return dotted(word) if len(word) < 3 else f'{dotted(word[:2])} = "{word[2]}"'


_STEELS = ("C45", "42CrMo4", "16MnCr5", "stainless")
_SINES = ("cycloidal", "modified-sine", "simple-harmonic")
_POLYNOMIALS = ("3-4-5", "4-5-6-7", "polynomial")
_NEMA_17 = ("17HS19-2004S1", "17HS24", "42STH48-2004AC", "42STH40-1004A")
_CAMS = ("disc-cam", "cylinder-cam", "linear-cam")

# What people call a value: by its key their word, in small letters with single hyphens, and the names that it may have here.
_LIKELY: dict[str, dict[str, tuple[str, ...]]] = {
    "law": {
        **dict.fromkeys(("sine", "sin", "sinus", "sinusoidal"), _SINES),
        **dict.fromkeys(("harmonic", "shm", "cosine"), ("simple-harmonic",)),
        **dict.fromkeys(("poly7", "poly-7"), ("4-5-6-7",)),
        **dict.fromkeys(("poly", "spline", "quintic", "smooth"), _POLYNOMIALS),
        **dict.fromkeys(
            (
                "345",
                "poly-345",
                "poly5",
                "poly-5",
                "fifth-order",
                "polynomial-345",
                "polynomial-3-4-5",
            ),
            ("3-4-5",),
        ),
        **dict.fromkeys(("trapezoid", "trapezoidal", "mod-trap"), ("modified-trapezoid",)),
        **dict.fromkeys(("linear", "constant-velocity", "constant"), ("uniform",)),
        "constant-acceleration": ("parabolic",),
        "mod-sine": ("modified-sine",),
    },
    "material": {
        **dict.fromkeys(("steel", "stahl", "mild-steel", "iron", "metal", "s235"), _STEELS),
        **dict.fromkeys(("hardened-steel", "tool-steel", "hardened"), ("16MnCr5", "42CrMo4")),
        **dict.fromkeys(("aluminum", "alu", "al", "6061"), ("aluminium",)),
        # numbers of EN 10027-2, as the sources of the materials have them
        "1.0503": ("C45",),
        "1.7225": ("42CrMo4",),
        "1.7131": ("16MnCr5",),
        "1.4301": ("stainless",),
        **dict.fromkeys(("wood", "birch", "mdf"), ("plywood",)),
        **dict.fromkeys(("delrin", "acetal"), ("POM",)),
        **dict.fromkeys(("plexiglass", "plexiglas", "pmma"), ("acrylic",)),
        **dict.fromkeys(("plastic", "filament", "resin"), ("PLA", "PETG", "ABS")),
        **dict.fromkeys(("inox", "stainless-steel", "304", "316"), ("stainless",)),
    },
    "model": {
        **dict.fromkeys(("nema", "nema17", "nema-17", "stepper", "stepper-motor"), _NEMA_17),
        **dict.fromkeys(("servo", "hobby-servo"), ("SG90", "MG90S")),
        **dict.fromkeys(("tt", "gearmotor", "gear-motor"), ("TT-1:48", "N20-100:1")),
        **dict.fromkeys(("n20",), ("N20-100:1", "N20-298:1", "N20-1000:1")),
        **dict.fromkeys(("hand", "crank", "manual", "none"), ("hand crank",)),
    },
    "kind": {
        **dict.fromkeys(("lift", "up", "raise"), ("rise",)),
        **dict.fromkeys(("fall", "down", "drop", "lower"), ("return",)),
        **dict.fromkeys(("rest", "hold", "pause", "wait"), ("dwell",)),
    },
    "motion": {
        **dict.fromkeys(("linear", "sliding", "translation", "slider"), ("translating",)),
        **dict.fromkeys(("swinging", "rotating", "pivoting", "rocker"), ("oscillating",)),
    },
    "shape": {
        **dict.fromkeys(("flat-faced", "face", "plate", "mushroom"), ("flat",)),
        **dict.fromkeys(("point", "edge", "knife-edge"), ("knife",)),
        **dict.fromkeys(("wheel", "bearing"), ("roller",)),
    },
    "closure": {
        **dict.fromkeys(("spring", "gravity"), ("force",)),
        **dict.fromkeys(("form", "positive", "desmodromic"), ("groove", "conjugate")),
        **dict.fromkeys(("track", "slot"), ("groove",)),
    },
    "make": {
        **dict.fromkeys(("print", "printer", "3d", "machine", "all"), ("printed",)),
        **dict.fromkeys(("lasercut", "laser-cut", "sheet"), ("laser",)),
    },
    "mechanism": {
        **dict.fromkeys(("cam",), _CAMS),
        **dict.fromkeys(("plate-cam", "radial-cam"), ("disc-cam",)),
        **dict.fromkeys(("barrel-cam", "drum-cam"), ("cylinder-cam",)),
        **dict.fromkeys(("music-box", "pin-drum", "automaton", "camshaft"), ("drum",)),
    },
}
# What people call a key, and what it may be called here.
_KEYS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("type", "motion_type"), ("kind",)),
    **dict.fromkeys(("angle", "duration", "degrees", "deg", "length_deg"), ("span_deg",)),
    **dict.fromkeys(("stroke", "rise", "height", "amplitude", "travel"), ("lift", "stroke")),
    **dict.fromkeys(("profile", "curve", "function", "motion_law"), ("law",)),
    **dict.fromkeys(("start", "start_deg", "from_deg"), ("at_deg",)),
    **dict.fromkeys(("mass", "weight", "weight_g"), ("mass_kg", "mass_g")),
    **dict.fromkeys(("force", "force_n", "load"), ("resistance",)),
    **dict.fromkeys(("torque", "torque_nm"), ("torque_n_m",)),
    **dict.fromkeys(("rpm", "speed", "n"), ("speed_rpm",)),
    **dict.fromkeys(("k", "stiffness", "spring_rate"), ("rate",)),
    **dict.fromkeys(("body", "bodies"), ("link", "links")),
    **dict.fromkeys(("joint", "joints"), ("points",)),
    **dict.fromkeys(("tolerance", "accuracy"), ("chord_tolerance",)),
    **dict.fromkeys(("base_circle", "base_circle_radius", "prime_radius"), ("base_radius",)),
}
# Machines that are no mechanism but an example of one: their words, and which example.
_EXAMPLES: dict[str, str] = {
    **dict.fromkeys(("four-bar", "fourbar", "4-bar", "crank-rocker"), "four-bar"),
    **dict.fromkeys(("slider-crank", "crank-slider", "quick-return"), "quick-return"),
    **dict.fromkeys(("five-bar", "fivebar"), "five-bar"),
    **dict.fromkeys(("geneva", "geneva-drive", "geneva-table"), "geneva-table"),
    **dict.fromkeys(("gear", "gears", "planetary", "planetary-reducer"), "planetary-reducer"),
    **dict.fromkeys(("cycloidal", "cycloidal-drive", "cycloidal-reducer"), "cycloidal-reducer"),
    **dict.fromkeys(("jansen", "walking-leg", "strandbeest"), "walking-leg"),
    **dict.fromkeys(("klann", "walker"), "walker"),
    **dict.fromkeys(("bird", "toy", "wings"), "flapping-bird"),
    "ratchet": "ratchet",
    "scotch-yoke": "scotch-yoke",
    "elliptic-trammel": "elliptic-trammel",
}


def likely(kind: str, value: object, known: Sequence[str]) -> tuple[str, ...]:
    """Names that a person may mean by another word, the likeliest first; kind: of the value; known: those that it may have."""
    words = _LIKELY.get(kind, {})
    return tuple(name for name in words.get(_plain(value), ()) if name in known)


def other_key(kind: str, value: object) -> str:
    """Where else a person may write what is no such value; or "" """
    frame = re.fullmatch(r"nema-?(\d+)", _plain(value))
    if kind != "model" or frame is None:
        return ""
    return f'parts.motor = "nema-{frame[1]}" is its frame'


def likely_key(name: str, known: Collection[str]) -> list[str]:
    """The key that a person may mean by another word, if one is known."""
    return [key for key in other_words(name) if key in known][:1]


def other_words(name: str) -> tuple[str, ...]:
    """Keys that a person may mean by a word that is none."""
    return _KEYS.get(name.lower(), ())


def example(kind: str, value: object) -> str:
    """The example that a person means by the word for a mechanism, for camgen new; or "" """
    return _EXAMPLES.get(_plain(value), "") if kind == "mechanism" else ""


def kind_of(path: Sequence[str | int]) -> str:
    """What a key holds: its own name, or that of its table where the key is the name in it, as material.name is a material."""
    named = len(path) > 1 and path[-1] == "name"
    return str(path[-2 if named else -1]) if path else ""


def _plain(value: object) -> str:
    """A word in small letters, with single hyphens; a material's number as it is written, with four decimals."""
    if isinstance(value, float):
        return f"{value:.4f}"
    return re.sub(r"[\s_-]+", "-", value.strip().lower()) if isinstance(value, str) else ""
