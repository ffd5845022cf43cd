"""Texts: in quotes, one word, a saying such as `good morning`, or a clause, as in `tell Bob that tea is ready`.

A clause ends with its statement, or before a word such as `then`. It is in doubt where it may end sooner, and where it
has a pronoun for a person, which whoever hears it would take for somebody else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set

from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.word_tree import WordTree, find, tree_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_ENDS = frozenset((END_OF_STATEMENT, END_OF_TEXT))
_BEFORE_QUOTES = frozenset((":", ","))  # `say: "hello"`
_MARKS = frozenset((",", ":", "(", ")", "{", "}"))
_JOINING = (
    "and", "or", "nor", "but", "if", "unless", "while", "until", "whenever", "before", "after", "otherwise",
    "as_soon_as", "once", "meanwhile", "provided", "stop_when",
)  # fmt: skip


class Texts:
    """Reads such texts in one language."""

    def __init__(self, language: Mapping[str, Any]) -> None:
        # words that an article before them makes no text: `print a then wave`
        self._connectives = frozenset(phrase for phrases in language["roles"].values() for phrase in phrases)
        articles, roles = frozenset(language["articles"]), language["roles"]

        def words_of(role: str) -> WordTree:
            return tree_of((words, True) for words in ways(roles.get(role, ()), articles))

        self._clause_words = frozenset(language["clause_words"])
        self._question_words = frozenset(language["question_words"])
        self._measuring = frozenset(language["asking"].get("measuring", ()))
        self._selecting = tree_of((phrase, True) for phrase in ways(language["asking"].get("selecting", ()), articles))
        self._openers = frozenset((*language["clause_openers"], *self._question_words))
        self._modals, self.completed = frozenset(language["modals"]), frozenset(language["completed"])
        self._participles, self._endings = frozenset(language["participles"]), tuple(language["participle_endings"])
        self.inverting = self._modals.union(language["inverting"])
        self.matters = frozenset(language["matters"])
        """Words before what somebody is told of, which is no text."""
        self._purpose = frozenset(language["purpose"])
        self._relatives = frozenset(phrase.split()[0] for phrase in language["relatives"])
        self._owners = frozenset(language["possessives"].get("others", ()))
        self._having = "".join(language["asking"].get("having", ())[:1])
        self._subjects = frozenset((*language["pronouns"], *language["asking"].get("addressed", ())))
        self._sayings = tree_of((phrase, True) for phrase in language["sayings"])
        self._then, self._otherwise = words_of("then"), words_of("otherwise")
        self._direct = tree_of((words, said) for said, clauses in language["direct"].items() for words in ways(clauses))
        self.of_persons = frozenset(language["of_persons"])
        """Words for persons that are others for whoever hears them."""
        self._joining_words = [*map(words_of, _JOINING)]
        self._joining = set().union(*self._joining_words)
        self.timing = {phrase.split()[0] for phrase in roles.get("at", ())}
        """The first words of times."""
        self._pairs = {tuple(phrase.split()) for phrase in language["asking"].get("pairs", ())}
        """Words that belong to the one before them: `look after`, `anything else`."""
        self._joints = words_of("nor") | words_of("and") | words_of("or")
        self._doubtful = {*_MARKS, *self.of_persons, *self._joining, *language.get("counts", ())}

    def read(self, text: Words, at: int) -> tuple[str, int] | None:
        """The text that begins at a word and where it ends."""
        word = text.words[at]
        if word[0] == '"':
            return word[1:], at + 1
        if word in self._joints:
            return None  # `neither nobody answers nor Bob is near`
        if word in _BEFORE_QUOTES and text.words[at + 1][0] == '"':
            return text.words[at + 1][1:], at + 2
        end = self._end_of_several(text, at)
        if end:
            return text.source.text[text.begin(at) : text.ends[end - 1]], end
        if self._is_clause(text, at):
            return None
        bare = word[0].isalnum() or (word[0] == "-" and len(word) > 1)
        ends_here = not bare or word in self._connectives
        if at in text.articles and ends_here:  # the article is all that there is: `print a`
            start, end = text.articles[at]
            return text.source.text[start:end], at
        return (text.source.text[text.starts[at] : text.ends[at]], at + 1) if bare else None

    def _end_of_several(self, text: Words, at: int) -> int:
        """Where a clause or saying ends that begins at a word, 0 for none."""
        if at and text.words[at - 1] in self._openers:
            return self.end_of_clause(text, at)
        return self.end_of_saying(text, at)

    def may_have_sayings(self, text: Words) -> bool:
        """Whether a text has a word with which a saying begins."""
        return not text.distinct.isdisjoint(self._sayings)

    def end_of_saying(self, text: Words, at: int) -> int:
        """Where a saying ends that begins at a word, 0 for none: `good morning`."""
        found = find(self._sayings, text.words, at) if text.words[at] in self._sayings else None
        return found[1] if found is not None else 0

    def _is_clause(self, text: Words, at: int) -> bool:
        """Whether a word begins a clause, of which it says nothing alone: `ask if he is hungry`, `he says to wave`."""
        is_opener = text.words[at] in self._clause_words or text.words[at] in self._purpose
        behind = text.words[at + 1] if is_opener else END_OF_TEXT
        return behind[0].isalpha() and behind not in self._joining and behind not in self._then

    def has_verb(self, words: Sequence[str]) -> bool:
        """Whether a noun and what is behind it may be a sentence: `lab is closed`, `shop closes`; not `exact time`."""
        sure = self.inverting | self.completed | self._participles
        may_be_plural = not self.matters.isdisjoint(words)  # `the names of the guests`
        endings = (*self._endings, "'t", *(() if may_be_plural else ("s",)))
        return words[0].endswith("'s") or any(word in sure or word.endswith(endings) for word in words[1:])

    def asks(self, word: str) -> bool:
        """Whether a word alone is a question: `ask Bob why`."""
        return word in self._question_words

    def opens(self, word: str) -> bool:
        """Whether a clause stands behind a word."""
        return word in self._openers

    def may_be_joined(self, text: Words, first: int, last: int) -> bool:
        """Whether a verb as it stands in commands could go on with a clause: `if he can come and help`."""
        return any(text.words[at] in self._modals or text.words[at] in self._purpose for at in range(first, last))

    def is_whole(self, text: Words, first: int, last: int) -> bool:
        """Whether a clause has its verb, in a form that no verb as in commands goes on with: `tea is ready`."""
        return self._verb(text, first, last) > first and not self.may_be_joined(text, first, last)

    def _verb(self, text: Words, first: int, last: int) -> int:
        """The word of a clause that stands before who does it in a question; the first of all where there is none."""
        return next((at for at in range(first, last) if self._inverts(text, at)), first)

    def _inverts(self, text: Words, at: int) -> bool:
        word, behind = text.words[at], text.words[at + 1]
        done = behind in self._participles or behind.endswith(self._endings)
        return word in self.inverting or (word in self.completed and done and at + 1 not in text.articles)

    def is_owned(self, text: Words, at: int) -> bool:
        """Whether an article, or a word for whose thing it is, stands before what begins at a word."""
        return at in text.articles or text.words[at] in self._owners

    def doubt(self, text: Words, first: int, last: int, sure: Set[int] = frozenset()) -> int:
        """The word of a text without quotes that may end it, or be understood as somebody else; 0 if there is none.

        The words at `sure` places are neither.
        """
        doubtful = (at for at in range(first, last) if text.words[at] in self._doubtful and at not in sure)
        doubtful = (at for at in doubtful if not self._is_second(text, at))
        return next((at for at in doubtful if at == first or not self._belongs(text, at)), 0)

    def _is_second(self, text: Words, at: int) -> bool:
        """Whether a word belongs to the one before it: the `else` of `anything else`."""
        return tuple(text.words[at - 1 : at + 1]) in self._pairs

    def _begins_no_other(self, text: Words, at: int) -> bool:
        """Whether a word begins none of the words that could go on with the mission: the `in` of `in ten minutes`."""
        word = text.words[at]
        is_time = word in self.timing and at + 1 not in text.articles  # but not `at the desk`
        if is_time or word not in self._joining or word in self.of_persons:
            return False
        return all(find(joining, text.words, at) is None for joining in self._joining_words)

    def _belongs(self, text: Words, at: int) -> bool:
        """Whether a word that could end a text goes on with the verb before it: `the book is on the table`."""
        if self._begins_no_other(text, at):
            return True
        is_joint = any(find(joints, text.words, at) is not None for joints in (self._joints, self._then))
        return text.words[at - 1] in self.inverting - self._modals and text.words[at] in self._joining and not is_joint

    def direct(
        self, text: Words, first: int, last: int, sure: Set[str], verbs: Mapping[int, tuple[str, int]]
    ) -> str | None:
        """The question that a clause stands for: `he is hungry` as "Are you hungry?"; None where that can't be told.

        The `sure` words belong to it, though they may end others; the `verbs` begin questions, by the place of who does
        it, each with where the verb ends: of `she drinks tea`, "do you drink".
        """
        mine = (at for at in range(first, last) if self._begins_no_other(text, at) or self._is_second(text, at))
        others = (text.words[at] for at in {*range(first, last)}.difference(mine))
        doubtful = (self._doubtful - sure).intersection(others)  # but not `in` of `if she is in pain`
        opener = text.words[first - 1]
        asks = opener in self._question_words
        for at in range(first, last) if asks else (first,):  # `what tea he wants`
            front = find(self._direct, text.words, at)
            front = front or verbs.get(at)
            if front is not None and (front[1] < last or asks or at in verbs):
                if not doubtful.isdisjoint(text.words[first:at]):
                    break  # `when she comes if she wants tea`
                begin = self._having if self._having and self._is_perfect(text, front[1], last) else front[0]
                parts = [*([opener] if asks else []), *self._said(text, first, at), begin]
                return self._question(parts, self._said(text, front[1], last), doubtful)
        if asks and text.words[first] in self.inverting:  # `what is 7 times 8`
            return self._question((opener, text.words[first]), self._said(text, first + 1, last), doubtful)
        verb = self._verb(text, first, last)
        if verb == first or not self._relatives.isdisjoint(text.words[first:verb]):
            return None
        subject = self._subject(text, first, verb) if opener in self._measuring else first
        if subject is None:
            return None  # `how long dinner will take`
        if subject == verb:  # `how many people are coming`
            return self._question([opener], self._said(text, first, last), doubtful)
        parts = [*([opener] if asks else []), *self._said(text, first, subject), text.words[verb]]
        parts += self._said(text, subject, verb)
        if self._belongs(text, verb + 1):  # `if the book is on the table`
            doubtful = doubtful - {text.words[verb + 1]}
        return self._question(parts, self._said(text, verb + 1, last), doubtful)

    def _is_perfect(self, text: Words, at: int, last: int) -> bool:
        """Whether a participle at a word says what somebody has done: `he has lost the key`, `he's lost the key`."""
        verb, behind = text.words[at - 1], at + 1
        if verb in self.completed:
            return self._inverts(text, at - 1)
        is_short = text.source.text[text.starts[at - 1] : text.ends[at - 1]][:1] == "'"
        has_object = behind < last and (self.is_owned(text, behind) or text.words[behind] in self._subjects)
        return (
            is_short and has_object and (text.words[at] in self._participles or text.words[at].endswith(self._endings))
        )

    def _subject(self, text: Words, first: int, verb: int) -> int | None:
        """Where who or what does it begins behind a question word: at `it` in `how long it will take`.

        At the verb where it is what is asked for, None where that isn't clear.
        """
        places = range(first, verb)
        found = (at for at in places if text.words[at] in self._subjects or self.is_owned(text, at))
        if (subject := next(found, None)) is not None:
            return subject
        front = find(self._selecting, text.words, first - 1)
        if front is not None:
            return verb if verb == front[1] + 1 else None
        return first if verb == first + 1 else None

    def _question(self, front: Sequence[str], behind: Sequence[str], doubtful: Set[str]) -> str | None:
        """A question of words, None where one of them is somebody else for whoever hears it."""
        if any(word.lower() in doubtful for word in behind):
            return None
        asked = " ".join((*front, *behind))
        return f"{asked[0].upper()}{asked[1:]}?"

    def _said(self, text: Words, first: int, last: int) -> list[str]:
        """Words as they are written, or in the place of those."""
        written = (text.source.text[text.begin(at) : text.ends[at]] for at in range(first, last))
        return [
            each if each.lower().endswith(word) else word
            for each, word in zip(written, text.words[first:last], strict=True)
        ]

    def written(self, text: Words, first: int, last: int) -> str:
        """Words as they are written, or those in their place."""
        return " ".join(self._said(text, first, last)).replace(" ,", ",")

    def end_of_clause(self, text: Words, at: int) -> int:
        """Where the clause ends that begins at a word, 0 where it is one word."""
        end = at
        while text.words[end] not in _ENDS:
            has_comma = text.words[end] == ","
            then = find(self._then, text.words, end + has_comma)
            if then is not None and text.words[then[1]] not in _ENDS:  # but `she is next`
                break
            if has_comma and find(self._otherwise, text.words, end + 1) is not None:
                break
            end += 1
        return end if end > at + 1 else 0
