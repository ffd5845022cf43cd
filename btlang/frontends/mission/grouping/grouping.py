"""Grouping: one scan with a stack, like the matching of brackets, over raw tokens.

It decides all that needs look-ahead: where conditions end and which connectives join them, what each bare comma means,
which count, `for`, `until` or `while` closes an open `repeat` or `try`, who owns each `otherwise`, and which comma
widens. It also is the one judge of syntax: what it lets through, both parsers accept.

The scan alternates between two states: an operand must come, or something that follows an operand.
"""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.mission.grouping import constraints, lists, operands, operators, problems
from btlang.frontends.mission.grouping.conditions import CONDITION_FORMS, STARTS_OPERAND, after_condition
from btlang.frontends.mission.grouping.scan import Scan, Unit
from btlang.frontends.mission.token import CORRELATIVES, QUANTIFIERS, RULES, Token
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.vocabulary.language_tables import CONNECTIVES


class Grouped(Record):
    """The units of a text, the problems with its syntax, and the raw token (the end is one) at which each showed."""

    units: tuple[Unit, ...]
    problems: list[Diagnostic]
    failed_at: list[int]


def group(source: Source, raw: list[Token], conditions: set[str], word: Callable[[str], str] = str) -> Grouped:
    """Groups the raw tokens of a source.

    `conditions` are the defined names that stand for conditions; `word` gives the word of a role, for corrections.
    """
    scan = Scan(source, raw, conditions, word)
    while scan.at < len(scan.raw):
        token = scan.raw[scan.at]
        if scan.operand_due:
            _OPERAND.get(token.kind, problems.no_operand)(scan, token)
        elif scan.stack[-1].is_condition:
            after_condition(scan, token)
        elif scan.stack[-1].kind == "choice":
            lists.after_choice(scan, token)
        elif token.kind == "command" and constraints.behind(scan, token):
            continue
        elif scan.stack[-1].kind != "head" or not operands.after_head(scan, token):
            _OPERATOR.get(token.kind, problems.side_by_side)(scan, token)
    scan.units.append(Unit(None, tuple(scan.out)))
    return Grouped(tuple(scan.units), scan.problems, scan.failed_at)


_OPERAND: dict[str, Callable[[Scan, Token], None]] = {
    **dict.fromkeys(("command", "condition", "wait", "wait_time", "wait_forever", "nothing", "fail"), operands.operand),
    "unknown": operands.unknown,
    **dict.fromkeys(("if", "unless", "while", "until", "as_soon_as", "provided"), operands.form),
    **dict.fromkeys(("check", "wait_until", "wait_for", "wait_up_to"), operands.test),
    **dict.fromkeys(operands.SEPARATORS, operands.joined_block),
    **dict.fromkeys(
        ("repeat", "try", "if_possible", "retry", "every", "delay", "at", "every_day", "until_time", "each"),
        operands.loop,
    ),
    "label": operands.label,
    **dict.fromkeys(("for", "up_to", "within", "by_time"), operands.front_amount),
    **dict.fromkeys(("whenever", "first_time"), operands.rule),
    "not": operands.negation,
    "never": problems.prohibition,
    **dict.fromkeys(QUANTIFIERS, lists.quantifier),
    **dict.fromkeys(CORRELATIVES, lists.correlative),
    "one_of": lists.choice,
    "nor": lists.stray,
    "open": operands.open_bracket,
    **dict.fromkeys(("then", "and"), operands.leading_then),
    **dict.fromkeys(("do_that", "repeat_that", "following"), operands.do_block),
    **dict.fromkeys(("before", "after", "while_doing", "if_doing"), operands.fronted),
    **dict.fromkeys(("start_over", "everything"), operands.whole_block),
    "define": operands.definition,
}

_OPERATOR: dict[str, Callable[[Scan, Token], None]] = {
    **dict.fromkeys((*CONNECTIVES, "while_doing"), operators.connective),
    "stop": operators.stop,
    "but": operators.but,
    "again": operators.says_nothing,
    **dict.fromkeys(
        ("within", "by_time", "if_possible", "every", "delay", "at", "every_day", "up_to", "apart"), operators.postfix
    ),
    **dict.fromkeys(CONDITION_FORMS, operators.form_after),
    **dict.fromkeys(STARTS_OPERAND, problems.side_by_side),
    **dict.fromkeys(RULES, operators.rule_after),
    "in_parallel": operators.at_the_same_time,
    "nor": lists.stray,
    "held": problems.not_a_condition,
    "never": problems.without,
    **dict.fromkeys(("newline", "semi", "dedent", "end"), operators.end_statement),
    "repeat": operators.repeat_after,
    "comma": operators.comma,
    "otherwise": operators.otherwise,
    **dict.fromkeys(("count", "for", "until_time"), operators.amount_of_form),
    "close": operators.close_bracket,
    "colon": operators.colon,
}
