"""`btc run --watch` and `btc watch`: who comes to the page, and what can be done there."""

from __future__ import annotations

import json
import signal
import socket
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus

from btlang.cli import main
from tests.server.doors import LocalDoor, received
from tests.task.layers import LONG, wait_until

MISSION = 'say "hello" then ask "Tea?" then wait 1 hour\n'


@pytest.fixture
def mission(tmp_path: Path) -> Path:
    file = tmp_path / "round.txt"
    file.write_text(MISSION)
    return file


@pytest.fixture
def watched(mission: Path) -> Iterator[LocalDoor]:
    with closing(LocalDoor(mission.parent, "run", str(mission), "--watch", "--no-browser", "--lines")) as up:
        yield up


def browser_in(folder: Path) -> tuple[Path, str]:
    """A program in place of a browser, and the file in which it leaves its command line, the modes and the page."""
    seen, browser = folder / "seen", folder / "browser.sh"
    browser.write_text(
        f'#!/bin/sh\nfile="${{1#file://}}"\n'
        f'(echo "$1"; stat -c "%a %U" "$file" "$(dirname "$file")"; cat "$file") > {seen}.part\n'
        f"mv {seen}.part {seen}\n"
    )
    browser.chmod(0o700)
    return seen, f"{browser} %s"


def test_a_run_is_watched_and_stopped(watched: LocalDoor) -> None:
    page = watched.enter()
    me = watched.ask("GET", "/api/me", **page).data
    assert (me["user"], me["role"], me["screen"]) == ("you", "viewer", ["robots", "round.txt"])
    with watched.socket(cookie=page["cookie"]) as socket:
        socket.send(json.dumps({"type": "subscribe", "id": 1}))
        run = received(socket, type="run")
        assert run["text"] == MISSION
        says = [place for place, (_, id, *_) in zip(run["spans"], run["nodes"], strict=True) if id == "Say"]
        assert [MISSION[start:end] for start, end in says] == ['say "hello"']
        assert received(socket, type="event")["event"]["text"] == "hello"
        assert received(socket, type="asking", text="Tea?")
        for command in ("submit", "pause", "release", "down", "talk"):
            asked = {"command": command, "robot": "round.txt", "text": "wave", "task": 1}
            assert watched.ask("POST", "/api/commands", asked, **page).status in (400, 403), command
        for path in ("/api/check", "/api/missions", "/api/rosbridge", "/metrics", "/openapi.json", "/api/logout"):
            assert watched.ask("GET", path, **page).status == 404, path
        assert watched.ask("POST", "/api/stop", {"robot": "round.txt"}, **page).status == 200
        while received(socket, type="event")["event"]["event"] != "end":
            pass
    wait_until(lambda: watched.process.poll() is not None)
    assert watched.process.returncode == 131
    assert watched.token not in "".join(watched.lines[1:])


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_end_stays_until_somebody_ends_it(mission: Path, number: signal.Signals) -> None:
    mission.write_text("wave\n")
    words = "run", str(mission), "--watch", "--no-browser", "--speed", "max"
    with closing(LocalDoor(mission.parent, *words)) as up:
        page = up.enter()
        with up.socket(cookie=page["cookie"]) as socket:
            socket.send(json.dumps({"type": "subscribe", "id": 1}))
            while received(socket, type="event")["event"]["event"] != "end":
                pass
            time.sleep(4.0)  # longer than it waits for a page that is loaded again
            assert up.process.poll() is None
            up.process.send_signal(number)
            up.process.wait(LONG)
    assert up.process.returncode == 0, up.lines
    assert not [path for path in mission.parent.iterdir() if path.name.startswith("btlang-")]


def test_nobody_else_comes_in(watched: LocalDoor) -> None:
    at = f":{watched.port}"
    for host in ("evil.example", f"evil.example{at}", "127.0.0.1", "127.0.0.1:1", f"127.0.0.1.evil{at}"):
        assert watched.ask("GET", "/", host=host).status == 403, host
        with pytest.raises(InvalidStatus):
            watched.socket(host=host)
    for origin in (
        "http://evil.example",
        "null",
        f"https://127.0.0.1{at}",
        f"http://localhost{at}",
        "http://127.0.0.1:1",
    ):
        assert watched.ask("POST", "/api/login", {"token": watched.token}, origin=origin).status == 403, origin
        with pytest.raises(InvalidStatus):
            watched.socket(origin=origin)
    for path in ("/api/me", "/api/robots", "/api/films/recording.mcap"):
        assert watched.ask("GET", path).status in (401, 404), path
    assert watched.ask("POST", "/api/stop", {}).status == 401
    with watched.socket() as socket:  # without a cookie it has to bring a token, and there are none
        assert received(socket, type="auth_required")
        socket.send(json.dumps({"type": "auth", "token": watched.token}))
        assert received(socket, type="auth_invalid")
    page = watched.enter()
    with pytest.raises(InvalidStatus):
        watched.socket(cookie=page["cookie"], origin="http://evil.example")
    assert watched.ask("POST", "/api/login", {"token": watched.token}).status == 401  # it was used
    assert watched.ask("POST", "/api/stop", {}, cookie=page["cookie"]).status == 403


def test_only_this_computer_reaches_it(watched: LocalDoor) -> None:
    others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    for address in others:
        with pytest.raises(OSError, match="refused"):
            socket.create_connection((address, watched.port), timeout=2)


@pytest.mark.parametrize("words", [("run", "--watch"), ("edit",)])
def test_the_browser_gets_the_address_in_a_private_file(words: tuple[str, ...], mission: Path) -> None:
    folder = mission.parent
    seen, browser = browser_in(folder)
    with closing(LocalDoor(folder, *words, str(mission), BROWSER=browser)) as up:
        wait_until(seen.exists)
        address, file, around, page = seen.read_text().split("\n", 3)
        owner = Path(seen).owner()
        assert (file, around) == (f"600 {owner}", f"700 {owner}")
        up.token = page.partition("token=")[2].partition('"')[0]
        assert len(up.token) > 40
        assert up.token not in address
        assert not [path for path in Path("/proc").glob("[0-9]*/cmdline") if up.token in _text(path)]
        up.enter()
        assert not Path(address.removeprefix("file://")).exists()
    assert up.token not in "".join(up.lines)
    assert up.process.returncode == 128 + signal.SIGTERM
    assert not [path for path in folder.iterdir() if path.name.startswith("btlang-")]


@pytest.mark.parametrize("words", [("run", "--watch", "--no-browser"), ("edit", "--no-browser")])
def test_a_signal_at_once_leaves_nothing(words: tuple[str, ...], mission: Path) -> None:
    up = LocalDoor(mission.parent, *words, str(mission))  # it returns with the first line
    up.close()
    assert up.process.returncode == 128 + signal.SIGTERM, up.lines
    assert not [path for path in mission.parent.iterdir() if path.name.startswith("btlang-")]


def _text(path: Path) -> str:
    try:
        return path.read_text(errors="replace")
    except OSError:  # it has ended
        return ""


def test_a_recording_is_watched(mission: Path, tmp_path: Path) -> None:
    mission.write_text("wave\n")
    file = tmp_path / "my run.mcap"
    assert main(["run", str(mission), "--speed", "max", "--quiet", "--record", str(file)]) == 0
    with closing(LocalDoor(tmp_path, "watch", str(file), "--no-browser")) as up:
        page = up.enter()
        screen = up.ask("GET", "/api/me", **page).data["screen"]
        assert screen == ["runs", "my run", "recording.mcap"]
        film: Any = up.ask("GET", "/api/films/recording.mcap?robot=my%20run", **page).data
        assert (film["ok"], film["text"]) == (True, "wave\n")
        downloaded = up.ask("GET", "/api/recordings/recording.mcap?robot=my%20run", **page)
        assert downloaded.body == file.read_bytes()
        for other in ("open.html", "..%2Fmy run.mcap", "other.mcap"):
            assert up.ask("GET", f"/api/recordings/{other}?robot=my%20run".replace(" ", "%20"), **page).status == 404
        with up.socket(cookie=page["cookie"]):
            pass
        up.process.wait(LONG)  # the page was closed
        assert up.process.returncode == 0


def test_what_is_no_recording_says_so_at_once(mission: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["watch", str(mission)]) == 2
    assert "error BT084: " in capsys.readouterr().err


def test_without_a_page_nothing_moves(
    mission: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("btlang.server.page.local_page.PAGE", Path("nowhere"))
    assert main(["run", str(mission), "--watch"]) == 2
    captured = capsys.readouterr()
    assert (captured.out, "error BT211: " in captured.err) == ("", True)
