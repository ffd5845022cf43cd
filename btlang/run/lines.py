"""Plain lines for people: what the robot does, when it starts and how it ends."""

from __future__ import annotations

from collections.abc import Callable

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED
from btlang.run.events import Overrun, StatusChanged, StatusesChanged
from btlang.text.escaping import one_line
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.events import Event

_WORDS = {IDLE: "halted", RUNNING: "start", FAILURE: "failed", SKIPPED: "skipped"}


class PlainLines:
    """A sink that writes a line at the start and at the end of each action, and what the robot says or bumps into.

    A leaf that takes too long for a tick is reported the first time only.
    `label` gives the words for a node, `is_action` whether it is an action; `write` gets lines without an end.
    """

    def __init__(
        self, label: Callable[[Node], str], is_action: Callable[[Node], bool], write: Callable[[str], object]
    ) -> None:
        self._label = label
        self._is_action = is_action
        self._write = write
        self._slow: set[str] = set()  # paths of leaves

    def __call__(self, event: Event) -> None:
        if isinstance(event, StatusesChanged):
            for change in event:
                if is_asked_wait(change.node) or self._is_action(change.node):
                    self._action(change, event.valued.get(change.index, change.node))
        elif isinstance(event, Overrun):
            self._overrun(event)
        elif words := event.words:
            word, _, rest = words.partition(" ")
            self._line(event.t, word, rest)

    def _action(self, event: StatusChanged, node: Node) -> None:
        reason = f": {event.reason}" if event.reason else ""
        self._line(event.t, _WORDS.get(event.status, "done"), self._label(node) + reason)

    def _overrun(self, event: Overrun) -> None:
        if event.node is not None and event.path not in self._slow:
            self._slow.add(event.path)
            took = f"took {brief(event.leaf_seconds)} s, but a tick has only {brief(event.period)} s"
            self._line(event.t, "slow", f"{self._label(event.node)}: {took}")

    def _line(self, t: float, word: str, rest: str) -> None:
        self._write(f"{t:7.2f}  {word:<6} {one_line(rest)}".rstrip())


def brief(seconds: float) -> str:
    """Write seconds with two digits that matter, however few they are."""
    return f"{seconds:.2f}" if seconds >= 0.1 else f"{seconds:.2g}"


def is_asked_wait(node: Node) -> bool:
    """Return whether a node is a wait that a sentence asks for; the timers inside `for` and `every` have no
    sentence.
    """
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.is_wait and node.span is not None
