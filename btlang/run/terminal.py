"""What `btc run` does: a run with its lines, its log, and at the end what failed."""

from __future__ import annotations

import os
import signal
import sys
import time
from _thread import start_new_thread
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress

from btlang.diagnostics.diagnostic import MissionError, render
from btlang.diagnostics.files import unwritable
from btlang.engine.blackboard import Blackboard
from btlang.engine.status import FAILURE
from btlang.run.controls import PATIENCE, Controls, emergency_signal
from btlang.run.logs import JsonLog, PlainLines, brief
from btlang.run.outcome import Outcome, Standstill
from btlang.run.pace import are_many
from btlang.run.sampler import Sampler
from btlang.run.world_input import WorldInput
from btlang.text.output import can_draw, has_colour, show
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, TextIO

    from btlang.run.bus import Bus
    from btlang.run.events import Sink
    from btlang.run.live.board import Map
    from btlang.run.live.view import LiveView, ViewKey

    class PreparedRun(Protocol):
        """A run as the terminal needs it; see btlang.session.Run."""

        @property
        def sink_errors(self) -> list[Exception]: ...

        @property
        def bus(self) -> Bus: ...

        def execute(self) -> Outcome: ...

    class RunnerSession(Protocol):
        """A session as the terminal needs it; see btlang.session.Session."""

        def map(self, unicode: bool) -> Map | None: ...

        @property
        def prepare(self) -> Callable[..., PreparedRun]: ...

    class Monitor(Protocol):
        """A monitor of a run; see btlang.monitor.groot.GrootMonitor."""

        hooks: Any

        def watch_run(self, run: Any, mission: Any) -> None: ...

    class RunnableMission(Protocol):
        """A mission that can be run from the command line; see btlang.api.Mission."""

        @property
        def tree(self) -> Tree: ...

        def label(self, node: Node) -> str: ...

        def is_action(self, node: Node) -> bool: ...


ENDING_SIGNALS = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""A signal to end, and that the terminal is gone, as far as the system has them."""
EMERGENCY_STOPPED = 131
"""The exit code after an emergency stop, as 130 is that after Ctrl-C: 128 and the signal of the keys."""
STILL_MOVING = 3
"""The exit code where the robot goes on moving at the end, whatever the mission came to."""
_AGAIN = 0.05  # seconds after which a signal that was lost is sent again; Python has long left its callback by then
_LEAST_SIZE = os.terminal_size((30, 10))  # of a terminal in which the live view is of use


def run_mission(
    mission: RunnableMission,
    open_session: Callable[[], AbstractContextManager[RunnerSession]],
    *,
    speed: float | str,
    rate: float,
    time_limit: float | None,
    log: str | None,
    quiet: bool,
    lines: bool = False,
    type_ahead: list[str] | None = None,
    tree_stays: bool = True,
    sinks: Iterable[Sink] = (),
    values: Blackboard | None = None,
    seed: int | None = None,
    answers: Mapping[str, list[str]] | None = None,
    scans: float | None = None,
    open_monitors: Iterable[Callable[[Controls], AbstractContextManager[Monitor]]] = (),
    limit_option: str = "",
) -> int:
    """Run and report; return the exit code. Raises MissionError where the log cannot be opened (BT009).

    A log that cannot be written to the end does not change the mission: it is said after it, and a mission that
    succeeded has the exit code 2. On a terminal it shows the live view, whose tree stays at the end or not and which
    puts keys that aren't for it into `type_ahead`, if given; elsewhere and where `lines` is true plain lines; and
    nothing when `quiet`. `sinks` get all events too, with `scans` also samples of the blackboard and so many scans a
    second; `open_session` gives the session to run in, `values` and `seed` are as for Session.prepare. `open_monitors`
    give what shows the run to other programs, such as Groot2 and a browser. `answers` are those of WorldInput. A note
    on standard error says that a mission without a time limit has no end, and offers `limit_option`, if given.
    """
    if time_limit is None and not quiet:
        _note_endless(mission.tree, limit_option)
    controls, world_input = Controls(), WorldInput(answers)
    view = None if quiet or lines else live_view(mission, controls, type_ahead, tree_stays, world_input=world_input)
    shown: list[Sink] = (
        [view] if view is not None else [] if quiet else [PlainLines(mission.label, mission.is_action, show)]
    )
    sinks = [*shown, world_input, *sinks]
    values = Blackboard() if values is None else values
    options = {"speed": speed, "rate": rate, "time_limit": time_limit, "values": values, "controls": controls}
    options["seed"] = seed
    try:
        with (
            interrupted_by_signals() as came,
            emergency_signal(controls.emergency_stop, controls.disable, PATIENCE, quits=True),
            _open(log) as file,
            view if view is not None else nullcontext(),
            _open_monitors(open_monitors, controls) as monitors,
            open_session() as session,
        ):
            if file is not None:
                sinks.append(JsonLog(file, mission.label))
            options["hooks"] = next((monitor.hooks for monitor in monitors if monitor.hooks is not None), None)
            if view is not None:
                view.show_map(session.map(view.unicode))
            run = session.prepare(mission, sinks=sinks, **options)
            for monitor in monitors:
                monitor.watch_run(run, mission)
            if scans is not None:
                run.bus.add(Sampler(run.bus, values, scans))
            outcome = run.execute()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise MissionError([unwritable(log or "the output", error)]) from None
    if outcome.worst is not None and are_many(outcome.overruns, outcome.ticks) and not quiet:
        show(_too_slow(outcome, *outcome.worst, mission.label))
    for slow in run.bus.slow:
        show(f"An event sink was too slow: the run waited {slow.seconds:.1f} s for it.", sys.stderr)
    if outcome.status == FAILURE:
        show("\n".join((outcome.why(colour=has_colour(sys.stderr)), *outcome.unanswered)), stream=sys.stderr)
    elif not quiet:
        show(outcome.summary)
    if unused := world_input.unused_answers():
        show(unused, sys.stderr)
    lost = [error for error in run.sink_errors if isinstance(error, OSError)]
    for failed in [error for error in run.sink_errors if not isinstance(error, OSError)]:
        show(f"An event sink failed: {failed}", sys.stderr)
    for full in lost:
        show(render(unwritable(full.filename or log or "the output", full), has_colour(sys.stderr)), sys.stderr)
    if warn_of_motion(outcome.standstill):
        return STILL_MOVING
    if outcome.stopped in ("interrupted", "emergency stop"):
        return EMERGENCY_STOPPED if outcome.stopped == "emergency stop" else 128 + came[0] if came else 130
    return 1 if outcome.status == FAILURE else 2 if lost else 0


def _note_endless(tree: Tree, limit_option: str) -> None:
    """Say that a mission has no end and how to end it, where this is certain."""
    from btlang.passes.lint.endings import FAILURE, NEVER, SKIPPED, SUCCESS, find_mission_ends

    ends = find_mission_ends(tree)
    if not ends & NEVER or ends & (SUCCESS | SKIPPED):
        return
    what = "only ends if something in it fails" if ends & FAILURE else "has no end"
    limit = f", or run it with a time limit, such as {limit_option}" if limit_option else ""
    show(f"note: This mission {what}. To end it, press Ctrl-C{limit}.", sys.stderr)


def warn_of_motion(standstill: Standstill) -> bool:
    """Warn on standard error where the robot does not stand still for good; return whether it moves."""
    if standstill.alarming:
        show(f"WARNING: {standstill}.", sys.stderr)
    return bool(standstill.moving)


class _Interrupt:
    """The handler that interrupts for a signal, as Ctrl-C does, and keeps those that came."""

    def __init__(self) -> None:
        self.came: list[int] = []

    def __call__(self, number: int, _: object) -> None:
        self.came.append(number)
        raise KeyboardInterrupt(number)


def _send_later(number: int) -> None:
    time.sleep(_AGAIN)
    os.kill(os.getpid(), number)


@contextmanager
def interrupted_by_signals() -> Iterator[list[int]]:
    """Let a signal to end, or that the terminal is gone, interrupt as Ctrl-C does; a caller's own handler stays.

    The list keeps those that came; where one is inside another they share it.
    """
    handler = next((found for found in map(signal.getsignal, ENDING_SIGNALS) if isinstance(found, _Interrupt)), None)
    if handler is not None:
        yield handler.came
        return
    handler, before = _Interrupt(), sys.unraisablehook

    def send_again(lost: sys.UnraisableHookArgs) -> None:
        """Python drops what is raised in a callback of its own, such as that of an import: then nothing would end."""
        if isinstance(lost.exc_value, KeyboardInterrupt):
            # A `threading.Thread` would wait here until it runs, and the signal would be lost again in that wait.
            start_new_thread(_send_later, (next(iter(lost.exc_value.args), signal.SIGINT),))
        else:
            before(lost)

    sys.unraisablehook = send_again
    taken = [number for number in ENDING_SIGNALS if signal.getsignal(number) == signal.SIG_DFL]
    for number in taken:
        signal.signal(number, handler)
    try:
        yield handler.came
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)
        sys.unraisablehook = before


def live_view(
    mission: RunnableMission,
    controls: Controls,
    type_ahead: list[str] | None = None,
    tree_stays: bool = True,
    keys: Callable[[], Sequence[ViewKey]] | None = None,
    world_input: WorldInput | None = None,
) -> LiveView | None:
    """Make the live view; None where standard output is no terminal in which it can be shown."""
    output = sys.stdout
    if output is None or not can_draw(output):
        return None
    try:
        columns, rows = os.get_terminal_size(output.fileno())
    except (OSError, ValueError):
        return None
    if columns < _LEAST_SIZE.columns or rows < _LEAST_SIZE.lines:
        return None
    from btlang.engine.instance import EngineError
    from btlang.run.live.view import LiveView

    try:
        shown = keys() if keys else None
        return LiveView(mission, controls, output, sys.stdin, tree_stays, type_ahead, shown, world_input)
    except EngineError:
        return None  # the run itself reports what is wrong


@contextmanager
def _open_monitors(
    open_monitors: Iterable[Callable[[Controls], AbstractContextManager[Monitor]]], controls: Controls
) -> Iterator[list[Monitor]]:
    with ExitStack() as stack:
        yield [stack.enter_context(open_monitor(controls)) for open_monitor in open_monitors]


@contextmanager
def _open(log: str | None) -> Iterator[TextIO | None]:
    if log is None:
        yield None
        return
    file = open(log, "w", encoding="utf-8", errors="backslashreplace")  # noqa: SIM115  # its lines are flushed, and
    try:  # who wrote them knows what was lost: an error on closing adds nothing
        yield file
    finally:
        with suppress(OSError):
            file.close()


def _too_slow(outcome: Outcome, node: Node, seconds: float, label: Callable[[Node], str]) -> str:
    ticks = f"{outcome.overruns} of {outcome.ticks} ticks took too long"
    return f'{ticks}; the slowest leaf was "{label(node)}" with {brief(seconds)} s.'
