"""The text of a message: its colours, and the line that it proposes."""

from __future__ import annotations

import io
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.cli import main
from btlang.diagnostics.diagnostic import Diagnostic, diagnostic, fix_line, render
from btlang.text.output import has_colour
from btlang.text.source import Source, Span
from tests.diagnostics.samples import sample_diagnostics, told
from tests.profiles import searches

ROOT = Path(__file__).parent.parent.parent
VARIABLES = ("NO_COLOR", "FORCE_COLOR", "CLICOLOR_FORCE", "CLICOLOR", "TERM")


class Terminal(io.StringIO):
    """A stream that says that it is a terminal."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("variables", "on_terminal", "elsewhere"),
    [
        ({}, True, False),
        ({"NO_COLOR": "1"}, False, False),
        ({"NO_COLOR": ""}, True, False),
        ({"FORCE_COLOR": "1"}, True, True),
        ({"FORCE_COLOR": "0"}, True, False),
        ({"FORCE_COLOR": ""}, True, False),
        ({"CLICOLOR_FORCE": "1"}, True, True),
        ({"CLICOLOR": "0"}, False, False),
        ({"CLICOLOR": "0", "CLICOLOR_FORCE": "1"}, True, True),
        ({"NO_COLOR": "1", "FORCE_COLOR": "1"}, False, False),
        ({"TERM": "dumb"}, False, False),
        ({"TERM": "dumb", "FORCE_COLOR": "1"}, True, True),
    ],
)
def test_who_gets_colours(
    variables: dict[str, str], on_terminal: bool, elsewhere: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    for name, value in {"TERM": "xterm", **variables}.items():
        monkeypatch.setenv(name, value)
    assert has_colour(Terminal()) is on_terminal
    assert has_colour(io.StringIO()) is elsewhere
    assert has_colour(None) is elsewhere


def test_colours_change_nothing_else() -> None:
    for problem in sample_diagnostics():
        coloured = render(problem, colour=True)
        assert ("\x1b[36m" if problem.kind.severity == "note" else "\x1b[1;3") in coloured
        assert re.sub(r"\x1b\[[\d;]*m", "", coloured) == render(problem)


def test_severity_and_underline_are_coloured() -> None:
    problem = told(Source("wave then flarp", "tea.txt"))[0]
    assert render(problem, colour=True).splitlines()[:3] == [
        "tea.txt:1:11: \x1b[1;31merror BT010:\x1b[0m I don't know the command 'flarp'.",
        "  wave then flarp",
        "            \x1b[1;31m^^^^^\x1b[0m",
    ]


def test_the_command_colours_where_it_is_asked_to(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("FORCE_COLOR", "1")
    main(["check", "-c", "wave is nod; wave"])
    assert "\x1b[1;33mwarning BT018:\x1b[0m" in capsys.readouterr().err
    main(["check", "-c", "wave is nod; wave", "--format", "json"])
    assert "\x1b" not in "".join(capsys.readouterr())


@pytest.mark.parametrize(
    ("mission", "line"),
    [
        ("go to the ktichen then wave", "go to the kitchen then wave"),
        ("if bumped:\n    \twave nod  ", "wave then nod"),
        ("wave nod then go to the ktichen", "wave then nod then go to the kitchen"),
        ("move forward 2 then wave", ""),  # the hint has it: move forward 2 m
        ("wave within 5 parsecs", ""),
        ("the battery is low", "check the battery is low"),
        ("say hello dear friends", ""),
        ("wave then say hello dear friends", ""),
        ("flarp", ""),
        ("wave nod then say " + "x" * 95, "wave then nod then say " + "x" * 95),
        ("wave nod then say " + "x" * 98, ""),
    ],
)
def test_mended_line(mission: str, line: str) -> None:
    problem = next(p for p in told(Source(mission)) if p.fix is not None or p.code != "BT020")
    assert fix_line(problem) == line
    assert render(problem).endswith(f"\n  Did you mean: {line}") is bool(line)


def test_a_fix_that_changes_nothing_is_none() -> None:
    source = Source("Go the lab")
    assert diagnostic("BT010", Span(source, 0, 10), fix=(Span(source, 0, 2), "go"), words="Go the lab").fix is None


def test_a_fix_of_several_lines_is_not_shown() -> None:
    source = Source("wave\nnod")
    assert fix_line(diagnostic("BT025", Span(source, 0, 4), fix=(Span(source, 2, 6), "x"))) == ""
    assert fix_line(diagnostic("BT025", Span(source, 0, 4), fix=(Span(source, 0, 4), "x\ny"))) == ""


def test_a_mended_line_cannot_control_the_terminal() -> None:
    source = Source("wave \x1b[31mnod")
    assert fix_line(diagnostic("BT025", Span(source, 0, 4), fix=(Span(source, 0, 4), "nod"))) == "nod  [31mnod"


def test_the_fix_of_a_sample_mends_it() -> None:
    """Its message is gone, and no fix brings more messages than it takes away."""
    fixed = [problem for problem in sample_diagnostics() if problem.fix is not None]
    for problem in fixed:
        before, after = told(Source(problem.span.source.text)), told(Source(after_fix(problem)))
        assert same(before, problem) > same(after, problem), render(problem)
        assert len(after) <= len(before), render(problem)
    assert {problem.code for problem in fixed} >= {
        "BT004",
        "BT010",
        "BT011",
        "BT013",
        "BT021",
        "BT024",
        "BT028",
        "BT032",
    }


def after_fix(problem: Diagnostic) -> str:
    """The whole text with the fix of one diagnostic."""
    assert problem.fix is not None
    span, words = problem.fix
    return span.source.text[: span.start] + words + span.source.text[span.end :]


def same(problems: list[Diagnostic], one: Diagnostic) -> int:
    """How many say the same of the same words."""
    return sum((p.code, p.message, p.span.text) == (one.code, one.message, one.span.text) for p in problems)


LINES = sorted(
    line.strip()
    for path in (ROOT / "examples").glob("*.txt")
    for line in path.read_text(encoding="utf-8").splitlines()
    if line.strip() and not line.startswith("#")
)


@searches(60, 4000, deadline=None)
@given(st.sampled_from(LINES), st.integers(0, 200), st.sampled_from(["", "x", ",", ")", '"', " "]))
def test_a_fix_takes_its_message_away(line: str, at: int, put: str) -> None:
    """Of lines of the examples in which a character is replaced."""
    at %= len(line)
    text = line[:at] + put + line[at + 1 :]
    before = told(Source(text))
    for problem in before:
        if problem.fix is not None:
            assert same(before, problem) > same(told(Source(after_fix(problem))), problem)


def test_a_further_hint_keeps_the_one_before() -> None:
    problem = diagnostic("BT129", Span(Source("wave"), 0, 4), words="wave", reason="it is so", help="Name it.")
    assert problem.advising("Read the file.").hint.splitlines()[-2:] == ["Name it.", "Read the file."]
