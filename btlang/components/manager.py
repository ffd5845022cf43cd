"""Leads components through their life: started by their needs, shut down in reverse, restarted after a failure."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence

from btlang.components.component import ACTIVE, FINALIZED, INACTIVE, UNCONFIGURED, ComponentAbsent, ComponentError
from btlang.components.location import locate_class
from btlang.engine.leaves.leaf import ActionFailed, NotThere, describe_exception
from btlang.robots.bodies.body import ComponentPart
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.components.component import Host

_LOOK = 0.1  # seconds between two looks at each component
_MINUTE = 60.0
_CLOSING = 3.0  # seconds that all of them get to go down by themselves
_PAUSE, _LONGEST = 0.1, 10.0  # seconds before it is started again: doubled each time, and the longest
_SOUND = 2.0  # seconds that it has to be active until pauses are short again


class ComponentStatus(Record):
    """The status of a component. `why` is why it isn't active; `process` the number of its own process."""

    name: str
    place: str
    version: str
    state: str
    why: str = ""
    starts: int = 0
    process: int | None = None
    needs: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = {}


class ComponentManager:
    """The components of one robot, by name. Each has its own thread; all methods are for any thread.

    `make` makes the host of a part. `report` gets an event of each change: see PartChanged. `in_use` returns whether a
    running mission uses the component of a name: then it isn't replaced.
    """

    def __init__(
        self,
        parts: Iterable[ComponentPart],
        make: Callable[[ComponentPart, Callable[[], object]], Host],
        report: Callable[[str, Mapping[str, Any]], object] = lambda kind, data: None,
        in_use: Callable[[str], bool] = lambda name: False,
    ) -> None:
        self._make, self._report, self._in_use = make, report, in_use
        self.changed = threading.Condition()
        """Notified whenever the state of one of them changes."""
        self._closing = False
        self._keepers: dict[str, ComponentKeeper] = {}
        for part in parts:
            self._keepers[part.name] = ComponentKeeper(self, part)

    def start(self) -> None:
        """Begin to start all components."""
        for keeper in self.keepers:
            keeper.start()

    def wait(self, seconds: float) -> bool:
        """Wait until none is starting; return whether all are active then."""
        with self.changed:
            self.changed.wait_for(lambda: all(keeper.settled for keeper in self._keepers.values()), seconds)
            return all(keeper.state == ACTIVE for keeper in self._keepers.values())

    def close(self) -> None:
        """Shut all components down, dependents first, and wait for it. May be called twice."""
        with self.changed:
            self._closing = True
            self.changed.notify_all()
        until = time.monotonic() + _CLOSING
        for keeper in self.keepers:
            if not keeper.join(until - time.monotonic()):
                keeper.abandon()

    @property
    def closing(self) -> bool:
        """Whether all components shut down."""
        return self._closing

    def keeper(self, name: str) -> ComponentKeeper:
        """Return the keeper of a component. Raises ComponentError for an unknown name."""
        if name not in self._keepers:
            listed = ", ".join(self._keepers) or "none"
            raise ComponentError(f'there is no component "{name}"; the components are {listed}')
        return self._keepers[name]

    @property
    def keepers(self) -> Sequence[ComponentKeeper]:
        """The keepers of all components."""
        return tuple(self._keepers.values())

    def statuses(self) -> list[ComponentStatus]:
        """Return the statuses of all components, in the order of the robot file."""
        return [keeper.status() for keeper in self.keepers]

    def load(self, part: ComponentPart) -> None:
        """Add a component, or replace that of its name as soon as no running mission uses it.

        Raises ComponentError for one that isn't installed.
        """
        class_of(part)
        with self.changed:
            found = self._keepers.get(part.name)
            if found is None or found.gone:
                found = self._keepers[part.name] = ComponentKeeper(self, part)
                found.start()
            else:
                found.replace(part)
            self.changed.notify_all()

    def unload(self, name: str) -> None:
        """Shut one down for good, as soon as no running mission uses it. Raises ComponentError."""
        with self.changed:
            self.keeper(name).replace(None)
            self.changed.notify_all()

    def restart(self, name: str) -> None:
        """Restart a component, even one that was given up. Raises ComponentError."""
        with self.changed:
            keeper = self.keeper(name)
            keeper.replace(keeper.next or keeper.part)
            self.changed.notify_all()

    def report(self, keeper: ComponentKeeper) -> None:
        """Report a changed state; called with the lock."""
        self.changed.notify_all()
        name, state = keeper.part.name, keeper.state
        why = keeper.why if keeper.has_failed else ""
        text = f"the {name} {why}" if why else f"the {name} is active" if state == ACTIVE else ""
        self._report("part", {"kind": "component", "name": name, "state": state, "text": text})

    def make(self, part: ComponentPart) -> Host:
        """Return a host that isn't started."""
        return self._make(part, self._wake)

    def needs_met(self, names: Iterable[str]) -> str | None:
        """Return the first component among these names that isn't active, or soon won't be; None if all are."""
        known = ((name, self._keepers[name]) for name in names if name in self._keepers)
        return next((name for name, keeper in known if keeper.state != ACTIVE or keeper.leaving), None)

    def is_needed(self, name: str) -> bool:
        """Return whether a component that needs it is still active."""
        keepers = self.keepers
        return any(keeper.state == ACTIVE and name in keeper.needs for keeper in keepers)

    def is_free(self, name: str) -> bool:
        """Return whether no running mission uses it, or a component that needs it."""
        users, keepers = [name], self.keepers
        for user in users:  # which grows
            users += [each.part.name for each in keepers if user in each.needs and each.part.name not in users]
        return self._closing or not any(map(self._in_use, users))

    def forget(self, keeper: ComponentKeeper) -> None:
        """Remove a component that was unloaded."""
        if self._keepers.get(keeper.part.name) is keeper:
            del self._keepers[keeper.part.name]

    def _wake(self) -> None:
        with self.changed:
            self.changed.notify_all()


def class_of(part: ComponentPart) -> str | None:
    """Return the `module:Class` of a part; None for a ROS 2 node. Raises ComponentError for
    one that isn't installed.
    """
    return locate_class(part.place) if part.node is None else None


class ComponentKeeper:
    """The thread that leads one component through its life and starts its process."""

    def __init__(self, manager: ComponentManager, part: ComponentPart) -> None:
        self._manager, self.part = manager, part
        self.class_place = class_of(part)
        """The `module:Class` of the part, found once: looking through installed packages takes long."""
        self.next: ComponentPart | None = part  # what it is to be; None: unloaded. Changed with the lock
        self._asked = False
        self.host: Host | None = None
        self.state, self.why, self.version = UNCONFIGURED, "", ""
        self.needs: tuple[str, ...] = part.needs
        self._starts = 0
        self._failures: deque[float] = deque()
        self._in_a_row = 0
        self._active_since: float | None = None
        self._due = 0.0
        self._given_up = self._absent = self.gone = self.leaving = False
        self.is_loaded = True
        """Whether its class could be loaded at the latest start."""
        self._thread = threading.Thread(target=self._keep, name=f"btlang component {part.name}", daemon=True)

    def start(self) -> None:
        """Begin to start the component."""
        self._thread.start()

    def join(self, seconds: float) -> bool:
        """Wait at most so long until the component is down; return whether it is."""
        if self._thread.ident is not None:
            self._thread.join(max(0.0, seconds))
        return not self._thread.is_alive()

    def abandon(self) -> None:
        """Close the host, whatever it does."""
        if self.host is not None:
            self.host.close()
        self.join(_LOOK * 10)

    def replace(self, part: ComponentPart | None) -> None:
        """Request another component, or none, in its place; called with the lock of the manager."""
        self.next, self._asked, self._given_up, self._due, self._in_a_row = part, True, False, 0.0, 0
        self._failures.clear()

    @property
    def settled(self) -> bool:
        """Whether it is active, or won't be without help."""
        return self.state == ACTIVE or self._given_up or self._absent or self.gone or bool(self._failures)

    @property
    def has_failed(self) -> bool:
        """Whether it is down because it failed."""
        return bool(self._failures) and self.state == UNCONFIGURED

    def status(self) -> ComponentStatus:
        """Return the status of the component."""
        part, process = self.part, getattr(self.host, "process", None)
        return ComponentStatus(
            part.name, part.place, self.version, self.state, self.why, self._starts, process, self.needs,
            part.parameters,
        )  # fmt: skip

    def active_host(self) -> Host:
        """Return the current host. Raises ActionFailed if the component isn't active."""
        host = self.host
        if host is None or self.state != ACTIVE or host.state != ACTIVE:
            raise ActionFailed(NotThere(f"the {self.part.name} {self.why or f'is {self.state}'}"))
        return host

    def _keep(self) -> None:
        changed = self._manager.changed
        try:
            while not self._over():
                with changed:
                    if not self._may_begin():
                        changed.wait(_LOOK)
                        continue
                    if self.next is not None:
                        self.part, self._asked = self.next, False
                self._live()
        finally:
            with changed:
                self.gone = True
                self._set(FINALIZED, self.why)
                if not self._manager.closing:
                    self._manager.forget(self)
                    if self.next is not None:  # it was asked for again meanwhile
                        self._manager.load(self.next)

    def _over(self) -> bool:
        return self._manager.closing or self.next is None

    def _may_begin(self) -> bool:
        return not self._given_up and time.monotonic() >= self._due and self._has_needs(self.part.needs)

    def _has_needs(self, needs: Iterable[str]) -> bool:
        """Return whether all that it needs is active; if not, note what it waits for. Called with the lock."""
        missing = self._manager.needs_met(needs)
        if missing is not None:
            self._set(self.state, f"waits for the {missing}")
        return missing is None

    def _live(self) -> None:
        """Lead the component from its start to its end or failure."""
        host = self.host = self._manager.make(self.part)
        self.leaving, self._starts = False, self._starts + 1
        try:
            self.class_place = class_of(self.part)
            known = self._load(host)
            self._absent = False
            self.version, self.needs = known["version"], tuple({*self.part.needs, *known["needs"]})
            host.transition("configure")
            self._change(INACTIVE, "")
            while not self._must_end():
                if self._wait_for_needs():
                    host.transition("activate")
                    self._active_since = time.monotonic()
                    self._change(ACTIVE, "")
                    self._watch(host)
            self._bring_down(host)
            self._change(UNCONFIGURED, "was brought down")
        except ComponentAbsent as problem:
            self._absent, self._starts, self._due = True, self._starts - 1, time.monotonic() + _LOOK
            self._change(UNCONFIGURED, str(problem))
        except ComponentError as problem:
            self._fail(str(problem))
        except BaseException as problem:  # of a class by somebody else, sys.exit() too
            self._fail(describe_exception(problem))
        finally:
            host.close()

    def _load(self, host: Host) -> Mapping[str, Any]:
        try:
            known = host.load()
        except ComponentAbsent:
            raise
        except BaseException:
            self.is_loaded = self.part.node is not None  # a ROS 2 node has no class
            raise
        self.is_loaded = True
        return known

    def _must_end(self) -> bool:
        """Return whether the component is to end or to be replaced, and may."""
        self.leaving = (self._over() or self._asked) and self._manager.is_free(self.part.name)
        return self.leaving

    def _wait_for_needs(self) -> bool:
        with self._manager.changed:
            if self._has_needs(self.needs):
                return True
            self._manager.changed.wait(_LOOK)
        self._look()
        return False

    def _watch(self, host: Host) -> None:
        """Watch the active component; deactivate it if what it needs is gone."""
        manager = self._manager
        while True:
            self._look()
            with manager.changed:
                missing = manager.needs_met(self.needs)
                if missing is not None or (self._must_end() and not manager.is_needed(self.part.name)):
                    break
                manager.changed.wait(_LOOK)
        self._change(INACTIVE, f"waits for the {missing}" if missing is not None else "")
        host.transition("deactivate")

    def _look(self) -> None:
        reason = self.host.look() if self.host is not None else None
        if reason is not None:
            raise ComponentError(reason)

    def _bring_down(self, host: Host) -> None:
        host.transition("clean up")
        host.transition("shut down")

    def _fail(self, reason: str) -> None:
        """Wait before the next start, longer each time, until too many failed within a minute."""
        now = time.monotonic()
        with self._manager.changed:
            while self._failures and now - self._failures[0] > _MINUTE:
                self._failures.popleft()
            if self._active_since is not None and now - self._active_since > _SOUND:
                self._in_a_row = 0
            self._due = now + (min(_PAUSE * 2**self._in_a_row, _LONGEST) if self._in_a_row else 0.0)
            self._in_a_row, self._active_since = self._in_a_row + 1, None
            self._failures.append(now)
            if len(self._failures) > self.part.restarts:
                self._given_up = True
                tries = len(self._failures)
                attempts = f"{tries} attempts in a minute" if tries > 1 else "the first attempt"
                reason = f"{reason}; it was given up after {attempts}"
            self._set(UNCONFIGURED, reason)

    def _change(self, state: str, why: str) -> None:
        with self._manager.changed:
            self._set(state, why)

    def _set(self, state: str, why: str) -> None:
        if (state, why) != (self.state, self.why):
            self.state, self.why = state, why
            self._manager.report(self)
