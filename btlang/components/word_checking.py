"""What doesn't fit between the words of a component and its class."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.text.source import NOWHERE
from btlang.vocabulary.entry import COMPARISONS, MEASURED
from btlang.vocabulary.load import load_vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.vocabulary.entry import Entry

_SERVICES = ("robot", "halted")
"""Parameters of methods that no slot gives."""


def check_words(path: str, methods: Mapping[str, Mapping[str, Any]]) -> Iterator[Diagnostic]:
    """Problems of a keyword file (BT060 to BT064, BT080), with the methods of each component by its place: see
    btlang.components.location.describe.
    """
    try:
        vocabulary = load_vocabulary([path])
    except MissionError as error:
        yield from error.diagnostics
        return
    for entry in chain(*vocabulary.entries.values()):
        reason = _reason(entry, methods) if entry.file == path else ""
        if reason:
            yield diagnostic("BT080", entry.span or NOWHERE, id=entry.id, reason=reason)


def _reason(entry: Entry, methods: Mapping[str, Mapping[str, Any]]) -> str:
    """Why its method can't do it, "" where it can, and where it isn't done by a component."""
    place, _, name = entry.call.rpartition(".") if isinstance(entry.call, str) else ("", "", "")
    if place not in methods:
        modules = {known.partition(":")[0] for known in methods}
        is_near = ":" in place and place.partition(":")[0] in modules
        return f"the robot has no component of the class {place}" if is_near else ""
    if name not in methods[place]:
        return f"{place} has no method {name}"
    takes, required, takes_all = (methods[place][name][key] for key in ("takes", "required", "takes_all"))
    slots = [slot.name for slot in entry.slots if slot.name not in (*COMPARISONS, MEASURED)]
    more = [slot for slot in slots if slot not in takes]
    if more and not takes_all:
        return f"{entry.call} takes no parameter {more[0]}"
    lacks = [each for each in required if each not in (*slots, *_SERVICES)]
    return f"{entry.call} has a parameter {lacks[0]}, which is no slot and has no default" if lacks else ""
