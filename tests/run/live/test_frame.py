"""What the lines of the live view say, and that they fit."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.robots.geometry import Pose
from btlang.run.controls import Controls
from btlang.run.live.frame import (
    ASCII,
    SIGNALS,
    UNICODE,
    ViewWords,
    counts_line,
    fit_text,
    header,
    keys_line,
    legend_lines,
    robot_line,
    tree_lines,
)
from btlang.run.live.view import usual_keys
from btlang.run.robot_state import RobotState
from btlang.run.snapshot import HALTED, SUSPENDED, Doing, RunState, Shape
from btlang.text.source import Source, Span
from btlang.tree.node import Node

from .trees import SHAPES, shape_of

Line = tuple[tuple[str, str], ...]


KEYS = [(key.shown, key.does) for key in usual_keys(Controls())] + [("?", "legend")]


def text(line: Line) -> str:
    return "".join(piece for piece, _ in line)


def named(node: Node) -> str:
    return node.name


def made(outline: str) -> tuple[RunState, ViewWords]:
    """A tree whose nodes are named by the lines."""
    shape = shape_of(outline)
    nodes = [Node("Id", name=line.strip()) for line in outline.splitlines()]
    return RunState(shape, [Node("Sequence")] * len(shape)), ViewWords(nodes, named)


def lines(state: RunState, words: ViewWords, height: int = 24, width: int = 40, over: bool = False) -> list[str]:
    return [text(line).rstrip() for line in tree_lines(state, words, height, width, over, UNICODE)]


def test_each_status_has_its_sign_and_its_time() -> None:
    state, words = made("all\n one\n two\n three\n four\n five\n six\n seven")
    state.statuses[:] = bytes([RUNNING, SUCCESS, FAILURE, SKIPPED, HALTED, SUSPENDED, RUNNING, IDLE])
    state.started = {0: 0.0, 1: 0.0, 2: 1.0, 4: 2.0, 5: 2.0, 6: 2.0}
    state.ended = {1: 1.0, 2: 2.0, 4: 2.5, 5: 4.0}
    state.reasons = {2: "the way is blocked"}
    state.now = 4.0
    assert lines(state, words) == [
        "▶ all  4.0 s",
        "├── ✓ one  1.0 s",
        "├── ✗ two  1.0 s  the way is blocked",
        "├── – three",  # noqa: RUF001
        "├── ■ four  0.5 s  halted",
        "├── ‖ five  2.0 s",
        "├── ▶ six  2.0 s",
        "└── · seven",
    ]
    assert lines(state, words, over=True)[5] == "├── ■ five  2.0 s  halted"


def test_what_runs_is_bold_and_nothing_else_is() -> None:
    state, words = made("all\n one\n two")
    state.statuses[:] = bytes([RUNNING, RUNNING, IDLE])
    styles = [
        {style for _, style in line if "bold" in style} for line in tree_lines(state, words, 9, 40, False, UNICODE)
    ]
    assert styles == [{"bold", "bold cyan"}, {"bold", "bold cyan"}, set()]


def test_a_folded_branch_tells_how_many_nodes_and_what_failed() -> None:
    state, words = made("all\n" + " go\n  walk\n  look\n" * 4)
    state.statuses[:] = bytes([RUNNING, *[SUCCESS] * 3, *[FAILURE, SUCCESS, FAILURE], *[RUNNING] * 2, *[IDLE] * 4])
    state.reasons = {6: "it is dark"}
    assert lines(state, words, 7) == [
        "▶ all",
        "├── ✓ go  (2 nodes)",
        "├── ✗ go  (2 nodes)  look: it is dark",
        "├── ▶ go",
        "│   ├── ▶ walk",
        "│   └── · look",
        "└── · go  (2 nodes)",
    ]


def test_sentences() -> None:
    source = Source("repeat 2 times:\n    wave then nod\n    nod\nwave")
    wave = Node("Leaf", name="wave", span=Span(source, 20, 24))
    both = Node("Sequence", (wave,), span=Span(source, 20, 33))
    body = Node("Sequence", (both,), span=Span(source, 20, 41))
    repeat = Node("Repeat", (body,), (("num_cycles", "2"),), span=Span(source, 0, 41))
    whole = Node("Sequence", (repeat,), span=Span(source, 0, 46))
    named_again = Node("Sequence", (wave,), name="wave", span=wave.span)
    nodes = [whole, repeat, body, both, both, wave, named_again]
    state = RunState(shape_of("a\n b\n  c\n   d\n    e\n     f\n b"), nodes)
    assert lines(state, ViewWords(nodes, lambda node: node.name or node.id), width=60) == [
        "· Sequence",
        "├── · Repeat  repeat 2 times:",
        "│   └── · Sequence",
        "│       └── · Sequence  wave then nod",
        "│           └── · Sequence",
        "│               └── · wave",
        "└── · wave",
    ]


def test_narrow_terminals_crop_the_sentence_and_keep_the_time() -> None:
    state, words = made("all\n say something that is very long indeed\n  deep\n   deeper\n    deepest")
    state.statuses[:] = bytes([RUNNING] * 5)
    state.started = dict.fromkeys(range(5), 0.0)
    state.now = 12.25
    assert lines(state, words, width=24) == [
        "▶ all  12.2 s",
        "└ ▶ say somethi…  12.2 s",
        "  └ ▶ deep  12.2 s",
        "    └ ▶ deeper  12.2 s",
        "      └ ▶ deepe…  12.2 s",
    ]


def test_the_robot() -> None:
    state, _ = made("all")
    assert text(robot_line(state, UNICODE)) == "robot -"
    state.robot = RobotState(Pose(1.0, -0.001, 90.4), 87.4, None, "red cup")
    state.doing = Doing(says="Hello\x1b[2J!")
    assert text(robot_line(state, UNICODE)) == (
        'robot x 1.00 m  y 0.00 m  heading 90° · battery 87% · holds red cup (right) · said "Hello\\x1b[2J!"'
    )


def test_the_lines_around() -> None:
    state, _ = made("all")
    state.now, state.ticks, state.overruns = 12.34, 246, 1
    assert text(header("tea.txt", state, "paused", UNICODE)) == "tea.txt · 12.3 s · paused"
    assert text(counts_line(state, UNICODE)) == "ticks 246"
    state.overruns = 3  # more than one in a hundred
    assert text(counts_line(state, UNICODE)) == "ticks 246 · overruns 3"
    assert text(keys_line(False, KEYS, UNICODE)) == "space pause · s step · q stop · e emergency stop · ? legend"
    assert text(keys_line(True, KEYS, UNICODE)) == "space resume · s step · q stop · e emergency stop · ? legend"
    assert text(keys_line(True, SIGNALS, ASCII)) == "Ctrl-C stop - Ctrl-\\ emergency stop"


def test_the_legend_explains_every_sign_in_any_width() -> None:
    for width in (100, 34):
        shown = legend_lines(width, UNICODE)
        assert max(cell_len(text(line)) for line in shown) <= width
        words = " ".join(map(text, shown))
        assert [sign for sign in UNICODE.statuses if f"{sign} " not in words] == []


def test_an_answer_of_a_condition_is_not_red() -> None:
    nodes = [Node("IfThenElse"), Node("Inverter"), Node("BatteryFull"), Node("Wave")]
    state, words = RunState(Shape([-1, 0, 1, 0]), nodes), ViewWords(nodes, lambda node: node.id, [-1, 0, 1, 0])
    state.statuses[:] = bytes([SKIPPED, FAILURE, SUCCESS, FAILURE])
    state.reasons = {1: "it is true", 3: "the arm is stuck"}
    shown = tree_lines(state, words, 10, 80, False, UNICODE)
    assert text(shown[1]).endswith("Inverter  'BatteryFull' was true")
    assert [any("red" in style for _, style in line) for line in shown] == [False, False, False, True]


def test_a_terminal_without_unicode() -> None:
    state, words = made("all\n one\n two" + "\n two" * 20)
    told = [text(line) for line in tree_lines(state, words, 5, 40, False, ASCII)]
    assert told == [". all", "|-- . one", "|-- . two", "|-- . two", "`-- ... 19 to come"]
    assert all(line.isascii() for line in told)


def test_wide_characters_are_counted_as_wide() -> None:
    assert fit_text("日本語", 6, UNICODE) == "日本語"
    assert fit_text("日本語", 5, UNICODE) == "日本…"
    assert fit_text("abc", 0, UNICODE) == ""


@given(SHAPES, st.integers(3, 30), st.integers(30, 120), st.text(max_size=50), st.booleans())
def test_whatever_the_tree_the_lines_fit(shape: object, height: int, width: int, name: str, over: bool) -> None:
    state = RunState(shape, [Node("Sequence")] * len(shape))  # type: ignore[arg-type]
    state.statuses[:] = bytes(index % 7 for index in range(len(state.statuses)))
    state.started = dict.fromkeys(range(len(state.statuses)), 0.0)
    words = ViewWords([Node("Id", name=name)] * len(state.statuses), named)
    for line in tree_lines(state, words, height, width, over, UNICODE):
        assert cell_len(text(line)) <= width
        assert "\n" not in text(line)
