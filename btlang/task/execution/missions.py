"""Missions of tasks: reading them, and the house rules that hold during and between them."""

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
from btlang.text.source import NOWHERE, Source, Span
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
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


_PREFIX = "house "
"""The prefix of names that the rules define, in the tree of a mission, which may define the same ones."""
_ROLES = ("whenever", "reaction", "work")
_EXAMPLE = "whenever the battery is below 20%, go to the dock then charge to 80%"


class HouseRules:
    """The rules of a robot, the first one the most important. Made by `read_house_rules` or `no_house_rules`."""

    def __init__(self, mission: Mission | None) -> None:
        self._mission = mission
        self._rules: list[Node] = []
        node = None if mission is None else mission.tree.root
        while node is not None and _is_rule(node):
            self._rules.append(node)
            node = node.children[2]

    @property
    def idle(self) -> Mission | None:
        """The rules alone, a mission that goes on for ever; None if there are none."""
        return self._mission

    def around(self, mission: Mission) -> Mission:
        """Return the same mission under the rules: a rule suspends it as any rule does, and then it goes on."""
        if self._mission is None:
            return mission
        root = mission.tree.root
        for rule in reversed(self._rules):
            condition, reaction, _ = rule.children
            root = rule.replace(children=(_rename(condition), _rename(reaction), root))
        own = tuple((_PREFIX + name, _rename(body)) for name, body in self._mission.tree.subtrees)
        around: Mission = mission.replace(
            tree=Tree(root, (*own, *mission.tree.subtrees)), facts=(*self._mission.facts, *mission.facts)
        )
        return around

    @property
    def reactions(self) -> list[str]:
        """The paths of what the rules do, in the tree of a mission under them."""
        return ["/" + "2/" * depth + "1" for depth in range(len(self._rules))]

    def is_own(self, path: str) -> bool:
        """Return whether a node at this path belongs to a rule and not to the mission."""
        return not path.startswith("/" + "2/" * (len(self._rules) - 1) + "2") if self._rules else False


def no_house_rules() -> HouseRules:
    """Return the rules of a robot that has none."""
    return HouseRules(None)


def read_house_rules(mission: Mission) -> HouseRules:
    """Read the rules in a mission. Raises MissionError (BT188) if there is anything but rules in it."""
    node = mission.tree.root
    while _is_rule(node):
        node = node.children[2]
    if node is mission.tree.root or not _watches_on(node):
        raise MissionError([diagnostic("BT188", node.span or NOWHERE, example=_EXAMPLE)])
    return HouseRules(mission)


def _is_rule(node: Node) -> bool:
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.roles == _ROLES


def _watches_on(node: Node) -> bool:
    """Return whether it is what lowering puts where rules stand alone: it goes on for ever, and does nothing."""
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.endless and not node.children[0].children


def _rename(root: Node) -> Node:
    """Return a tree with the names of the rules for subtrees."""

    def renamed(node: Node, children: list[Node]) -> Node:
        own = {"ID": _PREFIX + node.port("ID")} if node.id == SUBTREE else {}
        ports = tuple((port, own.get(port, text)) for port, text in node.ports)
        return node.replace(children=tuple(children), ports=ports)  # type: ignore[no-any-return]

    return fold(root, lambda node: node.children, renamed)
