"""Answers that are counted: `ask every guest "Tea?", then tell Bob how many said yes`."""

from __future__ import annotations

from btlang.frontends.mission.token import Assigned, Called, Listed, Token, statement_start
from btlang.frontends.mission.tokens.sentence_reader import is_question
from btlang.frontends.mission.tokens.visitors import question_to_set
from btlang.tree.answers import ANSWERED
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import PERSON, number_type

COUNTED = "counted answers"
"""The role of a command that says how many have given an answer: under the key that it says, the answer's `value`."""


def with_counted_answers(tokens: list[Token], vocabulary: Lexicon) -> None:
    """Count the answers behind the question before each such command; its key is 0 before that."""
    number, entry = number_type(vocabulary.types), vocabulary.entry(ANSWERED)
    for at in reversed([at for at, token in enumerate(tokens) if token.role.startswith(COUNTED)]):
        _, answer, key = tokens[at].role.split("|")
        asked = next((each for each in reversed(range(at)) if is_question(tokens[each])), -1)
        question = tokens[asked].value
        if asked < 0 or entry is None or not isinstance(question, Called | Listed):
            continue
        if tokens[at - 1].kind == "and":
            tokens[at - 1].kind = "then"  # behind the last round
        tokens[asked].value = question_to_set(question, PERSON)
        here, first = tokens[asked].end, statement_start(tokens, asked)
        begin = tokens[first].start
        said = Called(entry, ((entry.slots[0].name, answer),))
        front, more = (Token(kind, here, here) for kind in ("and", "comma"))
        form = [Token("open", here, here), Token("if", here, here), Token("condition", here, here, said), more]
        counts = Token("command", here, here, Assigned(key, "increase", number, "1"))
        tokens[asked + 1 : asked + 1] = [front, *form, counts, Token("close", here, here)]
        none = Token("command", begin, begin, Assigned(key, "set", number, "0"))
        tokens[first:first] = [none, Token("semi", begin, begin)]
