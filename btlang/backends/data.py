"""Trees in other texts than missions: XML of BehaviorTree.CPP and JSON. Which one a text is shows how it begins."""

from __future__ import annotations

from btlang.text.source import Source
from btlang.tree.node import Tree


def data_mark(source: Source) -> str:
    """`<` for XML, `{` for JSON, "" for a mission, which begins with neither: `{counter} is 3` is no JSON."""
    begin = source.text.lstrip("\ufeff \t\r\n")
    is_json = begin[:1] == "{" and begin[1:].lstrip()[:1] in ('"', "}")
    return begin[:1] if begin[:1] == "<" or is_json else ""


def read_tree(source: Source, main: str) -> Tree:
    """The tree in such a text; `main` is the ID of one of several. Raises MissionError."""
    if data_mark(source) == "<":
        from btlang.frontends.btcpp.reader import read_xml

        return read_xml(source, main)
    from btlang.backends.json_tree import read_json

    return read_json(source)
