"""The engine as a target: binds leaf ids to the Python that `call` in a keyword file names, just before a run."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

from btlang.backends.comparing import comparing
from btlang.backends.touching import touching
from btlang.engine.instance import EngineError
from btlang.engine.leaves.leaf import LeafBinding, describe_exception
from btlang.engine.script.values import as_text
from btlang.printer.phrase import leaf_words
from btlang.tree.node import Node
from btlang.vocabulary.entry import MEASURED, Entry, SlotSpec
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping
    from typing import Any


def bind_leaf(
    node_id: str,
    vocabulary: Lexicon,
    own: Callable[[Entry, Lexicon], LeafBinding | None] | None = None,
    awaited: Collection[str] = (),
) -> LeafBinding | None:
    """None where no keyword entry has the id. Raises EngineError where its `call` leads nowhere or is of no use.

    `own` is how the robot of the run binds an entry; what it leaves is bound by `call`. The latest entry that it binds
    counts, so that a keyword file can bind words that ship. An entry that replaces the others goes before the robot.
    `awaited` are the ids of conditions for which the mission waits: see btlang.backends.touching.
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
    call = _imported(entry)
    if entry.touches and (entry.sort == "action" or node_id in awaited):
        call = touching(call)
    return leaf_binding(entry, vocabulary, call, tuple(slots.values()))


def leaf_binding(
    entry: Entry, vocabulary: Lexicon, call: Callable[..., Any], slots: tuple[SlotSpec, ...]
) -> LeafBinding:
    """What does the work of an entry, with the values of slots as its parameters.

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
        return LeafBinding(comparing(call, say), converters, defaults, (MEASURED,), condition=True)
    except (TypeError, ValueError) as error:
        raise EngineError(f"{entry.call} cannot be a quantity: {error}", Node(entry.id, span=entry.span)) from error


def _converter(slot: SlotSpec, vocabulary: Lexicon) -> Callable[[str], Any]:
    kind = vocabulary.types[slot.type]
    if kind.kind == "quantity" or kind.kind == "number":
        return int if kind.whole else float
    return as_text


_packages: dict[str, str] = {}  # of the modules beside keyword files, by their folders


def _module(entry: Entry, name: str) -> ModuleType:
    """The module beside the keyword file, else an installed one.

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


_MOVED = {
    "btlang.actions.commands:do_what_somebody_says": "btlang.actions.conversation:do_what_somebody_says",
    "btlang.actions.show:bow": "btlang.actions.gestures:bow",
    "btlang.actions.show:dance": "btlang.actions.gestures:dance",
    "btlang.actions.sides:go_to_side": "btlang.actions.navigation:go_to_side",
}
"""Where functions that keyword files of 0.1 may name in `call` are now."""


def _imported(entry: Entry) -> Callable[..., Any]:
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
