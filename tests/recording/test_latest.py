"""The latest run: `btc why`, `btc replay` and `btc watch` without a file."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.recording.latest import latest_recording
from btlang.vocabulary.shipped import DEFAULT_WORLD

RUN = ("run", "--speed", "max")


@pytest.fixture(autouse=True)
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's folder for it, empty."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    return tmp_path


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    capsys.readouterr()
    assert main(list(words)) == 0
    return capsys.readouterr().out


def test_why_and_replay_take_the_latest_run(capsys: pytest.CaptureFixture[str], state: Path) -> None:
    assert main([*RUN, "-c", "wave"]) == 0
    assert "wave" in printed(capsys, "why")
    assert main([*RUN, "-c", "nod then fail"]) == 1
    assert "The mission failed" in printed(capsys, "why")
    assert "start  nod" in printed(capsys, "replay", "--lines", "--speed", "max")
    assert len(list(state.rglob("*.mcap"))) == 1  # only the latest one is kept


def test_a_recording_that_was_asked_for_is_the_latest_run_and_stays(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "mine" / "nod.mcap"
    path.parent.mkdir()
    assert main([*RUN, "-c", "nod", "--record", str(path)]) == 0
    assert "nod" in printed(capsys, "why")
    assert latest_recording() == str(path)
    assert main([*RUN, "-c", "wave"]) == 0
    assert path.exists()
    path.unlink()
    assert "wave" in printed(capsys, "why")


def test_a_quiet_run_is_not_recorded(capsys: pytest.CaptureFixture[str], state: Path) -> None:
    assert main([*RUN, "-c", "wave", "--quiet"]) == 0
    assert not list(state.iterdir())
    assert main(["why"]) == 2
    assert "BT088: There's no recording of the latest run" in capsys.readouterr().err


def test_a_recording_changes_neither_the_run_nor_its_seed(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    world.write_text("seed = 7\n" + Path(DEFAULT_WORLD).read_text(encoding="utf-8"), encoding="utf-8")
    words = ("-c", "go to a random place then go to a random place", "--world", str(world))
    runs = {printed(capsys, *RUN, *words) for _ in range(3)}
    assert len(runs) == 1


@pytest.mark.skipif(os.geteuid() == 0, reason="root can write everywhere")
def test_a_folder_that_cannot_be_written(capsys: pytest.CaptureFixture[str], state: Path) -> None:
    state.chmod(0o500)
    assert "wave" in printed(capsys, *RUN, "-c", "wave")


def test_a_state_that_is_no_folder(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked = tmp_path / "file"
    blocked.touch()
    monkeypatch.setenv("XDG_STATE_HOME", str(blocked))
    assert "wave" in printed(capsys, *RUN, "-c", "wave")


def test_a_full_disk_ends_the_recording_and_not_the_run(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("btlang.recording.recorder.Recorder._write", fail)
    assert "wave" in printed(capsys, *RUN, "-c", "wave")
    assert "No space" not in capsys.readouterr().err


def test_a_long_run_keeps_its_last_part(
    capsys: pytest.CaptureFixture[str], state: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("btlang.recording.latest.PART_BYTES", 50_000)
    assert main([*RUN, "-c", "repeat 20 times wave"]) == 0
    assert len(list(state.rglob("*.mcap"))) == 1
    assert "The mission succeeded after 90.0 s." in printed(capsys, "why")
