"""Trees, tables and lists as a user sees them in a terminal of any width."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.terminal.emulator import BTC, Terminal

Open = Callable[..., Terminal]

MISSION = 'say "Good morning to everybody who is here" then (wave and nod)'
FOLDED = """\
Sequence
├── Say: say "Good morning to
│   everybody who is here"
└── Parallel
    ├── Wave: wave
    └── Nod: nod
[status 0]
"""
UNFOLDED = """\
Sequence
├── Say: say "Good morning to everybody who is here"
└── Parallel
    ├── Wave: wave
    └── Nod: nod
[status 0]
"""


@pytest.mark.parametrize("environment", [{}, {"NO_COLOR": "1"}])
def test_a_line_of_a_tree_is_folded_below_its_branch(terminal: Open, environment: dict[str, str]) -> None:
    seen = terminal(*BTC, "tree", "-c", MISSION, width=36, environment=environment)
    assert seen.wait_for_end() == 0
    assert seen.screen() == FOLDED


def test_a_dumb_terminal_gets_the_text(terminal: Open) -> None:
    seen = terminal(*BTC, "tree", "-c", MISSION, width=36, environment={"TERM": "dumb"})
    assert seen.wait_for_end() == 0
    assert seen.history() == UNFOLDED  # the terminal has wrapped the line


@pytest.mark.parametrize("width", [60, 80, 120])
@pytest.mark.parametrize("verb", ["words", "examples"])
def test_lists_fit_the_terminal(terminal: Open, verb: str, width: int) -> None:
    seen = terminal(*BTC, verb, width=width)
    assert seen.wait_for_end() == 0
    widest = max(len(line) for line in seen.history().splitlines() if "btc examples" not in line)
    assert width - 20 < widest <= width


def test_the_last_column_of_a_table_is_folded(terminal: Open) -> None:
    seen = terminal(*BTC, "explain", width=40, height=50)
    assert seen.wait_for_end() == 0
    assert "\nBT015  a name contains a word that joins\n       commands\n" in seen.history()
