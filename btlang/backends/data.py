"""Trees in other texts than missions: XML of BehaviorTree.CPP and JSON. Which one a text is shows how it begins."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import MissionError
from btlang.text.source import Source, Span
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

    return _chosen(read_json(source), main, source)


def _chosen(tree: Tree, main: str, source: Source) -> Tree:
    """The same trees, of which this one is the main one; where none is asked for, the first. Nothing can use an
    unnamed one, so it is dropped where another is chosen."""
    if main in ("", tree.name):
        return tree
    trees = dict((*([(tree.name, tree.root)] if tree.name else []), *tree.subtrees))
    if main not in trees:
        from btlang.frontends.btcpp.reader import no_tree

        raise MissionError([no_tree(Span(source, 0, 0), main, trees)])
    others = tuple(named for named in trees.items() if named[0] != main)
    chosen: Tree = tree.replace(root=trees[main], subtrees=others, name=main)
    return chosen
