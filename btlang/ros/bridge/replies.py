"""The replies to clients of the rosbridge protocol. Imports no ROS, so that the server replies in the same way."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_CHARACTERS = 256 * 1024
"""The longest message as JSON, in either direction."""
_ANSWERS = {"call_service": ("service_response", "service"), "send_action_goal": ("action_result", "action")}


class BridgeError(Exception):
    """The reason why something can't be done, for the client that asked."""


def reason_of(error: Exception) -> str:
    """Return the reason of an error in words."""
    return str(error) if isinstance(error, BridgeError) else f"ROS 2 refuses it: {str(error).partition(', at ')[0]}"


def status(text: str, id: object = None, level: str = "error") -> dict[str, Any]:
    """Return a status message; `id` is that of what it is about."""
    about = {} if id is None else {"id": id}
    return {"op": "status", **about, "level": level, "msg": text}


def answer(asked: dict[str, Any], values: object, *, success: bool, goal: int = 0) -> dict[str, Any]:
    """Return the answer to a service call or a goal; `goal` is the status of a goal in ROS 2, 0 for none."""
    op, name = _ANSWERS[asked["op"]]
    about = {} if asked.get("id") is None else {"id": asked["id"]}
    ended = {"status": goal} if name == "action" else {}
    return {"op": op, **about, name: asked[name], "values": values, **ended, "result": success}


def failures(asked: dict[str, Any], text: str) -> list[dict[str, Any]]:
    """Return the replies to an operation that failed: a status and, if somebody waits for an answer, the answer."""
    messages = [status(text, asked.get("id"))]
    if asked.get("op") in _ANSWERS and isinstance(asked.get(_ANSWERS[asked["op"]][1]), str):
        messages.append(answer(asked, text, success=False))
    return messages
