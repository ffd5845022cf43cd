"""Edits of texts, for tests."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.changes import Change, apply_changes
from btlang.editing.edits import Edit, Edited, edit, read_edit
from btlang.editing.syntax import Syntax
from btlang.editing.words import RobotWords
from btlang.text.source import Source
from btlang.tree import ast


def edit_sample(text: str) -> int:
    """Does the edit that the first line of a text has as JSON; prints what is wrong and returns the exit code, as
    `btc` does.
    """
    first, _, mission = text.partition("\n")
    try:
        edit(Source(mission), RobotWords(), read_edit(json.loads(first.removeprefix("# edit "))))
    except MissionError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def number(text: str, words: str, nth: int = 0) -> int:
    """The number of the node that is said by these words, which may stand there several times."""
    syntax = _syntax(text)
    _, sources = syntax.lowered()
    starts = [node.span.start if node is not None else -1 for node in sources]
    said = ["" if node is None else node.span.text.lower() for node in sources]
    found = sorted({starts[i]: i for i in reversed(range(len(said))) if said[i] == words.lower()}.items())
    return found[nth][1]


def edited(text: str, do: str, words: str, *, last: str = "", to: str = "", nth: int = 0, **more: str) -> Edited:
    """An edit of the node that is said by some words; what else is wanted is said by words, too."""
    numbers = {key: number(text, value) for key, value in (("last", last), ("to", to)) if value}
    with_words = more.pop("given", "")
    wanted = Edit(do, number(text, words, nth), **numbers, **more, words=with_words)  # type: ignore[arg-type]
    made = edit(Source(text), RobotWords(), wanted)
    [change] = (Change(**each) for each in made["changes"])
    return Edited(apply_changes(text, [change]), change, made["start"], made["end"])


def statements(text: str) -> Sequence[ast.Ast]:
    """The statements and definitions of a mission, each with its place."""
    mission = _syntax(text).mission
    body = mission.body
    is_chain = isinstance(body, ast.Chain) and body.operator == "sequence"
    return [*mission.definitions, *(ast.parts(body) if body is not None and is_chain else [body] if body else [])]


def _syntax(text: str) -> Syntax:
    mission = parse_tree(text)
    assert mission.syntax is not None
    return Syntax(mission.syntax, mission.vocabulary)
