"""Checks of trees that our compiler hasn't made, such as those from XML: all problems, as diagnostics.

Also what a mission may have meant by an unknown id of a node: a word, a known node, or a subtree.
"""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, partial

from btlang.backends.engine import bind_leaf, leaf_binding
from btlang.backends.keywords import Draft, drafts
from btlang.backends.wording import id_words
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic, sort_diagnostics
from btlang.diagnostics.files import read_source
from btlang.engine.faults import UnknownNode, UnknownSubTree, find_faults
from btlang.engine.instance import EngineError
from btlang.engine.leaves.binding import GIVEN
from btlang.engine.leaves.leaf import LeafBinding
from btlang.frontends.mission.explanations.spelling_rule import is_respelling
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Source, Span
from btlang.text.spelling import nearest
from btlang.text.words import split
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.node_words import bare_id, id_of_name, said_id

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Fix = tuple[Span, str]


def tree_problems(
    tree: Tree,
    vocabulary: Lexicon,
    bind: Callable[[str], LeafBinding | None] | None = None,
    services: Mapping[str, Any] = {},
) -> list[Diagnostic]:
    """Report unknown leaves (BT130) and nodes (BT131), subtrees (BT126), and whatever the engine would refuse
    (BT132).

    `bind` and `services` are those of a run, by default what a keyword entry says, without the robot: a `call` that
    cannot be loaded here is no problem then, as it may be there on the robot.
    """
    bind, services = bind or cache(partial(bind_placeholder, vocabulary)), services or {"robot": None}
    found = find_faults(tree, bind, services)
    found.sort(key=_place)  # so that a missing entry is reported at its first use
    is_unknown = any(isinstance(error, UnknownNode) for error in found)
    entries = drafts(tree, vocabulary) if is_unknown else {}
    find_file = cache(find_keyword_file)
    problems = []

    def fits(node: Node) -> bool:
        return not find_faults(Tree(node), bind, services)

    for error in found:
        problems.append(_diagnose(error, tree, vocabulary, entries, fits, find_file))
        entries.pop(error.node.id, None)  # once is enough
    return sort_diagnostics(problems)


def missing_trees(tree: Tree, vocabulary: Lexicon) -> list[Diagnostic]:
    """Report each SubTree node whose tree isn't there (BT126)."""
    known = {name for name, _ in tree.subtrees}
    nodes = [node for node in tree.walk() if node.id == SUBTREE and node.port("ID") not in ("", *known)]
    return sort_diagnostics([_diagnose_missing_tree(node, tree, vocabulary) for node in nodes])


def find_misnamed(tree: Tree, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Find names of places and the like that nothing has (BT132): no phrase could hold them."""
    for node in tree.walk():
        slots = {slot.name: slot.type for entry in vocabulary.entries.get(node.id, ()) for slot in entry.slots}
        for port, text in node.ports:
            kind = vocabulary.types.get(slots.get(port, ""))
            if kind is None or kind.kind != "names" or "{" in text or vocabulary.value(kind.name, text) is not None:
                continue
            names = vocabulary.values.names(kind.name)
            if text in names:  # what nobody says: `eo`, said as `Esperanto`
                continue
            near = nearest(text.lower(), names)
            reason = f"there is no {kind.name} '{text}'" + (f"; similar: {', '.join(near)}" if near else "")
            yield diagnostic("BT132", node.span or NOWHERE, id=node.id, reason=reason)


def _diagnose_missing_tree(node: Node, tree: Tree, vocabulary: Lexicon) -> Diagnostic:
    span, name, names = node.span or NOWHERE, node.port("ID"), [name for name, _ in tree.subtrees]
    said = find_said_id(node, name, vocabulary)
    fix = correct_subtree(said, names, vocabulary) if said is not None else None
    near = _near(nearest(name.lower(), names))
    return _add_help(diagnostic("BT126", span, fix=fix, name=name), near, _advise_definition(name, span))


def _diagnose(
    error: EngineError,
    tree: Tree,
    vocabulary: Lexicon,
    entries: dict[str, Draft | None],
    fits: Callable[[Node], bool],
    find_file: Callable[[Source, str], str],
) -> Diagnostic:
    """Make a diagnostic of an error.

    `fits` says whether a leaf can run, `find_file` which keyword file beside a text has an id.
    """
    node = error.node
    span = node.span or NOWHERE
    if isinstance(error, UnknownSubTree):
        return _diagnose_missing_tree(node, tree, vocabulary)
    missing = node.id not in CATALOGUE and node.id not in vocabulary.entries
    if not isinstance(error, UnknownNode) and not (node.children and missing):
        return diagnostic("BT132", span, id=node.id, reason=error.message)
    if node.children:
        near = nearest(node.id.lower(), [id for id, kind in CATALOGUE.items() if kind.most])
        return diagnostic("BT131", span, id=node.id, help=_near(near))
    ids = [*vocabulary.entries, *(id for id, kind in CATALOGUE.items() if not kind.least)]
    said, fix, names = find_said_id(node, node.id, vocabulary), None, [name for name, _ in tree.subtrees]
    if said is not None and said.may_be_subtree:
        ids, fix = [*names, *ids], correct_subtree(said, names, vocabulary)
    if said is not None and fix is None:
        fix = correct_leaf(said, ids, vocabulary, lambda id: fits(node.replace(id=id)))
    if said is not None and fix is None and said.is_sentence:
        return diagnostic("BT010", span, kind="command", words=span.text, help=_near(nearest(node.id.lower(), ids)))
    problem = diagnostic("BT130", span, fix=fix, id=node.id)
    if file := find_file(span.source, node.id):
        return _add_help(
            problem.replace(fix=None), f"The keyword file {file} has it. Add: --keywords {shlex.quote(file)}"
        )
    advice = "" if fix else _entry(node, entries)
    return _add_help(problem, _near(nearest(node.id.lower(), ids)), advice)


def _add_help(problem: Diagnostic, *advice: str) -> Diagnostic:
    """Add advice of several lines."""
    return problem.advising("\n".join(line for line in advice if line))


def _place(error: EngineError) -> tuple[str, int]:
    span = error.node.span
    return (span.source.name, span.start) if span else ("", 0)


def _advise_definition(name: str, span: Span) -> str:
    if span.text[:1] == "<":
        return 'If it is in another file: <include path="..."/>'
    return f'Define it, at the left margin: "{name}" means: ...'


def _near(names: list[str]) -> str:
    return f"Similar: {', '.join(names)}" if names else ""


def _entry(node: Node, entries: dict[str, Draft | None]) -> str:
    if node.id not in entries:
        return ""
    draft = entries[node.id]
    if draft is None:
        return "A keyword entry can't have this id: an id is one word of letters and digits."
    other = "If a keyword file of yours has it, add: --keywords FILE"
    return f"{other}\nThis entry of a keyword file would define it:\n{draft.text()}"


_MOST_FILES = 200
_SORTS = ("[[action]]", "[[condition]]", "[[quantity]]")


def find_keyword_file(source: Source, id: str) -> str:
    """Return the path of a keyword file with an id that is in the folder of a text that the user named; "" if none."""
    if not source.may_load:
        return ""
    try:
        names = sorted(name for name in os.listdir(source.folder or os.curdir) if name.endswith(".toml"))
    except (OSError, ValueError):
        return ""
    line = re.compile(rf"""^[ \t]*id[ \t]*=[ \t]*["']{re.escape(id)}["']""", re.MULTILINE)
    for name in names[:_MOST_FILES]:
        path = os.path.join(source.folder, name)
        try:
            text = read_source(path).text if os.path.isfile(path) else ""
        except MissionError:
            continue
        if line.search(text) and any(sort in text for sort in _SORTS):
            return path
    return ""


def bind_placeholder(vocabulary: Lexicon, node_id: str) -> LeafBinding | None:
    """Bind a leaf that takes the ports of its `call`, and does nothing."""
    entries = vocabulary.entries.get(node_id, ())
    if not entries:
        return None
    try:
        binding = bind_leaf(node_id, vocabulary)
        assert binding is not None
    except EngineError:
        slots = {slot.name: slot for entry in entries for slot in entry.slots}
        return leaf_binding(entries[0].replace(measures=""), vocabulary, accept_anything, tuple(slots.values()))
    made: LeafBinding = binding.replace(call=_make_placeholder(binding.call), thread=False)
    return made


def accept_anything(**ports: object) -> None:
    """Take every port and do nothing."""


def _make_placeholder(call: Callable[..., Any]) -> Callable[..., Any]:
    """Make a function with the parameters of a leaf: those of a class's `start`, or of a component's method."""
    from inspect import isclass, signature

    def leaf(**ports: object) -> None:
        pass

    try:
        found = signature(call.start if isclass(call) else call)  # type: ignore[attr-defined]
    except (AttributeError, TypeError, ValueError):
        return accept_anything
    parameters = [each for each in found.parameters.values() if each.name not in GIVEN]
    has_self = isclass(call) or next(iter(found.parameters), "") == "self"
    leaf.__signature__ = found.replace(parameters=parameters[has_self:])  # type: ignore[attr-defined]
    return leaf


class SaidId(Record):
    """A place where a mission says the id of a node, in quotes or in words, and whether more is said about the node.

    It `may_be_subtree` behind a bare `do`, and is a `sentence` where these are words of the language alone: `do
    anything`.
    """

    span: Span
    id: str
    in_quotes: bool
    is_last: bool
    may_be_subtree: bool
    is_sentence: bool = False


def find_said_id(node: Node, node_id: str, vocabulary: Lexicon) -> SaidId | None:
    """Find where the words of a node say an id; None if they don't, as in XML."""
    if node.span is None or node.span.text[:1] == "<":
        return None
    text = split(Source(node.span.text), vocabulary.orthography)
    parts = id_words(node_id)
    for at in range(1, len(text.words)):
        in_quotes = text.words[at] == f'"{node_id}' or bare_id(text, at) == node_id
        last = at + 1 if in_quotes else at + len(parts)
        if in_quotes or (at == 1 and text.words[at:last] == parts):
            start = node.span.start
            span = Span(node.span.source, start + text.starts[at], start + text.ends[last - 1])
            may_be_subtree = " ".join(text.words[:at]) in vocabulary.roles["do"]
            is_last, words = span.end == node.span.end, text.words[at:last]
            is_sentence = not in_quotes and is_last and span.text.islower() and _are_correct(words, vocabulary)
            return SaidId(span, node_id, in_quotes, is_last, may_be_subtree, is_sentence)
    return None


def _are_correct(words: Iterable[str], vocabulary: Lexicon) -> bool:
    return correct_words(vocabulary.word_list).issuperset(words)


def correct_leaf(said: SaidId, ids: Iterable[str], vocabulary: Lexicon, fits: Callable[[str], bool]) -> Fix | None:
    """Return the change to the one known id that only a slip keeps apart; None if there is none, or it doesn't fit."""
    near = _near_ids(said.id, ids, vocabulary)
    if len(near) != 1 or not fits(near[0]):
        return None
    words = "" if said.in_quotes else said_id(near[0], "do", vocabulary)
    return said.span, words or f'"{near[0]}"'


def correct_subtree(said: SaidId, names: Iterable[str], vocabulary: Lexicon) -> Fix | None:
    """Return the change to the one subtree that only a slip keeps apart; None if there is none."""
    near = _near_ids(said.id, names, vocabulary)
    if len(near) != 1:
        return None
    [name] = near
    quoted = f'"{name}"'
    if not said.may_be_subtree:  # `do subtree "Tuor"`
        return said.span, quoted
    words = said_id(id_of_name(name), "do", vocabulary)
    if name == name.lower():  # may be a phrase: `do` takes that in words alone
        return (said.span, words) if words and said.is_last else None
    return said.span, quoted if said.in_quotes else words or quoted


def _near_ids(written: str, known: Iterable[str], vocabulary: Lexicon) -> list[str]:
    words = " ".join(id_words(written))
    return [name for name in known if is_respelling(words, " ".join(id_words(name)), vocabulary)]
