"""A robot with components: their words are done by them, and their life goes on from run to run."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Generator, Mapping
from inspect import Parameter, Signature, isgeneratorfunction, signature

from btlang.backends.engine import leaf_binding
from btlang.components.component import ComponentError
from btlang.components.device_robot import DeviceSimulation
from btlang.components.inside_host import InsideHost
from btlang.components.manager import ComponentKeeper, ComponentManager, class_of
from btlang.components.parts.hearing import Hearing
from btlang.components.process_host import ProcessHost
from btlang.devices.device_set import DeviceSet, Reads
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import KINDS, Command, Reading
from btlang.devices.simulated import twin
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.robots.bodies.body_file import unusable_robot
from btlang.robots.platforms import NODES, import_function
from btlang.robots.simulation.connection import Simulation
from btlang.run.events import RobotEvent
from btlang.speech.recogniser import RecogniserError
from btlang.vocabulary.entry import COMPARISONS, MEASURED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.components.component import Host
    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.bodies.body import Body, ComponentPart, RosNode
    from btlang.run.bus import Bus
    from btlang.run.connection import Connection
    from btlang.run.controls import Controls
    from btlang.run.pace import Pace
    from btlang.tree.node import Tree
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon

_WAITING = 1000  # events between two ticks: what is more is lost, but nothing of a component hides another change
_UP = 30.0  # seconds that all components get to come up before the first mission; who is later is waited for no more


class DeviceGate:
    """Devices for components. A device that moves and isn't commanded again comes to rest by itself."""

    def __init__(self, devices: Reads, kind: str, robot: Any) -> None:
        self._devices, self._rest, self._robot = devices, KINDS[kind].rest, robot

    def read(self, name: str) -> Reading:
        """Return the latest reading. Raises DeviceSilent."""
        return self._devices.read(name)

    def write(self, name: str, command: Command) -> None:
        """Command a device. Raises DeviceError while the robot is stopped, or for an invalid command."""
        if self._rest is not None and command != self._rest and self._robot.refuses:
            raise DeviceError(f"the {name} isn't moved: the robot is stopped")
        self._devices.write(name, command)

    def silent(self, name: str) -> str | None:
        """Return why it is silent."""
        return self._devices.silent(name)


class ComponentConnection:
    """A connection with the components and devices of a body added to it."""

    def __init__(self, inner: Connection, body: Body) -> None:
        self._inner, self._body = inner, body
        self._used: set[str] = set()
        self._changes: deque[tuple[str, Mapping[str, Any]]] = deque(maxlen=_WAITING)
        self._said: deque[tuple[str, Mapping[str, Any]]] = deque(maxlen=_WAITING)
        self.robot = inner.robot
        if isinstance(inner, DeviceSimulation):
            self.devices = inner.devices
        else:
            simulated = isinstance(inner, Simulation)
            mine = body.replace(devices=tuple(map(twin, body.devices))) if simulated else body
            self.devices = DeviceSet(mine, inner.robot, self._post)
            self.devices.start()
        has_nodes = any(part.node is not None for part in body.components)
        self._nodes: Any = import_function(NODES)(inner.robot, body) if has_nodes else None
        kinds = {name: device.kind for name, device in self.devices.devices.items()}
        self._gates = {name: DeviceGate(reads, kinds[name], self.robot) for name, reads in self.devices.readers.items()}
        self.manager = ComponentManager(body.components, self._host, self._post, self._in_use)
        self._hearing = Hearing(body, self.robot, self.devices, self._post) if body.ears and body.ears.engine else None
        self.robot.on_step = self._step
        self.manager.start()
        self.manager.wait(_UP)

    @property
    def bus(self) -> Bus:
        return self._inner.bus

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Implement Connection. A word whose `call` is a method of a component uses the component as it is at that
        time.
        """
        if entry.ros is not None and self._nodes is not None:
            return self._bound_to_node(entry, vocabulary)
        place, _, method = entry.call.rpartition(".") if isinstance(entry.call, str) else ("", "", "")
        keeper = next((each for each in self.manager.keepers if each.class_place == place), None)
        if keeper is None:
            return self._inner.bind(entry, vocabulary)
        self._used.add(keeper.part.name)
        call = (
            _make_condition(keeper, method, entry) if entry.sort == "condition" else _leaf_class(keeper, method, entry)
        )
        return leaf_binding(entry, vocabulary, call, entry.slots).replace(thread=False)  # type: ignore[no-any-return]

    def _bound_to_node(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Bind a word with a `ros` table. If it uses a name below that of a component, it fails with the component."""
        bound = self._inner.bind(entry, vocabulary) or self._nodes.bind(entry, vocabulary)
        assert entry.ros is not None
        name = f"/{entry.ros.name.lstrip('/')}"
        keeper = next((each for each in self.manager.keepers if _is_below(name, each.part.node)), None)
        if keeper is None or bound is None:
            return bound
        self._used.add(keeper.part.name)
        return bound.replace(call=_guard_leaf(keeper, bound.call))  # type: ignore[no-any-return]

    def check(self, tree: Tree, vocabulary: Lexicon) -> None:
        """Implement Connection. A mission can't use words of a component whose class can't be loaded."""
        self._inner.check(tree, vocabulary)
        entries = map(vocabulary.entry, {node.id for node in tree.walk()})
        calls = [entry.call for entry in entries if entry is not None and isinstance(entry.call, str)]
        self.check_loaded({call.rpartition(".")[0] for call in calls})

    def check_loaded(self, places: Collection[str | None] | None = None) -> None:
        """Raise MissionError (BT071) if a class can't be loaded, with all that `btc robot check` finds.

        `places` are the classes that are looked at, as `module:Class`; by default all.
        """
        keepers = [keeper for keeper in self.manager.keepers if places is None or keeper.class_place in places]
        failed = next((keeper for keeper in keepers if keeper.has_failed and not keeper.is_loaded), None)
        if failed is None:
            return
        from btlang.components.checking import check_robot  # most robots are sound

        found = check_robot(read_source(self._body.file))[1] if self._body.file else []
        raise MissionError(found) if found else unusable_robot(ComponentError(f"the {failed.part.name} {failed.why}"))

    def begin(self, bus: Bus) -> None:
        self._used.clear()
        self._inner.begin(bus)
        self._flush()

    def pace(self, speed: float, controls: Controls) -> Pace:
        return self._inner.pace(speed, controls)

    def close(self) -> None:
        try:
            if self._hearing is not None:
                self._hearing.close()
            self.manager.close()
            if self._nodes is not None:
                self._nodes.close()
            self.devices.close()
        finally:
            self._inner.close()

    def _host(self, part: ComponentPart, changed: Callable[[], object]) -> Host:
        if part.node is not None:
            return self._node_host(part, changed)
        if part.runs == "here":
            return InsideHost(part, self._body, self._gates, changed, self._post_from_component)
        return ProcessHost(part, self._body.file, self._gates, changed, self._post_from_component)

    def _node_host(self, part: ComponentPart, changed: Callable[[], object]) -> Host:
        if self._nodes is None:
            raise ComponentError("is a ROS 2 node: it is loaded when the robot starts, from its robot file")
        host: Host = self._nodes.host(part, changed, lambda: self.manager.closing)
        return host

    def _in_use(self, name: str) -> bool:
        return name in self._used and not self.bus.closed

    def _post(self, kind: str, data: Mapping[str, Any]) -> None:
        """Post an event from any thread; the thread that ticks emits it."""
        self._changes.append((kind, data))

    def _post_from_component(self, kind: str, data: Mapping[str, Any]) -> None:
        """Post what a component reports; it never counts as an event of the robot itself."""
        self._said.append((kind, data))

    def _step(self, seconds: float) -> None:
        self.devices.step()
        if self._hearing is not None:
            self._hearing.step()
        for keeper in self.manager.keepers:
            if isinstance(keeper.host, InsideHost):
                keeper.host.step(seconds)
        self._flush()

    def _flush(self) -> None:
        for _ in range(len(self._changes)):
            self.bus.emit_robot(*self._changes.popleft())
        for _ in range(len(self._said)):  # no more: a component may say things faster than they are handed on
            self.bus.emit(RobotEvent, *self._said.popleft())


def _is_below(name: str, node: RosNode | None) -> bool:
    return node is not None and name.startswith(f"{node.name}/")


def _guard_leaf(keeper: ComponentKeeper, call: Callable[..., Any]) -> Callable[..., Any]:
    """Return a leaf that fails as soon as its component isn't active."""
    led: Any

    def steps(**ports: Any) -> Generator[object, Any, object]:
        keeper.active_host()
        generator = call(**ports)
        try:
            while True:
                yield next(generator)
                keeper.active_host()
        except StopIteration as end:
            return end.value
        finally:
            generator.close()

    def once(**ports: Any) -> Any:
        keeper.active_host()
        return call(**ports)

    led = steps if isgeneratorfunction(call) else once
    led.__signature__ = signature(call)
    return led  # type: ignore[no-any-return]


def _make_condition(keeper: ComponentKeeper, method: str, entry: Entry) -> Callable[..., Any]:
    def ask(robot: Any, **ports: Any) -> Any:
        return keeper.active_host().ask(method, ports, robot)

    names = ["robot", *(slot.name for slot in entry.slots if slot.name not in (*COMPARISONS, MEASURED))]
    ask.__signature__ = Signature([Parameter(name, Parameter.KEYWORD_ONLY) for name in names])  # type: ignore[attr-defined]
    return ask


def _leaf_class(keeper: ComponentKeeper, method: str, entry: Entry) -> type:
    """Return a leaf class that asks for the component's host at each start: it may have been restarted."""

    class ComponentLeaf:
        def __init__(self, robot: Any, wake: Callable[[], object], beside: set[object]) -> None:
            self._robot, self._wake, self._beside = robot, wake, beside
            self._leaf: Any = None

        def start(self, **ports: Any) -> object:
            host = keeper.active_host()
            self._leaf = host.leaf(method, entry.outputs, self._robot, self._wake, self._beside)
            return self._leaf.start(**ports)

        def tick(self) -> object:
            return self._leaf.tick()

        def halt(self) -> None:
            self._leaf.halt()

    return ComponentLeaf


def component_connection(connect: Callable[[], Connection], body: Body) -> Connection:
    """Return the connection of `connect`, with the components and devices of the body.

    Raises MissionError (BT071) for those that can't be used.
    """
    inner: Connection | None = None
    try:
        for part in body.components:  # before anything is opened
            class_of(part)
        inner = connect()
        return ComponentConnection(inner, body)
    except (ComponentError, DeviceError, MissionError, RecogniserError) as problem:
        if inner is not None:
            inner.close()
        if isinstance(problem, MissionError):  # without ROS 2
            raise
        raise unusable_robot(problem) from None
