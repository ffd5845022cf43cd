"""The rest of the reference interpreter: nodes beside the plain ones, and what scripts decide."""

from __future__ import annotations

import json
from collections import deque
from itertools import pairwise
from typing import Any, cast

from btlang.engine.blackboard import Blackboard
from btlang.engine.script.script import compile_script
from btlang.engine.script.values import ScriptFailed, truth
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

from .reference_node import ReferenceNode

STATUSES = {"SUCCESS": SUCCESS, "FAILURE": FAILURE, "SKIPPED": SKIPPED, "RUNNING": RUNNING}


class MoreNodes(ReferenceNode):
    """Scripts, leaves that ship, decorators and Nav2's nodes; reference.py has the others."""

    # scripts in ports

    def run(self, code: str) -> Any:
        """The value of a script. Raises ScriptFailed where it cannot go on."""
        return compile_script(code)(cast(Blackboard, self.board))

    def run_script(self, port: str) -> Any:
        """The value of a script; None where there is none, or where it cannot go on."""
        text = self.node.port(port)
        try:
            return self.run(text) if text else None
        except ScriptFailed:
            return None

    def asked(self, port: str) -> bool | None:
        """None where the port is empty. Raises ScriptFailed."""
        text = self.node.port(port)
        return truth(self.run(text)) if text else None

    def decided(self) -> int:
        try:
            if not self.started:
                if self.asked("_failureIf"):
                    return FAILURE
                if self.asked("_successIf"):
                    return SUCCESS
                if self.asked("_onlyIf") is False or self.asked("_skipIf"):
                    return SKIPPED
            return SKIPPED if self.asked("_while") is False else IDLE
        except ScriptFailed:
            self.mission.unknowns += 1
            return FAILURE

    def afterwards(self, result: int) -> int:
        if result in (SUCCESS, FAILURE):
            for port in ("_onSuccess" if result == SUCCESS else "_onFailure", "_post"):
                text = self.node.port(port)
                try:
                    if text:
                        self.run(text)
                except ScriptFailed:
                    return FAILURE
        return result

    # leaves

    def Script(self) -> int:
        try:
            self.run(self.node.port("code"))
        except ScriptFailed:
            return FAILURE
        return SUCCESS

    def ScriptCondition(self) -> int:
        try:
            return SUCCESS if self.asked("code") else FAILURE
        except ScriptFailed:
            self.mission.unknowns += 1
            return FAILURE

    def SetBlackboard(self) -> int:
        """The random trees set texts that stand for numbers, and x holds a number where it holds anything."""
        key, value = self.node.port("output_key"), self.node.port("value")
        self.board.set(key, int(value) if key in self.board and isinstance(self.board.get(key), int) else value)
        return SUCCESS

    def UnsetBlackboard(self) -> int:
        self.board.unset(self.node.port("key"))
        return SUCCESS

    def WasEntryUpdated(self) -> int:
        return SUCCESS if self.updated() else FAILURE

    def updated(self) -> bool:
        key = self.node.port("entry").strip("{}")
        if key not in self.board:
            return False
        before, self.seen = self.seen, self.board.writes(key)
        return bool(before != self.seen)

    # one child of several

    def switch(self) -> int:
        self.status = RUNNING
        cases = len(self.children) - 1
        chosen = cases
        if "x" in self.board:
            found = str(self.board.get("x"))
            for index in range(cases):
                if self.node.port(f"case_{index + 1}") == found:
                    chosen = index
                    break
        running = self.at - 1  # 0 is none
        if running not in (-1, chosen):
            self.children[running].reset()
        result = self.children[chosen].execute()
        self.at = chosen + 1 if result == RUNNING else 0
        if result in (SUCCESS, FAILURE):
            self.reset_children()
        return int(result)

    Switch2 = Switch3 = switch

    def TryCatch(self) -> int:
        self.status = RUNNING
        last = len(self.children) - 1
        while not self.catching and self.at < last:
            result = self.children[self.at].execute()
            if result == RUNNING:
                return RUNNING
            if result == FAILURE:
                self.reset_children()
                self.catching = True
            else:
                self.at += 1
                self.skipped += result == SKIPPED
        if self.catching:
            if self.children[last].execute() == RUNNING:
                return RUNNING
            result = FAILURE
        else:
            result = SKIPPED if self.skipped == last else SUCCESS
        self.reset_children()
        self.at = self.skipped = 0
        self.catching = False
        return result

    def clean_up(self) -> None:
        """Of a halted TryCatch: the last child is executed once, and then reset as all children are."""
        wanted = self.node.port("catch_on_halt")
        if wanted == "{x}":
            wanted = str(self.board.get("x")) if "x" in self.board else ""
        if wanted in ("true", "1") and self.started and not self.catching and not self.mission.emergency:
            for child in self.children[:-1]:
                child.reset()
            self.catching = True
            self.children[-1].execute()

    def Whenever(self) -> int:
        condition, reaction, work = self.children
        self.status = RUNNING
        before = self.mission.unknowns
        asked = condition.execute()
        if asked != RUNNING:
            condition.reset()
        if asked != SUCCESS:
            self.armed = self.armed or (not self.fired and asked != RUNNING and self.mission.unknowns == before)
        elif self.armed and not self.reacting:
            self.armed, self.reacting = False, True
            self.fired = self.node.port("once") in ("true", "1")
            if self.working:
                self.working = False
                work.suspend()
        if self.reacting:
            result = reaction.execute()
            if result == RUNNING:
                return RUNNING
            self.reacting = False
            reaction.reset()
            if result == FAILURE:
                work.reset()
                condition.reset()
                self.armed, self.fired, self.working = True, False, False
                return FAILURE
        result = work.execute()
        self.working = result == RUNNING
        if result != RUNNING:
            self.armed, self.fired = True, False
            condition.reset()
            work.reset()
        return int(result)

    # decorators

    def once_more(self) -> int:
        """Executes the child, and resets it when it has completed."""
        [child] = self.children
        self.status = RUNNING
        result = child.execute()
        self.working = result == RUNNING
        if result in (SUCCESS, FAILURE):
            child.reset()
        return int(result)

    def KeepRunningUntilFailure(self) -> int:
        return FAILURE if self.once_more() == FAILURE else RUNNING

    def RunOnce(self) -> int:
        if self.once != IDLE:
            return SKIPPED if self.node.port("then_skip") == "true" else int(self.once)
        result = self.once_more()
        if result in (SUCCESS, FAILURE):
            self.once = result
        return result

    def Precondition(self) -> int:
        try:
            if not self.working and not self.asked("if"):
                return STATUSES[self.node.port("else")]
        except ScriptFailed:
            self.mission.unknowns += 1
            return FAILURE
        return self.once_more()

    def LoopString(self) -> int:
        if self.status == IDLE:
            self.queue = self.node.port("queue").split(";")
        if not self.working:
            source: Any = self.queue
            if self.node.port("queue") == "{q}":
                source = self.board.get("q") if "q" in self.board else deque()
                if isinstance(source, str):
                    source = deque(source.split(";"))
                    self.board.set("q", source)
            if not source:
                return STATUSES[self.node.port("if_empty")]
            self.board.set("y", source.pop(0) if isinstance(source, list) else source.popleft())
        return FAILURE if self.once_more() == FAILURE else RUNNING

    def entry(self, otherwise: int) -> int:
        return self.once_more() if self.working or self.updated() else otherwise

    def SkipUnlessUpdated(self) -> int:
        return self.entry(SKIPPED)

    def WaitValueUpdate(self) -> int:
        return self.entry(RUNNING)

    # Nav2

    def PipelineSequence(self) -> int:
        self.status = RUNNING
        skipped = 0
        for index, child in enumerate(self.children):
            result = child.execute()
            if result == FAILURE:
                self.reset_children()
                self.at = 0
                return FAILURE
            if result == RUNNING and index >= self.at:
                self.at = index
                return RUNNING
            skipped += result == SKIPPED
        self.reset_children()
        self.at = 0
        return SKIPPED if skipped == len(self.children) else SUCCESS

    def NonblockingSequence(self) -> int:
        self.status = RUNNING
        results = []
        for child in self.children:
            results.append(child.execute())
            if results[-1] == FAILURE:
                break
        if RUNNING in results and FAILURE not in results:
            return RUNNING
        self.reset_children()
        if FAILURE in results:
            return FAILURE
        return SUCCESS if SUCCESS in results else SKIPPED

    def PauseResumeController(self) -> int:
        result = self.children[0].execute()
        if result != RUNNING:
            self.reset_children()
        return SUCCESS if result == SKIPPED else result

    def SingleTrigger(self) -> int:
        if self.status in (IDLE, SKIPPED):
            self.triggered = False
        self.status = RUNNING
        if self.triggered:
            return FAILURE
        result = self.once_more()
        self.triggered = result in (SUCCESS, FAILURE)
        return result

    def PersistentSequence(self) -> int:
        """As there, but a child that ran is halted where the number has become that of another one."""
        self.status = RUNNING
        key = self.node.port("current_child_idx").strip("{}")
        try:
            number = float(self.board.get(key))
        except (KeyError, ValueError):
            number = -1
        if number not in range(len(self.children) + 1):
            self.reset_children()
            return FAILURE
        at = int(number)
        for index, child in enumerate(self.children):
            if index != at:
                child.reset()
        while at < len(self.children):
            result = self.children[at].execute()
            if result == RUNNING:
                return RUNNING
            self.children[at].reset()
            at = 0 if result == FAILURE else at + 1
            self.board.set(key, at)
            if result == FAILURE:
                return FAILURE
        self.board.set(key, 0)
        return SUCCESS

    def PathLongerOnApproach(self) -> int:
        """As there, but a child that ran is halted where the path is no longer that long. Paths are along one axis."""
        key = self.node.port("path").strip("{}")
        text = str(self.board.get(key)) if key in self.board else ""
        new = json.loads(text.removeprefix("json:")) if text.startswith("json:") else []
        old, self.path = self.path, new
        if not (old and new and old[-1] == new[-1]):
            self.reset_children()
            return SUCCESS
        lengths = [sum(abs(one[0] - other[0]) for one, other in pairwise(path)) for path in (old, new)]
        if not (lengths[0] < 3 and lengths[1] > 2 * lengths[0]):
            self.reset_children()
            return SUCCESS
        result = self.once_more()
        if result not in (SUCCESS, FAILURE):
            self.path = old
        return result

    def GoalUpdater(self) -> int:
        source, target = (self.node.port(port).strip("{}") for port in ("input_goal", "output_goal"))
        self.status = RUNNING
        if source in self.board:
            self.board.set(target, self.board.get(source))
        return self.once_more()

    def GoalUpdatedController(self) -> int:
        key = self.node.port("goal").strip("{}")
        goal = self.board.get(key) if key in self.board else None
        is_new = self.status == IDLE or goal != self.goal
        self.goal, self.status = goal, RUNNING
        return self.once_more() if is_new or self.working else RUNNING

    def RecoveryNode(self) -> int:
        self.status = RUNNING
        main, recovery = self.children
        while True:
            if self.at == 0:
                result = main.execute()
                if result == FAILURE and self.count < self.number("number_of_retries"):
                    main.reset()
                    self.at = 1
                    continue
            else:
                result = recovery.execute()
                if result == SUCCESS:
                    recovery.reset()
                    self.count += 1
                    self.at = 0
                    continue
                if result == SKIPPED:
                    result = FAILURE
            if result != RUNNING:
                self.reset_children()
                self.at = self.count = 0
            return int(result)

    def RoundRobin(self) -> int:
        self.status = RUNNING
        size = len(self.children)
        skipped = 0
        while self.failures + skipped < size:
            child = self.children[self.at]
            result = child.execute()
            if result == RUNNING:
                return RUNNING
            child.reset()
            self.at = (self.at + 1) % size
            if result == SUCCESS:
                self.failures = 0
                return SUCCESS
            self.failures += result == FAILURE
            skipped += result == SKIPPED
            if self.at == 0 and self.node.port("wrap_around") == "false":
                break
        self.at = self.failures = 0
        return SKIPPED if skipped == size else FAILURE

    def RateController(self) -> int:
        first = self.status == IDLE
        if first:
            self.stop_watch()
        due = self.passed() >= 1 / float(self.node.port("hz"))
        self.status = RUNNING
        if not (first or self.working or due):
            return RUNNING
        result = self.once_more()
        if result == SUCCESS:
            self.stop_watch()
            self.passed()
        return result
