"""What is said to people: `tell Bob dinner is ready`, `ask Bob to close the door`, `ask Bob if he is hungry`."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import Called, Listed, Token, arguments_of, with_arguments
from btlang.frontends.mission.tokens.hearers import Hearers, verbs_of
from btlang.frontends.mission.tokens.silent_words import BEGINS
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of
from btlang.text.words import Words
from btlang.tree.answers import ASK
from btlang.vocabulary.entry import RECIPIENT, Entry
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, TEXT, ZONE
from btlang.vocabulary.word_tree import find

TELL = "TellPerson"
_NO_QUESTION = "begins no question that I know"
_QUOTED = "has quotes of its own"
_MATTER = "begins what it is about, but not what to say"
_PERSON = "is a person, and the question is missing"
_BEHIND_PERSON = frozenset(("instead", "politeness", "until", "every"))
"""What may stand behind who is asked the same: `keep asking him until he says yes`."""
_MEASURES = frozenset(("count", "at_most", "up_to_times", "tries", "within", "by_time", "for", "up_to", "every"))
_MOST_IN_NAME = 4  # words
_PACES = ("every", "every_day")
_BEFORE_TIME = frozenset((*BEGINS, "and"))


class AddressedTexts(Hearers):
    """Texts without quotes that one text has for people."""

    @cached_property
    def _addressing(self) -> frozenset[str]:
        """The verbs behind which a person is told or asked something; none in a text without times or polite words."""
        between = self._vocabulary.firsts["at"] | self._addressing_pace
        if self._text.distinct.isdisjoint(between.union(self._vocabulary.asking["politely"])):
            return frozenset()
        return self._vocabulary.opening_words(TELL, ASK).union(self._vocabulary.asking["reminding"])

    @cached_property
    def _addressing_pace(self) -> frozenset[str]:
        """The words with which it begins how often somebody is told or asked something."""
        return frozenset().union(*(self._vocabulary.firsts[role] for role in _PACES))

    def with_time(self, match: Match | None, at: int) -> Match | None:
        """The phrase at a word; `remind Bob at 3 pm to rest` is `at 3 pm, remind Bob to rest`.

        That somebody is asked `politely` says nothing.
        """
        text = self._text
        if text.words[at] not in self._addressing:
            return match  # as nearly always
        person = self._context.read(PERSON, text, at + 1)
        begins = not self._tokens or self._tokens[-1].kind in _BEFORE_TIME
        times = self._times(person[1]) or self._pace(person[1]) if person is not None and begins else []
        is_polite = person is not None and text.words[person[1]] in self._vocabulary.asking["politely"]
        if person is None or not (times or is_polite):
            return match
        last = times[-1].last if times else person[1] + 1
        places = [*range(at, person[1]), *rest_of(text, last)]
        found = match_of(text, places, {}, (self._vocabulary.trie,), self._context)
        entry = found.meaning.entry if found is not None else None
        if found is None or entry is None or entry.id not in (TELL, ASK) or found.last <= person[1] - at:
            return match
        if times and times[0].meaning.role == "at":
            said = ";".join(text for time in times for text in time.values[0].texts)
            self._tokens.append(Token("at", text.starts[person[1]], text.ends[last - 1], said))
        elif times:
            self._tokens.append(self._calls.token(times[0], person[1]))
        return relocated(found, places)

    def _times(self, at: int) -> list[Match]:
        """The times of day at a word: `at 3 pm and again at 4 pm`."""
        found, words, roles = list[Match](), self._text.words, self._vocabulary.roles
        while (time := self._phrase(at)) is not None and time.meaning.role == "at":
            found.append(time)
            at = time.last + 1 if words[time.last] in roles["and"] else time.last
            at += words[at] in roles["again"]
        return found

    def _pace(self, at: int) -> list[Match]:
        """How often something is asked, at a word: `ask Bob every hour "Tea?"`."""
        pace = self._phrase(at) if self._text.words[at] in self._addressing_pace else None
        return [pace] if pace is not None and pace.meaning.role in _PACES else []

    def _tell(self, entry: Entry, value: SlotValue, command: Token) -> int:
        """`tell Bob dinner is ready`: a clause without a word before it."""
        text, texts = self._text, self._vocabulary.values.texts
        end = texts.end_of_clause(text, value.first)
        end = self._note_form(command, value.first, end) or end
        end = self._end_before_command(value.first, end, is_told=True) or end
        if any(word[0] == '"' for word in text.words[value.first : end]):
            return 0  # `tell her quietly "Hello"`
        if not end:
            return 0
        if text.words[value.first] in texts.matters:
            self._doubt(entry, value.first, _MATTER)
            return self._say_clause(value, end, command, text)
        said = self._to_hearer(command, value.first, end, is_asked=False)
        self._doubt_words(entry, command, value.first, end, said)
        return self._say_clause(value, end, command, said)

    def _said_times(self, first: int, last: int) -> Iterator[int]:
        """The places of times that belong to what is said: `tell Bob that lunch is at noon`, `that we close at six`."""
        timing = self._vocabulary.values.texts.timing
        for at in range(first + 2, last):
            if self._text.words[at] in timing and ((time := self._phrase(at)) is None or time.meaning.role == "at"):
                yield at

    def _said_lists(self, first: int, last: int) -> Iterator[int]:
        """The places of what joins a list of things that is said: `tell Bob that he can have tea, juice and water`."""
        words, joints = self._text.words, {*self._vocabulary.roles["and"], *self._vocabulary.roles["or"]}
        places = [at for at in range(first, last) if words[at] in joints or words[at] == ","]
        for at, joint in enumerate(places):
            if words[joint] not in joints or not self._is_thing(joint + 1, joint + 2):
                continue
            begin = at
            while begin and words[places[begin - 1]] == "," and self._is_thing(places[begin - 1] + 1, places[begin]):
                begin -= 1
            yield from places[begin : at + 1]

    def _is_thing(self, first: int, last: int) -> bool:
        """Whether words may name a thing: some behind an article, or one with which nothing begins."""
        is_owned = first in self._text.articles
        return last - first < _MOST_IN_NAME if is_owned else last - first == 1 and self._phrase(first) is None

    def _wish(self, value: SlotValue, command: Token) -> int:
        """`wish Bob a nice day`: "Have a nice day"."""
        text, first = self._text, value.first
        end = max(value.last, self._vocabulary.values.texts.end_of_clause(text, first))
        end = self._end_before_command(first, end, is_told=False) or end
        have = self._vocabulary.asking["wished"][0].capitalize()
        self._set_text(command, value.name, f"{have} {text.source.text[text.begin(first) : text.ends[end - 1]]}")
        command.end = text.ends[end - 1]
        self._tokens.append(command)
        return end

    def _say_clause(self, value: SlotValue, end: int, command: Token, said: Words) -> int:
        """Say the words of a clause up to a place, at which the mission goes on."""
        text = self._text
        words = text.source.text[text.begin(value.first) : text.ends[end - 1]]
        if said is not text:
            words = self._vocabulary.values.texts.written(said, value.first, end)
        self._set_text(command, value.name, words)
        command.end = text.ends[end - 1]
        self._tokens.append(command)
        return end

    def _doubt_words(self, entry: Entry, command: Token, first: int, last: int, said: Words) -> None:
        """Doubt what somebody is told, where nothing says who or what is meant; a time in it is part of it."""
        text, texts = self._text, self._vocabulary.values.texts
        sure = self._clear(said, first, last).union(self._said_times(first, last), self._said_lists(first, last))
        if not self._doubt(entry, texts.doubt(text, first, last, sure), said=(command, first, last)):
            self._note_unnamed(first, last)

    def _note_unnamed(self, first: int, last: int) -> None:
        """BT137 for `tell Bob that it was open`, behind a door."""
        word, context = self._text.words[first], self._context
        things = {kind for kind in context.values.pronouns.get(word, ()) if kind in (OBJECT, DOOR)}
        if any(context.latest.get(kind) for kind in things):
            words = self._text.span(first, last)
            self._calls.problems.append(diagnostic("BT137", words, words=words.text, word=word))

    def _plead(self, entry: Entry, value: SlotValue, at: int, command: Token) -> int:
        """`ask Bob to close his door`: says "Please close your door" to him; `ask Bob for the cup`: to give it."""
        text, asking, texts = self._text, self._vocabulary.asking, self._vocabulary.values.texts
        is_thing = text.words[value.first - 1] in asking["asking_for"]
        helps = is_thing and text.words[value.first] in asking["helping"]
        end = value.first + 1 if helps else texts.end_of_clause(text, value.first) or value.last
        end = (self._end_before_command(value.first, end, is_told=False) if is_thing else 0) or end
        end = next((at for at in range(value.first, end) if self._leaves_out_days(at + 1)), end)
        end = self._note_form(command, value.first, end) or end
        heard = self._to_hearer(command, value.first, end, is_asked=True, is_plea=not is_thing)
        clear = self._clear(heard, value.first, end)
        clear |= {place for place in range(value.first, end) if text.words[place - 1] in asking["coming"]}
        clear.update(self._said_lists(value.first, end))
        doubtful = (place for place in range(value.first, end) if texts.doubt(text, place, place + 1, clear))
        self._doubt(entry, next(doubtful, 0), said=(command, value.first, end))
        is_noun = value.first in text.articles or self._context.read(PLACE, text, value.first) is not None
        if is_noun and not is_thing:  # `get Bob to the lab`
            self._doubt(entry, value.first, "begins no request that I know")
        slot = self._ask_instead(command) if is_thing and text.words[end - 1] in asking["told_about"] else ""
        if slot:  # `ask Bob for his name`
            question = f"{asking['what_is'][0].capitalize()} {texts.written(heard, value.first, end)}?"
            self._set_text(command, slot, question)
            command.end = text.ends[end - 1]
            self._tokens.append(command)
            return end
        kind = "plea_for" if is_thing else "reminder" if text.words[at] in asking["reminding"] else "plea"
        said = asking["plea_for_help" if helps else kind][0].capitalize()
        said += "" if helps else f" {texts.written(heard, value.first, end)}"
        self._set_text(command, value.name, said)
        command.end = text.ends[end - 1]
        self._tokens.append(command)
        return end

    def _ask_instead(self, command: Token) -> str:
        """Make a command that tells people something one that asks them. Return the slot of the question."""
        said, ask = command.value, self._vocabulary.entry(ASK)
        if ask is None or not isinstance(said, Called | Listed):
            return ""
        kinds, names = {slot.name: slot.type for slot in said.entry.slots}, {slot.type: slot.name for slot in ask.slots}

        def renamed(arguments: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
            return tuple((names[kinds[name]], text) for name, text in arguments)

        command.value = with_arguments(said.replace(entry=ask), [*map(renamed, arguments_of(said))])
        return names[TEXT]

    def _ask(self, entry: Entry, value: SlotValue, command: Token) -> int:
        """`ask Bob if he is hungry`: the question that the clause stands for.

        Returns where to go on if the clause ends before its words do, else 0: `ask Bob what he wants and tell Alice`.
        """
        values, text, at = self._vocabulary.values, self._text, value.first
        if not self._is_clause(value):
            is_bare = text.words[at][0] != '"' and not values.texts.asks(text.words[at])
            if value.name == "question" and is_bare and value.last == at + 1:
                return self._ask_nobody(entry, value, command)
            if at not in text.articles and find(values.names_tree("person"), text.words, at) is not None:
                self._doubt(entry, at, _PERSON)
            return 0
        quote = next((place for place in range(at, value.last) if text.words[place][0] == '"'), 0)
        if self._doubt(entry, quote, _QUOTED):
            return 0
        self._ask_whom(entry, command, at)
        end = self._end_before_command(at, value.last, is_told=False)
        end = end or self._end_before_answer(at, value.last) or self._note_form(command, at, value.last)
        last = end or value.last
        is_speaker = text.words[at - 2] in values.role_words.speaker
        asked = self._of_speaker(at, last) if is_speaker else self._to_hearer(command, at, last, is_asked=True)
        asked = self._with_thing(asked, at, last)
        about = asked if asked is not text or not is_speaker else None  # `ask me if she wants tea`
        sure = self._sure_words(at, last)
        question = values.texts.direct(about, at, last, sure, {}) if about is not None else None
        if about is not None and question is None:
            question = values.texts.direct(about, at, last, sure, verbs_of(text, at, last, self._vocabulary))
        self._note_asked(at, last)
        if question is not None and self._doubt(entry, self._measure_in(at, last), said=(command, at, last)):
            return self._say_clause(value, value.last, command, text)
        if question is not None:
            self._set_text(command, value.name, question)
            if end:
                command.end = text.ends[end - 1]
                self._tokens.append(command)
            return end
        doubtful = values.texts.doubt(text, at + 1, value.last)
        self._doubt(entry, doubtful or at, "" if doubtful else _NO_QUESTION, (command, at, value.last))
        return self._say_clause(value, value.last, command, text)

    def _ask_whom(self, entry: Entry, command: Token, at: int) -> None:
        """Ask the one whom a question is about where nobody is named: `go to Bob and ask if he needs help`."""
        value, latest = command.value, self._context.latest.get(PERSON, "")
        slot = next((slot.name for slot in entry.slots if slot.type == PERSON), "")
        pronouns = self._vocabulary.pronouns_for_people
        if not isinstance(value, Called) or not slot or not latest or self._text.words[at] not in pronouns:
            return
        if slot not in dict(value.arguments):
            command.value = value.replace(arguments=((slot, latest), *value.arguments))

    def _ask_nobody(self, entry: Entry, value: SlotValue, command: Token) -> int:
        """BT013 for `ask the patient "Tea?"`, BT159 for words without a question. Returns where to go on."""
        from btlang.frontends.mission.explanations.nameless import unnamed

        text, at = self._text, value.first
        quote = next((i for i in range(at + 1, self._end_of_statement(at)) if text.words[i][0] == '"'), 0)
        if not quote or any(text.words[i] in self._vocabulary.joining for i in range(at, quote)):
            self._doubt(entry, at, _NO_QUESTION)
            end = self._vocabulary.values.texts.end_of_clause(text, at) or value.last
            return self._say_clause(value, end, command, text)
        end = next((i for i in range(at + 1, quote) if text.words[i] in self._vocabulary.asking["located"]), quote)
        people = [self._context.types[PERSON]]
        self._calls.problems.append(unnamed(text.span(at, end), people, "", self._vocabulary))
        self._set_text(command, value.name, text.words[quote][1:])
        self._tokens.append(command)
        return quote + 1

    def _measure_in(self, first: int, last: int) -> int:
        """Where words end what is said that could say how often, or how long: `if he wants tea three times`."""
        found = ((at, self._phrase(at)) for at in range(first + 1, last))
        ends = (
            at for at, match in found if match is not None and match.meaning.role in _MEASURES and match.last == last
        )
        return next(ends, 0)

    def _say_too(self, entry: Entry, value: SlotValue, command: Token) -> int:
        """`ask Bob "Tea?". If he says no, ask Alice`, `tell Bob lunch is ready, then tell Alice too`: to somebody else.

        What was asked or told last is said again.
        """
        before = (each.value for each in reversed(self._tokens) if isinstance(each.value, Called | Listed))
        asked = next((said for said in before if said.entry.id == entry.id), None)
        if not isinstance(asked, Called) or not isinstance(command.value, Called):
            return 0
        people = self._vocabulary.values.names_tree(PERSON)
        given = next((text for name, text in command.value.arguments if name != value.name), "")
        named = (given, value.first) if given else find(people, self._text.words, value.first)
        if named is None:
            return 0
        behind = self._phrase(named[1])
        is_silent = behind is not None and behind.meaning.role in _BEHIND_PERSON
        likewise = find(self._vocabulary.likewise, self._text.words, named[1])
        if entry.id != ASK and not (given and likewise is not None and self._ends(likewise[1])):
            return 0
        if not (is_silent or likewise is not None or self._ends(named[1])):
            return 0
        text = dict(asked.arguments)[value.name]
        said = {PERSON: named[0]}
        command.value = Called(entry, tuple((slot.name, said.get(slot.type, text)) for slot in entry.slots))
        command.end = self._text.ends[named[1] - 1]
        self._tokens.append(command)
        self._context.latest[PERSON] = named[0]
        return likewise[1] if likewise is not None else named[1]

    def _sure_words(self, first: int, last: int) -> set[str]:
        """The words of a question that could end it, and don't: `if she'd like the newspaper or her book`."""
        text, values, asking = self._text, self._vocabulary.values, self._vocabulary.asking
        sure = {*asking["hearing"], *asking["of_me"], *asking["addressed"]}.difference(text.words[first:last])
        for word in (*self._vocabulary.roles["or"], *self._vocabulary.roles["and"]):
            places = [place + 1 for place in range(first, last - 1) if text.words[place] == word]
            if places and all(
                find(values.names_tree(OBJECT), text.words, place) is not None
                or (values.texts.is_owned(text, place) and self._is_no_name(place))
                or (word in self._vocabulary.roles["or"] and self._is_choice(first, place))
                for place in places
            ):
                sure.add(word)
        times = {*self._said_times(first, last)}
        elsewhere = {text.words[at] for at in range(first, last) if at not in times}
        return sure | {text.words[at] for at in times} - elsewhere

    def _is_choice(self, first: int, at: int) -> bool:
        """Whether a word behind `or` in a question is another answer: `if she wants tea or coffee`."""
        if self._text.words[at] in self._vocabulary.before_conditions:
            return False
        return self._is_no_name(at) or self._vocabulary.values.texts.may_be_joined(self._text, first, at)

    def _is_no_name(self, at: int) -> bool:
        """Whether no name of somebody or of a place, and no phrase, begins at a word."""
        kinds = (PERSON, PLACE, ZONE, DOOR)
        named = any(find(self._vocabulary.values.names_tree(kind), self._text.words, at) is not None for kind in kinds)
        return not named and self._phrase(at) is None

    def _opens_clause(self, at: int) -> bool:
        """`tell me that ...`, `remind me to ...`, but not `report to Alice`."""
        asking, words = self._vocabulary.asking, self._text.words
        is_told = words[at - 1] in self._vocabulary.values.role_words.speaker
        return words[at] in asking["saying_that"] or (is_told and words[at] in asking["pleading"])

    def _clause(self, entry: Entry, at: int, opener: int) -> tuple[str, int]:
        """`remind me to drink some water`, `tell me that tea is ready`: what is said, and where it ends."""
        text, asking, texts = self._text, self._vocabulary.asking, self._vocabulary.values.texts
        end = texts.end_of_clause(text, opener + 1) or opener + 2
        end = self._end_before_command(opener + 1, end, is_told=True) or end
        own = self._vocabulary.values.adjectives.own if text.words[opener] in asking["pleading"] else frozenset[str]()
        doubtful = (place for place in range(opener + 1, end) if texts.doubt(text, place, place + 1))
        self._doubt(entry, next((place for place in doubtful if text.words[place] not in own), 0))
        words = (text.source.text[text.begin(place) : text.ends[place]] for place in range(opener + 1, end))
        said = " ".join(asking["addressed"][0] if word.lower() in own else word for word in words)
        if text.words[opener] in asking["pleading"]:
            said = f"{asking['reminder' if text.words[at] in asking['reminding'] else 'plea'][0]} {said}"
        return said[:1].upper() + said[1:], end

    def _addressee(self, first: int, last: int) -> int:
        """Where a clause ends with a person who may be told it: `report that lunch is ready to Bob`; 0 for none."""
        introducing = self._vocabulary.values.role_words.introducing.get(RECIPIENT, ())
        people, to = self._vocabulary.values.names_tree(PERSON), {words[-1] for words in introducing}
        for at in range(first, last - 1):
            named = find(people, self._text.words, at + 1) if self._text.words[at] in to else None
            if named is not None and named[1] == last:
                return at
        return 0

    def _repeat(self, entry: Entry, value: SlotValue, command: Token) -> None:
        """`ask Bob again`: what was asked, or told, before."""
        for token in reversed(self._tokens):
            said = token.value
            if isinstance(said, Called) and said.entry.id == entry.id:
                self._set_text(command, value.name, dict(said.arguments)[value.name])
                return
        self._doubt(entry, value.first)

    def _is_clause(self, value: SlotValue) -> bool:
        """Whether a text stands behind a word such as `that` or `if`."""
        return self._vocabulary.values.texts.opens(self._text.words[value.first - 1])

    def _set_text(self, command: Token, slot: str, text: str, adds: bool = False) -> None:
        """Makes a text that of a command, or `adds` it to the one that it has."""
        value = command.value

        def with_text(arguments: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
            said = {slot: f"{dict(arguments)[slot]} {text}" if adds else text}
            return tuple((name, said.get(name, given)) for name, given in arguments)

        assert isinstance(value, Called | Listed)
        command.value = with_arguments(value, [*map(with_text, arguments_of(value))])
