"""Rules of a context-free grammar, and their notations: that of `forms.py`, GBNF and EBNF.

GBNF is the notation of llama.cpp, EBNF that of the W3C in the specification of XML.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator

from btlang.support.record import Record

_PIECE = re.compile(
    r"""\s*(?:"(?P<text>[^"]*)"|(?P<chars>\[[^\]]+\])|<(?P<words>[^>]+)>|(?P<name>[a-z][a-z0-9-]*)|(?P<mark>[|()?*+]))"""
)
_ESCAPES = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n"})


class Text(Record):
    """These characters."""

    text: str


class Chars(Record):
    """One character of a class, in the notation of both GBNF and W3C EBNF: `[1-9]`."""

    written: str


class RuleName(Record):
    """The right-hand side of the rule of that name."""

    name: str


class Alternatives(Record):
    """One of these parts."""

    parts: tuple[Part, ...]


class Joined(Record):
    """These parts, one after the other."""

    parts: tuple[Part, ...]


class Repeated(Record):
    """A part as often as the mark says: `?`, `*` or `+`."""

    part: Part
    mark: str


Part = Text | Chars | RuleName | Alternatives | Joined | Repeated
Rules = dict[str, Part]
"""The rules by name; the first one makes whole missions."""

NOTHING = Alternatives(())
"""What can't be said with the loaded words."""


def is_nothing(part: Part) -> bool:
    """Whether a part is NOTHING, which is asked of each part that is made."""
    return type(part) is Alternatives and not part.parts


def choice(parts: Iterable[Part]) -> Part:
    """Return one of the parts that can be said, each once."""
    said = (part for part in parts if not is_nothing(part))
    found = tuple(
        {part.text if type(part) is Text else part: part for part in said}.values()
    )  # a text has a quick hash
    return found[0] if len(found) == 1 else Alternatives(found)


def joined(parts: Iterable[Part]) -> Part:
    """Return all parts in a row, with neighbouring texts as one; NOTHING if one of them can't be said."""
    made: list[Part] = []
    for part in parts:
        if isinstance(part, Text) and made and isinstance(made[-1], Text):
            made[-1] = Text(made[-1].text + part.text)
        elif is_nothing(part):
            return NOTHING
        elif not isinstance(part, Joined) or part.parts:
            made.append(part)
    return made[0] if len(made) == 1 else Joined(tuple(made))


def repeat(part: Part, mark: str) -> Part:
    """Repeat the part as often as the mark says. A part that can't be said can be said no times."""
    if is_nothing(part):
        return NOTHING if mark == "+" else Joined(())
    return Repeated(part, mark)


def parse_rule(format_rules: str, words: Callable[[str], Part]) -> Part:
    """Parse a right-hand side: `"text"`, `[1-9]`, `name`, `(a | b)`, `a?`, `a*`, `a+`, and `<what words() makes of
    this>`.

    A backtick in a text is a double quote, `\\n` a line end.
    """
    pieces = list(_pieces(format_rules))

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
            part = RuleName(piece)
        else:
            part = alternatives()
            pieces.pop(0)  # the closing bracket
        while pieces and pieces[0][0] == "mark" and pieces[0][1] in "?*+":
            part = repeat(part, pieces.pop(0)[1])
        return part

    return alternatives()


def _pieces(format_rules: str) -> Iterator[tuple[str, str]]:
    for match in _PIECE.finditer(format_rules):
        yield str(match.lastgroup), str(match[match.lastgroup or 0])


def prune(rules: Rules) -> Rules:
    """Return the rules that can make something and that the first one uses, without the others and what needs them."""
    uses = {name: set(find_rule_names(part)) for name, part in rules.items()}
    while empty := {name for name, part in rules.items() if is_nothing(part)}:
        rules = {
            name: part if uses[name].isdisjoint(empty) else _without(part, empty)
            for name, part in rules.items()
            if name not in empty
        }
    used: dict[str, None] = {}
    pending = [next(iter(rules))]
    while pending:
        name = pending.pop()
        if name not in used:
            used[name] = None
            pending += find_rule_names(rules[name])
    return {name: part for name, part in rules.items() if name in used}


def _without(part: Part, empty: set[str]) -> Part:
    if isinstance(part, RuleName):
        return NOTHING if part.name in empty else part
    if isinstance(part, Alternatives):
        return choice(_without(each, empty) for each in part.parts)
    if isinstance(part, Joined):
        return joined(_without(each, empty) for each in part.parts)
    if isinstance(part, Repeated):
        return repeat(_without(part.part, empty), part.mark)
    return part


def find_rule_names(part: Part) -> Iterator[str]:
    """Yield the rules that a right-hand side uses."""
    if isinstance(part, RuleName):
        yield part.name
    elif isinstance(part, Repeated):
        yield from find_rule_names(part.part)
    elif isinstance(part, Alternatives | Joined):
        for each in part.parts:
            yield from find_rule_names(each)


def format_rules(rules: Rules, pieces_of: Callable[[str], list[str]]) -> str:
    """Format one rule on each line; `pieces_of` returns a text as the notation quotes it, in a row."""
    return "".join(f"{name} ::= {_format_part(part, pieces_of)}\n" for name, part in rules.items())


def _format_part(part: Part, pieces_of: Callable[[str], list[str]], inside: bool = False) -> str:
    """Format a part, in brackets if it is `inside` another one that binds tighter."""
    if isinstance(part, Chars):
        return part.written
    if isinstance(part, RuleName):
        return part.name
    if isinstance(part, Repeated):
        return _format_part(part.part, pieces_of, inside=True) + part.mark
    if isinstance(part, Text):
        pieces = pieces_of(part.text)
        text, inside = " ".join(pieces), inside and len(pieces) > 1
    elif isinstance(part, Joined):
        text = " ".join(_format_part(each, pieces_of, isinstance(each, Alternatives)) for each in part.parts)
    else:
        text = " | ".join(_format_part(each, pieces_of) for each in part.parts)
    return f"({text})" if inside else text


def to_ebnf(rules: Rules) -> str:
    """Format one rule on each line; the first makes whole missions."""
    return format_rules(rules, lambda text: [_quote_ebnf(piece) for piece in re.split(r'(\n|"+)', text) if piece])


def _quote_ebnf(piece: str) -> str:
    """Quote a text, which has no escapes: a line end is a code, and a double quote stands in single ones."""
    if piece == "\n":
        return "#xA"
    return f"'{piece}'" if '"' in piece else f'"{piece}"'


def to_gbnf(rules: Rules) -> str:
    """Format one rule on each line. The first must be called "root"."""
    return format_rules(rules, lambda text: [f'"{text.translate(_ESCAPES)}"'])
