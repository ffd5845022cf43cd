"""A component in the robot's own process: for what is trusted, and for what the tick has to wait for."""

from __future__ import annotations

import threading
from collections.abc import Callable, Generator, Mapping
from functools import lru_cache
from inspect import isgenerator, signature

from btlang.components.component import ACTIVE, TRANSITIONS, UNCONFIGURED, Component, ComponentError
from btlang.components.location import describe, load_class
from btlang.engine.leaves.leaf import ActionFailed, NotThere, describe_exception, locate_failure
from btlang.robots.command_gate import RobotProxy

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body, ComponentPart


class InsideHost:
    """A host in the robot's process. A hook that doesn't end in time goes on in its thread, without its devices."""

    process = None

    def __init__(
        self,
        part: ComponentPart,
        body: Body,
        devices: Mapping[str, Any],
        changed: Callable[[], object],
        report: Callable[[str, Mapping[str, Any]], object],
    ) -> None:
        self._part, self._body, self._devices = part, body, devices
        self._changed, self._report = changed, report
        self._component = Component()
        self._passed = 0.0
        self.state = UNCONFIGURED
        self.problem = ""

    def load(self) -> Mapping[str, Any]:
        part = self._part
        component = self._component = load_class(part.place, self._body.folder)()
        component.name, component.body = part.name, self._body
        component._devices, component._report_event = self._devices, self._report
        component.set_parameters(part.parameters)
        return describe(component)

    def transition(self, name: str) -> None:
        transition, problems = TRANSITIONS[name], list[BaseException]()
        if self.state not in transition.begins:
            raise ComponentError(f"it can't {name}: it is {self.state}")

        def work() -> None:
            try:
                getattr(self._component, transition.hook)()
            except BaseException as problem:
                problems.append(problem)

        thread = threading.Thread(target=work, name=f"btlang {name}", daemon=True)
        thread.start()
        thread.join(self._part.limit)
        if thread.is_alive():
            self.problem = f"did not {name} within {self._part.limit:g} s"
            raise ComponentError(f"the {self._part.name} {self.problem}")
        if problems:
            self.state = transition.fails
            self._fail(problems[0])
            raise ComponentError(locate_failure(problems[0])) from problems[0]
        self.state = transition.ends

    def look(self) -> str | None:
        return self.problem or None

    def step(self, seconds: float) -> None:
        """Let so many seconds pass for the component, in the thread that ticks."""
        component = self._component
        if self.state != ACTIVE or not component.rate:
            return
        self._passed += seconds
        if self._passed + 1e-9 < 1 / component.rate:
            return
        passed, self._passed = self._passed, 0.0
        try:
            component.step(passed)
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            self.state, self.problem = UNCONFIGURED, f"failed in its step: {locate_failure(problem)}"
            self._fail(problem)
            self._changed()

    def leaf(
        self, method: str, outputs: tuple[str, ...], robot: Any, wake: Callable[[], object], beside: set[object]
    ) -> InsideLeaf:
        return InsideLeaf(self, self._method(method), robot)

    def ask(self, method: str, ports: Mapping[str, Any], robot: Any) -> Any:
        return _call(self._method(method), ports, robot)

    def _method(self, name: str) -> Callable[..., Any]:
        found = getattr(self._component, name, None)
        if not callable(found):
            raise ActionFailed(f"the {self._part.name} has no method {name}")
        return found  # type: ignore[no-any-return]

    def close(self) -> None:
        """Implement Host. What goes on in one of its threads can't move anything any more."""
        self.state = UNCONFIGURED
        self._component._devices = {}

    def check_active(self) -> None:
        """Raise ActionFailed if the component isn't active any more."""
        if self.state != ACTIVE:
            raise ActionFailed(NotThere(f"the {self._part.name} {self.problem or f'is {self.state}'}"))

    def _fail(self, problem: BaseException) -> None:
        try:
            self._component.error(
                problem if isinstance(problem, Exception) else ComponentError(describe_exception(problem))
            )
        except Exception as another:
            self.problem = f"failed in its error hook: {locate_failure(another)}"


def _call(method: Callable[..., Any], ports: Mapping[str, Any], robot: Any) -> Any:
    takes_robot = _takes_robot(getattr(method, "__func__", method))
    return method(**ports, robot=robot) if takes_robot else method(**ports)


@lru_cache(maxsize=1024)  # a condition is asked at each tick
def _takes_robot(function: Callable[..., Any]) -> bool:
    return "robot" in signature(function).parameters


class InsideLeaf:
    """A method of a component as a leaf, in the thread that ticks. It ends with the component."""

    def __init__(self, host: InsideHost, method: Callable[..., Any], robot: Any) -> None:
        self._host, self._method = host, method
        self._proxy = RobotProxy(robot, lambda call: call())
        self._generator: Generator[object, Any, object] | None = None

    def start(self, **ports: Any) -> object:
        """Call the method; a generator function runs to its first `yield`."""
        try:
            result = _call(self._method, ports, self._proxy)
        except BaseException:
            self._proxy.let_go()
            raise
        if not isgenerator(result):
            return True if result is None else result
        self._generator = result
        return self.tick()

    def tick(self) -> object:
        """Run a generator to its next `yield`."""
        assert self._generator is not None
        try:
            self._host.check_active()
            next(self._generator)
        except StopIteration as end:
            return True if end.value is None else end.value
        except BaseException:
            self.halt()
            raise
        return None

    def halt(self) -> None:
        """Close the generator, and end what the method has started."""
        try:
            if self._generator is not None:
                self._generator.close()
        finally:
            self._proxy.let_go()
