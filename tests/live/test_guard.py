"""Who is let in by the pages of this machine, and what too much, too deep or too slow a request does to them."""

from __future__ import annotations

import asyncio
import json
import os
import shutil
import socket
import stat
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
import uvicorn
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from camgen.errors import SpecError
from camgen.live import guard
from camgen.live import run as live
from camgen.live.numbers import Number, numbers, overrides, write
from camgen.live.server import Explorer, LastBuild, watcher

HOME = "http://127.0.0.1:8000"
WORD = "a-word-of-chance"
ORIGIN = {"origin": HOME}


@pytest.fixture
def spec(root: Path, tmp_path: Path) -> Path:
    return Path(shutil.copy(root / "specs" / "disc-cam.toml", tmp_path / "cam.toml"))


@pytest.fixture
def page(spec: Path, tmp_path: Path) -> TestClient:
    return TestClient(Explorer(spec, tmp_path / "out").app(WORD), base_url=HOME, headers=ORIGIN)


# ---- the word --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "word", ["", "x", WORD[:-1], WORD + "x", WORD.upper(), "%61-word", "w\u00f6rd", "%ff%fe"]
)
@pytest.mark.parametrize(
    "path", ["", "live.js", "out/report.html", "preview", "save", "build", "state"]
)
def test_whoever_does_not_know_the_word_is_refused(
    spec: Path, tmp_path: Path, word: str, path: str
) -> None:
    before = spec.read_bytes()
    for app in (
        Explorer(spec, tmp_path / "out").app(WORD),
        watcher(LastBuild(spec, tmp_path / "out"), WORD),
    ):
        asking = TestClient(app, base_url=HOME, headers=ORIGIN)
        posted = asking.post(f"/{word}/{path}", json={"settings": {"geometry.base_radius": "24"}})
        for reply in (asking.get(f"/{word}/{path}"), posted):
            assert (
                reply.status_code == 403 and "cam.toml" not in reply.text and WORD not in reply.text
            )
    assert spec.read_bytes() == before and not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "host",
    [
        "127.0.0.1:8812.evil.com",
        "127.0.0.1:80@evil.com",
        "localhost:1@x",
        "localhost:",
        "127.0.0.1.evil.com",
        "127.0.0.1:",
        "127.0.0.1:\u0661",
        "evil.com",
        "",
    ],
)
def test_a_host_that_only_begins_as_this_machine_is_refused(page: TestClient, host: str) -> None:
    reply = page.get(f"/{WORD}/", headers={"host": host.encode()})
    assert reply.status_code == 403 and "for this machine alone" in reply.text


@pytest.mark.parametrize(
    "host", ["127.0.0.1", "localhost", "LOCALHOST", "127.0.0.1:8812", "localhost:80"]
)
def test_this_machine_is_let_in_by_its_names(page: TestClient, host: str) -> None:
    assert page.get(f"/{WORD}/", headers={"host": host}).status_code == 200


def test_whoever_knows_it_is_let_in_and_the_page_asks_below_it(page: TestClient) -> None:
    shown = page.get(f"/{WORD}/")
    assert shown.status_code == 200 and "cam.toml" in shown.text and WORD not in shown.text
    assert (
        'src="live.js"' in shown.text
        and 'href="live.css"' in shown.text
        and '"/' not in page.get(f"/{WORD}/live.js").text
    )
    assert (
        shown.headers["referrer-policy"] == "no-referrer"
        and shown.headers["cache-control"] == "no-store"
    )


def test_each_start_has_a_word_of_its_own() -> None:
    words = {guard.word() for _ in range(200)}
    assert len(words) == 200 and min(map(len, words)) >= 43  # 32 bytes


def test_words_are_compared_in_a_time_that_tells_nothing(
    page: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    compared = list[tuple[bytes, bytes]]()

    def seen(a: bytes, b: bytes) -> bool:
        compared.append((a, b))
        return False

    monkeypatch.setattr(guard.secrets, "compare_digest", seen)
    assert page.get(f"/{WORD}/").status_code == 403 and compared == [(WORD.encode(), WORD.encode())]


def test_no_socket_is_opened_to_anyone(page: TestClient) -> None:
    for path in (f"/{WORD}/", f"/{WORD}/state", "/"):
        with pytest.raises(WebSocketDisconnect), page.websocket_connect(path):
            pass


def test_a_browser_is_led_there_by_a_page_that_its_user_alone_can_read(
    spec: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other users see what programs are started with."""
    opened, said, found = list[str](), list[str](), list[tuple[str, int]]()
    protocols = list[int]()

    def served(server: uvicorn.Server, sockets: list[socket.socket]) -> None:
        end = time.monotonic() + 10
        while not opened and time.monotonic() < end:
            time.sleep(0.01)
        protocols.extend(each.proto for each in sockets)
        (way,) = tmp_path.glob(".camgen-*.html")
        found.append((way.read_text("utf-8"), stat.S_IMODE(way.stat().st_mode)))

    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.setattr(uvicorn.Server, "run", served)
    live.explore(spec, tmp_path / "out", 0, True, said.append)
    address = said[0].split()[0]
    word = address.rstrip("/").rpartition("/")[2]
    assert len(word) >= 43 and word not in opened[0] and opened[0].startswith("file://")
    ((text, mode),) = found
    assert f"url={address}" in text and (os.name != "posix" or mode == 0o600)
    assert not list(tmp_path.glob(".camgen-*"))
    assert protocols == [socket.IPPROTO_TCP], "of these alone asyncio lets no answer wait"


# ---- too much, too deep ----------------------------------------------------------------------------------------------


def chunks(size: int) -> Iterator[bytes]:
    yield b'{"settings": {}, "x": "'
    for _ in range(size // 1000):
        yield b"x" * 1000
    yield b'"}'


def test_a_body_in_chunks_is_bounded_too(page: TestClient) -> None:
    assert page.post(f"/{WORD}/preview", content=chunks(50_000)).status_code == 200
    long = page.post(f"/{WORD}/preview", content=chunks(200_000))
    assert long.status_code == 413 and "100000 bytes" in long.text


DEEP = [b"[" * 90_000, b'{"a":' * 19_000, b'{"settings":' + b"[" * 90_000]
ODD = [*DEEP, b"9" * 90_000, b"\xff\xfe", b"", b'"\\ud800"', b"nul", b"[]"]


@pytest.mark.parametrize("body", ODD, ids=range(len(ODD)))
def test_what_is_no_json_is_said(
    page: TestClient, body: bytes, capfd: pytest.CaptureFixture[str]
) -> None:
    for path in ("preview", "save", "build"):
        reply = page.post(f"/{WORD}/{path}", content=body)
        assert reply.status_code == 400 and reply.json()["verdict"] == "no valid request"
    assert "Traceback" not in "".join(capfd.readouterr())


@pytest.mark.parametrize(
    "settings",
    [
        {"\ud800": "1"},
        {"geometry.base_radius": "\ud800"},
        {"geometry.base_radius": 3},
        {"geometry.base_radius": None},
        {str(k): "1" for k in range(6_000)},
        {"x" * 90_000: "1"},
        [],
        "x",
        {"geometry.base_radius": "[" * 90},
        {"segment.0.law": '{ name = "table", file = "/etc/passwd" }'},
        {"geometry.base_radius": '"/etc/passwd"'},
        {"segment.0.law": "no-such-law"},
    ],
    ids=range(12),
)
def test_odd_settings_are_refused_in_words(
    page: TestClient, settings: object, capfd: pytest.CaptureFixture[str]
) -> None:
    began = time.perf_counter()
    for path in ("preview", "save", "build"):
        reply = page.post(f"/{WORD}/{path}", content=json.dumps({"settings": settings}))
        assert (
            reply.status_code == 409
            and reply.json()["verdict"] == "not taken"
            and len(reply.text) < 10_000
        )
        assert "root:" not in reply.text
    assert "Traceback" not in "".join(capfd.readouterr()) and time.perf_counter() - began < 30


def test_a_value_is_a_number_or_one_of_the_words_to_choose_from() -> None:
    root = {
        "properties": {"a": {"type": "number"}, "b": {"type": "string", "enum": ["flat", "knife"]}}
    }
    known = numbers({"a": 1.0, "b": "flat"}, root)
    assert overrides({"a": "-2.5e-3", "b": "knife"}, known) == ["a=-2.5e-3", "b=knife"]
    for text in ("{x = 1}", "[1]", "'x'", "1 # x", " ", "a/b", "1\n"):
        with pytest.raises(SpecError, match="a number or a word"):
            overrides({"a": text}, known)
    for text, right in (
        ("2,5", "a decimal point, not a comma: 2.5"),
        ("2,5 mm", "a decimal point, not a comma: 2.5"),
        ("25 mm", "a number without a unit: 25"),
        ("1 in", "a number, in mm"),
    ):
        with pytest.raises(SpecError, match=f"A y: {text} - expected {right}"):
            overrides({"points.A.1": text}, [Number("points.A.1", 1.0, unit="mm")])
    for wrong in ({"b": "round"}, {"a": "1", "b": "flat", "c": "1"}):
        with pytest.raises(SpecError):
            overrides(wrong, known)


def test_a_fault_of_ours_is_told_without_a_traceback(
    spec: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(Explorer, "preview", broken)
    page = TestClient(Explorer(spec, tmp_path / "out").app(WORD), base_url=HOME, headers=ORIGIN)
    reply = page.post(f"/{WORD}/preview", json={"settings": {}})
    assert (
        reply.status_code == 500
        and reply.json()["verdict"] == "internal error"
        and "ZeroDivisionError" in reply.text
    )
    assert "Traceback" not in "".join(capfd.readouterr())


def test_a_link_that_waits_where_a_spec_is_written_is_not_followed(
    spec: Path, tmp_path: Path
) -> None:
    (other := tmp_path / "other.txt").write_text("mine", encoding="utf-8")
    (tmp_path / ".cam.toml.part").symlink_to(other)
    os.chmod(spec, 0o640)
    write(spec, "name = 'x'\n")
    assert spec.read_text("utf-8") == "name = 'x'\n" and other.read_text("utf-8") == "mine"
    assert os.name != "posix" or stat.S_IMODE(spec.stat().st_mode) == 0o640
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        ".cam.toml.part",
        "cam.toml",
        "other.txt",
    ]


# ---- by real connections ---------------------------------------------------------------------------------------------


@contextmanager
def served(spec: Path, out: Path) -> Iterator[int]:
    """The page on a port of this machine, as `explore` serves it."""
    config = uvicorn.Config(
        Explorer(spec, out).app(WORD),
        http=guard.Few,
        ws="none",
        log_level="error",
        access_log=False,
    )
    server = uvicorn.Server(config)
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        place.listen()
        thread = threading.Thread(target=lambda: asyncio.run(server.serve(sockets=[place])))
        thread.start()
        try:
            yield place.getsockname()[1]
        finally:
            server.should_exit = True
            thread.join()


def answer(
    port: int, request: bytes, more: Callable[[socket.socket], None] = lambda way: None
) -> bytes:
    """All that is sent back until the connection ends."""
    with closing(socket.create_connection(("127.0.0.1", port), 10)) as way:
        found = b""
        with suppress(ConnectionError, BrokenPipeError):
            way.sendall(request.replace(b"HERE", b"127.0.0.1:%d" % port))
            more(way)
        with suppress(ConnectionError):
            while piece := way.recv(65536):
                found += piece
        return found


GET = b"GET /%s HTTP/1.1\r\nHost: HERE\r\nConnection: close\r\n\r\n"
POST = b"POST /%s/preview HTTP/1.1\r\nHost: HERE\r\nOrigin: http://HERE\r\nConnection: close\r\n%s\r\n\r\n"


def test_odd_requests_leave_the_server_as_it_was(
    spec: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    def endless(way: socket.socket) -> None:
        for _ in range(400):
            way.sendall(b"3e8\r\n" + b"x" * 1000 + b"\r\n")

    good, word = GET % (WORD.encode() + b"/"), WORD.encode()
    with served(spec, tmp_path / "out") as port:
        assert answer(port, good).startswith(b"HTTP/1.1 200")
        assert (
            b" 413 "
            in answer(port, POST % (word, b"Transfer-Encoding: chunked"), endless).splitlines()[0]
        )
        assert b" 413 " in answer(port, POST % (word, b"Content-Length: 999999999999"))
        assert (
            b" 403 "
            in answer(port, POST % (b"x", b"Transfer-Encoding: chunked"), endless).splitlines()[0]
        )
        assert b" 400 " in answer(port, POST % (word, b"Content-Length: +5"))
        assert b" 403 " in answer(port, good.replace(b"Host: HERE", b"Host: evil.example"))
        assert b" 400 " in answer(
            port, good.replace(b"Host: HERE", b"Host: HERE\r\nHost: evil.example")
        )
        assert b" 404 " in answer(port, GET % (word + b"/out/../../cam.toml")).splitlines()[0]
        assert b" 40" in answer(port, GET % (word + b"/" + b"x" * 70_000))
        assert b" 40" in answer(
            port, good.replace(b"Connection", b"X: " + b"y" * 3_000_000 + b"\r\nConnection")
        )
        upgrade = b"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: eA==\r\n\r\n"
        assert b" 101 " not in answer(
            port, (GET % b"x/").replace(b"Connection: close\r\n\r\n", upgrade)
        )
        assert answer(port, b"\x16\x03\x01 no http\r\n\r\n").startswith(b"HTTP/1.1 400")
        assert answer(port, good).startswith(b"HTTP/1.1 200")
    assert "Traceback" not in "".join(capfd.readouterr())


def test_many_that_say_nothing_or_little_are_left(
    spec: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(guard, "_PATIENCE", 1.0)
    monkeypatch.setattr(guard, "_CONNECTIONS", 20)
    good = GET % (WORD.encode() + b"/")
    with served(spec, tmp_path / "out") as port:
        ways = list[Any]()
        for k in range(60):
            ways.append(way := socket.create_connection(("127.0.0.1", port), 10))
            with suppress(ConnectionError):
                way.sendall(b"GET / HT" if k % 2 else b"")
        ended = 0
        for way in ways:
            with suppress(ConnectionError):
                assert way.recv(1) == b""
            ended += 1
            way.close()
        assert ended == 60 and answer(port, good).startswith(b"HTTP/1.1 200")
    assert "Traceback" not in "".join(capfd.readouterr())
