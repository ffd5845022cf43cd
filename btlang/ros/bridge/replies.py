"""The replies to clients of the rosbridge protocol. Imports no ROS, so that the server replies in the same way."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_CHARACTERS = 256 * 1024
"""Of a message as JSON, either way."""
_ANSWERS = {"call_service": ("service_response", "service"), "send_action_goal": ("action_result", "action")}


class BridgeError(Exception):
    """Why something can't be done, in words for who asked."""


def reason_of(error: Exception) -> str:
    """What went wrong, in words."""
    return str(error) if isinstance(error, BridgeError) else f"ROS 2 refuses it: {str(error).partition(', at ')[0]}"


def status(text: str, id: object = None, level: str = "error") -> dict[str, Any]:
    """A status message; `id` is that of what it is about."""
    about = {} if id is None else {"id": id}
    return {"op": "status", **about, "level": level, "msg": text}


def answer(asked: dict[str, Any], values: object, *, success: bool, goal: int = 0) -> dict[str, Any]:
    """What a service call or a goal comes to; `goal` is the status of a goal in ROS 2, 0 for none."""
    op, name = _ANSWERS[asked["op"]]
    about = {} if asked.get("id") is None else {"id": asked["id"]}
    ended = {"status": goal} if name == "action" else {}
    return {"op": op, **about, name: asked[name], "values": values, **ended, "result": success}


def failures(asked: dict[str, Any], text: str) -> list[dict[str, Any]]:
    """That an operation failed: a status and, if somebody waits for an answer, that one."""
    messages = [status(text, asked.get("id"))]
    if asked.get("op") in _ANSWERS and isinstance(asked.get(_ANSWERS[asked["op"]][1]), str):
        messages.append(answer(asked, text, success=False))
    return messages
