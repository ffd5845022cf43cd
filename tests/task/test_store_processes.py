"""Several threads and processes at one store, and processes that are killed."""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.store.records import Act, TaskState
from btlang.task.store.task_store import TaskStore, open_store
from tests.profiles import amount
from tests.task.places import a_task, program

MANY = 120


def lines(started: subprocess.Popen[str]) -> list[str]:
    """What a program prints until its end, from where it was read last."""
    assert started.stdout is not None
    with started, started.stdout:
        return started.stdout.read().splitlines()


def line(started: subprocess.Popen[str]) -> str:
    """What a program prints next."""
    assert started.stdout is not None
    return started.stdout.readline().strip()


def test_no_task_is_claimed_twice(store: TaskStore, place: str) -> None:
    """By threads of this process and other processes."""
    wanted = {store.add(a_task(earliest=float(at % 3), priority=at % 2)).id for at in range(MANY)}
    others = [program("claim", place, stdin=subprocess.PIPE) for _ in range(4)]
    assert [line(other) for other in others] == ["ready"] * 4
    for other in others:
        assert other.stdin is not None
        other.stdin.close()
    claimed: list[int] = []

    def claim(_: int) -> None:
        while (task := store.claim(2.0)) is not None:
            claimed.append(task.id)

    with ThreadPoolExecutor(8) as threads:
        list(threads.map(claim, range(8)))
    claimed += [int(printed) for other in others for printed in lines(other)]
    assert sorted(claimed) == sorted(wanted)
    assert {task.state for task in store.tasks()} == {TaskState.STANDBY}
    assert {task.attempts for task in store.tasks()} == {1}


def test_threads_change_and_read(store: TaskStore) -> None:
    """What one of them reads is never half of what another one writes, and nobody who reads on misses a change."""
    ended = threading.Event()
    seen: list[int] = []

    def work(_: int) -> None:
        for _ in range(15):
            task = store.add(a_task())
            store.change(task.id, [TaskState.QUEUED], TaskState.SKIPPED, time=1.0, ended=1.0)

    def read() -> None:
        while True:
            last = ended.is_set()
            seen.extend(number for number, _ in store.changes(after=seen[-1] if seen else 0))
            if last:
                return

    reader = threading.Thread(target=read)
    reader.start()
    try:
        with ThreadPoolExecutor(6) as threads:
            list(threads.map(work, range(6)))
    finally:
        ended.set()
        reader.join()
    assert seen == list(range(1, 181))
    assert [task.id for task in store.tasks()] == list(range(1, 91))


@pytest.mark.long
def test_threads_do_everything(store: TaskStore) -> None:
    """Few tasks for many threads: none of them waits for one that waits for it."""

    newest = [store.add(a_task()).id]

    def work(seed: int) -> None:
        draw = random.Random(seed)
        for _ in range(amount(15, 2_000)):
            one, mission = max(newest) - draw.randrange(8), f"m{draw.randrange(2)}"
            match draw.randrange(10):
                case 0:
                    newest.append(store.add(a_task()).id)
                case 1 | 2:
                    store.claim(200.0)
                case 3:
                    store.change(one, [TaskState.STANDBY], TaskState.QUEUED, time=1.0)
                case 4:
                    store.change(one, list(TaskState), TaskState.FAILED, time=1.0)
                case 5:
                    store.amend(one, priority=draw.randrange(9))
                case 6:
                    store.clean(5.0)
                case 7:
                    store.put_text(mission, str(draw.random()), "ada", 1.0)
                case 8:
                    store.delete_text(mission, "ada", 1.0)
                case 9:
                    store.log(Act(draw.choice((1.0, 9.0)), "ada", "say", "", ""))

    with ThreadPoolExecutor(8) as threads:
        list(threads.map(work, range(8)))
    last: dict[int, TaskState] = {}
    for _, change in store.changes():
        last[change.task] = change.state
    assert last == {task.id: task.state for task in store.tasks()}


def test_threads_put_texts(store: TaskStore) -> None:
    with ThreadPoolExecutor(6) as threads:
        put = list(threads.map(lambda at: store.put_text("tour", f"wait {at} s", "ada", 1.0).number, range(12)))
    assert sorted(put) == list(range(1, 13))


def test_processes_make_one_store(place: str) -> None:
    started = [program("opened", place) for _ in range(3)]
    assert sorted(printed for one in started for printed in lines(one)) == ["1", "2", "3"]
    assert [one.returncode for one in started] == [0, 0, 0]


def test_a_store_that_another_process_begins_is_waited_for(tmp_path: Path) -> None:
    """SQLite itself doesn't wait where the mode of a file changes that somebody else writes to."""
    place = str(tmp_path / "tasks.db")
    with closing(sqlite3.connect(place, isolation_level=None, check_same_thread=False)) as other:
        other.execute("BEGIN IMMEDIATE")
        end = threading.Timer(0.3, other.execute, ["ROLLBACK"])
        end.start()
        with open_store(place) as store:
            assert store.tasks() == []
        end.join()


def test_a_kill_loses_nothing_that_was_accepted(place: str) -> None:
    adding = program("add", place)
    accepted = [int(line(adding)) for _ in range(30)]
    adding.send_signal(signal.SIGKILL)
    accepted += [int(printed) for printed in lines(adding)]
    with open_store(place) as store:
        kept = [task.id for task in store.tasks()]
        assert kept[: len(accepted)] == accepted
        assert len(kept) <= len(accepted) + 1
        assert [change.task for _, change in store.changes()] == kept
        assert store.add(a_task()).id == len(kept) + 1


@pytest.mark.parametrize("how", ["own", "own_and_fork"])
def test_an_ownership_ends_with_its_process(store: TaskStore, place: str, how: str) -> None:
    """Also where a child process of the owner goes on."""
    owner = program(how, place)
    said = line(owner)
    try:
        with pytest.raises(MissionError) as error:
            store.own()
        [told] = error.value.diagnostics
        assert told.code == "BT197"
        assert f" process {owner.pid}" in told.message
        store.add(a_task())
        owner.kill()
        owner.wait()
        own_soon(store)
    finally:
        owner.kill()
        if how == "own_and_fork":
            os.kill(int(said), signal.SIGKILL)
        lines(owner)


def own_soon(store: TaskStore) -> None:
    """A server needs a moment until it notices the end of a process."""
    for _ in range(200):
        try:
            return store.own()
        except MissionError:
            threading.Event().wait(0.05)
    return store.own()


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_child_process_has_connections_of_its_own(store: TaskStore) -> None:
    task = store.add(a_task())
    store.own()
    [connection] = store._database._idle
    child = os.fork()
    if not child:
        done = 1
        try:
            store.change(task.id, [TaskState.QUEUED], TaskState.FAILED, time=1.0)
            try:
                store.own()
            except MissionError:  # its parent is the owner
                done = 0 if connection not in store._database._idle else 2
        finally:
            os._exit(done)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    store.own()
    assert [found.state for found in store.tasks()] == [TaskState.FAILED]


@pytest.mark.skipif(sys.platform != "linux", reason="how large a file may grow is limited as on Linux")
def test_a_full_disk(tmp_path: Path) -> None:
    """What was accepted stays, nothing is half done, and it goes on when there is room again."""
    place = str(tmp_path / "tasks.db")
    told, accepted, kept, later = lines(program("fill", place))
    assert told == "BT195 it can't be written: the disk may be full."
    assert int(accepted) > 10
    assert kept == f"{accepted} {accepted}"
    assert later == f"{int(accepted) + 1} {int(accepted) + 1}"
    with open_store(place) as store:
        assert [task.id for task in store.tasks()] == list(range(1, int(accepted) + 2))
