"""What `btc edit` does: the page for one file, for the user who started it alone."""

from __future__ import annotations

import asyncio
import hmac
import os
import secrets
import tempfile
import threading
import time
import webbrowser
from contextlib import closing
from pathlib import Path

from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute
from starlette.types import ASGIApp

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.editing.words import Words
from btlang.server.access import AccessError, address_of, is_same_site
from btlang.server.accounts import Accounts
from btlang.server.app import Api
from btlang.server.bodies import JsonResponse, json_object, text_in
from btlang.server.door import listening
from btlang.server.door import serve as serve_door
from btlang.server.files import Files, TreeFiles, XmlFiles, english_beside, tree_sort
from btlang.server.links import Robots
from btlang.server.pages import BUILT
from btlang.server.private_files import write_private
from btlang.server.roles import Role
from btlang.task.keepable import is_whole
from btlang.task.messages import Answer
from btlang.text.escaping import one_line
from btlang.text.output import show
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

PAGE = BUILT / "index.html"
_HOST = "127.0.0.1"
_USER = "you"
_OPEN = 60.0  # seconds in which the address has to be opened


def edit(options: argparse.Namespace) -> int:
    """Does the verb `edit` until Ctrl-C; returns the exit code. Raises MissionError."""
    if options.file == "-":
        options.refuse("it needs a file, which it saves to")
    if not PAGE.is_file():
        raise MissionError([diagnostic("BT211", NOWHERE)])
    sort = tree_sort(options.file)
    file = english_beside(options.file) if sort else options.file
    words = Words(options.keywords, options.world, options.language, file=file)
    trees = {"xml": XmlFiles, "json": TreeFiles}.get(sort)
    files = trees(words, options.file, options.main) if trees is not None else Files(words)
    files.read(files.name)  # what can't be opened says so at once
    door = listening(_HOST, options.port)
    with (
        tempfile.TemporaryDirectory(prefix="btlang-") as folder,
        closing(Accounts(folder, clock=lambda: 0.0)) as accounts,  # its session ends with it, however long that is
    ):
        api = EditorApi(accounts, files, words, door.getsockname()[1])
        address = f"http://{_HOST}:{door.getsockname()[1]}/login#token={api.ticket}"

        def ready() -> None:
            show(f"Edit {one_line(options.file)} at {address}")
            show(f"The address is good once, within {_OPEN:.0f} s. End with Ctrl-C.")
            if options.browser:
                threading.Thread(target=_open, args=(address, folder), daemon=True).start()

        serve_door(api, door, None, os.path.join(folder, "control"), ready)
    return 0


class EditorApi(Api):
    """The server for one user, an administrator without a password, and without robots.

    `ticket` lets a browser in, once. The cookie is named after the port, since browsers give it to all ports of a host.
    """

    def __init__(self, accounts: Accounts, files: Files, words: Words, port: int) -> None:
        cookie = f"btlang-{port}"
        super().__init__(accounts, secrets.token_hex(32), _NoRobots(), words=words, cookie=cookie)
        accounts.add(_USER, Role.ADMINISTRATOR, "")
        self.ticket = secrets.token_urlsafe(32)
        self._files, self._saving = files, asyncio.Lock()
        self._until: float | None = time.monotonic() + _OPEN

    def app(self) -> ASGIApp:
        """Only under its own name: another site that leads its name to this computer reaches nothing."""
        return TrustedHostMiddleware(super().app(), [_HOST])

    def routes(self) -> list[BaseRoute]:
        """Those of a server, and the files."""
        return [
            self._route("/api/files", self._list_files, "GET"),
            self._route("/api/files/{name:path}", self._read_file, "GET"),
            self._route("/api/files/{name:path}", self._save_file, "PUT"),
            *super().routes(),
        ]

    async def _log_in(self, request: Request) -> Response:
        token = text_in(await json_object(request), "token")
        if not is_same_site(request.headers):
            raise AccessError(403, "This request doesn't come from the page of this server.")
        if not hmac.compare_digest(token.encode("utf-8", "replace"), self.ticket.encode()):
            raise AccessError(401, "This isn't the address that btc edit printed.")
        if self._until is None or time.monotonic() > self._until:
            raise AccessError(401, "This address was opened before, or is too old. Start btc edit again.")
        self._until = None
        secret = await asyncio.to_thread(self.accounts.log_in, _USER, address_of(request))
        identity = await asyncio.to_thread(self.accounts.identity, secret)
        assert identity is not None
        return self._logged_in(identity, secret)

    async def _list_files(self, request: Request) -> Response:
        await self._who(request)
        return _answered({"files": await asyncio.to_thread(self._files.listed)})

    async def _read_file(self, request: Request) -> Response:
        await self._who(request)
        return _answered(await asyncio.to_thread(self._files.read, request.path_params["name"]))

    async def _save_file(self, request: Request) -> Response:
        await self._who(request)
        data = await json_object(request)
        text, revision = text_in(data, "text"), text_in(data, "revision")
        if not is_whole(text):
            raise AccessError(400, "'text' must be a text that a file can hold: without NUL or half a character.")
        async with self._saving:
            answer = await asyncio.to_thread(self._files.save, request.path_params["name"], text, revision)
        return JsonResponse(answer.as_json(), 200 if answer.ok else 409)


class _NoRobots(Robots):
    """An editor has none."""

    async def follow(self) -> None:
        """There is nothing to do."""


def _answered(data: dict[str, object]) -> Response:
    return JsonResponse(Answer(True, "", data, "").as_json())


def _open(address: str, folder: str) -> None:
    """Opens the browser by a private file: the command line of a browser is shown to all users of a computer."""
    try:
        browser = webbrowser.get()
    except webbrowser.Error:
        return
    if type(browser) is webbrowser.GenericBrowser and "BROWSER" not in os.environ:
        return  # one in the terminal
    page = os.path.join(folder, "open.html")
    write_private(page, f'<meta http-equiv="refresh" content="0; url={address}">'.encode())
    browser.open(Path(page).as_uri())
