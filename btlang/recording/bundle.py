"""The files that a recording keeps, so that its mission can be read again elsewhere, and its mission read from them."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from btlang.api import Mission, parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.text.source import Source
from btlang.tree.ast import Include

TREE = "tree.json"
MISSION = "mission.txt"
ROBOT = "robot.toml"
_WORLD, _WORDS, _INCLUDED = "world.toml", "words", "included"
_ENDINGS = (".txt", ".toml", ".xml", ".json")


def files_of(mission: Mission, keywords: Sequence[str], robot: str = "") -> dict[str, bytes]:
    """Return the tree, the text of the mission with what it includes, its world, keyword and robot files, by their
    names.
    """
    files = {TREE: _encode(str(mission.to("json")))}
    if mission.syntax is not None:
        files[MISSION] = _encode(mission.syntax.span.source.text)
    for include in _includes(mission):
        files[f"{_INCLUDED}/{include.path}"] = _encode(include.mission.span.source.text)
    for number, path in enumerate(path for path in keywords if os.path.isfile(path)):
        files[f"{_WORDS}/{number}/{os.path.basename(path)}"] = _content(path)
    if isinstance(mission.world, Source):
        files[_WORLD] = _encode(mission.world.text)
    elif mission.world is not None and os.path.isfile(mission.world):
        files[_WORLD] = _content(mission.world)
    if robot.endswith(".toml") and os.path.isfile(robot):
        files[ROBOT] = _content(robot)
    return files


def _encode(text: str) -> bytes:
    """Encode a text; what UTF-8 lacks becomes an escape, as in write_file."""
    return text.encode(errors="backslashreplace")


@contextmanager
def open_mission(
    files: Mapping[str, bytes], name: str, language: str, keywords: Sequence[str] | None = None
) -> Iterator[Mission]:
    """Give the mission that a recording keeps, in a folder of its own for as long as it is used; `name` is that in
    messages.

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
        yield _read(files, name, folder, found if keywords is None else keywords, world, language)


def _read(
    files: Mapping[str, bytes], name: str, folder: str, keywords: Sequence[str], world: str | None, language: str
) -> Mission:
    tree = parse_tree(files[TREE].decode("utf-8", "replace"), world=world)
    if MISSION not in files:
        return tree
    source = Source(files[MISSION].decode("utf-8", "replace"), name, folder, (folder,))
    try:
        mission = parse_tree(source, keywords=keywords, world=world, language=language)
    except MissionError:
        return tree
    return mission if mission.tree == tree.tree else tree


def _includes(mission: Mission) -> Iterator[Include]:
    pending = [mission.syntax] if mission.syntax is not None else []
    while pending:
        for include in pending.pop().includes:
            yield include
            pending.append(include.mission)


def _content(path: str) -> bytes:
    with open(path, "rb") as file:
        return file.read()
