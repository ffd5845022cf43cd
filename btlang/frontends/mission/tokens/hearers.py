"""Words about people as whoever hears them is told them: of `tell her that she is next`, "you are next"."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic, two_readings
from btlang.frontends.mission.token import STATEMENT_ENDS, Called, Listed, Token, arguments_of, statement_start
from btlang.frontends.mission.tokens.sentence_reader import is_question
from btlang.frontends.mission.tokens.told_words import ToldWords
from btlang.frontends.mission.tokens.word_matches import words_of
from btlang.text.source import Span
from btlang.text.words import END_OF_TEXT, Words
from btlang.tree.answers import ABOUT_ANSWERS
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE
from btlang.vocabulary.word_tree import find

_SOMEBODY = "may be somebody else for whoever hears it"
_NEXT = "may be a part of it, or go on with the mission"


class Hearers(ToldWords):
    """Who is meant by words for people in what is said to somebody."""

    def _to_hearer(self, command: Token, first: int, last: int, is_asked: bool, is_plea: bool = False) -> Words:
        """The text whose words are those for whoever a command speaks to; where that isn't clear, as they are.

        `she` at the start is who is spoken to where nobody else was, and who is asked always; but who does something to
        `him`, as in the plea `to help him`, is another one.
        """
        text, vocabulary = self._text, self._vocabulary
        if not vocabulary.persons or not isinstance(command.value, Called | Listed):
            return text
        if is_asked or vocabulary.values.texts.opens(text.words[first - 1]):  # `tell Bob you are late` is unclear
            text = as_robot(text, first, last, vocabulary)
        spoken = [*persons_in(text, first, last, vocabulary)]
        hearer = self._persons_of(command)
        named = {*persons_in(text, words_of(text, command).start, first, vocabulary)}
        known, here = self._persons_before()
        for who in spoken:
            at = next(at for at in range(first, last) if person_of(text.words[at], vocabulary) == who)
            is_subject, meant = text.words[at] == who, {name for name, words in known if who in words}
            known_otherwise = {name for name, words in known if words and who not in words}
            others = {name for name, _ in known} - hearer - known_otherwise
            other = "".join(meant - hearer)
            is_other = is_plea and not (is_subject or _owns(text, at, last, vocabulary)) and not other
            if is_other and not any(vocabulary.values.texts.opens(text.words[i]) for i in range(first, at)):
                continue
            if who not in named and len(meant) == 1 and other:
                is_open = not hearer <= known_otherwise and who not in self._said_in_statement()
                if not is_asked and at == first and "{" not in other and is_open:
                    ways = (
                        as_named(text, at, last, who, other, vocabulary),
                        as_hearer(text, first, last, who, vocabulary),
                    )
                    self._note_hearer(command, first, last, *ways)
                text = as_named(text, at, last, who, other, vocabulary) if "{" not in other else text
            elif is_asked and (is_subject or (len(spoken) == 1 and others.isdisjoint(here))):
                text = as_hearer(text, first, last, who, vocabulary, but=who)
            elif not is_asked and (at == first or (who in named and not _owns(text, at, last, vocabulary))):
                if who in named or meant or not others:
                    text = as_hearer(text, first, last, who, vocabulary)
        return text

    def _note_hearer(self, command: Token, first: int, last: int, named: Words, heard: Words) -> None:
        """BT050 for `ask Alice if she is done. If so, tell Carol that she can go`: Alice, or who hears it."""
        text, written = self._text, self._vocabulary.values.texts.written
        is_opened = self._vocabulary.values.texts.opens(text.words[first - 1])
        front = text.source.text[command.start : text.ends[first - 1 - is_opened]]
        taken, other = (f'{front} "{written(words, first, last)}"' for words in (named, heard))
        whole = Span(text.source, command.start, text.ends[last - 1])
        self._calls.problems.append(two_readings(whole, taken, other))

    def _of_speaker(self, first: int, last: int) -> Words:
        """The words of `ask me if I want my tea` as those about somebody else: `if they want your tea`."""
        text, asking = self._text, self._vocabulary.asking
        own = self._vocabulary.values.adjectives.own
        if all(text.words[at] not in asking["speaking"] for at in range(first, last)):
            return text
        for at in range(first, last):
            if text.words[at] in asking["speaking"]:
                text = text.with_word(at, asking["spoken_of"][0])
            elif text.words[at] in own:
                text = text.with_word(at, asking["addressed"][0])
        return text

    def _doubt(self, entry: Entry, at: int, reason: str = "", said: tuple[Token, int, int] | None = None) -> bool:
        """Says that a word of what a command has `said` in a range may mean something else (BT159), if it is one."""
        if at:
            is_person = self._text.words[at] in self._vocabulary.values.texts.of_persons
            reason, span = reason or (_SOMEBODY if is_person else _NEXT), self._text.span(at, at + 1)
            example = self._quoting(*said, at) if said is not None else entry.example
            self._calls.problems.append(diagnostic("BT159", span, word=span.text, reason=reason, example=example))
        return at > 0

    def _note_form(self, command: Token, first: int, last: int) -> int:
        """Where a clause ends before a form; BT050 there, as it could be said, too: `that tea is ready, unless C`."""
        text, end = self._text, self._end_before_form(first, last)
        if not end:
            return 0
        last = self._end_of_statement(end)
        opener = text.words[first - 1]
        is_opened = self._vocabulary.values.texts.opens(opener) or opener in self._vocabulary.asking["pleading"]
        whole, behind = Span(text.source, command.start, text.ends[last - 1]), text.span(end, last).text
        front = text.source.text[command.start : text.ends[first - 1 - is_opened]]
        said = text.span(first, end).text
        taken, other = f'{front} "{said}"{behind}', f'{front} "{said}{behind}"'
        self._calls.problems.append(two_readings(whole, taken, other))
        return end

    def _quoting(self, command: Token, first: int, last: int, at: int) -> str:
        """A command with the words that it says in quotes, up to a word in doubt behind which another one begins."""
        text, values, asking = self._text, self._vocabulary.values, self._vocabulary.asking
        joins = at > first and text.words[at] in (",", *self._vocabulary.roles["and"])
        goes_on = joins and self._phrase(at + 1) is not None
        end = at - (text.words[at - 1] == ",") if joins else last
        is_asked, opener = is_question(command), text.words[first - 1]
        pleads = opener in (*asking["pleading"], *asking["asking_for"])
        heard = self._to_hearer(command, first, end, is_asked or pleads)
        who, others = person_of(text.words[at], self._vocabulary), self._persons_before()[0]
        names = {name for name, _ in others if "{" not in name} - self._persons_of(command)
        if (
            who and len(names) == 1 and heard.words[at] == text.words[at]
        ):  # `lead Bob to the lab and tell Alice he is there`
            heard = as_named(heard, at, end, who, names.pop(), self._vocabulary)
        said = values.texts.written(heard, first, end)
        if is_asked:
            verbs, sure = verbs_of(text, first, end, self._vocabulary), set(text.words[first:end])
            question = values.texts.direct(heard, first, end, sure.union(asking["hearing"]), verbs)
            said = question or f"{opener.capitalize()} {said}?" if values.texts.asks(opener) else question or said
        elif pleads:
            reminds = text.words[words_of(text, command).start] in asking["reminding"]
            kind = "plea_for" if opener in asking["asking_for"] else "reminder" if reminds else "plea"
            said = f"{asking[kind][0].capitalize()} {said}"
        front = text.source.text[command.start : text.ends[first - 1 - (pleads or values.texts.opens(opener))]]
        if pleads:  # a question would wait for an answer
            verb, _, whom = front.partition(" ")
            told = asking["informing"][0]
            front = f"{told.capitalize() if verb[:1].isupper() else told} {whom}"
        behind = at + 1 + (text.words[at + 1] in self._vocabulary.roles["and"])
        rest = f", {self._vocabulary.word('then')} {values.texts.written(text, behind, last)}" if goes_on else ""
        rest = f", {self._vocabulary.word('then')} ..." if joins and not goes_on else rest
        return f'{front} "{said}"{rest}'

    def _clear(self, said: Words, first: int, last: int) -> set[int]:
        """The places of words for people of whom it is clear who they are, once they are `said` so."""
        text, vocabulary = self._text, self._vocabulary
        changed = {at for at in range(first, last) if said.words[at] != text.words[at]}
        persons = {person_of(text.words[at], vocabulary) for at in changed} - {""}
        return changed.union(at for at in range(first, last) if person_of(text.words[at], vocabulary) in persons)

    def _persons_before(self) -> tuple[list[tuple[str, set[str]]], set[str]]:
        """The people of this statement and the one before it, each with the words for them, and those of this one."""
        ends = [0, 0, *(at + 1 for at, token in enumerate(self._tokens) if token.kind in STATEMENT_ENDS)]
        known, latest, here = list[tuple[str, set[str]]](), set[str](), set[str]()
        for place, token in enumerate(self._tokens[ends[-2] :], ends[-2]):
            latest = self._persons_of(token) or latest
            known += [(name, self._said_by(token)) for name in latest]
            here |= latest if place >= ends[-1] else set()
        return known, here

    @cached_property
    def _single(self) -> set[str]:
        """The subjects for one person alone: not `they`."""
        plural = self._vocabulary.values.plural_pronouns
        return {who for who, forms in self._vocabulary.persons.items() if plural.isdisjoint(forms)}

    def note_other(self, match: Match) -> None:
        """BT038 for `ask Bob what Alice needs. If he says cup, bring it to her`: she isn't Bob."""
        if not self._calls.speaks_of_people:
            return  # as nearly always
        text, vocabulary, tokens, single = self._text, self._vocabulary, self._tokens, self._single
        for value in match.values:
            who = person_of(text.words[value.first], vocabulary) if value.type == PERSON and not value.more else ""
            if who not in single:
                continue
            first = statement_start(tokens, len(tokens))
            answer = next((at for at in range(first, len(tokens)) if _is_answer(tokens[at])), None)
            named = set().union(*map(self._persons_of, tokens[answer or 0 : -1]))
            subject = person_of(text.words[words_of(text, tokens[answer]).start], vocabulary) if answer else who
            if subject in single - {who} and value.text not in named:
                word, example = text.span(value.first, value.last), vocabulary.values.said_names(PERSON)[0]
                problem = diagnostic("BT038", word, words=word.text, type=PERSON, example=example)
                self._calls.problems.append(problem)

    def _said_in_statement(self) -> set[str]:
        """The persons for whom words of this statement stand: he, in `if he doesn't come, ...`."""
        tokens = self._tokens[statement_start(self._tokens, len(self._tokens)) :]
        return set().union(*map(self._said_by, tokens))

    def _said_by(self, token: Token) -> set[str]:
        """The persons for whom words of a token stand."""
        words = words_of(self._text, token)
        return set(persons_in(self._text, words.start, words.stop, self._vocabulary))

    @staticmethod
    def _persons_of(token: Token) -> set[str]:
        """The people with whom something is done, by name or reference."""
        said = token.value
        if not isinstance(said, Called | Listed):
            return set()
        return {text for arguments in arguments_of(said) for text in said.entry.given(PERSON, arguments) if text}

    def _note_asked(self, at: int, last: int) -> None:
        """Make `it` and `there` what a question is about: `ask Bob if he wants the cup. If so, bring it`."""
        self._calls.note_asked([*self._text.words[at:last], END_OF_TEXT])
        for kind in (DOOR, PLACE):
            tree = self._vocabulary.values.names_tree(kind)
            found = {found[0] for place in range(at, last) if (found := find(tree, self._text.words, place))}
            if len(found) == 1:
                self._context.latest[kind] = found.pop()
            elif found:
                self._context.latest.pop(kind, None)

    def _with_thing(self, text: Words, first: int, last: int) -> Words:
        """`look for the cup. If that fails, ask Bob where it is`: the words with the cup, which he can't know."""
        pronouns, asking = self._context.pronouns, self._vocabulary.asking
        for at in range(first, last):
            if OBJECT not in pronouns.get(text.words[at], ()) or text.words[at] in self._vocabulary.values.ones:
                continue
            is_somewhere = text.words[at + 1] in asking["asking_be"] and text.words[at + 2] in asking["located"]
            is_where = text.words[at - 1] in self._vocabulary.roles["ask_where"]
            if not (is_where or is_somewhere or at == last - 1):
                continue  # `if it is raining`
            thing = self._meant_thing(first)
            if thing is not None:
                text = text.with_word(at, " ".join(map(self._written, range(*thing))))
        return text

    def _meant_thing(self, last: int) -> tuple[int, int] | None:
        """Where the thing is named or described, before a word, that the latest value stands for."""
        text, names, meant = (
            self._text,
            self._vocabulary.values.names_tree(OBJECT),
            self._context.latest.get(OBJECT, ""),
        )
        for at in reversed(range(last)):
            is_noun = at in text.articles and meant[:1] == "{"
            found = self._context.read(OBJECT, text, at) if is_noun else find(names, text.words, at)
            if found is not None and (is_noun or found[0] == meant):
                return at, found[1]
        return None


def person_of(word: str, vocabulary: Lexicon) -> str:
    """The subject for the person whom a word stands for, "" for other words: `she` for `her` and `she'll`."""
    word = word.partition("'")[0]
    persons = vocabulary.persons
    return word if word in persons else next((who for who, forms in persons.items() if word in forms), "")


def persons_in(text: Words, first: int, last: int, vocabulary: Lexicon) -> Iterator[str]:
    """The persons whom words stand for, each by the word that is its subject, in their order and once."""
    yield from dict.fromkeys(who for at in range(first, last) if (who := person_of(text.words[at], vocabulary)))


def as_hearer(text: Words, first: int, last: int, who: str, vocabulary: Lexicon, but: str = "") -> Words:
    """The same text in which words for a person, `but` one, are those for whoever hears it: `she is` is `you are`."""
    you, your = vocabulary.asking["hearing"][0], vocabulary.asking["addressed"][0]
    for at in range(first, last):
        word, _, tail = text.words[at].partition("'")
        if person_of(word, vocabulary) != who or word == but:
            continue
        if word == who:
            text = text.with_word(at, you + f"'{tail}" * (tail != ""))
            if at + 1 < last:
                text = text.with_word(at + 1, _with_you(text.words[at + 1], vocabulary))
        elif _owns(text, at, last, vocabulary):
            text = text.with_word(at, your)
        elif word in vocabulary.values.pronouns:  # but not `the cup is his`
            text = text.with_word(at, you)
    return text


def as_named(text: Words, at: int, last: int, who: str, name: str, vocabulary: Lexicon) -> Words:
    """The same text in which a word for a person is their name: `he missed his bus` is `Bob missed his bus`."""
    is_owner = text.words[at] != who and _owns(text, at, last, vocabulary)
    return text.with_word(at, name + vocabulary.values.adjectives.ending * is_owner)


def as_robot(text: Words, first: int, last: int, vocabulary: Lexicon) -> Words:
    """The same text in which the robot speaks of itself: `you are on your way` as `I am on my way`."""
    others, words = vocabulary.of_robot, text.words[first:last]
    if not others:
        return text
    for at in range(first, last):
        owner = text.source.text[slice(*text.articles[at])].lower() if at in text.articles else ""
        if owner in others:
            text = text.with_word(at, f"{others[owner]} {text.words[at]}")
    if len(words) > 1 and words[0] in others and words.count(words[0]) == 1:  # but not `you said that you are late`
        both = others.get(" ".join(words[:2]), f"{others[words[0]]} {words[1]}")
        text = text.with_word(first, both.split()[0]).with_word(first + 1, both.split()[1])
    verbs = (*vocabulary.values.texts.inverting, *vocabulary.values.texts.completed)
    for at in range(first + 1, last):  # `help you`, but not `that you are late`
        behind = text.words[at + 1] if at + 1 < last else ","
        if text.words[at] in others and behind not in verbs:
            text = text.with_word(at, vocabulary.asking["of_me"][0])
    return text


def verbs_of(text: Words, first: int, last: int, vocabulary: Lexicon) -> dict[int, tuple[str, int]]:
    """Whoever does something and the verb, as they begin a question, by their place, and where the verb ends.

    Of `she drinks tea`, "do you drink"; of `anybody drinks tea`, "does anybody drink".
    """
    asking, people, found = vocabulary.asking, vocabulary.values.names_tree(PERSON), dict[int, tuple[str, int]]()
    you, do, does = ("".join(asking[name][:1]) for name in ("doing_it", "doing_ours", "doing_theirs"))
    for at in range(first, last - 1):
        word, named = text.words[at], find(people, text.words, at)
        end = named[1] if named is not None else at + 1
        verb = _with_you(text.words[end], vocabulary)
        is_one = word in asking["one_doing"] or named is not None
        if word in vocabulary.persons and verb != text.words[end]:
            found[at] = f"{you} {verb}", end + 1
        elif is_one and does and verb != text.words[end] and verb not in vocabulary.values.texts.inverting:
            found[at] = f"{does} {' '.join(map(str, named[:1] if named is not None else (word,)))} {verb}", end + 1
        elif word in asking["several_doing"] and text.words[end] not in vocabulary.values.texts.inverting:
            found[at] = f"{do} {word} {text.words[end]}", end + 1
    asked = text.words[first]
    if not found and text.words[first - 1] in asking["who"] and _with_you(asked, vocabulary) != asked:
        found[first] = asked, first + 1  # `who wants tea`
    return found


def _is_answer(token: Token) -> bool:
    """Whether a condition is about what somebody answered."""
    return token.kind == "condition" and isinstance(token.value, Called) and token.value.entry.id in ABOUT_ANSWERS


def _owns(text: Words, at: int, last: int, vocabulary: Lexicon) -> bool:
    """Whether a word says whose the thing behind it is: the `her` of `her cup`, but not that of `bring her a cup`."""
    if text.words[at] not in vocabulary.values.adjectives.other_owners:
        return False
    behind = text.words[at + 1] if at + 1 < last else ","
    is_noun = behind[0].isalnum() and behind not in vocabulary.values.role_words.prepositions
    return is_noun and at + 1 not in text.articles and behind not in vocabulary.joining


def _with_you(verb: str, vocabulary: Lexicon) -> str:
    """A verb as it stands behind `you`: `are` for `is`, `need` for `needs`."""
    from btlang.vocabulary.correct_words import correct_words  # hardly ever

    if verb in vocabulary.of_hearer:
        return vocabulary.of_hearer[verb]
    endings = sorted(vocabulary.third_person.items(), key=lambda ending: -len(ending[0]))
    forms = (verb.removesuffix(end) + other for end, others in endings if verb.endswith(end) for other in others[::-1])
    return next((form for form in forms if form in correct_words(vocabulary.word_list)), verb)
