"""Pages while a spec is written: what a slider may change, what is saved, who is let in, what a save sets off."""

from __future__ import annotations

import builtins
import re
import shutil
import socket
import threading
import time
import tomllib
from pathlib import Path
from typing import Any

import pytest
from starlette.applications import Starlette
from starlette.testclient import TestClient

from camgen import reading
from camgen.cli import main
from camgen.edits import edited
from camgen.errors import SpecError
from camgen.live import run as live
from camgen.live.numbers import numbers, overrides
from camgen.live.server import Explorer, LastBuild, watcher
from camgen.machines import load
from camgen.machines.sources import files_of
from camgen.settings import override
from camgen.spec import schema
from camgen.starters import examples, folder

HOME = "http://127.0.0.1:8000"
WORD = "a-word-of-chance"


@pytest.fixture
def spec(root: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(root / "specs" / "disc-cam.toml", tmp_path / "cam.toml"))


def client(app: Starlette, home: str = HOME, origin: str | None = HOME) -> TestClient:
    return TestClient(
        app, base_url=f"{home}/{WORD}/", headers={} if origin is None else {"origin": origin}
    )


@pytest.fixture
def page(spec: Path, tmp_path: Path) -> TestClient:
    return client(Explorer(spec, tmp_path / "out").app(WORD))


def asked(page: TestClient, path: str, **settings: str) -> dict[str, Any]:
    reply = page.post(
        path, json={"settings": {key.replace("__", "."): text for key, text in settings.items()}}
    )
    return {"status": reply.status_code, **reply.json()}


# ---- numbers ---------------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("path", sorted(folder().rglob("*.toml")), ids=lambda path: path.stem)
def test_every_number_lies_on_its_slider_and_every_spec_comes_back_as_it_was(path: Path) -> None:
    text, data = path.read_text(encoding="utf-8"), reading.read(path)
    listed = numbers(data, schema(load(data["mechanism"]), data["mechanism"]))
    assert len(listed) >= 3
    for number in listed:
        if number.choices:
            assert (
                str(number.value).lower() if isinstance(number.value, bool) else str(number.value)
            ) in number.choices
        else:
            assert (
                isinstance(number.value, int | float)
                and number.low <= number.value <= number.high
                and number.step > 0
            )
    assert edited(text, []) == text
    settings = [f"{number.key}={number.value!r}" for number in listed if not number.choices]
    assert edited(text, settings) == text
    assert tomllib.loads(edited(text, [f"{settings[0].partition('=')[0]}=123.5"])) == override(
        tomllib.loads(text), f"{settings[0].partition('=')[0]}=123.5"
    )


def test_examples_are_among_them() -> None:
    assert "walking-leg" in examples()


def test_ranges_are_those_of_the_schema() -> None:
    root = {
        "properties": {
            "share": {"type": "number", "exclusiveMinimum": 0, "maximum": 1},
            "long": {"type": "number", "minimum": 2, "maximum": 1e6},
            "count": {"type": "integer", "minimum": 1},
            "way": {"type": "number", "unit": "deg"},
            "points": {"type": "array", "items": {"type": "number"}},
        }
    }
    found = numbers({"share": 0.5, "long": 30, "count": 3, "way": 0, "points": [1.0] * 13}, root)
    assert [(n.key, n.low, n.high, n.step) for n in found] == [
        ("share", 0.01, 1, 0.01),
        ("long", 2, 60, 0.1),
        ("count", 1, 6, 1),
        ("way", -30, 30, 0.1),
    ]


@pytest.mark.parametrize("motion, unit", [("oscillating", "deg"), ("translating", "mm")])
def test_a_lift_is_in_the_unit_of_its_follower(root: Path, motion: str, unit: str) -> None:
    data = reading.read(root / "specs" / "disc-cam.toml")
    data["geometry"]["follower"]["motion"] = motion
    found = {each.key: each for each in numbers(data, schema(load("disc-cam"), "disc-cam"))}
    assert found["segment.0.lift"].unit == unit and found["geometry.base_radius"].unit == "mm"
    data["geometry"]["follower"].pop("motion")
    found = {each.key: each for each in numbers(data, schema(load("disc-cam"), "disc-cam"))}
    assert found["segment.0.lift"].unit == "mm or deg"


def test_values_that_are_one_of_a_few_are_chosen() -> None:
    root = {
        "properties": {
            "branch": {"type": "integer", "enum": [1, -1]},
            "shape": {"type": "string", "enum": ["flat", "knife"]},
            "step": {"type": "boolean"},
            "name": {"type": "string"},
        }
    }
    found = numbers({"branch": 1, "shape": "flat", "step": True, "name": "x"}, root)
    assert [(n.key, list(n.choices)) for n in found] == [
        ("branch", ["1", "-1"]),
        ("shape", ["flat", "knife"]),
        ("step", ["false", "true"]),
    ]
    assert (
        edited("branch = 1  # way\n", overrides({"branch": "-1"}, found)) == "branch = -1 # way\n"
    )


def test_comments_and_columns_stay() -> None:
    text = 'a = 1      # first\n\n[[b]]  # table\nc = [1, 2] # pair\n\n[b.d]\n"x-y" = { e = 2.0 }   # last\n'
    expected = 'a = 12.5   # first\n\n[[b]]  # table\nc = [1, 7] # pair\n\n[b.d]\n"x-y" = { e = 3 }   # last\n'
    assert edited(text, ["a=12.5", "b.0.c.1=7", "b.0.d.x-y.e=3"]) == expected
    assert edited(
        text.replace("\n", "\r\n"), ["a=12.5", "b.0.c.1=7", "b.0.d.x-y.e=3"]
    ) == expected.replace("\n", "\r\n")


@pytest.mark.parametrize(
    "settings", [[], {"c": "1"}, {"a": ""}, {"a": 1}, {"a": "1\nb = 2"}, {"a": "1" * 101}]
)
def test_a_page_may_set_known_keys_to_short_values_alone(settings: object) -> None:
    known = numbers({"a": 1.0}, {"properties": {"a": {"type": "number"}}})
    assert overrides({"a": "2"}, known) == ["a=2"]
    with pytest.raises(SpecError):
        overrides(settings, known)


# ---- explore ---------------------------------------------------------------------------------------------------------


def test_a_preview_shows_how_each_output_moves(root: Path, tmp_path: Path) -> None:
    """Of a slide on a lever as of a cam's own follower; the quick answer leaves curves for later."""
    explorer = Explorer(root / "specs" / "linkage.toml", tmp_path / "out")
    page = explorer.preview({"settings": {}})["page"]
    assert (
        page.index("<figcaption>Swing<") < page.index("<figcaption>Transmission angle<")
        and "mm/rad" not in page
    )
    assert "<figcaption>" not in explorer.preview({"settings": {}, "quick": True})["page"]
    disc = Explorer(root / "specs" / "disc-cam.toml", tmp_path / "out").preview({"settings": {}})[
        "page"
    ]
    assert "<figcaption>Lift<" in disc and "mm/rad" in disc


def test_a_move_gives_the_report_of_that_variant(page: TestClient) -> None:
    first, small = (
        asked(page, "/preview"),
        asked(page, "/preview", geometry__base_radius="10", geometry__follower__radius="4"),
    )
    assert first["ok"] and 'id="mechanism"' in first["page"]
    assert first["verdict"] == "All 5 findings hold"
    assert not small["ok"] and "PRESSURE_ANGLE" in small["page"] and small["page"] != first["page"]
    assert "at most 30" in first["page"]


def test_a_preview_says_what_a_sweep_says_of_bore_and_hub(page: TestClient) -> None:
    wide = asked(page, "/preview", parts__hub_diameter="80")
    assert wide["verdict"] == "cannot be made" and "parts.hub_diameter" in wide["errors"][0]


def test_a_quick_answer_has_verdict_and_picture_without_the_study(page: TestClient) -> None:
    whole, quick = (
        page.post("/preview", json={"settings": {}, "quick": quick}).json()
        for quick in (False, True)
    )
    assert quick["verdict"] == whole["verdict"] and 'id="mechanism"' in quick["page"]
    assert 'class="plot' in whole["page"] and 'class="plot' not in quick["page"]


def test_what_is_no_spec_or_no_machine_is_said(page: TestClient) -> None:
    wrong = asked(page, "/preview", geometry__base_radius="many")
    assert wrong["verdict"] == "not taken" and wrong["errors"] == [
        "geometry.base_radius: many - expected a number, in mm"
    ]
    other = asked(page, "/preview", name="other")
    assert (other["status"], other["ok"]) == (409, False) and "settings" in other["errors"][0]
    assert page.post("/preview", content=b"[1]").status_code == 400
    assert page.post("/preview", content=b"{").status_code == 400


def test_saved_with_comments_kept_and_nothing_else_written(
    page: TestClient, spec: Path, tmp_path: Path
) -> None:
    before = spec.read_text(encoding="utf-8")
    assert asked(page, "/save", geometry__base_radius="24.5")["ok"]
    after = spec.read_text(encoding="utf-8")
    changed = [
        (a, b) for a, b in zip(before.splitlines(), after.splitlines(), strict=True) if a != b
    ]
    (line,) = (line for line in before.splitlines() if line.startswith("base_radius = 25"))
    assert changed == [(line, line.replace("25  ", "24.5", 1))]
    assert [path.name for path in tmp_path.iterdir()] == ["cam.toml"]
    assert '"value": 24.5' in page.get("/").text
    assert (
        asked(page, "/save", geometry__base_radius="-3")["status"] == 409
        and spec.read_text(encoding="utf-8") == after
    )


def test_a_spec_changed_by_someone_else_is_not_overwritten(page: TestClient, spec: Path) -> None:
    text = spec.read_text(encoding="utf-8") + "# mine\n"
    spec.write_text(text, encoding="utf-8")
    for path in ("/save", "/build"):
        refused = asked(page, path, geometry__base_radius="24")
        assert refused["status"] == 409 and "was changed since" in refused["errors"][0]
    assert spec.read_text(encoding="utf-8") == text
    page.get("/")  # loaded anew
    assert asked(page, "/save", geometry__base_radius="24")["ok"] and spec.read_text(
        encoding="utf-8"
    ).endswith("# mine\n")


@pytest.mark.long
def test_a_full_build_is_made_and_served(page: TestClient, spec: Path, tmp_path: Path) -> None:
    assert page.get("/out/report.html").status_code == 404
    built = asked(page, "/build", geometry__base_radius="26")
    assert built["folder"] == str(tmp_path / "out" / "disc-cam") and built["errors"] == []
    assert "MOTION_ERROR" in page.get("/out/report.html").text
    assert (
        page.get("/out/disc-cam-cam.dxf").content
        == (tmp_path / "out" / "disc-cam" / "disc-cam-cam.dxf").read_bytes()
    )
    for path in (
        "/out/%2e%2e/%2e%2e/cam.toml",
        "/out/..%2f..%2fcam.toml",
        "/out//etc/passwd",
        "/out/%00",
        "/out/a" + "b" * 5000,
    ):
        assert page.get(path).status_code == 404, path
    assert (
        page.get("/out/../../cam.toml").status_code == 403
    )  # as a browser asks it: without the word
    (tmp_path / "out" / "disc-cam" / "way-out.txt").symlink_to(spec)
    assert page.get("/out/way-out.txt").status_code == 404
    shutil.rmtree(tmp_path / "out")
    assert page.get("/out/report.html").status_code == 404


def test_script_and_style_are_served(page: TestClient) -> None:
    assert page.get("/live.js").headers["content-type"].startswith("text/javascript")
    assert page.get("/live.css").headers["content-type"].startswith("text/css")
    assert "frame-ancestors 'self'" in page.get("/").headers["content-security-policy"]


# ---- who is let in ---------------------------------------------------------------------------------------------------


OTHERS = [
    "evil.example",
    "evil.example:8000",
    "127.0.0.1.evil.example:8000",
    "",
    "10.0.0.1:8000",
    "[::1]:8000",
]


@pytest.mark.parametrize("host", OTHERS)
def test_another_host_is_refused(page: TestClient, host: str) -> None:
    posted = page.post("/save", json={}, headers={"host": host, "origin": f"http://{host}"})
    for reply in (page.get("/", headers={"host": host}), posted):
        assert reply.status_code == 403 and "cam.toml" not in reply.text


ELSEWHERE = [
    "null",
    "http://evil.example",
    "http://127.0.0.1:9000",
    "http://localhost:8000",
    "https://127.0.0.1:8000",
]


@pytest.mark.parametrize("origin", [None, *ELSEWHERE])
def test_a_post_of_another_page_is_refused(spec: Path, tmp_path: Path, origin: str | None) -> None:
    before = spec.read_bytes()
    page = client(Explorer(spec, tmp_path / "out").app(WORD), origin=origin)
    for path in ("/preview", "/build", "/save"):
        assert (
            page.post(path, json={"settings": {"geometry.base_radius": "24"}}).status_code == 403
        ), path
    assert spec.read_bytes() == before and not (tmp_path / "out").exists()


def test_localhost_is_this_machine_and_a_long_request_is_refused(
    spec: Path, tmp_path: Path
) -> None:
    near = "http://localhost:8000"
    page = client(Explorer(spec, tmp_path / "out").app(WORD), near, near)
    assert asked(page, "/preview")["ok"]
    assert page.post("/preview", content=b" " * 200_000).status_code == 413


# ---- watch -----------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_a_save_builds_anew_and_an_error_is_shown(spec: Path, tmp_path: Path) -> None:
    text = spec.read_text(encoding="utf-8")
    spec.write_text(text.replace("# bearing_life_h = 1000", "bearing_life_h = 1000"), "utf-8")
    built, ended, said = LastBuild(spec, tmp_path / "out"), threading.Event(), list[str]()
    page = client(watcher(built, WORD))
    thread = threading.Thread(target=live.rebuild, args=(built, said.append, ended))

    def after(number: int) -> dict[str, Any]:
        end = time.monotonic() + 120
        while True:
            state: dict[str, Any] = page.post("/state", json={}).json()
            if state["number"] >= number and "verdict" in state:
                return state
            assert time.monotonic() < end, state
            time.sleep(0.05)

    thread.start()
    try:
        state = after(1)
        assert state["folder"] == str(tmp_path / "out" / "disc-cam")
        assert state["ok"] and state["open"] and "NOT JUDGED: BEARING_LIFE" in state["verdict"]
        first = page.get("/out/report.html").text
        new = tmp_path / "new"  # as editors do: a new file takes the old one's place
        new.write_text(
            spec.read_text(encoding="utf-8").replace("base_radius = 25", "base_radius = 27"),
            encoding="utf-8",
        )
        new.replace(spec)
        assert after(2)["errors"] == [] and page.get("/out/report.html").text != first
        second = page.get("/out/report.html").text
        spec.write_text("mechanism = 'disc-cam'\nname = ", encoding="utf-8")
        wrong = after(3)
        assert wrong["verdict"] == "no valid spec" and "line 2" in wrong["errors"][0]
        assert page.get("/out/report.html").text == second
        time.sleep(3 * live._EVERY)
        assert built.number == 3, "nothing changed, nothing is built"
    finally:
        ended.set()
        thread.join()
    assert len([line for line in said if re.match(r"\d\d:\d\d:\d\d  ", line)]) == 3


def test_files_that_are_none_of_a_spec_are_not_looked_at(spec: Path) -> None:
    before = live.states_of(files_of(spec))
    for name in (".cam.toml.swp", "other.toml", "cam.toml~", "picture.png", "rise.csv"):
        spec.with_name(name).write_text("x", encoding="utf-8")
    assert live.states_of(files_of(spec)) == before and set(before) == {spec}


@pytest.mark.long
def test_a_file_that_the_spec_names_sets_off_a_build_and_no_other_one(tmp_path: Path) -> None:
    """The table of an included spec's law, which comes later, and a file beside it that nothing names."""
    (spec := tmp_path / "whole.toml").write_text(
        '[[include]]\nspec = "other/cam.toml"\n', encoding="utf-8"
    )
    (inner := tmp_path / "other").mkdir()
    (inner / "cam.toml").write_text(
        '[[segment]]\nlaw = { name = "table", file = "rise.csv" }\n', encoding="utf-8"
    )
    assert files_of(spec) == [spec, inner / "cam.toml", inner / "rise.csv"]

    class Counted(LastBuild):
        def build(self, settings: list[str]) -> dict[str, Any]:
            self.number += 1
            return {"verdict": str(self.number), "errors": []}

    built, ended = Counted(spec, tmp_path / "out"), threading.Event()
    thread = threading.Thread(target=live.rebuild, args=(built, lambda text: None, ended))

    def after(number: int) -> bool:
        end = time.monotonic() + 30
        while built.number < number and time.monotonic() < end:
            time.sleep(0.02)
        time.sleep(4 * live._EVERY)
        return built.number == number

    thread.start()
    try:
        assert after(1)
        (inner / "notes.csv").write_text("x", encoding="utf-8")
        (tmp_path / "other.toml").write_text("x", encoding="utf-8")
        assert after(1)
        (inner / "rise.csv").write_text("0,0\n1,1\n", encoding="utf-8")
        assert after(2)
        (inner / "cam.toml").write_text("name = 'x'\n", encoding="utf-8")
        assert after(3)
        (inner / "rise.csv").write_text("0,0\n2,1\n", encoding="utf-8")  # named no more
        assert after(3)
    finally:
        ended.set()
        thread.join()


@pytest.mark.parametrize("command", ["watch", "explore"])
def test_without_the_extra_its_name_is_told(
    command: str, spec: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name == "uvicorn":
            raise ImportError(name="uvicorn")
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(SystemExit) as done:
        main([command, str(spec)])
    assert done.value.code == 4
    assert re.search(r'needs uvicorn: (\S+ -m )?pip install ".+\[live\]"', capsys.readouterr().err)


@pytest.mark.parametrize("command", ["watch", "explore"])
def test_a_missing_spec_and_a_taken_port_are_told(
    command: str, spec: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as done:
        main([command, str(spec.with_name("none.toml"))])
    assert done.value.code == 4 and "none.toml" in capsys.readouterr().err
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(SystemExit) as done:
            main([command, str(spec), "--port", str(taken.getsockname()[1])])
    assert done.value.code == 4 and "choose another --port" in capsys.readouterr().err
