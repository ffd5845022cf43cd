"""Texts: in quotes, one word, a saying such as `good morning`, or a clause, as in `tell Bob that tea is ready`.

A clause ends with its statement, or before a word such as `then`. It is in doubt where it may end sooner, and where it
has a pronoun for a person, which whoever hears it would take for somebody else.
"""

from __future__ import annotations

from collections.abc import Mapping

from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.word_tree import WordTree, find, tree_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_ENDS = frozenset((END_OF_STATEMENT, END_OF_TEXT))
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
        self._openers = frozenset(language["clause_openers"])
        self._sayings = tree_of((phrase, True) for phrase in language["sayings"])
        self._then = words_of("then")
        self._direct = tree_of((words, said) for said, clauses in language["direct"].items() for words in ways(clauses))
        self.of_persons = frozenset(language["of_persons"])
        """Words for persons that are others for whoever hears them."""
        self._joining = set().union(*map(words_of, _JOINING))
        self._doubtful = {*_MARKS, *self.of_persons, *self._joining}

    def read(self, text: Words, at: int) -> tuple[str, int] | None:
        """The text that begins at a word and where it ends."""
        word = text.words[at]
        if word[0] == '"':
            return word[1:], at + 1
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
        found = find(self._sayings, text.words, at) if text.words[at] in self._sayings else None
        return found[1] if found is not None else 0

    def _is_clause(self, text: Words, at: int) -> bool:
        """Whether a word begins a clause, of which it says nothing alone: `ask Bob if he is hungry`."""
        behind = text.words[at + 1] if text.words[at] in self._clause_words else END_OF_TEXT
        return behind[0].isalpha() and behind not in self._joining and behind not in self._then

    def opens(self, word: str) -> bool:
        """Whether a clause stands behind a word."""
        return word in self._openers

    def doubt(self, text: Words, first: int, last: int) -> int:
        """The word of a text without quotes that may end it, or be understood as somebody else; 0 if there is none."""
        return next((at for at in range(first, last) if text.words[at] in self._doubtful), 0)

    def direct(self, text: Words, first: int, last: int) -> str | None:
        """The question that a clause stands for: `he is hungry` as "Are you hungry?"; None where that can't be told."""
        front = find(self._direct, text.words, first)
        if front is None or front[1] >= last or any(word in self._doubtful for word in text.words[front[1] : last]):
            return None
        behind = text.source.text[text.begin(front[1]) : text.ends[last - 1]]
        return f"{front[0][0].upper()}{front[0][1:]} {behind}?"

    def end_of_clause(self, text: Words, at: int) -> int:
        """Where the clause ends that begins at a word, 0 where it is one word."""
        end = at
        while text.words[end] not in _ENDS:
            if find(self._then, text.words, end + (text.words[end] == ",")) is not None:
                break
            end += 1
        return end if end > at + 1 else 0
