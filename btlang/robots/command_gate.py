"""Who may command a robot: the latch of a stop, and the proxy through which background leaves command it."""

from __future__ import annotations

from collections.abc import Callable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Latch:
    """A latch that refuses commands after a stop; open at first.

    `shut` and `stop` may be called from any thread and from signal handlers: there is no lock. `stop` refuses commands
    until the next `step`, so that a tick in flight can't undo it; `shut` until `open`, which only the start of a run,
    or its continuation after a pause, may call.
    """

    __slots__ = ("_shut", "_stopping")

    def __init__(self) -> None:
        self._shut = self._stopping = False

    @property
    def refuses(self) -> bool:
        """Whether commands are refused now."""
        return self._shut or self._stopping

    def stop(self) -> None:
        """Refuse commands until the next step."""
        self._stopping = True

    def shut(self) -> None:
        """Refuse commands until `open`."""
        self._shut = True

    def step(self) -> None:
        """Begin a step."""
        self._stopping = False

    def open(self) -> None:
        """Let commands through again."""
        self._shut = self._stopping = False


_UNDO: dict[str, Callable[..., object]] = {
    "drive": lambda robot, *velocity: robot.drive(0.0, 0.0) if any(velocity) else None,
    "move_joints": lambda robot, targets: robot.freeze_joints(*targets),
    "say": lambda robot, *said: robot.silence(),
}
"""How to end what a command has started; an operation that it returned is cancelled."""


class RobotProxy:
    """A robot for background leaves, whose methods run in the thread that ticks, by `in_tick`.

    Only `stop` reaches the robot at once. See `btlang.engine.leaves.background.Work.in_tick`.
    """

    __slots__ = ("_in_tick", "_robot", "_undo")

    def __init__(self, robot: Any, in_tick: Callable[[Callable[[], Any]], Any]) -> None:
        self._robot, self._in_tick = robot, in_tick
        self._undo: dict[str, Callable[[], object]] = {}

    def stop(self) -> None:
        """Stop the robot, from any thread."""
        self._robot.stop()

    def __getattr__(self, name: str) -> Any:
        if not callable(getattr(type(self._robot), name, None)):
            return self._in_tick(lambda: getattr(self._robot, name))
        return lambda *args, **named: self._in_tick(lambda: self._do(name, args, named))

    def let_go(self) -> None:
        """End what the leaf has started; for the thread that ticks, once the leaf was halted or has failed."""
        undo, self._undo = self._undo, {}
        for end in undo.values():
            end()

    def _do(self, name: str, args: tuple[Any, ...], named: dict[str, Any]) -> Any:
        result = getattr(self._robot, name)(*args, **named)
        if name in _UNDO:
            self._undo[name] = lambda: _UNDO[name](self._robot, *args, *named.values())
        elif hasattr(result, "cancel"):
            self._undo[name] = result.cancel
        return result
