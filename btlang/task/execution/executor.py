"""Does the tasks of a robot, one after the other, on a session: begins, suspends, resumes and ends their runs."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Callable
from functools import partial

from btlang.api import Mission, value_key
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.leaves.leaf import describe_exception
from btlang.engine.status import RUNNING, SKIPPED
from btlang.house_rules import HouseRules
from btlang.run.outcome import EMERGENCY, SUSPENDED
from btlang.run.sampler import Sampler
from btlang.session import Run, Session
from btlang.task.execution.emergency import EmergencyLatch
from btlang.task.execution.manager import ENDED, TaskManager, describe_recovery
from btlang.task.execution.run_sinks import Recordings, RunWatch, add_sinks, commands_of, indices_of, reason_of
from btlang.task.store.database import Outbox, StoreError
from btlang.task.store.records import ACTIVE, FINAL, MissionText, RequestedEnd, Restart, Task, TaskState
from btlang.task.store.task_store import TaskStore

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.events import Sink
    from btlang.run.outcome import Outcome
    from btlang.run.robot_state import RobotState

_RETRY = 1.0  # seconds of real time after which a store that could not be written to is tried again
_LOOK = 0.05  # seconds of real time for which an executor waits that can't do anything
_END = 8.0  # seconds of real time that a mission gets to halt and to bring the robot to rest
_ANSWER = 3.0  # seconds of real time that a mission gets to end when it is asked to, before who asked is answered
NOTHING_TO_DO = "there was nothing to do"
"""The reason of a task whose mission was skipped as a whole."""
_BLOCKED, _SCANS = "house rule", 1.0  # the setting that says why all tasks wait; scans in a second of a recording


class Executor:
    """A thread that runs tasks between `start` and `halt`; all methods may be called from any thread.

    `missions` reads a mission (MissionError if it can't be). `now` gives the time since 1970, `trouble` gets what went
    wrong, for people. `speed` and `rate` are those of `Session.prepare`, `idle_rate` is the rate between tasks. `sinks`
    makes sinks for a run that is about to begin: of a task, or None for the house rules between tasks.
    """

    def __init__(
        self,
        session: Session,
        store: TaskStore,
        manager: TaskManager,
        emergency: EmergencyLatch,
        rules: HouseRules,
        idle: Mission,
        *,
        missions: Callable[[MissionText], Mission],
        now: Callable[[], float],
        trouble: Callable[[str], object],
        recordings: Recordings | None = None,
        speed: float | str = "real",
        rate: float = 20.0,
        idle_rate: float = 20.0,
        sinks: Callable[[Task | None, Mission, Run], list[Sink]] = lambda task, mission, run: [],
    ) -> None:
        self._session, self._store, self._manager, self._emergency = session, store, manager, emergency
        self.rules, self._idle_mission = rules, rules.idle or idle
        self._missions, self._now, self._trouble = missions, now, trouble
        self._recordings, self._speed, self._rate, self._idle_rate = recordings, speed, rate, idle_rate
        self._sinks = sinks
        self._changed = threading.Condition()
        self._task: Task | None = None
        self._run: Run | None = None
        self._watch: RunWatch | None = None
        self._ending: RequestedEnd | None = None
        self._paused = self._closing = self._hangs = False
        self._outbox = Outbox(trouble, lambda: None if recordings is None else recordings.make_room())
        self._next: float | None = None  # when the manager wants to look again
        self._new = True  # somebody has asked for something since the last look
        self._stops = 0  # emergency stops before the turn under way
        self._latest = ""  # the run as it was when a command ended or a house rule began to act
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Take up what was left when the robot's process ended, then do what is due, until `halt`."""
        self._manager.recover(self._now(), self._emergency.reason)
        self._closing = self._hangs = False
        self._thread = threading.Thread(target=self._work, name="btlang executor", daemon=True)
        self._thread.start()

    def halt(self) -> bool:
        """End the run under way as its task says for a restart, and bring the robot to rest. May be called twice.

        False if a command hangs: then the robot was stopped, and the executor goes on once that command ends.
        """
        self._closing = True
        run, thread = self._run, self._thread
        if run is not None:
            run.suspend()
        self.wake()
        if thread is None:
            return True
        thread.join(0.0 if self._hangs else _END)
        if not thread.is_alive():
            return True
        if run is not None and not self._hangs:
            run.emergency_stop()
            self._trouble("The mission doesn't end because a command hangs; the robot was stopped.")
        self._hangs, self._closing = True, False  # who asks again need not wait again
        return False

    @property
    def is_at_work(self) -> bool:
        """Return whether it does what is due: between `start` and `halt`."""
        return self._thread is not None and self._thread.is_alive()

    def wake(self) -> None:
        """Look at once what is to be done: something has been asked for."""
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
        """The latest state that the robot sensed."""
        return self._watch.robot if self._watch is not None else None

    @property
    def is_paused(self) -> bool:
        """Return whether nothing goes on until `resume`."""
        return self._paused

    def hindrance(self) -> str:
        """Return why no task may begin now, "" if one may."""
        return self._hindrance() or ("" if self.is_at_work else "the robot isn't at work")

    def _hindrance(self) -> str:
        if self._emergency.is_latched:
            return f"the robot is stopped: {self._emergency.reason}"
        if self._paused:
            return "the robot is paused"
        blocked = self._store.setting(_BLOCKED)
        if blocked:
            return f"a house rule failed: {blocked}"
        if self._task is None and self.is_rule_acting:
            return "a house rule acts"
        return "the store can't be written to" if self._outbox else ""

    def pause(self) -> None:
        """Bring the robot to rest; the mission under way waits, and none begins."""
        self._paused = True
        run = self._run
        if run is not None and self._task is not None:
            run.pause()
        self.wake()

    def resume(self) -> str:
        """End a pause, and let tasks begin again after a house rule failed; return what it ended, "" for nothing."""
        ended = ["the pause"] if self._paused else []
        self._paused = False
        if self._store.setting(_BLOCKED):
            for task in self._store.tasks({TaskState.BLOCKED}):
                self._store.change(
                    task.id, {TaskState.BLOCKED}, TaskState.QUEUED, time=self._now(), cause="it may go on"
                )
            self._store.set_setting(_BLOCKED, "")  # last, so that no other task comes before these
            ended.append("the wait for help")
        run = self._run
        if run is not None:
            run.resume()
        self.wake()
        return " and ".join(ended)

    def step(self) -> bool:
        """Run one more tick of the mission under way, in a pause; return False if none is paused."""
        run = self._run
        if not self._paused or run is None or self._task is None:
            return False
        run.step()
        return True

    def end(self, task: int, ending: RequestedEnd) -> Task | None:
        """End the task under way, if it is this one; return the task as it is then, or soon will be.

        A task whose mission ends by itself in the same moment has the state of that.
        """
        with self._changed:
            if self._task is None or self._task.id != task or self._run is None:
                return None
            if self._ending is None or ending.outranks(self._ending):
                self._ending = ending
                ends = {TaskState.KILLED: self._run.emergency_stop, TaskState.DELAYED: self._run.suspend}
                ends.get(ending.state, self._run.stop)()
            elif ending.state is TaskState.DELAYED:  # it ends already, or has another token
                return None
            self._changed.wait_for(lambda: self._task is None or self._task.id != task, _ANSWER)
        return self._store.task(task)

    def _work(self) -> None:
        while not self._closing:
            try:
                self._turn()
            except StoreError as error:
                self._trouble(str(error))
                self._rest(_RETRY)
            except Exception as problem:  # nothing may end the executor but `halt`
                self._trouble(f"An error inside btlang: {describe_exception(problem)}")
                self._rest(_RETRY)

    def _turn(self) -> None:
        self._new, self._stops = False, len(self._emergency.stops)  # first: who waits for the store looks no more often
        self._outbox.flush()
        now = self._now()
        if self._hindrance():
            self._rest(_LOOK)
            return
        self._manager.recover(now)  # a task whose claim was kept although the answer to it was lost
        self._manager.tidy(now)
        self._manager.refresh(now)
        self._next = self._manager.next_time(now)
        task = self._manager.claim(now)
        if task is None:
            self._idle()
        elif (hindrance := self._hindrance()) != "":  # it came meanwhile
            self._change(task, TaskState.QUEUED, hindrance)
        else:
            self._do(task)

    def _rest(self, seconds: float) -> None:
        with self._changed:
            self._changed.wait_for(lambda: self._new or self._closing, seconds)

    def _idle(self) -> None:
        """Follow the house rules until there is something to do."""
        run = self._session.prepare(self._idle_mission, speed=self._speed, rate=self._idle_rate)
        self._watch = RunWatch(indices_of(run, self.rules.reactions), (), self._leave_idle)
        add_sinks(run, self._watch, *self._sinks(None, self._idle_mission, run))
        run.after_ticks(self._leave_idle)
        outcome = self._execute(run)
        if outcome.failure is not None:
            self._ask_for_help(outcome.failure.reason)

    def _leave_idle(self) -> None:
        run = self._run
        due = self._next is not None and self._now() >= self._next
        if run is not None and self._task is None and (self._new or due) and not self.is_rule_acting:
            run.stop()

    @property
    def is_rule_acting(self) -> bool:
        """Return whether a house rule acts now, during a task or between tasks."""
        return self._watch is not None and bool(self._watch.acting)

    def _do(self, task: Task) -> None:
        """Run a task, from its beginning or from where it was."""
        with self._changed:
            self._task, self._ending = task, None
        try:
            try:
                run = self._prepare(task)
                self._change(task, TaskState.UNDERWAY, "it goes on" if task.saved else "it begins", started=self._now())
                self._latest = task.saved
                outcome = self._execute(run)
            except MissionError as error:
                self._change(task, TaskState.ERROR, error.diagnostics[0].message)
            except (Exception, SystemExit) as problem:  # a word or a sink of the user's is broken
                self._change(task, TaskState.ERROR, describe_exception(problem))
            else:
                self._end(task, run, outcome)
        finally:
            if self._recordings is not None:
                self._recordings.end()
            with self._changed:
                self._task = None
                self._changed.notify_all()

    def _prepare(self, task: Task) -> Run:
        mission = self.rules.around(self._missions(task.mission))
        recorder = self._recordings.recorder(mission, task) if self._recordings is not None else None
        if recorder is not None:
            self._outbox.write(partial(self._store.amend, task.id, recording=os.path.abspath(recorder.path)))
        options: dict[str, Any] = {"speed": self._speed, "rate": self._rate, "sinks": [recorder] if recorder else []}
        if task.saved:
            run = self._session.restore(mission, json.loads(task.saved), **options)
        else:
            run = self._session.prepare(mission, **options)
            for name, value in task.mission.values.items():
                run.nodes.blackboard.set(value_key(name), value)
        commands = commands_of(run, mission)
        self._watch = RunWatch(indices_of(run, self.rules.reactions), commands, self.wake)
        samplers = [Sampler(run.bus, run.nodes.blackboard, _SCANS)] if recorder is not None else []
        add_sinks(run, self._watch, *self._sinks(task, mission, run), *samplers)
        run.after_ticks(partial(self._after_tick, task, run, self._watch))
        return run

    def _after_tick(self, task: Task, run: Run, watch: RunWatch) -> None:
        """Keep where the run is, and look whether another task is more urgent. In the thread of the run."""
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
                    self._ending = RequestedEnd(TaskState.CANCELED, "its schedule replaces it", "")
                    run.stop()
            self._next = self._manager.next_time(now)
            if not watch.acting and self._ending is None and self._manager.is_more_urgent(task, now):
                run.save()  # raises if it can't be kept
                self._ending = RequestedEnd(TaskState.DELAYED, "a more urgent task comes first", "")
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
            self._run, self._hangs = None, False
            if self._watch is not None:
                self._watch.acting.clear()
            for error in run.sink_errors:
                self._trouble(str(error))

    def _end(self, task: Task, run: Run, outcome: Outcome) -> None:
        """Set the state of a task whose run is over."""
        ending, standstill = self._ending, outcome.standstill
        warning = f"WARNING: {standstill}" if standstill.alarming else ""

        def change(state: TaskState, cause: str, *person: str, **fields: Any) -> None:
            self._change(task, state, "; ".join(filter(None, (cause, warning))), *person, **fields)

        if outcome.failure is not None and self.rules.is_own(outcome.failure.path):
            reason = outcome.failure.reason
            change(TaskState.BLOCKED, f"a house rule failed: {reason}", saved=self._latest)
            self._ask_for_help(reason)
        elif outcome.failure is not None:
            change(TaskState.FAILED, reason_of(outcome.failure, run.mission.vocabulary))
        elif not outcome.stopped:
            change(TaskState.COMPLETED, NOTHING_TO_DO if outcome.status == SKIPPED else " ".join(outcome.unanswered))
        elif outcome.stopped == EMERGENCY and len(self._emergency.stops) > self._stops:  # perhaps it's released already
            change(TaskState.KILLED, self._emergency.stops[-1])
        elif ending is not None and ending.state is TaskState.DELAYED:
            saved = json.dumps(run.save())
            change(TaskState.DELAYED, ending.cause, ending.person, saved=saved, token=ending.token)
        elif ending is not None:
            change(ending.state, ending.cause, ending.person)
        else:
            saved = json.dumps(run.save()) if outcome.stopped == SUSPENDED and task.restart is Restart.RESUME else ""
            if saved:
                self._outbox.write(partial(self._store.amend, task.id, saved=saved))
            begun, reason = task.replace(state=TaskState.UNDERWAY, saved=saved), "the robot was shut down"
            self._outbox.write(partial(describe_recovery, begun, self._store, self._now(), reason))

    def _ask_for_help(self, reason: str) -> None:
        """Keep the robot still after a house rule failed, and call people."""
        self._outbox.write(partial(self._store.set_setting, _BLOCKED, reason))
        self._trouble(f"The robot needs help: a house rule failed: {reason}. It does nothing until 'btc robot resume'.")
        say = getattr(self._session.robot, "say", None)
        if say is not None:
            say("I need help.")

    def _change(self, task: Task, state: TaskState, cause: str, person: str = "", **fields: Any) -> None:
        now = self._now()
        if state in FINAL:
            fields |= {"ended": now, "saved": ""}
        self._outbox.write(
            partial(self._store.change, task.id, ACTIVE, state, time=now, cause=cause, person=person, **fields)
        )
