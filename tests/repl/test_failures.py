"""What the REPL tells of a line that fails: what `btc run` tells of a mission."""

from __future__ import annotations

import pytest

from btlang.repl.draft import MissionDraft
from btlang.repl.loop import Repl
from btlang.repl.store import DraftStore


def told(capsys: pytest.CaptureFixture[str], *lines: str) -> list[str]:
    """What is written to standard error while these lines are done."""
    assert Repl(MissionDraft(), DraftStore(None), "max").read(lines) == 1
    return capsys.readouterr().err.splitlines()


def test_a_line_that_fails(capsys: pytest.CaptureFixture[str]) -> None:
    fetch = "fetch {object} is grasp the object or else check the robot is holding the object"
    lines = told(capsys, fetch, "wait 1 s", "wait 1 s then fetch the cup")
    assert lines == [
        "The mission failed after 1.0 s.",
        "prompt:2:54: holding cup",
        f"  {fetch}",
        f"  {'':53}{'^' * 27}",
        "  Holding: it is not true",
        "It was part of:",
        "  fetch the cup (line 1)",
        "What had been tried before:",
        "    1.0 s  grasp cup: the cup is not within reach of the right hand",
    ]


def test_each_line_has_its_own_story(capsys: pytest.CaptureFixture[str]) -> None:
    lines = told(capsys, "grasp the cup or else check battery is low", "check battery is low")
    assert [line for line in lines if "tried before" in line or "grasp cup:" in line] == lines[5:7]
    assert lines[7].startswith("The mission failed after 0.0 s.")
