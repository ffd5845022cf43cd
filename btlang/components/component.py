"""What a component is: a class with hooks for its life, its states and transitions, and where one lives."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

from btlang.engine.leaves.leaf import ActionFailed
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import ClassVar

    from btlang.devices.kinds import Command, Reading


UNCONFIGURED, INACTIVE, ACTIVE, FINALIZED = STATES = "unconfigured", "inactive", "active", "finalized"
UPWARDS = ("configure", "activate")
"""The transitions from unconfigured to active."""
SHARED = "--shared"
"""The option of a process that several robots share, before the path of its socket."""


class Transition(Record):
    """A transition between states; `hook` is the component's method for it.

    If the hook raises, the component's `error` hook is called, and the state is `fails`.
    """

    name: str
    begins: tuple[str, ...]
    ends: str
    hook: str
    fails: str = UNCONFIGURED


TRANSITIONS = {
    each.name: each
    for each in (
        Transition("configure", (UNCONFIGURED,), INACTIVE, "configure"),
        Transition("activate", (INACTIVE,), ACTIVE, "activate"),
        Transition("deactivate", (ACTIVE,), INACTIVE, "deactivate"),
        Transition("clean up", (INACTIVE,), UNCONFIGURED, "clean_up"),
        Transition("shut down", (UNCONFIGURED, INACTIVE, ACTIVE), FINALIZED, "shut_down", FINALIZED),
    )
}
"""The transitions by name."""


class ComponentError(ActionFailed):
    """The reason why a component can't be loaded or used, in plain English."""


class ComponentAbsent(ComponentError):
    """The error that a component isn't there and somebody else has to start it, which is waited for and isn't a
    failure.
    """


class ParameterError(ComponentError):
    """The reason why parameters in the robot file are wrong."""


class Parameter:
    """A value that the robot file may set: a number, a text or a flag, of the type of its default.

    Numbers are from `low` to `high`; a whole default takes whole numbers only. `unit` and `help` are for people.
    """

    def __init__(
        self,
        default: float | str | bool,
        *,
        low: float | None = None,
        high: float | None = None,
        choices: Sequence[str] = (),
        unit: str = "",
        help: str = "",
    ) -> None:
        self.default, self.low, self.high = default, low, high
        self.choices, self.unit, self.help = tuple(choices), unit, help
        self.name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, component: Component | None, owner: type) -> Any:
        return self if component is None else component.__dict__.get(self.name, self.default)

    def check(self, value: object) -> float | str | bool:
        """Return the value, as the component gets it. Raises ComponentError."""
        if isinstance(self.default, bool) or isinstance(value, bool):
            if not (isinstance(self.default, bool) and isinstance(value, bool)):
                raise self._wrong("true or false" if isinstance(self.default, bool) else "no flag", value)
            return value
        if isinstance(self.default, str):
            if not isinstance(value, str):
                raise self._wrong("a text", value)
            if self.choices and value not in self.choices:
                raise self._wrong(f"one of {', '.join(self.choices)}", value)
            return value
        if not isinstance(value, int | float) or value != value:
            raise self._wrong("a number", value)
        whole = isinstance(self.default, int)
        if whole and value != int(value):
            raise self._wrong("a whole number", value)
        low, high = self.low, self.high
        if (low is not None and value < low) or (high is not None and value > high):
            low_text, high_text = f"from {low:g}" if low is not None else "", f"to {high:g}" if high is not None else ""
            raise self._wrong(f"{low_text} {high_text}".strip() + (f" {self.unit}" if self.unit else ""), value)
        return int(value) if whole else float(value)

    def described(self) -> dict[str, Any]:
        """Return the parameter as JSON."""
        names = ("name", "default", "low", "high", "unit", "help")
        return {name: getattr(self, name) for name in names} | {"choices": list(self.choices)}

    def _wrong(self, wanted: str, value: object) -> ComponentError:
        return ComponentError(f"{self.name} must be {wanted}, not {value!r}")


class Component:
    """A part of a robot. Subclasses override the hooks that they need; the constructor takes no arguments.

    The hooks and `step` are called one at a time, in one thread. A hook that raises leaves the component in error, and
    one that doesn't end within its time limit is given up. The methods that words name run concurrently, in their own
    threads or in the thread of the mission: a function, or a generator function in which each `yield` lets time pass.
    """

    needs: ClassVar[Sequence[str]] = ()
    """Names of other components, of devices of the robot file, and capabilities such as "base". Those come up first."""
    version: ClassVar[str] = ""
    """The version, for people who compare two of them."""
    rate: ClassVar[float] = 0.0
    """How often `step` is called, in calls a second; 0: never."""

    name = ""
    """The name in the robot file."""
    body: Any = None
    """The body in the robot file, a btlang.robots.bodies.body.Body."""
    _devices: Mapping[str, Any] = {}
    _report_event: Callable[[str, Mapping[str, Any]], object] = staticmethod(lambda kind, data: None)

    def configure(self) -> None:
        """Get ready, at rest: parameters and devices are available."""

    def activate(self) -> None:
        """Begin to work."""

    def deactivate(self) -> None:
        """Stop working; what it moves comes to rest."""

    def clean_up(self) -> None:
        """Release what `configure` acquired."""

    def shut_down(self) -> None:
        """End for good, from any state."""

    def error(self, problem: Exception) -> None:
        """Bring what it moves to rest, after a hook or a step has raised."""

    def step(self, seconds: float) -> None:
        """Work for so many seconds while it is active."""

    def read(self, device: str) -> Reading:
        """Return the latest reading of a device that it needs. Raises DeviceSilent if there is no new one."""
        reading: Reading = self._device(device).read(device)
        return reading

    def write(self, device: str, command: Command) -> None:
        """Command a device that it needs; one that moves comes to rest unless it is commanded again in 0.2 s."""
        self._device(device).write(device, command)

    def report(self, kind: str, **data: Any) -> None:
        """Report an event to the logs and recordings of the mission."""
        self._report_event(kind, data)

    @classmethod
    def parameters(cls) -> dict[str, Parameter]:
        """Return the parameters of the class, by name."""
        found = {name: value for each in reversed(cls.__mro__) for name, value in vars(each).items()}
        return {name: value for name, value in found.items() if isinstance(value, Parameter)}

    def set_parameters(self, values: Mapping[str, object]) -> None:
        """Set parameters as a robot file does. Raises ParameterError for unknown ones and for values out of limits."""
        known, problems = self.parameters(), list[str]()
        for name, value in values.items():
            if name not in known:
                problems.append(f'unknown parameter "{name}"; the parameters are {", ".join(known) or "none"}')
                continue
            try:
                self.__dict__[name] = known[name].check(value)
            except ComponentError as problem:
                problems.append(str(problem))
        if problems:
            raise ParameterError("; ".join(problems))

    def _device(self, name: str) -> Any:
        if name not in self._devices:
            lacks = (
                f'needs "{name}", which the robot lacks'
                if name in self.needs
                else "can't use it: it isn't in its needs"
            )
            raise ComponentError(f"{self.name} {lacks}")
        return self._devices[name]


class Host(Protocol):
    """The host of one component, from its start to its end.

    The methods are for the thread of its keeper; `leaf` and `ask` are for the one that ticks.
    """

    def load(self) -> Mapping[str, Any]:
        """Start the process if it has one and make the component; return its description. Raises ComponentError."""

    def transition(self, name: str) -> None:
        """Do one of TRANSITIONS. Raises ComponentError if it fails, or doesn't end within its limit."""

    @property
    def state(self) -> str:
        """The latest known state: one of STATES."""

    def look(self) -> str | None:
        """Return why it can't be used any more (it died, hangs, or failed by itself); None if it works."""

    def leaf(
        self, method: str, outputs: tuple[str, ...], robot: Any, wake: Callable[[], object], beside: set[object]
    ) -> Any:
        """Return one use of a method by a command: an object with start, tick and halt; see btlang.engine.leaves.leaf.

        The values of ports in `outputs` are functions that take what the method writes there.
        """

    def ask(self, method: str, ports: Mapping[str, Any], robot: Any) -> Any:
        """Return a method's answer to a condition, within the tick. Raises Unknown if it doesn't answer in time."""

    def close(self) -> None:
        """End the component at once, whatever it does. May be called twice."""
