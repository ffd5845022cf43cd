"""The words of a vocabulary as lines to read: the list of `btc words`, and help on one phrase, word or topic."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence

from btlang.text.formatting import joined
from btlang.text.source import Source
from btlang.text.spelling import nearest
from btlang.text.words import split
from btlang.vocabulary.entry import UNMARKED
from btlang.vocabulary.items import Item, items
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Form, forms
from btlang.vocabulary.trie import longest

_WIDTH = 80  # columns, of a text that is for no terminal
_FEW = 3  # if so few are found, all about them is shown
_KEY = (
    "[...] is optional, {{...}} takes a value (see the end), a/b is a choice,",
    "time(s) is time or times. A condition isn't a command: it needs a word such as",
    "'{if}' or '{until}'.",
)


def overview(vocabulary: Lexicon, width: int = _WIDTH, command: str = "btc words") -> list[str]:
    """The topics, each with the number of things to say and the first of them; `command` is what lists more."""
    known = items(vocabulary)
    lines = ["What you can say, by topic:"]
    for topic in dict.fromkeys(item.topic for item in known):
        ways = [item.ways[0] for item in known if item.topic == topic]
        brief = textwrap.shorten(", ".join(ways), width - 20, placeholder=" ...")
        lines.append(f"  {topic:<13} {len(ways):>2}  {brief}")
    more = (
        f"{command} {known[0].topic} lists a topic, {command} battery finds a word, {command} --all lists everything."
    )
    return [*lines, *_wrapped(more, "", "", width)]


def listing(vocabulary: Lexicon, search: str = "", width: int = _WIDTH) -> list[str]:
    """Everything that can be said, by topic, each with what it does and an example.

    With `search` only the topic or sort of that name ("conditions"), else what is said with all of its words, else
    what is explained with them. A few finds are shown in full; if nothing is found, similar words are listed.
    """
    known = items(vocabulary)
    if not search.strip():
        examples = {role: vocabulary.word(role) for role in ("if", "until")}
        key = [part for line in _KEY for part in _wrapped(line.format(**examples), "", "  ", width)]
        return [*key, "", *_by_topic(known, width)]
    found = _found(known, search)
    whole = len(found) <= _FEW and not any(_is_called(item, search) for item in found)
    return _by_topic(found, width, whole) or _unknown(known, search)


def help_on(vocabulary: Lexicon, text: str = "", width: int = _WIDTH) -> list[str]:
    """Help on a topic, a phrase (with or without values), a node id, a word of the language or a type of values.

    Of a phrase or word: all ways to say it, what it does, its slots, what it needs of the robot, and an example.
    For what is not known the nearest words.
    """
    known = items(vocabulary)
    wanted = text.strip().strip("{}")
    if any(_is_called(item, wanted) for item in known):
        return _by_topic((item for item in known if _is_called(item, wanted)), width)
    found = _said_so(known, wanted, vocabulary) or _found(known, wanted) or _begun_so(known, wanted, vocabulary)
    return [line for item in found for line in ("", *_whole(item, width))][1:] or _unknown(known, wanted)


def phrases_with(vocabulary: Lexicon, text: str, most: int = 8) -> list[dict[str, str]]:
    """The phrases that begin with a word of a text, each with an example; else some that anybody can begin with."""
    spoken = set(split(Source(text), vocabulary.orthography).distinct)
    known = [item for item in items(vocabulary) if item.sort in ("command", "condition") and item.example]
    fitting = [item for item in known if any(set(way.split()[0].lower().split("/")) & spoken for way in item.ways)]
    chosen = fitting or [item for item in known if item.sort == "command"]
    return [{"phrase": item.ways[0], "example": item.example} for item in chosen[:most]]


def _is_called(item: Item, search: str) -> bool:
    """Whether the search is its topic or sort, as "conditions"."""
    return search.lower() in (item.topic, item.sort, item.sort + "s")


def _found(known: Sequence[Item], search: str) -> list[Item]:
    called = [item for item in known if _is_called(item, search)]
    wanted = search.lower().replace("/", " ").split()
    return (
        called
        or [_only(item, wanted) for item in known if _says(item, wanted)]
        or [item for item in known if _has(item.words(), wanted)]
        or [item for item in known if _has(item.all_words(), wanted)]
    )


def _has(words: Iterable[str], wanted: Sequence[str]) -> bool:
    """Whether each wanted word is the start of one of the words."""
    return all(any(word.startswith(start) for word in words) for start in wanted)


def _says(item: Item, wanted: Sequence[str]) -> bool:
    """Whether it is said with all wanted words. A word of the language has so many ways that it takes whole words."""
    if item.sort == "word":
        return item.said_words().issuperset(wanted)
    return _has(item.words(), wanted)


def _only(item: Item, wanted: Sequence[str]) -> Item:
    """Return a word of the language with its first way and those that have the wanted words, if any."""
    if item.sort != "word":
        return item
    first, *others = item.ways
    ways = tuple(way for way in others if item.replace(ways=(way,), names=()).said_words().issuperset(wanted))
    return item.replace(ways=(first, *ways)) if ways else item


def _said_so(known: Sequence[Item], text: str, vocabulary: Lexicon) -> list[Item]:
    """What is said with exactly these words, whatever stands in its slots."""
    words = split(Source(text), vocabulary.orthography)
    bare = tuple(words.words[: len(words.words) - 2])
    found = [item for item in known if text.lower() in map(str.lower, item.names)]
    found += [item for item in known if item not in found and bare in _spoken(item, vocabulary.articles)]
    if found:
        return found
    match = longest(vocabulary.trie, words, 0, vocabulary.context)
    return _begun_so(known, text, vocabulary) if match is not None and match.last >= len(bare) else []


def _begun_so(known: Sequence[Item], text: str, vocabulary: Lexicon) -> list[Item]:
    """The phrase that the text begins with."""
    match = longest(vocabulary.trie, split(Source(text), vocabulary.orthography), 0, vocabulary.context)
    if match is None:
        return []
    name = match.meaning.entry.id if match.meaning.entry else match.meaning.role
    return [item for item in known if name in item.names and item.sort != "value"]


def _spoken(item: Item, articles: frozenset[str]) -> set[Form]:
    """The words of each way to say it, without slots."""
    if item.sort == "value":
        return {(word,) for word in item.words()}
    ways = (form for way in item.ways for form in forms(way, articles))
    return {tuple(part for part in form if isinstance(part, str)) for form in ways}


def _by_topic(chosen: Iterable[Item], width: int, whole: bool = False) -> list[str]:
    lines: list[str] = []
    topic = ""
    for first, *others in _by_verb(chosen):
        if first.topic != topic:
            topic = first.topic
            lines += ["", f"{topic}:"] if lines else [f"{topic}:"]
        if whole and first.sort != "value":
            lines += ["  " + line for item in (first, *others) for line in _whole(item, width - 2)]
        elif others:
            lines += _verb(first, others, width)
        else:
            lines += _brief(first, width)
    return lines


def _by_verb(chosen: Iterable[Item]) -> list[list[Item]]:
    """The items, those of one verb in a topic together."""
    groups: dict[tuple[str, str], list[Item]] = {}
    for number, item in enumerate(chosen):
        groups.setdefault((item.topic, item.verb or str(number)), []).append(item)
    return list(groups.values())


def _verb(first: Item, others: Sequence[Item], width: int) -> list[str]:
    """A verb once, with its roles: `go to {place}, {person} or {door} [through {via}]`; then what it does with each."""
    items = (first, *others)
    lines = _wrapped(f"{first.verb} {_roles(items)}", "  ", "    ", width)
    for item in items:
        said = item.ways[0].removeprefix(f"{item.verb} ")
        lines += _wrapped(f"{said}: {item.help}", "      ", "        ", width)
        lines += _wrapped(f"For example: {item.example}", "        ", "        ", width)
    return lines


def _roles(items: Sequence[Item]) -> str:
    """The roles of all the items in their order, each once."""
    said: dict[str, list[str]] = {}
    for item in items:
        for role in item.roles:
            word = "" if role.name in UNMARKED or not role.words else f"{' '.join(role.words[0])} "
            said.setdefault(role.name, []).append(f"{word}{{{role.slot}}}")
    needed = {
        name for name in said if all(any(role.name == name and role.is_needed for role in item.roles) for item in items)
    }
    return " ".join(
        either if name in needed else f"[{either}]"
        for name, ways in said.items()
        for either in [joined([*dict.fromkeys(ways)], "or")]
    )


def _brief(item: Item, width: int) -> list[str]:
    if item.sort == "value":
        return _wrapped(item.help, f"  {item.ways[0]:<11} ", " " * 14, width)
    ways = item.ways if item.sort == "word" else item.ways[:1]
    mark = "  (condition)" if item.sort == "condition" else ""
    lines = _wrapped(", ".join(ways), "  ", "    ", width)
    lines[-1] += mark
    block = _block(item.example, 8) if "\n" in item.example else []
    example = f"For example: {item.example}" if item.example not in ("", item.ways[0]) and not block else ""
    texts = [text for text in (item.help, example) if text]
    if len(" ".join(texts)) <= width - 6:
        texts = [" ".join(texts)] if texts else []
    lines += [line for text in texts for line in _wrapped(text, "      ", "      ", width)]
    return [*lines, *(["      For example:", *block] if block else [])]


def _whole(item: Item, width: int) -> list[str]:
    if item.sort == "value":
        return _brief(item, width)
    mark = "  (condition)" if item.sort == "condition" else ""
    lines = [item.ways[0] + mark, *_wrapped(item.help, "    ", "    ", width)]
    if item.sort == "word" and len(item.ways) > 1:
        lines += _wrapped("also: " + ", ".join(item.ways[1:]), "    ", "          ", width)
    elif len(item.ways) > 1:
        lines += ["    also: " + item.ways[1], *("          " + way for way in item.ways[2:])]
    for detail in item.details:
        lines += _wrapped(detail, "    ", "        ", width)
    if "\n" in item.example:
        return [*lines, "    for example:", *_block(item.example, 6)]
    return [*lines, *([f"    for example: {item.example}"] if item.example else [])]


def _unknown(known: Sequence[Item], search: str) -> list[str]:
    every = {word for item in known for word in (*item.words(), item.topic)}
    wanted = search.lower().split()
    odd = [word for word in wanted if not _has(every, [word])]
    said = {item.topic for item in known}
    for item in known:
        said |= (item if item.sort == "value" else item.replace(names=())).words()
    near = [near for word in odd for near in nearest(word, said)] if odd else wanted
    lines = ["No phrase has the words: " + "".join(c if c.isprintable() else "?" for c in search)]
    return [*lines, "Similar: " + ", ".join(dict.fromkeys(near))] if near else lines


def _wrapped(text: str, first: str, then: str, width: int) -> list[str]:
    return textwrap.wrap(text, width, initial_indent=first, subsequent_indent=then, break_long_words=False)


def _block(example: str, indent: int) -> list[str]:
    return [" " * indent + line for line in example.splitlines()]
