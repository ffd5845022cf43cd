"""Lists, dicts and sets that note what readers look at, so that it is known what a reading depends on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class LookedAt(list["Any"]):
    """A list that notes the lowest and the highest place that was looked at, and the lowest that has changed."""

    low, high, cut = 0, 0, 0

    def begin(self) -> None:
        """Forget what was looked at, and what has changed."""
        self.low, self.high, self.cut = len(self) + 1, -1, len(self)

    def plain(self) -> list[Any]:
        """Return a list of the same that notes nothing."""
        return list.__getitem__(self, slice(None))

    def _note(self, first: int, last: int) -> None:
        if first <= last:
            self.low, self.high = min(self.low, first), max(self.high, last)

    def _change(self, at: int | slice) -> None:
        first = at.indices(len(self))[0] if isinstance(at, slice) else range(len(self))[at]
        self.cut = min(self.cut, first)

    def __getitem__(self, at: Any) -> Any:
        if type(at) is slice:
            first, last, step = at.indices(len(self))
            self._note(first, last - 1) if step > 0 else self._note(last + 1, first)
        else:
            self._note(at + len(self) if at < 0 else at, at + len(self) if at < 0 else at)
        return list.__getitem__(self, at)

    def __iter__(self) -> Iterator[Any]:
        self._note(0, len(self) - 1)
        return list.__iter__(self)

    def __reversed__(self) -> Iterator[Any]:
        return (self[at] for at in reversed(range(len(self))))

    def __contains__(self, value: object) -> bool:
        self._note(0, len(self) - 1)
        return list.__contains__(self, value)

    def __eq__(self, other: object) -> bool:
        self._note(0, len(self) - 1)
        return list.__eq__(self, other)

    __hash__ = None

    def __add__(self, other: list[Any]) -> list[Any]:
        return [*self, *other]

    def index(self, value: Any, *bounds: Any) -> int:
        self._note(0, len(self) - 1)
        return list.index(self, value, *bounds)

    def count(self, value: Any) -> int:
        self._note(0, len(self) - 1)
        return list.count(self, value)

    def copy(self) -> list[Any]:
        return [*self]

    def __setitem__(self, at: Any, value: Any) -> None:
        self._change(at)
        list.__setitem__(self, at, value)

    def __delitem__(self, at: Any) -> None:
        self._change(at)
        list.__delitem__(self, at)

    def pop(self, at: Any = -1) -> Any:
        self._change(at)
        self[at]
        return list.pop(self, at)

    def insert(self, at: Any, value: Any) -> None:
        self._change(slice(at, None))
        list.insert(self, at, value)

    def remove(self, value: Any) -> None:
        del self[self.index(value)]

    def reverse(self) -> None:
        self[:] = self[::-1]

    def sort(self, **how: Any) -> None:
        self[:] = sorted(self, **how)

    def clear(self) -> None:
        del self[:]


class LookedUp(dict["Any", "Any"]):
    """A dict that notes whether something in it was found, or has changed; most are empty."""

    is_used = False

    def _use(self, is_used: bool) -> None:
        self.is_used = self.is_used or is_used

    def __getitem__(self, key: Any) -> Any:
        self._use(True)
        return dict.__getitem__(self, key)

    def get(self, key: Any, default: Any = None) -> Any:
        self._use(dict.__contains__(self, key))
        return dict.get(self, key, default)

    def __contains__(self, key: object) -> bool:
        self._use(dict.__contains__(self, key))
        return dict.__contains__(self, key)

    def __iter__(self) -> Iterator[Any]:
        self._use(len(self) > 0)
        return dict.__iter__(self)

    def keys(self) -> Any:
        self._use(len(self) > 0)
        return dict.keys(self)

    def items(self) -> Any:
        self._use(len(self) > 0)
        return dict.items(self)

    def values(self) -> Any:
        self._use(len(self) > 0)
        return dict.values(self)

    def __setitem__(self, key: Any, value: Any) -> None:
        self._use(True)
        dict.__setitem__(self, key, value)

    def __delitem__(self, key: Any) -> None:
        self._use(True)
        dict.__delitem__(self, key)

    def pop(self, key: Any, *default: Any) -> Any:
        self._use(dict.__contains__(self, key))
        return dict.pop(self, key, *default)

    def setdefault(self, key: Any, default: Any = None) -> Any:
        self._use(True)
        return dict.setdefault(self, key, default)

    def update(self, *given: Any, **named: Any) -> None:
        self._use(True)
        dict.update(self, *given, **named)

    def clear(self) -> None:
        self._use(len(self) > 0)
        dict.clear(self)


class WordsLookedUp(frozenset[str]):
    """The words of a text, each once, which note which of them were asked for, and whether none of these is there.

    A text is asked for the words below a node of a trie only to save the search for what isn't there.
    """

    asked: dict[frozenset[str], bool]
    is_read = False
    """Whether somebody went through them all."""

    def isdisjoint(self, words: Iterable[object]) -> bool:
        if type(words) is dict:
            return frozenset.isdisjoint(self, words)
        of: frozenset[Any] = frozenset(words)
        answer = self.asked[of] = frozenset.isdisjoint(self, of)
        return answer

    def __contains__(self, word: object) -> bool:
        return not self.isdisjoint((word,))

    def __iter__(self) -> Iterator[str]:
        self.is_read = True
        return frozenset.__iter__(self)

    def agrees(self, asked: dict[frozenset[str], bool]) -> bool:
        """Return whether the answers to these questions are the same."""
        return all(frozenset.isdisjoint(self, of) == answer for of, answer in asked.items())
