"""Answers: commands that depend on what somebody answers are put where that person is asked.

A command that depends on the answer and follows a form whose commands ask belongs to those commands: elsewhere it
would be asked where nobody has answered.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import TEXT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


ASK, ANSWERED, UNANSWERED = "Ask", "AnswerIs", "NobodyAnswered"
"""The ids of the question, and of the conditions about its answer."""
ANSWER = "Answer"
"""The id of the quantity that is the answer."""
PERSON_SAYS, SOMEBODY_SAYS = "PersonSays", "SomebodySays"
"""The ids of the conditions that are true for the moment in which something is said."""
SPEAKS = {PERSON_SAYS: "PersonSpeaks", SOMEBODY_SAYS: "SomebodySpeaks"}
"""The conditions of the same without certain words."""
_LAST_ONLY = "only the answer of who was asked last is known by then; go to each, ask them, and tell it then"
ABOUT_ANSWERS = frozenset((ANSWERED, UNANSWERED, "AnswerNumber"))
_ONCE = (
    ast.Retry, ast.Try, ast.Within, ast.ByTime, ast.UpTo, ast.StopWhen, ast.Constrained, ast.Delay, ast.Provided,
    ast.Named, ast.Chain,
)  # fmt: skip
"""Forms whose commands are done before what comes behind the form."""
EXAMPLE = 'ask Alice "Tea?". If so, wave'
KEEP_ASKING = 'keep asking Alice "Tea?" until she says yes'
OF_WHICH = "could be about the first question or about the second"


def asking_verbs(vocabulary: Lexicon) -> frozenset[str]:
    """Return the words with which somebody is asked."""
    return frozenset(phrase.split()[0] for entry in vocabulary.entries.get(ASK, ()) for phrase in entry.phrases)


def with_answers(mission: ast.Program) -> tuple[ast.Program, list[Diagnostic]]:
    """Return the mission with dependent commands where somebody asks, and what is wrong with it (BT144, BT049)."""
    problems: list[Diagnostic] = []

    def body(root: ast.Ast) -> ast.Ast:
        nodes = ast.parents_first(root)
        if any(map(_is_told, nodes)):
            problems.extend(told for node in nodes if isinstance(node, ast.Chain) for told in _lost_answers(node))
        if not any(_is_one(each, ABOUT_ANSWERS) for each in nodes):
            return root
        return fold(
            root, ast.parts, lambda node, done: _go_on(_gather(_ask_until(ast.with_parts(node, done)), problems))
        )

    def program(part: ast.Program) -> ast.Program:
        return ast.with_bodies(part, body, program)

    return program(mission), problems


def asks(node: ast.Ast, ids: Container[str] = ABOUT_ANSWERS) -> bool:
    """Whether a condition of these, by default one about an answer, is in a node."""
    return any(_is_one(each, ids) for each in ast.parents_first(node))


def _is_one(node: ast.Ast, ids: Container[str]) -> bool:
    return isinstance(node, ast.Phrase) and node.entry.id in ids


def _is_told(node: ast.Ast) -> bool:
    """Whether the answer is asked for, to say it."""
    return isinstance(node, ast.Remember) and node.entry.id == ANSWER


def _lost_answers(chain: ast.Chain) -> Iterator[Diagnostic]:
    """Yield BT049 for an answer that is asked for behind several questions, of which only the last one's is known."""
    for before, item in pairwise(chain.items) if chain.operator in ("sequence", "and") else ():
        is_several = isinstance(before, ast.ForEach) or (isinstance(before, ast.Chain) and ast.is_list(before))
        if _is_told(item) and is_several and asks(before, (ASK,)):
            yield diagnostic("BT049", item.span, words=item.span.text, reason=_LAST_ONLY)


def _depends(node: ast.Ast) -> bool:
    """Whether a command is done if the answer is this or that."""
    return isinstance(node, ast.If) and asks(node.condition)


def _ask_until(node: ast.Ast) -> ast.Ast:
    """Ask again after another answer, or after none: `ask Bob "Ready?" every minute until he says yes`."""
    if not (isinstance(node, ast.While) and node.negated and node.otherwise is None and asks(node.condition)):
        return node
    round_, pause = node.body, ""
    if isinstance(round_, ast.Every) and not round_.rounds:
        asked, pause = round_.body, round_.seconds
    else:
        asked = round_.body if isinstance(round_, ast.Repeat) and round_.rounds == "-1" else round_
    waits = isinstance(asked, ast.Chain) and all(isinstance(each, ast.Wait) for each in asked.items[:-1])
    parts = (
        asked.items if waits and isinstance(asked, ast.Chain) else (asked,)
    )  # `wait 5 min and ask her again until C`
    if not (isinstance(parts[-1], ast.Phrase) and parts[-1].entry.id == ASK):
        return node
    if _is_reply(node):
        asked = ast.Chain("sequence", (*parts, ast.Check(node.condition, node.condition.span)), True, node.span)
    elif not (isinstance(node.condition, ast.Not) and asks(node.condition, (UNANSWERED,))):  # `until he answers`
        return node
    return ast.Retry("-1", asked, pause, node.span)


def _gather(node: ast.Ast, problems: list[Diagnostic]) -> ast.Ast:
    """Return a sequence in which commands that depend on an answer stand where it is given."""
    if not isinstance(node, ast.Chain) or node.operator == "fallback" or not any(map(_depends, node.items)):
        return node
    made: list[ast.Ast] = []
    asking: int | None = None
    for item in node.items:
        if asking is not None and isinstance(item, ast.If) and _depends(item):
            behind = _behind_silence(made[asking], item)
            if behind is not None:
                made[asking] = behind
                continue
            is_anew = _asks_anew(made, asking)
            form = [] if is_anew else _form_that_asks(made[asking])
            problem = _problem(made, asking, form, item)
            if problem:
                words = item.span.text.split(",")[0]
                problems.append(diagnostic("BT144", item.span, words=words, problem=problem, example=EXAMPLE))
            elif form:
                made[asking] = _with_last(form, item)
                continue
            elif all(map(_depends, made[asking + 1 :])) and (item.otherwise is not None or item.negated):
                # silence is something else than what was asked for: `unless she says yes`, `otherwise`
                for at in range(asking - is_anew, asking + 1):
                    made[at] = _without_failure(made[at])
        _reply(made, asking, item)
        if _questions(item):
            asking = len(made) - 1
    return made[0] if len(made) == 1 else node.replace(items=tuple(made))


def _go_on(node: ast.Ast) -> ast.Ast:
    """Return a round in which who doesn't answer keeps nobody from being asked: `ask everyone "Tea?". If so, A`."""
    body = node.body if isinstance(node, ast.ForEach) else None
    if not isinstance(node, ast.ForEach) or not isinstance(body, ast.Chain) or body.operator == "fallback":
        return node
    items = list(body.items)
    for at, (asked, reply) in enumerate(pairwise(body.items)):
        if isinstance(asked, ast.Phrase) and asked.entry.id == ASK and _depends(reply):
            items[at] = _without_failure(asked)
    return node.replace(body=body.replace(items=tuple(items)))  # type: ignore[no-any-return]


def _behind_silence(question: ast.Ast, item: ast.If) -> ast.Ast | None:
    """Put a reply that would hold in silence, too, behind what is done then: `if she doesn't answer, A. If not, B`."""
    if isinstance(question, ast.IfWorks) and _questions(question.tried):
        span = Span(item.span.source, question.body.span.start, item.span.end)
        body = ast.Chain("sequence", (question.body, item), True, span)
        return ast.IfWorks(question.tried, body, question.otherwise, question.span)
    if not (isinstance(question, ast.Chain) and question.operator == "fallback" and _holds_in_silence(item)):
        return None
    first, *others = question.items
    silent = others[0] if len(others) == 1 else question.replace(items=tuple(others))
    span = Span(item.span.source, question.span.start, item.span.end)
    return ast.IfWorks(first, item, silent, span) if _questions(first) else None


def _reply(items: list[ast.Ast], asking: int | None, item: ast.Ast) -> None:
    """Add a command to those behind a question, if there is one."""
    if asking is not None and isinstance(item, ast.If) and asks(item.condition, (UNANSWERED,)):
        items[asking:] = _with_silence(items[asking:], item)
        return
    if asking is not None and isinstance(item, ast.If) and item.otherwise is not None and _is_reply(item):
        while len(items) > asking + 1 and isinstance(item, ast.If) and _excludes(items[-1], item):
            before = items.pop()
            item = before.replace(otherwise=item, span=Span(item.span.source, before.span.start, item.span.end))
    items.append(item)


def _excludes(before: ast.Ast, item: ast.If) -> bool:
    """Whether an answer is another one than that of the command before: `otherwise` behind both is neither of them."""
    if not isinstance(before, ast.If) or before.otherwise is not None or not _is_reply(before):
        return False
    return not _questions(before.body) and before.condition != item.condition


def _is_reply(node: ast.If | ast.While) -> bool:
    """Whether the condition of a form is one answer, or that there is none."""
    asked = node.condition
    is_denied = isinstance(node, ast.If) and node.negated  # of a loop it is `until`
    return not is_denied and isinstance(asked, ast.Phrase) and asked.entry.id in ABOUT_ANSWERS


def _with_silence(items: Sequence[ast.Ast], item: ast.If) -> list[ast.Ast]:
    """Return a question and what follows, with a command that says what silence does: nobody has to answer then.

    `If so, A. If not, B. If she says nothing, C`: silence is no `not`.
    """
    asked, *others = items
    question = _without_failure(asked)
    excludes = any(isinstance(each, ast.If) and _holds_in_silence(each) for each in others)
    is_plain = isinstance(item.condition, ast.Phrase) and not item.negated and item.otherwise is None
    if not (excludes and is_plain and all(map(_depends, others))):
        return [question, *others, item]
    span = Span(item.span.source, others[0].span.start, others[-1].span.end)
    otherwise = others[0] if len(others) == 1 else ast.Chain("sequence", tuple(others), True, span)
    return [question, item.replace(otherwise=otherwise)]


def _without_failure(asked: ast.Ast) -> ast.Ast:
    """Return a command whose question may stay without an answer; what is done before it may still fail."""
    if isinstance(asked, ast.Try):
        return asked
    if not isinstance(asked, ast.Chain) or asked.operator == "fallback":
        return ast.Try(asked, None, asked.span)
    last = max(at for at, each in enumerate(asked.items) if _questions(each))
    items = [*asked.items[:last], _without_failure(asked.items[last]), *asked.items[last + 1 :]]
    made: ast.Chain = asked.replace(items=tuple(items))
    return made


def _holds_in_silence(node: ast.If) -> bool:
    """Whether a command that depends on an answer does something where there is none."""
    is_denied = any(isinstance(each, ast.Not) for each in ast.parents_first(node.condition))
    return node.negated or node.otherwise is not None or is_denied


def _questions(node: ast.Ast) -> list[ast.Phrase]:
    return [each for each in ast.parents_first(node) if isinstance(each, ast.Phrase) and each.entry.id == ASK]


def _question(node: ast.Phrase) -> str:
    """Return the text of a question."""
    types = {slot.name: slot.type for slot in node.entry.slots}
    return next((text for name, text in node.arguments if types.get(name) == TEXT), "")


def _form_that_asks(node: ast.Ast) -> list[Any]:
    """List the forms around the last question of a command, the outermost first; none if it is asked in any case."""
    path: list[Any] = []
    last = _questions(node)[-1]
    while node is not last:
        part = next(part for part in reversed(ast.parts(node)) if any(each is last for each in ast.parents_first(part)))
        path.append((node, part))
        node = part
    while path and isinstance(path[-1][0], _ONCE):
        path.pop()
    return path


def _asks_anew(made: Sequence[ast.Ast], at: int) -> bool:
    """Whether the question before is asked again and again while an answer is given, so that the latest one counts."""
    loop, before = made[at], _questions(made[at - 1]) if at else []
    repeats = isinstance(loop, ast.Repeat) and any(map(_depends, ast.parents_first(loop)))
    return repeats and bool(before) and {each.arguments for each in _questions(loop)} == {before[-1].arguments}


def _with_last(form: Sequence[Any], item: ast.Ast) -> ast.Ast:
    """Return the outermost of some forms, whose innermost has one more command at its end."""
    body = form[-1][1]
    items = body.items if isinstance(body, ast.Chain) and body.operator == "sequence" else (body,)
    made = list(items)
    _reply(made, max(at for at, each in enumerate(items) if _questions(each)), item)
    span = Span(body.span.source, body.span.start, item.span.end)
    changed: ast.Ast = ast.Chain("sequence", tuple(made), True, span)
    for node, part in reversed(form):
        parts = [changed if each is part else each for each in ast.parts(node)]
        changed = ast.with_parts(node, parts)
    return changed


def _problem(made: Sequence[ast.Ast], at: int, form: Sequence[Any], item: ast.Ast) -> str:
    """Return why it isn't clear whose answer is meant, "" if it is."""
    asked = _questions(made[at])
    before = _questions(made[at - 1]) if at and not form else []
    same = [each for each in (*before, *asked) if _question(each) == _question(asked[-1])]
    if len({each.arguments for each in same}) > 1 or any(isinstance(node, ast.ForEach) for node, _ in form):
        return "could be about one answer or about all"
    if not form:
        return ""
    inner = form[-1][0]
    text = item.span.source.text[made[at].span.end : item.span.start]
    sometimes = [node for node, _ in form if not isinstance(node, _ONCE)]
    is_last = all(part is ast.parts(node)[-1] for node, part in form if isinstance(node, ast.Chain))
    if getattr(inner, "otherwise", None) is not None or len(sometimes) > 1 or not is_last:
        several = len({each.arguments for each in asked}) > 1
        return "could be about several questions" if several else "is about a question that is asked only sometimes"
    if _depends(inner):
        return "" if _same(inner, item) else OF_WHICH
    return "stands on another line than what asks only sometimes" if "\n" in text else ""


def _same(one: Any, other: Any) -> bool:
    """Whether two commands depend on the same answer, which then is that of the second question."""
    plain = isinstance(one.condition, ast.Phrase) and isinstance(other.condition, ast.Phrase)
    return plain and not (one.negated or other.negated) and one.condition.arguments == other.condition.arguments
