"""What `btc run` does: a run with its lines, its log, and at the end what failed."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.render import underlined
from btlang.engine.status import FAILURE, SKIPPED
from btlang.run.json_log import JsonLog
from btlang.run.lines import Lines
from btlang.run.runner import Outcome
from btlang.text.source import Source, Span
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol, TextIO

    from btlang.run.events import Sink

    class Runnable(Protocol):
        """What can be run from the command line."""

        def run(self, *, speed: float | str, rate: float, time_limit: float | None, sinks: list[Sink]) -> Outcome: ...

        @property
        def sink_errors(self) -> list[Exception]: ...

        def label(self, node: Node) -> str: ...

        def is_action(self, node: Node) -> bool: ...


def run_mission(
    tree: Runnable, *, speed: float | str, rate: float, time_limit: float | None, log: str | None, quiet: bool
) -> int:
    """Runs and reports; returns the exit code. Raises MissionError where the log cannot be written (BT009)."""
    sinks: list[Sink] = [] if quiet else [Lines(tree.label, tree.is_action, _print)]
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)  # as Ctrl-C, from the first moment on
    try:
        with _opened(log) as file:
            if file is not None:
                sinks.append(JsonLog(file, tree.label))
            outcome = tree.run(speed=speed, rate=rate, time_limit=time_limit, sinks=sinks)
        for error in tree.sink_errors if log is not None else ():
            if isinstance(error, OSError):
                raise error
    except BrokenPipeError:
        raise
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        name = log or "the output"
        raise MissionError([diagnostic("BT009", Span(Source("", name), 0, 0), file=name, reason=reason)]) from None
    finally:
        signal.signal(signal.SIGTERM, before)
    if outcome.status == FAILURE:
        print(failure_report(outcome, tree.label), file=sys.stderr)
        return 1
    if not quiet:
        print(_ending(outcome))
    return 130 if outcome.stopped == "interrupted" else 0


def _opened(log: str | None) -> AbstractContextManager[TextIO | None]:
    if log is None:
        return nullcontext()
    return open(log, "w", encoding="utf-8", errors="backslashreplace")  # a mission may hold what UTF-8 does not


def failure_report(outcome: Outcome, label: Callable[[Node], str]) -> str:
    """Which sentence failed, at which leaf, and why."""
    lines = [f"The mission failed after {outcome.seconds:.1f} s."]
    failure = outcome.failure
    if failure is not None:
        span = failure.node.span
        if span is not None:
            sentence = span.text.splitlines()[0] if failure.node.children else label(failure.node)
            lines += [f"{span.place}: {sentence}", *underlined(span)]
        asked = "the mission says so" if failure.node.id == "AlwaysFailure" else "it does not hold"
        lines.append(f"  {failure.node.id}: {failure.reason or asked}")
    return "\n".join(lines)


def _ending(outcome: Outcome) -> str:
    seconds = f"{outcome.seconds:.1f} s"
    if outcome.stopped == "interrupted":
        return f"Interrupted after {seconds}; the robot stands still."
    if outcome.stopped:
        return f"Stopped after {seconds}, as asked; the robot stands still."
    if outcome.status == SKIPPED:
        return f"The mission had nothing to do ({seconds}): every command was skipped."
    return f"The mission succeeded in {seconds}."


def _print(line: str) -> None:
    print(line, flush=True)
