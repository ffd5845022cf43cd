"""Rules of a context-free grammar, and the notation in which `forms.py` writes them."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator

from btlang.support.record import Record


class Text(Record):
    """These characters."""

    text: str


class Chars(Record):
    """One character of a class, in the notation of both GBNF and W3C EBNF: `[1-9]`."""

    written: str


class Name(Record):
    """What the rule of that name makes."""

    name: str


class Choice(Record):
    """One of these."""

    parts: tuple[Part, ...]


class Joined(Record):
    """These, one after the other."""

    parts: tuple[Part, ...]


class Repeated(Record):
    """The part as often as the mark says: `?`, `*` or `+`."""

    part: Part
    mark: str


Part = Text | Chars | Name | Choice | Joined | Repeated
Rules = dict[str, Part]
"""The rules by name; the first one makes whole missions."""

NOTHING = Choice(())
"""What can't be said with the loaded words."""


def choice(parts: Iterable[Part]) -> Part:
    """One of those that can be said, each once."""
    found = tuple(dict.fromkeys(part for part in parts if part != NOTHING))
    return found[0] if len(found) == 1 else Choice(found)


def joined(parts: Iterable[Part]) -> Part:
    """All parts in a row, with neighbouring texts as one; NOTHING if one of them can't be said."""
    made: list[Part] = []
    for part in parts:
        if isinstance(part, Text) and made and isinstance(made[-1], Text):
            made[-1] = Text(made[-1].text + part.text)
        elif part == NOTHING:
            return NOTHING
        elif not isinstance(part, Joined) or part.parts:
            made.append(part)
    return made[0] if len(made) == 1 else Joined(tuple(made))


def repeated(part: Part, mark: str) -> Part:
    """The part as often as the mark says. What can't be said can be said no times."""
    if part == NOTHING:
        return NOTHING if mark == "+" else Joined(())
    return Repeated(part, mark)


_PIECE = re.compile(
    r"""\s*(?:"(?P<text>[^"]*)"|(?P<chars>\[[^\]]+\])|<(?P<words>[^>]+)>|(?P<name>[a-z][a-z0-9-]*)|(?P<mark>[|()?*+]))"""
)


def parsed(written: str, words: Callable[[str], Part]) -> Part:
    """A right-hand side: `"text"`, `[1-9]`, `name`, `(a | b)`, `a?`, `a*`, `a+`, and `<what words() makes of this>`.

    A backtick in a text is a double quote, `\\n` a line end.
    """
    pieces = list(_pieces(written))

    def alternatives() -> Part:
        found = [row()]
        while pieces and pieces[0] == ("mark", "|"):
            pieces.pop(0)
            found.append(row())
        return choice(found)

    def row() -> Part:
        parts: list[Part] = []
        while pieces and pieces[0] not in (("mark", "|"), ("mark", ")")):
            parts.append(one())
        return joined(parts)

    def one() -> Part:
        kind, piece = pieces.pop(0)
        part: Part
        if kind == "text":
            part = Text(piece.replace("`", '"').replace("\\n", "\n"))
        elif kind == "chars":
            part = Chars(piece)
        elif kind == "words":
            part = words(piece)
        elif kind == "name":
            part = Name(piece)
        else:
            part = alternatives()
            pieces.pop(0)  # the closing bracket
        while pieces and pieces[0][0] == "mark" and pieces[0][1] in "?*+":
            part = repeated(part, pieces.pop(0)[1])
        return part

    return alternatives()


def _pieces(written: str) -> Iterator[tuple[str, str]]:
    for match in _PIECE.finditer(written):
        yield str(match.lastgroup), str(match[match.lastgroup or 0])


def pruned(rules: Rules) -> Rules:
    """The rules that can make something and that the first one uses; the others, and what needs them, go."""
    rules = dict(rules)
    while True:
        empty = {name for name, part in rules.items() if part == NOTHING}
        if not empty:
            break
        rules = {name: _without(part, empty) for name, part in rules.items() if name not in empty}
    used: dict[str, None] = {}
    pending = [next(iter(rules))]
    while pending:
        name = pending.pop()
        if name not in used:
            used[name] = None
            pending += names_in(rules[name])
    return {name: part for name, part in rules.items() if name in used}


def _without(part: Part, empty: set[str]) -> Part:
    if isinstance(part, Name):
        return NOTHING if part.name in empty else part
    if isinstance(part, Choice):
        return choice(_without(each, empty) for each in part.parts)
    if isinstance(part, Joined):
        return joined(_without(each, empty) for each in part.parts)
    if isinstance(part, Repeated):
        return repeated(_without(part.part, empty), part.mark)
    return part


def names_in(part: Part) -> Iterator[str]:
    """The rules that a right-hand side uses."""
    if isinstance(part, Name):
        yield part.name
    elif isinstance(part, Repeated):
        yield from names_in(part.part)
    elif isinstance(part, Choice | Joined):
        for each in part.parts:
            yield from names_in(each)


def written(rules: Rules, pieces_of: Callable[[str], list[str]]) -> str:
    """One rule on each line; `pieces_of` gives a text as the notation quotes it, in a row."""
    return "".join(f"{name} ::= {_part_written(part, pieces_of)}\n" for name, part in rules.items())


def _part_written(part: Part, pieces_of: Callable[[str], list[str]], inside: bool = False) -> str:
    """A part, in brackets where it is `inside` another one that binds tighter."""
    if isinstance(part, Chars):
        return part.written
    if isinstance(part, Name):
        return part.name
    if isinstance(part, Repeated):
        return _part_written(part.part, pieces_of, inside=True) + part.mark
    if isinstance(part, Text):
        pieces = pieces_of(part.text)
        text, inside = " ".join(pieces), inside and len(pieces) > 1
    elif isinstance(part, Joined):
        text = " ".join(_part_written(each, pieces_of, isinstance(each, Choice)) for each in part.parts)
    else:
        text = " | ".join(_part_written(each, pieces_of) for each in part.parts)
    return f"({text})" if inside else text
