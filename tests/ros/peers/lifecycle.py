"""Lifecycle nodes as somebody else would write them, in Python. `lifecycle.py NAME [FOLDER]`

The node has the service `~/grip` and the parameters `force`, the seconds it takes, and `wrong`, what configure does:
"raise", "hang" or "slow". The file `plan` in FOLDER, if there is one, counts once in place of `wrong`.
"""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty
from std_srvs.srv import Trigger

ALIVE = QoSProfile(depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=Duration(seconds=0.25))


class ArmDriver(LifecycleNode):  # type: ignore[misc]
    """Says what it does, one line for each transition."""

    def __init__(self, name: str, plan: Path | None = None, **options: Any) -> None:
        super().__init__(name, **options)
        self._plan = plan
        self.declare_parameter("force", 1.0)
        self.declare_parameter("wrong", "")
        self._alive = self.create_publisher(Empty, "~/alive", ALIVE)
        self.create_service(Trigger, "~/grip", self._grip)

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Gets ready, or goes wrong."""
        wrong = self.get_parameter("wrong").value
        if self._plan is not None and self._plan.exists():
            wrong = self._plan.read_text(encoding="utf-8")
            self._plan.unlink()
        print("configure", self.get_parameter("force").value, wrong, file=sys.stderr, flush=True)
        if wrong == "raise":
            raise RuntimeError("no arm")
        if wrong in ("hang", "slow"):
            time.sleep(1000.0 if wrong == "hang" else 1.5)
        return TransitionCallbackReturn.SUCCESS

    def _grip(self, request: Any, response: Any) -> Any:
        time.sleep(float(self.get_parameter("force").value))
        response.success = True
        return response


def main(name: str, folder: str = "") -> None:
    """Until a signal comes."""
    rclpy.init()
    node = ArmDriver(name, Path(folder, "plan") if folder else None)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)


if __name__ == "__main__":
    main(*sys.argv[1:])
