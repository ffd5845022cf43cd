"""The server's routes: log-in, commands to robots, the library, and the WebSocket."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from functools import partial

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.words import RobotWords
from btlang.server.accounts.accounts import LONGEST, NEEDED, Accounts, Identity
from btlang.server.fleet.fleet import Fleet
from btlang.server.fleet.joining import Joins
from btlang.server.http.access import (
    COOKIE,
    UNREADABLE,
    Access,
    AccessError,
    JsonResponse,
    address_of,
    admit,
    cookie_in,
    json_object,
    text_in,
)
from btlang.server.http.headers import Headers
from btlang.server.http.openapi import LIBRARY, VERSION, document
from btlang.server.http.pages import page_routes
from btlang.server.http.users import UserRequests
from btlang.server.live.clients import ClientProtocol
from btlang.server.live.robot_feeds import RobotFeed, RobotFeeds, metrics
from btlang.server.live.rosbridge import Rosbridge
from btlang.server.live.sockets import Sockets
from btlang.server.live.supervision import supervise
from btlang.server.page.processes import ASKED, TRIES, Checker, arguments_of, comparison, failures, film, tree
from btlang.server.page.recordings import RecordingResponse, fetch, in_file, path_of, recordings_of, runs_like
from btlang.task import messages
from btlang.task.messages import Answer, Command, read_command
from btlang.task.store.database import StoreError
from btlang.task.store.records import LibraryKind

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST_FETCHING = 2  # recordings of robots elsewhere that are shown at a time: each is copied
_LOOK = 1.0  # seconds between two looks at who may still be here
_KNOWN_DEVICE = 365 * 86_400  # seconds for which a browser is known


class Api:
    """The API of the server: what its routes do.

    `ros` are the names of the ROS 2 graph that are allowed. Texts are read with `words`, if they are given, in place of
    those of a robot.
    """

    def __init__(
        self,
        accounts: Accounts,
        key: str,
        robots: RobotFeeds | None = None,
        ros: Sequence[str] = (),
        words: RobotWords | None = None,
        cookie: str = COOKIE,
    ) -> None:
        self.accounts, self.robots, self.words = accounts, robots or RobotFeeds(), words
        self.access, self.checker, self.trials = Access(accounts, key, cookie), Checker(), Checker()
        self.sockets, self.clients = Sockets(self.access), ClientProtocol(self.robots, self.send)
        self.rosbridge = Rosbridge(self.access, ros) if ros else None
        self.stop_port = 0
        """The port of the process of the emergency stop, 0 for none."""
        self._fetching = asyncio.Semaphore(_MOST_FETCHING)
        self.users = UserRequests(self.access, self._who, self.sockets.check)
        self.joins = Joins(Fleet(accounts.database), self.robots, self.access)

    def app(self) -> ASGIApp:
        """Return the ASGI application."""
        return Headers(Starlette(routes=self.routes(), lifespan=self._life, exception_handlers={404: _not_found}))

    def routes(self) -> list[BaseRoute]:
        """Return all routes."""
        return [
            self._route("/api/login", self._log_in, "POST"),
            self._route("/api/logout", self._log_out, "POST"),
            self._route("/api/me", self._me, "GET"),
            *(self._route(path, do, method) for method, path, do in self.users.routes()),
            self._route("/api/robots", self._robots, "GET"),
            self._route("/api/stop", self._stop, "POST"),
            self._route("/api/commands", self._command, "POST"),
            *(route for path, kind in LIBRARY.items() for route in self._library(path, kind)),
            *(self._route(f"/api/{kind}", partial(self._text, kind), "POST") for kind in ASKED),
            self._route("/api/recordings", self._recordings, "GET"),
            self._route("/api/recordings/{name}", self._recording, "GET"),
            self._route("/api/films/{name}", partial(self._show_film, film, ()), "GET"),
            self._route("/api/trees/{name}", partial(self._show_film, tree, ()), "GET"),
            self._route("/api/failures/{name}", partial(self._show_film, failures, None), "GET"),
            self._route("/api/comparisons/{name}", partial(self._show_film, comparison, ("with",)), "GET"),
            self._route("/api/urdf", self._urdf, "GET"),
            self._route("/metrics", self._metrics, "GET"),
            Route("/openapi.json", lambda request: JsonResponse(document())),
            *page_routes(self.access, lambda: self.stop_port),
            Route("/live", _word("live")),
            Route("/ready", _word("ready")),
            WebSocketRoute("/api/ws", partial(self.sockets.serve, self.clients)),
            WebSocketRoute(
                "/api/rosbridge",
                _no_socket if self.rosbridge is None else partial(self.sockets.serve, self.rosbridge),
            ),
            WebSocketRoute("/api/join", self.joins.serve),
        ]

    async def check(self) -> None:
        """Send away who may no longer be here, and look which robots may join."""
        await self.sockets.check()
        await self.joins.check()

    async def send(self, identity: Identity, robot: str, command: Command, address: str) -> Answer:
        """Send a command to a robot, by somebody who may at this moment; return the answer. Raises AccessError.

        The emergency stop waits for no disk: it is enough that the access was valid some seconds ago.
        """
        if not isinstance(command, messages.EmergencyStop):
            identity = await self.access.still(identity)
        if not identity.role.covers(NEEDED[type(command)]):
            await self.access.note(identity.user, address, command.tag, "refused")
            raise AccessError(403, f"Only {NEEDED[type(command)]}s may do this.")
        feed = self.feed(robot)
        if feed.is_elsewhere and not isinstance(command, messages.EmergencyStop):
            await self.joins.check()
            feed = self.feed(robot)
        try:
            if isinstance(command, messages.EmergencyStop):
                await feed.stop()  # at once; what follows says who, and why
            return await feed.send(command, identity.user)
        except ConnectionError as error:
            raise AccessError(503, str(error)) from None

    def feed(self, robot: str) -> RobotFeed:
        """Return the feed of a robot.

        Raises AccessError (404, 409) if there is no such robot, or several where none was named.
        """
        feed = self.robots.get(robot)
        if feed is None and robot:
            raise AccessError(404, f"There's no robot '{robot}'.")
        if feed is None:
            up = [feed.name for feed in self.robots.feeds.values() if feed.is_up]
            raise AccessError(409, f"Say which robot: {', '.join(up)}." if up else "No robot is up.")
        return feed

    @asynccontextmanager
    async def _life(self, app: Starlette) -> AsyncIterator[None]:
        await self.joins.check()
        tasks = [
            asyncio.create_task(supervise("look for robots", self.robots.follow)),
            asyncio.create_task(supervise("look at the accounts", self._watch_accounts)),
        ]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks)
            self.access.close()
            self.checker.close()
            self.trials.close()
            if self.rosbridge is not None:
                await self.rosbridge.close()

    async def _watch_accounts(self) -> None:
        while True:
            await asyncio.sleep(_LOOK)
            with suppress(StoreError):  # nobody is sent away because a disk doesn't answer
                await self.check()

    def _route(self, path: str, do: Callable[[Request], Awaitable[Response]], method: str) -> Route:
        async def answered(request: Request) -> Response:
            try:
                return await do(request)
            except AccessError as error:
                headers = {"retry-after": f"{error.wait + 1:.0f}"} if error.wait else None
                return JsonResponse({"ok": False, "text": error.reason, "code": error.code}, error.status, headers)
            except StoreError:  # whose text has paths
                return JsonResponse({"ok": False, "text": UNREADABLE, "code": ""}, 503)
            except MissionError as error:
                first = error.diagnostics[0]
                return JsonResponse({"ok": False, "text": str(error), "code": first.code}, 400)

        return Route(path, answered, methods=[method])

    async def _who(self, request: Request, *, stops: bool = False) -> Identity:
        """Return who asks, as it is at this moment; one who `stops` a robot waits for no disk."""
        changes = request.method not in ("GET", "HEAD")
        identity = await self.access.identify(request.headers, changes=changes, scheme=request.scope["scheme"])
        if not stops:
            identity = await self.access.still(identity)
        admit(request, identity.user)
        return identity

    async def _log_in(self, request: Request) -> Response:
        data = await json_object(request)
        name, device = text_in(data, "name"), cookie_in(request.headers, self.access.device_cookie)
        identity, secret = await self.access.log_in(name, text_in(data, "password"), address_of(request), device)
        admit(request, identity.user)
        response = JsonResponse(self._describe(identity))
        known = self.access.device(device, identity.user)
        response.set_cookie(value=known, max_age=_KNOWN_DEVICE, **{**self._cookie, "key": self.access.device_cookie})
        return self._logged_in(response, secret)

    def _logged_in(self, response: Response, secret: str) -> Response:
        response.set_cookie(value=secret, max_age=int(LONGEST), **self._cookie)
        return response

    @property
    def _cookie(self) -> dict[str, Any]:
        """Return the name of the cookie: over plain HTTP, browsers take none of the name that needs TLS."""
        name = self.access.cookie
        return {"key": name, "secure": name == COOKIE, "httponly": True, "samesite": "strict"}

    async def _log_out(self, request: Request) -> Response:
        identity = await self._who(request)
        data = await json_object(request, identity.user)
        ended = "" if data.get("everywhere") is True else identity.id
        await asyncio.to_thread(self.accounts.log_out, identity.user, ended)
        await self.sockets.check()
        response = JsonResponse({"ok": True})
        response.delete_cookie(**self._cookie)
        return response

    async def _me(self, request: Request) -> Response:
        return JsonResponse(self._describe(await self._who(request)))

    async def _robots(self, request: Request) -> Response:
        await self._who(request)
        await self.joins.check()
        feeds = self.robots.feeds.values()
        listed = [
            {"name": each.name, "up": each.is_up, "seen": each.seen, "elsewhere": each.is_elsewhere} for each in feeds
        ]
        return JsonResponse({"robots": listed})

    async def _stop(self, request: Request) -> Response:
        identity = await self._who(request, stops=True)
        data = await json_object(request, identity.user)
        robot, reason = data.get("robot", ""), data.get("reason", "")
        command = messages.EmergencyStop(reason if isinstance(reason, str) else "")
        return _answer(await self.send(identity, str(robot), command, address_of(request)))

    async def _command(self, request: Request) -> Response:
        identity = await self._who(request)
        data = await json_object(request, identity.user)
        robot = data.pop("robot", "")
        return _answer(await self.send(identity, str(robot), read_command(data), address_of(request)))

    async def _text(self, kind: str, request: Request) -> Response:
        identity = await self._who(request)
        data = await json_object(request, identity.user)
        text, robot = text_in(data, "text"), str(data.get("robot", ""))
        arguments = arguments_of(kind, data, text)
        words = self.words or (self.feed(robot).words if robot or self.robots.feeds else RobotWords())
        if "world" in data:
            name = text_in(data, "world")
            if not name:
                raise AccessError(400, "'world' must be the name of a world.")
            command = messages.Library(name, LibraryKind.WORLD.value, revision=0)
            found = await self.send(identity, robot, command, address_of(request))
            if not found.ok:
                return _answer(found)
            try:
                words = words.in_world(name, str(found.data["worlds"][0]["text"]))
            except (LookupError, TypeError):  # a robot may say anything
                raise AccessError(503, f"The robot didn't send the world '{name}'.") from None
        page = str(data.get("page", "")) if identity.is_session else None  # a program doesn't type
        checker = self.trials if kind in TRIES else self.checker
        written = await checker.answer(kind, text, words, arguments, identity.user, page)
        return Response(written, media_type="application/json")

    async def _recordings(self, request: Request) -> Response:
        return JsonResponse({"ok": True, "recordings": await recordings_of(await self._recorder(request))})

    async def _recording(self, request: Request) -> Response:
        feed, name = await self._recorder(request), request.path_params["name"]
        if feed.is_elsewhere:
            return RecordingResponse(await fetch(feed.read, name))
        path = await asyncio.to_thread(path_of, feed.recordings, name)
        return FileResponse(path, media_type="application/octet-stream")

    async def _show_film(self, show: Callable[..., bytes], query: tuple[str, ...] | None, request: Request) -> Response:
        """Return what a page shows of a recording, and of others: those in the `query`, or None for all like it.

        What has words of nodes has them in the `language` of the query, "" for that of the mission.
        """
        feed, name = await self._recorder(request), request.path_params["name"]
        more = await runs_like(feed, name) if query is None else [request.query_params.get(each, "") for each in query]
        async with AsyncExitStack() as stack:
            if feed.is_elsewhere:
                await stack.enter_async_context(self._fetching)  # a copy may be large
            paths = [await stack.enter_async_context(self._file(feed, name, request)) for name in (name, *more)]
            if show in (film, comparison):
                show = partial(show, language=request.query_params.get("language", ""))
            return Response(await self.trials.shown(show, *paths), media_type="application/json")

    @asynccontextmanager
    async def _file(self, feed: RobotFeed, name: str, request: Request) -> AsyncIterator[str]:
        if not feed.is_elsewhere:
            yield await asyncio.to_thread(path_of, feed.recordings, name)
            return

        async def is_wanted() -> bool:
            return not await request.is_disconnected()

        async with in_file(await fetch(feed.read, name), is_wanted) as path:
            yield path

    async def _recorder(self, request: Request) -> RobotFeed:
        """Return the robot whose recordings are asked for."""
        await self._who(request)
        feed = self.feed(request.query_params.get("robot", ""))
        if feed.is_elsewhere and not feed.is_up:
            raise AccessError(503, f"The robot '{feed.name}' isn't up: its recordings are on its own computer.")
        return feed

    async def _urdf(self, request: Request) -> Response:
        answer = await self._sent(request, messages.Urdf())
        return Response(str(answer.data.get("urdf")), media_type="application/xml") if answer.ok else _answer(answer)

    async def _metrics(self, request: Request) -> Response:
        await self._who(request)
        return PlainTextResponse(metrics(self.robots.feeds.values(), len(self.sockets)))

    def _library(self, path: str, kind: LibraryKind) -> list[Route]:
        return [
            self._route(path, partial(self._list, kind), "GET"),
            self._route(f"{path}/{{name:path}}", partial(self._list, kind), "GET"),
            self._route(f"{path}/{{name:path}}", partial(self._put, kind), "PUT"),
            self._route(f"{path}/{{name:path}}", partial(self._delete, kind), "DELETE"),
        ]

    async def _list(self, kind: LibraryKind, request: Request) -> Response:
        return await self._of_library(request, messages.Library(request.path_params.get("name", ""), kind.value))

    async def _put(self, kind: LibraryKind, request: Request) -> Response:
        identity = await self._who(request)
        data = await json_object(request, identity.user)
        revision = data.get("revision")
        if revision is not None and not isinstance(revision, int):
            raise AccessError(400, "'revision' must be a number.")
        command = messages.Put(request.path_params["name"], text_in(data, "text"), revision, kind.value)
        robot = request.query_params.get("robot", "")
        return _answer(await self.send(identity, robot, command, address_of(request)))

    async def _delete(self, kind: LibraryKind, request: Request) -> Response:
        return await self._of_library(request, messages.Delete(request.path_params["name"], kind.value))

    async def _of_library(self, request: Request, command: Command) -> Response:
        return _answer(await self._sent(request, command))

    async def _sent(self, request: Request, command: Command) -> Answer:
        robot = request.query_params.get("robot", "")
        return await self.send(await self._who(request), robot, command, address_of(request))

    def _describe(self, identity: Identity) -> dict[str, Any]:
        described: dict[str, Any] = {"ok": True, "user": identity.user, "role": identity.role, "version": VERSION}
        if self.stop_port:
            described["stop"] = self.stop_port
        return {**described, "csrf": self.access.csrf(identity)} if identity.is_session else described


def _answer(answer: Answer) -> Response:
    return JsonResponse(answer.as_json(), 200 if answer.ok else 409)


def _word(word: str) -> Callable[[Request], Response]:
    return lambda request: PlainTextResponse(word)


async def _no_socket(socket: WebSocket) -> None:
    await socket.send_denial_response(_not_found())


def _not_found(*_: object) -> Response:
    return JsonResponse({"ok": False, "text": "There's nothing at this address.", "code": ""}, 404)
