"""The battery and the dock of a ROS 2 robot, with docking as Nav2's docking server does it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

from rclpy.action import ActionClient
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.readings import ChargeCheck
from btlang.robots.robot import Operation, RobotError
from btlang.ros.clocks import AWAKE
from btlang.ros.messages import stamped_pose
from btlang.ros.node import ExecutorThread
from btlang.ros.robot.navigation import GoalTask, ServerGoal, ServerGoals
from btlang.ros.robot.services import Services
from btlang.ros.subscriptions import SubscriptionCache

DOCK_ROBOT, UNDOCK_ROBOT = "dock_robot", "undock_robot"
_REASONS = {
    901: "the docking server doesn't know the dock",
    902: "the docking server can't use docks of this type",
    903: "the robot didn't get to the staging pose in front of the dock",
    904: "the dock wasn't detected",
    906: "the robot is in the dock, but doesn't charge",
}
_DOCKING = {**_REASONS, 905: "the robot couldn't be driven into the dock", 907: "docking took too long"}
_UNDOCKING = {**_REASONS, 905: "the robot couldn't be driven out of the dock", 907: "undocking took too long"}
BATTERY, DOCKED, DOCK, UNDOCK = "battery_state", "docked", "dock", "undock"
STATUS = "battery status"
"""The key of what the battery reports besides its percentage; a robot may leave it out."""
_SILENT = 30.0  # seconds without word of the battery
_SETTLED = 5.0  # seconds after which the battery reports a dock that was entered or left
_AT_CHARGER = {
    BatteryState.POWER_SUPPLY_STATUS_CHARGING: True,
    BatteryState.POWER_SUPPLY_STATUS_FULL: True,
    BatteryState.POWER_SUPPLY_STATUS_DISCHARGING: False,
}


class RosDocking(ServerGoals):
    """The clients of the docking server, and the current goal. Docking drives to the staging pose by itself.

    Raises ImportError if nav2_msgs isn't installed or has no docking.
    """

    def __init__(
        self, node: Node, executor: ExecutorThread, where: Callable[[], Pose | None], now: Callable[[], float]
    ) -> None:
        from nav2_msgs.action import DockRobot, UndockRobot  # a robot may have no Nav2, or one without docking

        super().__init__(node, executor, where, now)
        self._dock_type, self._undock_type = DockRobot, UndockRobot
        self._dock = ActionClient(node, DockRobot, DOCK_ROBOT)
        self._undock = ActionClient(node, UndockRobot, UNDOCK_ROBOT)

    @property
    def served(self) -> bool:
        """Whether there is a docking server."""
        return bool(self._dock.server_is_ready() and self._undock.server_is_ready())

    def dock(self, pose: Pose | None) -> ServerGoal:
        """Dock at a pose of the map; with None, at the dock that the server calls "dock"."""
        self.stop("the robot docks instead")
        request = self._dock_type.Goal(use_dock_id=pose is None, dock_id="" if pose is not None else "dock")
        request.navigate_to_staging_pose = True
        if pose is not None:
            request.dock_pose = stamped_pose(pose, self._node.get_clock().now().to_msg())
        task = GoalTask("docking", "dock", "docking", "dock", " on the way into the dock", _DOCKING, False)
        return self.begin(task, self._dock, self._node.resolve_service_name(DOCK_ROBOT), request)

    def undock(self) -> ServerGoal:
        """Leave the dock."""
        self.stop("the robot undocks instead")
        task = GoalTask("docking", "dock", "undocking", "undock", " on the way out of the dock", _UNDOCKING, False)
        server = self._node.resolve_service_name(UNDOCK_ROBOT)
        return self.begin(task, self._undock, server, self._undock_type.Goal())


class RosPower:
    """The battery and the dock. `emit` reports what happens; everything raises RobotError if nothing reports the state.

    `make_docking` makes the clients of the docking server; it raises ImportError if nav2_msgs has none.
    """

    def __init__(
        self,
        node: Node,
        subscriptions: SubscriptionCache,
        services: Services,
        emit: Callable[..., object],
        make_docking: Callable[[], RosDocking],
    ) -> None:
        self._subscriptions, self._services, self._emit = subscriptions, services, emit
        self._make_docking = make_docking
        self.docking: RosDocking | None = None
        self._docks = False
        self._docked: bool | None = None
        self._since = -_SETTLED
        self._charge = ChargeCheck()
        subscriptions.listen(BATTERY, BatteryState, "battery state", refuses=self._charge_fault)
        subscriptions.listen(BATTERY, BatteryState, "battery state", key=STATUS)
        subscriptions.listen(DOCKED, Bool, "message from the dock", qos="state")
        services.add(DOCK, Trigger)
        services.add(UNDOCK, Trigger)

    @property
    def level(self) -> float:
        """The percentage that is left."""
        return 100.0 * float(self._subscriptions.get(BATTERY, _SILENT).percentage)

    @property
    def empty(self) -> bool:
        """Whether the robot reports an empty battery."""
        try:
            return self.level <= 0.0
        except RobotError:
            return False

    @property
    def charging(self) -> bool:
        """Whether the battery is being charged."""
        state = self._subscriptions.get(STATUS, _SILENT)
        return bool(state.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_CHARGING)

    @property
    def docked(self) -> bool:
        """Whether it is connected to the dock.

        If no topic reports it, the battery does: it charges, or is full.
        """
        if self._docked is None:
            self._hear_battery()
        return self._docked if self._docked is not None else bool(self._subscriptions.get(DOCKED).data)

    def prepare_docking(self) -> bool:
        """Make the clients of the docking server, which find it in a moment; return False if
        nav2_msgs has no docking.
        """
        if self.docking is None:
            with suppress(ImportError):
                self.docking = self._make_docking()
        return self.docking is not None

    @property
    def docks_by_itself(self) -> bool:
        """Whether there is a docking server, which drives the robot into its dock and out of it."""
        return self.prepare_docking() and self.docking is not None and self.docking.served

    def dock(self, pose: Pose | None) -> Operation:
        """Connect to the charger. A docking server drives there, at a pose of the map if that is known."""
        if self.docking is None or not self.docks_by_itself:
            return self._services.call(DOCK, lambda _: self._set_docked(True))
        self._docks = True
        return self.docking.dock(pose)

    def undock(self) -> Operation:
        """Disconnect. A docking server drives out of the dock."""
        if self.docking is None or not self.docks_by_itself:
            return self._services.call(UNDOCK, lambda _: self._set_docked(False))
        self._docks = False
        return self.docking.undock()

    def step(self) -> None:
        """Read whether it is docked."""
        for message in self._subscriptions.events(DOCKED):
            self._docked = bool(message.data)
        self._hear_battery()
        ended = self.docking.step() if self.docking is not None else None
        if ended is not None and ended.failure is None:
            self._set_docked(self._docks)

    def _charge_fault(self, state: BatteryState) -> str:
        if not 0.0 <= state.percentage <= 1.0:
            return f"gives no percentage from 0 to 1, but {state.percentage:g}"
        return self._charge.fault(100.0 * state.percentage, AWAKE.now())

    def _hear_battery(self) -> None:
        """Take what the battery reports about the dock, if no topic does."""
        if not self._subscriptions.has(DOCKED) and AWAKE.now() - self._since > _SETTLED:
            with suppress(RobotError):
                status = self._subscriptions.get(STATUS, _SILENT).power_supply_status
                self._docked = _AT_CHARGER.get(status, self._docked)

    def _set_docked(self, docked: bool) -> None:
        self._docked, self._since = docked, AWAKE.now()  # before the topic reports it
        self._emit("dock" if docked else "undock")
