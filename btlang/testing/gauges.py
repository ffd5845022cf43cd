"""Gauges in tests: quantities of keyword files and gauges of robot files that a test sets to a value."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial, wraps

from btlang.backends.engine import bind_leaf, compare_quantity
from btlang.devices.simulated import SimulatedDevice
from btlang.engine.leaves.leaf import Failed
from btlang.vocabulary.cache import recent
from btlang.vocabulary.entry import COMPARISONS, MEASURED, Entry, SlotSpec
from btlang.vocabulary.load import load_vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.devices.device_set import Reads
    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.bodies.body import Body
    from btlang.vocabulary.lexicon import Lexicon

    Bind: TypeAlias = Callable[[Entry, Lexicon], LeafBinding | None]

_CHANGES = "drops/falls/rises/goes/jumps to", "at"
"""What a gauge does, in the words of `battery drops to 15%` and `with the battery at 15%`."""
_BECOMES = "becomes", "at"
_TOPIC = "testing"
_VALUE = "value"


class Gauges:
    """The values that one test gives gauges.

    From then on a quantity has this value for the mission and for the conditions of the test, and so has a simulated
    device of the kind `gauge` for the components that read it.
    """

    def __init__(self) -> None:
        self._bind: Bind | None = None
        self._devices: Mapping[str, Reads] = {}
        self._values: dict[str, list[tuple[Mapping[str, Any], Any]]] = {}  # by the id; the latest counts

    def connect(self, bind: Bind, devices: Mapping[str, Reads]) -> None:
        """Take the robot's own way to bind words, and its devices."""
        self._bind, self._devices = bind, devices

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Bind a word as the robot does; a quantity has the value that the test gives it, if it does."""
        own = self._bind(entry, vocabulary) if self._bind is not None else None
        if not entry.measures or entry.id in load_vocabulary().entries:
            return own
        real = own or (bind_leaf(entry.id, vocabulary) if entry.call else None)
        return real and real.replace(call=self._or_given(entry.id, real.call))

    def set_quantity(self, id: str, ports: Mapping[str, Any], value: Any) -> None:
        """Give a quantity a value, for these values of its slots."""
        self._values.setdefault(id, []).append((ports, value))

    def set_device(self, name: str, value: float) -> bool | Failed:
        """Let a gauge of the robot file measure a value."""
        device = self._devices.get(name)
        if not isinstance(device, SimulatedDevice):
            return Failed(f"the {name} isn't simulated")
        device.measured = value
        return True

    def _or_given(self, id: str, measure: Callable[..., Any]) -> Callable[..., Any]:
        """Return a leaf that compares the value of the test, or else measures it."""

        @wraps(measure)
        def ask(**values: Any) -> Any:
            for ports, value in reversed(self._values.get(id, ())):
                if ports.items() <= values.items():
                    compared = {name: values[name] for name in (*COMPARISONS, MEASURED) if name in values}
                    return compare_quantity(partial(_given, value), lambda _, text: f"it is {text}")(**compared)
            return measure(**values)

        return ask


def _given(value: Any) -> Any:
    return value


_made: dict[tuple[object, ...], tuple[Sequence[Entry], list[Entry]]] = {}  # the first stay, so that no id comes again


def gauge_words(body: Body | None, vocabulary: Lexicon) -> list[Entry]:
    """Return the words that set gauges: the gauges of the robot file, and the quantities that don't ship.

    They are the same objects for the same gauges, so that the vocabulary with them is made once.
    """
    shipped = load_vocabulary()
    known = [entry for same in vocabulary.entries.values() for entry in same if entry.measures]
    own = [entry for entry in known if entry.id not in shipped.entries]
    gauges = [device.name for device in body.devices if device.kind == "gauge"] if body is not None else []

    def make() -> tuple[Sequence[Entry], list[Entry]]:
        words = [_quantity(entry, vocabulary) for entry in own]
        words += [_device(name, number) for number, name in enumerate(gauges, 1) if re.search(r"\w", name)]
        return own, words

    return recent(_made, (*map(id, own), *gauges), make)[1]


def _quantity(entry: Entry, vocabulary: Lexicon) -> Entry:
    def change(gauges: Gauges, **ports: Any) -> None:
        gauges.set_quantity(entry.id, ports, ports.pop(_VALUE))

    is_number = vocabulary.types[entry.measures].kind in ("quantity", "number")
    slots = (SlotSpec(_VALUE, entry.measures), *(slot for slot in entry.slots if slot.name not in _COMPARED))
    phrases = _phrases((*entry.quantity, *entry.named), _CHANGES if is_number else _BECOMES, _VALUE)
    return _word(f"Set{entry.id}", phrases, slots, change, f"From now on the {_first(entry.quantity)} is that.")


def _device(name: str, number: int) -> Entry:
    def change(gauges: Gauges, number: float | None = None, percent: float | None = None) -> bool | Failed:
        return gauges.set_device(name, number if number is not None else percent or 0.0)

    words = " ".join(re.findall(r"\w+", name))
    said = dict.fromkeys((words, " ".join(words.replace("_", " ").split()) or words))
    kinds = "number", "percent"
    phrases = tuple(phrase for kind in kinds for phrase in _phrases(tuple(said), _CHANGES, kind))
    slots = tuple(SlotSpec(kind, kind) for kind in kinds)
    return _word(f"SetGauge{number}", phrases, slots, change, f"From now on the {name} measures that.")


_COMPARED = frozenset((*COMPARISONS, MEASURED))


def _phrases(said: tuple[str, ...], changes: tuple[str, ...], slot: str) -> tuple[str, ...]:
    return tuple(f"{words} {change} {{{slot}}}" for words in said for change in changes)


def _first(phrases: tuple[str, ...]) -> str:
    return phrases[0] if phrases else "quantity"


def _word(id: str, phrases: tuple[str, ...], slots: tuple[SlotSpec, ...], call: Callable[..., Any], help: str) -> Entry:
    return Entry("action", id, phrases, call, slots, topic=_TOPIC, help=help, instant=True, yields=True)
