"""What the terminal of `btc robot up` reports, a line each: stops, releases, pauses, questions, tasks that are over."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress

from btlang.task.commands.answers import shorten
from btlang.task.layer import TaskLayer
from btlang.task.live.task_follower import TaskFollower
from btlang.task.store.records import FINAL, TaskChange
from btlang.text.formatting import one_line


class RobotLog:
    """A log of a robot that is up. `write` gets lines; methods may be called from any thread.

    Call `look` when something may have changed. Close it before the layer, whose store it reads.
    """

    def __init__(self, layer: TaskLayer, write: Callable[[str], object]) -> None:
        self._layer, self._write = layer, write
        self._lock = threading.Lock()
        self._stops, self._is_stopped = len(layer.emergency.stops), layer.emergency.is_latched
        self._reason = layer.emergency.reason
        self._is_paused = layer.executor.is_paused
        self._follower = TaskFollower(layer.store, self._report_tasks)
        layer.emergency.listeners.append(self._report_stops)
        layer.world_input.on_question = self._report_question

    def close(self) -> None:
        """Report what has happened until now, and end. May be called twice."""
        self._follower.close()
        if self._report_stops in self._layer.emergency.listeners:
            self._layer.emergency.listeners.remove(self._report_stops)

    def look(self, person: str = "") -> None:
        """Report a stop, a release, a pause or its end since the last look; `person` is who has asked for it."""
        by = f" by {person}" if person else ""
        emergency, executor = self._layer.emergency, self._layer.executor
        self._report_stops()
        with self._lock:
            was_stopped, self._is_stopped = self._is_stopped, emergency.is_latched
            if was_stopped and not self._is_stopped:
                self._reason = ""
                self._report(f"Released{by}: the robot may move again.")
            was_paused, self._is_paused = self._is_paused, executor.is_paused
            if self._is_paused and not was_paused:
                self._report(f"Paused{by}. To go on: btc robot resume")
            elif was_paused and not self._is_paused:
                self._report(f"The pause was ended{by}.")

    def _report_stops(self) -> None:
        """Report stops alone, which need no command: a release comes with who has asked for it."""
        with self._lock:
            stops = self._layer.emergency.stops[self._stops :]
            self._stops, self._is_stopped = self._stops + len(stops), self._is_stopped or bool(stops)
            for reason in stops:
                if reason != self._reason:  # who asks again, to be sure, changes nothing
                    self._report(f"Stopped: {reason}. To let it move: btc robot release")
                self._reason = reason

    def _report_question(self, question: str) -> None:
        self._report(f'Asks "{question}" To answer: btc task answer TEXT')

    def _report_tasks(self, changes: Sequence[TaskChange]) -> None:
        for change in changes:
            if change.state in FINAL:
                task = self._layer.store.task(change.task)
                words = f": {shorten(task.mission)}" if task is not None else ""
                cause = f" ({change.cause})" if change.cause else ""
                self._report(f"Task {change.task} {change.state}{words}{cause}")

    def _report(self, text: str) -> None:
        with suppress(OSError, ValueError):  # the terminal is gone, which stops no robot
            self._write(one_line(f"{time.strftime('%H:%M:%S')}  {text}"))
