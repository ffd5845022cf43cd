"""The reader of the missions of tasks."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import lru_cache

from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import is_below, read_source
from btlang.engine.leaves.leaf import describe_exception
from btlang.task.store.records import MissionText
from btlang.text.formatting import one_line
from btlang.text.source import Source, Span
from btlang.vocabulary.shipped import DEFAULT_WORLD, ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_REMEMBERED = 64  # missions that were read last
_NOT_ALLOWED = "others can't use it; to allow it, start the robot with --allow-keywords and its name or folder"


class MissionReader:
    """A reader of missions for one robot.

    Its words are those of the keyword files `keywords`, its names those of `world`, a world file or its text.

    A text may include files below `include_root`, and bring keyword files of `allowed_keywords` (names of packs, and
    folders); by default none, since the author of a text may not read these files, and keyword files run Python.
    """

    def __init__(
        self,
        keywords: Sequence[str] = (),
        world: str | Source | None = None,
        *,
        parser: str = "shunting-yard",
        language: str = ENGLISH,
        include_root: str | None = None,
        allowed_keywords: Sequence[str] = (),
    ) -> None:
        self.keywords, self.world, self.language = tuple(keywords), world, language
        self._parser, self._root, self._allowed = parser, include_root, tuple(allowed_keywords)
        self._remembered = lru_cache(_REMEMBERED)(self._read)

    @property
    def words(self) -> dict[str, Any]:
        """The places of its words and its world, for another process on this computer."""
        files = [os.path.abspath(name) if os.path.exists(name) else name for name in self.keywords]
        words: dict[str, Any] = {"keywords": files, "language": self.language}
        if isinstance(self.world, Source):
            return {**words, "world_text": self.world.text}
        return {**words, "world": os.path.abspath(self.world or DEFAULT_WORLD)}

    def read(self, mission: MissionText) -> Mission:
        """Read a mission. Raises MissionError. Fast for a text that was read a moment ago."""
        values = tuple((name, isinstance(value, str)) for name, value in mission.values.items())
        may_change = mission.file or self._root is not None  # what it includes
        read = self._read if may_change else self._remembered
        return read(mission.text, mission.name, mission.file, mission.keywords, values)

    def check(self, keywords: Sequence[str]) -> None:
        """Raise MissionError (BT001) if a text may not bring one of these keyword files."""
        for name in keywords:
            if name not in self._allowed and not self._is_in_allowed_folder(name):
                where = Span(Source("", "keywords"), 0, 0)
                raise MissionError([diagnostic("BT001", where, file=name, reason=_NOT_ALLOWED)])

    def source(self, text: str, name: str = "") -> Source:
        """Make the source of a text that others sent."""
        root, shown = self._root, one_line(name) or "mission"
        return Source(text, shown, root or "", () if root is None else (root,), hides_includes=True)

    def _read(
        self, text: str, name: str, file: str, keywords: tuple[str, ...], values: tuple[tuple[str, bool], ...]
    ) -> Mission:
        source = read_source(file, self._root) if file else self.source(text, name)
        try:
            return parse_tree(
                source,
                keywords=[*self.keywords, *keywords],
                world=self.world or DEFAULT_WORLD,  # the robot's, not that of the text
                parser=self._parser,
                language=self.language,
                values={each: "" if is_text else 0 for each, is_text in values},
            )
        except (SystemExit, RecursionError) as problem:  # of a keyword file, which may be anybody's
            where = Span(source, 0, 0)
            raise MissionError(
                [diagnostic("BT001", where, file=source.name, reason=describe_exception(problem))]
            ) from None

    def _is_in_allowed_folder(self, name: str) -> bool:
        if "\0" in name or not os.path.isfile(name):
            return False
        folders = [name for name in self._allowed if os.path.isdir(name)]
        return any(is_below(os.path.realpath(name), folder) for folder in folders)
