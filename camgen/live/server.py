"""Pages on 127.0.0.1: a spec with sliders, and the report of its last build. Who is let in: see `guard`."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable, Mapping
from functools import partial
from hashlib import sha256
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from threading import Lock
from typing import Any

from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import BaseRoute, Mount, Route
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Receive, Scope, Send

from camgen import reading
from camgen import spec as specs
from camgen.bounds import read_bytes
from camgen.edits import edited
from camgen.errors import CamgenError, DesignError, Fault, FileError, SpecError, explained
from camgen.live.guard import OnlyHere
from camgen.live.numbers import Number, Refusal, numbers, overrides, write
from camgen.live.preview import failure, preview
from camgen.machines import MECHANISMS, load
from camgen.machines.mechanism import Mechanism
from camgen.machines.sources import changed, read_tables
from camgen.pipeline.build import KINDS, build

_POLICY = (
    "default-src 'none'; img-src 'self' data:; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; connect-src 'self'; "
    "frame-src 'self'; frame-ancestors 'self'"
)

_FILES = {
    "live.js": "javascript",
    "apexes.js": "javascript",
    "draw.js": "javascript",
    "live.css": "css",
}

Answer = dict[str, Any]


class LastBuild:
    """Builds of one spec into OUT, one at a time; `folder` is that of the last, `number` counts them."""

    def __init__(self, spec: Path, out: Path) -> None:
        self.spec = spec
        self.out = out
        self.folder: Path | None = None
        self.number = 0
        self.answer = Answer(building=True)
        self.lock = Lock()

    def build(self, settings: list[str], made: Mechanism | None = None) -> Answer:
        """Build it with some keys set anew, or what was made of it; the answer has its verdict, or why there is none."""
        with self.lock:
            self.answer = Answer(building=True)
            try:
                report = build(made or self.spec, self.out, frozenset(KINDS), settings)
                assert report.folder is not None, "a build writes a folder"
                self.folder = Path(report.folder)
                verdict = report.verdict
                open_ = bool(report.not_judged)
                self.answer = Answer(
                    ok=report.ok, open=open_, verdict=verdict, errors=[], folder=str(self.folder)
                )
            except (CamgenError, OSError) as error:
                self.answer = reasons(explained(error))
            except Exception as error:  # a fault of ours is told, and does not end the watch
                self.answer = failure(
                    "internal error",
                    [f"{type(error).__name__}: {error}; please report it with the spec"],
                )
            self.number += 1
        return self.answer

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a file of the last build."""
        folder = self.folder
        there = folder is not None and folder.is_dir()
        app: ASGIApp = (
            StaticFiles(directory=folder) if there else PlainTextResponse("nothing is built", 404)
        )
        await app(scope, receive, send)


def reasons(error: CamgenError) -> Answer:
    """The answer that stands for an error."""
    if isinstance(error, Refusal):
        return failure("not taken", [str(fault) for fault in error.faults])
    if isinstance(error, SpecError):
        return failure("no valid spec", [str(fault) for fault in error.faults])
    return failure(
        "cannot be made" if isinstance(error, DesignError) else "cannot be read or written",
        [str(error)],
    )


class Explorer:
    """A spec with sliders: its file as it was read, previews of variants, and what is written back."""

    def __init__(self, spec: Path, out: Path) -> None:
        self.spec = spec
        self.last_build = LastBuild(spec, out)
        self.lock = Lock()
        self.read()

    def read(self) -> None:
        """Take the spec as its file has it now."""
        raw = read_bytes(self.spec, reading.SPEC_FILE)
        self.data, self.source, self.folder = read_tables(self.spec)
        self.digest = sha256(raw).hexdigest()
        kind = specs.choose(self.data, MECHANISMS, self.source)
        self.numbers: list[Number] = numbers(
            reading.read(self.spec), specs.schema(load(kind), kind)
        )

    def preview(self, request: Answer) -> Answer:
        """A variant's page; quick: without what takes long."""
        with self.lock:
            return preview(
                self.data,
                self.source,
                self.folder,
                self._settings(request),
                request.get("quick") is True,
            )

    def build(self, request: Answer) -> Answer:
        """All files of a variant."""
        self._unchanged_text()
        return self.last_build.build(self._settings(request))

    def save(self, request: Answer) -> Answer:
        """Write a variant's values into the spec, which has to be as it was read."""
        with self.lock:
            settings = self._settings(request)
            changed(self.data, self.source, self.folder, settings)
            raw = self._unchanged_text()
            write(self.spec, edited(raw.decode("utf-8-sig"), settings))
            self.read()
        return Answer(ok=True, verdict=f"saved in {self.spec.name}", errors=[])

    def _settings(self, request: Answer) -> list[str]:
        return overrides(request.get("settings"), self.numbers)

    def _unchanged_text(self) -> bytes:
        raw = read_bytes(self.spec, reading.SPEC_FILE)
        if sha256(raw).hexdigest() != self.digest:
            raise FileError(
                self.spec,
                "was changed since this page read it; reload the page to see the new values",
            )
        return raw

    def page(self) -> str:
        """The page, of the spec as it is now."""
        with self.lock:
            self.read()
        numbers = [vars(number) for number in self.numbers]
        return _page(
            "explore.html",
            self.spec,
            data=json.dumps(numbers, ensure_ascii=False).replace("<", "\\u003c"),
        )

    def app(self, word: str) -> Starlette:
        """What serves it, below the word."""
        return served(
            word,
            {"/": self.page},
            self.last_build,
            {"/preview": self.preview, "/build": self.build, "/save": self.save},
        )


def watcher(last_build: LastBuild, word: str) -> Starlette:
    """What serves the report of a spec's last build, below the word, and says when there is a new one."""

    def state(_request: Answer) -> Answer:
        return {"number": last_build.number, **last_build.answer}

    return served(
        word, {"/": partial(_page, "watch.html", last_build.spec)}, last_build, {"/state": state}
    )


def _page(file: str, spec: Path, **more: str) -> str:
    return Template(asset(file)).substitute(name=escape(spec.name), **more)


def asset(file: str) -> str:
    """A page, script or style of ours."""
    return files("camgen.live").joinpath(file).read_text(encoding="utf-8")


def served(
    word: str,
    pages: Mapping[str, Callable[[], str]],
    last_build: LastBuild,
    answers: Mapping[str, Callable[[Answer], Answer]],
    pictures: Path | None = None,
) -> Starlette:
    """Pages, their scripts and style, the files of the last build, pictures of a folder, and what the pages ask for: JSON to JSON."""
    routes: list[BaseRoute] = [Mount("/out", app=last_build)]
    if pictures is not None:
        routes.append(Mount("/pictures", app=StaticFiles(directory=pictures)))
    routes += [Route(path, _showing(page)) for path, page in pages.items()]
    routes += [
        Route(f"/{file}", Response(asset(file), media_type=f"text/{kind}"))
        for file, kind in _FILES.items()
    ]
    routes += [Route(path, _answering(reply), methods=["POST"]) for path, reply in answers.items()]
    return Starlette(routes=routes, middleware=[Middleware(OnlyHere, word=word)])


def _showing(page: Callable[[], str]) -> Callable[[Request], Awaitable[Response]]:
    async def shown(_request: Request) -> Response:
        try:
            text = await run_in_threadpool(page)
        except CamgenError as error:
            return PlainTextResponse(str(error), 500)
        return Response(text, media_type="text/html", headers={"Content-Security-Policy": _POLICY})

    return shown


def _answering(reply: Callable[[Answer], Answer]) -> Callable[[Request], Awaitable[Response]]:
    async def answer(request: Request) -> Response:
        try:
            body = await request.json()
        except (ValueError, RecursionError):  # no JSON, or too deep
            body = None
        if not isinstance(body, dict):
            return _json(
                failure("no valid request", [str(Fault(("request",), "", "a JSON object"))]), 400
            )
        try:
            return _json(await run_in_threadpool(reply, body))
        except (CamgenError, OSError) as error:
            return _json(reasons(explained(error)), 409)

    return answer


def _json(answer: Answer, status: int = 200) -> Response:
    """In plain letters, for what was asked may hold what no encoding has."""
    return Response(json.dumps(answer), status, media_type="application/json")
