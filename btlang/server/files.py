"""The file that `btc edit` opens, and those that it includes: read, and saved without losing what others wrote."""

from __future__ import annotations

import errno
import os
from codecs import BOM_UTF8
from hashlib import sha256

from btlang.backends.files import write_file
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import MOST_DEEP, read_included, read_source, unwritable
from btlang.editing.words import Words
from btlang.frontends.mission.symbols.includes import find_includes
from btlang.server.access import AccessError
from btlang.server.checking import MOST_CHARACTERS
from btlang.task.answers import differences
from btlang.task.checks import refused
from btlang.task.messages import Answer
from btlang.testing.names import ENDING, is_test_file
from btlang.text.source import Source, Span
from btlang.text.words import split

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Files:
    """Of these the one that `words` belong to can be saved, and the file of its tests beside it; the others, which it
    includes, are shown.

    A revision is a hash of the content, "" for a file that isn't there. Methods raise MissionError for one that can't
    be read (BT001, BT002) or written (BT009), and AccessError (403, 404).
    """

    def __init__(self, words: Words) -> None:
        self.path, self.name = words.file, os.path.basename(words.file)
        self._words = words
        stem = self.path.removesuffix(".txt")
        self._tests = "" if is_test_file(self.path) else stem + ENDING

    def listed(self) -> list[dict[str, Any]]:
        """All, the one that was opened first, and its tests last."""
        saved = self._saved()
        names = [self.name, *(name for name in self._included() if name not in saved), *list(saved)[1:]]
        return [{"name": name, "saves": name in saved} for name in names]

    def read(self, name: str) -> dict[str, Any]:
        """The `text` of a file and its `revision`."""
        if (path := self._saved().get(name)) is not None:
            return _content(_text(path))
        included = self._included()
        if name not in included:
            raise AccessError(404, "That file isn't open here.")
        return _content(included[name].text)

    def save(self, name: str, text: str, revision: str) -> Answer:
        """Writes a text that was made from a revision; where the file has another one by now, it is refused with the
        difference. Line ends stay those of the file.
        """
        path = self._saved().get(name)
        if path is None:
            raise AccessError(403, "Only the file that was opened can be saved, and its tests.")
        before = _text(path)
        text = text if before is None else _with_line_ends(text, before)
        if revision != _revision(before):
            problem = refused(f"The file '{name}'", "was changed by another program, or in another window")
            data = {**_content(before), "diff": differences(before or "", text)}
            return Answer(False, str(problem), data, problem.diagnostics[0].code)
        write_file(path, (BOM_UTF8 if before is not None and _has_mark(path) else b"") + text.encode())
        return Answer(True, f"Saved {name}.", {"revision": _revision(text)}, "")

    def _saved(self) -> dict[str, str]:
        """The paths of those that can be saved, by their names."""
        return {os.path.basename(path): path for path in (self.path, self._tests) if path}

    def _included(self) -> dict[str, Source]:
        """By their names as seen from the folder of the file; those that can't be read are left out."""
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


def _text(path: str) -> str | None:
    """That of the file, None if it isn't there. Its folder must be there, and it must be no other sort of file."""
    source = Source("", path)
    if not os.path.lexists(path):
        folder = os.path.dirname(path) or os.curdir
        if not os.path.isdir(folder):
            raise MissionError([unwritable(path, f"there's no folder {folder}")])
        return None
    if os.path.exists(path) and not os.path.isfile(path):
        reason = os.strerror(errno.EISDIR).lower() if os.path.isdir(path) else "it isn't a regular file"
        raise _unreadable(source, reason)
    text = read_source(path).text
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
    """A page has line feeds alone."""
    return text.replace("\n", "\r\n") if "\r\n" in before and "\r" not in text else text


def _has_mark(path: str) -> bool:
    with open(path, "rb") as file:
        return file.read(len(BOM_UTF8)) == BOM_UTF8
