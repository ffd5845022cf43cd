"""The nodes of Nav2 in the reference interpreter."""

from __future__ import annotations

import json
from itertools import pairwise

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

from .reference_nodes import MoreNodes


class Nav2Nodes(MoreNodes):
    """Nav2's control nodes and decorators."""

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
