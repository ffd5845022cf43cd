"""Commands that depend on what somebody answers: `ask Alice "Tea?". If so, A`, `wait until she says stop`."""

from __future__ import annotations

from functools import cached_property

from btlang.frontends.mission.token import Called, Listed, Token
from btlang.frontends.mission.tokens.addressed_texts import AddressedTexts
from btlang.tree.asked import ANSWERED, ASK
from btlang.vocabulary.value_type import PERSON, TEXT
from btlang.vocabulary.word_tree import find

_PERSON_SAYS, _SOMEBODY_SAYS = "PersonSays", "SomebodySays"
_STOPS = frozenset(("semi", "newline"))


class Answers(AddressedTexts):
    """Those of one text."""

    def _if(self, condition: Token, is_so: bool) -> None:
        """Begins a command that is done if a condition is so, or isn't."""
        start, end = condition.start, condition.end
        self._tokens.append(Token("if", start, start))
        if not is_so:
            self._tokens.append(Token("not", start, start))
        self._tokens += [condition, Token("comma", end, end)]

    def reply(self, at: int, role: str) -> int:
        """`ask Alice "Tea?". If so, A`: a command that depends on the answer, not on whether there was one."""
        found = find(self._vocabulary.replies, self._text.words, at)
        entry = self._vocabulary.entry(ANSWERED) if found is not None and self._may_ask else None
        if found is None or entry is None or not self._is_asked(right_before=role == "otherwise"):
            return 0
        start, end = self._text.starts[at], self._text.ends[found[1] - 1]
        yes = Called(entry, ((entry.slots[0].name, self._vocabulary.asking["answers"][0]),))
        self._if(Token("condition", start, end, yes), found[0])
        return found[1] + (self._text.words[found[1]] == ",")

    def said(self, token: Token, at: int) -> None:
        """`wait until she says stop` where nobody is asked: what is heard, not an answer."""
        value = token.value
        if not isinstance(value, Called) or value.entry.id != ANSWERED or self._may_ask:
            return
        if find(self._vocabulary.values.pronoun_words, self._text.words, at) is None:
            return
        words, person = value.arguments[0][1], self._context.latest.get(PERSON, "")
        heard = self._vocabulary.entry(_PERSON_SAYS if person else _SOMEBODY_SAYS)
        if heard is not None:
            by_type = {PERSON: person, TEXT: words}
            token.value = Called(heard, tuple((slot.name, by_type[slot.type]) for slot in heard.slots))

    @cached_property
    def _may_ask(self) -> bool:
        """Whether anybody may be asked in the text."""
        asking = {phrase.split()[0] for entry in self._vocabulary.entries.get(ASK, ()) for phrase in entry.phrases}
        return not asking.isdisjoint(self._text.distinct)

    def _is_asked(self, right_before: bool) -> bool:
        """Whether the statement before asks, or depends on the answer: `ask "Tea?". If so, A. If he wants none, B`."""
        tokens, last = self._tokens, len(self._tokens)
        while last:
            if tokens[last - 1].kind in _STOPS:
                last -= 1
                continue
            first = last
            while first and tokens[first - 1].kind not in _STOPS:
                first -= 1
            values = [token.value for token in tokens[first:last] if isinstance(token.value, Called | Listed)]
            if tokens[last - 1].kind == "command" and values and values[-1].entry.id == ASK:
                return True
            if right_before or tokens[first].kind != "if" or not values or values[0].entry.id != ANSWERED:
                return False
            last = first
        return False
