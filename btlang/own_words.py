"""Python functions and classes as words: the decorators `btlang.action` and `btlang.condition`."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.vocabulary.entry import Entry, SlotSpec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    Call = TypeVar("Call", bound=Callable[..., Any])


def action(
    phrase: str | Sequence[str],
    *,
    id: str = "",
    slots: dict[str, str] | None = None,
    resources: Sequence[str] = (),
    thread: bool = False,
) -> Callable[[Call], Call]:
    """Makes a function, generator function, `async def` function or class a command: `parse_tree(keywords=[...])`.

    `phrase` is one pattern or several, `slots` gives types to slots whose name is not a type, `id` is the node's name,
    by default that of the function in CamelCase. With `thread` a plain function works in a thread of its own. See
    btlang/engine/leaf.py for what a leaf may be.
    """
    return _word("action", phrase, id, slots or {}, resources, thread)


def condition(
    phrase: str | Sequence[str], *, id: str = "", slots: dict[str, str] | None = None
) -> Callable[[Call], Call]:
    """Makes a function that returns a bool a condition; as `action`."""
    return _word("condition", phrase, id, slots or {}, (), False)


def _word(
    sort: str, phrase: str | Sequence[str], node_id: str, slots: dict[str, str], resources: Sequence[str], thread: bool
) -> Callable[[Call], Call]:
    from btlang.vocabulary.pattern import Slot, forms

    phrases = (phrase,) if isinstance(phrase, str) else tuple(phrase)

    def decorate(call: Call) -> Call:
        names = dict.fromkeys(p.name for text in phrases for form in forms(text) for p in form if isinstance(p, Slot))
        specs = tuple(SlotSpec(name, slots.get(name, name)) for name in names)
        made = node_id or "".join(part.title() for part in call.__name__.split("_"))
        entry = Entry(sort, made, phrases, call, specs, tuple(resources), help=call.__doc__ or "", thread=thread)
        call.btlang_entry = entry  # type: ignore[attr-defined]
        return call

    return decorate
