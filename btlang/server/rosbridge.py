"""What is spoken at /api/rosbridge: the rosbridge protocol, for the names of the ROS 2 graph that are allowed."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Sequence
from fnmatch import fnmatchcase
from itertools import count

from starlette.websockets import WebSocketDisconnect

from btlang.ros.bridge.replies import failures, status
from btlang.server.access import Access, AccessError
from btlang.server.accounts import Identity
from btlang.server.bodies import read_object
from btlang.server.bridge_process import BridgeProcess
from btlang.server.roles import Role
from btlang.server.sockets import LOST, Visitor
from btlang.support.record import Record
from btlang.text.escaping import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_NAME = re.compile(r"/?[A-Za-z][A-Za-z0-9_]*(?:/[A-Za-z][A-Za-z0-9_]*)*")
"""Of the graph. Names with a part that begins with _ are for ROS itself: they would go past the rules of goals."""
_LONGEST = 200  # characters of a name or an id
_SHOWN = 100  # characters of what is refused


class _Operation(Record):
    name: str  # the field that says what it is about
    role: Role


OPERATIONS = {
    "subscribe": _Operation("topic", Role.VIEWER),
    "unsubscribe": _Operation("topic", Role.VIEWER),
    "advertise": _Operation("topic", Role.OPERATOR),
    "unadvertise": _Operation("topic", Role.VIEWER),
    "publish": _Operation("topic", Role.OPERATOR),
    "call_service": _Operation("service", Role.OPERATOR),
    "send_action_goal": _Operation("action", Role.OPERATOR),
    "cancel_action_goal": _Operation("action", Role.VIEWER),
}
"""With the least role for each. To end what one began needs none."""


class Rosbridge:
    """A `btlang.server.sockets.Subprotocol`. `allowed` are names, with * and ? as in file names."""

    def __init__(self, access: Access, allowed: Sequence[str]) -> None:
        self.greeting: dict[str, Any] | None = None
        self.refusal = status('Log in first: {"op": "auth", "mac": TOKEN}, with a token of this server.')
        self._access, self._allowed = access, tuple(allowed)
        self._visitors: dict[int, Visitor] = {}
        self._numbers = count(1)
        self._bridge = BridgeProcess(self._heard, self._ended)
        self._leaving: set[asyncio.Task[None]] = set()

    def token(self, data: dict[str, Any]) -> object:
        """See `Subprotocol`."""
        return data.get("mac") if data.get("op") == "auth" else None

    def welcome(self, identity: Identity) -> None:
        """See `Subprotocol`: rosbridge has no answer for that."""

    async def talk(self, visitor: Visitor) -> None:
        """See `Subprotocol`. What he began ends with him."""
        number = next(self._numbers)
        self._visitors[number] = visitor
        try:
            try:
                await self._bridge.start()
            except OSError:
                raise WebSocketDisconnect(LOST) from None
            while True:
                await visitor.outlet.wait_for_room()
                for message in await self._take(visitor, number, await visitor.receive()):
                    visitor.outlet.say(json.dumps(message))
        finally:
            self._visitors.pop(number, None)
            self._bridge.write({"client": number, "op": "leave"})

    async def close(self) -> None:
        """Ends the process."""
        await self._bridge.close()

    async def _take(self, visitor: Visitor, number: int, text: str) -> list[dict[str, Any]]:
        """Hands an operation on; what to answer at once."""
        try:
            data = read_object(text)
            if data.get("op") == "auth":  # a page with a cookie may send that, too
                return [status(f"You're logged in as {visitor.identity.user}.", level="info")]
            _check_form(data)
        except AccessError as error:
            return [status(error.reason)]
        reason = self._refusal(visitor, data)
        if reason:
            name = str(data.get(OPERATIONS[data["op"]].name))
            what = f"{data['op']} {one_line(name[:_SHOWN])}"
            await self._access.note(visitor.identity.user, visitor.address, what, "refused")
            return failures(data, reason)
        self._bridge.write({**data, "client": number})
        await self._bridge.drain()
        return []

    def _refusal(self, visitor: Visitor, data: dict[str, Any]) -> str:
        operation = OPERATIONS[data["op"]]
        name = data.get(operation.name)
        if not isinstance(name, str) or len(name) > _LONGEST or not _NAME.fullmatch(name):
            return f"'{operation.name}' must be a name such as /btlang/tasks, whose parts begin with letters."
        if not any(fnmatchcase(f"/{name.removeprefix('/')}", pattern) for pattern in self._allowed):
            return f"{name} isn't one of the names that this server lets through: {', '.join(self._allowed)}."
        if not visitor.identity.role.covers(operation.role):
            return f"Only {operation.role}s may do this: {data['op']}."
        return ""

    def _heard(self, about: dict[str, Any], text: str) -> None:
        visitor = self._visitors.get(about["client"])
        if visitor is None:
            return
        if about["topic"]:
            visitor.outlet.keep(about["topic"], text, about["most"])
        else:
            visitor.outlet.say(text)

    def _ended(self, problem: str) -> None:
        text = json.dumps(status(problem or "The connection to ROS 2 has ended. Connect again."))
        for visitor in self._visitors.values():
            task = asyncio.ensure_future(visitor.leave(LOST, text))
            self._leaving.add(task)
            task.add_done_callback(self._leaving.discard)


def _check_form(data: dict[str, Any]) -> None:
    """Raises AccessError (400)."""
    op = data.get("op")
    if not isinstance(op, str) or op not in OPERATIONS:
        shown = one_line(str(op)[:_SHOWN])
        raise AccessError(400, f"This server doesn't have the op '{shown}'. It has: {', '.join(OPERATIONS)}.")
    id = data.get("id")
    if not (id is None or isinstance(id, int) or (isinstance(id, str) and len(id) <= _LONGEST)):
        raise AccessError(400, f"'id' must be a text of at most {_LONGEST} characters or a whole number.")
