"""Rules that are said of people: `wave at everyone who comes near`, `greet everybody you meet`."""

from __future__ import annotations

from btlang.frontends.mission.token import JOINTS, STATEMENT_ENDS, Called, Token, run_start, statement_start
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.frontends.mission.tokens.settling import STAYS
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of, words_of
from btlang.text.words import END_OF_TEXT
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import PERSON

_SIMPLE = frozenset(("command", "name", "wait", "wait_time", "for", "until_time", "count", *JOINTS))


class Visitors(SentenceReader):
    """Those of one text."""

    def read(self, at: int) -> int:
        """`say hi to anyone who comes near`: whenever somebody comes near, say hi to them.

        Behind other commands it is a rule of the mission only where nothing follows them.
        """
        tokens = self._tokens
        event, said = self._event(at), tokens[-1].value if tokens else None
        if event is None or not isinstance(said, Called):
            return 0
        last = event.last
        if not self._is_end(last):  # `greet everyone who comes in with "Hello"`
            whole = self._partial.in_order([*words_of(self._text, tokens[-1]), *rest_of(self._text, last)])
            if whole is None or whole.meaning.entry is not said.entry or whole.last <= last:
                return 0
            said, last = self._calls.token(whole, at).value, whole.last
        if not isinstance(said, Called) or not self._is_end(last):
            return 0
        everyone = next((text for name, text in said.arguments if said.entry.slot(name).type == PERSON), "")
        choice = choice_of(everyone)
        first = statement_start(tokens, len(tokens))
        joint = run_start(tokens, len(tokens) - 1, JOINTS)
        is_plain = all(token.kind in _SIMPLE for token in tokens[first:])
        if choice is None or choice.parts or not is_plain:
            return 0
        if joint > first and any(word != END_OF_TEXT for word in self._text.words[last + 1 :]):
            return 0  # `stay here until noon and wave at everyone who comes near. Then dock`
        self._calls.note_nearest()
        nearest = self._context.latest[PERSON]
        start, end = tokens[-1].start, self._text.ends[last - 1]
        condition = self._calls.token(event, at)
        condition.kind = "condition"
        arguments = tuple((name, nearest if text == everyone else text) for name, text in said.arguments)
        command = Token("command", start, end, said.replace(arguments=arguments))
        before = run_start(tokens, first, STATEMENT_ENDS)
        if joint <= first and 0 < before < first and tokens[before - 1].kind == "command":
            tokens[before - 1].role = STAYS  # `go to the door. Say hi to everyone who comes in`
        ends = [Token("semi", start, start)] if joint > first else []
        tokens[joint if joint > first else first :] = [
            *ends, Token("whenever", start, start), condition, Token("comma", end, end), command,
        ]  # fmt: skip
        return last

    def _event(self, at: int) -> Match | None:
        """What somebody does who is spoken of: `who comes near`, `you meet`."""
        text, asking = self._text, self._vocabulary.asking
        somebody = next(iter(asking["somebody"]), "")
        if text.words[at] in asking["who"] and text.words[at + 1] in asking["events"]:
            places, other = [at, *rest_of(text, at + 1)], {0: somebody}
        elif text.words[at] in self._vocabulary.subjects and text.words[at + 1] in asking["events"]:
            places, other = [at, at + 1, at + 1], {2: somebody}
        else:
            return None
        found = match_of(text, places, other, (self._vocabulary.trie,), self._context)
        is_event = found is not None and found.meaning.role == "condition"
        return relocated(found, places) if found is not None and is_event else None
