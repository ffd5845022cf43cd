"""Words that make a standing rule: `always stop when C`, `if A, B, then carry on`, `patrol, and whenever C, A`."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.frontends.mission.token import (
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    WAITING,
    Called,
    Token,
    run_start,
    statement_start,
    texts_of,
)
from btlang.frontends.mission.tokens.rules_inside import ON_WAY, TIMES, any_lasts
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.frontends.mission.tokens.settling import FAILS
from btlang.frontends.mission.tokens.silent_words import BEGINS
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.vocabulary.references import ALL, choice_of
from btlang.vocabulary.word_tree import find

_DONE = frozenset(("command", "name", "wait", "wait_time", "condition", "close"))
_PLAIN = frozenset(
    (*_DONE, *JOINTS, *WAITING, *WAITING.values(), "open", "or", "up_to", "count", "wait_up_to", "repeat")
)
"""The kinds of tokens of a statement in which no rule is for a part alone."""


class RuleWords(SentenceReader):
    """Those of one text."""

    _lasting = -1
    """Where `always` stands that was read last."""

    def aside(self, at: int) -> int:
        """`whenever A, interrupt, B, then continue`: what a standing rule does by itself.

        With these words `if A` beside other statements is a rule, too.
        """
        tokens, words = self._tokens, self._text.words
        interrupting, resuming = self._vocabulary.asides
        if words[at] not in interrupting and words[at] not in resuming:
            return 0  # as nearly always
        first = statement_start(tokens, len(tokens))
        first = next((i for i in range(first, len(tokens)) if tokens[i].kind in (*RULES, "if")), first)
        found = find(resuming, words, at)
        if found is not None and (end := self._go_on(first, at, found[1])):
            return end
        if not tokens or tokens[first].kind not in (*RULES, "if"):
            return 0
        if found is not None and self._is_end(found[1]) and any(token.kind in _DONE for token in tokens[first + 2 :]):
            while tokens[-1].kind in JOINTS:
                tokens.pop()
            if self._is_in_round(first, words[at : found[1]]):
                return found[1]
            is_last = all(word in (END_OF_STATEMENT, END_OF_TEXT) for word in words[found[1] :])
            if not is_last or any(token.kind in ("command", "name") for token in tokens[:first]):
                self._watch(tokens[first])
            return found[1]
        found = find(interrupting, words, at) if tokens[-1].kind == "comma" else None
        if found is None or tokens[-2].kind != "condition":
            return 0
        self._watch(tokens[first])
        behind = found[1] + (words[found[1]] == ",")
        joint = self._phrase(behind)
        if joint is not None and joint.meaning.role in ("and", "then"):
            return joint.last
        return behind if behind > found[1] else 0

    def _is_in_round(self, first: int, said: Sequence[str]) -> bool:
        """`go to each room. If C, A, then carry on with the next`: each time, so that the statement goes on."""
        tokens = self._tokens
        before = run_start(tokens, first, JOINTS | STATEMENT_ENDS)
        done = tokens[statement_start(tokens, before) : before]
        choices = [choice_of(text) for each in done if isinstance(each.value, Called) for text in texts_of(each.value)]
        is_round = any(choice is not None and choice.how == ALL for choice in choices)
        if not is_round or self._vocabulary.values.further.isdisjoint(said):
            return False
        here = tokens[first].start
        tokens[before:first] = [Token("comma", here, here), Token("and", here, here)]
        return True

    def _go_on(self, first: int, at: int, end: int) -> int:
        """`otherwise carry on`, `if that fails, skip it and go on`: nothing is done in place of what comes then."""
        tokens, text = self._tokens, self._text
        last = run_start(tokens, len(tokens), JOINTS)
        if not last or not (self._is_end(end) or text.words[end] in (",", *self._vocabulary.roles["and"])):
            return 0
        if tokens[last - 1].kind == "otherwise" or tokens[last - 1].value == FAILS:
            tokens.append(Token("nothing", text.starts[at], text.ends[end - 1]))
            return end
        is_branch = any(token.kind == "otherwise" or token.value == FAILS for token in tokens[first:last])
        if not is_branch or last == len(tokens) or not self._is_end(end):
            return 0
        del tokens[last:]
        return end

    def _watch(self, form: Token) -> None:
        """Makes `if` a standing rule."""
        if form.kind == "if":
            form.kind = "whenever"
            self._split_rule(self._tokens.index(form))

    def lasts(self, at: int) -> None:
        """`always stop when C`, `A, and always charge if C`: a rule of its own, from that word on."""
        forms = {phrase.split()[0] for phrase in self._vocabulary.roles["if"]}
        if not any(self._text.words[i] in forms for i in range(at, self._end_of_statement(at))):
            return
        tokens, start = self._tokens, self._text.starts[at]
        joint = run_start(tokens, len(tokens), JOINTS)
        if 0 < joint < len(tokens):
            tokens[joint:] = [Token("semi", start, start)]
        self._lasting = start

    def rule_of(self, form: Token) -> None:
        """Makes `if` a standing rule behind `always` in its statement."""
        first = statement_start(self._tokens, len(self._tokens))
        if form.kind == "if" and self._tokens[first].start >= self._lasting >= 0:
            if first == 0 or self._tokens[first - 1].start <= self._lasting:
                self._watch(form)

    def _any_time(self, end: int, role: str = "") -> int:
        """`if the battery is low at any time, A`: whenever it is."""
        for token in reversed(self._tokens):
            if token.kind in BEGINS and token.kind != "comma":
                break
            if token.kind == "if":
                self._watch(token)
                token.role = role
                return end
        return 0

    def _split_rule(self, last: int) -> None:
        """`patrol until noon, and whenever bumped, wave`: a rule of its own, where each command is done once.

        Also in `patrol, but wave whenever bumped`. Behind other statements, or a time, it holds while A is done.
        """
        tokens = self._tokens
        if last > 1 and tokens[last - 1].kind == "command" and tokens[last - 2].kind == "but":
            last -= 1
        joint = run_start(tokens, last, JOINTS | {"but"})
        first = statement_start(tokens, joint)
        before = tokens[first:joint]
        if before and any(token.kind in ("and", "but") for token in tokens[joint:last]):
            timed = before[0].kind in TIMES
            if all(token.kind in _PLAIN for token in before[timed:]):
                if tokens[last].kind == "whenever" and (timed or first) and any_lasts(before):
                    tokens[last].role = ON_WAY
                tokens[joint:last] = [Token("semi", tokens[joint].start, tokens[joint].start)]
