"""An AST as canonical English: one function for each class of syntax node, in the table SAYS.

What is said has exactly the reading of the AST: both parsers make of it an AST that lowers to an equal tree, and that
one is said in the same words. Words come from the vocabulary, so another language is another keyword file. To keep the
rules few, a sentence uses `then`, `or`, `and` without commas, forms with a condition before their command, and forms
with a value behind it; brackets do the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from btlang.english.phrase import holds_definer, leaf_words, value_of
from btlang.english.pieces import (
    CLOSE,
    COLON,
    COMMA,
    LEAF,
    OPEN,
    WORD,
    Piece,
    Pieces,
    flat,
    last_of,
    mark,
    reads_on,
    text_of,
)
from btlang.record import Record
from btlang.tree import ast
from btlang.tree.visit import fold
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.pattern import Form, Slot, forms, name_form
from btlang.vocabulary.trie import TrieNode, add
from btlang.vocabulary.values import format_number
from btlang.vocabulary.vocabulary import Vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

THEN, OR, AND, FORM, WHOLE = range(5)
"""How tightly what is said holds together, loosest first; WHOLE is a leaf or stands in brackets."""

_CHAINS = {
    "sequence": (THEN, "then"), "fallback": (OR, "or"), "parallel": (AND, "and"), "any": (OR, "or"), "all": (AND, "and")
}  # fmt: skip


class Said(Record):
    """What is said of a node, and what may not stand around it without brackets.

    `reaches`: what follows it would become part of it. `takes_otherwise`: an `otherwise` right behind it would.
    `counts`: a count in it would close a `try` or `retry` before it. `in_lines`: it holds a standing rule, which no
    bracket can, so that it is said in lines and blocks only (see blocks.py).
    """

    pieces: Pieces
    level: int
    reaches: bool = False
    takes_otherwise: bool = False
    counts: bool = False
    in_lines: bool = False


class Speaker:
    """Says nodes in the words of a vocabulary, where `names` are defined.

    With `brackets` "all" each chain and form inside another one is bracketed, with "needed" only those whose reading
    needs it (see the table in docs/language/joining.md): what binds less tightly than what is around it,
    a chain in an equal chain, and a form that reaches to the right where something follows it.
    """

    def __init__(
        self, vocabulary: Vocabulary, names: Iterable[str | ast.Definition] = (), brackets: str = "needed"
    ) -> None:
        if brackets not in ("needed", "all"):
            raise ValueError(f'brackets are "needed" or "all": {brackets!r}')
        self.vocabulary = vocabulary.with_references()
        self.all_brackets = brackets == "all"
        self.names: TrieNode = {}
        self._said: dict[int, tuple[ast.Ast, Said]] = {}  # with its node, whose id is then that of no other
        self._forms: dict[str, Form] = {}
        self._leaves: dict[tuple[str, tuple[tuple[str, str], ...]], str] = {}
        self._reads_on: dict[tuple[Piece, Piece], bool] = {}
        self._parameters: dict[str, dict[str, str]] = {}
        for defined in names:
            name, types = (
                (defined.name, dict(defined.parameters)) if isinstance(defined, ast.Definition) else (defined, {})
            )
            self._parameters[name] = types
            add(self.names, name_form(name), types, Meaning("name"))

    def say(self, node: ast.Ast) -> Said:
        """What is said of a node (any but a Mission)."""
        if id(node) in self._said:
            return self._said[id(node)][1]

        def combine(item: ast.Ast, parts: list[Said]) -> Said:
            said: Said = SAYS[type(item)](item, parts, self)
            if any(part.in_lines for part in parts) or any(isinstance(part, ast.Whenever) for part in ast.parts(item)):
                said = said.replace(in_lines=True)
            self._said[id(item)] = item, said
            return said

        return fold(node, ast.parts, combine)

    def statement(self, node: ast.Ast, joined: str = "") -> str:
        """A line of its own, or one of several that make a chain of the operator `joined`."""
        return self.line(node, self.say(node), joined)

    def line(self, node: ast.Ast, said: Said, joined: str) -> str:
        """As `statement`, of what is said of the node."""
        if isinstance(node, ast.Chain) and node.operator == joined:
            said = bracketed(said)
        text = self.text(said.pieces)
        if not isinstance(node, ast.Definition) and self._would_define(flat(said.pieces)):
            return f"{self.vocabulary.word('then')} {text}"  # a line that begins so defines nothing
        return text

    def _would_define(self, pieces: Iterable[Piece]) -> bool:
        """Whether a word that defines stands in a command or name; in a condition it compares."""
        return any(piece.kind == LEAF and holds_definer(piece.text, self.vocabulary) for piece in pieces)

    def text(self, pieces: Pieces) -> str:
        """The pieces as text."""
        return text_of(pieces, self.vocabulary, self.names)

    # -- words

    def word(self, role: str, **values: str) -> Piece:
        """The word of a role, with the value of its slot: `then`, `within 5 s`."""
        if role not in self._forms:
            self._forms[role] = forms(self.vocabulary.first(role))[-1]
        words = (values[part.name] if isinstance(part, Slot) else part for part in self._forms[role])
        return Piece(" ".join(words), WORD)

    def phrase(self, node_id: str, arguments: tuple[tuple[str, str], ...]) -> str:
        """The phrase of a leaf, "" where there is none."""
        key = node_id, arguments
        if key not in self._leaves:
            self._leaves[key] = leaf_words(node_id, dict(arguments), self.vocabulary, self.names)
        return self._leaves[key]

    def value(self, text: str, kind: str) -> str:
        """A port text of a type as it is written."""
        return value_of(text, self.vocabulary.types[kind], self.vocabulary)

    def plain_value(self, text: str, kind: str) -> str:
        """As `value` where no slot tells the type: a text is in quotes, as a bare word may be a name or a number."""
        value = self.value(text, kind)
        if kind != "text" or value != text or value.startswith("{"):
            return value
        return f'"{value}"'

    def name(self, node: ast.Name) -> str:
        """A defined name with its arguments."""
        types, arguments = self._parameters.get(node.name, {}), dict(node.arguments)
        parts = name_form(node.name)
        return " ".join(
            self.value(arguments[part.name], types.get(part.name, "text")) if isinstance(part, Slot) else part
            for part in parts
        )

    def duration(self, role: str, seconds: str) -> Piece:
        """The word of a role that has a duration."""
        return self.word(role, duration=self.value(seconds, "duration"))

    def rounds(self, number: str) -> Piece:
        """`3 times`; one word for once and for a number without end."""
        single = [word for word, rounds in self.vocabulary.counts.items() if str(rounds) == number]
        return Piece(single[0], WORD) if single and number in ("-1", "1") else self.word("count", count=number)

    # -- brackets

    def inside(self, said: Said, needs_brackets: bool) -> Said:
        """What is said inside another chain or form."""
        if said.level < WHOLE and (needs_brackets or self.all_brackets):
            return bracketed(said)
        return said

    def condition(self, said: Said) -> Said:
        """The condition of a form: no reading needs brackets round it."""
        return bracketed(said) if self.all_brackets and said.level < FORM else said

    def reads_on(self, said: Said, piece: Piece) -> bool:
        """Whether the end of what is said and a connective behind it would be read as one."""
        key = last_of(said.pieces), piece
        if key not in self._reads_on:
            self._reads_on[key] = reads_on(*key, self.vocabulary, self.names)
        return self._reads_on[key]

    def behind(self, body: Said, word: Piece, *rest: Pieces, counts: bool = False) -> Said:
        """A form that stands behind its body."""
        body = self.inside(body, body.level < FORM or body.reaches or self.reads_on(body, word))
        return Said((body.pieces, word, *rest), FORM, counts=counts or body.counts)

    def before(self, head: Pieces, body: Said, otherwise: Said | None = None) -> Said:
        """A form that stands before its body, and reaches to the right; its `otherwise` is as it is to be said."""
        if otherwise is None:
            body = self.inside(body, False)
            return Said((*head, body.pieces), FORM, True, body.takes_otherwise, body.counts)
        word = self.word("otherwise")
        body = self.inside(body, body.reaches or body.takes_otherwise or self.reads_on(body, word))
        pieces = (*head, body.pieces, word, otherwise.pieces)
        return Said(pieces, FORM, True, otherwise.takes_otherwise, body.counts or otherwise.counts)


def bracketed(said: Said) -> Said:
    """The same in brackets."""
    return Said((mark(OPEN), said.pieces, mark(CLOSE)), WHOLE)


def english(node: ast.Ast, vocabulary: Vocabulary, *, brackets: str = "needed", names: Iterable[str] = ()) -> str:
    """Canonical English of any AST; a Mission is its facts, its definitions and then its commands.

    Each is on a line, or in a block where a line cannot say it.
    `brackets` is "needed" or "all" (see Speaker); `names` are those that are defined where a part of a mission stands.
    """
    from btlang.english.blocks import lines_of

    if not isinstance(node, ast.Mission):
        return "\n".join(lines_of(node, Speaker(vocabulary, names, brackets)))
    speaker = speaker_of(node, vocabulary, brackets)
    parts = [*((part, "") for part in (*node.includes, *node.facts, *node.definitions)), *statements(node.body)]
    return "\n".join(line for part, joined in parts for line in lines_of(part, speaker, joined=joined))


def speaker_of(mission: ast.Mission, vocabulary: Vocabulary, brackets: str = "needed") -> Speaker:
    """Says the parts of a mission, where its names and places are known."""
    facts = ast.all_facts(mission)
    if facts:
        vocabulary = vocabulary.with_places(tuple(fact.name for fact in facts))
    return Speaker(vocabulary, ast.all_definitions(mission), brackets)


def statements(body: ast.Ast | None) -> Iterator[tuple[ast.Ast, str]]:
    """The commands that a body has as lines of its own, each with the operator of the chain that they make."""
    if isinstance(body, ast.Chain) and body.operator == "sequence":
        yield from ((item, body.operator) for item in body.items)
    elif body is not None:
        yield body, ""


def _leaf(text: str) -> Said:
    return Said((Piece(text, LEAF),), WHOLE)


def _unread(text: str) -> Said:
    """What no phrase of the vocabulary is looked for in."""
    return Said((mark(text),), WHOLE)


def _phrase(node: ast.Phrase, _parts: list[Said], speaker: Speaker) -> Said:
    return _leaf(speaker.phrase(node.entry.id, node.arguments) or node.span.text)


def _name(node: ast.Name, _parts: list[Said], speaker: Speaker) -> Said:
    return _leaf(speaker.name(node))


def _compared(node: ast.Compared, _parts: list[Said], speaker: Speaker) -> Said:
    """The name is in braces: a bare one could be the start of a phrase."""
    ports = {port: speaker.value(text, node.kind) for port, text in node.arguments}
    form = next(
        form
        for form in speaker.vocabulary.comparing_forms(node.kind)
        if {part.name for part in form if isinstance(part, Slot)} == ports.keys()
    )
    return _unread(" ".join((f"{{{node.key}}}", *filled(form, ports))))


def _assign(node: ast.Assign, _parts: list[Said], speaker: Speaker) -> Said:
    word, joint = speaker.vocabulary.word(node.operation), "set_to" if node.operation == "set" else "by"
    value = speaker.plain_value(node.text, node.kind)
    return _unread(f"{word} {spelt(node.key, speaker.vocabulary)} {speaker.vocabulary.word(joint)} {value}")


def _remember(node: ast.Remember, _parts: list[Said], speaker: Speaker) -> Said:
    types = {slot.name: slot.type for slot in node.entry.slots}
    ports = {name: speaker.value(text, types[name]) for name, text in node.arguments}
    ways = (form for pattern in node.entry.quantity for form in reversed(forms(pattern)))
    form = next(f for f in ways if {part.name for part in f if isinstance(part, Slot)} == ports.keys())
    quantity = " ".join(filled(form, ports))
    joint = speaker.vocabulary.word("remember_as")
    return _unread(f"{speaker.vocabulary.word('remember')} {quantity} {joint} {spelt(node.key, speaker.vocabulary)}")


def _for_each(node: ast.ForEach, parts: list[Said], speaker: Speaker) -> Said:
    return speaker.before((*each_head(node, speaker), mark(COLON)), parts[0])


def each_head(node: ast.ForEach, speaker: Speaker) -> Iterator[Piece]:
    """`for each place in lab, dock`: marks, as no phrase is looked for in it."""
    word = speaker.vocabulary.word
    values = ", ".join(speaker.plain_value(text, node.kind) for text in node.values)
    yield mark(f"{word('each')} {spelt(node.key, speaker.vocabulary)} {word('each_in')} {values}")


def filled(form: Form, values: Mapping[str, str]) -> Iterator[str]:
    """The words of a form with values in its slots."""
    return (values[part.name] if isinstance(part, Slot) else part for part in form)


def spelt(key: str, vocabulary: Vocabulary) -> str:
    """The key of a value as words; as one word where it holds one that would end the name."""
    ends = {
        phrase.split()[0] for role in ("set_to", "by", "remember_as", "each_in") for phrase in vocabulary.roles[role]
    }
    return key if ends.intersection(key.split("_")) else key.replace("_", " ")


def _chain(node: ast.Chain, parts: list[Said], speaker: Speaker) -> Said:
    level, role = _CHAINS[node.operator]
    word = speaker.word(role)
    inner = [speaker.inside(p, p.level <= level or p.reaches or speaker.reads_on(p, word)) for p in parts[:-1]]
    inner.append(speaker.inside(parts[-1], parts[-1].level <= level))
    return Said(tuple(_joined(inner, word)), level, *_flags(inner))


def _joined(parts: Sequence[Said], word: Piece) -> Iterator[Pieces | Piece]:
    for i, part in enumerate(parts):
        if i:
            yield word
        yield part.pieces


def _flags(parts: Sequence[Said]) -> tuple[bool, bool, bool]:
    return parts[-1].reaches, parts[-1].takes_otherwise, any(part.counts for part in parts)


def _not(_node: ast.Not, parts: list[Said], speaker: Speaker) -> Said:
    inner = speaker.inside(parts[0], parts[0].level < FORM)
    return Said((speaker.word("not"), inner.pieces), FORM)


def _branching(positive: str, negative: str) -> Callable[[Any, list[Said], Speaker], Said]:
    def said(node: Any, parts: list[Said], speaker: Speaker) -> Said:
        condition = speaker.condition(parts[0])
        head = (speaker.word(negative if node.negated else positive), condition.pieces, mark(COMMA))
        otherwise = speaker.inside(parts[2], False) if node.otherwise is not None else None
        return speaker.before(head, parts[1], otherwise)

    return said


def _whenever(_node: ast.Whenever, parts: list[Said], speaker: Speaker) -> Said:
    return speaker.before((speaker.word("whenever"), speaker.condition(parts[0]).pieces, mark(COMMA)), parts[1])


def _provided(_node: ast.Provided, parts: list[Said], speaker: Speaker) -> Said:
    return speaker.behind(parts[1], speaker.word("provided"), speaker.condition(parts[0]).pieces)


def _repeat(node: ast.Repeat, parts: list[Said], speaker: Speaker) -> Said:
    return speaker.behind(parts[0], speaker.rounds(node.rounds), counts=True)


def _retry(node: ast.Retry, parts: list[Said], speaker: Speaker) -> Said:
    """Its count closes it, so nothing else in it may count."""
    body = speaker.inside(parts[0], parts[0].reaches or parts[0].counts)
    return Said((speaker.word("retry"), body.pieces, speaker.rounds(node.attempts)), FORM, takes_otherwise=True)


def _try(node: ast.Try, parts: list[Said], speaker: Speaker) -> Said:
    body = parts[0]
    if node.otherwise is None:
        return speaker.behind(body, speaker.word("if_possible"))
    otherwise = parts[1]
    if not is_flat_fallback(node.otherwise):
        otherwise = speaker.inside(otherwise, otherwise.level == OR)
    if isinstance(node.body, ast.Retry) and not speaker.all_brackets:
        pieces = (body.pieces, speaker.word("otherwise"), otherwise.pieces)
        return Said(pieces, FORM, True, otherwise.takes_otherwise, otherwise.counts)
    return speaker.before((speaker.word("try"),), bracketed(body) if body.counts else body, otherwise)


def is_flat_fallback(otherwise: ast.Ast) -> bool:
    """Whether the `otherwise` of a `try` makes one node with it, from which brackets would part it."""
    return isinstance(otherwise, ast.Chain) and otherwise.operator == "fallback" and not otherwise.bracketed


def _timed(role: str) -> Callable[[Any, list[Said], Speaker], Said]:
    def said(node: Any, parts: list[Said], speaker: Speaker) -> Said:
        return speaker.behind(parts[0], speaker.duration(role, node.seconds))

    return said


def _wait(node: ast.Wait, _parts: list[Said], speaker: Speaker) -> Said:
    return _leaf(speaker.duration("wait", node.seconds).text)


def _test(role: str) -> Callable[[Any, list[Said], Speaker], Said]:
    def said(_node: Any, parts: list[Said], speaker: Speaker) -> Said:
        return Said((speaker.word(role), speaker.condition(parts[0]).pieces), FORM)

    return said


def _single(role: str) -> Callable[[Any, list[Said], Speaker], Said]:
    def said(_node: Any, _parts: list[Said], speaker: Speaker) -> Said:
        return _leaf(speaker.word(role).text)

    return said


def _definition(node: ast.Definition, parts: list[Said], speaker: Speaker) -> Said:
    """In the strong word, which no other word of the line can overrule."""
    return Said((mark(node.name), mark(speaker.word("define_strong").text), parts[0].pieces), THEN)


def _fact(node: ast.Fact, _parts: list[Said], speaker: Speaker) -> Said:
    x, y = (mark(format_number(metres)) for metres in (node.x, node.y))
    place = (mark(node.name), mark(speaker.word("fact").text), mark(OPEN), x, mark(COMMA), y, mark(CLOSE))
    if node.facing is None:
        return Said(place, THEN)
    angle = value_of(format_number(node.facing), speaker.vocabulary.types["angle"], speaker.vocabulary)
    return Said((*place, mark(speaker.word("facing").text), mark(angle)), THEN)


def _include(node: ast.Include, _parts: list[Said], speaker: Speaker) -> Said:
    return Said((mark(speaker.vocabulary.word("include")), mark(f'"{node.path}"')), THEN)


SAYS: dict[type[ast.Ast], Callable[[Any, list[Said], Speaker], Said]] = {
    ast.Phrase: _phrase,
    ast.Name: _name,
    ast.Compared: _compared,
    ast.Assign: _assign,
    ast.Remember: _remember,
    ast.ForEach: _for_each,
    ast.Chain: _chain,
    ast.Not: _not,
    ast.If: _branching("if", "unless"),
    ast.While: _branching("while", "until"),
    ast.Whenever: _whenever,
    ast.Provided: _provided,
    ast.Repeat: _repeat,
    ast.Retry: _retry,
    ast.Try: _try,
    ast.Within: _timed("within"),
    ast.For: _timed("for"),
    ast.Every: _timed("every"),
    ast.Delay: _timed("delay"),
    ast.Wait: _wait,
    ast.WaitUntil: _test("wait_until"),
    ast.Check: _test("check"),
    ast.Nothing: _single("nothing"),
    ast.Fail: _single("fail"),
    ast.Definition: _definition,
    ast.Fact: _fact,
    ast.Include: _include,
}
"""How each class of node is said, given what is said of its parts."""
