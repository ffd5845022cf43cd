"""What the live view says: each line as pieces of text with a style, fitted to a width."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence

from rich.cells import cell_len, set_cell_size

from btlang.engine.nodes.decorators import WAS_TRUE
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.live.selection import LEAST_HEIGHT, Row, choose_rows
from btlang.run.pace import are_many
from btlang.run.robot_state import RobotState
from btlang.run.snapshot import HALTED, SUSPENDED, RunState, find_asked
from btlang.support.record import Record
from btlang.text.formatting import one_line
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Line: TypeAlias = tuple[tuple[str, str], ...]
    """Pieces of text, each with a style of rich."""

_STYLES = {IDLE: "dim", RUNNING: "bold cyan", SUCCESS: "green", FAILURE: "bold red", SKIPPED: "dim"}
_STYLES |= {HALTED: "yellow", SUSPENDED: "bold yellow"}
_MEANINGS = {
    RUNNING: "running", SUCCESS: "succeeded", FAILURE: "failed", SKIPPED: "skipped", IDLE: "not run", HALTED: "halted",
    SUSPENDED: "paused",
}  # fmt: skip
_LABELS = {IDLE: "dim", RUNNING: "bold", FAILURE: "red", SKIPPED: "dim", SUSPENDED: "bold"}
SIGNALS = (("Ctrl-C", "stop"), *((("Ctrl-\\", "emergency stop"),) if hasattr(signal, "SIGQUIT") else ()))
"""The keys that work everywhere, as signals."""


class Signs(Record):
    """The characters that a terminal can show: one for each status, forks and lines of the tree, and marks."""

    statuses: str
    forks: tuple[str, str, str]
    more: str
    apart: str


UNICODE = Signs("✗✓▶–·■‖", ("├── ", "└── ", "│   "), "…", " · ")  # noqa: RUF001
ASCII = Signs("x+>-.!=", ("|-- ", "`-- ", "|   "), "...", " - ")


class ViewWords:
    """The words for the nodes of a tree, each looked up once: id or command, and the sentence of what has children."""

    def __init__(self, nodes: Sequence[Node], label: Callable[[Node], str], parents: Sequence[int] = ()) -> None:
        self._nodes = nodes
        self.asked = find_asked(nodes, parents)
        """Whether a node is in a condition of the node above, whose failure is an answer and no mistake."""
        self._label = label
        self._known: dict[int, tuple[str, str]] = {}

    def of(self, index: int) -> tuple[str, str]:
        """Return what a node is called, and the sentence it came from, "" where that says no more."""
        found = self._known.get(index)
        if found is None:
            node = self._nodes[index]
            sentence = node.source_text.strip() if node.children and node.span is not None else ""
            first, more, _ = sentence.partition("\n")
            name = self._label(node)
            if (more and not _heads_a_block(node, first)) or first.lower() == name.lower():
                first = ""  # the first of many sentences says too little, and a name twice too much
            found = self._known[index] = one_line(name), one_line(first)
        return found


def _heads_a_block(node: Node, line: str) -> bool:
    """Return whether the first line of a node's text is about all of it: `repeat 3 times:`."""
    inner, outer = node.children[0].span, node.span
    return line.endswith(":") and not (inner is not None and outer is not None and inner.start == outer.start)


def header(title: str, state: RunState, doing: str, signs: Signs) -> Line:
    """Return mission file, time, and what the run is doing."""
    style = {"running": "bold cyan", "paused": "bold yellow", "emergency stop": "bold red"}.get(doing, "bold")
    return ((title, "bold"), (f"{signs.apart}{state.now:.1f} s{signs.apart}", "dim"), (doing, style))


def tree_lines(state: RunState, words: ViewWords, height: int, width: int, over: bool, signs: Signs) -> list[Line]:
    """Return at most `height` lines, but at least 3, none wider than `width`. `over` says that the run has ended."""
    rows = choose_rows(state.shape, state.statuses, max(height, LEAST_HEIGHT))
    step = 4 if min(state.shape.depth, height) * 4 <= width // 2 else 2  # the same throughout a run
    heads = _heads([row.depth for row in rows], step, signs)
    lines: list[Line] = []
    sentences: list[str] = []  # of the rows around the present one
    for row, head in zip(rows, heads, strict=True):
        del sentences[row.depth :]
        if len(head) > width // 2:
            head = signs.more + head[len(head) - width // 2 + len(signs.more) :]
        if row.node < 0:
            counts = f"{signs.more} " + ", ".join(f"{count} {kind}" for kind, count in row.left_out)
            lines.append(((head, "dim"), (fit_text(counts, width - len(head), signs), "dim italic")))
            continue
        sentence = words.of(row.node)[1]
        shown = sentence if sentence not in sentences else ""
        sentences.append(sentence)
        lines.append(((head, "dim"), *_node(state, words, row, shown, width - len(head), over, signs)))
    return lines


def side_by_side(left: Sequence[Line], right: Sequence[Line], column: int) -> list[Line]:
    """Return the lines of one beside those of another one, which begin at a column."""
    lines: list[Line] = []
    for at in range(max(len(left), len(right))):
        line = left[at] if at < len(left) else ()
        if at < len(right):
            line = (*line, (" " * (column - sum(cell_len(text) for text, _ in line)), ""), *right[at])
        lines.append(line)
    return lines


def robot_line(state: RunState, signs: Signs) -> Line:
    """Return pose, battery, what it holds, its last words."""
    robot = state.robot or RobotState()
    parts: list[str] = []
    if robot.pose is not None:
        pose = robot.pose
        parts.append(f"x {_zero(pose.x, 2)} m  y {_zero(pose.y, 2)} m  heading {_zero(pose.heading, 0)}°")
    if robot.battery is not None:
        parts.append(f"battery {robot.battery:.0f}%")
    held = [f"{name} ({hand})" for hand, name in (("left", robot.left), ("right", robot.right)) if name]
    if held:
        parts.append("holds " + ", ".join(held))
    if state.doing.says:
        parts.append(f'said "{one_line(state.doing.says)}"')
    return (("robot ", "dim"), (signs.apart.join(parts) or "-", ""))


def counts_line(state: RunState, signs: Signs) -> Line:
    """Tick, and overruns if there are many."""
    ticks = (("ticks ", "dim"), (str(state.ticks), ""))
    if not are_many(state.overruns, state.ticks):
        return ticks
    return (*ticks, (f"{signs.apart}overruns ", "dim"), (str(state.overruns), "bold yellow"))


def legend_lines(width: int, signs: Signs) -> list[Line]:
    """Return what the signs in front of the nodes mean."""
    lines: list[Line] = [()]
    for status, meaning in _MEANINGS.items():
        piece = ((f"{signs.statuses[status]} ", _STYLES[status]), (f"{meaning}  ", "dim"))
        if sum(cell_len(text) for text, _ in (*lines[-1], *piece)) > width:
            lines.append(())
        lines[-1] += piece
    return lines


def keys_line(paused: bool, keys: Sequence[tuple[str, str]], signs: Signs) -> Line:
    """Return what each key does."""
    pieces: list[tuple[str, str]] = []
    for key, deed in keys:
        deed = "resume" if paused and deed == "pause" else deed
        pieces += [(key, "bold"), (f" {deed}{signs.apart}", "dim")]
    last = pieces.pop()[0].removesuffix(signs.apart)
    return (*pieces, (last, "dim"))


def prompt_line(question: str, typed: str, width: int, signs: Signs) -> Line:
    """Return what the robot asks, the answer so far, and the keys that aren't a part of it, where there is room."""
    answer = f" {typed}_"
    asked = fit_text(one_line(question), max(8, width - len(answer) - 1), signs)
    keys = signs.apart.join(f"{key} {does}" for key, does in (("Enter", "answers"), *SIGNALS))
    hint = f"   {keys}" if cell_len(asked) + len(answer) + len(keys) + 3 <= width else ""
    return ((asked, "bold yellow"), (answer[-width:], "bold"), (hint, "dim"))


def _node(
    state: RunState, words: ViewWords, row: Row, sentence: str, width: int, over: bool, signs: Signs
) -> list[tuple[str, str]]:
    node = row.node
    status = state.statuses[node]
    if status == SUSPENDED and over:
        status = HALTED
    name, _ = words.of(node)
    end = _seconds(state, node, status) + (f"  ({row.inside} node{'s' * (row.inside > 1)})" if row.inside else "")
    note, note_style = _note(state, row, words, status)
    room = width - 2 - cell_len(end) - min(cell_len(note), width // 2)
    name = fit_text(name, room, signs)
    sentence = fit_text(f"  {sentence}", room - cell_len(name), signs) if sentence else ""
    note = fit_text(note, width - 2 - cell_len(name + sentence + end), signs)
    is_answer = status == FAILURE and words.asked[node]
    styles = ("dim", "dim") if is_answer else (_STYLES[status], _LABELS.get(status, ""))
    pieces = [(signs.statuses[status] + " ", styles[0]), (name, styles[1])]
    pieces += [(sentence, "dim italic"), (end, "cyan" if status == RUNNING else "dim"), (note, note_style)]
    return pieces


def _note(state: RunState, row: Row, words: ViewWords, status: int) -> tuple[str, str]:
    """Return what is to be said of the end of a node, with its style."""
    if status == FAILURE:
        reason = one_line(_reason(state, row, words))
        return (f"  {reason}" if reason else ""), "dim" if words.asked[row.node] else "red"
    is_leaf = state.shape.ends[row.node] == row.node + 1
    return ("  halted" if status == HALTED and is_leaf else ""), "yellow"


def _seconds(state: RunState, node: int, status: int) -> str:
    """Return the time in a status that lasts, or the time that the node took."""
    began = state.started.get(node)
    if began is None or status in (IDLE, SKIPPED):
        return ""
    until = state.now if status == RUNNING else state.ended.get(node, state.now)
    return f"  {until - began:.1f} s" if status == RUNNING or until > began else ""


def _reason(state: RunState, row: Row, words: ViewWords) -> str:
    """Return why a node failed; where it is folded up, which leaf in it failed and why."""
    node, shape = row.node, state.shape
    while row.inside and (failed := [child for child in shape.children(node) if state.statuses[child] == FAILURE]):
        node = failed[-1]
    reason = state.reasons.get(node, "")
    if reason == WAS_TRUE and shape.ends[node + 1] == node + 2:  # it denies a leaf
        reason = f"'{words.of(node + 1)[0]}' was true"
    parts = [words.of(node)[0]] if node != row.node else []
    return ": ".join([*parts, reason] if reason else parts)


def _heads(depths: list[int], step: int, signs: Signs) -> list[str]:
    """Return the branches in front of each row, drawn from the last row up.

    Not by rich.tree: it has no narrow branches, and takes 5 ms for 48 rows of a frame (this: 0.04 ms).
    """
    fork, last_fork, line = (part[:1] + part[2:][-step + 1 :] if step < 4 else part for part in signs.forks)
    heads: list[str] = []
    lines: list[bool] = []  # for each depth, whether a row further down hangs there
    for depth in reversed(depths):
        lines += [False] * (depth + 1 - len(lines))
        above = "".join(line if lines[d] else " " * step for d in range(1, depth))
        heads.append(above + (fork if lines[depth] else last_fork) if depth else "")
        lines[depth] = True
        del lines[depth + 1 :]
    heads.reverse()
    return heads


def fit_text(text: str, width: int, signs: Signs) -> str:
    """Return the text, its end replaced by an ellipsis where it is wider."""
    if cell_len(text) <= width:
        return text
    room = width - len(signs.more)
    return set_cell_size(text, room).rstrip() + signs.more if room > 0 else ""


def _zero(value: float, digits: int) -> str:
    """Return a number without the sign of a zero that comes from rounding."""
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if not text.strip("-0.") else text
