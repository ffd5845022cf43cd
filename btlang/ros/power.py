"""The battery and the dock of a ROS 2 robot."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

from btlang.ros.services import Call, Services
from btlang.ros.subscription_cache import SubscriptionCache

BATTERY, DOCKED, DOCK, UNDOCK = "battery_state", "docked", "dock", "undock"
STATUS = "battery status"
"""The key of what the battery tells besides its percentage, which a robot may leave out."""
_SILENT = 30.0  # seconds without word of the battery


class RosPower:
    """`emit` is told what happens. All raise RobotError where nothing tells what is asked for."""

    def __init__(
        self, node: Node, subscriptions: SubscriptionCache, services: Services, emit: Callable[..., object]
    ) -> None:
        self._subscriptions, self._services, self._emit = subscriptions, services, emit
        self._docked: bool | None = None
        subscriptions.listen(BATTERY, BatteryState, "battery state", refuses=_no_percentage)
        subscriptions.listen(BATTERY, BatteryState, "battery state", key=STATUS)
        subscriptions.listen(DOCKED, Bool, "message from the dock", qos="state")
        services.add(DOCK, Trigger)
        services.add(UNDOCK, Trigger)

    @property
    def battery(self) -> float:
        """Percent left."""
        return 100.0 * float(self._subscriptions.get(BATTERY, _SILENT).percentage)

    @property
    def charging(self) -> bool:
        """True while the battery is being charged."""
        state = self._subscriptions.get(STATUS, _SILENT)
        return bool(state.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_CHARGING)

    @property
    def docked(self) -> bool:
        """True while connected to the dock."""
        return self._docked if self._docked is not None else bool(self._subscriptions.get(DOCKED).data)

    def dock(self) -> Call:
        """Connects to the charger."""
        return self._services.call(DOCK, lambda _: self._connected(True))

    def undock(self) -> Call:
        """Disconnects."""
        return self._services.call(UNDOCK, lambda _: self._connected(False))

    def step(self) -> None:
        """Hears whether it is docked."""
        for message in self._subscriptions.events(DOCKED):
            self._docked = bool(message.data)

    def _connected(self, docked: bool) -> None:
        self._docked = docked  # before the topic tells so
        self._emit("dock" if docked else "undock")


def _no_percentage(state: BatteryState) -> str:
    return "" if 0.0 <= state.percentage <= 1.0 else f"gives no percentage from 0 to 1, but {state.percentage:g}"
