"""A linkage that is drawn: each operation in the spec's text, undo, what the page is told, where it is saved."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from camgen import starters
from camgen.errors import SpecError
from camgen.live.board import Board
from camgen.live.gallery import Gallery, cards, usable
from camgen.live.operations import OPERATIONS, applied
from camgen.machines.linkage.mechanism import Linkage
from camgen.machines.linkage.traces import angles, idle, traces
from camgen.machines.sources import changed, read_mechanism

HOME = "http://127.0.0.1:8000"
WORD = "a-word-of-chance"
LEG = starters.text("walking-leg")
FOUR = """# a four-bar
mechanism = "linkage"
name = "bar"

[points]                # mm
O = [0, 0]              # shaft
A = [10, 20]
B = [60, 40]            # far end
C = [60, 0]

[links]
ground = ["O", "C"]     # stands
crank = ["O", "A"]
coupler = ["A", "B"]
rocker = ["C", "B"]

[lengths]
"O-A" = 22.36           # crank

[drive]
link = "crank"
speed_rpm = 30

[[output]]
name = "far"
point = "B"
"""
# Each operation on the four-bar: lines that go and lines that come.
DONE: list[tuple[dict[str, Any], set[str], set[str]]] = [
    (
        {"op": "move", "points": {"B": [61.5, 40.25]}},
        {"B = [60, 40]            # far end"},
        {"B = [61.5, 40.25]       # far end"},
    ),
    (
        {"op": "move", "points": {"A": [3, 4]}, "follow": True},
        {"A = [10, 20]", '"O-A" = 22.36           # crank'},
        {"A = [3, 4]", '"O-A" = 5               # crank'},
    ),
    (
        {"op": "link", "ends": ["A", [30.004, 70]]},
        set(),
        {"D = [30, 70]", 'link = ["A", "D"]'},
    ),
    (
        {"op": "point", "link": "coupler", "at": [30, 70]},
        {'coupler = ["A", "B"]'},
        {"D = [30, 70]", 'coupler = ["A", "B", "D"]'},
    ),
    (
        {"op": "ground", "point": "B"},
        {'ground = ["O", "C"]     # stands'},
        {'ground = ["O", "C", "B"]     # stands'},
    ),
    (
        {"op": "join", "point": "B", "to": "O"},
        {
            "B = [60, 40]            # far end",
            'coupler = ["A", "B"]',
            'rocker = ["C", "B"]',
            'point = "B"',
        },
        {'coupler = ["A", "O"]', 'rocker = ["C", "O"]', 'point = "O"'},
    ),
    (
        {"op": "unpin", "point": "O"},
        {'crank = ["O", "A"]', '"O-A" = 22.36           # crank'},
        {"D = [5, 0]", 'crank = ["D", "A"]', '"D-A" = 22.36           # crank'},
    ),
    (
        {"op": "slide", "point": "B", "along": [[60, 40], [100, 40]]},
        {'ground = ["O", "C"]     # stands'},
        {
            'ground = ["O", "C", "D", "E"]     # stands',
            "D = [60, 40]",
            "E = [100, 40]",
            'slider = ["B"]',
            "[[slide]]",
            'link = "slider"',
            'along = ["D", "E"]',
        },
    ),
    (
        {"op": "slot", "point": "B", "link": "crank"},
        set(),
        {"[[slot]]", 'pin = "B"', 'link = "crank"', 'along = ["O", "A"]'},
    ),
    (
        {"op": "gear", "a": "crank", "b": "rocker"},
        set(),
        {"[[gear]]", 'a = "crank"', 'b = "rocker"', "ratio = -1"},
    ),
    (
        {"op": "cam", "cam": "crank", "point": "B"},
        set(),
        {
            "[[cam]]",
            'cam = "crank"',
            'follower = "rocker"',
            'at = "B"',
            "radius = 6",
            "[[cam.segment]]",
            'kind = "rise"',
            "lift_deg = 30",
            "span_deg = 120",
            'law = "modified-sine"',
            'kind = "dwell"',
            'kind = "return"',
            "to_deg = 0",
        },
    ),
    (
        {"op": "drive", "link": "rocker"},
        {'link = "crank"'},
        {'link = "rocker"'},
    ),
    ({"op": "output", "point": "B"}, {"[[output]]", 'name = "far"', 'point = "B"'}, set()),
    (
        {"op": "output", "link": "rocker"},
        set(),
        {"[[output]]", 'name = "rocker"', 'link = "rocker"'},
    ),
    (
        {"op": "length", "between": ["B", "A"], "value": 53.849},
        set(),
        {'"B-A" = 53.85'},
    ),
    (
        {"op": "length", "between": ["A", "O"], "value": None},
        {'"O-A" = 22.36           # crank'},
        set(),
    ),
    (
        {"op": "delete", "point": "B"},
        {
            "B = [60, 40]            # far end",
            'coupler = ["A", "B"]',
            'rocker = ["C", "B"]',
            "[[output]]",
            'name = "far"',
            'point = "B"',
        },
        set(),
    ),
    (
        {"op": "delete", "link": "crank"},
        {"O = ", 'crank = ["O", "A"]', '"O-A" = 22.36           # crank', 'link = "crank"'},
        set(),
    ),
    (
        {"op": "rename", "point": "B", "to": "pen"},
        {
            "B = [60, 40]            # far end",
            'coupler = ["A", "B"]',
            'rocker = ["C", "B"]',
            'point = "B"',
        },
        {
            "pen = [60, 40]            # far end",
            'coupler = ["A", "pen"]',
            'rocker = ["C", "pen"]',
            'point = "pen"',
        },
    ),
    (
        {"op": "rename", "link": "crank", "to": "arm"},
        {'crank = ["O", "A"]', 'link = "crank"'},
        {'arm = ["O", "A"]', 'link = "arm"'},
    ),
    ({"op": "rename", "to": "leg-2"}, {'name = "bar"'}, {'name = "leg-2"'}),
]
REFUSED: list[tuple[dict[str, Any], str]] = [
    (
        {"op": "gear", "a": "crank", "b": "coupler"},
        "Gear: coupler - expected a link that is pinned",
    ),
    ({"op": "gear", "a": "crank", "b": "crank"}, "a link with another axis than crank"),
    ({"op": "cam", "cam": "coupler", "point": "B"}, "a link that is pinned to the ground"),
    ({"op": "cam", "cam": "crank", "point": "A"}, "a moving point of a link beside crank"),
    ({"op": "cam", "cam": "crank", "point": "C"}, "a moving point of a link beside crank"),
    ({}, "op"),
    ({"op": "explode"}, "op"),
    ({"op": "move", "points": {"Z": [0, 0]}}, "Move: 'Z'"),
    ({"op": "move", "points": {"B": [math.nan, 0]}}, "a place [x, y]"),
    ({"op": "move", "points": {"B": [1e9, 0]}}, "at most 10000"),
    ({"op": "link", "ends": ["A"]}, "two ends"),
    ({"op": "link", "ends": ["A", "A"]}, "two different ends"),
    ({"op": "point", "link": "crnk", "at": [0, 0]}, "crank"),
    ({"op": "ground", "point": ["O"]}, "Ground: "),
    ({"op": "join", "point": "A", "to": "O"}, "a point of another link"),
    ({"op": "unpin", "point": "D"}, "Unpin: 'D'"),
    ({"op": "slide", "point": "O", "along": [[0, 0], [1, 0]]}, "stands on the ground"),
    ({"op": "slide", "point": "B", "along": [[0, 0], [0, 0]]}, "lie apart"),
    ({"op": "slot", "point": "A", "link": "crank"}, "without A"),
    ({"op": "drive", "link": "coupler"}, "pinned to the ground"),
    ({"op": "drive", "link": "ground"}, "Drive: 'ground'"),
    ({"op": "length", "between": ["A", "C"], "value": 5}, "two points of one link"),
    (
        {"op": "length", "between": ["A", "B"], "value": -5},
        "a length in mm, above 0",
    ),
    (
        {"op": "length", "between": ["A", "B"], "value": "20,5"},
        "a decimal point, not a comma: 20.5",
    ),
    ({"op": "delete", "link": "ground"}, "Delete: 'ground'"),
    ({"op": "rename", "link": "crank", "to": "no name"}, "a name of letters"),
    ({"op": "rename", "link": "crank", "to": "Rocker"}, "not taken"),
    ({"op": "rename", "to": "../up"}, "name: ../up - expected a name of small letters"),
    ({"op": "rename", "to": "con"}, "device of Windows"),
]


def board(folder: Path, text: str = FOUR) -> Board:
    spec = folder / "bar.toml"
    spec.write_text(text, encoding="utf-8")
    return Board(spec, folder / "out")


def client(board: Board) -> TestClient:
    return TestClient(board.app(WORD), base_url=f"{HOME}/{WORD}/", headers={"origin": HOME})


@pytest.mark.parametrize("request_, gone, new", DONE, ids=[str(each[0])[:60] for each in DONE])
def test_an_operation_changes_its_lines_alone(
    request_: dict[str, Any], gone: set[str], new: set[str], tmp_path: Path
) -> None:
    drawn = board(tmp_path)
    drawn.draw(request_)
    before, after = FOUR.splitlines(), (drawn.text or "").splitlines()
    lost = {line for line in before if line not in after}
    assert all(any(line.startswith(each) for each in gone) for line in lost), lost - gone
    assert {line for line in after if line and line not in before} <= new
    assert all(any(line == each for line in after) for each in new)
    assert sum(line not in before for line in after) or lost
    tomllib.loads(drawn.text or "")
    drawn.undo({})
    assert drawn.text == FOUR and drawn.file.text == FOUR, "to the byte"
    drawn.redo({})
    assert (drawn.text or "").splitlines() == after


def test_a_slider_goes_with_its_point_and_a_link_with_its_last_but_one() -> None:
    slider = applied(FOUR, {"op": "slide", "point": "B", "along": [[70, 40], [100, 40]]})
    tables = tomllib.loads(applied(slider, {"op": "delete", "point": "B"}))
    assert [*tables["links"]] == ["ground", "crank"] and "slide" not in tables
    tables = tomllib.loads(applied(slider, {"op": "delete", "link": "slider"}))
    assert [*tables["links"]] == ["ground", "crank", "coupler", "rocker"]


def test_each_operation_is_tried() -> None:
    assert {each["op"] for each, _, _ in DONE} == set(OPERATIONS)


@pytest.mark.parametrize("request_, says", REFUSED, ids=lambda each: str(each)[:40])
def test_what_cannot_be_done_is_refused_in_words(request_: dict[str, Any], says: str) -> None:
    with pytest.raises(SpecError) as error:
        applied(FOUR, request_)
    assert says in str(error.value)


@pytest.mark.parametrize(
    "line", ["points = 5", "links = 5", "output = 5", "slide = 5", "drive = 5", "masses = 5"]
)
def test_a_key_of_another_kind_is_shown_and_operations_refuse_it(tmp_path: Path, line: str) -> None:
    spec = tmp_path / "s.toml"
    spec.write_text(f'mechanism = "linkage"\nname = "s"\n{line}\n')
    page = client(Board(spec, tmp_path / "out"))
    assert page.get("/").status_code == 200
    answer = page.post("/draw", json={"op": "link", "ends": [[0, 0], [9, 0]]})
    assert answer.status_code == 409
    name = line.split()[0]
    (said,) = answer.json()["errors"]
    assert said.startswith(f"{name}: 5 - expected a ")


def test_links_are_named_by_what_they_are_and_typed_names_stay(tmp_path: Path) -> None:
    page = client(Board(None, tmp_path / "out"))
    page.post("/start", json={})
    drawn = [
        {"op": "link", "ends": [[0, 0], [10, 20]]},
        {"op": "ground", "point": "O"},
        {"op": "link", "ends": ["A", [60, 40]]},
        {"op": "link", "ends": ["B", [60, 0]]},
        {"op": "ground", "point": "C"},
    ]
    links = [[*page.post("/draw", json=each).json()["sheet"]["links"]] for each in drawn]
    assert links[0] == ["link"] and {*links[1]} == {"crank", "ground"}
    assert {*links[2]} == {"crank", "ground", "link"} and {*links[3]} == {*links[2], "link_2"}
    assert {*links[4]} == {"crank", "ground", "coupler", "rocker"}
    turned = page.post("/draw", json={"op": "drive", "link": "rocker"}).json()["sheet"]
    assert turned["links"]["crank"] == ["B", "C"] and turned["drive"] == "crank"
    assert turned["links"]["rocker"] == ["O", "A"]
    page.post("/draw", json={"op": "rename", "link": "coupler", "to": "link_7"})
    kept = page.post("/draw", json={"op": "drive", "link": "rocker"}).json()["sheet"]["links"]
    assert {*kept} == {"crank", "ground", "link_7", "rocker"}

    spec = tmp_path / "typed.toml"
    spec.write_text(FOUR.replace("rocker", "link_2").replace("coupler", "link"))
    typed = client(Board(spec, tmp_path / "out"))
    typed.get("/")
    seen = typed.post("/draw", json={"op": "drive", "link": "link_2"}).json()["sheet"]
    assert {*seen["links"]} == {"ground", "crank", "link", "link_2"} and seen["drive"] == "link_2"


def test_a_four_bar_from_an_empty_sheet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As with the mouse: three links, two points on the ground, a point on the coupler, its path."""
    monkeypatch.chdir(tmp_path)
    page = client(Board(None, tmp_path / "out", Gallery({"walking-leg": LEG})))
    assert 'data-start="walking-leg"' in page.get("/").text
    assert page.post("/draw", json={"op": "output", "point": "A"}).status_code == 409
    assert page.post("/start", json={"name": "nothing"}).status_code == 409
    assert page.post("/start", json={"name": ["walking-leg"]}).status_code == 409
    assert page.post("/start", json={}).json()["ok"]
    done = [
        {"op": "link", "ends": [[0, 0], [10, 20]]},
        {"op": "link", "ends": ["A", [60, 40]]},
        {"op": "link", "ends": ["B", [60, 0]]},
        {"op": "ground", "point": "O"},
        {"op": "ground", "point": "C"},
        {"op": "point", "link": "coupler", "at": [30, 70]},
        {"op": "output", "point": "D"},
    ]
    answers = [page.post("/draw", json=each).json() for each in done]
    assert not answers[2]["ok"] and answers[2]["start"] is None and answers[2]["faults"]
    assert "degrees of freedom left over" in answers[3]["reason"], "drawn as drawn, and why"
    whole = answers[-1]
    assert {*whole["sheet"]["links"]} == {"ground", "crank", "coupler", "rocker"}
    assert whole["ok"] and whole["sheet"]["drive"] == "crank" and len(whole["paths"]["D"]) == 2 * 73
    assert page.post("/limits", json={}).json()["verdict"].endswith("hold")
    assert page.post("/save", json={}).json()["verdict"] == "saved in my-linkage.toml"
    assert read_mechanism(tmp_path / "my-linkage.toml").name == "my-linkage"
    assert 'href="gallery"' in page.get("/").text
    assert 'data-start="walking-leg"' in page.get("/gallery").text
    saved = (tmp_path / "my-linkage.toml").read_text(encoding="utf-8")
    assert page.post("/start", json={"name": "walking-leg"}).json()["ok"]
    assert page.post("/save", json={}).json()["verdict"] == "saved in walking-leg.toml"
    assert (tmp_path / "my-linkage.toml").read_text(encoding="utf-8") == saved
    undone = page.post("/undo", json={}).json()
    assert (undone["text"], undone["file"], undone["changed"]) == (saved, "my-linkage.toml", False)
    assert page.post("/save", json={}).json()["verdict"] == "saved in my-linkage.toml"
    assert read_mechanism(tmp_path / "walking-leg.toml").name == "walking-leg"
    other = client(Board(None, tmp_path / "out"))
    other.post("/start", json={})
    assert 'href="gallery"' not in other.get("/").text
    refused = other.post("/save", json={})
    assert refused.status_code == 409 and "is there already" in refused.json()["errors"][0]


def test_a_drag_shows_where_all_points_go_and_writes_nothing(tmp_path: Path) -> None:
    drawn = board(tmp_path, LEG)
    tried = drawn.draw({"op": "move", "points": {"C": [-40, -7]}, "try": True})
    assert drawn.text == LEG and not drawn.past
    other = read_mechanism(drawn.spec or "", ["points.C=[-40, -7]"])
    run = other.solve(np.radians([0, 90]), 0)["foot"]
    assert tried["start"]["P"] == pytest.approx([run[0].real, run[0].imag], abs=1e-9)
    assert tried["paths"]["P"][36:38] == pytest.approx([run[1].real, run[1].imag], abs=6e-4)
    follows = {"op": "move", "points": {"P": [-40, -95]}, "follow": True, "try": True}
    assert drawn.draw(follows)["start"]["P"] == pytest.approx([-40, -95], abs=0.05)
    held = drawn.draw({**follows, "follow": False})
    assert math.dist(held["start"]["P"], drawn.tables["points"]["P"]) < 0.02


def test_the_page_places_points_by_itself_where_circles_do_it(tmp_path: Path) -> None:
    """The leg in the order in which one draws it with compasses; a slide, or a shape that is balanced, is asked for."""
    chain = board(tmp_path, LEG).draw({"op": "move", "points": {}})["chain"]
    placed = {"O", "C", "A"}
    assert [step.point for step in chain["apexes"]] == ["B", "D", "E", "F", "P"]
    for step in chain["apexes"]:
        assert {step.a, step.b} <= placed
        placed.add(step.point)
    slid = board(tmp_path, starters.text("scotch-yoke")).draw({"op": "move", "points": {}})
    assert slid["chain"] is None and slid["start"]
    balanced = LEG.replace('"C-D" = 40.1', '# "C-D" = 40.1')
    assert board(tmp_path, balanced).draw({"op": "move", "points": {}})["chain"] is None


NEXT = (  # what a sheet lacks in the order of drawing, and what is done then
    ("Link", {"op": "link", "ends": [[0, 0], [10, 20]]}),
    ("Ground", {"op": "ground", "point": "O"}),
    ("Output", {"op": "output", "point": "A"}),
)


def test_a_path_is_drawn_as_far_as_the_drive_comes(tmp_path: Path) -> None:
    """A is 13 to 107 mm from C, and coupler and rocker span 14 to 94: two gaps, and one half of the turn is not reached."""
    seen = board(tmp_path).draw({"op": "length", "between": ["O", "A"], "value": 47})
    path = seen["paths"]["A"][::2]
    gaps = [k for k in range(len(path)) if path[k] is None]
    assert gaps and gaps == [*range(gaps[0], gaps[-1] + 1)], (
        "one gap: what lies between two is not reached"
    )


def test_an_empty_sheet_says_what_to_draw_next_and_nothing_is_wrong(tmp_path: Path) -> None:
    page = client(Board(None, tmp_path / "out"))
    page.post("/start", json={})
    for tool, done in NEXT:
        for path in ("preview", "build"):
            answer = page.post(f"/{path}", json={}).json()
            assert answer["wanted"] == answer["verdict"] and f"ake {tool}" in answer["wanted"], path
            assert answer["errors"] == []
        assert f"Take {tool}" in page.get("/").text
        seen = page.post("/draw", json=done).json()
    assert seen["wanted"] == "" and seen["ok"]


def test_what_does_not_close_is_drawn_as_drawn(tmp_path: Path) -> None:
    drawn = board(tmp_path)
    long = drawn.draw({"op": "length", "between": ["A", "B"], "value": 500})
    assert long["start"] is None and "contradict" in long["reason"] and not long["ok"]
    assert long["sheet"]["points"]["B"] == [60, 40]
    part = drawn.draw({"op": "length", "between": ["A", "B"], "value": 30})
    assert part["start"] and None in part["paths"]["B"] and part["reason"]
    odd = board(tmp_path, FOUR.replace("[60, 40]", '"far"').replace('"C"]     #', '"C", 7] #'))
    with pytest.raises(SpecError, match=r"points\.B"):
        odd.draw({"op": "move", "points": {"A": [1, 2]}})


def test_coordinates_without_effect_are_those_that_lengths_decide(tmp_path: Path) -> None:
    """Of Jansen's leg all but the two on the ground and the crank's direction; each is tried in the machine's own route."""
    drawn = board(tmp_path, LEG)
    keys = drawn.idle({})["idle"]
    assert keys == ["points.A.0", *(f"points.{point}.{k}" for point in "BDEFP" for k in (0, 1))]
    theta = np.radians([0.0, 100.0])
    before = read_mechanism(drawn.spec or "").solve(theta, 0)["foot"]
    for key in (*keys, "points.C.0", "points.A.1"):
        at, axis = key.split(".")[1:]
        value = drawn.tables["points"][at][int(axis)] + 0.2
        after = read_mechanism(drawn.spec or "", [f"{key}={value}"]).solve(theta, 0)["foot"]
        assert (float(np.abs(after - before).max()) < 1e-9) == (key in keys), key


CAM = """mechanism = "linkage"
name = "cam"
[points]
O = [0, 0]
A = [15, 0]
F = [50, 0]
P = [10, 30]
D = [-60, 0]
E = [-60, 15]
G = [0, -60]
H = [0, -100]
R = [0, -40]
T = [0, -50]
[links]
ground = ["O", "F", "D", "G", "H"]
crank = ["O", "A"]
arm = ["F", "P"]
wheel = ["D", "E"]
stem = ["R", "T"]
[[slide]]
link = "stem"
along = ["G", "H"]
[drive]
link = "crank"
speed_rpm = 30
[[output]]
name = "swing"
link = "arm"
[[output]]
name = "lift"
link = "stem"
[[output]]
name = "turn"
link = "wheel"
"""
DRAWN = (
    {"op": "cam", "cam": "crank", "point": "P"},
    {"op": "gear", "a": "crank", "b": "wheel"},
    {"op": "cam", "cam": "wheel", "point": "R"},
)


def test_gears_and_cams_that_are_drawn_hold_and_go_again(tmp_path: Path) -> None:
    """Each roller touches the outline that is shown, at each place of the turn: of a cam on the drive, and behind a gear."""
    drawn = board(tmp_path, CAM)
    for each in DRAWN[:2]:
        drawn.draw(each)
    last = drawn.draw({"op": "cam", "cam": "crank", "point": "R"})
    cams = drawn.idle({})["cams"]
    assert [each["link"] for each in cams] == ["crank", "crank"] and last["start"]
    for shown, row in zip(cams, last["sheet"]["cam"], strict=True):
        outline = np.array(shown["outline"]).reshape(-1, 2) @ [1, 1j]
        pivot = complex(*last["sheet"]["points"][shown["pivot"]])
        tip = np.array(last["paths"][row["at"]]).reshape(-1, 2) @ [1, 1j]
        for angle, at in zip(shown["angles"], tip, strict=True):
            corners = pivot + np.exp(1j * angle) * outline
            ends = np.roll(corners, -1) - corners
            share = np.clip(((at - corners) * ends.conj()).real / np.abs(ends) ** 2, 0, 1)
            assert np.abs(at - corners - share * ends).min() == pytest.approx(
                row["radius"], abs=0.06
            )
    machine = drawn.linkage
    assert machine is not None and machine.assembly.parts
    assert [each.code for each in machine.limits() if not each.ok] == []
    for each in (*DRAWN[:2], {"op": "cam", "cam": "crank", "point": "R"}):
        drawn.draw(each)
    assert tomllib.loads(drawn.text or "") == tomllib.loads(CAM)


def test_a_cam_behind_a_gear_turns_with_its_wheel(tmp_path: Path) -> None:
    drawn = board(tmp_path, CAM.replace("R = [0, -40]", "R = [-60, -40]"))
    for each in DRAWN:
        drawn.draw(each)
    _, cam = drawn.idle({})["cams"]
    assert cam["link"] == "wheel" and cam["angles"][-1] == pytest.approx(-math.tau, abs=1e-3)


def test_sliders_of_a_drawn_sheet_are_undone_like_all_else(tmp_path: Path) -> None:
    drawn = board(tmp_path)
    asked = {"op": "set", "settings": {"lengths.O-A": "20"}}
    assert drawn.draw({**asked, "try": True})["start"]["A"] == pytest.approx(
        [20 / math.sqrt(5), 40 / math.sqrt(5)]
    )
    seen = drawn.draw(asked)
    assert '"O-A" = 20              # crank' in seen["text"] and seen["undo"] and seen["changed"]
    assert not drawn.undo({})["changed"]
    with pytest.raises(SpecError):
        drawn.draw({"op": "set", "settings": {"name": "x"}})
    with pytest.raises(SpecError):
        drawn.draw({"op": "move", "points": 3, "try": True})


def test_a_file_changed_by_someone_else_is_not_overwritten_and_nothing_is_lost(
    tmp_path: Path,
) -> None:
    drawn = board(tmp_path)
    page = client(drawn)
    page.post("/draw", json={"op": "move", "points": {"B": [61, 40]}})
    mine = drawn.text
    (tmp_path / "bar.toml").write_text(FOUR + "# theirs\n", encoding="utf-8")
    refused = page.post("/save", json={})
    assert refused.status_code == 409 and "was changed since" in refused.json()["errors"][0]
    assert "# theirs" in page.get("/").text, "loaded anew"
    assert page.post("/undo", json={}).json()["text"] == mine
    assert page.post("/save", json={}).json()["ok"]
    assert (tmp_path / "bar.toml").read_text(encoding="utf-8") == mine


@pytest.mark.long
def test_a_build_of_what_is_drawn(tmp_path: Path) -> None:
    drawn = board(tmp_path)
    page = client(drawn)
    page.post("/draw", json={"op": "rename", "to": "drawn"})
    built = page.post("/build", json={}).json()
    assert built["folder"] == str(tmp_path / "out" / "drawn") and built["errors"] == []
    assert "MOTION_ERROR" in page.get("/out/report.html").text
    page.post("/draw", json={"op": "output", "point": "B"})
    assert "Nothing to build yet: take Output" in page.post("/build", json={}).json()["verdict"]
    page.post("/undo", json={})
    assert 'id="mechanism"' in page.post("/preview", json={"quick": True}).json()["page"]


def test_another_page_draws_nothing(tmp_path: Path) -> None:
    drawn = board(tmp_path)
    other = TestClient(
        drawn.app(WORD), base_url=f"{HOME}/{WORD}/", headers={"origin": "http://evil.example"}
    )
    for path in ("draw", "undo", "redo", "idle", "limits", "preview", "build", "save", "start"):
        assert other.post(f"/{path}", json={"op": "delete", "link": "crank"}).status_code == 403
    assert drawn.text == FOUR == (tmp_path / "bar.toml").read_text(encoding="utf-8")


def test_the_gallery_has_pictures_of_linkages_that_stand_alone() -> None:
    texts = {name: starters.text(name) for name in ("four-bar", "disc-cam", "stitch-head")}
    assert [*usable(texts)] == ["four-bar"]
    card = cards(Gallery(usable(texts)))
    assert card.count("<polyline") == 4 and "Hoeken" in card and "nan" not in card


@pytest.mark.long
def test_no_tile_of_the_gallery_is_empty_and_its_pictures_are_served(tmp_path: Path) -> None:
    """A linkage without rods, such as two wheels, has the gallery's own picture."""
    texts = {n: starters.text(n) for n in starters.examples()}
    page = TestClient(
        Board(None, tmp_path, Gallery(texts, starters.pictures())).app(WORD),
        base_url=f"{HOME}/{WORD}/",
    )
    answer = page.get("/")
    tiles = re.findall(r"<button data-start=\"([^\"]+)\">(.*?)</button>", answer.text)
    assert len(tiles) > 12 and "img-src 'self'" in answer.headers["content-security-policy"]
    for name, tile in tiles:
        if "<img" not in tile:
            lengths = [len(set(places.split())) for places in re.findall('points="([^"]*)"', tile)]
            assert max(lengths) > 1, name
            continue
        picture = page.get(f"/pictures/{name}.svg")
        assert picture.status_code == 200 and "<svg" in picture.text, name
    assert "<img" in dict(tiles)["elliptic-wheels"]
    assert page.get("/pictures/none.svg").status_code == 404


@pytest.mark.long
@pytest.mark.parametrize("name", [*usable({n: starters.text(n) for n in starters.examples()})])
def test_places_of_a_drag_are_those_of_the_machine(name: str) -> None:
    """By the quick way without closing the drawing, and by the mechanism's own."""
    made = changed(tomllib.loads(starters.text(name)), name, Path())
    assert isinstance(made, Linkage)
    theta = angles(made, 13)
    found = traces(made, theta)
    run = made.solve(theta, 0)
    for each in made.wanted:
        if each.point:
            assert np.abs(found[each.point] - run[each.name]).max() < 1e-9
    assert not [key for key in idle(made) if key.split(".")[0] not in made.points]
