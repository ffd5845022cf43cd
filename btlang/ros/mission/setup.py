"""What the options of `btc ros-node` settle for all missions of its node."""

from __future__ import annotations

import os
from collections.abc import Sequence

from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import is_below
from btlang.record import Record
from btlang.robots.registry import connector
from btlang.session import Session
from btlang.text.source import Source, Span
from btlang.vocabulary.shipped import DEFAULT_WORLD, ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.recording.recorder import Recorder

_NOT_ALLOWED = "other programs can't use it; to allow it, start the node with --allow-keywords and its name or folder"


class Setup(Record):
    """`robot` and `over` are as for Session; `file` is the mission that the node runs when activated, "" for none.

    What other programs send may include only files below `include_root`, and use only the keyword files of
    `allowed_keywords`: names of packs, and folders. `record` is the folder for recordings of missions, if there is one.
    """

    name: str = "btlang"
    robot: str = "simulated"
    over: str | None = None
    sim_time: bool = False
    namespace: str = ""
    speed: float | str = "real"
    file: str = ""
    keywords: Sequence[str] = ()
    world: str | None = None
    parser: str = "shunting-yard"
    include_root: str | None = None
    allowed_keywords: Sequence[str] = ()
    language: str = ENGLISH
    record: str | None = None

    def session(self) -> Session:
        """The robot in its world. Raises MissionError."""
        named = {"sim_time": self.sim_time, "namespace": self.namespace, "name": f"{self.name}_robot"}
        return Session(connector(self.robot, self.over, **named), world=self.world)

    def sent(self, text: str) -> Source:
        """A mission that another program sent."""
        root = self.include_root
        return Source(text, "mission", root or "", () if root is None else (root,), hides_includes=True)

    def check_keywords(self, names: Sequence[str]) -> None:
        """Raises MissionError (BT001) where another program may not use one of these keyword files."""
        for name in names:
            if name not in self.allowed_keywords and not self._is_in_allowed_folder(name):
                where = Span(Source("", "keywords"), 0, 0)
                raise MissionError([diagnostic("BT001", where, file=name, reason=_NOT_ALLOWED)])

    def _is_in_allowed_folder(self, name: str) -> bool:
        if "\0" in name or not os.path.isfile(name):
            return False
        folders = [name for name in self.allowed_keywords if os.path.isdir(name)]
        return any(is_below(os.path.realpath(name), folder) for folder in folders)

    def recorder(self, mission: Mission, keywords: Sequence[str] = ()) -> Recorder | None:
        """What records a mission, None where nothing is to be recorded. Raises MissionError (BT009, BT083)."""
        if self.record is None:
            return None
        from btlang.recording.recorder import recorder_in

        about = {"robot": self.robot, "over": self.over or "", "language": self.language, "speed": str(self.speed)}
        return recorder_in(self.record, mission, [*self.keywords, *keywords], about)

    def compiled(self, source: Source, keywords: Sequence[str] = ()) -> Mission:
        """A mission, with further keyword files. Raises MissionError."""
        known, world = [*self.keywords, *keywords], self.world or DEFAULT_WORLD  # the robot's, not that of the text
        return parse_tree(source, parser=self.parser, keywords=known, world=world, language=self.language)
