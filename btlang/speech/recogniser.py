"""What a recogniser of speech is: sound becomes sentences of what is listened for, given as a grammar."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    class Recogniser(Protocol):
        """A recogniser of speech from one microphone, made with RecogniserSettings, for one thread apart from the tick.

        No call may take longer than a few hundredths of a second. Raises RecogniserError if it can't be used.
        """

        def expect(self, expected: Expected) -> None:
            """Set what is listened for from now on, also within a sentence."""

        def hear(self, samples: bytes) -> Sequence[RecognisedSpeech]:
            """Take the next samples, 16 bits signed, mono, 16 kHz; return the sentences that have ended in them."""

        def end(self) -> Sequence[RecognisedSpeech]:
            """End a sentence after the samples so far: the speaker has released the button."""

        def forget(self) -> None:
            """Drop what was heard so far."""


Mode = Literal["open", "wake", "addressed", "pushed"]
RATE = 16_000
"""Samples a second for recognisers."""
_TOKEN = re.compile(r"[\[\]]|\{\w+\}|[^\s\[\]{}]+")
_WORD = re.compile(r"[a-z']*[a-z][a-z']*|[0-9]+")
_ONES = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
    "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen",
)  # fmt: skip
_TENS = ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")
_NOTHING = "<VOID>"


class RecogniserError(Exception):
    """The reason why a recogniser can't be used."""


class RecogniserSettings(Record):
    """A `language` such as "en". With `push`, a button shows when somebody speaks, else the recogniser finds out."""

    language: str = "en"
    push: bool = False


class Expected(Record):
    """The speech that is expected: `phrases` and their `names` as in this module, and with `anything` all else too.

    Recognisers that always find the nearest phrase know `others` too, which aren't heard: what could be taken for the
    contrary of a phrase. In the `mode` "open" anybody may say anything, in "wake" all phrases begin with the wake word,
    in "addressed" the speaker has woken the robot or was asked, and in "pushed" the speaker holds its button.
    """

    phrases: tuple[str, ...] = ()
    names: Mapping[str, tuple[str, ...]] = {}
    anything: bool = False
    mode: Mode = "open"
    others: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.phrases) or self.anything

    def __or__(self, other: Expected) -> Expected:
        """Return both together."""
        phrases, names = tuple(dict.fromkeys(self.phrases + other.phrases)), {**self.names, **other.names}
        others = tuple(dict.fromkeys(self.others + other.others))
        return Expected(phrases, names, self.anything or other.anything, self.mode, others)


class RecognisedSpeech(Record):
    """A sentence that was said. If it isn't `sure`, it may have been another one."""

    text: str
    sure: bool = True


def spoken(text: str) -> str:
    """Return the words that are said for a text: lower case without accents, numbers as words.

    "" for a text without words. As a phrase of a grammar they mean only themselves.
    """
    plain = unicodedata.normalize("NFKD", text.lower().replace("\u2019", "'")).encode("ascii", "ignore").decode()
    return " ".join(_number(word) if word.isdigit() else word for word in _WORD.findall(plain))


class Grammar:
    """The sentences of what is expected. Brackets without a partner, and names that nobody can say, are left out."""

    def __init__(self, expected: Expected) -> None:
        self._names = {kind: {spoken(name): name for name in names} for kind, names in expected.names.items()}
        for names in self._names.values():
            names.pop("", None)
        phrases = [tokens for tokens in map(self._tokens, expected.phrases) if tokens]
        self._pattern = re.compile("|".join(self._regex(tokens) for tokens in phrases) or "(?!)")
        others = [self._tokens(other) for other in expected.others if phrases and not self.holds(other)]
        self._phrases = phrases + [tokens for tokens in others if tokens]
        by_name = {said: name for names in self._names.values() for said, name in names.items() if said != name}
        longest = sorted(by_name, key=len, reverse=True)
        self._written, self._by_name = re.compile(rf"\b({'|'.join(longest)})\b" if longest else "(?!)"), by_name

    @property
    def words(self) -> list[str]:
        """Each word once, in alphabetical order."""
        said = (word for tokens in self._phrases for token in tokens for word in self._said(token))
        return sorted({each for word in said for each in word.split()})

    @property
    def jsgf(self) -> str:
        """The grammar in the JSpeech Grammar Format."""
        rules = [f"<{kind}> = {' | '.join(names) or _NOTHING};" for kind, names in self._names.items()]
        sentences = " | ".join(" ".join(map(self._rule, tokens)) for tokens in self._phrases) or _NOTHING
        return "\n".join(("#JSGF V1.0;", "grammar expected;", *rules, f"public <sentence> = {sentences};", ""))

    def holds(self, text: str) -> bool:
        """Return whether a text, as it is spoken, is one whole sentence of the grammar, and none of the others."""
        return self._pattern.fullmatch(f"{spoken(text)} ") is not None

    def written(self, text: str) -> str:
        """Return a spoken sentence with names as they are written."""
        return self._written.sub(lambda match: self._by_name[match[0]], text)

    def _tokens(self, phrase: str) -> list[str]:
        tokens = _TOKEN.findall(phrase)
        kinds = {token[1:-1] for token in tokens if token[0] == "{"}
        depth = 0
        for token in tokens:
            depth += (token == "[") - (token == "]")
            if depth not in (0, 1):
                return []
        return tokens if depth == 0 and all(self._names.get(kind) for kind in kinds) else []

    def _said(self, token: str) -> Iterator[str]:
        if token[0] == "{":
            yield from self._names[token[1:-1]]
        elif token not in "[]":
            yield from filter(None, map(spoken, token.split("/")))

    def _rule(self, token: str) -> str:
        if token in "[]":
            return token
        return f"<{token[1:-1]}>" if token[0] == "{" else f"({' | '.join(self._said(token)) or '<NULL>'})"

    def _regex(self, tokens: list[str]) -> str:
        brackets = {"[": "(?:", "]": ")?"}
        return "".join(
            brackets.get(token) or f"(?:{'|'.join(f'{each} ' for each in self._said(token))})" for token in tokens
        )


def _number(digits: str) -> str:
    number = int(digits) if len(digits) < 3 else 100
    if number < len(_ONES) and not (len(digits) > 1 and digits[0] == "0"):
        return _ONES[number]
    if number < 100 and digits[0] != "0":
        ones = f" {_ONES[number % 10]}" if number % 10 else ""
        return f"{_TENS[number // 10 - 2]}{ones}"
    return " ".join(_ONES[int(digit)] for digit in digits)
