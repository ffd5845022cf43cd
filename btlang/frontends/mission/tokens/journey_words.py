"""Journeys that are said in other words: `from the lab, go to the hall`, `wait at the desk until somebody comes`."""

from __future__ import annotations

from btlang.frontends.mission.token import JOINTS, RULES, STATEMENT_ENDS, Called, Token, run_start, statement_start
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.frontends.mission.tokens.settling import STAYS
from btlang.frontends.mission.tokens.silent_words import BEGINS, begins, begins_item
from btlang.frontends.mission.tokens.word_matches import forms_of, match_of, relocated, rest_of
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.language_tables import NOT_ALONE
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.references import ALL, Choice, choice_of, ordinal
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE
from btlang.vocabulary.word_tree import find

_ASKED = ("condition", "negated")
COMES, ANYBODY_COMES, _COMES_BACK, _DURATION = "WaitForPerson", "WaitForSomeone", "ComeBack", "duration"
SEES, _AT = "SeesPerson", "PersonIsAt"
_ANY = "seen"  # how one of those in view is chosen
_TAKES, _FROM = "Take", ("off", "at", "inside", "on")
_LOOPED = frozenset(("command", "name", "wait", "every", "count", "repeat", "open", "close", "comma", "and", "then"))


def _texts(token: Token) -> list[str]:
    """The values of a command."""
    return [text for _, text in token.value.arguments] if isinstance(token.value, Called) else []


class JourneyWords(SentenceReader):
    """Those of one text."""

    def _start(self, at: int, end: int) -> int:
        """`from the lab, go to the hall`, `go from the lab to the hall`: to the first place, then on."""
        tokens = self._tokens
        if tokens and tokens[-1].kind not in (*BEGINS, *JOINTS):
            return 0
        journey = self._with_front(at, end, "journey")
        if journey is None or self._is_end(journey.last) or any("{" in value.text for value in journey.values):
            return 0  # `from your room` isn't where it starts
        behind = self._behind_comma(journey.last)
        joint = self._phrase(behind)
        self._partial.append(journey, at)
        tokens.append(Token("then", self._text.ends[journey.last - 1], self._text.ends[journey.last - 1]))
        return joint.last if joint is not None and joint.meaning.role in ("and", "then") else behind

    def _start_of_leg(self, at: int) -> int:
        """`go from the lab to the hall`, `go from room to room`, by the verb at a word."""
        if self._text.words[at] not in self._vocabulary.journey_verbs:
            return 0
        match = self._phrase(at + 1)
        if match is None or match.meaning.role != "start_at":
            return 0
        return self._from_each(at, match.last) or self._start(at, match.last)

    def _from_each(self, at: int, first: int) -> int:
        """`go from room to room`, where the noun at a word stands twice: to every room."""
        text, every = self._text, self._vocabulary.roles["all_names"][0]
        if self._is_end(first) or self._is_end(first + 1) or first in text.articles:
            return 0
        if text.words[first] != text.words[first + 2]:
            return 0
        journey = self._partial.with_front(at, first + 2, [*self._vocabulary.asking["journey"], every])
        if journey is None or journey.last != first + 3:
            return 0
        self._partial.append(journey, at)
        return journey.last

    def stop_after(self, match: Match, at: int) -> int:
        """`every 30 min, take a picture. Stop after 8 pictures`, `A. After three rounds, B`: so many rounds of it.

        What is counted is a round, or is said in the commands.
        """
        tokens, text, end = self._tokens, self._text, match.last + 1
        last = run_start(tokens, len(tokens), JOINTS | STATEMENT_ENDS | {"stop", "but"})
        first, noun = statement_start(tokens, last), text.words[match.last]
        looped = tokens[first:last]
        if not looped or any(token.kind not in _LOOPED for token in looped):
            return 0
        said = text.source.text[looped[0].start : looped[-1].end].lower().split()
        is_counted = noun in self._vocabulary.asking["rounds"] or not {noun, noun.removesuffix("s")}.isdisjoint(said)
        paces = [token for token in looped if token.kind in ("every", "count")]
        commands = [token for token in looped if token.kind not in ("every", "count", "repeat")]
        commands = commands[commands[:1] != [] and commands[0].kind == "comma" :]
        is_endless = len(paces) < 2 and all(token.kind == "every" or token.value == "-1" for token in paces)
        if not (commands and is_counted and is_endless and (self._is_end(end) or text.words[end] == ",")):
            return 0
        here, start, stop = looped[0].start, text.starts[at], text.ends[match.last]
        number = Token("count", start, stop, self._calls.token(match, at).value)
        if paces and paces[0].kind == "every":
            made = [paces[0], Token("comma", here, here), *commands, Token("comma", start, start), number]
        else:
            front = Token("repeat", here, here), Token("open", here, here)
            made = [*front, *commands, Token("close", start, start), number]
        tokens[first:] = [*made, *([] if self._is_end(end) else [Token("semi", stop, stop)])]
        return end if self._is_end(end) else end + 1

    def _put_back(self, at: int) -> int:
        """`fetch the cup from the lab. ... Then put it back`: to where it was taken from."""
        text, entry, asking = self._text, self._vocabulary.entry(_TAKES), self._vocabulary.asking
        thing = self._context.read(OBJECT, text, at + 1) if text.words[at] in asking["putting"] else None
        back = find(self._vocabulary.and_back, text.words, thing[1]) if thing is not None else None
        if entry is None or thing is None or back is None or not self._is_end(back[1]):
            return 0
        taken = (choice_of(said) for token in reversed(self._tokens) for said in _texts(token))
        parts = next((dict(each.parts) for each in taken if each is not None and f"{{{each.key}}}" == thing[0]), {})
        place = next((parts[relation] for relation in _FROM if relation in parts), "")
        if not place or place[:1] == "{":
            return 0
        said = {OBJECT: thing[0], PLACE: place}
        arguments = tuple((slot.name, said[slot.type]) for slot in entry.slots if slot.type in said)
        self._tokens.append(Token("command", text.starts[at], text.ends[back[1] - 1], Called(entry, arguments)))
        return back[1]

    def _back(self, at: int) -> int:
        """`go to the lab and back`: to where the journey before it ended, else to where the mission began."""
        found = find(self._vocabulary.and_back, self._text.words, at)
        journey = run_start(self._tokens, len(self._tokens), JOINTS) - 1
        if found is None or journey < 0 or self._journey(self._tokens[: journey + 1]) is not self._tokens[journey]:
            return 0
        behind = self._phrase(found[1])
        joins = behind is not None and behind.meaning.role in ("and", "then", "count")
        if not (joins or self._is_end(found[1]) or self._text.words[found[1]] == ","):
            return 0
        tokens, first = self._tokens, statement_start(self._tokens, journey)
        before, entry = self._journey(tokens[:journey]), self._vocabulary.entry(_COMES_BACK)
        start, end = self._text.starts[at], self._text.ends[found[1] - 1]
        if before is not None and before in tokens[first:]:
            journey = tokens.index(before)
            back = Token("command", start, end, before.value)
        elif before is None and entry is not None and self._is_first(first):
            back = self._calls.token(Match(Meaning("command", entry), found[1]), at)
        else:
            return 0  # from where it leaves is open
        tokens.insert(journey, Token("open", tokens[journey].start, tokens[journey].start))
        del tokens[run_start(tokens, len(tokens), JOINTS) :]
        tokens += [Token("then", start, start), back, Token("close", end, end)]
        return found[1]

    def _is_first(self, first: int) -> bool:
        """Whether a statement without a journey before it begins where the mission does."""
        is_defined = first > 0 and self._tokens[first - 1].kind == "define"
        return not is_defined and all(token.kind not in RULES for token in self._tokens[first:])

    def _back_and_forth(self, at: int, end: int) -> int:
        """`go back and forth between the lab and the hall`: to each of them, again and again."""
        journey = self._with_front(at, end, "journey")
        if journey is None or not any(value.more for value in journey.values):
            return 0
        if not self._tokens or self._tokens[-1].kind != "repeat":
            self._tokens.append(Token("repeat", self._text.starts[at], self._text.ends[end - 1]))
        self._partial.append(journey, at)
        return journey.last

    def rounds(self, match: Match, at: int) -> int:
        """`five times, A and B`: both, so many times."""
        text, last = self._text, match.last
        if not begins(self._tokens) or text.words[last] not in (",", ":"):
            return 0
        self._tokens.append(Token("repeat", text.starts[at], text.starts[at]))
        self._tokens += [self._calls.token(match, at), Token("colon", text.starts[last], text.ends[last])]
        return last + 1

    def _so_many(self, match: Match, at: int, front: str) -> int:
        """`do three rounds through the lab and the hall`, `take three pictures`: the same, so many times."""
        words = self._vocabulary.asking[front]
        command = self._partial.with_front(at, match.last, words, is_whole=front != "journey")
        if command is None:
            return 0
        start, end = self._text.starts[at], self._text.ends[match.last - 1]
        number = self._calls.token(match, at)
        self._partial.append(command, at)
        self._tokens.append(Token("count", start, end, number.value))
        return max(command.last, match.last)

    def _go_and_see(self, at: int) -> int:
        """`go and see if Bob is in the lab`: there, and then what is asked."""
        words = self._text.words
        going = find(self._vocabulary.going, words, at)
        check = self._phrase(going[1]) if going is not None else None
        if going is None or check is None or check.meaning.role != "check":
            return 0
        asked = self._phrase(check.last)
        places = [value for value in asked.values if value.type in (PLACE, DOOR)] if asked is not None else []
        spans = [(value.first, value.last) for value in places]
        if asked is not None and not spans:  # `if the light in the hall is on`
            named = self._vocabulary.values.names_tree(PLACE)
            located = (i for i in range(check.last, asked.last) if words[i - 1] in self._vocabulary.asking["located"])
            spans = [(i, found[1]) for i in located if (found := find(named, words, i)) is not None]
        journey = self._with_front(at, spans[0][0], "journey") if len(spans) == 1 else None
        if journey is None or journey.last != spans[0][1]:
            return 0
        self._partial.append(journey, at)
        joint = self._text.ends[going[1] - 1]
        self._tokens.append(Token("then", joint, joint))
        return going[1]

    def _pace(self, at: int) -> int:
        """`drive slowly` before all journeys: how they are made."""
        words = self._text.words
        manner = find(self._context.manners, words, at + 1) if words[at] in self._vocabulary.journey_verbs else None
        if manner is None or not begins_item(self._tokens) or self._journey() is not None:
            return 0
        behind = self._phrase(manner[1])
        joins = behind is not None and behind.meaning.role in ("and", "then")
        if not (self._is_end(manner[1]) or words[manner[1]] == "," or joins):
            return 0
        self._calls.manner = manner[0]
        return behind.last if behind is not None and joins else manner[1] + (words[manner[1]] == ",")

    def _wait_at(self, match: Match, at: int) -> int:
        """`wait at the desk until somebody comes`: goes there, then waits."""
        journey = self._with_front(at, match.last, "journey")
        if journey is None:
            return 0
        waiting = self._with_front(at, journey.last, "waiting")
        self._partial.append(journey, at)
        if waiting is None:
            self._tokens[-1].role = STAYS
            return journey.last
        joint = self._text.ends[journey.last - 1]
        self._tokens.append(Token("then", joint, joint))
        if waiting.meaning.role == "wait_time" and (end := self.until_both(waiting, journey.last)):
            return end
        if waiting.meaning.role == "wait_for":
            self._tokens.append(Token("wait_for", self._text.starts[journey.last], self._text.ends[waiting.last - 1]))
            return waiting.last
        is_wait = waiting.meaning.entry is not None and waiting.meaning.entry.id == COMES
        if is_wait and (end := self.wait_for_event(waiting, journey.last)):
            return end
        self._partial.append(self.for_anybody(waiting), journey.last)
        return waiting.last

    def until_both(self, match: Match, at: int) -> int:
        """Where a time with a condition beside it ends, 0 for others; see ClockWords."""
        raise NotImplementedError

    def _wait_for(self, at: int) -> int:
        """`wait for Bob`, `wait up to 5 min for Bob`: until he comes."""
        tokens, entry = self._tokens, self._vocabulary.entry(COMES)
        waits = bool(tokens) and tokens[-1].kind in ("wait_for", "wait_up_to")
        found = self._context.read(PERSON, self._text, at) if waits else None
        if found is None or entry is None or not found[0]:
            return 0
        wait = tokens.pop()
        said = {PERSON: found[0], **({_DURATION: wait.value} if isinstance(wait.value, str) else {})}
        values = [
            SlotValue(slot.name, slot.type, said[slot.type], at, found[1]) for slot in entry.slots if slot.type in said
        ]
        match = self.for_anybody(Match(Meaning("command", entry), found[1], tuple(values)))
        if self._wait_for_one(match, at):
            return found[1]
        self._partial.append(match, at)
        if match.meaning.entry is not entry:
            self._calls.note(match)
        tokens[-1].start = wait.start
        return found[1]

    def for_anybody(self, match: Match) -> Match:
        """`wait for somebody`, `wait for the first person`: until anybody comes; who it is shows only then.

        `if a guest is in the lab` asks of the guests there, not where the nearest one is.
        """
        if match.meaning.role == "negated" or (self._tokens and self._tokens[-1].kind == "not"):
            match = self._none_of(match)
        if match.meaning.entry is None or match.meaning.entry.id not in (COMES, _AT):
            return match  # as nearly always
        if match.meaning.entry.id == _AT:
            return _of_those_there(match)
        entry, who = self._vocabulary.entry(ANYBODY_COMES), _whoever(match)
        if entry is None or who is None or who.parts:
            return match
        return Match(Meaning("command", entry), match.last, tuple(v for v in match.values if v.type != PERSON))

    def _none_of(self, match: Match) -> Match:
        """`if there are no cups`, `if no guests are near`: not that some are missing, but that there isn't one."""
        values, none = list[SlotValue](), self._vocabulary.asking["no_thing"]
        for value in match.values:
            every = choice_of(value.group or value.text) if value.type in (OBJECT, PERSON) else None
            if every is not None and every.how == ALL and {*self._text.words[value.first - 1 : value.last]} & {*none}:
                how = _ANY if value.type == PERSON else "nearest"
                value = value.replace(text=every.replace(how=how).text, more=(), group="")
            values.append(value)
        return match.replace(values=tuple(values))  # type: ignore[no-any-return]

    def _wait_for_one(self, match: Match, at: int) -> bool:
        """`wait for a guest`, `wait for the first guest`: until any of that kind is in view, who is the one then."""
        entry, who = self._vocabulary.entry(SEES), _whoever(match)
        if entry is None or who is None or {name for name, _ in who.parts} != {"kind"}:
            return False
        start, end = self._text.starts[at], self._text.ends[match.last - 1]
        durations = [value.text for value in match.values if value.type == _DURATION]
        limit = next(iter(durations), None)
        one = who.replace(how=_ANY).text
        asked = Token("condition", start, end, Called(entry, ((entry.slots[0].name, one),)))
        self._tokens += [Token("wait_up_to" if limit else "wait_until", start, start, limit), asked]
        self._calls.note(_with_person(match, one))
        return True

    def wait_for_event(self, match: Match, at: int) -> int:
        """`wait for Bob to come to the lab`, `wait for the door to open`: until he comes to the lab, until it opens."""
        if match.meaning.entry is not None and self._wait_for_one(match, at):
            return match.last
        text, vocabulary = self._text, self._vocabulary
        first = match.values[0].first if match.meaning.entry is not None and match.values else match.last
        ends = (i for i in range(first + 1, self._end_of_statement(first)) if text.words[i] in vocabulary.purpose)
        behind = next(ends, 0)
        if not behind or (match.meaning.entry is None and match.meaning.role not in ("wait_for", "wait_up_to")):
            return 0
        verb, found = text.words[behind + 1], None
        forms = forms_of(verb, vocabulary.third_person)
        is_being = verb == vocabulary.asking["being"][0]
        places = [*range(first, behind), *rest_of(text, behind + 1)]
        for form in vocabulary.asking["being"][1:] if is_being else forms:
            asked = match_of(text, places, {behind - first: form}, (vocabulary.trie,), self._context)
            if asked is not None and asked.meaning.role == "condition" and (found is None or asked.last > found.last):
                found = asked
        found = relocated(found, places) if found is not None else None
        if found is None or found.last <= max(behind, match.last):
            return 0
        if text.words[found.last - 1] in vocabulary.asking["by_then"]:  # `wait for Bob to come by noon`
            time = self._phrase(found.last - 1)
            is_time = time is not None and time.meaning.role == "by_time" and time.last > found.last
            found = found.replace(last=found.last - is_time)
        if (who := _whoever(found)) is not None:
            found = _with_person(found, who.replace(how=_ANY).text)
        wait = self._calls.token(match, at)
        wait.end = text.ends[first - 1]
        if match.meaning.role != "wait_up_to":
            wait.kind, wait.value = "wait_until", None
        condition = self._calls.token(found, first)
        condition.kind = "condition"
        self._tokens += [wait, condition]
        self._calls.note(found)
        return found.last

    def inspection(self, at: int, end: int) -> int:
        """`check the lab`: no condition, but a place that is looked at."""
        found, asked = self._with_front(at, end, "inspecting"), self._phrase(end)
        if found is None or (asked is not None and asked.last > found.last and asked.meaning.role in _ASKED):
            return 0  # `check that the lab door and the hall door are closed`
        behind = self._phrase(found.last)
        joins = behind is not None and behind.meaning.entry is None and behind.meaning.role not in NOT_ALONE
        if not (joins or self._is_end(found.last) or self._text.words[found.last] == ","):
            return 0
        self._partial.append(found, at)
        return found.last


def _whoever(match: Match) -> Choice | None:
    """The choice of anybody, or of the first one, with whom something is done; None for other people."""
    who = next((choice_of(value.text) for value in match.values if value.type == PERSON and not value.more), None)
    return who if who is not None and (who.how == _ANY or ordinal(who.how) == 1) else None


def _of_those_there(match: Match) -> Match:
    """The same condition, in which any person is one of those at its place."""
    place = next((value.text for value in match.values if value.type == PLACE and not value.more), "{")
    who = _whoever(match)
    if who is None or who.how != _ANY or place[:1] == "{" or "at" in dict(who.parts):
        return match
    return _with_person(match, who.replace(parts=tuple(sorted((*who.parts, ("at", place))))).text)


def _with_person(match: Match, person: str) -> Match:
    """The same phrase about another person."""
    values = tuple(value.replace(text=person) if value.type == PERSON else value for value in match.values)
    return match.replace(values=values)  # type: ignore[no-any-return]
