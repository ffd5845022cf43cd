"""A plain interpreter of trees with the semantics of BehaviorTree.CPP 4.10, to compare the engine with.

Each node has a status, as in C++; SKIPPED is returned but not kept. Before a class or generator leaf (id `C...` or
`G...`) starts, each node above it that asks its children anew and has a running child elsewhere halts that. A suspended
leaf keeps the status RUNNING, but is `stopped`: it starts anew.
"""

from __future__ import annotations

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS

from .reference_nav2 import Nav2Nodes
from .scripted import STATUS


class Reference(Nav2Nodes):
    """One node and, below it, the others."""

    def execute(self) -> int:
        result = self.decided()
        if result == IDLE:
            result = self.behaviour()
            self.started = result == RUNNING
        elif self.status == RUNNING:
            self.halt()
        result = self.afterwards(result)
        if result != SKIPPED:
            self.status = result
        return result

    def halt(self) -> None:
        if self.lasting and self.status == RUNNING and not self.stopped:
            self.log.append(f"{self.node.id}.halt")
        if self.node.id == "TryCatch":
            self.clean_up()
        self.reset_children()
        if self.node.id != "SequenceWithMemory":
            self.at = 0
        self.count = self.skipped = self.failures = self.successes = 0
        self.completed.clear()
        self.stop_watch()
        self.due = None
        self.late = self.stopped = self.catching = self.reacting = self.working = False
        self.armed, self.fired = True, False
        self.status = IDLE
        if self.started:
            self.started = False
            self.run_script("_onHalted")

    # leaves

    def leaf(self) -> int:
        name = self.node.id
        if self.lasting:
            runs = self.status == RUNNING and not self.stopped
            if not runs:
                self.interrupt()
            self.stopped = False
            self.log.append(f"{name}.{'tick' if runs else 'start'}")
        else:
            self.log.append(name)
        script = self.mission.scripts[name]
        letter = script[self.mission.calls[name] % len(script)]
        self.mission.calls[name] += 1
        if letter == "x":
            self.mission.unknowns += 1
            if name.startswith("C"):
                self.log.append(f"{name}.halt")
            return FAILURE
        result = STATUS[letter]
        if result == SKIPPED:
            self.status = IDLE
        return result

    def interrupt(self) -> None:
        below, above = self, self.parent
        while above is not None:
            if above.node.id in ("ReactiveSequence", "ReactiveFallback"):
                follows = not below.left  # what is started by halting a child makes room for the others
            else:
                follows = above.node.id == "WhileDoElse" and below is above.children[0]
            for child in above.children if follows else ():
                if child is not below and child.status == RUNNING:
                    child.reset()
            if above.node.id == "Whenever" and below is above.children[0]:
                if above.reacting:
                    above.children[1].suspend()
                elif above.working:
                    above.working = False
                    above.children[2].suspend()
            below, above = above, above.parent

    def SubTree(self) -> int:
        self.status = RUNNING
        result = self.children[0].execute()
        if result in (SUCCESS, FAILURE):
            self.children[0].reset()
        return result

    def Sleep(self) -> int:
        if self.passed() < self.number("msec") / 1000:
            return RUNNING
        self.stop_watch()
        return SUCCESS

    def WaitForTime(self) -> int:
        """The mission begins at 9 o'clock."""
        hours, minutes = self.node.port("time").split(":")
        if self.due is None:
            self.due = (int(hours) - 9) * 3600.0 + int(minutes) * 60.0
            while self.due <= self.clock.now:
                self.due += 24 * 3600.0
        if self.clock.now < self.due:
            return RUNNING
        self.due = None
        return SUCCESS

    # in order

    def Sequence(self) -> int:
        return self.in_order(SUCCESS, self.node.id)

    Fallback = AsyncSequence = AsyncFallback = SequenceWithMemory = Sequence

    def in_order(self, passes: int, id: str) -> int:
        if id.endswith("Fallback"):
            passes = FAILURE
        if self.status == IDLE:
            self.skipped = 0
        self.status = RUNNING
        while self.at < len(self.children):
            child = self.children[self.at]
            before = child.status
            result = child.execute()
            if result == RUNNING:
                return RUNNING
            if result == passes:
                self.at += 1
                breathes = id.startswith("Async") or id == "SequenceWithMemory"
                if breathes and before == IDLE and self.at < len(self.children):
                    return RUNNING
            elif result == SKIPPED:
                self.at += 1
                self.skipped += 1
            else:
                self.reset_children()
                self.skipped = 0
                if id != "SequenceWithMemory":
                    self.at = 0
                return result
        all_skipped = self.skipped == len(self.children)
        self.reset_children()
        self.at = self.skipped = 0
        return SKIPPED if all_skipped else passes

    # side by side

    def Parallel(self) -> int:
        size = len(self.children)
        wanted, allowed = self.number("success_count"), self.number("failure_count")
        required = wanted if wanted >= 0 else size + wanted + 1
        limit = allowed if allowed >= 0 else size + allowed + 1
        self.status = RUNNING
        skipped = 0
        for index, child in enumerate(self.children):
            if index not in self.completed:
                result = child.execute()
                skipped += result == SKIPPED
                self.successes += result == SUCCESS
                self.failures += result == FAILURE
                if result in (SUCCESS, FAILURE):
                    self.completed.add(index)
            end = IDLE
            if self.successes >= required or (wanted < 0 and self.successes + skipped >= required):
                end = SUCCESS
            elif size - self.failures < required or self.failures == limit:
                end = FAILURE
            if end != IDLE:
                self.completed.clear()
                self.successes = self.failures = 0
                self.reset_children()
                return end
        return SKIPPED if skipped == size else RUNNING

    def ParallelAll(self) -> int:
        self.status = RUNNING
        skipped = 0
        for index, child in enumerate(self.children):
            if index not in self.completed:
                result = child.execute()
                skipped += result == SKIPPED
                self.failures += result == FAILURE
                if result in (SUCCESS, FAILURE):
                    self.completed.add(index)
        if skipped == len(self.children):
            return SKIPPED
        if skipped + len(self.completed) < len(self.children):
            return RUNNING
        result = FAILURE if self.failures >= self.number("max_failures") else SUCCESS
        self.reset_children()
        self.completed.clear()
        self.failures = 0
        return result

    # reactive

    def ReactiveSequence(self) -> int:
        return self.reactive(SUCCESS)

    def ReactiveFallback(self) -> int:
        return self.reactive(FAILURE)

    def reactive(self, passes: int) -> int:
        self.status = RUNNING
        all_skipped = True
        for child in self.children:
            result = child.execute()
            all_skipped &= result == SKIPPED
            if result == RUNNING:
                for other in self.children:
                    if other is not child:
                        other.reset()
                return RUNNING
            if result == SKIPPED:
                child.reset()
            elif result != passes:
                self.reset_children()
                return result
        self.reset_children()
        return SKIPPED if all_skipped else passes

    # branches

    def IfThenElse(self) -> int:
        self.status = RUNNING
        if self.at == 0:
            before = self.mission.unknowns
            result = self.children[0].execute()
            if result == RUNNING:
                return result
            no_branch = len(self.children) == 2 or self.mission.unknowns > before
            if result == SKIPPED or (result == FAILURE and no_branch):
                self.reset_children()
                return FAILURE
            self.at = 1 if result == SUCCESS else 2
        result = self.children[self.at].execute()
        if result != RUNNING:
            self.reset_children()
            self.at = 0
        return result

    def WhileDoElse(self) -> int:
        self.status = RUNNING
        before = self.mission.unknowns
        condition = self.children[0].execute()
        if condition == RUNNING:
            return RUNNING
        self.children[0].reset()
        if condition == SKIPPED or (condition == FAILURE and self.mission.unknowns > before):
            result = FAILURE
        elif condition == SUCCESS:
            for other in self.children[2:]:
                other.reset()
            result = self.children[1].execute()
        elif len(self.children) == 3:
            self.children[1].reset()
            result = self.children[2].execute()
        else:
            result = FAILURE
        if result != RUNNING:
            self.reset_children()
        return result

    # decorators

    def Inverter(self) -> int:
        before = self.mission.unknowns
        result = self.turned({SUCCESS: FAILURE, FAILURE: SUCCESS})
        return FAILURE if self.mission.unknowns > before and result != RUNNING and result != SKIPPED else result

    def ForceSuccess(self) -> int:
        return self.turned({FAILURE: SUCCESS})

    def ForceFailure(self) -> int:
        return self.turned({SUCCESS: FAILURE})

    def turned(self, table: dict[int, int]) -> int:
        self.status = RUNNING
        result = self.children[0].execute()
        if result in (SUCCESS, FAILURE):
            self.children[0].reset()
        return table.get(result, result)

    def Repeat(self) -> int:
        return self.rounds(self.number("num_cycles"), SUCCESS)

    def RetryUntilSuccessful(self) -> int:
        return self.rounds(self.number("num_attempts"), FAILURE)

    def rounds(self, limit: int, again: int) -> int:
        [child] = self.children
        self.status = RUNNING
        while self.count < limit or limit == -1:
            before = child.status
            result = child.execute()
            if result == RUNNING:
                return RUNNING
            child.reset()
            if result == SKIPPED:
                return SKIPPED
            if result != again:
                self.count = 0
                return result
            self.count += 1
            if before == IDLE and (self.count < limit or limit == -1):
                return RUNNING
        self.count = 0
        return again

    def Timeout(self) -> int:
        [child] = self.children
        self.status = RUNNING
        if self.passed() >= self.number("msec") / 1000 and child.status == RUNNING:
            child.reset()
            self.stop_watch()
            return FAILURE
        result = child.execute()
        if result != RUNNING:
            self.stop_watch()
        if result in (SUCCESS, FAILURE):
            child.reset()
        return result

    def Delay(self) -> int:
        [child] = self.children
        self.status = RUNNING
        self.late = self.passed() >= self.number("delay_msec") / 1000 or self.late
        if not self.late:
            return RUNNING
        result = child.execute()
        if result in (SUCCESS, FAILURE):
            self.stop_watch()
            self.late = False
            child.reset()
        return result
