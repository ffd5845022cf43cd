"""Reads noun phrases in a text for one set of names. What each word begins is looked for once, for all types."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.text.words import Words
from btlang.vocabulary.likenesses import Likenesses
from btlang.vocabulary.nouns import Description, Nouns
from btlang.vocabulary.references import ALL
from btlang.vocabulary.word_tree import WordTree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    Found: TypeAlias = tuple[Description, int] | None


class NounReader:
    """Reads them by the `nouns` of a language. `names` gives the word tree of the names that a slot of a type takes."""

    def __init__(self, nouns: Nouns, names: Callable[[str], WordTree], likenesses: Likenesses) -> None:
        self._nouns, self._names, self._likenesses = nouns, names, likenesses
        self._adjective_starts: frozenset[str] | None = None

    @property
    def adjective_starts(self) -> frozenset[str]:
        """The words at which what stands before a head may begin: `my`, `big`."""
        if self._adjective_starts is None:
            self._adjective_starts = self._nouns.adjectives.starts(self._names, self._likenesses.is_ever_told)
        return self._adjective_starts

    def one(self, text: Words, at: int, kind: str = "") -> Found:
        """The longest noun phrase of a type at a word, "" for any type, and where it ends."""
        return self._found(text, at, is_plural=False).get(kind)

    def all(self, text: Words, at: int, kind: str = "") -> Found:
        """All names that a noun such as `places` or `red cup` is for, and where it ends."""
        named, found = self._nouns.type_at(text, at), self.one(text, at, kind)
        if named is not None and kind in ("", named[0]) and self._likenesses.fits(named[0], ()):
            if found is None or (found[1] <= named[1] and not found[0].parts):
                return Description(named[0], ALL), named[1]
        return (found[0].replace(how=ALL), found[1]) if found is not None and found[0].parts else None

    def several(self, text: Words, at: int, kind: str = "") -> Found:
        """The longest one in the plural, else all that a noun is for."""
        return self._found(text, at, is_plural=True).get(kind) or self.all(text, at, kind)

    def _found(self, text: Words, at: int, *, is_plural: bool) -> Mapping[str, tuple[Description, int]]:
        memo: dict[tuple[int, str], Any] = text.memo.setdefault(self, {})
        key = at, "several" if is_plural else "one"
        if key not in memo:
            read = self._nouns.plural if is_plural else self._nouns.longest
            memo[key] = read(text, at, self._names, self._likenesses.fits, self.adjective_starts)
        return memo[key]  # type: ignore[no-any-return]
