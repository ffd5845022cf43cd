"""The words that a text is read with, as plain data that may be sent to another process."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.mission_vocabulary import mission_vocabulary, world_vocabulary
from btlang.text.formatting import one_line
from btlang.text.source import Source
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.passes.compilation import Origins


class RobotWords:
    """The words of a robot: keyword files, world and language. The world is a file, or the text of one.

    `file` is the path that texts belong to, if the user named one: what they name is looked for beside it.
    """

    def __init__(
        self,
        keywords: Sequence[str] = (),
        world: str | None = None,
        language: str = "en",
        world_text: str = "",
        file: str = "",
    ) -> None:
        self.keywords, self.language, self.file = keywords, language, file
        self.world = Source(world_text, "world", roots=()) if world_text else world

    def in_world(self, name: str, text: str) -> RobotWords:
        """Return these words with the places of a world in a text; `name` is what messages show."""
        other = RobotWords(self.keywords, language=self.language, file=self.file)
        other.world = Source(text, one_line(name), roots=())
        return other

    def for_file(self, path: str) -> RobotWords:
        """Return these words for the texts of another file; "" for texts of none."""
        other = RobotWords(self.keywords, language=self.language, file=path)
        other.world = self.world
        return other

    def source(self, text: str) -> Source:
        """Return a text that somebody writes; of no file, it can't include any."""
        return Source(text, self.file, may_load=True) if self.file else Source(text, "mission", roots=())

    def mission(
        self, source: Source, origins: Origins | None = None, main: str = "", world: str | None = None
    ) -> Mission:
        """Return a text compiled with them, or with another world; the others as for `parse_tree`.

        Raises MissionError.
        """
        return parse_tree(
            source, keywords=self.keywords, world=self.world if world is None else world, language=self.language,
            origins=origins, main=main,
        )  # fmt: skip

    def vocabulary(self, source: Source) -> Lexicon:
        """Return the vocabulary that a text is read with; files that it names and that can't be used are left out.

        Raises MissionError for words that can't be used themselves.
        """
        try:
            return mission_vocabulary(source, self.keywords, self.world, self.language)[0]
        except MissionError:
            return world_vocabulary(self.keywords, self.world, self.language)
