"""What `btc edit` does: the page for one file, for the user who started it alone."""

from __future__ import annotations

import asyncio

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute

from btlang.editing.words import Words
from btlang.server.access import AccessError
from btlang.server.accounts import Accounts
from btlang.server.bodies import JsonResponse, json_object, text_in
from btlang.server.files import Files, TreeFiles, XmlFiles, english_beside, tree_sort
from btlang.server.local_page import LocalApi, LocalRobots, check_page, local_page, say_where
from btlang.task.messages import Answer
from btlang.task.store.records import is_whole
from btlang.text.escaping import one_line
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def edit(options: argparse.Namespace) -> int:
    """Does the verb `edit` until Ctrl-C; returns the exit code. Raises MissionError."""
    if options.file == "-":
        options.refuse("it needs a file, which it saves to")
    check_page()
    sort = tree_sort(options.file)
    file = english_beside(options.file) if sort else options.file
    words = Words(options.keywords, options.world, options.language, file=file)
    trees = {"xml": XmlFiles, "json": TreeFiles}.get(sort)
    files = trees(words, options.file, options.main) if trees is not None else Files(words)
    files.read(files.name)  # what can't be opened says so at once
    with local_page(lambda accounts, port, _: EditorApi(accounts, files, words, port), options.port) as page:
        say_where(page, f"Edit {one_line(options.file)}", options.browser)
        show("End with Ctrl-C.")
        return page.wait(lambda: False)


class EditorApi(LocalApi):
    """The server for the files of an editor, without robots."""

    def __init__(self, accounts: Accounts, files: Files, words: Words, port: int) -> None:
        super().__init__(accounts, port, ("write", "file", files.name), LocalRobots(), words)
        self._files, self._saving = files, asyncio.Lock()

    def routes(self) -> list[BaseRoute]:
        """Those of a server, and the files."""
        return [
            self._route("/api/files", self._list_files, "GET"),
            self._route("/api/files/{name:path}", self._read_file, "GET"),
            self._route("/api/files/{name:path}", self._save_file, "PUT"),
            *super().routes(),
        ]

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


def _answered(data: dict[str, object]) -> Response:
    return JsonResponse(Answer(True, "", data, "").as_json())
