"""Breakpoints and replacements of nodes, as Groot2 sets them (Monitor::Hook of BehaviorTree.CPP).

One difference: BehaviorTree.CPP blocks the tick, while the robot goes on with its last command. Here a breakpoint
pauses the run: the robot comes to rest, and the commands that the pause interrupted start over when it goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from threading import Lock

from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.monitor.groot_protocol import NAMES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled

BEFORE, AFTER = 0, 1
"""The places of a hook: before a node begins, or when it has ended."""
BREAK, REPLACE = 0, 1
"""The actions of a hook: it pauses until it is unlocked, or gives the node a status."""


class Hook:
    """One hook. `wanted` is the status that it gives, SKIPPED for what the node itself does."""

    __slots__ = ("enabled", "index", "mode", "once", "position", "unlocked", "waiting", "wanted")

    def __init__(self, data: Mapping[str, Any]) -> None:
        """Raise ValueError, KeyError or TypeError for what is no hook."""
        self.waiting = self.unlocked = False
        self.index = _index(data)
        self.position, self.mode = int(data["position"]), int(data["mode"])
        if self.position not in (BEFORE, AFTER) or self.mode not in (BREAK, REPLACE):
            raise ValueError("unknown position or mode")
        self.enabled, self.once = bool(data["enabled"]), bool(data["once"])
        self.wanted = NAMES[data["desired_status"]]

    def data(self) -> dict[str, Any]:
        """Return the hook as Groot2 writes it."""
        name = next(name for name, status in NAMES.items() if status is self.wanted or status == self.wanted)
        return {
            "enabled": self.enabled, "uid": self.index + 1, "mode": self.mode, "once": self.once,
            "desired_status": name, "position": self.position,
        }  # fmt: skip


def _index(data: Mapping[str, Any]) -> int:
    return int(data["uid"]) - 1


class Breakpoints:
    """The hooks of one run. `reached` is called with the index of a node whose breakpoint pauses the run.

    `pause` and `resume` are those of the run. Hooks are set from another thread than that which ticks.
    """

    def __init__(
        self, pause: Callable[[], object], resume: Callable[[], object], reached: Callable[[int], object]
    ) -> None:
        self._pause, self._resume, self._reached = pause, resume, reached
        self._lock = Lock()
        self._hooks: dict[tuple[int, int], Hook] = {}
        self._are_on = True

    def wrap(self, index: int, compiled: Compiled) -> Compiled:
        """Return the same node, which its hooks are asked for when it begins and when it has ended."""
        tick, halt = compiled
        hooks, running = self._hooks, False

        def hooked() -> int:
            nonlocal running
            if not running and (index, BEFORE) in hooks:
                given = self._ask(index, BEFORE, SKIPPED)
                if given != SKIPPED:
                    return given
            status = tick()
            running = status == RUNNING
            if status in (SUCCESS, FAILURE) and (index, AFTER) in hooks:
                given = self._ask(index, AFTER, status)
                return status if given == SKIPPED else given
            return status

        def hooked_halt(keep: bool) -> None:
            nonlocal running
            running = False
            halt(keep)

        return hooked, hooked_halt

    def _ask(self, index: int, position: int, status: int) -> int:
        """Return the status that a hook gives, RUNNING while it is to be unlocked, SKIPPED for the node's own."""
        with self._lock:
            hook = self._hooks.get((index, position))
            if hook is None or not hook.enabled or not self._are_on:
                return SKIPPED
            if hook.mode == BREAK and not hook.unlocked and position == BEFORE:
                if not hook.waiting:
                    hook.waiting = True
                    self._pause()
                    self._reached(index)
                return RUNNING
            if hook.mode == BREAK and position == AFTER:  # it has ended: the run pauses behind it
                self._pause()
                self._reached(index)
                hook.waiting = True
            hook.waiting = hook.unlocked = False
            if hook.once:
                del self._hooks[index, position]
            return hook.wanted if hook.wanted in (SUCCESS, FAILURE) else SKIPPED

    def insert(self, data: Mapping[str, Any], size: int) -> None:
        """Set a hook, or changes the one in its place. Raises ValueError, KeyError or TypeError."""
        hook = Hook(data)
        if not 0 <= hook.index < size:
            raise ValueError("Node ID not found")
        with self._lock:
            before = self._hooks.get((hook.index, hook.position))
            self._hooks[hook.index, hook.position] = hook
        if before is not None and before.waiting and (hook.mode == REPLACE or not hook.enabled):
            self._resume()

    def unlock(self, data: Mapping[str, Any]) -> None:
        """Go on at a breakpoint, with a status for the node or not. Raises ValueError, KeyError or TypeError."""
        status = NAMES[data["desired_status"]]
        with self._lock:
            hook = self._hooks.get((_index(data), int(data["position"])))
            if hook is None:
                raise ValueError("Node ID not found")
            hook.wanted = status if status in (SUCCESS, FAILURE) else SKIPPED
            hook.unlocked, hook.once = True, hook.once or bool(data["remove_when_done"])
        self._resume()

    def remove(self, data: Mapping[str, Any]) -> None:
        """Raise ValueError, KeyError or TypeError."""
        with self._lock:
            hook = self._hooks.pop((_index(data), int(data["position"])), None)
        if hook is None:
            raise ValueError("Node ID not found")
        if hook.waiting:
            self._resume()

    def remove_all(self) -> None:
        """Remove all, and let what waits go on."""
        with self._lock:
            waiting = any(hook.waiting for hook in self._hooks.values())
            self._hooks.clear()
        if waiting:
            self._resume()

    def enable(self, are_on: bool) -> None:
        """Turn breakpoints on or off: nothing stops at one while nobody is there to go on."""
        with self._lock:
            goes_on = self._are_on and not are_on and any(hook.waiting for hook in self._hooks.values())
            self._are_on = are_on
            for hook in self._hooks.values():
                hook.waiting = hook.waiting and are_on
        if goes_on:
            self._resume()

    def disable_all(self) -> None:
        """Turn each off until it is set again."""
        with self._lock:
            waiting = any(hook.waiting for hook in self._hooks.values())
            for hook in self._hooks.values():
                hook.enabled = hook.waiting = False
        if waiting:
            self._resume()

    def data(self) -> list[dict[str, Any]]:
        """Return all hooks, as Groot2 writes them."""
        with self._lock:
            return [hook.data() for hook in self._hooks.values()]
