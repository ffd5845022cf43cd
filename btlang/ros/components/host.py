"""Components that are ROS 2 lifecycle nodes, led by their services, and the node through which a robot leads them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from math import radians

from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.srv import SetParameters
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.parameter import Parameter
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

from btlang.components.component import (
    ACTIVE,
    FINALIZED,
    INACTIVE,
    STATES,
    TRANSITIONS,
    UNCONFIGURED,
    ComponentAbsent,
    ComponentError,
)
from btlang.components.started_process import StartedProcess
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.ros.clocks import wait_until
from btlang.ros.components.services import Container, ServiceCaller
from btlang.ros.node import SpunNode
from btlang.ros.robot.places import RosPlaces
from btlang.ros.words.binding import bind_ros
from btlang.ros.words.clients import RosClients

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.bodies.body import ComponentPart
    from btlang.ros.components.services import AwaitedReply
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon


_NUMBERS = {
    "configure": Transition.TRANSITION_CONFIGURE,
    "clean up": Transition.TRANSITION_CLEANUP,
    "activate": Transition.TRANSITION_ACTIVATE,
    "deactivate": Transition.TRANSITION_DEACTIVATE,
}
_SHUT_DOWN = {
    UNCONFIGURED: Transition.TRANSITION_UNCONFIGURED_SHUTDOWN,
    INACTIVE: Transition.TRANSITION_INACTIVE_SHUTDOWN,
    ACTIVE: Transition.TRANSITION_ACTIVE_SHUTDOWN,
}
_DOWNWARDS = {ACTIVE: "deactivate", INACTIVE: "clean up"}
_ANSWER = 0.5  # seconds until it is asked in another way
_STARTING = 30.0  # seconds that a program gets until its node is there, on a busy computer
_DISCOVERY = 7.0  # seconds in which a node that is there is found: DDS announces every 3 s, and two may get lost
_BEAT = 1.0  # seconds between two questions for its state
_END = 2.0  # seconds that a program gets to end by itself
_DOUBT = 0.3  # seconds that it gets to answer where DDS says that it is dead
_ALIVE = QoSProfile(
    depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=Duration(seconds=0.5)
)  # fmt: skip
_LAST_ANSWERS = 2.0  # seconds that goals which were halted get to end


class NodeHost:
    """A component that is a ROS 2 lifecycle node. It has no words: those of a ROS 2 node have `ros` tables.

    `changed` is called, from any thread, when there is something to look at; `closing` returns whether waiting for the
    node is pointless by now. A node that somebody else has started is left unconfigured at the end, for the next robot.
    """

    def __init__(self, part: ComponentPart, changed: Callable[[], object], closing: Callable[[], bool]) -> None:
        assert part.node is not None
        self._part, self._node, self._limit = part, part.node, part.limit
        self._changed, self._closing = changed, closing
        self._spun: SpunNode | None = None
        self._program: StartedProcess | None = None
        self._container: Container | None = None
        self._clients: dict[str, Any] = {}
        self._beats: list[AwaitedReply] = []
        self._asked = self._answered = 0.0
        self._lived = self._died = self._failed = False
        self.state = UNCONFIGURED

    @property
    def process(self) -> int | None:
        """The number of the process that it has started, while there is one."""
        return self._program.number if self._program is not None and self._program.ending is None else None

    def load(self) -> Mapping[str, Any]:
        """Implement Host. Raises ComponentAbsent if somebody else has to start the node."""
        self._questions = self._connect()
        if self._node.command:
            self._program = StartedProcess(self._node.command)
        elif self._node.container:
            self._container = Container(self._node, self._questions, self._limit)
            self._container.load(self._part.parameters)
        self._wait_for_node()
        self._reset()
        self._set_parameters()
        return {"version": "", "needs": []}

    def transition(self, name: str) -> None:
        """Implement Host. A slow or lost answer is no failure: the node is then asked for its state."""
        self._failed = True  # until it has done it: what hangs is not asked to end
        self._lead(name)
        self._failed = False

    def look(self) -> str | None:
        try:
            self._check_life()
        except ComponentError as problem:
            return str(problem)
        now = time.monotonic()
        if now - self._asked > _BEAT:  # also where the answer before is missing, which may be lost
            self._beats.append(self._questions.begin(self._clients["get"], GetState.Request()))
            self._asked = now
        answers = [beat.answer for beat in self._beats if beat.answer is not None]
        if answers:
            state, self._answered = _label(answers[-1]), now
            self._beats.clear()
            if state != self.state:
                before, self.state = self.state, state
                return f"is {state} by itself, after it was {before}"
        if now - self._answered > max(self._limit, self._part.silence):
            return f"has not answered for {now - self._answered:.0f} s"
        return None

    def leaf(
        self, method: str, outputs: tuple[str, ...], robot: Any, wake: Callable[[], object], beside: set[object]
    ) -> Any:
        """Implement Host. Raises ActionFailed."""
        raise self._no_method(method)

    def ask(self, method: str, ports: Mapping[str, Any], robot: Any) -> Any:
        """Implement Host. Raises ActionFailed."""
        raise self._no_method(method)

    def close(self) -> None:
        self.state = UNCONFIGURED
        try:
            if self._container is not None:
                self._container.unload()
            if self._spun is not None:
                self._spun.close()
        finally:
            if self._program is not None:
                self._program.close(0.0 if self._failed else _END)

    def _lead(self, name: str) -> None:
        if name == "shut down" and self._program is None and self._container is None:
            self.state = FINALIZED
            return
        self._beats.clear()
        transition, until = TRANSITIONS[name], time.monotonic() + self._limit
        if self.state not in transition.begins:
            raise ComponentError(f"it can't {name}: it is {self.state}")
        question = self._change(name)
        while True:
            answer = question.wait(_ANSWER)
            state = transition.ends if answer is not None and answer.success else self._ask_state(_ANSWER)
            if state == transition.ends:
                break
            if answer is not None and state in STATES:
                self.state = state
                raise ComponentError(f"can't {name}: its node says no, and is {state}")
            self._check_life()
            if time.monotonic() > until:
                raise ComponentError(f"did not {name} within {self._limit:g} s")
            if answer is None and state in transition.begins:
                question = self._change(name)  # it has not got it, or has it still before it: then it refuses this one
        self.state = transition.ends
        self._answered = time.monotonic()

    def _wait_for_node(self) -> None:
        """Wait until the node is in the graph. Raises ComponentError."""
        name, limit = self._node.name, _STARTING if self._program is not None else _DISCOVERY

        def is_over() -> bool:
            ended = self._program is not None and self._program.ending is not None
            return self._questions.is_there(name) or ended or self._closing()

        wait_until(is_over, limit)
        if self._program is not None:
            self._check_program()
        if not self._questions.is_there(name):
            if self._program is None and self._container is None:
                raise ComponentAbsent(f"waits for the node {name}")
            raise ComponentError(f"has started, but there is no node {name}")

    def _connect(self) -> ServiceCaller:
        """Return a new node for each life: one that knew a killed node takes seconds to find its successor.

        Raises ComponentError.
        """
        try:
            self._spun = SpunNode(f"btlang_{self._node.name.rpartition('/')[2]}")
        except MissionError as problem:
            raise ComponentError(str(problem)) from None
        node, name = self._spun.node, self._node.name
        self._clients = {
            "get": node.create_client(GetState, f"{name}/get_state"),
            "change": node.create_client(ChangeState, f"{name}/change_state"),
            "set": node.create_client(SetParameters, f"{name}/set_parameters"),
        }
        node.create_subscription(TransitionEvent, f"{name}/transition_event", self._hear, 10)
        node.create_subscription(
            Empty, f"{name}/alive", lambda _: None, _ALIVE,
            event_callbacks=SubscriptionEventCallbacks(liveliness=self._live),
        )  # fmt: skip
        questions = ServiceCaller(node)
        self._spun.start()
        return questions

    def _live(self, info: Any) -> None:
        """Note, in the thread that spins, whether the node lives: DDS reports it if the node publishes ~/alive."""
        self._lived = self._lived or info.alive_count > 0
        self._died = self._lived and not info.alive_count
        self._changed()

    def _hear(self, event: TransitionEvent) -> None:
        """Take a message, in the thread that spins."""
        self._asked = 0.0  # asked again at the next look: this may be an older event
        self._changed()

    def _reset(self) -> None:
        """Bring down a node that an earlier robot left up. Raises ComponentError."""
        until = time.monotonic() + self._limit
        while (state := self._ask_state(_ANSWER)) not in STATES:
            self._check_life()
            if self._closing() or time.monotonic() > until:
                reason = f"its node {self._node.name} has no life cycle, or doesn't answer"
                raise ComponentError(reason) if self._program is not None else ComponentAbsent(reason)
        self.state = state
        if state == FINALIZED:
            raise ComponentAbsent(f"waits for the node {self._node.name}, which is finalized, to be started again")
        while self.state in _DOWNWARDS:
            self._lead(_DOWNWARDS[self.state])

    def _set_parameters(self) -> None:
        """Set the parameters. Raises ComponentError if the node refuses one."""
        values = [Parameter(name, value=value).to_parameter_msg() for name, value in self._part.parameters.items()]
        if not values:
            return
        until, answer = time.monotonic() + self._limit, None
        while answer is None:
            answer = self._questions.ask(self._clients["set"], SetParameters.Request(parameters=values), _BEAT)
            if answer is None and time.monotonic() > until:
                raise ComponentError("its parameters can't be set: there is no answer")
        for name, result in zip(self._part.parameters, answer.results, strict=False):
            if not result.successful:
                raise ComponentError(f'its parameter "{name}" can\'t be set: {result.reason}')

    def _change(self, name: str) -> AwaitedReply:
        number = _SHUT_DOWN[self.state] if name == "shut down" else _NUMBERS[name]
        request = ChangeState.Request(transition=Transition(id=number))
        wait_until(self._clients["change"].service_is_ready, _ANSWER)
        return self._questions.begin(self._clients["change"], request)

    def _ask_state(self, seconds: float) -> str:
        """Ask for the state; return "" if the node doesn't answer."""
        return _label(self._questions.ask(self._clients["get"], GetState.Request(), seconds))

    def _check_life(self) -> None:
        """Raise ComponentError if the node is gone."""
        self._check_program()
        if self._died and self._clients and self._ask_state(_DOUBT):
            self._died = False  # it was another one of its name
        if self._died or not self._questions.is_there(self._node.name):
            raise ComponentError(f"has died: its node {self._node.name} is gone")

    def _check_program(self) -> None:
        ending = self._program.ending if self._program is not None else None
        if ending is not None:
            raise ComponentError(ending)

    def _no_method(self, method: str) -> ActionFailed:
        return ActionFailed(f"the {self._part.name} is a ROS 2 node, and has no method {method}")


def _label(answer: Any) -> str:
    """Return the label of a state as in STATES."""
    return "" if answer is None else str(answer.current_state.label)


class ComponentNodes:
    """The node for the ROS 2 components of one robot, until `close`.

    Raises MissionError (BT100) if ROS 2 doesn't start.
    """

    def __init__(self, robot: Any) -> None:
        self._robot = robot
        self._spun = SpunNode("btlang_components")
        try:
            self._clients = RosClients(self._spun.node)
            self._spun.start()
        except BaseException:
            self._spun.close()
            raise

    def host(self, part: ComponentPart, changed: Callable[[], object], closing: Callable[[], bool]) -> NodeHost:
        """Return the host of a component that is a node."""
        return NodeHost(part, changed, closing)

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Bind a word with a `ros` table, for a robot that isn't a ROS 2 robot. Raises MissionError."""
        return bind_ros(entry, vocabulary, self._clients, self._located)

    def close(self) -> None:
        """Leave the ROS graph."""
        try:
            self._clients.close(_LAST_ANSWERS)
        finally:
            self._spun.close()

    def _located(self, name: str) -> tuple[float, float, float | None]:
        places = RosPlaces(self._robot.world, self._robot.body)
        try:
            known = places.known(name)
            point = places.locate(known, Pose(0.0, 0.0, 0.0))
        except RobotError:
            raise KeyError(name) from None
        place = places.place(known)
        facing = None if place is None else place.facing
        return *point, None if facing is None else radians(facing)
