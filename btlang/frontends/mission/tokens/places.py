"""Where a command is done: `go to the lab and wave there`, `wave in the kitchen`, `in every room, take a picture`."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    JOINTS,
    LINES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    arguments_of,
    constraint_of,
    drives,
    run_end,
    run_start,
    statement_start,
    texts_of,
    with_arguments,
    with_text,
)
from btlang.frontends.mission.tokens.repeated_statements import ELSEWHERE
from btlang.frontends.mission.tokens.searches_there import SearchesThere
from btlang.frontends.mission.tokens.sentence_reader import leads_to
from btlang.frontends.mission.tokens.silent_words import begins
from btlang.text.source import Span
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.references import ALL, NAMES, choice_of
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE
from btlang.vocabulary.word_tree import find

_HOLD, _PUT, _SEES = "Hold", "PutDown", "SeesSomeone"
_JOINS = ("and", "then", "or")
_TIMED = ("at", "every", "every_day", "weekly", "count", "within", "by_time", "until_time")
_BEHIND = (*_JOINS, *_TIMED, "if", "unless", "until")
"""Raw kinds that may stand behind where a command is done: `wave in the hall at 6 pm`."""
_AND = frozenset(("and", "comma"))
_ASKING = ("if", "unless", "check")
_COMMANDS = frozenset(("command", "name", "wait", "nothing"))
_DONE = ("command", "name", "close", "wait")
_HEADS = frozenset(("every", "every_day", "condition"))
"""The kinds of tokens behind which the commands of a form begin."""
_LASTING = frozenset(("for", "until_time", "every"))
"""The kinds of tokens that say how long a round goes on, and how often."""
_PLAIN = frozenset(("command", "name", "comma", "open", "close", *_JOINS))
"""The kinds of tokens of a statement that does each of its commands once."""


class Places(SearchesThere):
    """Those of one text."""

    def at_goal(self, at: int) -> int:
        """`go to the lab and wave there`, `visit every room and wave in each of them`: where the robot is by then."""
        tokens, text, context = self._tokens, self._text, self._context
        first = at + (text.words[at] in self._vocabulary.asking["located"])
        pronoun = find(context.values.pronoun_words, text.words, first)
        if pronoun is None or PLACE not in context.pronouns[pronoun[0]]:
            return 0
        journey = self._journey(tokens[:-1])
        said = tokens[-1].value
        if isinstance(said, Listed) and TRAVELS in said.entry.needs:
            return 0  # `go to the lab and the hall and greet everybody there`
        behind = self._phrase(pronoun[1])
        is_polite = behind is not None and behind.meaning.role == "politeness"  # `there, too`
        if journey is None or not (is_polite or self._is_end(pronoun[1]) or text.words[pronoun[1]] == ","):
            return 0
        is_plural = pronoun[0] in context.values.plural_pronouns
        is_list = isinstance(journey.value, Listed) and journey.value.joiner == "and"  # `go to A and B and wave there`
        if (is_plural or is_list) and PLACE not in context.listed and context.latest.get(PLACE, "{")[:1] != "{":
            stops = context.stops(text, at)  # `go to A, then to B, and wave in each`
            return pronoun[1] if stops and self._goes_there(stops, len(tokens) - 1) else 0
        goal = (
            context.listed[PLACE] if (is_plural or is_list) and PLACE in context.listed else context.latest.get(PLACE)
        )
        if not goal:
            return 0
        if self._calls.is_alternative(journey, goal):
            choices = map(choice_of, texts_of(said)) if isinstance(said, Called) else ()
            return 0 if any(choice is not None and choice.how == ALL for choice in choices) else pronoun[1]
        if goal[:1] == "{":
            count = tokens[tokens.index(journey) + 1]
            if count.kind == "count":
                return self._doubt_times(journey, count, pronoun[1])
            if tokens[-2].kind != "and" or not self._calls.is_round(journey, goal):
                return 0
            self._measure_round(tokens.index(journey))
        elif not leads_to(journey, goal):
            return 0
        return pronoun[1]

    def _measure_round(self, at: int) -> None:
        """Put what says how long behind what is done in each: `patrol A and B until 6 pm and wave in each`."""
        tokens = self._tokens
        last = run_end(tokens, at + 1, _LASTING)
        measures, here, end = tokens[at + 1 : last], tokens[at].start, tokens[-1].end
        if measures and len(tokens) == last + 2 and tokens[last].kind == "and":
            opening, closing = Token("open", here, here), Token("close", end, end)
            tokens[at:] = [opening, tokens[at], tokens[last], tokens[-1], closing, *measures]

    def _doubt_times(self, journey: Token, count: Token, end: int) -> int:
        """BT151 for `go to the lab and the hall twice and wave in each`: each time, or at the end."""
        text, word = self._text, self._vocabulary.word
        whole = Span(text.source, journey.start, text.ends[end - 1])
        said, times = (text.source.text[token.start : token.end] for token in (journey, count))
        rest = text.source.text[count.end : whole.end].strip(" ,")
        one = f"{word('repeat')} {times}: {said} {rest}"
        other = f"{said} {times}, {word('then')} {text.source.text[self._tokens[-1].start : self._tokens[-1].end]}"
        self._calls.problems.append(diagnostic("BT151", whole, words=whole.text, one=one, other=other))
        return end

    def behind(self, at: int) -> int:
        """`wave in the kitchen`: goes there first. Also to who speaks: `bring the cup to me in the kitchen`."""
        tokens = self._tokens
        speaker = self._vocabulary.values.role_words.speaker
        is_to_speaker = self._text.words[at - 1] in speaker
        journey = self._to(at)
        if journey is None and self._text.words[at] == self._vocabulary.asking["journey"][-1]:
            spoken = self._text.source.text[tokens[-1].start : tokens[-1].end].lower().split()
            is_to_speaker = not speaker.isdisjoint(spoken)  # `bring me the cup to the lab`
            journey = self._to(at, is_goal=True) if is_to_speaker else None
        value, is_wait = tokens[-1].value, tokens[-1].kind == "wait"
        if journey is None or not (is_wait or (isinstance(value, Called | Listed) and not constraint_of(tokens[-1]))):
            return 0
        following = self._phrase(journey.last)
        ends = self._is_end(journey.last) or self._text.words[journey.last] == ","
        if not ends and (following is None or following.meaning.role not in _BEHIND):
            return 0
        if isinstance(value, Called | Listed) and TRAVELS in value.entry.needs and not is_to_speaker:
            placed = self._placed(value, journey.values[0])
            if placed is None:
                return 0
            value = tokens[-1].value = placed
        if self._goes_there(_goal_of(journey), len(tokens) - 1):
            return journey.last
        if self._goes_round(journey, len(tokens) - 1):
            return journey.last
        if self._repeats(journey, len(tokens)):
            return 0
        said = tokens.pop()
        end = said.end = self._text.ends[journey.last - 1]
        tokens.append(Token("open", said.start, said.start))
        called = value if is_to_speaker and isinstance(value, Called) else None
        held = called.entry.given(OBJECT, called.arguments)[:1] if called is not None else []
        if hold := self._handling(_HOLD, held, said.start):
            tokens += [hold, Token("and", said.start, said.start)]
            choice = choice_of(held[0])
            if choice is not None and called is not None:  # once it is held, it isn't where it was
                held = [f"{{{choice.key}}}"]
                said.value = with_arguments(called, [with_text(called.arguments, choice.text, held[0])])
        self._append_tour(journey, at)
        tokens[-1].start = said.start
        met = self._if_met(said, self._handling(_PUT, held, end)) if called is not None else [said]
        tokens += [Token("and", said.start, said.start), *met, Token("close", end, end)]
        return journey.last

    def _handling(self, node_id: str, held: Sequence[str], at: int) -> Token | None:
        """A command about what is held, None without one."""
        entry = self._vocabulary.entry(node_id) if held else None
        return Token("command", at, at, Called(entry, ((entry.slots[0].name, held[0]),))) if entry is not None else None

    def _if_met(self, said: Token, otherwise: Token | None) -> list[Token]:
        """`come to me in the lab`: to whoever is in view there; what was to be brought is put down for nobody."""
        seen, here, end = self._vocabulary.entry(_SEES), said.start, said.end
        if seen is None:
            return [said]
        made = [Token("open", here, here), Token("if", here, here), Token("condition", here, here, Called(seen, ()))]
        made += [Token("comma", here, here), said]
        if otherwise is not None:
            made += [Token("stop", end, end), Token("otherwise", end, end), otherwise]
        return [*made, Token("close", end, end)]

    def again_at(self, at: int) -> int:
        """`Do the same in the kitchen`: what was done, in another place."""
        journey = self._to(at)
        if journey is None or not (self._is_end(journey.last) or self._text.words[journey.last] == ","):
            return 0
        self._partial.append(journey, at)
        self._tokens[-1].role = ELSEWHERE
        return journey.last

    def _placed(self, said: Called | Listed, goal: SlotValue) -> Called | None:
        """`turn off the light in every room`: the one that is there; None where nothing shows what is in the rooms."""
        choice = choice_of(goal.group)
        if choice is None or not isinstance(said, Called):
            return None
        things = [name for name, _ in said.arguments if said.entry.slot(name).type == OBJECT]
        text = dict(said.arguments)[things[0]] if len(things) == 1 and len(said.arguments) == 1 else ""
        placed = self._context.inside(OBJECT, text, f"{{{choice.key}}}")
        return Called(said.entry, ((things[0], placed),)) if placed else None

    def in_place_of_command(self, match: Match, at: int) -> int:
        """A condition where a command stands: where one is done, or the rest of a command that leaves words out."""
        tokens = self._tokens
        if tokens and tokens[-1].kind in ("before", "after") and (done := self._partial.doing(at)) is not None:
            self._partial.append(done, at)
            return done.last  # `wave before charging`
        before = run_start(tokens, len(tokens), JOINTS)
        goes_on = 0 < before < len(tokens) and tokens[before - 1].kind in _DONE
        if (goes_on or begins(tokens)) and (end := self.before(at)):
            return end
        if goes_on and tokens[before - 1].kind == "command":  # `go to the kitchen and then in the lab`
            return self._partial.add_left_out(at, match.last)
        return self._partial.add_third(at + 1, None) if begins(tokens) else 0

    def before(self, at: int) -> int:
        """`in the kitchen, wave`: goes there first, unless it just did: `visit A and B. In each room, wave`."""
        journey = self._to(at)
        if journey is None:
            return 0
        behind = self._behind_comma(journey.last)
        following = self._phrase(behind)
        if following is not None and journey.values[0].group:
            self._doubt_round(at, behind, following)
        if self._goes_there(_goal_of(journey), len(self._tokens)):
            return behind
        role = following.meaning.role if following is not None else ""
        if role not in (*_COMMANDS, *_ASKING):
            return 0
        is_tour = any(value.group or value.more for value in journey.values)
        if role not in _ASKING and is_tour and not self._are_commands(behind):
            return 0  # `in every room, look around, then wave`
        if self._repeats(journey, run_start(self._tokens, len(self._tokens), LINES)):
            return 0
        self._append_tour(journey, at)
        end = self._text.ends[journey.last - 1]
        self._tokens.append(Token("and", end, end))
        return behind

    def _doubt_round(self, at: int, behind: int, command: Match) -> None:
        """BT151 for `in every room, turn off the light`: the one that is there, or one that may be anywhere."""
        entry, types = command.meaning.entry, [value.type for value in command.values]
        text, words = self._text, self._vocabulary
        if entry is None or entry.first or TRAVELS not in entry.needs or OBJECT not in types or PLACE in types:
            return
        if self._is_there(command.last):
            return
        said = text.span(at, command.last)
        journey = f"{' '.join(words.asking['journey'])} {text.span(at + 1, behind).text.rstrip(' ,')}"
        doing = text.span(behind, command.last).text
        here = next(iter(words.values.role_words.directions - set(words.asking["home"])), "")
        one, other = f"{journey} {words.word('and')} {doing} {here}", f"{journey}, {words.word('then')} {doing}"
        self._calls.problems.append(diagnostic("BT151", said, words=said.text, one=one, other=other))

    def _goes_there(self, goal: str, end: int) -> bool:
        """Whether the journey before some token is to the same places: what comes behind is done at each of them."""
        tokens = self._tokens
        behind = run_start(tokens, end, JOINTS | STATEMENT_ENDS)
        pace = tokens[behind - 1] if behind > 1 else None
        is_paced = pace is not None and (pace.kind == "every" or (pace.kind == "count" and pace.value == "-1"))
        last = behind - is_paced  # `visit every room every hour and wave`, `... in a loop. In each room, wave`
        if not goal or not 0 < behind < end or self._journey(tokens[:last]) is not tokens[last - 1]:
            return False
        if any(token.kind == "then" for token in tokens[last:end]):
            return False  # `go to A and B, then wave in each room`
        first = statement_start(tokens, last)
        first = max((i + 1 for i in range(first, last) if tokens[i].kind in _HEADS), default=first)
        if any(token.kind not in _PLAIN for token in tokens[first:last]):
            return False
        tour = self._tour(tokens[first:last])
        if not self._calls.make_round(tour, goal):
            return False
        at, legs = tour.end, last - 1 - first
        tokens[behind:end] = [Token("and", at, at)]
        tokens[first:last] = [tour]
        last -= legs
        if pace is not None and is_paced and pace.kind == "count":
            del tokens[last]
            here = tokens[first].start
            tokens[first:first] = [Token("repeat", here, here), pace, Token("colon", here, here)]
        return True

    def ask_in_each(self, match: Match) -> None:
        """`visit every room. If somebody is there, A`: that is asked in each of them."""
        tokens = self._tokens
        if PLACE not in self._context.pronouns.get(self._text.words[match.last - 1], ()):
            return  # as nearly always
        form = run_start(tokens, len(tokens), IN_CONDITIONS) - 1
        before = run_start(tokens, form, STATEMENT_ENDS)
        value = tokens[before - 1].value if 0 < before < form else None
        if not isinstance(value, Called) or not drives(value) or tokens[form].kind not in ("if", "unless"):
            return
        self._goes_there(next((text for text in texts_of(value) if choice_of(text) is not None), ""), form)

    def _goes_round(self, journey: Match, end: int) -> bool:
        """Whether the journey before some token is to the same set some times, with BT151: done each time, or then."""
        tokens, choice = self._tokens, choice_of(journey.values[0].group)
        behind = run_start(tokens, end, JOINTS)
        if choice is None or behind < 2 or tokens[behind - 1].kind != "count":
            return False
        if tokens[behind - 2].kind != "command" or not self._calls.has_set(tokens[behind - 2], choice):
            return False
        self._doubt_times(tokens[behind - 2], tokens[behind - 1], journey.last)
        return True

    @staticmethod
    def _tour(tokens: Sequence[Token]) -> Token:
        """`go to A, then to B and C` as one journey, where there is nothing else: else the last one."""
        last, legs = tokens[-1], [token.value for token in tokens if token.kind not in ("then", "and", "comma")]
        calls = [value for value in legs if drives(value) and not (isinstance(value, Listed) and value.joiner == "or")]
        if len(calls) < max(len(legs), 2) or len({call.entry.id for call in calls}) > 1:
            return last
        arguments = tuple(each for call in calls for each in arguments_of(call))
        return Token("command", tokens[0].start, last.end, Listed(calls[0].entry, arguments, "and"))

    def _repeats(self, journey: Match, last: int) -> bool:
        """`go to A and B three times. In each room, wave`: whether the rooms are those of a loop, three times each."""
        choice = choice_of(journey.values[0].group)
        first = statement_start(self._tokens, last)
        is_spoken_of = choice is not None and NAMES in dict(choice.parts)
        return is_spoken_of and any(token.kind not in _PLAIN for token in self._tokens[first:last])

    def _are_commands(self, at: int) -> bool:
        """Whether all from a word to the end of the statement are commands that `and` joins, up to an `if`."""
        joints = self._vocabulary.roles["and"]
        while True:
            command = self._phrase(at)
            if command is None or command.meaning.role not in _COMMANDS:
                return command is not None and command.meaning.role in _ASKING
            at = command.last + self._is_there(command.last)
            if self._is_end(at):
                return True
            at += self._text.words[at] == ","
            if self._text.words[at] not in joints:
                return False
            at += 1

    def _is_there(self, at: int) -> bool:
        """Whether a pronoun for a place stands at a word: `in every room, turn off the light there`."""
        return tuple(self._context.pronouns.get(self._text.words[at], ())) == (PLACE,)

    def _to(self, at: int, is_goal: bool = False) -> Match | None:
        """The journey to where words say that something is done, or brought."""
        if self._text.words[at] not in self._vocabulary.asking["located"] and not is_goal:
            return None
        journey = self._with_front(at, at + 1, "journey")
        goal = journey.values[0] if journey is not None and journey.values else None
        is_there = goal is not None and (goal.type in (PLACE, DOOR) or (goal.type == PERSON and bool(goal.group)))
        is_open = goal is not None and bool(goal.more) and goal.joiner == "or"  # `wave in the kitchen or the lab`
        return journey if is_there and not is_open else None  # `at each person, wave`

    def _append_tour(self, journey: Match, at: int) -> None:
        """Go to where something is done; to each place of a list in a round of its own."""
        self._partial.append(journey, at)
        listed = self._context.listed.get(PLACE)
        if journey.values[0].more and not journey.values[0].group and listed:
            self._calls.make_round(self._tokens[-1], listed)


def _goal_of(journey: Match) -> str:
    """Where a journey leads: to one place, or to a set of them."""
    return journey.values[0].group or journey.values[0].text
