"""Hands on what becomes of the tasks of this process, in a thread."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence

from btlang.engine.leaves.leaf import describe_exception
from btlang.task.store.database import StoreError
from btlang.task.store.records import TaskChange
from btlang.task.store.task_store import TaskStore

_RETRY = 1.0  # seconds after which a store that could not be read is asked again
_REST = 4.0  # times as long as it took: many changes are handed on together then


class TaskFollower:
    """A thread that hands the changes of this process's tasks to `changed`, each once and in order.

    It begins with the changes that come after it was made, until `close`. `changed` may raise StoreError: then it gets
    the same changes again. `trouble` gets what else it raises, for people.
    """

    def __init__(
        self,
        store: TaskStore,
        changed: Callable[[Sequence[TaskChange]], object],
        trouble: Callable[[str], object] = lambda text: None,
    ) -> None:
        self._store, self._changed, self._trouble = store, changed, trouble
        self._last = store.latest_change()
        self._closed = threading.Event()
        self._news = threading.Event()
        store.listeners.append(self._news.set)
        self._thread = threading.Thread(target=self._work, name="btlang follower", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Hand on what has happened until now, and end. May be called twice."""
        if not self._closed.is_set():
            self._store.listeners.remove(self._news.set)
            self._closed.set()
            self._news.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _work(self) -> None:
        is_last = False
        while not is_last:
            self._news.wait()
            self._news.clear()
            is_last, began = self._closed.is_set(), time.monotonic()
            try:
                found = self._store.changes(after=self._last)
                if found:
                    self._changed([change for _, change in found])
                    self._last = found[-1][0]
            except StoreError:
                self._news.set()
                self._closed.wait(_RETRY)
            except Exception as problem:  # the next ones may do better
                self._last = found[-1][0]
                self._trouble(f"An error inside btlang: {describe_exception(problem)}")
            else:
                self._closed.wait(_REST * (time.monotonic() - began))
