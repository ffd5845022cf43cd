"""The commands of the task layer as services."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial

from btlang_interfaces.srv import Command as CommandService
from btlang_interfaces.srv import TaskCommand
from rclpy.node import Node
from std_srvs.srv import Trigger

from btlang.task import messages
from btlang.task.messages import Answer, Command
from btlang.text.json_text import load_json

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Handle = Callable[[Command | dict[str, Any]], Answer]

_PLAIN = (
    messages.Pause, messages.Step, messages.Release, messages.Status, messages.Components, messages.InviteVisitor,
)  # fmt: skip
_OF_A_TASK = (
    messages.Cancel, messages.Kill, messages.Interrupt, messages.Resume, messages.Skip, messages.Again, messages.Show,
)  # fmt: skip


def create_services(node: Node, handle: Handle) -> None:
    """`~/pause`, `~/cancel` and so on, and `~/command` for all commands as JSON; `handle` does them."""
    for kind in _PLAIN:
        node.create_service(Trigger, f"~/{kind.tag}", partial(_plain, kind, handle))
    for each in _OF_A_TASK:
        node.create_service(TaskCommand, f"~/{each.tag}", partial(_of_a_task, each, handle))
    node.create_service(CommandService, "~/command", partial(_any, handle))


def _plain(kind: type[Command], handle: Handle, request: Any, response: Any) -> Any:
    answer = handle(kind())
    response.success, response.message = answer.ok, answer.text
    return response


def _of_a_task(kind: type[Command], handle: Handle, request: Any, response: Any) -> Any:
    return _filled(response, handle(kind(**{field: getattr(request, field) for field in kind.fields})))


def _any(handle: Handle, request: Any, response: Any) -> Any:
    try:
        data = load_json(request.command)
    except ValueError:
        return _filled(response, Answer(False, "That isn't JSON.", {}, "BT198"))
    return _filled(response, handle(data))


def _filled(response: Any, answer: Answer) -> Any:
    response.ok, response.text, response.code = answer.ok, answer.text, answer.code
    response.data = json.dumps(dict(answer.data), ensure_ascii=False, default=str)
    return response
