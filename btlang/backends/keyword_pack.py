"""Keyword packs for the nodes of other programs, which are loaded and read back before they are returned.

A file with models may stand for the pack that is made of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from btlang.backends.keywords import Draft, Leaf, draft_entries, is_unknown, keyword_text, why_none
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.files import read_files
from btlang.frontends.mission.reader import PARSERS, read_mission
from btlang.passes import lower_mission
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Source, Span
from btlang.tree.node import Node, NodeModel
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.keyword_file import KeywordFile, read_keyword_file
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.value_type import ValueType, with_unit

_LEAVES = ("Action", "Condition", "")
_HEAD = "# Words for nodes of other programs, made of their ids by btc words. Change the phrases to what people say."


class KeywordPack(Record):
    """The text of a keyword file; `warnings` name the nodes that it has no words for."""

    text: str
    warnings: tuple[Diagnostic, ...]


def pack_of_files(
    sources: Sequence[Source], vocabulary: Lexicon, load: Callable[[Source], Lexicon]
) -> tuple[KeywordPack, KeywordFile]:
    """Make a pack for the unknown nodes in XML files and those that they include, as `keyword_pack` does.

    Return it with what it declares, at the nodes' tags.

    The warnings are those of the files, too. Raises MissionError (BT120 to BT129).
    """
    read = read_files(sources, follows_includes=True)
    places = read.places()
    models = [*read.known_models(), *read.models.values()]  # what the files themselves describe counts, even if bare
    pack = keyword_pack(leaves_of(models, read.nodes(), vocabulary), vocabulary, load, places)
    declared = read_keyword_file(Source(pack.text, sources[0].name))
    entries = tuple(entry.replace(span=places[entry.id]) for entry in declared.entries)
    return pack.replace(warnings=(*read.warnings, *pack.warnings)), declared.replace(entries=entries)


def vocabulary_of_models(
    paths: Sequence[str], vocabulary: Lexicon, load: Callable[[Source | KeywordFile], Lexicon]
) -> Lexicon:
    """Return a vocabulary with the words of XML files; `load` is that of `keyword_pack`.

    Raises MissionError (BT001, BT002, BT120 to BT129).
    """
    return load(pack_of_files([read_source(path) for path in paths], vocabulary, load)[1])


def leaves_of(models: Iterable[NodeModel], nodes: Iterable[Node], vocabulary: Lexicon) -> list[Leaf]:
    """List the leaves that the vocabulary doesn't know, those with models first."""
    uses: dict[str, list[Node]] = {}
    for node in nodes:
        if not node.children:
            uses.setdefault(node.id, []).append(node)
    described = {model.id: model for model in models}
    by_id = {id: described.get(id) or NodeModel("", id) for id in (*described, *uses)}
    return [
        Leaf(model, tuple(uses.get(id, ())))
        for id, model in by_id.items()
        if model.kind in _LEAVES and is_unknown(id, vocabulary)
    ]


def keyword_pack(
    leaves: Sequence[Leaf],
    vocabulary: Lexicon,
    load: Callable[[Source], Lexicon],
    places: Mapping[str, Span] = {},
) -> KeywordPack:
    """Make words for these leaves. `load` makes the vocabulary with a keyword file, as a mission with the pack has it;
    `places` are those of ids in the files.

    A phrase that either parser reads as anything else gives way to the next one. A leaf without any is left out, with
    the warning BT240.
    """
    refused: dict[str, list[str]] = {}
    while True:
        found = draft_entries(leaves, vocabulary, refused)
        text = keyword_text((_HEAD,), found, module="")
        misread = list(_misread(found, load(Source(text, "<words>"))))
        if not misread:
            break
        for entry in misread:
            refused.setdefault(entry.id, []).append(entry.phrases[0])
    without = [id for id, draft in found.items() if draft is None]
    warnings = (diagnostic("BT240", places.get(id, NOWHERE), id=id, reason=why_none(id)) for id in without)
    return KeywordPack(text, tuple(warnings))


def _misread(found: Mapping[str, Draft | None], words: Lexicon) -> Iterator[Entry]:
    """Yield the entries with a phrase that isn't read as its node; all are tried at once, as hardly ever one is."""
    entries = [draft.entry for draft in found.values() if draft is not None]
    if _reads(entries, words):
        return
    yield from (entry for entry in entries if not _reads([entry], words))


def _reads(entries: Sequence[Entry], words: Lexicon) -> bool:
    """Whether the shortest and the longest form of each phrase are read as its node, in both parsers."""
    said, meant = list[str](), list[Node]()
    for entry in entries:
        types = {slot.name: words.types[slot.type] for slot in entry.slots}
        ways = forms(entry.phrases[0])
        for form in dict.fromkeys((ways[-1], ways[0])):
            parts = {part.name: _sample(types[part.name]) for part in form if isinstance(part, Slot)}
            line = " ".join(parts[part.name][0] if isinstance(part, Slot) else part for part in form)
            said.append(line if entry.sort == "action" else f"{words.word('check')} {line}")
            meant.append(Node(entry.id, ports=tuple((name, text) for name, (_, text) in sorted(parts.items()))))
    source = Source("".join(f"{line}\n" for line in said))
    try:
        trees = [lower_mission(read_mission(source, words, parser).mission, words) for parser in PARSERS]
    except MissionError:
        return False
    return all([_bare(node) for node in tree.walk() if not node.children] == meant for tree in trees)


def _bare(node: Node) -> Node:
    return Node(node.id, ports=tuple(sorted(node.ports)), name=node.name)


def _sample(type: ValueType) -> tuple[str, str]:
    """Return a value as it is said, and the text of its port."""
    if type.kind == "text":
        return '"two words"', "two words"
    if type.kind == "names" and type.names:
        return type.names[0], type.names[0]
    return (with_unit("7", type.units[0].words[0]) if type.units else "7"), "7"
