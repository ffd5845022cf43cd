"""What a queue should do with commands: a plain model beside a robot that does them, and random commands for both."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

from btlang.task.store.records import Restart, TaskState

from .driven import HOUR, Driven

Act = tuple[str, int, bool]
Command = tuple[str, dict[str, Any]]

PRINTS = 3
MISSION = " then ".join(f"print {number} then wait 0.2 s" for number in range(PRINTS))
WAITING = (TaskState.QUEUED, TaskState.DELAYED)
ENDS = {"cancel": TaskState.CANCELED, "kill": TaskState.KILLED, "skip": TaskState.SKIPPED}
ACTS = (
    "cancel", "kill", "interrupt", "stop", "down", "crash", "hour", "again", "submit", "submit", "move", "move another",
)  # fmt: skip
"""What happens while a mission is under way."""
RANKS = ("", "more urgent", "interrupt", "cancel", "kill")
"""Of what is asked of a mission at the same moment only the most counts."""


class Expected:
    """What the model knows of a task."""

    def __init__(
        self, priority: int, earliest: int | None, deadline: int | None, restart: Restart, created: int
    ) -> None:
        self.priority, self.bonus, self.position, self.restart = priority, 0, 0, restart
        self.earliest, self.deadline = earliest, deadline
        self.state, self.token = TaskState.QUEUED, ""
        self.has_begun = False
        self.prints = 0
        self.created = created

    def age(self, hour: int) -> None:
        """1 for each ten minutes that it has waited, at most 10."""
        since = self.created if self.earliest is None or self.earliest < self.created else self.earliest + 0.5
        self.bonus = max(self.bonus, min(10, int(6 * (hour - since))))


class Model:
    """The tasks by their numbers. Times are in hours, and between two full ones, so that no second counts."""

    def __init__(self, robot: Driven) -> None:
        self.robot = robot
        robot.empty()
        robot.prepared, robot.printed, robot.ticked = self.prepared, self.printed, self.ticked
        self.tasks: dict[int, Expected] = {}
        self.paused = self.stopped = False
        self.hour = 0
        self.running = 0
        self.meanwhile: list[Act] = []
        self.after_tick: list[Act] = []
        self.crash_at = ""
        self.asked = self.token = ""
        self.goes_down = self.was_stopped = False

    def order(self, *, ready: bool = False) -> list[int]:
        """Of the tasks that wait, or of those that may begin."""
        found = [number for number, task in self.tasks.items() if task.state in WAITING]
        if ready:
            found = [number for number in found if self.is_ready(self.tasks[number])]
        return sorted(found, key=self._turn)

    def _turn(self, number: int) -> tuple[int, int, int]:
        task = self.tasks[number]
        return -task.priority - task.bonus, task.position, number

    def is_ready(self, task: Expected) -> bool:
        in_time = task.has_begun or task.deadline is None or task.deadline >= self.hour
        return not task.token and (task.earliest is None or task.earliest < self.hour) and in_time

    def some(self, number: int) -> int:
        return number % (len(self.tasks) + 2)

    def is_open(self, number: int) -> bool:
        return number in self.tasks and self.tasks[number].state in (*WAITING, TaskState.UNDERWAY)

    def ok(self, command: str, **fields: Any) -> bool:
        return self.robot.ask(command, **fields).ok

    def submit(self, priority: int, earliest: int | None, deadline: int | None, restart: Restart) -> None:
        """Hours from now, each half an hour later."""
        first, last = (None if hours is None else self.hour + hours for hours in (earliest, deadline))
        at, by = (None if hour is None else self.robot.begins + (hour + 0.5) * HOUR for hour in (first, last))
        answer = self.robot.ask("submit", text=MISSION, priority=priority, at=at, by=by, restart=restart)
        could_begin = deadline is None or (deadline >= 0 and (earliest is None or earliest <= deadline))
        assert answer.ok is could_begin
        if not could_begin:
            return
        number = answer.data["task"]["id"]
        assert number not in self.tasks
        self.tasks[number] = Expected(priority, first, last, restart, self.hour)

    def submit_wrongly(self, priority: int) -> None:
        assert not self.ok("submit", text=MISSION, priority=priority)
        assert not self.ok("submit", text="frobnicate")

    def end(self, number: int, act: str) -> None:
        number = self.some(number)
        assert self.ok(act, task=number) is self.is_open(number)
        if self.is_open(number):
            self.tasks[number].state = ENDS[act]

    def interrupt_what_is_not_under_way(self, number: int) -> None:
        assert not self.ok("interrupt", task=self.some(number))

    def let_go_on(self, number: int, right: bool) -> None:
        interrupted = [each for each, task in self.tasks.items() if task.state is TaskState.DELAYED and task.token]
        number = interrupted[number % len(interrupted)] if interrupted else max(1, self.some(number))
        token = self.tasks[number].token if interrupted and right else "x"
        assert self.ok("resume", task=number, token=token) is (bool(interrupted) and right)
        if interrupted and right:
            self.tasks[number].state, self.tasks[number].token = TaskState.QUEUED, ""

    def again(self, number: int) -> None:
        number = self.some(number)
        answer = self.robot.ask("again", task=number)
        assert answer.ok is (number in self.tasks)
        if answer.ok:
            earlier = self.tasks[number]
            self.tasks[answer.data["task"]["id"]] = Expected(earlier.priority, None, None, earlier.restart, self.hour)

    def move(self, number: int, priority: int) -> None:
        number = self.some(number)
        assert self.ok("reorder", task=number, priority=priority) is self.is_open(number)
        if self.is_open(number):
            self.tasks[number].priority = priority

    def move_before(self, number: int, other: int) -> None:
        waiting = self.order()
        if len(waiting) < 2:
            return
        number, other = waiting[number % len(waiting)], waiting[other % len(waiting)]
        if number == other:
            return
        assert self.ok("reorder", task=number, before=other)
        left = sorted(filter(self.is_open, self.tasks), key=self._turn)  # also the one under way: it may be interrupted
        left.remove(number)
        left.insert(left.index(other), number)
        task, after = self.tasks[number], self.tasks[other]
        task.priority, task.bonus = after.priority, after.bonus
        equal = [each for each in left if self._turn(each)[0] == self._turn(other)[0]]
        for position, each in enumerate(equal):
            self.tasks[each].position = position - len(equal)

    def pause(self, paused: bool) -> None:
        assert self.ok("pause" if paused else "resume")
        self.paused = paused

    def stop(self, stopped: bool) -> None:
        assert self.ok("emergency_stop" if stopped else "release")
        self.stopped = stopped

    def time_passes(self, hours: int) -> None:
        self.hour += hours
        self.robot.hours_pass(hours)

    def restart(self) -> None:
        self.robot.restart()
        self.paused = False

    def work(self, meanwhile: list[Act], crashes_first: bool = False) -> None:
        self.running, self.meanwhile, self.after_tick = 0, list(meanwhile), []
        self.asked = self.token = ""
        self.goes_down = self.was_stopped = False
        self.crash_at = "standby" if crashes_first else ""
        if not (self.paused or self.stopped):
            self.skip_the_late()
            for task in self.tasks.values():
                if task.state in WAITING:
                    task.age(self.hour)
            self.running = next(iter(self.order(ready=True)), 0)
        if self.running:
            self.tasks[self.running].state = TaskState.STANDBY
        self.robot.turn()
        if self.running:
            self.ended(self.tasks[self.running])
        if self.robot.has_crashed or self.goes_down:
            self.restart()
        self.running = 0

    def prepared(self) -> None:
        task = self.tasks[self.running]
        if self.crash_at:
            self.robot.crash()
        else:
            self.check()
            task.state, task.has_begun = TaskState.UNDERWAY, True

    def ended(self, task: Expected) -> None:
        """What becomes of the task that was under way."""
        if self.crash_at == "standby":
            task.state = TaskState.QUEUED
        elif self.robot.has_crashed and self.stopped:
            task.state = TaskState.KILLED
        elif self.robot.has_crashed:
            self.cut_off(task)
            if task.restart is Restart.RESUME and self.crash_at == "tick":
                task.prints -= 1  # what the tick of a crash did is not in the store
        elif self.was_stopped:
            task.state = TaskState.KILLED
        elif self.asked in ENDS:
            task.state = ENDS[self.asked]
        elif self.asked:
            task.state, task.token = TaskState.DELAYED, self.token
        elif self.goes_down:
            self.cut_off(task)
        else:
            assert task.prints == PRINTS, f"{task.prints} prints"
            task.state = TaskState.COMPLETED

    def cut_off(self, task: Expected) -> None:
        """As the task says for a restart."""
        task.state = TaskState.ERROR if task.restart is Restart.GIVE_UP else TaskState.QUEUED
        if task.restart is Restart.AGAIN:
            task.prints = 0

    def skip_the_late(self) -> None:
        for task in self.tasks.values():
            is_late = task.deadline is not None and task.deadline < self.hour
            if task.state is TaskState.QUEUED and not task.has_begun and is_late:
                task.state = TaskState.SKIPPED

    def printed(self, number: int, text: str) -> None:
        task = self.tasks[number]
        assert (number, text) == (self.running, str(task.prints)), f"task {number} prints {text}"
        task.prints += 1
        if self.meanwhile and self.meanwhile[0][2]:
            self.do(*self.meanwhile.pop(0))
        if self.meanwhile and not self.meanwhile[0][2]:
            self.after_tick.append(self.meanwhile.pop(0))

    def ticked(self) -> None:
        while self.after_tick:
            self.do(*self.after_tick.pop())

    def do(self, act: str, priority: int, is_in_tick: bool) -> None:
        """While a task is under way."""
        number, task = self.running, self.tasks[self.running]
        if act in ENDS:
            assert self.ok(act, task=number)
            self.asked = max(self.asked, act, key=RANKS.index)
        elif act == "interrupt":
            answer = self.robot.ask("interrupt", task=number)
            assert answer.ok is (self.asked in ("", "more urgent"))
            if answer.ok:
                self.asked, self.token = "interrupt", answer.data["token"]
        elif act == "stop":
            self.was_stopped = True
            self.stop(True)
            if priority > 0:
                self.stop(False)
        elif act == "down":
            self.goes_down = True
            self.robot.layer.halt()
        elif act == "crash":
            self.crash_at = "tick" if is_in_tick else "after"
            self.robot.crash()
            return
        elif act == "hour":
            self.time_passes(1)
        elif act == "again":
            self.again(number)
        elif act == "submit":
            self.submit(priority, None, None, Restart.AGAIN)
        elif act == "move":
            self.move(number, priority)
        elif act == "move another":
            self.move(number + 1, priority)
        self.check()
        if not (self.asked or self.was_stopped or self.goes_down):
            self.skip_the_late()
            if any(self.tasks[other].priority > task.priority for other in self.order(ready=True)[:1]):
                self.asked = "more urgent"

    def check(self) -> None:
        found = {task.id: task.state for task in self.robot.layer.store.tasks()}
        states = {number: task.state for number, task in self.tasks.items()}
        assert found == states, f"{found} instead of {states}"
        listed = [task["id"] for task in self.robot.ask("list").data["tasks"]]
        order = [self.running] * bool(self.running) + self.order()
        assert listed == order, f"{listed} instead of {order}"


def _meanwhile(draw: Random) -> list[Act]:
    """At the prints of a mission: what happens, a priority for it, and whether in the tick of the print or after it."""
    count = draw.choice((0, 0, 1, 1, 2, 2, PRINTS))
    return [(draw.choice(ACTS), draw.randint(-2, 2), draw.random() < 0.5) for _ in range(count)]


def _hours(draw: Random) -> int | None:
    return draw.choice((None, None, None, -1, 0, 1, 2))


_DRAWN: dict[str, tuple[int, Callable[[Random], dict[str, Any]]]] = {
    "submit": (12, lambda draw: {
        "priority": draw.randint(-2, 2), "earliest": _hours(draw), "deadline": _hours(draw),
        "restart": draw.choice(list(Restart)),
    }),
    "submit_wrongly": (1, lambda draw: {"priority": draw.choice((-1000, -101, 101, 1000))}),
    "end": (2, lambda draw: {"number": draw.randint(0, 50), "act": draw.choice(list(ENDS))}),
    "interrupt_what_is_not_under_way": (1, lambda draw: {"number": draw.randint(0, 50)}),
    "let_go_on": (4, lambda draw: {"number": draw.randint(0, 50), "right": draw.random() < 0.8}),
    "again": (1, lambda draw: {"number": draw.randint(0, 50)}),
    "move": (2, lambda draw: {"number": draw.randint(0, 50), "priority": draw.randint(-2, 2)}),
    "move_before": (2, lambda draw: {"number": draw.randint(0, 50), "other": draw.randint(0, 50)}),
    "pause": (3, lambda draw: {"paused": draw.random() < 0.2}),
    "stop": (5, lambda draw: {"stopped": draw.random() < 0.1}),
    "time_passes": (2, lambda draw: {"hours": draw.randint(1, 3)}),
    "restart": (1, lambda draw: {}),
    "work": (15, lambda draw: {"meanwhile": _meanwhile(draw), "crashes_first": draw.random() < 0.05}),
}  # fmt: skip
"""How often each method of the model is called, and with what."""


def drawn_commands(draw: Random) -> list[Command]:
    """Some dozen."""
    weights = [weight for weight, _ in _DRAWN.values()]
    names = draw.choices(list(_DRAWN), weights, k=draw.randint(10, 30))
    return [(name, _DRAWN[name][1](draw)) for name in names]


def smallest(commands: list[Command], fails: Callable[[list[Command]], bool]) -> list[Command]:
    """Those without which it doesn't fail."""
    index = 0
    while index < len(commands):
        name, fields = commands[index]
        simpler: list[list[Command]] = [[]]
        if fields.get("meanwhile"):
            simpler.append([(name, {**fields, "meanwhile": fields["meanwhile"][:-1]})])
        for instead in simpler:
            fewer = [*commands[:index], *instead, *commands[index + 1 :]]
            if fails(fewer):
                commands = fewer
                break
        else:
            index += 1
    return commands
