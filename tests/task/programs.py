"""Programs that use a store in processes of their own: python -m tests.task.programs NAME PLACE. They print a line for
each thing that is done.
"""

from __future__ import annotations

import os
import resource
import sys
import time

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.store.task_store import TaskStore, open_store
from tests.task.places import a_task


def add(store: TaskStore) -> None:
    """Tasks until it is killed; a line is printed after the task was accepted."""
    while True:
        print(store.add(a_task("wave then nod")).id, flush=True)


def claim(store: TaskStore) -> None:
    """All that there are, once the other end of its input is closed."""
    print("ready", flush=True)
    sys.stdin.read()
    while (task := store.claim(1_000.0)) is not None:
        print(task.id, flush=True)


def opened(store: TaskStore) -> None:
    """Nothing: it is opened, and one task is added."""
    print(store.add(a_task()).id, flush=True)


def own(store: TaskStore) -> None:
    """The ownership, until it is killed."""
    store.own()
    print("owned", flush=True)
    time.sleep(600)


def own_and_fork(store: TaskStore) -> None:
    """The same, with a child process that outlives it."""
    store.own()
    child = os.fork()
    if child:
        print(child, flush=True)
    time.sleep(600)


def fill(store: TaskStore) -> None:
    """Adds tasks until the file may not grow any more, and one when it may again."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    store.add(a_task())
    resource.setrlimit(resource.RLIMIT_FSIZE, (1_000_000, hard))
    accepted = 1
    try:
        while accepted < 10_000:
            store.add(a_task("wave " * 200))
            accepted += 1
    except MissionError as error:
        print(error.diagnostics[0].code, error.diagnostics[0].message.partition("used: ")[2])
    print(accepted)
    print(len(store.tasks()), len(store.changes()))
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    store.add(a_task())
    print(len(store.tasks()), len(store.changes()))


def powerless(place: str) -> None:
    """Opens it as a user who may write nowhere there."""
    if os.geteuid() == 0:
        os.setgroups([])
        os.setgid(65_534)
        os.setuid(65_534)
    try:
        open_store(place).add(a_task())
    except MissionError as error:
        print(error.diagnostics[0].code, error.diagnostics[0].message.partition("used: ")[2])


if __name__ == "__main__":
    name, at = sys.argv[1:]
    if name == "powerless":
        powerless(at)
    else:
        with open_store(at) as one:
            {run.__name__: run for run in (add, claim, opened, own, own_and_fork, fill)}[name](one)
