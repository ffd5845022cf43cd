"""Python functions and classes as words: the decorators `btlang.action`, `btlang.condition` and `btlang.quantity`."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import wraps

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.text.source import NOWHERE, find_calling_line
from btlang.vocabulary.capabilities import resources_of
from btlang.vocabulary.entry import Entry, SlotSpec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ParamSpec, Protocol, TypeAlias, TypeVar, overload

    from btlang.vocabulary.ros_binding import RosBinding

    Call = TypeVar("Call", bound=Callable[..., Any])
    Phrases: TypeAlias = str | Sequence[str]
    Slots: TypeAlias = Mapping[str, str | Mapping[str, str]]
    Options = ParamSpec("Options")

    class Decorator(Protocol[Options]):
        """A decorator that may stand above a function with its options in parentheses, or without both."""

        @overload
        def __call__(self, function: Call, /) -> Call: ...
        @overload
        def __call__(self, *args: Options.args, **kwargs: Options.kwargs) -> Callable[[Call], Call]: ...


def _also_bare(made: Callable[Options, Callable[[Call], Call]]) -> Decorator[Options]:
    """A decorator that does without parentheses what it does with empty ones."""

    @wraps(made)
    def decorator(*given: Any, **options: Any) -> Any:
        bare = len(given) == 1 and callable(given[0])
        return made()(given[0]) if bare else made(*given, **options)  # type: ignore[call-arg]

    return decorator


@_also_bare
def action(
    phrase: Phrases = "",
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

    The options are the keys of an entry in a keyword file (docs/keywords.md). `phrase` is one pattern or several, by
    default the name of the function and a slot for each of its parameters. `id` is the node's name, by default the name
    of the function in CamelCase. `help` is the docstring by default. btlang/engine/leaves/leaf.py describes what a leaf
    can be. `@action` without parentheses is the same as `@action()`. Raises ValueError for a `ros` table with mistakes,
    MissionError (BT061) for a phrase with mistakes.

    The type of a slot is what `slots` says (a type, or a type and a default), else what its annotation says (see
    btlang.slots), else the type with the slot's name, else "count" for an int, "number" for a float, "text" for a str.

    With `replace` it replaces the known word with this id, or with this phrase if there is no id: a fake for tests.
    Without it a second function for the same id is an error (BT064).
    """
    return _word("action", phrase, id, slots or {}, ros, replace, needs, resources, topic=topic, help=help,
                 example=example, accompaniment=accompaniment, instant=instant, uninterruptible=uninterruptible,
                 thread=thread, touches=touches)  # fmt: skip


@_also_bare
def condition(
    phrase: Phrases = "",
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
    from btlang.vocabulary.pattern import PatternError, Slot, forms

    given = (phrase,) if isinstance(phrase, str) else tuple(phrase)
    span = find_calling_line()

    def decorate(call: Call) -> Call:
        phrases = given if any(given) else (_phrase_of(call),)
        try:
            parts = [part for text in phrases for form in forms(text) for part in form]
        except PatternError as error:
            raise MissionError([diagnostic("BT061", span or NOWHERE, reason=str(error))]) from None
        types = _annotated(call)
        names = dict.fromkeys(part.name for part in parts if isinstance(part, Slot))
        specs = tuple(_slot(name, slots[name]) if name in slots else SlotSpec(name, *types.get(name, (name, None, "")))
                      for name in names)  # fmt: skip
        camel_case = "".join(part[:1].upper() + part[1:] for part in call.__name__.split("_"))
        made = node_id or ("" if replace else camel_case)
        is_quantity = sort == "quantity"
        taken = tuple(dict.fromkeys((*resources, *resources_of(needs)))) if sort == "action" else ()
        entry = Entry(
            "condition" if is_quantity else sort, made, () if is_quantity else phrases, call, specs,
            quantity=phrases if is_quantity else (), ros=_ros(ros, sort), replaces=replace,
            needs=tuple(needs), resources=taken, span=span,
            **{**keys, "help": keys["help"] or call.__doc__ or ""},
        )  # fmt: skip
        call.btlang_entry = entry  # type: ignore[attr-defined]
        return call

    return decorate


def _slot(name: str, spec: str | Mapping[str, str]) -> SlotSpec:
    if isinstance(spec, str):
        return SlotSpec(name, spec)
    return SlotSpec(name, spec.get("type", name), spec.get("default"))


_CAPITAL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_OF_PYTHON = {"int": "count", "float": "number", "str": "text"}
_SERVICES = ("self", "robot", "clock", "blackboard", "wake", "wake_at", "progress", "beside", "halted", "kept")


def _parameters(call: Any) -> dict[str, Any]:
    """The parameters that slots may fill, of a function or of the `start` of a class."""
    from inspect import isclass, signature

    begin: Any = getattr(call, "start", None) if isclass(call) else call
    try:
        found = signature(begin).parameters
    except (TypeError, ValueError):
        return {}
    return {name: found[name] for name in found if name not in _SERVICES}


def _phrase_of(call: Any) -> str:
    words = _CAPITAL.sub(" ", call.__name__).replace("_", " ").lower()  # of the class CountDown: count down
    return " ".join([words, *(f"{{{name}}}" for name in _parameters(call))])


def _annotated(call: Any) -> dict[str, tuple[str, None, str]]:
    """The types of slots by their names: the one to take, no default, and the one to take if it doesn't exist."""
    from typing import Annotated, get_args, get_origin

    found: dict[str, tuple[str, None, str]] = {}
    scope = {**getattr(sys.modules.get(call.__module__), "__dict__", {}), **getattr(call, "__globals__", {})}
    for name, parameter in _parameters(call).items():
        kind = parameter.annotation
        try:
            kind = eval(kind, scope) if isinstance(kind, str) else kind  # what typing.get_type_hints does, one by one
        except Exception:  # a name for type checkers alone
            continue
        named = [text for text in get_args(kind)[1:] if isinstance(text, str)] if get_origin(kind) is Annotated else []
        found[name] = (named[0] if named else name, None, _OF_PYTHON.get(getattr(kind, "__name__", ""), ""))
    return found


def _ros(table: Mapping[str, Any] | None, sort: str) -> RosBinding | None:
    if table is None:
        return None
    from btlang.vocabulary.ros_table import read_ros

    binding, wrong = read_ros(dict(table), sort)
    if wrong:
        raise ValueError("; ".join(reason for reason, _ in wrong))
    return binding
