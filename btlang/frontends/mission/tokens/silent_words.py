"""Words that say nothing in one place: `until you go to`, `go through the hall to get to the lab`, `but B first`."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from btlang.frontends.mission.token import (
    JOINTS,
    LINES,
    RULES,
    STATEMENT_ENDS,
    Called,
    Token,
    constraint_of,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.settling import STAYS, first_word
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import PERSON, PLACE
from btlang.vocabulary.word_tree import find

MARKS = {",": "comma", ";": "semi", ":": "colon", "(": "open", ")": "close"}
"""The raw kinds of marks."""
_COME = "ComeToMe"
_GONE_FOR = frozenset(("command", "wait_at", "wait", "wait_until", "wait_for", "wait_up_to", "wait_forever"))
"""The roles of what is done where one goes for it: `go wait in the lab`."""
_STAYS_BEFORE = (",", ";", ")", END_OF_STATEMENT, END_OF_TEXT)
_DONE = ("command", "name")
_PLAIN = frozenset(("command", "wait", "count", "every", "every_day", "weekly", "on_days", "at", *JOINTS))
_OPERANDS = frozenset(("command", "name", "close", "and", "comma"))
BEGINS = frozenset(("newline", "semi", "indent", "dedent", "open", "define", "colon", "comma", "then"))
"""Behind these a statement, or an item of a list, begins."""


def begins(tokens: Sequence[Token]) -> bool:
    """Whether a statement begins at the word behind these tokens, out of brackets."""
    return not tokens or tokens[-1].kind in LINES


def begins_item(tokens: Sequence[Token]) -> bool:
    """The same, or an item of a list or bracket."""
    return not tokens or tokens[-1].kind in BEGINS


def begins_question(tokens: Sequence[Token], has_word: bool) -> bool:
    """Whether a question may begin behind these tokens; one that `has_word` of its own may be joined, too."""
    return begins(tokens) or (has_word and tokens[-1].kind in ("comma", "then", "and"))


def after_politeness(tokens: list[Token], words: Sequence[str], match: Match) -> int:
    """Politeness is left out with the comma beside it: `Robot, go home, please`. Returns where to go on."""
    if tokens and tokens[-1].kind == "comma" and words[match.last] in (",", ";", ")", END_OF_TEXT):
        tokens.pop()
    elif words[match.last] == "," and (not tokens or tokens[-1].kind not in ("command", "name", "condition")):
        return match.last + 1
    return match.last


def without_meaning(
    tokens: list[Token],
    text: Words,
    match: Match | None,
    role: str,
    at: int,
    vocabulary: Lexicon,
    context: ReadingContext,
) -> int:
    """The word behind those at a place that say nothing behind these tokens, 0 if there are none.

    What a command is for goes on as `then` would, and as `and` behind a constraint. `first` moves `but B` to the front.
    """
    staying = find(vocabulary.staying, text.words, at)
    if staying is not None and text.words[staying[1]] in (*_STAYS_BEFORE, *vocabulary.roles["and"]):
        tokens.append(Token("nothing", text.starts[at], text.ends[staying[1] - 1], role=STAYS))
        return staying[1]
    if text.words[at] in vocabulary.asking["waiting"] and text.words[at + 1] in (END_OF_STATEMENT, END_OF_TEXT):
        tokens.append(Token("nothing", text.starts[at], text.ends[at], role=STAYS))  # what follows says how long
        return at + 1
    going = find(vocabulary.going, text.words, at)
    if going is not None and going[1] not in text.articles:
        follows = longest(vocabulary.trie, text, going[1], context)
        is_command = follows is not None and follows.meaning.role in _GONE_FOR
        if follows is not None and follows.meaning.role == "check":
            asked = longest(vocabulary.trie, text, follows.last, context)
            is_command = asked is None or asked.meaning.entry is None  # but `go check that C` asks there
        joins = text.words[going[1] - 1] in vocabulary.roles["and"]
        if is_command or (joins and follows is None) or find(vocabulary.telling, text.words, going[1]) is not None:
            begin, end = text.starts[at], text.ends[going[1] - 1]
            if text.words[at] in vocabulary.asking["coming"] and not _goes(follows):
                here = vocabulary.entry(_COME)
                joint = text.starts[going[1] - 1] if joins else end
                said = Token("command", begin, text.ends[at], Called(here, ())) if here else None
                tokens += [said, Token("and", joint, end)] if said else []
            return going[1]  # `go charge`
    if not tokens:
        return 0
    before = tokens[-1]
    if text.words[at] in vocabulary.asking["apiece"]:
        follows = longest(vocabulary.trie, text, at + 1, context)
        if before.kind == "count" or (follows is not None and follows.meaning.role == "count"):
            return at + 1  # `visit the lab and the hall, each twice`: both, twice
    if before.kind in ("check", "while") and text.words[at] in vocabulary.subjects:
        follows = longest(vocabulary.trie, text, at + 1, context)
        if follows is not None and follows.meaning.role == "command":
            if before.kind == "check":
                tokens.pop()  # `make sure that you wave`
            else:
                before.kind = "while_doing"  # `while you wave`
            return at + 1
        if before.kind == "while" and text.words[at + 1] in vocabulary.asking["asking_be"]:
            return at + 2  # `while you are waving`
    if before.kind in ("until", "before") and text.words[at] in vocabulary.subjects:
        return at + 1
    is_behind = match is not None and role == "ordinal" and before.kind in (*_DONE, "count")
    if match is not None and is_behind and text.words[at] not in vocabulary.asking["foremost"]:
        return match.last  # `charge at the end`
    if role == "ordinal" and match is not None and before.kind in ("command", "but", "for"):
        start = next((token for token in reversed(tokens) if token.kind in BEGINS or token.kind == "but"), before)
        pairs = pairwise(tokens[statement_start(tokens, len(tokens)) :])
        start = next((but for but, form in pairs if (but.kind, form.kind) == ("but", "if")), start)
        start.value = "first" if start.kind == "but" else start.value
        follows = longest(vocabulary.trie, text, match.last, context)
        is_behind = len(tokens) > 2 and tokens[-2].kind in JOINTS and tokens[-3].kind in _OPERANDS
        is_last = text.words[match.last] in (",", ";", END_OF_TEXT, END_OF_STATEMENT) and not is_behind
        role = follows.meaning.role if follows is not None and follows.meaning.entry is None else ""
        goes_on = role in ("then", "and") or (bool(role) and not is_behind and not does_before(tokens))
        is_end = all(word in (END_OF_STATEMENT, END_OF_TEXT) for word in text.words[match.last :])
        if start.kind == "but" or goes_on or (is_last and not (is_end and does_before(tokens))):
            return match.last
        form = statement_start(tokens, len(tokens))
        if tokens[form].kind in ("if", *RULES) and (not is_end or _goes_before(tokens, form, text, vocabulary)):
            return match.last  # `if C, go to the dock and charge first. Then A`
        return 0
    throughout = find(vocabulary.throughout, text.words, at)
    if throughout is not None and constraint_of(before) is not None:
        return throughout[1]  # `avoid the hall at all times`
    purpose = find(vocabulary.purpose, text.words, at) if before.kind == "command" else None
    causing = vocabulary.asking["causing"]
    if purpose is None or purpose[1] in text.articles or first_word(before, text.source) in causing:
        return 0  # `wait for Bob to pick up the cup`: he does that
    if longest(vocabulary.trie, text, purpose[1], context) is not None:
        kind = "and" if constraint_of(before) is not None else "then"
        tokens.append(Token(kind, text.starts[at], text.ends[purpose[1] - 1]))
        return purpose[1]
    return 0


def _goes_before(tokens: Sequence[Token], form: int, text: Words, vocabulary: Lexicon) -> bool:
    """Make `A. If C, B first` the same as `A, but if C, B first`, where nothing comes before A."""
    end, condition = run_start(tokens, form, STATEMENT_ENDS), tokens[form + 1]
    if tokens[form].kind in RULES or end + 1 != form or any(each.kind not in _PLAIN for each in tokens[:end]):
        return False
    if vocabulary.says_event(text.source.text[condition.start : condition.end]):
        return False
    if all(each.kind != "unknown" for each in tokens[form:]):  # which is told by itself
        tokens[end].kind, tokens[end].value = "but", "first"
    return True


def does_before(tokens: Sequence[Token]) -> bool:
    """Whether statements with commands come before the one that is read: `go to the lab. Charge first`."""
    last = next((at for at in reversed(range(len(tokens))) if tokens[at].kind in STATEMENT_ENDS), 0)
    return any(token.kind in _DONE for token in tokens[:last])


def _goes(match: Match | None) -> bool:
    """Whether a command drives to where it is done, or to whom it is about: no `come` before it says anything then."""
    if match is None or match.meaning.role != "command" or match.meaning.entry is None:
        return False
    return TRAVELS in match.meaning.entry.needs or any(value.type in (PERSON, PLACE) for value in match.values)


def verb_forms(text: Words, vocabulary: Lexicon) -> set[str]:
    """The words of a text that end as forms of verbs do: `going`, and `waves` where somebody is the subject."""
    endings = tuple(vocabulary.doing)
    if not text.distinct.isdisjoint(vocabulary.asking["subject"]):
        endings += tuple(vocabulary.third_person)
    return {word for word in text.distinct if word.endswith(endings)}
