"""The state of the readers of a text: all of their attributes that a line may change, found by looking at them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.calls import Calls
from btlang.support.record import Record
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import Known

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Fields: TypeAlias = list[tuple[object, str]]

_LARGE = 16  # items from which on a container that is as large as it was is taken for a table of the language
_READERS = "btlang.frontends.mission.tokens."

_PASSING = frozenset(("_origin", "_root", "_shares", "_bounds", "_looked", "_found", "_told", "_untold", "_verb_forms"))
"""Attributes that no line leaves behind: each line sets them before it uses them, they are caches that begin anew with
each line, they count unknown words (a line that has any isn't kept), or they have words by their endings alone.
"""
_DERIVED = frozenset(("_most_words", "openers"))
"""Attributes that follow from what is known."""
_PLACED = frozenset((
    "_named_at", "_denied", "_lists", "_alternatives", "_said", "sharing", "same", "reached",
    "is_used", "has_named", "has_denied",
))  # fmt: skip
"""Attributes with places of words and tokens, which are dealt with one by one."""


class NotComparableError(Exception):
    """A state that isn't told by its values alone."""


def parts_of(reader: object, context: object) -> list[object]:
    """Return the readers of one text, each once, with all that they keep once they were asked for it."""
    parts = [reader, context]
    for part in parts:
        for kind in type(part).__mro__:
            for name, value in vars(kind).items():
                if isinstance(value, cached_property):
                    getattr(part, name)  # so that it isn't a line that does it
        for name in _attributes(part):
            value = getattr(part, name)
            if type(value).__module__.startswith(_READERS) and type(value).__name__[0].isupper():
                if not isinstance(value, Record | Token | list | dict) and all(value is not other for other in parts):
                    parts.append(value)
    return parts


def state_fields(parts: Sequence[object]) -> Fields:
    """Return the attributes of readers that belong to their state, but those with places."""
    ignored = _PASSING | _PLACED | _DERIVED
    return [
        (part, name)
        for part in parts
        for name in _attributes(part)
        if name not in ignored and not _is_service(getattr(part, name))
    ]


def _attributes(part: object) -> Iterator[str]:
    """Yield the names of the attributes of an object that has them all."""
    yield from sorted(vars(part)) if hasattr(part, "__dict__") else ()
    for kind in type(part).__mro__:
        yield from (name for name in getattr(kind, "__slots__", ()) if hasattr(part, name))


def _is_service(value: object) -> bool:
    """Return whether a value is no state, but what others do: a reader, the text, a vocabulary, a function."""
    if isinstance(value, Record | Token):
        return False
    if isinstance(value, dict) and value and all(map(callable, value.values())):
        return True
    return callable(value) or type(value).__module__.startswith("btlang.")


def size_of(value: object) -> int:
    """Return how many items a value has that lines may change in place; -1 for others."""
    return len(value) if isinstance(value, list | dict | set) else -1


def is_constant(value: object, size: int) -> bool:
    """Return whether a value that is still the first one has not changed; its `size` was the first one's."""
    return size < 0 or (size > _LARGE and size_of(value) == size)


def content_of(value: Any) -> object:
    """Return what of a value is compared. Raises NotComparableError for one with tokens or places."""
    if isinstance(value, dict):
        return tuple(value.items()) if _is_plain(value) else id(value)
    if isinstance(value, list | tuple):
        return tuple([content_of(each) for each in value])
    if isinstance(value, set | frozenset):
        return frozenset(value)
    if isinstance(value, Entry):
        return id(value)  # there is one of each
    if isinstance(value, Token) or (type(value) is int and value):
        raise NotComparableError
    return value


def copied(value: Any) -> Any:
    """Return a value that doesn't change with another one."""
    if isinstance(value, dict):
        return dict(value) if _is_plain(value) else value
    if isinstance(value, list):
        return [copied(each) for each in value]
    if type(value) is tuple:
        return tuple([copied(each) for each in value])
    return set(value) if type(value) is set else value


def moved(match: Match | None, words: int) -> Match | None:
    """Return a phrase so many words further on."""
    if match is None:
        return None
    values = [value.replace(first=value.first + words, last=value.last + words) for value in match.values]
    return match.replace(last=match.last + words, values=tuple(values))  # type: ignore[no-any-return]


def _is_plain(values: dict[Any, Any]) -> bool:
    """Return whether a dict has values that lines note in it; others are those of a vocabulary, which don't change."""
    return all(isinstance(each, str | bool | Known) for each in values.values())


class WatchedCalls(Calls):
    """Those of a text that is watched: they note which of their attributes with places are used."""

    is_used = has_named = has_denied = False

    def begin(self) -> None:
        """Forget what was used."""
        self.is_used = self.has_named = self.has_denied = False

    @property
    def has_lists(self) -> bool:
        """Whether a list may become a round."""
        return bool(vars(self)["_lists"])

    @property
    def _named_at(self) -> int:
        self.is_used |= not self.has_named and vars(self)["_named_at"] > 0
        return vars(self)["_named_at"]  # type: ignore[no-any-return]

    @_named_at.setter
    def _named_at(self, at: int) -> None:
        self.has_named = True
        vars(self)["_named_at"] = at

    @property
    def _denied(self) -> Any:
        self.is_used |= vars(self)["_denied"] is not None
        return vars(self)["_denied"]

    @_denied.setter
    def _denied(self, match: Any) -> None:
        self.has_denied = True
        vars(self)["_denied"] = match

    @property
    def _lists(self) -> Any:
        self.is_used |= bool(vars(self)["_lists"])
        return vars(self)["_lists"]

    @_lists.setter
    def _lists(self, lists: Any) -> None:
        vars(self)["_lists"] = lists
