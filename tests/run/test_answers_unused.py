"""Answers of a file that no question had."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main


def test_answers_that_no_question_had_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "answers.toml"
    file.write_text('Bob = "yes"\ntea = "no"\n', encoding="utf-8")
    run = ["run", "--speed", "max", "--answers", str(file), "-c"]
    assert main([*run, 'go to Bob, then ask Bob "Juice?"']) == 1
    assert 'No question had the words "bob", "tea". Answers stand under words' in capsys.readouterr().err
    assert main([*run, 'go to Bob, then ask Bob "Tea?"']) == 0
    assert "No question" not in capsys.readouterr().err
