"""The files that a recording keeps, so that its mission can be read again elsewhere, and its mission read from them."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress

from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.symbols.needs import WORDS as NEEDED_WORDS
from btlang.house_rules import no_house_rules, read_house_rules
from btlang.text.source import Source
from btlang.tree.ast import Include, Program
from btlang.tree.node import Node
from btlang.tree.visit import fold
from btlang.vocabulary.load import keyword_path

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

TREE = "tree.json"
MISSION = "mission.txt"
ROBOT = "robot.toml"
_WORLD, _WORDS, _INCLUDED = "world.toml", "words", "included"
_RULES = "house_rules"
_RULES_TEXT = f"{_RULES}/rules.txt"
_ENDINGS = (".txt", ".toml", ".xml", ".json")


def files_of(mission: Mission, keywords: Sequence[str], robot: str = "") -> dict[str, bytes]:
    """Return the tree, the texts of the mission and of the house rules round it with what they include, its world,
    keyword and robot files, by their names.
    """
    files = {TREE: _encode(str(mission.to("json")))}
    if mission.syntax is not None:
        files |= _texts_of(mission.syntax, MISSION, f"{_INCLUDED}/")
    if mission.rules is not None and mission.rules.syntax is not None:
        files |= _texts_of(mission.rules.syntax, _RULES_TEXT, f"{_RULES}/")
    for number, path in enumerate(path for path in map(keyword_path, keywords) if os.path.isfile(path)):
        files[f"{_WORDS}/{number}/{os.path.basename(path)}"] = _content(path)
    if isinstance(mission.world, Source):
        files[_WORLD] = _encode(mission.world.text)
    elif mission.world is not None and os.path.isfile(mission.world):
        files[_WORLD] = _content(mission.world)
    if robot.endswith(".toml") and os.path.isfile(robot):
        files[ROBOT] = _content(robot)
    return files


def _texts_of(program: Program, name: str, folder: str) -> dict[str, bytes]:
    """Return a text, with what it includes and the keyword files that it names in a folder."""
    source = program.span.source
    files = {name: _encode(source.text)}
    for include in _includes(program):
        files[f"{folder}{include.path}"] = _encode(include.mission.span.source.text)
    for role, path in program.needs:
        if role == NEEDED_WORDS and os.path.isfile(place := os.path.join(source.folder, path)):
            files[f"{folder}{path}"] = _content(place)
    return files


def _encode(text: str) -> bytes:
    """Encode a text; what UTF-8 lacks becomes an escape, as in write_file."""
    return text.encode(errors="backslashreplace")


@contextmanager
def open_mission(
    files: Mapping[str, bytes],
    name: str,
    language: str,
    keywords: Sequence[str] | None = None,
    values: Mapping[str, object] = {},
) -> Iterator[Mission]:
    """Give the mission that a recording keeps, in a folder of its own for as long as it is used; `name` is that in
    messages, `values` are what it was given, or others of the same kinds.

    Where its text can no longer be read as the tree that ran, it is that tree. It is read with the recorded keyword
    files unless there are `keywords`: to run it takes files that the user has named, since these name code to run.
    """
    with tempfile.TemporaryDirectory(prefix="btlang-") as folder:
        found = []
        for known, data in files.items():
            path = os.path.normpath(os.path.join(folder, known.removeprefix(f"{_INCLUDED}/")))
            if not path.startswith(os.path.join(folder, "")) or not path.endswith(_ENDINGS):
                continue  # no file of a recording leaves the folder
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "wb") as file:
                file.write(data)
            if known.startswith(f"{_WORDS}/"):
                found.append(path)
        world = os.path.join(folder, _WORLD) if _WORLD in files else None
        may_load = keywords is None  # what is only looked at may have all its words

        def text(known: str, name: str, place: str) -> Source:
            return Source(files[known].decode("utf-8", "replace"), name, place, (place,), may_load=may_load)

        def read(source: Source, **more: Any) -> Mission:
            return parse_tree(source, keywords=found if keywords is None else keywords, world=world, **more)

        tree = _read_tree(text(TREE, name, folder), read)
        rules, missions = no_house_rules(), [tree]
        with suppress(MissionError):
            if _RULES_TEXT in files:
                read_rules = read(text(_RULES_TEXT, f"{_RULES}.txt", os.path.join(folder, _RULES)), language=language)
                rules = read_house_rules(read_rules)
                missions = [rules.inside(tree)]
        with suppress(MissionError):
            if MISSION in files:
                missions.insert(0, read(text(MISSION, name, folder), language=language, values=values))
        yield next((each for each in map(rules.around, missions) if each.tree == tree.tree), tree)


def _read_tree(source: Source, read: Callable[..., Mission]) -> Mission:
    """Read the tree that ran. Nobody wrote it as it is kept, so its nodes have no places in a text."""
    try:
        mission = read(source)
    except MissionError:
        mission = parse_tree(source)
    without = mission.tree.replace(
        root=_without_places(mission.tree.root),
        subtrees=tuple((name, _without_places(root)) for name, root in mission.tree.subtrees),
    )
    placed: Mission = mission.replace(tree=without)
    return placed


def _without_places(root: Node) -> Node:
    def made(node: Node, children: list[Node]) -> Node:
        return node.replace(children=tuple(children), span=None)  # type: ignore[no-any-return]

    return fold(root, lambda node: node.children, made)


def _includes(program: Program) -> Iterator[Include]:
    pending = [program]
    while pending:
        for include in pending.pop().includes:
            yield include
            pending.append(include.mission)


def _content(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()
