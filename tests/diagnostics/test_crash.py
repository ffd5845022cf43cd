"""A bug in btlang is a short message and a file; in tests and with BTC_DEBUG it comes through."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang import cli
from btlang.cli import main

ERRORS = [ZeroDivisionError("division by zero"), MemoryError(), RecursionError("too deep"), KeyError("\x1b[2J")]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_a_bug(
    error: Exception, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: object) -> int:
        raise error

    monkeypatch.setattr(cli, "_run_handler", fail)
    with pytest.raises(type(error)):
        main(["check", "-c", "wave"])
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.delenv("BTC_DEBUG")
    assert main(["check", "-c", "wave"]) == cli.CRASHED
    said = capsys.readouterr().err
    file = tmp_path / "btlang" / "crash.txt"
    assert "error BT099: btlang has a bug: " in said
    assert str(file) in said
    assert not any(part in said for part in ("Traceback", "\x1b"))
    text = file.read_text(encoding="utf-8")
    assert "Traceback" in text
    assert type(error).__name__ in text
    assert file.stat().st_mode & 0o777 == 0o600
