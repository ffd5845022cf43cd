"""Words about the order of commands: `once you get to the lab, A`, `A when you arrive`, `on the way to the lab, A`.

An arrival goes on as `then` would. A journey behind `on the way to` or `from` becomes a command of its own.
"""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    FORMS,
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    WAITING,
    Called,
    Listed,
    Token,
    constraint_of,
    drives,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.clock_words import ClockWords
from btlang.frontends.mission.tokens.journey_words import JourneyWords
from btlang.frontends.mission.tokens.replaced_commands import INSTEAD
from btlang.frontends.mission.tokens.sentence_reader import leads_to
from btlang.frontends.mission.tokens.settling import FAILS, MEASURES
from btlang.frontends.mission.tokens.silent_words import BEGINS, does_before
from btlang.frontends.mission.tokens.way_words import WayWords
from btlang.frontends.mission.tokens.word_matches import words_of
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.vocabulary.entry import MANNER, THEME
from btlang.vocabulary.match import Match
from btlang.vocabulary.value_type import OBJECT, PERSON
from btlang.vocabulary.word_tree import find

_REPEATED = frozenset(("every", "every_day", "whenever"))
BEFORE_ASIDE = JOINTS | {"otherwise", "or"}
"""Raw kinds behind which words may say that the robot goes on with what it did."""


class OrderWords(ClockWords, JourneyWords, WayWords):
    """Those of one text."""

    def read(self, match: Match, at: int) -> int:
        """Reads the words of one of these roles, where they say something."""
        role = match.meaning.role
        if role == "start_at":
            return self._start(at, match.last)
        if role == "on_way_to":
            return self._on_way_to(at, match.last)
        if role == "on_way":
            return self._on_way(at, match.last)
        if role == "wait_at":
            return self._wait_at(match, at)
        if role == "any_time":
            return self._any_time(match.last)
        if role in ("weekly", "on_days"):
            return self._weekly(match, at)
        if role == "instead":
            return self._instead(match, at)
        if role == "received":
            return self._received(match, at)
        if role == "between_times":
            return self._between(match, at)
        if role == "rounds_of":
            return self._so_many(match, at, "journey")
        if role == "pictures_of":
            return self._so_many(match, at, "picturing")
        return self._back_and_forth(at, match.last) if role == "back_and_forth" else self._arrival(match, at)

    def _arrival(self, match: Match, at: int) -> int:
        """`when you arrive`: at the end of a statement it says nothing, before a command it says `then`."""
        tokens, end = self._tokens, match.last
        journey = self._journey()
        if journey is None or (match.values and not leads_to(journey, match.values[0].text)):
            return 0
        if self._may_be_left_out(journey):
            return 0  # `If bumped, go to the lab. When you arrive, wave` might wave without the journey
        if self._is_end(end):
            return end if tokens[-1].kind == "command" else 0
        while tokens[-1].kind in JOINTS:
            tokens.pop()
        if tokens[-1].kind not in ("command", "name", "close", *BEGINS):
            return 0
        tokens.append(Token("then", self._text.starts[at], self._text.ends[end - 1]))
        return self._behind_comma(end)

    def _received(self, match: Match, at: int) -> int:
        """`give Bob the cup. When he has it, wave`: then, right behind what somebody is given."""
        tokens, last = self._tokens, run_start(self._tokens, len(self._tokens), JOINTS | STATEMENT_ENDS) - 1
        said = tokens[last].value if last >= 0 else None
        types = {slot.type for slot in said.entry.slots} if isinstance(said, Called | Listed) else set()
        if not types.issuperset((OBJECT, PERSON)) or self._is_end(match.last) or self._may_be_left_out(tokens[last]):
            return 0
        while tokens[-1].kind in JOINTS:
            tokens.pop()
        tokens.append(Token("then", self._text.starts[at], self._text.ends[match.last - 1]))
        return self._behind_comma(match.last)

    def _may_be_left_out(self, journey: Token) -> bool:
        """Whether the journey is that of an earlier statement that doesn't always run, or runs beside the others."""
        at = self._tokens.index(journey)
        is_earlier = statement_start(self._tokens, len(self._tokens)) > at
        before = self._tokens[statement_start(self._tokens, at) : at]
        return is_earlier and any(token.kind in FORMS for token in before)

    def no_phrase(self, at: int) -> int:
        """What begins with words that are no phrase."""
        text = self._text
        return (
            self._go_and_see(at)
            or self._once_more(at)
            or self._start_of_leg(at)
            or self._pace(at)
            or self._journey_of_constraint(at)
            or self._wait_for(at)
            or self._faces(at)
            or self._put_back(at)
            or self._manner(at)
            or self._back(at)
            or (self._partial.add_third(at + 1, None) if text.words[at] in self._vocabulary.asking["subject"] else 0)
        )

    def _manner(self, at: int) -> int:
        """BT252 for `turn around really fast`: how it is done is left out of a command that is done in one way."""
        found, last = find(self._context.manners, self._text.words, at), len(self._tokens) - 1
        while last > 0 and self._tokens[last].kind in MEASURES:
            last -= 1
        value = self._tokens[last].value if last >= 0 else None
        if found is None or not isinstance(value, Called | Listed) or self._tokens[last].kind != "command":
            return 0
        if any(slot.type == MANNER for slot in value.entry.slots):
            return 0
        words, done = self._text.span(at, found[1]), self._tokens[last]
        verb = self._text.source.text[done.start : done.end]
        self._calls.problems.append(diagnostic("BT252", words, words=words.text, verb=verb))
        return found[1]

    def left_out(self, at: int) -> int:
        """`pick up all cups and bring them to the lab, except the red ones`: of the set in the statement."""
        tokens, first = self._tokens, statement_start(self._tokens, len(self._tokens))
        for token in tokens[first:] if self._vocabulary.values.exception(self._text, at) else ():
            value = token.value
            for name, group in value.arguments if isinstance(value, Called) else ():
                fewer = self._context.without(group, self._text, at)
                if isinstance(value, Called) and fewer is not None and fewer[0] and self._is_end(fewer[1]):
                    said = tuple((each, fewer[0] if each == name else text) for each, text in value.arguments)
                    token.value = value.replace(arguments=said)
                    del tokens[run_start(tokens, len(tokens), JOINTS) :]
                    return fewer[1]
        return 0

    def connect(self, role: str) -> None:
        """What the words that were read last, of a role, are where they stand."""
        if role == "start_over":
            self._start_over()
        elif role in RULES:
            self._split_rule(len(self._tokens) - 1)
        elif role in WAITING:
            self._waits(role)
            self._until()
        elif role == "held" and len(self._tokens) > 1 and self._tokens[-2].kind == "command":
            words = self._text.source.text[self._tokens[-1].start : self._tokens[-1].end].lower()
            if any(least in words for least in self._vocabulary.asking["at_least"]):
                self._tokens[-1].kind = "for"  # `charge for at least an hour`

    def _waits(self, role: str) -> None:
        """`stand at the door until noon`: goes there, then waits until then."""
        tokens, text = self._tokens, self._text
        if len(tokens) > 1 and tokens[-2].kind == "command":
            verb = text.words[words_of(text, tokens[-2]).start]
            if verb in self._vocabulary.asking["standing_verbs"]:
                tokens[-1].kind = WAITING[role]
                tokens.insert(-1, Token("then", tokens[-1].start, tokens[-1].start))

    def _start_over(self) -> None:
        """`A, B and start over`: as a sentence of its own, unless the commands before may be left out."""
        tokens, last = self._tokens, len(self._tokens) - 1
        first = run_start(tokens, last, JOINTS)
        kinds = {token.kind for token in tokens[statement_start(tokens, first) : first]}
        if first < last and kinds and FORMS.isdisjoint(kinds) and kinds.isdisjoint(("repeat", "colon")):
            tokens[first:last] = [Token("semi", tokens[first].start, tokens[first].start)]

    def is_doing(self, at: int) -> bool:
        """Whether the form of a verb stands at a word: `keep going back and forth`."""
        match = self._phrase(at)
        again = match is not None and match.meaning.role == "back_and_forth"
        return again or self._partial.doing(at) is not None

    def until_none(self, at: int) -> int:
        """`pick up the cups until none are left`: all of them, whatever is behind."""
        if self._text.words[at] not in self._vocabulary.until_none:
            return 0  # as nearly always
        found = find(self._vocabulary.until_none, self._text.words, at)
        return found[1] if found is not None and self._tokens and self._calls.is_set(self._tokens[-1]) else 0

    def says_nothing(self, match: Match, at: int) -> bool:
        """Whether words begin nothing: `say bye when that's done`, `take all cups away, one after the other`.

        `afterwards` says nothing at the end, either, nor does `each time` where something is done again and again.
        """
        if match.meaning.role == "whenever":
            first = statement_start(self._tokens, len(self._tokens))
            is_repeated = any(token.kind in _REPEATED for token in self._tokens[first:])
            return is_repeated and (self._is_end(match.last) or self._text.words[match.last] == ",")
        if match.meaning.role == "following":
            is_behind = bool(self._tokens) and self._tokens[-1].kind in ("command", "comma")
            return is_behind and (self._is_end(match.last) or self._text.words[match.last] == ",")
        tokens, words, roles = self._tokens, self._text.words, self._vocabulary.roles
        if not tokens or tokens[-1].kind not in ("command", "name", "wait", "close"):
            return False
        behind = self._phrase(self._behind_comma(match.last))
        joins = behind is not None and behind.meaning.role in ("and", "then") and words[at] not in roles["and"]
        ends = self._is_end(match.last) or joins
        if words[at] in (*self._vocabulary.asked_once, *roles["once"]):
            return ends
        opening = (at for at in range(len(tokens) - 1, -1, -1) if tokens[at].kind == "open")
        before = (next(opening, 0) if tokens[-1].kind == "close" else len(tokens) - 1) - 1
        is_later = ends and before >= 0 and tokens[before].kind in (*JOINTS, "semi", "newline")
        if is_later and tokens[before].kind == "and":  # `go to the lab and wave afterwards`
            tokens[before].kind = "then"
        return is_later

    def note_late(self, at: int, first: int) -> None:
        """BT151 for `go to the lab. First open the door` at the end: before that, or then."""
        words, tokens, then = self._text.words, self._tokens, self._vocabulary.word("then")
        if words[at] not in self._vocabulary.asking["foremost"] or not does_before(tokens):
            return
        last = next(i for i in range(first, len(words)) if words[i] in (END_OF_STATEMENT, END_OF_TEXT))
        goes_on = any(word not in (END_OF_STATEMENT, END_OF_TEXT) for word in words[last:])
        if goes_on or not {*self._vocabulary.roles["then"]}.isdisjoint(words[first:last]):
            return  # `first A, then B`, `First A. Second B`
        begin = statement_start(tokens, run_start(tokens, len(tokens), STATEMENT_ENDS))
        before = self._text.source.text[tokens[begin].start : self._text.starts[at]].strip(" .;\n")
        span, done = self._text.span(at, last), self._text.span(first, last).text
        one, other = f"{done}, {then} {before}", f"{before}, {then} {done}"
        self._calls.problems.append(diagnostic("BT151", span, words=span.text, one=one, other=other))

    def _instead(self, match: Match, at: int) -> int:
        """`otherwise wave instead`; elsewhere it is open what isn't done."""
        if not self._tokens:
            return match.last
        self._with_rest_of_tried()
        before = self._tokens[statement_start(self._tokens, len(self._tokens)) :]
        settled = next((token for token in before if token.kind == "otherwise" and token.value == FAILS), None)
        if settled is not None:  # `find Alice and wave. If you can't find her, find Bob instead`: and wave?
            said = self._text.source.text[settled.end : self._text.starts[at]].strip(" ,")
            span = self._text.span(at, match.last)
            one, other = f"{said}, {self._vocabulary.word('then')} ...", said
            self._calls.problems.append(diagnostic("BT151", span, words=span.text, one=one, other=other))
            return match.last
        if before and not any(token.kind in ("otherwise", "or") for token in before):
            self._tokens[-1].role = INSTEAD
        return match.last

    def _with_rest_of_tried(self) -> None:
        """Complete a command in place of one with the same verb: `bring it to Bob. Otherwise bring the book instead`.

        What it doesn't say is as it was in the command that failed.
        """
        tokens, said = self._tokens, self._tokens[-1].value
        form = next((at for at in reversed(range(len(tokens))) if tokens[at].kind in ("or", "otherwise")), 0)
        last = run_start(tokens, form, JOINTS | STATEMENT_ENDS | MEASURES) - 1
        tried = tokens[last].value if last >= 0 and form < len(tokens) - 1 else None
        if not isinstance(said, Called) or not isinstance(tried, Called):
            return
        words = self._text.source.text[tokens[-1].start : tokens[-1].end].lower().split()
        themes, given = tried.entry.slots_of(THEME), dict(said.arguments)
        is_same_verb = any(
            words[: len(verb.split())] == verb.split() for verbs, _ in tried.entry.verbs for verb in verbs
        )
        if is_same_verb and given.keys() == themes:
            rest = tuple((name, text) for name, text in tried.arguments if name not in given)
            tokens[-1].value = Called(tried.entry, (*said.arguments, *rest))

    def _journey_of_constraint(self, at: int) -> int:
        """`avoid the hall until the lab`, `until you have been in the lab`: a constraint that a journey ends.

        `don't go through the hall towards the lab` is one for a journey.
        """
        tokens, text = self._tokens, self._text
        if tokens and text.words[at] in self._vocabulary.asking["towards"] and constraint_of(tokens[-1]) is not None:
            journey = self._with_front(at, at + 1, "journey")
            if journey is None:
                return 0
            tokens.append(Token("and", text.starts[at], text.ends[at]))
            self._partial.append(journey, at)
            return journey.last
        if len(tokens) < 2 or tokens[-1].kind not in ("until", "before") or constraint_of(tokens[-2]) is None:
            return 0
        been = find(self._vocabulary.been, text.words, at)
        journey = self._with_front(at, been[1] if been is not None else at, "journey")
        if journey is None:
            return 0
        self._partial.append(journey, at)
        return journey.last

    def _faces(self, at: int) -> int:
        """`turn left, facing the table`, `go to the lab facing the door`: faces it then."""
        tokens, words = self._tokens, self._text.words
        if words[at] not in self._vocabulary.roles["facing"]:
            return 0
        command = run_start(tokens, len(tokens), ("comma",))
        facing = (
            self._with_front(at, at + 1, "turning_to") if command and tokens[command - 1].kind == "command" else None
        )
        if facing is None or not drives(tokens[command - 1].value):
            return 0
        tokens[command:] = [Token("then", self._text.starts[at], self._text.starts[at])]
        self._partial.append(facing, at)
        return facing.last

    def _once_more(self, at: int) -> int:
        """`count the people, wave and count again`: the latest command with this verb."""
        again = self._phrase(at + 1)
        if again is None or again.meaning.role != "again":
            return 0
        text = self._text
        commands = (token for token in reversed(self._tokens) if token.kind == "command")
        said = next((each for each in commands if text.words[words_of(text, each).start] == text.words[at]), None)
        if said is None:
            return 0
        self._tokens.append(Token("command", text.starts[at], text.ends[again.last - 1], said.value))
        return again.last
