"""Does the tasks of a robot, one after the other, on a session: begins, suspends, resumes and ends their runs."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable
from functools import partial

from btlang.api import Mission, value_key
from btlang.diagnostics.errors import MissionError
from btlang.engine.leaves.leaf import described
from btlang.engine.status import RUNNING
from btlang.record import Record
from btlang.run.runner import SUSPENDED
from btlang.session import Run, Session
from btlang.task.database import StoreError
from btlang.task.emergency import EmergencyStop
from btlang.task.house_rules import HouseRules
from btlang.task.manager import ENDED, Manager, recovered
from btlang.task.recordings import Recordings
from btlang.task.store import Store
from btlang.task.task import ACTIVE, FINAL, Restart, State, Task
from btlang.task.watch import RunWatch, commands_of, indices_of, reason_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.events import Sink
    from btlang.run.robot_state import RobotState
    from btlang.run.runner import Outcome

_RETRY = 1.0  # seconds of real time after which a store that could not be written to is tried again
_LOOK = 0.05  # seconds of real time for which an executor waits that can't do anything
_ANSWER = 3.0  # seconds of real time that a mission gets to end when it is asked to, before who asked is answered
_BLOCKED = "house rule"
"""The setting of the store that says why all tasks wait."""


class Ending(Record):
    """What was asked of the run under way: the state that its task gets then, why, by whom, and the token."""

    state: State
    cause: str
    person: str
    token: str = ""


class Executor:
    """Runs tasks in a thread of its own between `start` and `close`; all methods may be called from any thread.

    `missions` reads the mission of a task (MissionError if it can't be). `now` gives the time since 1970, `trouble`
    gets what went wrong, for people. `speed` and `rate` are those of `Session.prepare`, `idle_rate` is the rate between
    tasks. `sinks` makes sinks for the run of a task.
    """

    def __init__(
        self,
        session: Session,
        store: Store,
        manager: Manager,
        emergency: EmergencyStop,
        rules: HouseRules,
        idle: Mission,
        *,
        missions: Callable[[Task], Mission],
        now: Callable[[], float],
        trouble: Callable[[str], object],
        recordings: Recordings | None = None,
        speed: float | str = "real",
        rate: float = 20.0,
        idle_rate: float = 20.0,
        sinks: Callable[[Task], list[Sink]] = lambda task: [],
    ) -> None:
        self._session, self._store, self._manager, self._emergency = session, store, manager, emergency
        self._rules, self._idle_mission = rules, rules.idle or idle
        self._missions, self._now, self._trouble = missions, now, trouble
        self._recordings, self._speed, self._rate, self._idle_rate = recordings, speed, rate, idle_rate
        self._sinks = sinks
        self._changed = threading.Condition()
        self._task: Task | None = None
        self._run: Run | None = None
        self._watch: RunWatch | None = None
        self._ending: Ending | None = None
        self._paused = self._closing = False
        self._unwritten: list[Callable[[], object]] = []  # changes of states that the store hasn't taken yet
        self._next: float | None = None  # when the manager wants to look again
        self._new = True  # somebody has asked for something since the last look
        self._latest = ""  # the run as it was when a command ended or a house rule began to act
        self._thread = threading.Thread(target=self._work, name="btlang executor", daemon=True)

    def start(self) -> None:
        """Takes up what was left when the robot's process ended, then does what is due."""
        self._manager.recover(self._now())
        self._thread.start()

    def close(self) -> None:
        """Ends the run under way as its task says for a restart, and brings the robot to rest. May be called twice."""
        self._closing = True
        run = self._run
        if run is not None:
            run.suspend()
        self.wake()
        if self._thread.is_alive():
            self._thread.join()

    def wake(self) -> None:
        """Something has been asked for: looks at once what is to be done."""
        self._new = True
        with self._changed:
            self._changed.notify_all()
        if self._task is None:
            self._leave_idle()

    @property
    def task(self) -> Task | None:
        """The task under way."""
        return self._task

    @property
    def run(self) -> Run | None:
        """The run under way: of a task, or of the house rules between tasks."""
        return self._run

    @property
    def robot_state(self) -> RobotState | None:
        """What the robot sensed last."""
        return self._watch.robot if self._watch is not None else None

    @property
    def is_paused(self) -> bool:
        """Whether nothing goes on until `resume`."""
        return self._paused

    def hindrance(self) -> str:
        """Why no task may begin now, "" if one may."""
        if self._emergency.is_latched:
            return f"the robot is stopped: {self._emergency.reason}"
        if self._paused:
            return "the robot is paused"
        blocked = self._store.setting(_BLOCKED)
        if blocked:
            return f"a house rule failed: {blocked}"
        if self._task is None and self._acts():
            return "a house rule acts"
        return "the store can't be written to" if self._unwritten else ""

    def pause(self) -> None:
        """The robot comes to rest; the mission under way waits, and none begins."""
        self._paused = True
        run = self._run
        if run is not None and self._task is not None:
            run.pause()
        self.wake()

    def resume(self) -> str:
        """Ends a pause, and lets tasks begin again after a house rule failed; returns what it ended, "" for nothing."""
        ended = ["the pause"] if self._paused else []
        self._paused = False
        if self._store.setting(_BLOCKED):
            for task in self._store.tasks({State.BLOCKED}):
                self._store.change(task.id, {State.BLOCKED}, State.QUEUED, time=self._now(), cause="it may go on")
            self._store.set_setting(_BLOCKED, "")  # last, so that no other task comes before these
            ended.append("the wait for help")
        run = self._run
        if run is not None:
            run.resume()
        self.wake()
        return " and ".join(ended)

    def step(self) -> bool:
        """In a pause, one more tick of the mission under way; False if none is paused."""
        run = self._run
        if not self._paused or run is None or self._task is None:
            return False
        run.step()
        return True

    def end(self, task: int, ending: Ending) -> Task | None:
        """Ends the task under way, if it is this one; returns the task as it is then, or soon will be.

        A task whose mission ends by itself in the same moment has the state of that.
        """
        with self._changed:
            if self._task is None or self._task.id != task or self._run is None:
                return None
            if self._ending is None or self._ending.state is not State.KILLED:
                self._ending = ending
            if ending.state is State.KILLED:
                self._run.emergency_stop()
            elif ending.state is State.DELAYED:
                self._run.suspend()
            else:
                self._run.stop()
            self._changed.wait_for(lambda: self._task is None or self._task.id != task, _ANSWER)
        return self._store.task(task)

    def _work(self) -> None:
        while not self._closing:
            try:
                self._turn()
            except StoreError as error:
                self._trouble(str(error))
                self._rest(_RETRY)

    def _turn(self) -> None:
        while self._unwritten:
            self._unwritten[0]()
            self._unwritten.pop(0)
        self._new = False
        if self.hindrance():
            self._rest(_LOOK)
            return
        now = self._now()
        self._manager.refresh(now)
        self._next = self._manager.next_time(now)
        task = self._manager.claim(now)
        if task is None:
            self._idle()
        elif (hindrance := self.hindrance()) != "":  # it came meanwhile
            self._change(task, State.QUEUED, hindrance)
        else:
            self._do(task)

    def _rest(self, seconds: float) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._new or self._closing, seconds)

    def _idle(self) -> None:
        """Follows the house rules until there is something to do."""
        run = self._session.prepare(self._idle_mission, speed=self._speed, rate=self._idle_rate)
        self._watch = RunWatch(indices_of(run, self._rules.reactions), (), self._leave_idle)
        run.bus.add(self._watch)
        run.after_ticks(self._leave_idle)
        outcome = self._execute(run)
        if outcome.failure is not None:
            self._ask_for_help(outcome.failure.reason)

    def _leave_idle(self) -> None:
        run = self._run
        due = self._next is not None and self._now() >= self._next
        if run is not None and self._task is None and (self._new or due) and not self._acts():
            run.stop()

    def _acts(self) -> bool:
        """Whether a house rule acts now."""
        return self._watch is not None and bool(self._watch.acting)

    def _do(self, task: Task) -> None:
        """The run of a task, from its beginning or from where it was."""
        with self._changed:
            self._task, self._ending = task, None
        try:
            try:
                run = self._prepared(task)
            except MissionError as error:
                self._change(task, State.ERROR, error.diagnostics[0].message)
                return
            self._change(task, State.UNDERWAY, "it goes on" if task.saved else "it begins", started=self._now())
            self._latest = task.saved
            try:
                outcome = self._execute(run)
            except Exception as problem:  # a word or a sink of the user's is broken
                self._change(task, State.ERROR, described(problem))
                return
            self._end(task, run, outcome)
        finally:
            with self._changed:
                self._task = None
                self._changed.notify_all()

    def _prepared(self, task: Task) -> Run:
        mission = self._rules.around(self._missions(task))
        sinks = self._sinks(task)
        recorder = self._recordings.recorder(mission, task.id) if self._recordings is not None else None
        if recorder is not None:
            sinks.append(recorder)
            self._store.amend(task.id, recording=os.path.abspath(recorder.path))
        options: dict[str, Any] = {"speed": self._speed, "rate": self._rate, "sinks": sinks}
        if task.saved:
            run = self._session.restore(mission, json.loads(task.saved), **options)
        else:
            run = self._session.prepare(mission, **options)
            for name, value in task.mission.values.items():
                run.nodes.blackboard.set(value_key(name), value)
        commands = commands_of(run, mission)
        self._watch = RunWatch(indices_of(run, self._rules.reactions), commands, self.wake)
        run.bus.add(self._watch)
        run.after_ticks(partial(self._after_tick, task, run, self._watch))
        return run

    def _after_tick(self, task: Task, run: Run, watch: RunWatch) -> None:
        """In the thread of the run: keeps where it is, and looks whether another task is more urgent."""
        began, ended = watch.take_began(), watch.take_ended()
        try:
            if run.nodes.status != RUNNING:
                if task.restart is Restart.RESUME:  # it takes a moment yet until its state is final
                    self._store.amend(task.id, saved=json.dumps({ENDED: run.nodes.status}))
                return
            if began or ended:
                self._latest = json.dumps(run.save())
            if ended and task.restart is Restart.RESUME:
                self._store.amend(task.id, saved=self._latest)
            now = self._now()
            if not self._new and (self._next is None or now < self._next):
                return
            self._new = False
            for other in self._manager.refresh(now):
                if other.id == task.id:
                    self._ending = Ending(State.CANCELED, "its schedule replaces it", "")
                    run.stop()
            self._next = self._manager.next_time(now)
            if not watch.acting and self._ending is None and self._manager.is_more_urgent(task, now):
                run.save()  # raises if it can't be kept
                self._ending = Ending(State.DELAYED, "a more urgent task comes first", "")
                run.suspend()
        except (StoreError, MissionError) as error:
            self._trouble(str(error))

    def _execute(self, run: Run) -> Outcome:
        self._run = run
        if self._emergency.is_latched:  # it came before this run could be stopped
            run.emergency_stop()
        if self._closing:
            run.suspend()
        if self._paused and self._task is not None:
            run.pause()
        try:
            return run.execute()
        finally:
            self._run = None
            if self._watch is not None:
                self._watch.acting.clear()
            for error in run.sink_errors:
                self._trouble(str(error))

    def _end(self, task: Task, run: Run, outcome: Outcome) -> None:
        """The state of a task whose run is over."""
        ending = self._ending
        if outcome.failure is not None and self._rules.is_own(outcome.failure.path):
            reason = outcome.failure.reason
            self._change(task, State.BLOCKED, f"a house rule failed: {reason}", saved=self._latest)
            self._ask_for_help(reason)
        elif outcome.failure is not None:
            self._change(task, State.FAILED, reason_of(outcome))
        elif not outcome.stopped:
            self._change(task, State.COMPLETED, "" if outcome.seconds else "there was nothing to do")
        elif self._emergency.is_latched:
            self._change(task, State.KILLED, self._emergency.reason)
        elif ending is not None and ending.state is State.DELAYED:
            saved = json.dumps(run.save())
            self._change(task, State.DELAYED, ending.cause, ending.person, saved=saved, token=ending.token)
        elif ending is not None:
            self._change(task, ending.state, ending.cause, ending.person)
        else:
            saved = json.dumps(run.save()) if outcome.stopped == SUSPENDED and task.restart is Restart.RESUME else ""
            if saved:
                self._write(partial(self._store.amend, task.id, saved=saved))
            reason = "the robot was shut down"
            self._write(partial(recovered, task.replace(saved=saved), self._store, self._now(), reason))

    def _ask_for_help(self, reason: str) -> None:
        """A house rule failed: the robot stands still, and people are called."""
        self._write(partial(self._store.set_setting, _BLOCKED, reason))
        self._trouble(f"The robot needs help: a house rule failed: {reason}. It does nothing until 'resume'.")
        say = getattr(self._session.robot, "say", None)
        if say is not None:
            say("I need help.")

    def _change(self, task: Task, state: State, cause: str, person: str = "", **fields: Any) -> None:
        now = self._now()
        if state in FINAL:
            fields |= {"ended": now, "saved": ""}
        self._write(partial(self._store.change, task.id, ACTIVE, state, time=now, cause=cause, person=person, **fields))

    def _write(self, write: Callable[[], object]) -> None:
        """Now, or as soon as the store can be written to: what has happened is not lost."""
        if not self._unwritten:
            try:
                write()
                return
            except StoreError as error:
                self._trouble(str(error))
        self._unwritten.append(write)
