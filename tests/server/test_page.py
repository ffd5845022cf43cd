"""The page for browsers, and the program in docs/server.md as it stands there."""

from __future__ import annotations

import asyncio
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

from starlette.applications import Starlette

from btlang.server.http.access import AccessError
from btlang.server.http.openapi import ROUTES
from btlang.server.http.pages import PLAIN, page_routes
from btlang.server.live.client_queue import TOPICS
from btlang.server.live.rosbridge import OPERATIONS
from btlang.task.layer import TaskLayer
from tests.server.doors import Door

PAGE = Path(__file__).parents[2] / "docs" / "server.md"


def test_the_client_of_the_page(door: Door, robot: TaskLayer, tmp_path: Path) -> None:
    [program] = re.findall(r"```py\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    (tmp_path / "client.py").write_text(program)
    assert door.process.stdout is not None
    fingerprint = door.process.stdout.readline().partition(": ")[2].strip()
    token = door.user("token", "olga", "page")
    for given, code in ((fingerprint, 0), ("AB:" + fingerprint[3:], 1)):
        words = [sys.executable, tmp_path / "client.py", str(door.port), given, token]
        done = subprocess.run(words, capture_output=True, text=True, timeout=30)
        assert done.returncode == code, done.stderr
        assert code or {"result", "run", "statuses", "change"} <= {*done.stdout.split()}


class Nobody:
    """Access for nobody, as far as the page needs it."""

    async def identify(self, headers: object, *, changes: bool) -> None:
        raise AccessError(401, "Log in first.")


def test_the_plain_page_is_there_without_a_built_one(tmp_path: Path) -> None:
    app = Starlette(routes=page_routes(Nobody(), built=tmp_path))  # type: ignore[arg-type]
    assert asked(app, "/") == (303, {"location": "/login"}, "")
    for path, words in (("/login", '<script type="module" src="/page/login.js">'), ("/page/index.js", "fetch(")):
        status, _, text = asked(app, path)
        assert status == 200
        assert words in text
    assert {path.suffix for path in PLAIN.iterdir()} == {".html", ".js", ".css"}  # all of it is served, to anybody


def test_a_built_page_may_be_kept_and_its_nonces_not(tmp_path: Path) -> None:
    (tmp_path / "files").mkdir()
    (tmp_path / "files" / "main-AB12.js").write_text("start()" * 500)
    (tmp_path / "index.html").write_text('<script nonce="NONCE">')
    app = Starlette(routes=page_routes(Nobody(), built=tmp_path))  # type: ignore[arg-type]
    status, headers, text = asked(app, "/page/main-AB12.js")
    assert (status, headers["cache-control"]) == (200, "public, max-age=31536000, immutable")
    assert text.startswith("start()")
    nonces = set()
    for _ in range(2):
        _, headers, text = asked(app, "/login")
        [nonce] = re.findall(r'nonce="([\w-]{20,})"', text)
        assert f"style-src 'self' 'nonce-{nonce}';" in headers["content-security-policy"]
        nonces.add(nonce)
    assert len(nonces) == 2


def asked(app: Starlette, path: str) -> tuple[int, dict[str, str], str]:
    """The answer of an application to a request: its status, the headers that matter, and its text."""
    sent: list[dict[str, Any]] = []

    async def receive() -> Any:
        await asyncio.Event().wait()  # there's no body

    async def send(message: Any) -> None:
        sent.append(message)

    scope = {
        "type": "http",
        "method": "GET",
        "path": path,
        "raw_path": path.encode(),
        "query_string": b"",
        "headers": [],
    }
    asyncio.run(app({**scope, "root_path": "", "client": None, "server": None, "http_version": "1.1"}, receive, send))
    wanted = ("location", "cache-control", "content-security-policy")
    headers = {name.decode(): value.decode() for name, value in sent[0]["headers"]}
    body = b"".join(message.get("body", b"") for message in sent[1:])
    return sent[0]["status"], {name: headers[name] for name in wanted if name in headers}, body.decode()


def test_the_page(door: Door) -> None:
    led = door.ask("GET", "/")
    assert (led.status, led.headers["location"]) == (303, "/login")
    vic = door.log_in("vic")
    for path, headers in (("/login", {}), ("/", vic)):
        page = door.ask("GET", path, **headers)
        text = page.body.decode()
        assert (page.status, page.headers["content-type"]) == (200, "text/html; charset=utf-8")
        policy = page.headers["content-security-policy"]
        assert "default-src 'none'; script-src 'self'" in policy
        assert "unsafe" not in policy
        assert not re.search(r"<script(?![^>]*src)|<style|\bon\w+=", text)  # which that policy would keep from running
        files = re.findall(r'(?:src|href)="(/[^"]+)"', text)
        assert len(files) == 2
        for each in files:
            assert door.ask("GET", each).status == 200
    for path in ("/page/", "/page/../pages.py", "/page/%2e%2e/pages.py", "/page//etc/passwd", "/page/nothing.js"):
        assert door.ask("GET", path).status == 404


def test_the_documents_name_all_that_there_is() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for _, path in ROUTES:
        assert path.partition("/{")[0] in text
    for name in (*TOPICS, *(kind for kinds in TOPICS.values() for kind in kinds), *OPERATIONS):
        assert f"`{name}`" in text
