"""Why words could not be read: a value that does not fit its slot, a name that nobody knows, or an unknown phrase."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.explanations.fragments import explain_fragment
from btlang.frontends.mission.explanations.lacking import not_two, unreferred, untold, value_example
from btlang.frontends.mission.explanations.misfits import Misfit, misfits_of
from btlang.frontends.mission.explanations.mission_values import unknown_value
from btlang.frontends.mission.explanations.nameless import KIND_NAMES, near_names, unknown_place, unnamed
from btlang.frontends.mission.explanations.nearest_phrases import nearest_phrases
from btlang.frontends.mission.explanations.roles import explain_role
from btlang.frontends.mission.explanations.spelling_rule import is_respelling
from btlang.frontends.mission.explanations.suggestions import defined, examples, heard, nearest_known
from btlang.frontends.mission.explanations.times import explain_time, without_hour
from btlang.frontends.mission.symbols.definitions import Definitions
from btlang.frontends.mission.symbols.nodes import misread_form, misread_node
from btlang.frontends.mission.token import (
    CORRELATIVES,
    QUANTIFIERS,
    Called,
    Listed,
    Token,
    arguments_of,
    asks_once,
    drives,
    run_start,
)
from btlang.text.formatting import joined
from btlang.text.source import Span
from btlang.text.spelling import nearest
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon
from btlang.vocabulary.node_words import BEHIND_ID, near_commands, role_end
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import PLACE, WORLD, ValueType, with_unit
from btlang.vocabulary.word_tree import SLOTS, find

_BEFORE_TIMES = ("until", "wait_until", "before", "after")
_LIST = "list of names"
"""What a word in the plural needs before it."""
_NOT_A_VALUE = frozenset((END_OF_TEXT, END_OF_STATEMENT, ",", ":", "(", ")"))


def explain_unknown(
    text: Words,
    at: int,
    end: int,
    vocabulary: Lexicon,
    context: ReadingContext,
    definitions: Definitions,
    before: list[Token],
) -> Diagnostic:
    """The diagnostic for words `at` to `end`, which nothing known matches.

    It is one of BT010 to BT014, BT019, BT038, BT152, BT154 and BT160. `context` is that of the lexer, with pronouns.
    """
    brace = next((i for i in range(at, end) if text.words[i] == "{" and context.named(text, i) == (None, i + 1)), None)
    if brace is not None:
        last = next((i for i in range(brace, end) if text.words[i] == "}"), brace)
        name = " ".join(text.words[brace + 1 : last])
        return unknown_value(text.span(brace, last + 1), name, context.known or (), vocabulary)
    lacking = untold(text, at, end, vocabulary) or not_two(text, at, end, vocabulary)
    lacking = lacking or unreferred(text, at, vocabulary, context) or without_hour(text, at, end, vocabulary)
    if lacking is not None:
        return lacking
    roots = (vocabulary.trie, definitions.trie)
    start, misfits = at, list(misfits_of(text, at, roots, context))
    asks = _asks(before) and text.words[at][0].isalpha()  # `wave until foo` lacks no duration
    if before and before[-1].kind not in ("comma", "newline", "indent", "dedent", "open", "semi") and not asks:
        phrase = bisect_left(text.starts, before[-1].start)  # `move forward 5 s`: read that far, and no further
        longer = [found for found in misfits_of(text, phrase, roots, context) if found.at >= at]
        if longer and (not misfits or longer[0].at >= misfits[0].at):
            start, misfits = phrase, longer
    names_fit = any(context.types[misfit.kind].kind == "names" for misfit in misfits)
    untaken = explain_role(text, at, end, before, vocabulary, context) if not names_fit else None
    if untaken is not None:
        return untaken
    if misfits:
        return _misfit(text, start, end, misfits, vocabulary, context, definitions, before)
    time = explain_time(text, at, bool(before) and before[-1].kind in _BEFORE_TIMES, vocabulary)
    if time is not None:
        return time
    number = vocabulary.values.number(text, at)
    for _, kind, child in vocabulary.trie.get(SLOTS, ()):
        is_measured = vocabulary.types[kind].kind != "names"
        if number is not None and is_measured and text.words[number[1]] in child:  # `0 times`
            return _number_misfit(text, at, number, [vocabulary.types[kind]], "", "", kind, vocabulary)
    if (number is not None and not _asks(before)) or text.words[at][0] == '"':
        return diagnostic("BT019", text.span(at, end), example='say "hello"')
    goes_on = bool(before) and before[-1].kind == "command" and _ends_in_a_bare_text(before[-1])  # `say still here`
    journey = vocabulary.asking["journey"]
    is_new = text.words[at] == journey[-1] and context.read(PLACE, text, at + 1) is None
    if is_new and at + 1 < end and _journey_before(before):
        understood = f"I understood '{' '.join(journey)} ...'. "
        return unnamed(text.span(at + 1, end), [vocabulary.types[PLACE]], understood, vocabulary)
    part = None if goes_on else explain_fragment(text, at, end, _asks(before), vocabulary, context)
    return part or _unknown_phrase(text, at, end, vocabulary, definitions, before)


def _journey_before(before: list[Token]) -> bool:
    """Whether the latest command drives somewhere: `go to the lab, then to the attic`."""
    said = next((token for token in reversed(before) if token.kind == "command"), None)
    return said is not None and drives(said.value)


def _misfit(
    text: Words,
    first: int,
    end: int,
    misfits: list[Misfit],
    vocabulary: Lexicon,
    context: ReadingContext,
    definitions: Definitions,
    before: Sequence[Token],
) -> Diagnostic:
    at = misfits[0].at
    types = [vocabulary.types[misfit.kind] for misfit in misfits]
    names = [KIND_NAMES.get(kind.name, kind.name.replace("_", " ")) for kind in types]
    wanted = joined([f"{_article(name)} {name}" for name in names], "or")
    head = text.span(first, at).text
    example = f"{head} {value_example(types[0], vocabulary)} {misfits[0].ending}".rstrip()
    if text.words[at] == "(" and end > at and any(kind.name == PLACE for kind in types):
        point = vocabulary.values.point_text("3", "4", "90")
        return diagnostic("BT036", text.span(at, end), example=f"{head} {point}")
    if text.words[at] in _NOT_A_VALUE or _is_connective(text, at, vocabulary):
        return diagnostic("BT012", text.span(first, at), words=head, wanted=wanted, example=example)
    mentioned = context.named(text, at)
    if mentioned is not None and mentioned[0] is not None:
        return _wrong_type(text.span(at, mentioned[1]), mentioned[0], wanted)
    quantity = vocabulary.values.quantity(text, at, [kind.name for kind in types])
    number = vocabulary.values.number(text, at)
    time = explain_time(text, at, quantity is None and any(kind.kind == "time" for kind in types), vocabulary)
    if time is not None:
        return time
    if quantity is not None:
        span = text.span(at, quantity[2])
        if quantity[1] in (kind.name for kind in types):
            least = vocabulary.types[quantity[1]].least or 0
            wanted = f"{_article(quantity[1])} {quantity[1]} is at least {least:g}"
            return diagnostic("BT014", span, words=span.text, wanted=wanted)
        reason = f"it is {_article(quantity[1])} {quantity[1]}, and {wanted} is needed"
        return diagnostic("BT011", span, words=span.text, wanted=reason, example=example)
    if number is not None:
        return _number_misfit(text, at, number, types, head, example, wanted, vocabulary)
    named = [kind for kind in types if kind.kind == "names"]
    following = frozenset().union(*(misfit.following for misfit in misfits))
    span = text.span(at, next((i for i in range(at + 1, end) if text.words[i] in following), max(end, at + 1)))
    pronoun = find(vocabulary.values.pronoun_words, text.words, at) if named else None
    if pronoun is not None:
        meant = vocabulary.values.pronouns[pronoun[0]]
        fitting = [kind for kind in named if kind.name in meant]
        if not fitting and any(kind in context.latest for kind in meant):  # `from her`, where a day could stand
            return _unknown_phrase(text, first, max(end, at + 1), vocabulary, definitions, [])
        named = fitting or [vocabulary.types[kind] for kind in meant]
        is_plural = pronoun[0] in vocabulary.values.plural_pronouns
        said = is_plural and any(kind.name in context.latest for kind in named)
        kinds = _LIST if said else joined([kind.name for kind in named], "or")
        return diagnostic(
            "BT038",
            text.span(at, pronoun[1]),
            words=pronoun[0],
            type=kinds,
            example=value_example(named[0], vocabulary),
        )
    if named and not any(kind.name in WORLD for kind in named):
        place = unknown_place(text, at, end, vocabulary)
        if place is not None:
            return place
    if named:
        return unnamed(span, named, f"I understood '{head} ...'. " if at > first else "", vocabulary)
    if text.words[at][0] != '"':  # `turn leftt` lacks no angle
        before = [token for token in before if token.start < text.starts[first]]
        part = explain_fragment(text, first, end, _asks(before), vocabulary, context)
        return part or _unknown_phrase(text, first, max(end, at + 1), vocabulary, definitions, before)
    return diagnostic("BT011", span, words=span.text, wanted=f"{wanted} is needed", example=example)


def _listed(text: Words, at: int, before: Sequence[Token], vocabulary: Lexicon) -> ValueType | None:
    """What one more thing of a list is: `visit the lab and the attic`."""
    last = run_start(before, len(before), ("and", "or", "comma"))
    said = before[last - 1].value if 0 < last < len(before) and at in text.articles else None
    if not isinstance(said, Called | Listed) or not arguments_of(said)[-1]:
        return None
    kind = said.entry.slot(arguments_of(said)[-1][-1][0]).type
    return vocabulary.types[kind] if kind in WORLD else None


def _wrong_type(span: Span, known: Known, wanted: str) -> Diagnostic:
    return diagnostic("BT044", span, name=" ".join(known.words), kind=known.kinds[0], wanted=wanted)


def _is_connective(text: Words, at: int, vocabulary: Lexicon) -> bool:
    match = longest(vocabulary.trie, text, at, vocabulary.context)
    return match is not None and match.meaning.entry is None and not match.values


def _number_misfit(
    text: Words,
    at: int,
    number: tuple[float, int],
    types: list[ValueType],
    head: str,
    example: str,
    wanted: str,
    vocabulary: Lexicon,
) -> Diagnostic:
    span = text.span(at, number[1])
    measured = next((kind for kind in types if kind.kind == "quantity"), None)
    if measured is not None:
        units = [word for unit in measured.units for word in unit.words]
        written = text.words[number[1]]
        misspelt = [unit for unit in nearest(written, units)[:1] if is_respelling(written, unit, vocabulary)]
        if (
            not misspelt
            and written.isalpha()
            and written not in _NOT_A_VALUE
            and not _is_connective(text, number[1], vocabulary)
        ):
            said = text.span(at, number[1] + 1)
            reason = f"{wanted} is needed, and '{written}' is no unit of it"
            return diagnostic("BT011", said, words=said.text, wanted=reason, example=f"{head} {measured.example}")
        unit = misspelt[0] if misspelt else units[0]
        value = with_unit(span.text, unit)
        reason = f"{wanted} has a unit"
        fix = (text.span(at, number[1] + len(misspelt)), value)
        return diagnostic("BT011", span, fix=fix, words=span.text, wanted=reason, example=f"{head} {value}")
    limited = next((kind for kind in types if kind.whole or kind.least is not None), None)
    if limited is not None:
        least = f" from {limited.least:g} on" if limited.least is not None else ""
        reason = f"a {'whole ' if limited.whole else ''}number{least} is needed"
        return diagnostic("BT014", span, words=span.text, wanted=reason)
    return diagnostic("BT011", span, words=span.text, wanted=f"{wanted} is needed", example=example)


def _ends_in_a_bare_text(command: Token) -> bool:
    value = command.value
    return (
        isinstance(value, Called) and bool(value.arguments) and value.entry.slot(value.arguments[-1][0]).type == "text"
    )


def _unknown_phrase(
    text: Words, at: int, end: int, vocabulary: Lexicon, definitions: Definitions, before: Sequence[Token]
) -> Diagnostic:
    span = text.span(at, end)
    start = Span(text.source, before[-1].start, before[-1].end) if before else span
    may_say = bool(before) and before[-1].kind in ("command", "condition")  # `until Bob says you can go`
    verb, _, word = start.text.rpartition(" ")  # none in the second text of `until I say yes or five minutes are gone`
    if may_say and verb and _ends_in_a_bare_text(before[-1]) and word[-1].isalnum():
        is_thing = at - 1 in text.articles  # `show the visitors around`: no words to say
        gap = "" if span.text[:1] == "'" else " "  # of `it's ok`
        quoted = f'{verb} "{word}{gap}{span.text}"'
        advice = f"A text of more than one word needs quotes: {quoted}"
        whole = Span(text.source, start.start, span.end)
        fix = None if is_thing else (whole, quoted)
        return diagnostic("BT010", span, fix=fix, kind="word", words=span.text, help=advice)
    kind = "condition" if _asks(before) else "command"
    unknown_home = next((i for i in range(at, end) if text.words[i] in vocabulary.asking["home"]), None)
    if unknown_home is not None:  # `go home`
        places = vocabulary.values.said_names(PLACE) if PLACE in vocabulary.types else []
        advice = "".join(f'A line of the world file says which place it is: home = "{place}"' for place in places[:1])
        home = text.span(unknown_home, unknown_home + 1)
        return diagnostic("BT013", home, type=PLACE, words=home.text, help=advice or near_names([], places))
    is_node = text.words[at] in (phrase for role in NODE_ROLES for phrase in vocabulary.roles[role])
    meant = longest(vocabulary.trie, text, at + 1, vocabulary.context) if is_node else None
    is_phrase = meant is not None and meant.meaning.entry is not None
    if meant is not None and is_phrase and not role_end(text, meant.last, BEHIND_ID, vocabulary):  # `do wave`
        rest = text.span(at + 1, meant.last).text
        whole = text.span(at, meant.last)
        return diagnostic("BT010", whole, fix=(whole, rest), kind=kind, words=whole.text, help=nearest_known([rest]))
    form = misread_form(text, at, vocabulary) if kind == "command" else None
    if form is not None:
        near_form = nearest_known(form[1])
        return diagnostic("BT010", form[0], fix=(form[0], form[1][0]), kind=kind, words=form[0].text, help=near_form)
    names = [header.name for header in definitions.headers.values()]
    written = f" {' '.join(text.words[at:end])} "
    is_lower = span.text[1:] == span.text[1:].lower()
    near_node = near_commands(text.words[at + 1 : end], vocabulary) if is_node and is_lower else []
    if near_node and near_node[0] not in vocabulary.nodes.values():  # `do wavee`
        return diagnostic("BT010", span, fix=(span, near_node[0]), kind=kind, words=span.text,
                          help=nearest_known(near_node[:3]))  # fmt: skip
    if is_node and at + 1 < end and at + 1 in text.articles and not any(f" {name} " in written for name in names):
        name = text.span(at + 1, end)  # `do the round`
        advice = f"To give commands this name, write them in a line of their own: {name.text} is ..."
        return diagnostic("BT010", name, kind="name", words=name.text, help=advice)
    node = misread_node(text, at, vocabulary) if is_node else None
    if node is not None:
        advice = f"A node by its id: {' or '.join(node[1])}"
        return diagnostic("BT010", node[0], fix=(node[0], node[1][0]), kind="node", words=node[0].text, help=advice)
    listed = _listed(text, at, before, vocabulary)
    if listed is not None:
        return unnamed(span, [listed], "", vocabulary)
    inside = [(name, end - at) for name in names if f" {name} " in written]
    near = dict(inside) | dict(nearest_phrases(tuple(text.words[at:end]), vocabulary, tuple(names))) | dict(inside)
    # what is wrong stands behind a phrase that begins as it is written
    near = {one: words for one, words in near.items() if not written.startswith(f" {one.partition(' {')[0]} ")}
    is_asked = kind == "condition"
    further = heard(text, at, end, vocabulary) if is_asked else defined(text, at, end, before, vocabulary)
    if not near:  # a value alone, in a list or where the other words are left out: `if Allice or Bob is near`
        values = [name for kind in WORLD if kind in vocabulary.types for name in vocabulary.values.said_names(kind)]
        word = text.words[at]
        near_values = nearest(word, values) if word.isalpha() else []
        words_of = ((one, one.lower().split()) for one in near_values)
        value = [one for one, said in words_of
                 if word not in said and any(is_respelling(word, of, vocabulary) for of in said)]  # fmt: skip
        fix = (text.span(at, at + 1), value[0]) if value else None
        advice = nearest_known(value) if value else examples(vocabulary, kind)
        unknown = diagnostic("BT010", span, fix=fix, kind=kind, words=span.text, help=advice)
        return unknown if value or not further else unknown.advising(further)
    likely, words = next(iter(near.items()))
    meant_start = likely.partition(" {")[0]
    pairs = zip(text.words[at:end], meant_start.lower().split(), strict=False)
    is_misspelt = all(one == other or is_respelling(one, other, vocabulary) for one, other in pairs)
    fix = (text.span(at, min(at + words, end)), meant_start)
    unknown = diagnostic("BT010", span, fix=fix, kind=kind, words=span.text, help=nearest_known(near))
    return unknown if is_misspelt or not further else unknown.advising(further)


_ASKING = frozenset((
    "if", "unless", "whenever", "first_time", "as_soon_as", "while", "until", "check", "wait_until", "condition",
    *QUANTIFIERS,
))  # fmt: skip
_BEFORE_ANY = frozenset(("not", "open", "and", "or", "nor", *CORRELATIVES))


def _asks(before: Sequence[Token]) -> bool:
    """Whether a condition belongs after these tokens."""
    kinds = [token.kind for token in before if token.kind not in _BEFORE_ANY]
    return kinds[-1:] != [] and (kinds[-1] in _ASKING or (kinds[-1] == "once" and asks_once(before, len(before) - 1)))


def _article(word: str) -> str:
    return "an" if word[0] in "aeiou" else "a"
