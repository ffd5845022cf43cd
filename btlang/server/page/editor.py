"""The page of `btc edit`: one file and those that it includes, saved without losing what others wrote."""

from __future__ import annotations

import asyncio
import errno
import os
from contextlib import suppress
from hashlib import sha256

from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import BaseRoute

from btlang.backends.targets import target_of
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import MOST_DEEP, has_mark, read_included, read_source, unwritable, write_file
from btlang.editing.english_of_xml import write_onto
from btlang.editing.words import RobotWords
from btlang.frontends.mission.symbols.includes import find_includes
from btlang.frontends.table import FRONTENDS, frontend_of
from btlang.server.accounts.accounts import Accounts
from btlang.server.http.access import AccessError, JsonResponse, json_object, text_in
from btlang.server.page.local_page import LocalApi, LocalRobots, check_page, local_page, say_where
from btlang.server.page.processes import MOST_CHARACTERS
from btlang.support.test_files import ENDING, is_test_file
from btlang.task.commands.answers import differences
from btlang.task.commands.checks import refusal_error
from btlang.task.messages import Answer
from btlang.task.store.records import is_whole
from btlang.text.formatting import one_line
from btlang.text.output import show
from btlang.text.source import Source, Span
from btlang.text.words import split

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from typing import Any


class EditorFiles:
    """The files of an editor.

    The one that `words` belong to can be saved, and the file of its tests beside it; the others, which it includes, are
    shown.

    A revision is a hash of the content, "" for a file that isn't there. Methods raise MissionError for one that can't
    be read (BT001, BT002) or written (BT009), and AccessError (403, 404).
    """

    def __init__(self, words: RobotWords) -> None:
        self.path, self.name = words.file, os.path.basename(words.file)
        self._words = words
        stem = self.path.removesuffix(".txt")
        self._tests = "" if is_test_file(self.path) else stem + ENDING

    def listed(self) -> list[dict[str, Any]]:
        """List all, the one that was opened first, and its tests last."""
        saved = self._savable_paths()
        names = [self.name, *(name for name in self._included_paths() if name not in saved), *list(saved)[1:]]
        return [{"name": name, "saves": name in saved} for name in names]

    def read(self, name: str) -> dict[str, Any]:
        """Return the `text` of a file and its `revision`; of a tree also the name of the `tree`, that of its `copy`,
        and a `problem` if there's one.
        """
        if (path := self._savable_paths().get(name)) is not None:
            return _content(_text(path))
        included = self._included_paths()
        if name not in included:
            raise AccessError(404, "That file isn't open here.")
        return _content(included[name].text)

    def save(self, name: str, text: str, revision: str) -> Answer:
        """Write a text that was made from a revision; where the file has another one by now, it is refused with the
        difference. Line ends stay those of the file.
        """
        path = self._savable_paths().get(name)
        if path is None:
            raise AccessError(403, "Only the file that was opened can be saved, and its tests.")
        before = _text(path)
        text = text if before is None else _with_line_ends(text, before)
        if revision != _revision(before):
            problem = refusal_error(f"The file '{name}'", "was changed by another program, or in another window")
            data = {**_content(before), "diff": differences(before or "", text)}
            return Answer(False, str(problem), data, problem.diagnostics[0].code)
        write_file(path, ("\ufeff" if before is not None and has_mark(path) else "") + text)
        return Answer(True, f"Saved {name}.", {"revision": _revision(text)}, "")

    def _savable_paths(self) -> dict[str, str]:
        """Return the paths of those that can be saved, by their names."""
        return {os.path.basename(path): path for path in (self.path, self._tests) if path}

    def _included_paths(self) -> dict[str, Source]:
        """Return the included files by their names as seen from the folder of the file; those that can't be read are
        left out.
        """
        waiting = [self._words.source(_text(self.path) or "")]
        found: dict[str, Source] = {}
        while waiting and len(found) < MOST_DEEP:
            source = waiting.pop()
            try:
                vocabulary = self._words.vocabulary(source)
            except MissionError:
                break
            for path, _ in find_includes(split(source, vocabulary.orthography), vocabulary).found:
                try:
                    included = read_included(path, source)
                except MissionError:
                    continue
                name = os.path.relpath(included.name, os.path.dirname(self.path) or os.curdir)
                if name not in found:
                    found[name] = included
                    waiting.append(included)
        return found


class TreeEditorFiles(EditorFiles):
    """A mission that is, until it is saved, the English of a tree in JSON. Saving it also writes its tree into a copy
    of that one, which itself stays as it is. `main` is the ID of one of several trees.
    """

    def __init__(self, words: RobotWords, tree: str, main: str = "") -> None:
        super().__init__(words)
        self._tree, self._main, self._target = tree, main, tree_sort(tree)
        self._copy = f"{os.path.splitext(self.path)[0]}.{self._target}"
        self._names = {"tree": os.path.basename(tree), "copy": os.path.basename(self._copy)}
        self._written = self._content_of_copy() if os.path.lexists(self.path) else None
        """The copy as it was written from this mission."""

    def read(self, name: str) -> dict[str, Any]:
        """Read a file as EditorFiles does. Raises MissionError for a tree that can't be read or said, too."""
        content = super().read(name)
        if name != self.name:
            return content
        if not content["revision"]:
            content["text"] = self._english()
        tree = self._names["tree"]
        with suppress(OSError):
            if os.path.getmtime(self._tree) > os.path.getmtime(self.path):
                content["problem"] = (
                    f"{tree} has changed since {name} was saved. To begin with it again, remove {name}."
                )
        return {**content, **self._names}

    def save(self, name: str, text: str, revision: str) -> Answer:
        """Save a file as EditorFiles does; `problem` says why the copy wasn't written, for which the text has to
        compile.
        """
        answer = super().save(name, text, revision)
        if not answer.ok or name != self.name:
            return answer
        data, copy = {**answer.data, **self._names}, self._names["copy"]
        try:
            if self._content_of_copy() not in (None, self._written):
                raise refusal_error(
                    f"The file '{copy}'", "was written by another program. To have it anew, move it away"
                )
            write_file(self._copy, self._words.mission(self._words.source(text)).to(self._target))
            self._written = self._content_of_copy()
        except MissionError as error:
            problem = f"{copy} is not written anew: {error.diagnostics[0].message}"
            return Answer(True, f"{answer.text} {problem}", {**data, "problem": problem})
        return Answer(True, f"{answer.text} Its tree is in {copy}.", data)

    def _content_of_copy(self) -> str | None:
        return read_source(self._copy).text if os.path.isfile(self._copy) else None

    def _english(self) -> str:
        return _english_of(self._tree, self._words, self._main)


class XmlEditorFiles(EditorFiles):
    """A tree in XML in English, which saving writes onto it. A text that doesn't compile yet is kept beside it until it
    does. `main` is the ID of one of several trees.
    """

    def __init__(self, words: RobotWords, tree: str, main: str = "") -> None:
        super().__init__(words)
        self._tree, self._main = tree, main

    def read(self, name: str) -> dict[str, Any]:
        """Read a file as EditorFiles does. Raises MissionError for a tree that can't be read or said, too."""
        if name != self.name:
            return super().read(name)
        text = _text(self.path)
        text = _english_of(self._tree, self._words, self._main) if text is None else text
        return {"text": text, "revision": self._state(), "tree": os.path.basename(self._tree)}

    def save(self, name: str, text: str, revision: str) -> Answer:
        """Save a file as EditorFiles does; `problem` says why the tree wasn't written, for which the text has to
        compile.
        """
        if name != self.name:
            return super().save(name, text, revision)
        tree, before = os.path.basename(self._tree), self.read(name)
        if revision != before["revision"]:
            problem = refusal_error(f"The file '{tree}'", "was changed by another program, or in another window")
            data = {**before, "diff": differences(before["text"], text)}
            return Answer(False, str(problem), data, problem.diagnostics[0].code)
        try:
            write_onto(self._words.mission(self._words.source(text)), self._tree, force=True)
        except MissionError as error:
            write_file(self.path, text)
            trouble = f"{tree} is not written: {error.diagnostics[0].message}"
            data = {"revision": self._state(), "tree": tree, "problem": trouble}
            return Answer(True, f"Kept {name}. {trouble}", data)
        with suppress(FileNotFoundError):
            os.remove(self.path)
        return Answer(True, f"Saved {tree}.", {"revision": self._state(), "tree": tree})

    def _state(self) -> str:
        """Return the revision of the tree, and that of the text that is kept beside it."""
        return f"{_revision(read_source(self._tree).text)} {_revision(_text(self.path))}"


def _english_of(tree: str, words: RobotWords, main: str) -> str:
    source = read_source(tree)
    return _of_fair_size(str(words.mission(source, main=main).to("english")), source)


def tree_sort(path: str) -> str:
    """Return what the file of a tree is in, "xml" or "json"; "" for a mission in English, there or not."""
    sort = target_of(path)
    with suppress(MissionError):  # which opening it will say
        sort = frontend_of(read_source(path)) if os.path.isfile(path) else sort
    return sort if sort in FRONTENDS and sort != "english" else ""


def english_beside(tree: str) -> str:
    """Return the file of the mission that is written for a tree."""
    return os.path.splitext(tree)[0] + ".edited.txt"


def _text(path: str) -> str | None:
    """Return the text of a file, None if it isn't there.

    Its folder must be there, and it must be no other sort of file.
    """
    source = Source("", path)
    if not os.path.lexists(path):
        folder = os.path.dirname(path) or os.curdir
        if not os.path.isdir(folder):
            raise MissionError([unwritable(path, f"there's no folder {folder}")])
        return None
    if os.path.exists(path) and not os.path.isfile(path):
        reason = os.strerror(errno.EISDIR).lower() if os.path.isdir(path) else "it isn't a regular file"
        raise _unreadable(source, reason)
    return _of_fair_size(read_source(path).text, source)


def _of_fair_size(text: str, source: Source) -> str:
    if len(text) > MOST_CHARACTERS:
        raise _unreadable(source, f"it has more than {MOST_CHARACTERS:,} characters")
    return text


def _unreadable(source: Source, reason: str) -> MissionError:
    return MissionError([diagnostic("BT001", Span(source, 0, 0), file=source.name, reason=reason)])


def _content(text: str | None) -> dict[str, Any]:
    return {"text": text or "", "revision": _revision(text)}


def _revision(text: str | None) -> str:
    return "" if text is None else sha256(text.encode()).hexdigest()


def _with_line_ends(text: str, before: str) -> str:
    """Return a text with other line ends: a page has line feeds alone."""
    return text.replace("\n", "\r\n") if "\r\n" in before and "\r" not in text else text


def edit(options: argparse.Namespace) -> int:
    """Do the verb `edit` until Ctrl-C; return the exit code. Raises MissionError."""
    if options.file == "-":
        options.refuse("it needs a file, which it saves to")
    check_page()
    sort = tree_sort(options.file)
    file = english_beside(options.file) if sort else options.file
    words = RobotWords(options.keywords, options.world, options.language, file=file)
    trees = {"xml": XmlEditorFiles, "json": TreeEditorFiles}.get(sort)
    files = trees(words, options.file, options.main) if trees is not None else EditorFiles(words)
    files.read(files.name)  # what can't be opened says so at once
    with local_page(lambda accounts, port, _: EditorApi(accounts, files, words, port), options.port) as page:
        say_where(page, f"Edit {one_line(options.file)}", options.browser)
        show("End with Ctrl-C.")
        return page.wait(lambda: False)


class EditorApi(LocalApi):
    """The server for the files of an editor, without robots."""

    def __init__(self, accounts: Accounts, files: EditorFiles, words: RobotWords, port: int) -> None:
        super().__init__(accounts, port, ("write", "file", files.name), LocalRobots(), words)
        self._files, self._saving = files, asyncio.Lock()

    def routes(self) -> list[BaseRoute]:
        """Return the routes of a server, and the files."""
        return [
            self._route("/api/files", self._list_files, "GET"),
            self._route("/api/files/{name:path}", self._read_file, "GET"),
            self._route("/api/files/{name:path}", self._save_file, "PUT"),
            *super().routes(),
        ]

    async def _list_files(self, request: Request) -> Response:
        await self._who(request)
        return _answer({"files": await asyncio.to_thread(self._files.listed)})

    async def _read_file(self, request: Request) -> Response:
        await self._who(request)
        return _answer(await asyncio.to_thread(self._files.read, request.path_params["name"]))

    async def _save_file(self, request: Request) -> Response:
        identity = await self._who(request)
        data = await json_object(request, identity.user)
        text, revision = text_in(data, "text"), text_in(data, "revision")
        if not is_whole(text):
            raise AccessError(400, "'text' must be a text that a file can hold: without NUL or half a character.")
        async with self._saving:
            answer = await asyncio.to_thread(self._files.save, request.path_params["name"], text, revision)
        return JsonResponse(answer.as_json(), 200 if answer.ok else 409)


def _answer(data: dict[str, object]) -> Response:
    return JsonResponse(Answer(True, "", data, "").as_json())
