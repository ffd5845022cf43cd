"""The rest of the reference interpreter: nodes beside the plain ones, and what scripts decide."""

from __future__ import annotations

from collections import deque
from typing import Any, cast

from btlang.engine.blackboard import Blackboard
from btlang.engine.script.script import compile_script
from btlang.engine.script.values import ScriptFailed, truth
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

from .reference_node import ReferenceNode

STATUSES = {"SUCCESS": SUCCESS, "FAILURE": FAILURE, "SKIPPED": SKIPPED, "RUNNING": RUNNING}


class MoreNodes(ReferenceNode):
    """Scripts, leaves that ship and decorators; reference.py and reference_nav2.py have the others."""

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
