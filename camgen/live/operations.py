"""What a hand does on the sheet, each as one change of the spec's text: comments, order and layout stay.

An operation is {"op": name, ...}; places are [x, y] in mm. What it cannot do is refused in words, and the text stays as it was.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import count
from typing import Any

from camgen.edits import put
from camgen.errors import Fault
from camgen.live.numbers import Refusal, typed_number
from camgen.machines.linkage.tables import pair
from camgen.schemas import shortened
from camgen.spec import DEVICES, unknown

GROUND = "ground"
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}")
NAMED_FILE = "a name of small letters a-z, digits and hyphens, at most 60, and none of a device of Windows, such as con"
FILE_NAME = re.compile(rf"(?!({DEVICES})$)(?=.{{1,60}}$)[a-z0-9]+(-[a-z0-9]+)*")
_BESIDE = 5.0  # mm, between points that were one
_FAR = 1e4  # mm, that a place may be from the origin
# Of a cam that is drawn.
_LIFT = 0.4  # share of the follower's distance from the shaft
_MOST_LIFT = 30.0  # deg or mm
_ROLLER = 6.0  # mm, its largest radius
_NEAREST = 8.0  # mm, of a follower's point from the cam's shaft
_OF_POINTS = ("along", "pin", "at", "point", "thread", "between")  # keys that name points
_OF_LINKS = ("link", "on", "a", "b", "cam", "follower", "wheel")
_TABLES = ("points", "links", "lengths", "drive")
ROWS = ("slide", "slot", "gear", "cam", "output")  # lists of tables
_GIVEN = re.compile(r"(link|crank|coupler|rocker)(_\d+)?")  # names that the sheet gives to links
_OF_ROLES = ("ground", "drive", "join")  # operations that tell what other links do
_OTHER_ROLES = (
    "slide",
    "gear",
    "cam",
)  # lists of tables whose links are no cranks, couplers or rockers
_BY_LINK = ("masses", "parts", "layers", "bodies")  # tables with a key for each link

Request = Mapping[str, Any]


def refused(key: str, value: object, right: str) -> Refusal:
    """The refusal of a part of an operation."""
    return Refusal([Fault((key,), shortened(str(value)), right)], "sheet")


def number(value: float) -> float:
    """To a hundredth, as a person writes it."""
    short = round(value, 2)
    return int(short) if short == int(short) else short


class Draft:
    """A spec's document while an operation changes it."""

    def __init__(self, text: str) -> None:
        import tomlkit

        self.document: Any = tomlkit.parse(text)
        self._check_kinds()

    def _check_kinds(self) -> None:
        """Refusal where a key that operations change holds another kind of thing, as a hand may have typed it."""
        tables = {name: self.document.get(name, {}) for name in (*_TABLES, *_BY_LINK)}
        for name, table in tables.items():
            if not isinstance(table, Mapping):
                raise refused(name, table, f"a table [{name}]")
        for name in ("points", "links"):
            for key, value in tables[name].items():
                if not isinstance(value, list):
                    raise refused(f"{name}.{key}", value, "a list")
        for name in ROWS:
            rows = self.document.get(name, [])
            if not isinstance(rows, list) or not all(isinstance(row, Mapping) for row in rows):
                raise refused(name, rows, f"a list of tables [[{name}]]")

    def text(self) -> str:
        """As it is now."""
        import tomlkit

        return tomlkit.dumps(self.document)

    # ---- what is there ----

    def table(self, name: str) -> Any:
        """A table of the spec, made where it has none."""
        import tomlkit

        if name not in self.document:
            self.document.add(tomlkit.nl())
            self.document.add(name, tomlkit.table())
        return self.document[name]

    @property
    def drives(self) -> list[Any]:
        """The table [drive], or each [[drive]]."""
        drive = self.document.get("drive", [])
        return list(drive) if isinstance(drive, list) else [drive]

    @property
    def points(self) -> Any:
        """Table [points]."""
        return self.table("points")

    @property
    def links(self) -> Any:
        """Table [links]."""
        return self.table("links")

    @property
    def lengths(self) -> Any:
        """Table [lengths]; an empty one that is not kept where the spec has none."""
        return self.document.get("lengths", {})

    def rows(self) -> Iterator[tuple[Any, int]]:
        """Each row of each list of tables, by its list and its place there, the last first."""
        for value in list(self.document.values()):
            if isinstance(value, list) and value and isinstance(value[0], dict):
                yield from ((value, k) for k in reversed(range(len(value))))

    def named(self, request: Request, key: str, names: Any) -> str:
        """A name in the request that has to be there already."""
        name = request.get(key)
        if not isinstance(name, str) or name not in names:
            raise Refusal([unknown((key,), name, names)], "sheet")
        return name

    def place(self, key: str, value: object) -> list[float]:
        """A place in a request, mm."""
        if (
            isinstance(value, list)
            and len(value) == 2
            and all(isinstance(each, int | float) and abs(each) <= _FAR for each in value)
        ):
            return [number(each) for each in value]
        raise refused(key, value, f"a place [x, y], mm, at most {_FAR:g} from the origin")

    def fresh(self, names: Any, first: str) -> str:
        """A name that is not taken, as the first or with a number behind it."""
        taken = {name.lower() for name in names}
        return next(
            name
            for k in count(1)
            if (name := first if k == 1 else f"{first}_{k}").lower() not in taken
        )

    def point(self, key: str, value: object) -> str:
        """A point by its name, or a new one at a place."""
        if isinstance(value, str):
            return self.named({key: value}, key, self.points)
        place = self.place(key, value)
        letters = ["O", *"ABCDEFGHIJKLMNPQRSTUVWXYZ"]
        names = (f"{letter}{k or ''}" for k in count() for letter in letters)
        taken = {name.lower() for name in self.points}
        name = next(name for name in names if name.lower() not in taken)
        self.points[name] = place
        return name

    def carry(self, link: str, point: str) -> None:
        """Put a point on a link."""
        if link not in self.links:
            self.links[link] = [point]
        elif point not in self.links[link]:
            self.links[link].append(point)

    def append(self, table: str, row: Mapping[str, Any]) -> None:
        """One more row of a list of tables."""
        import tomlkit

        if not isinstance(self.document.get(table), list):
            self.document.pop(table, None)
            self.document.add(tomlkit.nl())
            self.document.add(table, tomlkit.aot())
        self.document[table].append(_made(row))

    def within(self, holder: Any, table: str, rows: Sequence[Mapping[str, Any]]) -> None:
        """A list of tables within a row of another."""
        import tomlkit

        made = tomlkit.aot()
        for row in rows:
            made.append(_made(row))
        holder.append(table, made)

    def drive_if_none(self) -> None:
        """Let the first link on the ground drive, where none does."""
        drive: Any = next(iter(self.drives), {})
        ground = set(self.links.get(GROUND, ()))
        able = [name for name in self.links if name != GROUND and ground & {*self.links[name]}]
        if able and drive.get("link", drive.get("slide", "")) not in self.links:
            self.turn(able[0])

    def turn(self, link: str) -> None:
        """Let a link drive by turning, in place of what did first."""
        drive = self.drives[0] if self.drives else self.table("drive")
        for key in ("slide", "speed", "range"):
            drive.pop(key, None)
        put(drive, "link", link)

    def role(self, link: str) -> str:
        """What a link is, as its pins and the drive tell: crank, coupler, rocker; "" where they do not yet."""
        rows = [row for name in _OTHER_ROLES for row in self.document.get(name, [])]
        if any(row.get(key) == link for row in rows for key in ("link", "a", "b", "cam")):
            return ""
        points = set(self.links[link])
        ground = set(self.links.get(GROUND, ()))
        moving = [names for name, names in self.links.items() if name not in (link, GROUND)]
        pins = points & {point for names in moving for point in names} - ground
        if not points & ground:
            return "coupler" if len(pins) > 1 else ""
        if any(drive.get("link") == link for drive in self.drives):
            return "crank"
        return "rocker" if pins else ""

    def name_by_role(self, links: Collection[str]) -> None:
        """Give links of which the sheet made the names those of what they are."""
        roles = {}
        for link in links:
            role = self.role(link)
            given = _GIVEN.fullmatch(link)
            if role and given and given[1] != role:
                roles[link] = role
        between = {}
        for link, role in roles.items():  # two links may swap their names
            between[self.fresh([*self.links], "link")] = role
            self.rename_link(link, [*between][-1])
        for link, role in between.items():
            self.rename_link(link, self.fresh([*self.links], role))

    # ---- taking away, and other names ----

    def rename_link(self, name: str, other: str) -> None:
        """Give a link another name wherever it stands."""
        self.replace(_OF_LINKS, name, other)
        for drive in self.drives:
            if drive.get("link") == name:
                put(drive, "link", other)
        for table in ("links", *_BY_LINK):
            if name in self.document.get(table, {}):
                _rekey(self.document[table], name, other)

    def sweep(self) -> None:
        """Take away what hangs on nothing: links without points, or of one that do not slide; points of no link; lengths within
        no link."""
        held = [rows[k].get(key) for rows, k in self.rows() for key in ("link", "on")]
        for name in [name for name in self.links if name != GROUND]:
            if len(self.links[name]) < (1 if name in held else 2):
                self.drop_link(name)
        used = {point for points in self.links.values() for point in points}
        for name in [name for name in self.points if name not in used]:
            self.drop_point(name)
        within = [set(points) for points in self.links.values()]
        for key in list(self.lengths):
            ends = pair(key)
            if ends is None or not any(points.issuperset(ends) for points in within):
                self.lengths.pop(key)

    def drop_point(self, name: str) -> None:
        """Take a point off the sheet."""
        self.points.pop(name, None)
        for points in self.links.values():
            if name in points:
                points.remove(name)
        self.drop_rows(_OF_POINTS, name)

    def drop_link(self, name: str) -> None:
        """Take a link off the sheet, and what is said of it."""
        self.links.pop(name, None)
        self.drop_rows(_OF_LINKS, name)
        for drive in self.drives:
            if drive.get("link") == name:
                drive.pop("link")
        for table in _BY_LINK:
            self.document.get(table, {}).pop(name, None)

    def drop_rows(self, keys: tuple[str, ...], name: str) -> None:
        """Take away the rows that name a point or a link."""
        for rows, k in self.rows():
            row = rows[k]
            if any(name == row.get(key) or _holds(row.get(key), name) for key in keys):
                rows.pop(k)
        for table in [key for key, value in self.document.items() if value == []]:
            self.document.pop(table)

    def replace(self, keys: tuple[str, ...], name: str, other: str) -> None:
        """Name another point or link in all rows."""
        for rows, k in self.rows():
            for key in keys:
                value = rows[k].get(key)
                if value == name:
                    put(rows[k], key, other)
                elif _holds(value, name):
                    value[value.index(name)] = other


def _made(row: Mapping[str, Any]) -> Any:
    """A table of the document."""
    import tomlkit

    made = tomlkit.table()
    for key, value in row.items():
        made[key] = value
    return made


def _holds(value: Any, name: str) -> bool:
    return isinstance(value, list) and name in value


# ---- the operations --------------------------------------------------------------------------------------------------


def _move(draft: Draft, request: Request) -> None:
    """Points to other places; lengths that are held stay, or follow (follow = true)."""
    places = request.get("points")
    if not isinstance(places, Mapping):
        raise refused("points", places, "places by their points")
    for name, place in places.items():
        draft.named({"points": name}, "points", draft.points)
        put(draft.points, name, draft.place("points", place))
    if request.get("follow") is True:
        for key in draft.lengths:
            ends = pair(key)
            if ends and not set(ends).isdisjoint(places):
                put(draft.lengths, key, _drawn(draft, *ends))


def _drawn(draft: Draft, a: str, b: str) -> float:
    """Distance of two points as drawn, mm."""
    return max(0.01, number(math.dist(draft.points[a], draft.points[b])))


def _link(draft: Draft, request: Request) -> None:
    """A link between two ends: points that are there, or places of new ones."""
    ends = request.get("ends")
    if not isinstance(ends, list) or len(ends) != 2:
        raise refused("ends", ends, "two ends, each a point or a place")
    if ends[0] == ends[1]:
        raise refused("ends", ends[0], "two different ends")
    points = [draft.point("ends", end) for end in ends]
    name = draft.fresh(draft.links, "link")
    draft.links[name] = points
    draft.drive_if_none()
    draft.name_by_role([name])


def _point(draft: Draft, request: Request) -> None:
    """A point, there already or new, on a link."""
    link = draft.named(request, "link", draft.links)
    draft.carry(link, draft.point("at", request.get("at")))


def _ground(draft: Draft, request: Request) -> None:
    """Pin a point to the ground, or let it go."""
    point = draft.named(request, "point", draft.points)
    ground = draft.links.get(GROUND, [])
    if point in ground:
        ground.remove(point)
        draft.sweep()
    else:
        draft.carry(GROUND, point)
        draft.drive_if_none()


def _join(draft: Draft, request: Request) -> None:
    """Pin what meets at one point to what meets at another."""
    gone = draft.named(request, "point", draft.points)
    kept = draft.named(request, "to", draft.points)
    shared = [name for name, points in draft.links.items() if gone in points and kept in points]
    if gone == kept or shared:
        raise refused("to", kept, f"a point of another link than {gone} is on")
    _rename_point(draft, gone, kept)
    draft.points.pop(gone)


def _unpin(draft: Draft, request: Request) -> None:
    """Give each link but the first that is pinned at a point a point of its own beside it."""
    point = draft.named(request, "point", draft.points)
    links = [name for name, points in draft.links.items() if point in points]
    if len(links) < 2:
        raise refused("point", point, "a point at which links are pinned")
    x, y = draft.points[point]
    for k, link in enumerate(links[1:], 1):
        own = draft.point("point", [x + _BESIDE * k, y])
        _rename_ends(draft, {*draft.links[link]}, point, own)
        draft.links[link][draft.links[link].index(point)] = own


def _rename_point(draft: Draft, name: str, other: str) -> None:
    for points in draft.links.values():
        if name in points:
            points[points.index(name)] = other
    _rename_ends(draft, {*draft.points}, name, other)
    draft.replace(_OF_POINTS, name, other)


def _rename_ends(draft: Draft, within: set[str], name: str, other: str) -> None:
    """Name another point in the lengths between some points."""
    for key in list(draft.lengths):
        ends = pair(key)
        if ends and name in ends and within.issuperset(ends):
            value = draft.lengths.pop(key)
            new = "-".join(other if end == name else end for end in ends)
            if new not in draft.lengths:
                _hold(draft, new, value)


def _slide(draft: Draft, request: Request) -> None:
    """Let a link, or a slider at a point, slide on the ground along a line between two new points of it."""
    ends = request.get("along")
    if not isinstance(ends, list) or len(ends) != 2 or ends[0] == ends[1]:
        raise refused("along", ends, "two places that lie apart")
    places = [draft.place("along", end) for end in ends]
    if "point" in request:
        point = draft.named(request, "point", draft.points)
        if point in draft.links.get(GROUND, ()):
            raise refused("point", point, "a point that moves: this one stands on the ground")
        link = draft.fresh(draft.links, "slider")
        draft.links[link] = [point]
    else:
        link = draft.named(request, "link", [name for name in draft.links if name != GROUND])
    along = [draft.point("along", place) for place in places]
    for each in along:
        draft.carry(GROUND, each)
    draft.append("slide", {"link": link, "along": along})


def _slot(draft: Draft, request: Request) -> None:
    """Let a point run in a slot of a link, along two points of it."""
    pin = draft.named(request, "point", draft.points)
    link = draft.named(request, "link", draft.links)
    points = [each for each in draft.links[link] if each != pin]
    if len(points) < 2 or pin in draft.links[link]:
        raise refused("link", link, f"a link with two points, and without {pin}")
    draft.append("slot", {"pin": pin, "link": link, "along": points[:2]})


def _pivot(draft: Draft, link: str) -> str | None:
    """The point at which a link turns on the ground."""
    ground = draft.links.get(GROUND, ())
    return next((point for point in draft.links[link] if point in ground), None)


def _turning(draft: Draft, request: Request, key: str) -> tuple[str, str]:
    """A link of the request that turns on the ground, and the point at which it does."""
    link = draft.named(request, key, [name for name in draft.links if name != GROUND])
    pivot = _pivot(draft, link)
    if pivot is None:
        raise refused(key, link, "a link that is pinned to the ground")
    return link, pivot


def _taken_away(draft: Draft, table: str, row: Mapping[str, str]) -> bool:
    """Take the rows away that have these values; whether there were any."""
    rows = draft.document.get(table, [])
    found = [k for k, each in enumerate(rows) if row.items() <= dict(each).items()]
    for k in reversed(found):
        rows.pop(k)
    if found and not rows:
        draft.document.pop(table)
    return bool(found)


def _gear(draft: Draft, request: Request) -> None:
    """Join two links that turn on the ground by a pair of equal wheels, or no longer."""
    a, pivot_a = _turning(draft, request, "a")
    b, pivot_b = _turning(draft, request, "b")
    if a == b or pivot_a == pivot_b:
        raise refused("b", b, f"a link with another axis than {a}")
    if _taken_away(draft, "gear", {"a": a, "b": b}) or _taken_away(draft, "gear", {"a": b, "b": a}):
        return
    draft.append("gear", {"a": a, "b": b, "ratio": -1})


def _cam(draft: Draft, request: Request) -> None:
    """Let a link that turns move another by a cam and a roller at a point of it, or no longer.

    The follower rises by 0.4 of its distance from the cam's shaft in a third of a turn: of a modified sine that is a pressure
    angle of some 16 deg, where it moves straight off the shaft.
    """
    cam, shaft = _turning(draft, request, "cam")
    point = draft.named(request, "point", draft.points)
    sliding = [row.get("link") for row in draft.document.get("slide", [])]
    able = [
        name
        for name, points in draft.links.items()
        if point in points
        and name not in (GROUND, cam)
        and (name in sliding or _pivot(draft, name) not in (None, point))
    ]
    if not able:
        raise refused(
            "point",
            point,
            f"a moving point of a link beside {cam} that turns or slides on the ground",
        )
    follower = able[0]
    if _taken_away(draft, "cam", {"cam": cam, "follower": follower}):
        return
    distance = _drawn(draft, point, shaft)
    if distance < _NEAREST:
        raise refused("point", point, f"a point at least {_NEAREST:g} mm from {shaft}")
    if follower in sliding:
        end = "lift", "to"
        lift = _LIFT * distance
    else:
        end = "lift_deg", "to_deg"
        lift = math.degrees(_LIFT * distance / _drawn(draft, point, str(_pivot(draft, follower))))
    rise, back = end
    law = {"span_deg": 120, "law": "modified-sine"}
    rows: list[dict[str, Any]] = [
        {"kind": "rise", rise: max(1, round(min(lift, _MOST_LIFT))), **law},
        {"kind": "dwell"},
        {"kind": "return", back: 0, **law},
    ]
    radius = max(1, round(min(_ROLLER, distance / 6)))
    draft.append("cam", {"cam": cam, "follower": follower, "at": point, "radius": radius})
    draft.within(draft.document["cam"][-1], "segment", rows)


def _drive(draft: Draft, request: Request) -> None:
    """The link that drives."""
    link = draft.named(request, "link", [name for name in draft.links if name != GROUND])
    if set(draft.links[link]).isdisjoint(draft.links.get(GROUND, ())):
        raise refused("link", link, "a link that is pinned to the ground")
    draft.turn(link)


def _output(draft: Draft, request: Request) -> None:
    """Show and judge a point's path or a link's motion, or no longer."""
    key = "point" if "point" in request else "link"
    name = draft.named(request, key, draft.points if key == "point" else draft.links)
    kept = draft.document.get("output", [])
    for k in reversed(range(len(kept))):
        if kept[k].get(key) == name:
            kept.pop(k)
            if not kept:
                draft.document.pop("output")
            return
    names = [row.get("name", "") for row in kept]
    draft.append("output", {"name": draft.fresh(names, name), key: name})


def _length(draft: Draft, request: Request) -> None:
    """Hold the length between two points of a link at a value, mm; without one it follows the drawing."""
    ends = request.get("between")
    if not isinstance(ends, list) or len(ends) != 2:
        raise refused("between", ends, "two points")
    a, b = (draft.named({"between": end}, "between", draft.points) for end in ends)
    value = request.get("value")
    known = [key for key in draft.lengths if set(pair(key) or ()) == {a, b}]
    if value is None:
        for key in known:
            draft.lengths.pop(key)
        return
    if not isinstance(value, int | float) or not 1e-3 <= value <= 2 * _FAR:
        right = typed_number(str(value), f"a length in mm, above 0 and at most {2 * _FAR:g}", "mm")
        raise refused(f"{a}-{b}", value, right)
    if not any({a, b} <= {*points} for points in draft.links.values()):
        raise refused("between", f"{a}-{b}", "two points of one link")
    if known:
        put(draft.lengths, known[0], number(value))
        return
    _hold(draft, f"{a}-{b}", number(value))


def _hold(draft: Draft, key: str, value: Any) -> None:
    """A new length, its key in quotes as people write it."""
    from tomlkit.items import KeyType, SingleKey

    draft.table("lengths").append(SingleKey(key, t=KeyType.Basic), value)


def _delete(draft: Draft, request: Request) -> None:
    """Take away a point or a link, and what is said of it."""
    if "point" in request:
        draft.drop_point(draft.named(request, "point", draft.points))
    else:
        draft.drop_link(
            draft.named(request, "link", [each for each in draft.links if each != GROUND])
        )
    draft.sweep()


def _rename(draft: Draft, request: Request) -> None:
    """Give a point, a link or the sheet another name."""
    if request.keys().isdisjoint(("point", "link")):
        name = request.get("to")
        if not isinstance(name, str) or not FILE_NAME.fullmatch(name):
            raise refused("name", name, NAMED_FILE)
        put(draft.document, "name", name)
        return
    is_point = "point" in request
    names = draft.points if is_point else [each for each in draft.links if each != GROUND]
    name = draft.named(request, "point" if is_point else "link", names)
    other = request.get("to")
    if not isinstance(other, str) or not _NAME.fullmatch(other):
        raise refused("name", other, "a name of letters, digits and _, a letter first, at most 40")
    if other.lower() in {each.lower() for each in (draft.points if is_point else draft.links)} - {
        name.lower()
    }:
        raise refused("name", other, "a name that is not taken")
    if is_point:
        _rename_point(draft, name, other)
        _rekey(draft.points, name, other)
        return
    draft.rename_link(name, other)


def _rekey(table: Any, name: str, other: str) -> None:
    """A key's other name, at the end of its table."""
    table[other] = table.pop(name)


OPERATIONS: dict[str, Callable[[Draft, Request], None]] = {
    "move": _move,
    "link": _link,
    "point": _point,
    "ground": _ground,
    "join": _join,
    "unpin": _unpin,
    "slide": _slide,
    "slot": _slot,
    "gear": _gear,
    "cam": _cam,
    "drive": _drive,
    "output": _output,
    "length": _length,
    "delete": _delete,
    "rename": _rename,
}


def applied(text: str, request: Request, typed: Collection[str] = ()) -> str:
    """The text after an operation; Refusal where it cannot be done. typed: links that keep their names."""
    name = request.get("op")
    if not isinstance(name, str) or name not in OPERATIONS:
        raise Refusal([unknown(("op",), name, OPERATIONS)], "sheet")
    draft = Draft(text)
    try:
        OPERATIONS[name](draft, request)
    except Refusal as error:
        raise Refusal([_by_tool(fault, name, request) for fault in error.faults], "sheet") from None
    if name in _OF_ROLES:
        draft.name_by_role([each for each in draft.links if each not in (GROUND, *typed)])
    return draft.text()


def _by_tool(fault: Fault, name: str, request: Request) -> Fault:
    """A fault of a part of the request, of which nobody typed the key, under the name of the tool."""
    return replace(fault, path=(), source=name.capitalize()) if fault.path[0] in request else fault


def moved(tables: Mapping[str, Any], request: Request) -> tuple[dict[str, Any], dict[str, Any]]:
    """Points and lengths after a move, without its text: what a hand that drags asks for many times a second."""
    points = {**tables["points"], **request["points"]}
    lengths = dict(tables.get("lengths", {}))
    if request.get("follow") is True:
        for key in lengths:
            ends = pair(key)
            if ends and not set(ends).isdisjoint(request["points"]):
                lengths[key] = max(0.01, math.dist(points[ends[0]], points[ends[1]]))
    return points, lengths
