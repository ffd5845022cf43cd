"""Python functions and classes as words: the decorators `btlang.action`, `btlang.condition` and `btlang.quantity`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from btlang.vocabulary.capabilities import resources_of
from btlang.vocabulary.entry import Entry, SlotSpec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias, TypeVar

    from btlang.vocabulary.ros_binding import RosBinding

    Call = TypeVar("Call", bound=Callable[..., Any])
    Phrases: TypeAlias = str | Sequence[str]
    Slots: TypeAlias = Mapping[str, str | Mapping[str, str]]


def action(
    phrase: Phrases,
    *,
    id: str = "",
    slots: Slots | None = None,
    resources: Sequence[str] = (),
    needs: Sequence[str] = (),
    topic: str = "",
    help: str = "",
    example: str = "",
    accompaniment: bool = False,
    instant: bool = False,
    uninterruptible: bool = False,
    touches: bool = False,
    thread: bool = False,
    ros: Mapping[str, Any] | None = None,
    replace: bool = False,
) -> Callable[[Call], Call]:
    """Turns a function, generator function, `async def` function or class into a command: `parse_tree(keywords=[...])`.

    The options are the keys of an entry in a keyword file (docs/keywords.md). `phrase` is one pattern or several.
    `slots` gives a type, or a type and a default, to slots with a name that isn't a type. `id` is the node's name, by
    default the name of the function in CamelCase. `help` is the docstring by default. btlang/engine/leaves/leaf.py
    describes what a leaf can be. Raises ValueError for a `ros` table with mistakes.

    With `replace` it replaces the known word with this id, or with this phrase if there is no id: a fake for tests.
    Without it a second function for the same id is an error (BT064).
    """
    return _word("action", phrase, id, slots or {}, ros, replace, needs, resources, topic=topic, help=help,
                 example=example, accompaniment=accompaniment, instant=instant, uninterruptible=uninterruptible,
                 thread=thread, touches=touches)  # fmt: skip


def condition(
    phrase: Phrases,
    *,
    id: str = "",
    slots: Slots | None = None,
    needs: Sequence[str] = (),
    topic: str = "",
    help: str = "",
    example: str = "",
    ros: Mapping[str, Any] | None = None,
    replace: bool = False,
) -> Callable[[Call], Call]:
    """Turns a function that returns a bool into a condition. See `action`."""
    return _word("condition", phrase, id, slots or {}, ros, replace, needs, topic=topic, help=help, example=example)


def quantity(
    phrase: Phrases,
    *,
    type: str,
    id: str = "",
    slots: Slots | None = None,
    needs: Sequence[str] = (),
    topic: str = "",
    help: str = "",
    example: str = "",
    ros: Mapping[str, Any] | None = None,
    replace: bool = False,
) -> Callable[[Call], Call]:
    """Turns a function that returns a number of this type, such as "length", into a quantity that missions compare.

    The number is in the unit with factor 1. See `action`.
    """
    return _word("quantity", phrase, id, slots or {}, ros, replace, needs, topic=topic, help=help, example=example,
                 measures=type)  # fmt: skip


def _word(
    sort: str,
    phrase: Phrases,
    node_id: str,
    slots: Slots,
    ros: Mapping[str, Any] | None,
    replace: bool,
    needs: Sequence[str],
    resources: Sequence[str] = (),
    **keys: Any,
) -> Callable[[Call], Call]:
    from btlang.vocabulary.pattern import Slot, forms

    phrases = (phrase,) if isinstance(phrase, str) else tuple(phrase)

    def decorate(call: Call) -> Call:
        names = dict.fromkeys(p.name for text in phrases for form in forms(text) for p in form if isinstance(p, Slot))
        specs = tuple(_slot(name, slots.get(name, name)) for name in names)
        made = node_id or ("" if replace else "".join(part.title() for part in call.__name__.split("_")))
        is_quantity = sort == "quantity"
        taken = tuple(dict.fromkeys((*resources, *resources_of(needs)))) if sort == "action" else ()
        entry = Entry(
            "condition" if is_quantity else sort, made, () if is_quantity else phrases, call, specs,
            quantity=phrases if is_quantity else (), ros=_ros(ros, sort), replaces=replace,
            needs=tuple(needs), resources=taken,
            **{**keys, "help": keys["help"] or call.__doc__ or ""},
        )  # fmt: skip
        call.btlang_entry = entry  # type: ignore[attr-defined]
        return call

    return decorate


def _slot(name: str, spec: str | Mapping[str, str]) -> SlotSpec:
    if isinstance(spec, str):
        return SlotSpec(name, spec)
    return SlotSpec(name, spec.get("type", name), spec.get("default"))


def _ros(table: Mapping[str, Any] | None, sort: str) -> RosBinding | None:
    if table is None:
        return None
    from btlang.vocabulary.ros_table import read_ros

    binding, wrong = read_ros(dict(table), sort)
    if wrong:
        raise ValueError("; ".join(reason for reason, _ in wrong))
    return binding
