"""The message handler: does what commands say, and answers with what happened or why not."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from functools import partial

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.report import report_crash
from btlang.speech.marks import without_marks
from btlang.task import messages
from btlang.task.commands.answers import describe_times, messages_data, refusal_data, task_data, with_warnings
from btlang.task.commands.checks import (
    check_labels,
    check_priority,
    check_values,
    choose_member,
    refusal_error,
    task_times,
)
from btlang.task.commands.robot_handlers import ComponentHandler, VoiceHandler, WorldHandler
from btlang.task.commands.store_handlers import LibraryHandler, ScheduleHandler, unknown_text_error
from btlang.task.commands.store_reader import StoreReader
from btlang.task.execution.emergency import EmergencyLatch
from btlang.task.execution.executor import Executor
from btlang.task.execution.manager import TaskManager
from btlang.task.messages import Answer, Command, wrong
from btlang.task.store.database import StoreError
from btlang.task.store.records import ACTIVE, FINAL, WAITING, Act, MissionText, RequestedEnd, Restart, Task, TaskState
from btlang.task.store.task_store import TaskStore
from btlang.text.formatting import one_line
from btlang.text.json_text import NestedTooDeep, dump_json
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.world_input import WorldInput
    from btlang.session import Session
    from btlang.task.commands.store_handlers import Warned

_BEGINNING = 3.0  # seconds of real time that a task may take from its claim to its first tick
_MOMENT = 0.01


class Handler:
    """A handler of all commands.

    `handle` may be called from any thread. `admit` reads a mission for this robot and refuses what it can't do, with
    all reasons (MissionError); `now` gives the time since 1970, `down` ends the process, `needs` is what a mission
    needs, `overs` is what robot files of others may run on, `world_input` a sink of all runs.
    """

    def __init__(
        self,
        store: TaskStore,
        manager: TaskManager,
        executor: Executor,
        emergency: EmergencyLatch,
        session: Session,
        admit: Callable[[MissionText], Mission],
        now: Callable[[], float],
        down: Callable[[], object],
        needs: Callable[[MissionText], tuple[str, ...]],
        overs: Collection[str],
        world_input: WorldInput,
    ) -> None:
        self._store, self._manager, self._executor, self._emergency = store, manager, executor, emergency
        self._session, self._admit, self._now, self._down, self._needs = session, admit, now, down, needs
        self._reader = StoreReader(store, manager, now, executor.hindrance, lambda: world_input.question)
        self._world_input = world_input
        self._interrupted: tuple[str, ...] = ()  # the words of the commands at which the latest pause came
        schedules = ScheduleHandler(store, executor.wake, self._mission, now)
        library = LibraryHandler(store, admit, now, getattr(session.robot, "body", None), overs)
        components, world = ComponentHandler(session), WorldHandler(session, world_input)
        self._does: dict[type[Command], Callable[[Any, str], Answer]] = {
            messages.Submit: self._submit, messages.List: self._reader.list, messages.Show: self._reader.show,
            messages.Cancel: partial(self._end, TaskState.CANCELED),
            messages.Kill: partial(self._end, TaskState.KILLED),
            messages.Interrupt: self._interrupt, messages.Resume: self._resume, messages.Skip: self._skip,
            messages.Reorder: self._reorder, messages.Again: self._again, messages.AddSchedule: schedules.add,
            messages.RemoveSchedule: schedules.remove, messages.Schedules: schedules.list,
            messages.Put: library.put, messages.Delete: library.delete, messages.Library: library.list,
            messages.Pause: self._pause, messages.Step: self._step, messages.EmergencyStop: self._stop,
            messages.Release: self._release, messages.Say: self._say, messages.Down: self._end_all,
            messages.Status: self._status, messages.Report: self._reader.report,
            messages.Trail: self._reader.trail,
            messages.Components: components.list, messages.ChangeComponent: components.change,
            messages.Picture: components.picture, messages.AnswerQuestion: world.answer,
            messages.Talk: world.talk,
            messages.InviteVisitor: world.invite, messages.Voice: VoiceHandler(session).sound,
            messages.Urdf: components.urdf,
        }  # fmt: skip

    def do(self, command: Command, person: str) -> Answer:
        """Do a command, without a trail. Raises MissionError where it is refused."""
        return self._does[type(command)](command, person)

    def handle(self, command: Command, person: str) -> Answer:
        """Do a command of a person, who is allowed to give it; a refusal is an answer, too."""
        try:
            answer = self.do(command, person)
        except MissionError as error:
            first = error.diagnostics[0]
            answer = Answer(False, str(error), refusal_data(error), first.code)
        except Exception as problem:  # whoever asked gets an answer, and the others go on
            if os.environ.get("BTC_DEBUG"):
                raise
            answer = Answer(False, report_crash(problem), {}, "BT099")
        if command.changes:
            self._log(command, person, answer)
        return answer

    def add(self, mission: MissionText, person: str, **fields: Any) -> Task:
        """Queue a mission that was admitted, with these fields of its task. Raises StoreError."""
        task = Task(0, mission, person, self._now(), needs=self._needs(mission), **fields)
        task = self._store.add(task, "it was submitted")
        self._executor.wake()
        return task

    def _log(self, command: Command, person: str, answer: Answer) -> None:
        with suppress(MissionError, NestedTooDeep):  # then it was refused for the same, or needs no store
            details = dump_json(messages.as_json(command), str, ensure_ascii=False)
            self._store.log(Act(self._now(), person, command.tag, details, answer.text))

    def _submit(self, command: messages.Submit, person: str) -> Answer:
        earliest, deadline = task_times(command, self._now())
        mission, warnings = self._mission(command)
        task = self.add(
            mission, person, priority=check_priority(command.priority, command.tag),
            labels=check_labels(command.labels, command.tag), earliest=earliest, deadline=deadline,
            restart=choose_member(Restart, command.restart, "restart", command.tag),
        )  # fmt: skip
        text = " ".join((f"Task {task.id} is queued.", *describe_times(earliest, deadline, self._now())))
        return Answer(True, with_warnings(text, warnings), {"task": task_data(task), **messages_data(warnings)})

    def _end(self, state: TaskState, command: messages.Cancel | messages.Kill, person: str) -> Answer:
        task = self._open(command.task)
        cause = _cause(command.reason, person)
        ended, until = None, time.monotonic() + _BEGINNING
        while ended is None:
            now = self._now()
            ended = self._executor.end(task.id, RequestedEnd(state, cause, person)) or self._store.change(
                task.id, WAITING, state, time=now, cause=cause, person=person, ended=now
            )
            if ended is None:  # it ends at this moment, or is about to begin
                time.sleep(_MOMENT)
                known = self._reader.known(task.id)
                ended = known if known.state in FINAL or time.monotonic() > until else None
        self._executor.wake()
        if ended.state is state:
            return Answer(True, f"Task {task.id} is {state}.", {"task": self._reader.data(ended)})
        if ended.state in FINAL:
            raise refusal_error(task.id, f"was already over: {ended.state}")
        return Answer(True, f"Task {task.id} is about to be {state}.", {"task": self._reader.data(ended)})

    def _interrupt(self, command: messages.Interrupt, person: str) -> Answer:
        task = self._open(command.task)
        token, cause = os.urandom(8).hex(), _cause(command.reason, person)
        run = self._executor.run
        if self._executor.task is not None and self._executor.task.id == task.id and run is not None:
            run.save()  # raises if it can't be kept
        ended = self._executor.end(task.id, RequestedEnd(TaskState.DELAYED, cause, person, token))
        if ended is None:
            state = self._reader.known(task.id).state
            raise refusal_error(
                task.id, "ends already" if state is TaskState.UNDERWAY else f"isn't under way: it's {state}"
            )
        if ended.state in FINAL:
            raise refusal_error(task.id, f"was already over: {ended.state}")
        text = f"Task {task.id} is interrupted. To let it go on, use the token {token}."
        return Answer(True, text, {"task": self._reader.data(ended), "token": token})

    def _resume(self, command: messages.Resume, person: str) -> Answer:
        if not command.task:
            was_paused, ended = self._executor.is_paused, self._executor.resume()
            if was_paused:
                self._note_pause("it goes on after a pause", person)
            text = f"That ends {ended}." if ended else "Nothing was paused."
            if not ended and self._emergency.is_latched:
                text += " The robot is stopped until 'release'."
            return Answer(True, text, {"ended": ended})
        task = self._open(command.task)
        if task.state is not TaskState.DELAYED or not task.token:
            raise refusal_error(task.id, f"wasn't interrupted: it's {task.state}")
        if not command.token:
            raise refusal_error(task.id, "was interrupted, and only the token of that lets it go on: --token TOKEN")
        if command.token != task.token:
            raise refusal_error(task.id, "has another token: it was interrupted again, or by somebody else")
        cause = f"{person or 'somebody'} lets it go on"
        resumed = self._store.change(
            task.id, {TaskState.DELAYED}, TaskState.QUEUED, time=self._now(), cause=cause, person=person, token=""
        )
        if resumed is None:
            raise refusal_error(task.id, "has changed meanwhile")
        self._executor.wake()
        return Answer(True, f"Task {task.id} continues when its turn comes.", {"task": self._reader.data(resumed)})

    def _skip(self, command: messages.Skip, person: str) -> Answer:
        task, now = self._open(command.task), self._now()
        cause = _cause(command.reason, person)
        skipped = self._store.change(
            task.id, WAITING, TaskState.SKIPPED, time=now, cause=cause, person=person, ended=now
        )
        if skipped is None:
            raise refusal_error(task.id, "has begun, so it can't be skipped: cancel it")
        self._executor.wake()
        return Answer(True, f"Task {task.id} is skipped.", {"task": self._reader.data(skipped)})

    def _reorder(self, command: messages.Reorder, person: str) -> Answer:
        task = self._open(command.task)
        if (command.priority is None) is (command.before == 0):
            raise wrong("reorder", "it needs either 'priority' or 'before'")
        if command.priority is not None:
            moved = self._store.amend(task.id, priority=check_priority(command.priority, command.tag))
        else:
            moved = self._move_before(task, self._open(command.before))
        self._executor.wake()
        assert moved is not None
        return Answer(True, f"Task {task.id} has a new place.", {"task": self._reader.data(moved)})

    def _move_before(self, task: Task, other: Task) -> Task | None:
        if task.id == other.id:
            raise refusal_error(task.id, "can't come before itself")
        for each in (task, other):
            if each.state in ACTIVE:
                raise refusal_error(each.id, f"has begun: it's {each.state}")
        return self._store.move_before(task.id, other.id)

    def _again(self, command: messages.Again, person: str) -> Answer:
        task = self._reader.known(command.task)
        fresh = Task(
            0,
            task.mission,
            person,
            self._now(),
            priority=task.priority,
            labels=task.labels,
            restart=task.restart,
            needs=task.needs,
        )
        self._admit(task.mission)
        made = self._store.add(fresh, f"like task {task.id}")
        self._executor.wake()
        return Answer(True, f"Task {made.id} is queued.", {"task": task_data(made)})

    def _pause(self, command: messages.Pause, person: str) -> Answer:
        run, task = self._executor.run, self._executor.task
        was_paused = self._executor.is_paused
        if not was_paused:
            self._interrupted = () if run is None or task is None else run.snapshot().running
        self._executor.pause()
        if not was_paused:
            self._note_pause("paused", person)
        at = _paused_at(task, self._interrupted)
        text = f"The robot is paused.{f' {at} It goes on with: btc robot resume' if at else ''}"
        return Answer(True, text, {"task": 0 if task is None else task.id, "interrupted": list(self._interrupted)})

    def _note_pause(self, cause: str, person: str) -> None:
        """Keep what became of the task under way, for who asks later why it took so long."""
        task = self._executor.task
        if task is not None:
            with suppress(StoreError):  # the pause counts, whether it can be written down or not
                under_way = {TaskState.UNDERWAY}
                self._store.change(task.id, under_way, TaskState.UNDERWAY, time=self._now(), cause=cause, person=person)

    def _step(self, command: messages.Step, person: str) -> Answer:
        if not self._executor.step():
            raise refusal_error("The robot", "has no paused mission to step")
        return Answer(True, "One tick.", {})

    def _stop(self, command: messages.EmergencyStop, person: str) -> Answer:
        self._emergency.stop(person, command.reason)
        self._executor.wake()
        return Answer(True, "The robot is stopped. Nothing moves it until 'release'.", {})

    def _release(self, command: messages.Release, person: str) -> Answer:
        if not self._emergency.is_latched:
            return Answer(True, "The robot isn't stopped.", {})
        try:
            self._emergency.release()
        except OSError as error:
            raise MissionError([diagnostic("BT195", NOWHERE, place="the latch", reason=str(error))]) from None
        self._executor.wake()
        return Answer(True, "The robot may move again.", {})

    def _say(self, command: messages.Say, person: str) -> Answer:
        say = getattr(self._session.robot, "say", None)
        if say is None:
            raise refusal_error("The robot", "has no voice")
        run = self._executor.run
        call = partial(say, without_marks(command.text))
        if run is not None:
            run.call(call)
        else:
            call()
        return Answer(True, f'The robot says "{one_line(command.text)}".', {})

    def _end_all(self, command: messages.Down, person: str) -> Answer:
        self._down()
        return Answer(True, "The robot goes down.", {})

    def _status(self, command: messages.Status, person: str) -> Answer:
        run, task, hindrance = self._executor.run, self._executor.task, self._executor.hindrance()
        snapshot = None if run is None or task is None else run.snapshot()
        state = self._executor.robot_state
        data: dict[str, Any] = {
            "stopped": self._emergency.reason, "paused": self._executor.is_paused, "hindrance": hindrance,
            "task": None if task is None else self._reader.data(self._reader.known(task.id)),
            "running": [] if snapshot is None else list(snapshot.running),
            "battery": None if state is None else state.battery,
            "holds": {hand: thing for hand in ("left", "right") if (thing := getattr(state, hand, None))},
            "waiting": self._store.count_tasks(WAITING),
            "question": "" if task is None else self._world_input.question,
            "rules": self._executor.rules.words, "next_schedule": self._next_schedule(),
        }  # fmt: skip
        running = f": {', '.join(data['running'])}" if data["running"] else ""
        doing = "It has nothing to do" if task is None else f"Task {task.id} is under way{running}"
        lines = [f"{hindrance[0].upper()}{hindrance[1:]}." if hindrance else f"{doing}."]
        if data["question"]:
            asked = f'It waits for an answer to "{one_line(data["question"])}".'
            lines.append(f"{asked} To answer: btc task answer TEXT")
        if data["paused"] and (at := _paused_at(task, self._interrupted)):
            lines.append(at)
        lines.append(f"{data['waiting']} waiting." if data["waiting"] else "Nothing waits.")
        return Answer(True, "\n".join(lines), data)

    def _next_schedule(self) -> float | None:
        """Return when a schedule is due next, None if none is."""
        return min((each.next for each in self._store.schedules() if each.next is not None), default=None)

    def _mission(self, command: messages.Submit | messages.AddSchedule) -> Warned:
        """Return the mission of a command, which this robot can do, and what it is warned of."""
        text, name, revision = command.text, command.name, 0
        if not text:
            if not name:
                raise wrong(command.tag, "it needs 'text' or 'name'")
            found = self._store.text(name)
            if found is None:
                raise unknown_text_error(name)
            text, revision = found.text, found.number
        mission = MissionText(text, name, revision, dict(command.values), command.keywords)
        admitted = self._admit(mission)
        check_values(admitted, mission.values)
        return mission, admitted.warnings

    def _open(self, number: int) -> Task:
        task = self._reader.known(number)
        if task.state in FINAL:
            raise refusal_error(number, f"was already over: {task.state}")
        return task


def _paused_at(task: Task | None, interrupted: Sequence[str]) -> str:
    """Say what a pause interrupted, "" where nothing was under way."""
    if task is None:
        return ""
    words = one_line(", ".join(interrupted))
    return f"Task {task.id} was under way{f': {words}' if words else ''}."


def _cause(reason: str, person: str) -> str:
    return reason or f"{person or 'somebody'} asked for it"
