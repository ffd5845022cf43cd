"""A service of ROS 2 as a leaf: calls it and is RUNNING until the answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator

from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere, described
from btlang.ros.clients import Clients
from btlang.ros.filling import filler
from btlang.ros.graph import is_ready
from btlang.ros.leaves.server import WAIT, Judge, awaited, nothing
from btlang.ros.word import Word

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

LIMIT = 10.0
"""Real seconds that an answer may take, where a table says nothing else."""
_GONE = 1.0  # seconds without a server, after which it counts as lost


def service_leaf(word: Word, clients: Clients) -> Callable[..., Any]:
    """A generator leaf. A call cannot be taken back: when it is halted, nobody looks at the answer."""
    cls, name = word.interface(), word.ros.name
    make = filler(word, cls.Request, word.ros.get("request"), clients.clock.message)
    judge = Judge(word, cls.Response)
    client = clients.service(cls, name)
    wait, limit = word.ros.get("wait", WAIT), word.ros.get("limit", LIMIT)

    def call(wake: Callable[[], object] = nothing, **values: Any) -> Generator[None, None, bool | Failed]:
        request = make(values)
        yield from awaited(clients, client, cls, name, wait)
        return judge.verdict((yield from answered(clients, client, name, request, limit, wake)))

    return call


def answered(
    clients: Clients, client: Any, name: str, request: Any, limit: float, wake: Callable[[], object]
) -> Generator[None, None, Any]:
    """Yields until a service has answered; returns the response. Raises ActionFailed where none comes."""
    answers: list[Any] = []

    def got(future: Any) -> None:
        answers.append(future.result())
        wake()

    def send() -> None:
        try:
            client.call_async(request).add_done_callback(got)
        except Exception as problem:
            answers.append(f"{name} could not be called: {described(problem)}")
            wake()

    clients.post(send)
    now = time.monotonic()
    until, seen = now + limit, now
    while not answers:
        yield
        now = time.monotonic()
        seen = now if is_ready(client) else seen
        if not answers and now - seen > _GONE:
            raise ActionFailed(NotThere(f"the server of {name} is gone"))
        if not answers and now >= until:
            raise ActionFailed(NotThere(f"{name} has not answered within {limit:g} s"))
    if isinstance(answers[0], str):
        raise ActionFailed(answers[0])
    return answers[0]
