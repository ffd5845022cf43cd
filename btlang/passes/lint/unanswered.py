"""Lint BT253: questions that end the mission, or a rule for good, where nobody answers them.

- `ask Bob "Tea?". If he says yes, A. If he says no, B`: a question without an answer fails, and so does the mission;
- `whenever somebody is near, ask them "Tea?"`: a rule whose reaction fails once is over.

Only a mission that depends on the answer is reported, and only where silence takes something from it: there is another
answer, or more commands or rounds stand behind. Rounds without end have a note of their own (BT175).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.unlikely_meanings import goes_on
from btlang.support.record import Record
from btlang.tree import ast
from btlang.tree.answers import ASK, UNANSWERED, asking_verbs, asks
from btlang.tree.visit import fold
from btlang.vocabulary.capabilities import HEARS
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

_ENDLESS = "-1"
_LAST_ONLY = ("fallback", "any")
"""The chains that only fail if their last part does."""
_ONE_BY_ONE = (ast.Chain, ast.Whenever, ast.Every, ast.Named)
"""The forms behind whose commands a further sentence goes on."""
_ROUNDS = (ast.Repeat, ast.ForEach, ast.Every, ast.Apart, ast.For)


class Silent(Record):
    """A question whose failure nothing handles, the last command that depends on its answer, and what is around it.

    `is_open`: a sentence about the answer can follow that command. `retry` asks more than once, and then fails.
    `loses`: something else isn't done without an answer.
    """

    question: ast.Phrase
    reply: ast.If | None = None
    rule: ast.Whenever | None = None
    retry: ast.Retry | None = None
    is_open: bool = True
    loses: bool = False


_Found: TypeAlias = "tuple[Silent, ...]"


def find_unanswered(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report each question once: the failing mission where something depends on the answer, the rule in any case."""
    vocabulary = compilation.vocabulary
    waiting = {id for id in compilation.ids if _waits_for_people(id, vocabulary)}
    if not waiting:
        return  # as nearly always
    named: dict[str, _Found] = {}
    in_rules: dict[int, Silent] = {}

    def combine(node: ast.Ast, done: Sequence[_Found]) -> _Found:
        """Return the questions of a node that make it fail."""
        if isinstance(node, ast.Phrase):
            return (Silent(node),) if node.entry.id in waiting and node.entry.sort == "action" else ()
        if isinstance(node, ast.Name):
            return named.get(node.name, ())
        found = _failing(node, done)
        if isinstance(node, ast.Whenever):
            found = tuple(each.replace(rule=node) for each in found)
            in_rules.update((id(each.question), each) for each in found)
        return found

    for definition in compilation.ordered:
        named[definition.name] = fold(definition.body, ast.parts, combine)
    body = compilation.mission.body
    failing = {} if body is None else {id(each.question): each for each in fold(body, ast.parts, combine)}
    for key, silent in {**failing, **in_rules}.items():
        is_lost = silent.reply is not None and silent.loses and silent.question.entry.id == ASK
        if silent.rule is not None or is_lost:
            yield _note(silent, key in failing, vocabulary)


def _waits_for_people(id: str, vocabulary: Lexicon) -> bool:
    """Whether a leaf is a question, or a command that fails if nobody speaks."""
    return id == ASK or any(HEARS in each.needs and each.sort == "action" for each in vocabulary.entries.get(id, ()))


def _failing(node: ast.Ast, done: Sequence[_Found]) -> _Found:
    """Return the questions that make a form fail, of those that make its parts fail."""
    if not any(done):
        return ()
    if isinstance(node, ast.Try | ast.IfWorks):
        done = done[1:]
    elif isinstance(node, ast.Chain) and node.operator in _LAST_ONLY:
        done = done[-1:]
    elif _never_fails(node):
        return ()
    elif isinstance(node, ast.Chain):
        return _with_replies(node, done)
    found = tuple(each for part in done for each in part)
    if isinstance(node, ast.Retry):
        return tuple(each.replace(retry=node) for each in found)
    if isinstance(node, _ONE_BY_ONE):
        return found
    repeats = isinstance(node, _ROUNDS)
    return tuple(
        each.replace(is_open=each.is_open and not _is_in_line(node, each), loses=each.loses or repeats)
        for each in found
    )


def _never_fails(node: ast.Ast) -> bool:
    """Whether a form doesn't end in silence, does so by a rule of its own, or has a note of its own."""
    if isinstance(node, ast.Every | ast.Repeat | ast.UntilTime):
        return goes_on(node)
    return isinstance(node, ast.Exact) or (isinstance(node, ast.Retry) and node.attempts == _ENDLESS)


def _is_in_line(node: ast.Ast, silent: Silent) -> bool:
    """Whether a form holds a question and what depends on the answer, and no line of its own begins between."""
    text, asked = node.span.source.text, silent.question.span
    return silent.reply is not None and (
        asked.source is not node.span.source or "\n" not in text[node.span.start : asked.start]
    )


def _with_replies(chain: ast.Chain, done: Sequence[_Found]) -> _Found:
    """Return the questions of a chain, the latest one with each command that depends on its answer."""
    found: list[Silent] = []
    latest, is_next = 0, False  # where the questions begin that are asked last; whether nothing else stands behind them
    for item, own in zip(chain.items, done, strict=True):
        is_reply = isinstance(item, ast.If) and asks(item.condition)
        if isinstance(item, ast.If) and is_reply:
            is_next &= item.condition.span.start < item.body.span.start and not asks(item, (ASK,))
            found = [_with_reply(each, item, at >= latest, is_next) for at, each in enumerate(found)]
        elif chain.operator == "sequence" and not isinstance(item, ast.Whenever):
            found = [each.replace(loses=True) for each in found]
            is_next = False
        if own or asks(item, (ASK,)):
            latest, is_next = len(found), not is_reply
            found += own
    return tuple(found)


def _with_reply(silent: Silent, reply: ast.If, is_latest: bool, is_open: bool) -> Silent:
    """Return a question with a command that depends on its answer, or on that of a later one."""
    if not is_latest:
        return silent.replace(loses=True)  # type: ignore[no-any-return]
    return silent.replace(reply=reply, is_open=is_open, loses=silent.loses or silent.reply is not None)  # type: ignore[no-any-return]


def _note(silent: Silent, is_failing: bool, vocabulary: Lexicon) -> Diagnostic:
    """Make BT253 with what ends, and what to write so that it doesn't."""
    question, rule, retry = silent.question.span, silent.rule, silent.retry
    ends = "the mission fails here"
    if rule is not None:
        ends = "the rule ends for good, and the mission fails" if is_failing else "the rule ends for good"
    behind, tried = "", _tried(silent, vocabulary)
    if retry is not None:
        behind = f"write: {retry.span.text}. {vocabulary.word('if_fails').capitalize()}, ..."
    elif silent.reply is not None and silent.is_open:
        silence = _silence(silent.reply, vocabulary)
        behind = f"add behind the answers: {silence}, ..." if silence else ""
    ways = [f"To say what is done then, {behind}"] if behind else []
    if retry is None and (rule is not None or not ways):
        ways.append(f"To {'go on' if rule is None else 'keep the rule'} in any case, write: {tried}")
    does = "answers" if silent.question.entry.id == ASK else "speaks"
    note = diagnostic("BT253", question, does=does, ends=ends, advice=ways[0], help="".join(ways[1:]))
    is_whole = len(ways) > 1 or not behind
    return note.replace(readings=((question, tried),) if is_whole and "..." not in tried else ())  # type: ignore[no-any-return]


def _tried(silent: Silent, vocabulary: Lexicon) -> str:
    """Return the words of a question behind a try: `try to ask Bob "Tea?"`. Those that are a rule by themselves have
    none: `ask everyone who comes "Tea?"`.
    """
    question, rule = silent.question, silent.rule
    word = next((words for words in vocabulary.roles["try"] if " " in words), vocabulary.word("try"))
    said = question.span.text
    if rule is not None and rule.span == question.span:
        return f"{vocabulary.word('whenever')} ..., {word} ..."
    is_verb = question.entry.id != ASK or said.split()[0].lower() in asking_verbs(vocabulary)
    return f"{word} {said[:1].lower()}{said[1:]}" if is_verb and "\n" not in said else f"{word} ..."


def _silence(reply: ast.If, vocabulary: Lexicon) -> str:
    """Return the words for an answer that doesn't come, about whom the reply names: `If he doesn't answer`."""
    entry = vocabulary.entry(UNANSWERED)
    if entry is None:
        return ""
    who = reply.condition.span.text.split()[0].lower()
    patterns = ([words.split("/") for words in phrase.split()] for phrase in entry.phrases)
    said = next(
        (" ".join([who, *(each[0] for each in rest)]) for first, *rest in patterns if who in first), entry.example
    )
    return f"{vocabulary.word('if').capitalize()} {said}"
