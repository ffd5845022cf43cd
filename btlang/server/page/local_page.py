"""The page for the user who started a command, on this computer alone: its address, its log-in, and the browser."""

from __future__ import annotations

import asyncio
import hmac
import os
import secrets
import signal
import tempfile
import threading
import time
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.editing.words import RobotWords
from btlang.run.terminal import interrupted_by_signals
from btlang.server.accounts.accounts import Accounts, Identity, UserRole
from btlang.server.http.access import AccessError, JsonResponse, address_of, is_same_site, json_object, text_in
from btlang.server.http.app import Api
from btlang.server.http.listener import open_listener, web_server
from btlang.server.http.pages import BUILT
from btlang.server.live.robot_feeds import RobotFeed, RobotFeeds
from btlang.support.private_file import write_private
from btlang.text.output import show
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

PAGE = BUILT / "index.html"
OPEN = 60.0
"""The seconds in which the address has to be opened."""
_HOST = "127.0.0.1"
_USER = "you"
_LEFT = 3.0  # seconds without a window after which the page was closed, and not loaded again
_LOOK = 0.1
_END = 5.0  # seconds in which the server ends


class LocalApi(Api):
    """The server for one user without a password, whose page has one screen.

    `ticket` lets a browser in, once. The cookie is named after the port, since browsers give it to all ports of a host.
    `screen` are the parts of the address of the screen.
    """

    role = UserRole.ADMINISTRATOR

    def __init__(
        self,
        accounts: Accounts,
        port: int,
        screen: tuple[str, ...],
        robots: RobotFeeds,
        words: RobotWords | None = None,
    ) -> None:
        super().__init__(accounts, secrets.token_hex(32), robots, words=words, cookie=f"btlang-{port}")
        accounts.add(_USER, self.role, "")
        self.ticket = secrets.token_urlsafe(32)
        self.entered: Callable[[], object] = lambda: None
        """A function to call when a browser was let in."""
        self._port, self._screen = port, screen
        self._until: float | None = time.monotonic() + OPEN

    @property
    def may_open(self) -> bool:
        """Return whether the ticket is still good."""
        return self._until is not None and time.monotonic() <= self._until

    def app(self) -> ASGIApp:
        """Return the ASGI application, under its own address alone."""
        return _OwnAddress(super().app(), self._port)

    async def _log_in(self, request: Request) -> Response:
        token = text_in(await json_object(request), "token")
        if not is_same_site(request.headers):
            raise AccessError(403, "This request doesn't come from the page of this server.")
        if not hmac.compare_digest(token.encode("utf-8", "replace"), self.ticket.encode()):
            raise AccessError(401, "This isn't the address that btc printed.")
        if not self.may_open:
            raise AccessError(401, "This address was opened before, or is too old. Start the command again.")
        self._until = None
        self.entered()
        secret = await asyncio.to_thread(self.accounts.log_in, _USER, address_of(request))
        identity = await asyncio.to_thread(self.accounts.identity, secret)
        assert identity is not None
        return self._logged_in(JsonResponse(self._describe(identity)), secret)

    def _describe(self, identity: Identity) -> dict[str, Any]:
        return {**super()._describe(identity), "screen": self._screen}


class LocalRobots(RobotFeeds):
    """The robots of a page, without others that are up on this computer."""

    def __init__(self, *feeds: RobotFeed) -> None:
        super().__init__()
        self._given = feeds

    def look(self) -> None:
        """Add those that were given."""
        for feed in self._given:
            if feed.name not in self.feeds:
                self.add(feed)


class LocalPage:
    """A page that is served until it is closed; see `local_page`. `folder` is a private one."""

    def __init__(self, api: LocalApi, port: int, folder: str) -> None:
        self._api, self._file = api, os.path.join(folder, "open.html")
        self.place = f"http://{_HOST}:{port}"
        self.address = f"{self.place}/login#token={api.ticket}"
        """The address that lets a browser in, once."""
        self._seen = time.monotonic()
        api.entered = self._forget

    @property
    def is_open(self) -> bool:
        """Return whether a window shows the page."""
        return len(self._api.sockets) > 0

    def open(self) -> bool:
        """Open the browser, if there is one with windows; return whether there is.

        It is led there by a private file: the command line of a browser is shown to all users of a computer.
        """
        try:
            browser = webbrowser.get()
        except webbrowser.Error:
            return False
        if type(browser) is webbrowser.GenericBrowser and "BROWSER" not in os.environ:
            return False  # one in the terminal
        write_private(self._file, f'<meta http-equiv="refresh" content="0; url={self.address}">'.encode())
        # a browser may keep the caller waiting until it ends
        threading.Thread(target=browser.open, args=(Path(self._file).as_uri(),), daemon=True).start()
        return True

    @property
    def was_left(self) -> bool:
        """Whether the last window was closed, or nobody can open the first one any more; to be asked often."""
        if self.is_open or self._api.may_open:
            self._seen = time.monotonic()
        return time.monotonic() > self._seen + _LEFT

    def wait(self, is_over: Callable[[], bool]) -> int:
        """Wait until it's over, or is interrupted; return the exit code for that."""
        self._seen = time.monotonic()  # a page that was just being loaded again isn't closed
        with interrupted_by_signals() as came:
            try:
                while not is_over():
                    time.sleep(_LOOK)
            except KeyboardInterrupt:
                return 128 + (came[0] if came else signal.SIGINT)
        return 0

    def _forget(self) -> None:
        with suppress(OSError):
            os.unlink(self._file)


def check_page() -> None:
    """Raise MissionError (BT211) if the page isn't built."""
    if not PAGE.is_file():
        raise MissionError([diagnostic("BT211", NOWHERE)])


@contextmanager
def local_page(make: Callable[[Accounts, int, str], LocalApi], port: int = 0) -> Iterator[LocalPage]:
    """Serve a page as long as it is used, on a port, 0 for a free one. Raises MissionError (BT201, BT211).

    `make` makes its server, from accounts, the port and a private folder. Requests are answered in a thread.
    """
    check_page()
    listener = open_listener(_HOST, port)
    port = listener.getsockname()[1]
    with (
        interrupted_by_signals(),  # so that what it wrote is removed, whenever the signal comes
        tempfile.TemporaryDirectory(prefix="btlang-") as folder,
        closing(Accounts(folder, clock=lambda: 0.0)) as accounts,  # its session ends with it, however long that is
    ):
        api = make(accounts, port, folder)
        server = web_server(api.app(), None)
        thread = threading.Thread(target=lambda: asyncio.run(server.serve([listener])), name="btlang page", daemon=True)
        thread.start()
        try:
            yield LocalPage(api, port, folder)
        finally:
            server.should_exit = True
            thread.join(_END)


def say_where(page: LocalPage, what: str, browser: bool) -> None:
    """Open the browser, or else print the address that lets somebody in: where it opens nobody has to see that."""
    if browser and page.open():
        show(f"{what} in the browser at {page.place}. If none opens, use --no-browser.")
    else:
        show(f"{what} at {page.address}")
        show(f"The address works once, within {OPEN:.0f} s.")


class _OwnAddress:
    """The middleware that answers under its own address alone: another site that leads its name to this computer
    reaches nothing.
    """

    def __init__(self, app: ASGIApp, port: int) -> None:
        self._app = app
        self._hosts = {f"{name}:{port}" for name in (_HOST, "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] in ("http", "websocket"):
            headers = Headers(scope=scope)
            host, origin = headers.get("host"), headers.get("origin")
            if host not in self._hosts or origin not in (None, f"http://{host}"):
                if scope["type"] == "websocket":
                    await send({"type": "websocket.close", "code": 1008})
                else:
                    await PlainTextResponse("This isn't the address of this page.", 403)(scope, receive, send)
                return
        await self._app(scope, receive, send)
