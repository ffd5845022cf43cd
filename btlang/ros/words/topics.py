"""Leaves of topics: one to publish, and the latest message as a condition or a quantity."""

from __future__ import annotations

import operator
import time
from collections.abc import Callable, Generator, Mapping

from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere, Unknown
from btlang.ros.graph import no_listener
from btlang.ros.subscriptions import AGE
from btlang.ros.words.clients import RosClients
from btlang.ros.words.fields import make_filler, make_reader
from btlang.ros.words.servers import WAIT
from btlang.ros.words.word import RosWord
from btlang.vocabulary.ros_table import LIMITS, SLOT

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_HOLDS: dict[str, Callable[[Any, Any], bool]] = {
    "below": operator.lt, "above": operator.gt, "at_least": operator.ge, "at_most": operator.le,
    "equal": operator.eq, "not_equal": operator.ne,
}  # fmt: skip
_NUMBERS = (int, float)
RATE = 10.0
"""Messages a second of repeated publishing, unless a table gives another rate."""


def topic_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a function that compares, or returns a number if the word is a quantity. FAILURE
    if the topic is silent.
    """
    cls, latched = word.interface(), word.ros.get("latched", False)
    read = make_reader(word, cls) if word.ros.get("field") else None
    latest = clients.latest(cls, word.ros.name, latched)
    age = word.ros.get("age", None if latched else AGE)

    def value() -> Any:
        message = latest.take(age)
        try:
            return read(message) if read is not None else True
        except ValueError as problem:
            raise Unknown(f"{problem} in the message on {word.ros.name}") from None

    shown = word.ros.get("field", "") and f"{word.ros.get('field')} of {word.ros.name}"
    return (
        make_measurement(word, value, shown) if word.measured is not None else make_comparison(word, cls, value, shown)
    )


def _known(value: Any, shown: str) -> Any:
    if value != value:
        raise Unknown(f"{shown} is not known: it is not a number")
    return value


def make_measurement(word: RosWord, value: Callable[[], Any], shown: str) -> Callable[..., Any]:
    """Return a function that returns a value in the unit of the word's type. Raises
    ActionFailed if it isn't a number.
    """
    scale = word.scale

    def measure(**values: Any) -> float:
        found = _known(value(), shown)
        if not isinstance(found, _NUMBERS):
            raise ActionFailed(f"{shown} is {found!r}, which isn't a number")
        return float(found) * scale

    return measure


def make_comparison(word: RosWord, cls: Any, value: Callable[[], Any], shown: str) -> Callable[..., Any]:
    """Return a function that holds if all comparisons of the table do; without any, if the value isn't empty or 0."""
    limits = [
        (_HOLDS[key], key, _limit(word, cls, word.ros.get(key))) for key in LIMITS if word.ros.get(key) is not None
    ]
    scale = float(word.ros.get("scale", 1.0))

    def hold(**values: Any) -> bool | Failed:
        found = _known(value(), shown)
        if scale != 1.0 and isinstance(found, _NUMBERS):
            found *= scale
        try:
            good = all(holds(found, limit(values)) for holds, _, limit in limits) if limits else bool(found)
        except TypeError:
            return Failed(f"{shown} is {found!r}, which can't be compared like this")
        return good or Failed(lambda: f"{shown} is {f'{found:.3g}' if isinstance(found, float) else found}")

    return hold


def _limit(word: RosWord, cls: Any, given: Any) -> Callable[[Mapping[str, Any]], Any]:
    """Return the value to compare with: a slot in SI, the constant of a message by its name, or the value itself."""
    slot = SLOT.fullmatch(given) if isinstance(given, str) else None
    if slot is None:
        constant = getattr(cls, given, given) if isinstance(given, str) and given.isupper() else given
        return lambda values: constant
    name, unit = slot[1], slot[2] or ""
    try:
        factor = word.factor(name, unit)
    except LookupError as error:
        raise word.misfit(cls, given, str(error)) from None

    def limit(values: Mapping[str, Any]) -> Any:
        if name not in values:
            raise ActionFailed(f"it needs a value for {name}")
        value = values[name]
        return value * factor if isinstance(value, _NUMBERS) else value

    return limit


def publish_leaf(word: RosWord, clients: RosClients) -> Callable[..., Any]:
    """Return a generator leaf that publishes a message once there is a listener; FAILURE if there is none.

    With `for` it goes on for a time, with `rate` alone until it is halted: at most one message a tick, and after the
    last one the message of `finally`, also when it is halted.
    """
    cls, name, latched = word.interface(), word.ros.name, word.ros.get("latched", False)
    make = make_filler(word, cls, word.ros.get("message"), clients.clock.message)
    last = word.ros.get("finally")
    make_last = None if last is None else make_filler(word, cls, last, clients.clock.message)
    publisher = clients.publisher(cls, name, latched)
    seconds = word.amount("for", 0.0)
    timed, again = word.ros.get("for") is not None, word.ros.get("rate") is not None
    period, wait = 1 / word.ros.get("rate", RATE), word.ros.get("wait", WAIT)

    def publish(**values: Any) -> Generator[None, None, bool]:
        message = make(values)
        until = time.monotonic() + wait
        while not latched and not publisher.get_subscription_count():
            if time.monotonic() >= until:
                raise ActionFailed(NotThere(no_listener(clients.node, cls, name)))
            yield
        if not timed and not again:
            publisher.publish(message)
            return True
        start = due = clients.clock.now()
        length = seconds(values)
        try:
            while (now := clients.clock.now()) < start + length or not timed:
                if now >= due:
                    publisher.publish(make(values))
                    due = max(due + period, now)
                yield
        finally:
            if make_last is not None:
                publisher.publish(make_last(values))
        return True

    return publish
