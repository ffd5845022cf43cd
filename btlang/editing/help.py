"""Help at a place of a text: what was understood there, and what may follow; and the colours of its words."""

from __future__ import annotations

from itertools import groupby

from btlang.api import Mission
from btlang.editing.reading import TextReading
from btlang.editing.words import RobotWords
from btlang.frontends.mission.completion.completer import Completion, completions
from btlang.frontends.mission.reader import lexed
from btlang.frontends.mission.token import Assigned, Called, Each, Header, Listed, NodeCall, Remembered, Token
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.frontends.table import frontend_of
from btlang.printer.mission import english
from btlang.text.source import Source
from btlang.tree import ast
from btlang.vocabulary.entry import About, Entry

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Found = dict[str, Any]

_LONGEST = 500  # characters of canonical English
_NAMED = "A name of this mission"
_ROLES: dict[type, str] = {Remembered: "remember", NodeCall: "do", Each: "each"}
_MOST = 200
_OPERANDS = {"condition": "condition"} | dict.fromkeys(
    ("command", "wait", "wait_time", "wait_forever", "nothing", "fail"), "command"
)
_UNCOLOURED = ("unknown", "comma", "colon", "open", "close")
_QUOTES = ('"', "'")


def hover(source: Source, at: int, words: RobotWords, read: TextReading | None = None) -> dict[str, Any]:
    """Return `found`: what is at a character, None for nothing.

    `start` and `end` are its characters; `words` what was understood, in canonical English; `help` and `example` those
    of its phrase or joining word; `id` that of its node or role; `kind` "command", "condition", "name", "word", or
    "node" in XML and JSON. `read` is the text if it was read already. Raises MissionError for words that can't be used.
    """
    read = read or TextReading(source, words)
    if read.sort == "english":
        return {"found": _in_english(read, at)}
    return {"found": None if read.mission is None else _in_tree(source, at, read.mission)}


def tokens(
    source: Source, words: RobotWords, at: int = 0, to: int | None = None, lexer: Lexer | None = None
) -> dict[str, Any]:
    """List the `tokens` between two characters, by default all: `start`, `end`, and the `kind` as which they're read.

    This is "command", "condition", "name" (of a definition), "word" (joins others), "text" or "number" (in any of
    these), or "comment". What isn't understood has none, nor has XML and JSON. `lexer` has read the text if that was
    done already. Raises MissionError for words that can't be used.
    """
    if frontend_of(source) != "english":
        return {"tokens": []}
    lexer = lexer or lexed(source, words.vocabulary(source))
    kinds = [""] * len(source.text)

    def paint(start: int, end: int, kind: str) -> None:
        kinds[start:end] = [kind] * (end - start)

    for token in lexer.tokens:
        if token.kind not in _UNCOLOURED:
            is_name = isinstance(token.value, Called) and token.value.entry.sort == "name"
            paint(token.start, token.end, "name" if is_name else _OPERANDS.get(token.kind, "word"))
        if isinstance(token.value, Header):
            paint(token.value.span.start, token.value.span.end, "name")
    for start, end in zip(lexer.text.starts, lexer.text.ends, strict=True):
        first = source.text[start:end][:1]
        if first in _QUOTES or first.isdigit():
            paint(start, end, "number" if first.isdigit() else "text")
    for comment in lexer.text.comments:
        paint(comment.start, comment.end, "comment")
    found, start = [], at
    for kind, run in groupby(kinds[at:to]):
        end = start + sum(1 for _ in run)
        if kind:
            found.append({"start": start, "end": end, "kind": kind})
        start = end
    return {"tokens": found}


def _in_tree(source: Source, at: int, mission: Mission) -> Found | None:
    places = ((node.span, node) for node in mission.tree.walk() if node.span is not None)
    around = [(span, node) for span, node in places if span.source is source and span.start <= at < span.end]
    if not around:
        return None
    span, node = min(around, key=lambda place: place[0].end - place[0].start)
    entry = mission.vocabulary.entry(node.id)
    return _find(span.start, span.end, mission.label(node), node.id, "node", entry or About())


def _in_english(read: TextReading, at: int) -> Found | None:
    source, mission, lexer = read.source, read.mission, read.lexer
    token = next((token for token in lexer.tokens if token.start <= at < token.end), None)
    if token is None:
        return None
    said = token.value
    program = mission.syntax if mission is not None else None
    if isinstance(said, Header):
        return _definition(token, said, program, lexer)
    part = _smallest(program, source, token) if program is not None else None
    if isinstance(said, Called | Listed):
        if part is None and isinstance(said, Called) and said.entry.sort in ("action", "condition"):
            part = ast.Phrase(said.entry, said.arguments, lexer.text.span(0, 0))
        understood = _english(part, program, lexer) if part is not None else source.text[token.start : token.end]
        return _describe_call(token, said.entry, understood, lexer)
    known = said.operation if isinstance(said, Assigned) else _ROLES.get(type(said), token.kind)
    role = next((role for role in (known, token.role) if role in lexer.vocabulary.about), "")
    if not role:
        return None
    understood = source.text[token.start : token.end]
    if part is not None:
        understood = _english(_join(part, at), program, lexer)
    return _find(token.start, token.end, understood, role, "word", lexer.vocabulary.about[role])


def _definition(token: Token, header: Header, program: ast.Program | None, lexer: Lexer) -> Found:
    defined = program.definitions if program is not None else ()
    body = next((each.body for each in defined if each.name_span.start == header.span.start), None)
    understood = header.name if body is None else f"{header.name}: {_english(body, program, lexer)}"
    return _find(token.start, token.end, understood, header.name, "name", About(help=_NAMED))


def _describe_call(token: Token, entry: Entry, understood: str, lexer: Lexer) -> Found:
    if entry.sort == "name":
        return _find(token.start, token.end, understood, entry.id, "name", About(help=_NAMED))
    if entry.sort == "value":
        return _find(token.start, token.end, understood, "compare", "condition", lexer.vocabulary.about["compare"])
    return _find(
        token.start, token.end, understood, entry.id, "command" if entry.sort == "action" else entry.sort, entry
    )


def _find(start: int, end: int, understood: str, id: str, kind: str, about: Entry | About) -> Found:
    short = understood if len(understood) <= _LONGEST else f"{understood[: _LONGEST - 1]}…"
    return {
        "start": start, "end": end, "words": short, "help": " ".join(about.help.split()), "example": about.example,
        "id": id, "kind": kind,
    }  # fmt: skip


def _smallest(program: ast.Program, source: Source, token: Token) -> ast.Ast | None:
    """Return the smallest part of a mission around a token, with all that is said by the same words."""
    bodies = [each.body for each in program.definitions] + ([program.body] if program.body is not None else [])
    best: ast.Ast | None = None
    for body in bodies:
        for part in ast.parents_first(body):
            span = part.span
            if span.start <= token.start and token.end <= span.end and span.source is source:
                if best is None or span.end - span.start < best.span.end - best.span.start:
                    best = part
    return best


def _join(part: ast.Ast, at: int) -> ast.Ast:
    """Return only the two parts of a chain that are joined at a character."""
    if not isinstance(part, ast.Chain) or len(part.items) < 3:
        return part
    right = next((number for number, item in enumerate(part.items) if item.span.start > at), len(part.items) - 1)
    return part.replace(items=part.items[max(right - 1, 0) : right + 1], bracketed=False)  # type: ignore[no-any-return]


def _english(part: ast.Ast, program: ast.Program | None, lexer: Lexer) -> str:
    names = ast.all_definitions(program) if program is not None else ()
    return english(part, lexer.vocabulary, names=names)


def complete(source: Source, words: RobotWords, at: int | None = None, whole: str = "") -> dict[str, Any]:
    """List completions at a character, by default the end; see `Completion`. None in XML and JSON.

    What the text says elsewhere comes first, most often first, then the values that a phrase waits for, and all others
    as they fit. Behind a word that is written out are also those behind the blank that would follow. `whole` is the
    text if that of `source` is a part of it. Raises MissionError for words that can't be used.
    """
    if frontend_of(source) != "english":
        return {"completions": []}
    vocabulary, before = words.vocabulary(source), source.text[:at]
    found = list(completions(before, vocabulary))
    written = next((each for each in found if each.text == f"{before[each.start :]} "), None)
    if written is not None:
        behind = completions(f"{before} ", vocabulary)
        further = [each.replace(text=written.text + each.text, start=written.start) for each in behind]
        found = [*further, *(each for each in found if each is not written)]
    said = f" {' '.join((whole or source.text).lower().split())} "
    ranked = sorted(found, key=lambda each: (-_count(each, said), each.kind != "value"))
    once = {each.text: each.as_dict() for each in reversed(ranked)}
    return {"completions": [*reversed(once.values())][:_MOST]}


def _count(each: Completion, said: str) -> int:
    """Return how often a text says what is offered; what joins or corrects words counts as never said."""
    return 0 if each.kind == "connective" or each.spelling else said.count(f" {each.text.strip().lower()} ")
