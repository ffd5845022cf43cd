"""Trials, and the recordings of a robot, for pages."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.server.access import AccessError
from btlang.server.recordings import listed, path_of
from tests.server.doors import Door


def test_a_trial(door: Door) -> None:
    vic = door.log_in("vic")
    film = door.ask("POST", "/api/try", {"text": 'say "🤖"\nwave twice'}, **vic).data
    assert (film["ok"], film["stopped"], film["failed"]) == (True, "", -1)
    assert [(node["start"], node["end"]) for node in film["nodes"]][2:] == [(9, 19), (9, 13)]
    assert film["map"]["places"]
    wrong = door.ask("POST", "/api/try", {"text": "wav"}, **vic).data
    assert (wrong["ok"], wrong["messages"][0]["code"]) == (False, "BT010")
    endless = door.ask("POST", "/api/try", {"text": "repeat: print hello"}, **vic).data
    assert endless["stopped"]


def test_recordings_of_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(tmp_path)
    path = tmp_path / "2026-01-01-100000-ab12.mcap"
    assert main(["run", "-c", "wave", "--speed", "max", "--quiet", "--record", str(path)]) == 0
    capsys.readouterr()
    (tmp_path / "broken.mcap").write_bytes(b"no recording")
    (tmp_path / "other.txt").write_text("x")
    assert {each["name"] for each in listed(folder)} == {path.name, "broken.mcap"}
    assert path_of(folder, path.name) == os.path.join(folder, path.name)
    for name in ("../x.mcap", "other.txt", "none.mcap", "", "a/b.mcap", "\0.mcap", "x.mcap\n", "..mcap"):
        with pytest.raises(AccessError):
            path_of(folder, name)
    with pytest.raises(AccessError):
        listed("")


def test_recordings_of_a_robot(door: Door) -> None:
    for path in ("/api/recordings", "/api/recordings/x.mcap", "/api/films/x.mcap"):
        assert door.ask("GET", path).status == 401
        reply = door.ask("GET", path, **door.log_in("vic"))
        assert reply.status in (200, 404, 409), path
