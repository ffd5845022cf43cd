"""The page for browsers, and the program in docs/server.md as it stands there."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from btlang.server.openapi import ROUTES
from btlang.server.outlet import TOPICS
from btlang.server.rosbridge import OPERATIONS
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
