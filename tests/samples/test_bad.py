"""Every code of a message has a bad sample in `bad/`, and its exact output beside it.

A sample is compiled with `btc check`; a first line `# btc VERB FILE ...` asks for another command.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main
from btlang.diagnostics.codes import CODES
from tests.conftest import matches_golden, take_away_what_is_missed

BAD = Path(__file__).parent / "bad"
SAMPLES = sorted(BAD.glob("*.txt"))


@pytest.mark.parametrize("sample", SAMPLES, ids=[s.stem for s in SAMPLES])
def test_message(sample: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(BAD)
    take_away_what_is_missed(sample.stem[:5], monkeypatch)
    first = sample.read_text(encoding="latin-1").splitlines()[0]
    command = first.removeprefix("# btc ").split() if first.startswith("# btc ") else ["check", "FILE"]
    code = main([sample.name if word == "FILE" else word for word in command])
    errors = capsys.readouterr().err
    assert sample.stem[:5] in errors
    assert "Traceback" not in errors
    assert code == (0 if CODES[sample.stem[:5]].severity == "warning" else 2)
    matches_golden(errors, sample.with_suffix(".out"))


@pytest.mark.parametrize("sample", SAMPLES, ids=[s.stem for s in SAMPLES])
def test_both_parsers_say_the_same(
    sample: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(BAD)
    said = []
    for parser in ("shunting-yard", "lark"):
        main(["check", sample.name, "--parser", parser])
        said.append(capsys.readouterr())
    assert said[0] == said[1]


def test_every_code_has_a_sample() -> None:
    assert {sample.stem[:5] for sample in SAMPLES} == set(CODES)
