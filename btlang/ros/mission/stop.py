"""The emergency stop as a service of a node of its own: nothing that the mission's node does can delay it."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from std_srvs.srv import Trigger

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class StopNode(Node):  # type: ignore[misc]  # rclpy is seen as untyped
    """`service` is the full name of the service, `stop` says whether there was a robot to stop."""

    def __init__(self, service: str, stop: Callable[[], bool], name: str, **options: Any) -> None:
        super().__init__(name, start_parameter_services=False, enable_rosout=False, **options)
        self._do = stop
        self.create_service(Trigger, service, self._stop)

    def _stop(self, request: Any, response: Any) -> Any:
        response.success = self._do()
        response.message = "" if response.success else "there is no robot, and its latch can't be written"
        return response
