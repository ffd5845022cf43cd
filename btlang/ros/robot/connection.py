"""The connection to a ROS 2 robot: its node, its clock, and the end that leaves nothing behind."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import Any

from rosgraph_msgs.msg import Clock as ClockMessage

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.robots.bodies.body import Body
from btlang.robots.preflight import check_mission, find_missing_parts
from btlang.robots.worlds.world import World
from btlang.ros.available import OWN, require_interfaces, require_ros
from btlang.ros.clocks import RosPace, wait_until
from btlang.ros.graph import absent, full_name, is_connected, mismatch
from btlang.ros.node import SpunNode
from btlang.ros.robot.interface import ALTERNATIVES, CLOCK, ONE_SOURCE, VELOCITY, Interface, interfaces, needs
from btlang.ros.robot.joints import STATES
from btlang.ros.robot.robot import RosRobot
from btlang.ros.serving.names import use_server
from btlang.ros.subscriptions import NodeClock
from btlang.ros.words.binding import bind_ros
from btlang.ros.words.clients import RosClients
from btlang.run.bus import Bus
from btlang.run.controls import Controls
from btlang.run.events import Warned
from btlang.run.pace import Pace
from btlang.text.source import Source, Span
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon

_DISCOVERY = 7.0  # seconds of a node's life in which it has found all: DDS announces every 3 s, and two may get lost
_UNNAMED = "_NODE_NAME_UNKNOWN_"  # of a node whose topics are found and whose name is not yet
_AGAIN = 2.0  # seconds that an older node gets
_LAST_ANSWERS = 2.0  # seconds that goals which were halted get to end


class RosConnection:
    """A connection to a ROS 2 robot. Names and poses are those of the world file, whose map is the robot's.

    With `sim_time` the mission's clock follows the topic /clock, otherwise the system's. Missions run in real time.
    `namespace` is that of the robot and of the `node`, which is called `name`. With `servers`, actions are done by the
    servers of `btc serve-actions` in that folder of names; sensing still uses the robot itself.
    """

    def __init__(
        self,
        world: World,
        *,
        sim_time: bool = False,
        namespace: str = "",
        name: str = "btlang",
        servers: str = "",
        body: Body | None = None,
    ) -> None:
        self.world = world
        self.bus = Bus()
        self._sim_time = sim_time
        self._servers = servers
        self._discovers_until = time.monotonic() + _DISCOVERY
        self._spun = SpunNode(name, namespace=namespace, use_sim_time=sim_time)
        self.node = self._spun.node
        now = NodeClock(self._spun.node).now
        try:
            self.robot = RosRobot(self._spun.node, world, on_event=self._report, now=now, body=body)
            if sim_time:
                self.robot.subscriptions.listen(CLOCK.name, ClockMessage, "simulated time")
            self._clients = RosClients(self._spun.node)
            self._clients.judge = self.robot.judge
            self.robot.pending = self._clients.left
            self._spun.start()
        except BaseException:
            self._spun.close()
            raise

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Bind an entry to what its `ros` table names, or to its server; None if it has neither.

        Raises MissionError (BT104 to BT106).
        """
        if self._servers:
            entry = use_server(entry, vocabulary, self._servers)
        return bind_ros(entry, vocabulary, self._clients, self.robot.located)

    def survey(self, tree: Tree, vocabulary: Lexicon) -> dict[Interface, tuple[Node | None, str]]:
        """Return what a tree needs of the robot, each with the first leaf that needs it and what is wrong, "" for
        nothing.

        Waits for what is missing: until the node is seven seconds old, at least for two seconds; and two seconds for
        states that may only be published when they change. Raises MissionError if nav2_msgs is needed and isn't
        installed (BT100), or btlang's interfaces aren't compiled (BT110).
        """
        wanted: dict[Interface, Node | None] = {CLOCK: None} if self._sim_time else {}
        declared, own = self._bind_leaves(tree, vocabulary)
        wanted.update(needs(tree, vocabulary, self.robot.body, but=declared))
        if any(interface.kind == "action" for interface in wanted):
            require_ros("nav2_msgs")
            self.robot.prepare_navigation()
        if any(interface.type.startswith(f"{OWN.name}/") for interface in wanted):
            require_interfaces()
        found: dict[Interface, tuple[Node | None, str]] = {}
        states_until, joints = time.monotonic() + _AGAIN, any(interface.name == STATES for interface in wanted)

        def has_all() -> bool:
            found.clear()
            for spoken, node in self._with_velocity_type(wanted).items():
                offered, reason = self._find_offer(spoken)
                found[offered] = node, reason
            lacking = {Interface(need.kind, need.name, need.type): need.missing for need in self._clients.needs()}
            found.update((interface, (node, lacking[interface])) for interface, node in own.items())
            if any(reason for _, reason in found.values()):
                return False
            return not self.robot.find_unreported(joints) or time.monotonic() >= states_until

        wait_until(has_all, max(self._discovers_until - time.monotonic(), _AGAIN))
        return {self._resolve(interface): lack for interface, lack in found.items()}

    def lacking_parts(self, tree: Tree, vocabulary: Lexicon) -> dict[str, Node]:
        """Return the parts that a tree needs and the body lacks, each with the first leaf that needs it."""
        return find_missing_parts(self.robot.body, tree, vocabulary, but=self._bind_leaves(tree, vocabulary)[0])

    def warnings(self, needs: Iterable[Interface]) -> list[str]:
        """Return what may do harm: others that command the robot to move, and two publishers of the same state.

        Waits until DDS has found everybody.
        """
        wanted = {(need.kind, full_name(self.node, need.kind, need.name)) for need in needs}
        drives = full_name(self.node, "listener", VELOCITY)
        commands = [drives] if ("listener", drives) in wanted else []
        said = [name for kind, name in sorted(wanted) if kind == "publisher" and name.rpartition("/")[2] in ONE_SOURCE]
        own = self.node.get_namespace().rstrip("/"), self.node.get_name()

        def others(name: str) -> list[tuple[str, str]]:
            ends = self.node.get_publishers_info_by_topic(name)
            named = ((end.node_namespace.rstrip("/"), end.node_name) for end in ends)
            return sorted(each for each in named if each != own)

        def are_named() -> bool:
            """Return whether all that can be found has been: where there is one of a kind, there may be another."""
            found = [others(name) for name in commands] + [others(name)[1:] for name in said]
            return all(found) and not any(node == _UNNAMED for each in found for _, node in each)

        def shown(name: str) -> list[str]:
            return ["another node" if node == _UNNAMED else f"{place}/{node}" for place, node in others(name)]

        if commands or said:
            wait_until(are_named, self._discovers_until - time.monotonic())
        twice = [(name, " and ".join(shown(name))) for name in said if len(others(name)) > 1]
        rivals = [(name, node) for name in commands for node in dict.fromkeys(shown(name))]
        return [
            *(f"{node} publishes {name} too, so the robot follows both" for name, node in rivals),
            *(f"{nodes} publish {name}, so it contradicts itself" for name, nodes in twice),
        ]

    def blind(self, found: Mapping[Interface, tuple[Node | None, str]]) -> list[Diagnostic]:
        """Return the warning that the mission drives, but the robot file's scanner sends nothing (BT107).

        `found` is the result of `survey`. If the mission itself needs the scanner, it is reported as missing already.
        """
        drives = full_name(self.node, "listener", VELOCITY)
        node = next((node for need, (node, _) in found.items() if (need.kind, need.name) == ("listener", drives)), None)
        if node is None or self.robot.body.sensor("scanner") is None:
            return []
        [scan] = interfaces("scanner", self.robot.body)
        reason = self._lacks(scan) if self._resolve(scan) not in found else ""
        return [diagnostic("BT107", _place(node), words=_words(node), reason=reason)] if reason else []

    def _with_velocity_type(self, wanted: Mapping[Interface, Node | None]) -> dict[Interface, Node | None]:
        """Return the interfaces with the type of velocity that the robot listens to."""
        types = {VELOCITY: self.robot.velocity_type()}
        return {i.replace(type=types.get(i.name, i.type)): node for i, node in wanted.items()}

    def _find_offer(self, wanted: Interface) -> tuple[Interface, str]:
        """Return what the robot offers for an interface, and what is wrong with that, "" for nothing."""
        choices = ALTERNATIVES.get(wanted.name, ())
        if any(each.kind == "action" for each in choices) and not self.robot.power.prepare_docking():
            choices = ()
        offered = next((each for each in choices if not self._absent(each)), wanted)
        reason = self._lacks(offered)
        others = [self._lacks(each) for each in choices if each != offered] if reason else []
        return offered, ", and ".join(dict.fromkeys(filter(None, [reason, *others])))

    def _lacks(self, wanted: Interface) -> str:
        """Return what is wrong with an interface that shipped leaves need, "" for nothing."""
        node, name = self._spun.node, self._resolve(wanted).name
        reason = self._absent(wanted)
        if not reason and wanted.kind in ("publisher", "listener"):
            reason = mismatch(node, wanted.kind, name)
        if not reason and wanted.flows:
            reason = self.robot.subscriptions.why_not(wanted.name)
        return reason if reason or is_connected(node, name) else f"{name} is not connected yet"

    def _absent(self, wanted: Interface) -> str:
        return absent(self.node, wanted.kind, self._resolve(wanted).name, wanted.type)

    def _resolve(self, interface: Interface) -> Interface:
        named: Interface = interface.replace(name=full_name(self._spun.node, interface.kind, interface.name))
        return named

    def _bind_leaves(self, tree: Tree, vocabulary: Lexicon) -> tuple[set[str], dict[Interface, Node]]:
        """Return the ids of leaves with `ros` tables, and what these need, each with the first such leaf."""
        self._clients.begin()
        ids: set[str] = set()
        own: dict[Interface, Node] = {}
        for node in tree.walk():
            entries = vocabulary.entries.get(node.id, ()) if node.id not in ids else ()
            entry = next((entry for entry in reversed(entries) if self.bind(entry, vocabulary) is not None), None)
            if entry is not None:
                ids.add(node.id)
                for need in self._clients.used():
                    own.setdefault(Interface(*need), node)
        return ids, own

    def check(self, tree: Tree, vocabulary: Lexicon) -> None:
        """Raise MissionError as `check_mission` does, and for all interfaces that the robot lacks (BT101)."""
        check_mission(self.robot.world, self.robot.body, tree, vocabulary, but=self._bind_leaves(tree, vocabulary)[0])
        lacking = [(i, node, reason) for i, (node, reason) in self.survey(tree, vocabulary).items() if reason]
        if lacking:
            raise MissionError([_lack(*lack) for lack in lacking])
        self.robot.subscriptions.read()

    def begin(self, bus: Bus) -> None:
        """Begin a run: what the robot reports goes to this bus."""
        self.bus = bus

    def pace(self, speed: float, controls: Controls) -> Pace:
        """Return the pace of real time. Raises ValueError for another speed than 1: the robot's
        time passes by itself.
        """
        if speed != 1.0:
            raise ValueError('a ROS 2 robot runs in real time: speed must be "real"')
        return RosPace(controls, self._ros_time if self._sim_time else None, self._clock_failed)

    def close(self) -> None:
        """Leave the robot at rest with its goals cancelled, and leave the ROS graph. Takes a few seconds at most."""
        try:
            self._clients.close(_LAST_ANSWERS)
            self.robot.close()
        finally:
            self._spun.close()

    def _ros_time(self) -> float:
        return float(self._spun.node.get_clock().now().nanoseconds) * 1e-9

    def _clock_failed(self, what: str) -> None:
        self.bus.emit(Warned, f"{CLOCK.name} {what}, so that the mission's time goes on with the computer's clock")

    def _report(self, kind: str, data: Mapping[str, Any]) -> None:
        self.bus.emit_robot(kind, data)


def _lack(interface: Interface, node: Node | None, reason: str) -> Any:
    return diagnostic(
        "BT101", _place(node), words=_words(node), sort=interface.sort, name=interface.name, reason=reason
    )


def _words(node: Node | None) -> str:
    """Return the words of a leaf; without one, the option --sim-time needs something."""
    if node is None:
        return "--sim-time"
    return node.id if node.span is None else node.span.text


def _place(node: Node | None) -> Span:
    return (None if node is None else node.span) or Span(Source("", "ROS 2"), 0, 0)
