"""A handle of a goal by its id alone: DDS may lose the answer of a server that has accepted the goal and does it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from rclpy.action.client import ClientGoalHandle
from unique_identifier_msgs.msg import UUID


def unanswered(client: Any, goal_id: UUID) -> ClientGoalHandle:
    """Of a goal that a client of an action has sent and heard nothing of; for cancelling it, and for its result."""
    return ClientGoalHandle(client, goal_id, SimpleNamespace(accepted=True))
