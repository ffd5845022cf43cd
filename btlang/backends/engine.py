"""The engine as a target: leaf ids are bound to the Python that `call` in a keyword file names, just before a run."""

from __future__ import annotations

import operator
import os
import sys
from collections.abc import Callable, Mapping
from functools import wraps
from importlib import import_module
from importlib.util import find_spec
from inspect import Parameter, signature
from types import ModuleType

from btlang.engine.instance import EngineError
from btlang.engine.leaves.leaf import Failed, LeafBinding, Unknown, describe_exception
from btlang.engine.script.values import as_text, as_whole
from btlang.printer.phrase import leaf_words
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node, Tree
from btlang.vocabulary.entry import MEASURED, Entry, SlotSpec
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Collection, Generator
    from typing import Any

_packages: dict[str, str] = {}  # of the modules beside keyword files, by their folders
_MOVED = {
    "btlang.actions.commands:do_what_somebody_says": "btlang.actions.conversation:do_what_somebody_says",
    "btlang.actions.show:bow": "btlang.actions.gestures:bow",
    "btlang.actions.show:dance": "btlang.actions.gestures:dance",
    "btlang.actions.sides:go_to_side": "btlang.actions.navigation:go_to_side",
}
"""Where functions that keyword files of 0.1 may name in `call` are now."""
_AS_GOOD_AS_EQUAL = 1e-9
_MOST_DIGITS = 17  # all that a double has


def bind_leaf(
    node_id: str,
    vocabulary: Lexicon,
    own: Callable[[Entry, Lexicon], LeafBinding | None] | None = None,
    find_awaited: Collection[str] = (),
) -> LeafBinding | None:
    """Bind an id, None if no keyword entry has it. Raises EngineError if its `call` leads nowhere or is of no use.

    `own` is how the robot of the run binds an entry; what it leaves is bound by `call`. The latest entry that it binds
    counts, so that a keyword file can bind words that ship. An entry that replaces the others goes before the robot.
    `find_awaited` are the ids of conditions for which the mission waits: see btlang.backends.engine.
    """
    entries = vocabulary.entries.get(node_id, ())
    replacing = [entry for entry in entries if entry.replaces]
    for entry in reversed(entries) if own is not None and not replacing else ():
        binding = own(entry, vocabulary)  # type: ignore[misc]
        if binding is not None:
            return binding.replace(condition=True) if entry.sort != "action" else binding
    if not entries:
        return None
    entry = (replacing or entries)[-1 if replacing else 0]
    slots = {slot.name: slot for other in entries for slot in other.slots}
    call = import_call(entry)
    if entry.touches and (entry.sort == "action" or node_id in find_awaited):
        call = allow_touching(call)
    return leaf_binding(entry, vocabulary, call, tuple(slots.values()))


def leaf_binding(
    entry: Entry, vocabulary: Lexicon, call: Callable[..., Any], slots: tuple[SlotSpec, ...]
) -> LeafBinding:
    """Return the binding that does the work of an entry, with the values of slots as its parameters.

    Raises EngineError where it is of no use for such an entry.
    """
    from inspect import iscoroutinefunction

    converters = {slot.name: _converter(slot, vocabulary) for slot in slots}
    defaults = {slot.name: slot.default for slot in slots if slot.default is not None}
    if entry.sort == "condition" and iscoroutinefunction(call):
        raise EngineError("it is asynchronous, but a condition must answer at once", Node(entry.id, span=entry.span))
    if not entry.measures:
        binding = LeafBinding(call, converters, defaults, entry.outputs, thread=entry.thread)
        return binding if entry.sort == "action" else binding.replace(refusal="it is not true", condition=True)

    def say(given: Mapping[str, Any], value: str) -> str:
        ports = {slot.name: str(given[slot.name]) for slot in slots if slot.name in given}
        return leaf_words(entry.id, {**ports, "equal": value}, vocabulary) or f"it is {value}"

    try:
        compare = compare_quantity(call, say)
        measured = compare.measured  # type: ignore[attr-defined]
        return LeafBinding(compare, converters, defaults, (MEASURED,), condition=True, measured=measured)
    except (TypeError, ValueError) as error:
        raise EngineError(f"{entry.call} cannot be a quantity: {error}", Node(entry.id, span=entry.span)) from error


def _converter(slot: SlotSpec, vocabulary: Lexicon) -> Callable[[str], Any]:
    kind = vocabulary.types[slot.type]
    if kind.kind != "quantity" and kind.kind != "number":
        return as_text
    return as_whole if kind.whole or slot.otherwise == _WHOLE else float


_WHOLE = "count"
"""What a slot is `otherwise` whose parameter has the annotation int."""


def _module(entry: Entry, name: str) -> ModuleType:
    """Import the module beside the keyword file, else an installed one.

    Those of one folder are a package with a unique name: the modules of two packs may be called the same.
    """
    if entry.span is None or not os.path.isfile(entry.span.source.name):
        return import_module(name)
    folder = os.path.dirname(os.path.realpath(entry.span.source.name))
    beside = os.path.join(folder, *name.split("."))
    if not os.path.isfile(f"{beside}.py") and not os.path.isfile(os.path.join(beside, "__init__.py")):
        return import_module(name)
    top = name.partition(".")[0]
    spec = find_spec(top)
    known = () if spec is None else (spec.origin or "", *(spec.submodule_search_locations or ()))
    if any(os.path.realpath(path) in (os.path.join(folder, top), os.path.join(folder, f"{top}.py")) for path in known):
        return import_module(name)  # the very module that the program imports, too
    package = _packages.setdefault(folder, f"btlang_words_{len(_packages)}")
    if package not in sys.modules:
        made = ModuleType(package, f"The modules beside the keyword files of {folder}.")
        made.__path__ = [folder]
        sys.modules[package] = made
    try:
        return import_module(f"{package}.{name}")
    except ModuleNotFoundError as error:
        if error.name is not None and os.path.isfile(os.path.join(folder, f"{error.name}.py")):
            error.msg += f"; it is in the folder of the keyword file: write 'from . import {error.name}'"
        raise


def import_call(entry: Entry) -> Callable[..., Any]:
    if not isinstance(entry.call, str):
        return entry.call
    node = Node(entry.id, span=entry.span)
    if not entry.call:
        raise EngineError(f'its keyword entry in {entry.file} has no call = "module:name"', node)
    module, _, name = _MOVED.get(entry.call, entry.call).partition(":")
    try:
        found: Any = _module(entry, module)
        for part in name.split("."):
            found = getattr(found, part)
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # whatever a user's module raises while it is imported
        raise EngineError(f"{entry.call} cannot be loaded ({describe_exception(error)})", node) from error
    if not callable(found):
        raise EngineError(f"{entry.call} isn't a function or class", node)
    return found  # type: ignore[no-any-return]


def _is_equal(value: Any, wanted: Any) -> bool:
    """Whether two values are equal: numbers up to rounding, texts in any case."""
    if isinstance(value, str) or isinstance(wanted, str):
        return str(value).casefold() == str(wanted).casefold()
    return bool(abs(value - wanted) <= _AS_GOOD_AS_EQUAL * max(1.0, abs(wanted)))


_HOLDS: dict[str, Callable[[float, float], bool]] = {
    "below": operator.lt,
    "above": operator.gt,
    "at_least": operator.ge,
    "at_most": operator.le,
    "equal": _is_equal,
}


def compare_quantity(
    quantity: Callable[..., Any], say: Callable[[Mapping[str, Any], str], str]
) -> Callable[..., bool | Failed]:
    """Make a function that calls the quantity and holds if all comparisons with given ports hold.

    What the quantity gives goes to the function in the output port first, so without comparisons it is just remembered.
    `say` gives the words for what was read, of the arguments of the quantity and the value as a text. Its `measured`
    returns these words for the latest call that held. Raises ValueError
    where the quantity has a parameter that is named as one of these ports.
    """

    latest: tuple[Mapping[str, Any], Any, Mapping[str, Any]] | None = None

    def compare(**given: Any) -> bool | Failed:
        nonlocal latest
        store = given.pop(MEASURED, None)
        limits = {name: given.pop(name) for name in _HOLDS if name in given}
        value = quantity(**given)
        if store is not None:
            store(value)
        if _hold(limits, value):
            latest = given, value, limits
            return True
        if value != value:
            raise Unknown("it is not a number")
        return Failed(lambda: say(given, _round(value, limits)))

    def measured() -> str:
        if latest is None:
            return ""
        arguments, value, limits = latest
        return say(arguments, _round(value, limits, True))

    own = signature(quantity)
    ports = [Parameter(name, Parameter.KEYWORD_ONLY, default=None) for name in (*_HOLDS, MEASURED)]
    compare.__signature__ = own.replace(parameters=[*own.parameters.values(), *ports])  # type: ignore[attr-defined]
    compare.measured = measured  # type: ignore[attr-defined]
    compare.__name__ = getattr(quantity, "__name__", "quantity")
    return compare


def _hold(limits: Mapping[str, Any], value: Any) -> bool:
    return all(_HOLDS[name](value, limit) for name, limit in limits.items() if limit is not None)


def _round(value: Any, limits: Mapping[str, Any], holds: bool = False) -> str:
    """Return the value in three digits, or in more if the answer would be another one: 19.96 is not at least 20."""
    if isinstance(value, str):
        return value
    texts = (f"{value:.{digits}g}" for digits in range(3, _MOST_DIGITS + 1))
    return next((text for text in texts if _hold(limits, float(text)) is holds), str(value))


def find_awaited(tree: Tree) -> frozenset[str]:
    """Find the ids of leaves that a node looks at while it runs another child, and that may end it: `until bumped`."""
    found: set[str] = set()
    for node in tree.walk():
        kind = CATALOGUE.get(node.id)
        if kind is not None and kind.reactive and kind.interrupts:
            looked_at = node.children[:1] if kind.roles else node.children[:-1]
            for child in looked_at:
                found.update(each.id for each in Tree(child).walk() if not each.children)
    return frozenset(found)


def allow_touching(call: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap the function of a leaf, which takes a `robot`: at each tick it may touch what is ahead."""
    from inspect import isgeneratorfunction  # takes longer to import than most checks

    if not isgeneratorfunction(call):

        @wraps(call)
        def look(robot: Any, **values: Any) -> Any:
            robot.touch()
            return call(robot=robot, **values)

        return look

    @wraps(call)
    def work(robot: Any, **values: Any) -> Generator[None, None, Any]:
        running = call(robot=robot, **values)
        try:
            while True:
                robot.touch()
                try:
                    next(running)
                except StopIteration as end:
                    return end.value
                yield
        finally:
            running.close()

    return work
