"""A topic to publish as a leaf: once, or again and again."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator

from btlang.engine.leaves.leaf import ActionFailed, NotThere
from btlang.ros.clients import Clients
from btlang.ros.filling import filler
from btlang.ros.graph import no_listener
from btlang.ros.leaves.server import WAIT
from btlang.ros.word import Word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

RATE = 10.0
"""Messages a second of what is published again and again, where a table says nothing else."""


def publish_leaf(word: Word, clients: Clients) -> Callable[..., Any]:
    """A generator leaf that publishes a message once there is a listener; FAILURE if there is none.

    With `for` it goes on for a time, with `rate` alone until it is halted: at most one message a tick, and after the
    last one the message of `finally`, also when it is halted.
    """
    cls, name, latched = word.interface(), word.ros.name, word.ros.get("latched", False)
    make = filler(word, cls, word.ros.get("message"), clients.clock.message)
    last = word.ros.get("finally")
    make_last = None if last is None else filler(word, cls, last, clients.clock.message)
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
