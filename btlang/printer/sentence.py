"""Canonical English of syntax trees: one function for each class of syntax node, in the table PRINTERS."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from btlang.printer.exact import exact, phrase, quote
from btlang.printer.fragments import CLOSE, COLON, COMMA, LEAF, OPEN, Fragment, Fragments, mark
from btlang.printer.phrase import value_of
from btlang.printer.printer import AND, FORM, LOOSE, OR, THEN, WHOLE, Doc, Printer, add_brackets
from btlang.tree import ast
from btlang.vocabulary.language_tables import CONNECTIVES
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.value_type import PLACE, WORLD, format_number

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LEVELS = {"sequence": THEN, "fallback": OR, "and": AND, "parallel": AND}
CHAINS = {
    **{operator: (_LEVELS.get(operator, THEN), role) for role, operator in reversed(CONNECTIVES.items())},
    "any": (OR, "or"), "all": (AND, "and"),
}  # fmt: skip


def statements(body: ast.Ast | None) -> Iterator[tuple[ast.Ast, str]]:
    """Yield the commands that a body has as separate lines, each with the operator of the chain that they make."""
    if isinstance(body, ast.Chain) and body.operator == "sequence":
        yield from ((item, body.operator) for item in body.items)
    elif body is not None:
        yield body, ""


def _leaf(text: str) -> Doc:
    return Doc((Fragment(text, LEAF),), WHOLE)


def _name(node: ast.Name, _parts: list[Doc], printer: Printer) -> Doc:
    return _leaf(printer.name(node))


def _chain(node: ast.Chain, parts: list[Doc], printer: Printer) -> Doc:
    if node.operator == "parallel":
        return _parallel(node, parts, printer)
    level, role = CHAINS[node.operator]
    word = printer.word(role)
    inner = [printer.inside(p, p.level <= level or p.reaches or printer.reads_on(p, word)) for p in parts[:-1]]
    inner.append(printer.inside(parts[-1], parts[-1].level <= level))
    if printer.is_clear and node.operator == "any":
        negated = [isinstance(item, ast.Not) for item in node.items]
        inner = [printer.inside(p, own) for p, own in zip(inner, negated, strict=True)]
    if printer.is_clear:
        inner = [printer.inside(p, p.level < FORM or p.reaches or (p.behind and i > 0)) for i, p in enumerate(inner)]
    words = [word] * (len(inner) - 1)
    return Doc(tuple(_join(inner, words)), level, *_flags(inner))


def _parallel(node: ast.Chain, parts: list[Doc], printer: Printer) -> Doc:
    """Join by `and` if that alone means at the same time, else put the words that say so behind it."""
    if printer.joined_by_and(node):
        return _chain(node.replace(operator="and"), parts, printer)
    word = printer.word("and")
    inner = [printer.inside(p, p.level < WHOLE) for p in parts]
    behind = (printer.word("in_parallel"),)
    return Doc((*_join(inner, [word] * (len(inner) - 1)), *behind), AND, False, False, any(p.counts for p in inner))


def _at_least(node: ast.AtLeast, parts: list[Doc], printer: Printer) -> Doc:
    """Print a list that reaches to the end of the condition, so inside another one it is in brackets."""
    word = printer.word("and")
    inner = [printer.inside(p, p.level < FORM or printer.reads_on(p, word)) for p in parts]
    fragments = [fragment for part in inner[:-1] for fragment in (part.fragments, mark(COMMA))]
    return Doc((printer.word("at_least_of", count=str(node.number)), *fragments[:-1], word, inner[-1].fragments), LOOSE)


def _join(parts: Sequence[Doc], words: Sequence[Fragment]) -> Iterator[Fragments | Fragment]:
    for i, part in enumerate(parts):
        if i:
            yield words[i - 1]
        yield part.fragments


def _flags(parts: Sequence[Doc]) -> tuple[bool, bool, bool]:
    return parts[-1].reaches, parts[-1].takes_otherwise, any(part.counts for part in parts)


def _not(_node: ast.Not, parts: list[Doc], printer: Printer) -> Doc:
    inner = printer.inside(parts[0], parts[0].level < FORM)
    return Doc((printer.word("not"), inner.fragments), FORM)


def _branching(positive: str, negative: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(node: Any, parts: list[Doc], printer: Printer) -> Doc:
        condition = printer.condition(parts[0])
        head = (printer.word(negative if node.negated else positive), condition.fragments, mark(COMMA))
        if node.otherwise is not None:
            return printer.before(head, parts[1], printer.inside(parts[2], False))
        whose = printer.is_clear and parts[1].reaches and parts[1].chooses  # an `otherwise` could be of both
        return printer.before(head, printer.inside(parts[1], whose))

    return said


def _if_works(node: ast.IfWorks, parts: list[Doc], printer: Printer) -> Doc:
    tried = printer.inside(parts[0], parts[0].level == LOOSE or parts[0].reaches)
    head = (tried.fragments, mark(COMMA), printer.word("if_works"), mark(COMMA))
    otherwise = printer.inside(parts[2], parts[2].level == LOOSE) if node.otherwise is not None else None
    said = printer.before(head, printer.inside(parts[1], parts[1].level == LOOSE), otherwise)
    return Doc(said.fragments, LOOSE, True, said.takes_otherwise, said.counts)


def _whenever(node: ast.Whenever, parts: list[Doc], printer: Printer) -> Doc:
    return printer.before((printer.word(rule_word(node)), printer.condition(parts[0]).fragments, mark(COMMA)), parts[1])


def rule_word(node: ast.Whenever) -> str:
    """Return the role of the word with which a rule begins."""
    return "first_time" if node.once else "whenever"


def _provided(node: ast.Provided, parts: list[Doc], printer: Printer) -> Doc:
    if not isinstance(node.body, ast.Provided):
        return printer.behind(parts[1], printer.word("provided"), printer.condition(parts[0]).fragments)
    head, body = guards(node, printer)
    return printer.before((*head, mark(COMMA)), printer.say(body))


def guards(node: ast.Provided, printer: Printer) -> tuple[tuple[Fragment | Fragments, ...], ast.Ast]:
    """Return the words of all guards of a command, the outermost first, and the command."""
    head: tuple[Fragment | Fragments, ...] = ()
    body: ast.Ast = node
    while isinstance(body, ast.Provided):
        said = printer.condition(printer.say(body.condition)).fragments
        head, body = (*head, mark(COMMA), printer.word("provided"), said), body.body
    return head[1:], body


def _named(node: ast.Named, parts: list[Doc], printer: Printer) -> Doc:
    """Print a name before its command, which only a statement can have."""
    return Doc((mark(quote(node.name, printer.vocabulary)), mark(COLON), parts[0].fragments), LOOSE, in_lines=True)


def _stop_when(_node: ast.StopWhen, parts: list[Doc], printer: Printer) -> Doc:
    return printer.behind(parts[1], printer.word("stop_when"), printer.condition(parts[0]).fragments)


def _repeat(node: ast.Repeat, parts: list[Doc], printer: Printer) -> Doc:
    body = printer.inside(parts[0], isinstance(node.body, ast.Every | ast.Apart))  # which the count would pace
    return printer.behind(body, printer.rounds(node.rounds), counts=True)


def _retry(node: ast.Retry, parts: list[Doc], printer: Printer) -> Doc:
    """Print a form that its count closes, so nothing else in it may count."""
    body = printer.inside(parts[0], parts[0].reaches or parts[0].counts)
    if node.pause:
        rounds: Fragments = paced_rounds(node.attempts, node.pause, "every", printer)
    else:
        rounds = (printer.rounds(node.attempts),)
    return Doc((printer.word("retry"), body.fragments, *rounds), FORM, takes_otherwise=True)


def paced_rounds(rounds: str, seconds: str, role: str, printer: Printer) -> tuple[Fragment, Fragment]:
    """Print `3 times every 5 s`; `once every 5 s` would have no number."""
    count = printer.word("count", count=rounds) if rounds == "1" else printer.rounds(rounds)
    return count, printer.duration(role, seconds)


def _try(node: ast.Try, parts: list[Doc], printer: Printer) -> Doc:
    body = parts[0]
    if node.otherwise is None:
        said = printer.behind(body, printer.word("if_possible"))
        return Doc(said.fragments, FORM, takes_otherwise=True, counts=said.counts, behind=True)
    otherwise = parts[1]
    if not is_flat_fallback(node.otherwise):
        otherwise = printer.inside(otherwise, otherwise.level == OR)
    if isinstance(node.body, ast.Retry) and not printer.all_brackets:
        fragments = (body.fragments, printer.word("otherwise"), otherwise.fragments)
        return Doc(fragments, FORM, True, otherwise.takes_otherwise, otherwise.counts)
    return printer.before((printer.word("try"),), add_brackets(body) if body.counts else body, otherwise)


def is_flat_fallback(otherwise: ast.Ast) -> bool:
    """Whether the `otherwise` of a `try` makes one node with it, from which brackets would part it."""
    return isinstance(otherwise, ast.Chain) and otherwise.operator == "fallback" and not otherwise.bracketed


def _timed(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(node: Any, parts: list[Doc], printer: Printer) -> Doc:
        own = role == "for" and isinstance(node.body, ast.WaitUntil)  # `wait until C for 10 s`: C has to hold so long
        return printer.behind(printer.inside(parts[0], own), printer.duration(role, node.seconds))

    return said


def _paced(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(node: Any, parts: list[Doc], printer: Printer) -> Doc:
        counted = ast.Repeat | ast.Retry | ast.Every | ast.Apart  # behind these a count or a pace is part of them
        body = printer.inside(parts[0], isinstance(node.body, counted))
        if not node.rounds:
            return printer.behind(body, printer.duration(role, node.seconds))
        count, pace = paced_rounds(node.rounds, node.seconds, role, printer)
        words = (pace, (count,)) if role == "every" else (count, (pace,))  # `3 times every 5 s` has two readings
        return printer.behind(body, *words, counts=True)

    return said


def _constrained(node: ast.Constrained, parts: list[Doc], printer: Printer) -> Doc:
    """Print a constraint. Whatever stands beside it in its statement or bracket would be constrained, too."""
    role = "without_entering" if node.kind == "keep out" else "without_leaving"
    zones = [printer.value(zone, "zone") for zone in node.zones]
    listed = f" {printer.word('and').text} ".join(zones)
    body = printer.inside(parts[0], parts[0].level < WHOLE)
    return Doc((body.fragments, Fragment(printer.word(role, zone=listed).text, LEAF)), LOOSE)


def _wait(node: ast.Wait, _parts: list[Doc], printer: Printer) -> Doc:
    return _leaf(printer.duration("wait", node.seconds).text)


def _held(node: ast.Held, parts: list[Doc], printer: Printer) -> Doc:
    return Doc((printer.condition(parts[0]).fragments, printer.duration("for", node.seconds)), FORM)


def _wait_until(node: ast.WaitUntil, parts: list[Doc], printer: Printer) -> Doc:
    return Doc((printer.word("wait_until"), printer.condition(parts[0]).fragments), FORM)


def _wait_time(node: ast.WaitTime, _parts: list[Doc], printer: Printer) -> Doc:
    """Print the next of several times: `wait until 08:00, 12:00 or 18:00`."""
    first, *more = node.time.split(";")
    said = [printer.time_of_day("wait_time", first).text, *(printer.value(time, "time_of_day") for time in more)]
    return _leaf(f" {printer.word('or').text} ".join((", ".join(said[:-1]), said[-1])) if more else said[0])


def _until_time(node: ast.UntilTime, parts: list[Doc], printer: Printer) -> Doc:
    return printer.behind(parts[0], printer.time_of_day("until_time", node.time))


def _by_time(node: ast.ByTime, parts: list[Doc], printer: Printer) -> Doc:
    return printer.behind(parts[0], printer.time_of_day("by_time", node.time))


def _test(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(_node: Any, parts: list[Doc], printer: Printer) -> Doc:
        return Doc((printer.word(role), printer.condition(parts[0]).fragments), FORM)

    return said


def _single(role: str) -> Callable[[Any, list[Doc], Printer], Doc]:
    def said(_node: Any, _parts: list[Doc], printer: Printer) -> Doc:
        return _leaf(printer.word(role).text)

    return said


"""How each class of node is said, given what is said of its parts."""


def compared(node: ast.Compared, _parts: list[Doc], printer: Printer) -> Doc:
    """Print a comparison. The name is in braces: a bare one could be the start of a phrase."""
    ports = {port: printer.value(text, node.kind) for port, text in node.arguments}
    form = next(
        form
        for form in printer.vocabulary.comparing_forms(node.kind)
        if {part.name for part in form if isinstance(part, Slot)} == ports.keys()
    )
    return _unread(" ".join((f"{{{node.key}}}", *fill_form(form, ports))))


def assign(node: ast.Assign, _parts: list[Doc], printer: Printer) -> Doc:
    word, joint = printer.vocabulary.word(node.operation), "set_to" if node.operation == "set" else "by"
    value = printer.plain_value(node.text, node.kind)
    return _unread(f"{word} {spell_key(node.key, printer.vocabulary)} {printer.vocabulary.word(joint)} {value}")


def remember(node: ast.Remember, _parts: list[Doc], printer: Printer) -> Doc:
    types = {slot.name: slot.type for slot in node.entry.slots}
    ports = {name: printer.value(text, types[name]) for name, text in node.arguments}
    ways = (form for pattern in node.entry.quantity for form in reversed(forms(pattern)))
    form = next(f for f in ways if {part.name for part in f if isinstance(part, Slot)} == ports.keys())
    quantity = " ".join(fill_form(form, ports))
    joint = printer.vocabulary.word("remember_as")
    return _unread(
        f"{printer.vocabulary.word('remember')} {quantity} {joint} {spell_key(node.key, printer.vocabulary)}"
    )


def for_each(node: ast.ForEach, parts: list[Doc], printer: Printer) -> Doc:
    return printer.before((*each_head(node, printer), mark(COLON)), parts[0])


def each_head(node: ast.ForEach, printer: Printer) -> Iterator[Fragment]:
    """Print `for each place in lab, dock`: marks, as no phrase is looked for in it."""
    word = printer.vocabulary.word
    values = ", ".join(printer.plain_value(text, node.kind) for text in node.values)
    yield mark(
        f"{word('each')} {spell_key(node.key, printer.vocabulary)} {_each_in(node, printer.vocabulary)} {values}"
    )


def _each_in(node: ast.ForEach, vocabulary: Lexicon) -> str:
    """Return the words before the values; before one thing none that describe it, as `for each cup in kitchen`
    would.
    """
    if len(node.values) > 1 or node.kind == PLACE or node.kind not in WORLD:
        return vocabulary.word("each_in")
    describing = vocabulary.values.modifiers.starts
    ways = (words for words in vocabulary.roles["each_in"] if words.split()[0] not in describing)
    return next(ways, vocabulary.word("each_in"))


def fill_form(form: Form, values: Mapping[str, str]) -> Iterator[str]:
    """Yield the words of a form with values in its slots."""
    return (values[part.name] if isinstance(part, Slot) else part for part in form)


def spell_key(key: str, vocabulary: Lexicon) -> str:
    """Return the key of a value as words; as one word if it holds one that would end the name."""
    ends = {
        phrase.split()[0] for role in ("set_to", "by", "remember_as", "each_in") for phrase in vocabulary.roles[role]
    }
    return key if ends.intersection(key.split("_")) else key.replace("_", " ").strip()


def definition(node: ast.Definition, parts: list[Doc], printer: Printer) -> Doc:
    """Print a definition with the strong word, which no other word of the line can overrule."""
    return Doc((*definition_head(node, printer), parts[0].fragments), THEN)


def definition_head(node: ast.Definition, printer: Printer) -> tuple[Fragment, Fragment]:
    """Return the name and the word that defines."""
    name = quote(node.name, printer.vocabulary) if node.is_quoted else node.name
    return mark(name), mark(printer.word("define_strong").text)


def fact(node: ast.Fact, _parts: list[Doc], printer: Printer) -> Doc:
    x, y = (mark(format_number(metres)) for metres in (node.x, node.y))
    place = (mark(node.name), mark(printer.word("fact").text), mark(OPEN), x, mark(COMMA), y, mark(CLOSE))
    if node.facing is None:
        return Doc(place, THEN)
    angle = value_of(format_number(node.facing), printer.vocabulary.types["angle"], printer.vocabulary)
    return Doc((*place, mark(printer.word("facing").text), mark(angle)), THEN)


def include(node: ast.Include, _parts: list[Doc], printer: Printer) -> Doc:
    return Doc((mark(printer.vocabulary.word("include")), mark(f'"{node.path}"')), THEN)


def _unread(text: str) -> Doc:
    """Print words that no phrase of the vocabulary is looked for in."""
    return Doc((mark(text),), WHOLE)


PRINTERS: dict[type[ast.Ast], Callable[[Any, list[Doc], Printer], Doc]] = {
    ast.Phrase: phrase,
    ast.Name: _name,
    ast.Compared: compared,
    ast.Assign: assign,
    ast.Remember: remember,
    ast.ForEach: for_each,
    ast.Chain: _chain,
    ast.AtLeast: _at_least,
    ast.Not: _not,
    ast.If: _branching("if", "unless"),
    ast.While: _branching("while", "until"),
    ast.Whenever: _whenever,
    ast.Provided: _provided,
    ast.Named: _named,
    ast.IfWorks: _if_works,
    ast.StopWhen: _stop_when,
    ast.Repeat: _repeat,
    ast.Retry: _retry,
    ast.Try: _try,
    ast.Within: _timed("within"),
    ast.For: _timed("for"),
    ast.UpTo: _timed("up_to"),
    ast.Every: _paced("every"),
    ast.Apart: _paced("apart"),
    ast.Delay: _timed("delay"),
    ast.Constrained: _constrained,
    ast.Wait: _wait,
    ast.Held: _held,
    ast.WaitUntil: _wait_until,
    ast.WaitTime: _wait_time,
    ast.UntilTime: _until_time,
    ast.ByTime: _by_time,
    ast.Check: _test("check"),
    ast.WaitForever: _single("wait_forever"),
    ast.Nothing: _single("nothing"),
    ast.Fail: _single("fail"),
    ast.Exact: exact,
    ast.Definition: definition,
    ast.Fact: fact,
    ast.Include: include,
}
