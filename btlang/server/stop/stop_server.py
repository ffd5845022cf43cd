"""The process of the emergency stop: a port, descriptors and a memory of its own, which nothing else can use up.

It knows sessions and tokens by their hashes, which it reads once a second, and reaches robots by the sockets and files
that are for nothing else. It outlives a server that is killed for some seconds, in which another one may begin.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import socket
import sys
import threading
import time
from contextlib import suppress

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Accounts, Identity, hash_secret
from btlang.server.accounts.certificate import Certificate
from btlang.server.http.access import CSRF, Access, AccessError, JsonResponse, host_of, read_body, read_object
from btlang.server.http.connections import Connections
from btlang.server.http.listener import web_server
from btlang.server.live.robot_connection import LocalConnection
from btlang.server.live.supervision import supervise
from btlang.task.commands.client import check_name, data_folder, names_up
from btlang.task.execution.emergency import shut_latch
from btlang.task.messages import EmergencyStop, as_json
from btlang.task.store.database import StoreError
from btlang.task.store.records import is_whole
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

UP = "The emergency stop is up."
"""Its first line."""
_READ = 1.0  # seconds between two looks at the sessions and tokens
_LOOK_UP = 1.0  # seconds for one that isn't known yet
_STOPPED = 0.6  # seconds in which a robot has to say that it has the stop
_MOST_BYTES = 16_384  # of a body
_BODY = 3.0  # seconds for a body
_TOLD = 0.3  # seconds in which it is told who did that, and why: within a second somebody has an answer
_ORPHAN = 0.25  # seconds between two looks whether another server has begun
_LONGEST = 10.0  # seconds for which it outlives a server that was killed
_MOST_CONNECTIONS, _OF_ADDRESS = 64, 16


class StopAccess(Access):
    """The access to the emergency stop: everybody who is logged in."""

    def __init__(self, accounts: Accounts, key: str, cookie: str) -> None:
        super().__init__(accounts, key, cookie)
        self._users: dict[str, Identity] = {}  # by the hashes of their secrets

    def read(self) -> None:
        """Read the sessions and tokens. Raises StoreError; what was known before stays known."""
        self._users = {each.id: each for each in self.accounts.identities()}

    async def _identity(self, secret: str) -> Identity | None:
        found = self._users.get(hash_secret(secret))
        if found is None and secret and is_whole(secret):  # it's younger than the last look, or signed
            with suppress(TimeoutError, StoreError):
                async with asyncio.timeout(_LOOK_UP):
                    return await asyncio.to_thread(self._look_up, secret)
        return found


class StopApp:
    """The application that stops robots: `POST /api/stop` with a `robot` and a `reason`.

    A page of another port of the same host may ask, too: it sends its CSRF token in the body, as `csrf`, so that the
    browser doesn't ask first.
    """

    def __init__(self, access: StopAccess, connections: Connections) -> None:
        self._access, self._connections = access, connections
        self.app = Starlette(
            routes=[
                Route("/api/stop", self._answer, methods=["POST"]),
                Route("/live", lambda request: PlainTextResponse("live")),
            ]
        )

    async def watch(self) -> None:
        """Read who may stop robots, again and again."""
        while True:
            with suppress(StoreError):
                await asyncio.to_thread(self._access.read)
                for _, address in await asyncio.to_thread(self._access.accounts.addresses):
                    self._connections.remember(address)
            await asyncio.sleep(_READ)

    async def _answer(self, request: Request) -> Response:
        origin = request.headers.get("origin", "")
        headers = {"connection": "close", "cache-control": "no-store"}
        if _is_of_this_host(request, origin):
            headers |= {
                "access-control-allow-origin": origin, "access-control-allow-credentials": "true", "vary": "origin",
            }  # fmt: skip
        try:
            text = await self._stop(request, origin)
            return JsonResponse({"ok": True, "text": text, "data": {}, "code": ""}, headers=headers)
        except AccessError as error:
            return JsonResponse({"ok": False, "text": error.reason, "code": ""}, error.status, headers)
        except StoreError:
            return JsonResponse({"ok": False, "text": "The accounts can't be read.", "code": ""}, 503, headers)

    async def _stop(self, request: Request, origin: str) -> str:
        data = read_object(await read_body(request, _MOST_BYTES, _BODY))
        given: Mapping[str, str] = {
            **request.headers,
            "host": origin.partition("://")[2] if _is_of_this_host(request, origin) else "",
            CSRF: str(data.get("csrf", "")) or request.headers.get(CSRF, ""),
        }
        identity = await self._access.identify(given, changes=True, scheme=request.scope["scheme"])
        robot, reason = data.get("robot", ""), data.get("reason", "")
        name = await self._name(str(robot))
        try:
            async with asyncio.timeout(_STOPPED):
                await LocalConnection(name).stop()
        except OSError:
            await asyncio.to_thread(_shut, name, identity.user, str(reason))
            raise AccessError(
                503, f"The emergency stop may not have reached the robot '{name}': STOP IT WHERE IT STANDS."
            ) from None
        await _tell(name, identity.user, str(reason))
        return f"The robot '{name}' is stopped."

    async def _name(self, robot: str) -> str:
        try:
            if robot:
                known = check_name(robot)
                if not os.path.isdir(data_folder(known)) and known not in await asyncio.to_thread(names_up):
                    raise AccessError(404, f"There's no robot '{known}' on this computer.")
                return known
            up = await asyncio.to_thread(names_up)
        except MissionError:
            raise AccessError(404, "There's no such robot.") from None
        if len(up) != 1:
            raise AccessError(409, f"Say which robot: {', '.join(up)}." if up else "No robot is up.")
        return up[0]


def _is_of_this_host(request: Request, origin: str) -> bool:
    """Return whether a page is of the same host, at whatever port."""
    host = host_of(request.headers.get("host", ""))
    return host != "" and host_of(origin) == host


async def _tell(robot: str, user: str, reason: str) -> None:
    """Tell a robot that is stopped who did it, and why; not later, when somebody may have released it."""
    with suppress(OSError, ValueError):
        async with asyncio.timeout(_TOLD):
            await LocalConnection(robot).ask({**as_json(EmergencyStop(reason)), "as": user})


def _shut(robot: str, user: str, reason: str) -> None:
    """Stop a robot that doesn't answer by the file of its latch."""
    with suppress(OSError):
        shut_latch(data_folder(robot), user, reason)


def _watch_parent(notice: str, end: Callable[[], object]) -> None:
    """End some seconds after the server was killed, or once there is another one, which wants this port, too."""
    before = _read_text(notice)
    sys.stdin.read()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # nobody reads what it says any more
    os.dup2(nowhere, 2)
    until = time.monotonic() + _LONGEST
    while time.monotonic() < until and _read_text(notice) == before != "":
        time.sleep(_ORPHAN)
    end()


def _read_text(path: str) -> str:
    try:
        with open(path, encoding="ascii") as file:
            return file.read()
    except OSError:
        return ""


async def _serve(settings: dict[str, Any]) -> None:
    accounts = Accounts(settings["folder"])
    connections = Connections(_MOST_CONNECTIONS, _MOST_CONNECTIONS - _OF_ADDRESS, _OF_ADDRESS)
    app = StopApp(StopAccess(accounts, settings["key"], settings["cookie"]), connections)
    certificate = None if settings["certificate"] is None else Certificate(*settings["certificate"])
    server = web_server(app.app, certificate, connections, settings["proxies"])
    watching = asyncio.create_task(supervise("read the accounts", app.watch))
    end = lambda: os.kill(os.getpid(), signal.SIGTERM)  # noqa: E731 - a thread needs it
    threading.Thread(target=_watch_parent, args=(settings["notice"], end), daemon=True).start()
    serving = asyncio.create_task(server.serve([socket.socket(fileno=settings["descriptor"])]))
    while not server.started and not serving.done():
        await asyncio.sleep(0.01)
    show(UP)
    await serving
    watching.cancel()


def main() -> int:
    """Serve until the server has ended."""
    os.dup2(1, 2)  # its server says what it says, and whoever reads that isn't kept waiting when that has ended
    asyncio.run(_serve(json.loads(sys.stdin.readline())))
    return 0


if __name__ == "__main__":
    sys.exit(main())
