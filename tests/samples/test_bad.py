"""Every code of a message has a bad sample in `bad/`, and its exact output beside it.

A sample is compiled with `btc check`; a first line `# btc VERB FILE ...` asks for another command, and `# ros FILE`
binds the words of a keyword file to ROS 2. `# schedules ZONE` reads each further line as the rule of a schedule. With
the rest, `# edit JSON` does an edit, `# rename OLD -> NEW` gives something another name, `# try FILE` tries it with the
words of a keyword file, and `# restored` goes on with it from a saved run of another mission. Commands for a robot that
is up find one.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from btlang.cli import CRASHED, main
from btlang.diagnostics.codes import CODES
from tests.conftest import matches_golden, take_away_what_is_missed, without_pointer
from tests.editing.edited import edit_sample
from tests.editing.renames import refusal
from tests.recording.trials import try_sample
from tests.ros.bound import bind_words
from tests.task.schedules import read_schedules
from tests.task.up import REFUSALS, restored, robot_for

BAD = Path(__file__).parent / "bad"
SAMPLES = sorted(BAD.glob("*.txt"))


@pytest.mark.parametrize("sample", SAMPLES, ids=[s.stem for s in SAMPLES])
def test_message(sample: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(BAD)
    take_away_what_is_missed(sample.stem[:5], monkeypatch)
    first = sample.read_text(encoding="latin-1").splitlines()[0]
    if first.startswith("# ros "):
        code = bind_words(first.removeprefix("# ros "))
    elif first.startswith("# schedules"):
        rules = sample.read_text(encoding="utf-8").splitlines()[1:]
        code = read_schedules(rules, first.removeprefix("# schedules").strip())
    elif first.startswith("# edit "):
        code = edit_sample(sample.read_text(encoding="utf-8"))
    elif first.startswith("# rename "):
        problem = refusal(sample.read_text(encoding="utf-8").replace("# rename ", "# ", 1))
        print(problem, file=sys.stderr)
        code = 2 if problem else 0
    elif first.startswith("# try "):
        code = try_sample(sample.read_text(encoding="utf-8"), first.removeprefix("# try "))
    elif first == "# restored":
        problem = restored(sample.read_text(encoding="utf-8"))
        print(problem, file=sys.stderr)
        code = 2 if problem else 0
    else:
        with robot_for(sample.stem[:5], monkeypatch):
            code = run_sample(sample, first)
    errors = without_pointer(capsys.readouterr().err).replace(f"process {os.getpid()}", "process 4711")
    assert sample.stem[:5] in errors
    assert "Traceback" not in errors
    expected = 2 if CODES[sample.stem[:5]].severity == "error" else 0
    assert code == {"BT099": CRASHED, **dict.fromkeys(REFUSALS, 1)}.get(sample.stem[:5], expected)
    matches_golden(errors, sample.with_suffix(".out"))


def run_sample(sample: Path, first: str) -> int:
    """The exit code of the command that the first line asks for."""
    command = first.removeprefix("# btc ").split() if first.startswith("# btc ") else ["check", "FILE"]
    return main([sample.name if word == "FILE" else word for word in command])


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
