"""Fakes: what stands in for a command or condition of a mission while it is tested: `"grasp" fails twice`.

As the substitution rules of BehaviorTree.CPP 4 (`addSubstitutionRule`), but a fake may end after so many times.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, wraps

from btlang.backends.engine import bind_leaf
from btlang.engine.clock import Clock
from btlang.engine.leaves.leaf import Failed, LeafBinding
from btlang.engine.leaves.signature import LeafSignature
from btlang.support.record import Record
from btlang.testing.commands import Command
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.vocabulary.entry import Entry

FAKED = "the test lets it fail"


class Fake(Record):
    """`succeeds` after `seconds`, or fails, `times` times (0: always); then comes the next fake, or the command."""

    words: str
    command: Command
    succeeds: bool
    seconds: float = 0.0
    times: int = 0


class Fakes:
    """The fakes of one run, counted."""

    def __init__(self, fakes: Sequence[Fake]) -> None:
        self._fakes = fakes
        self._left = [fake.times for fake in fakes]

    def has(self, node_id: str) -> bool:
        """Whether one may stand in for nodes with this id."""
        return any(node_id in fake.command.ids for fake in self._fakes)

    def take(self, node_id: str, values: dict[str, Any]) -> Fake | None:
        """The fake for a call with these values, which counts it; None where the real one is to be called."""
        for number, fake in enumerate(self._fakes):
            if node_id not in fake.command.ids or (fake.times and not self._left[number]):
                continue
            if all(_is_same(values.get(name), text) for name, text in fake.command.ports):
                self._left[number] -= 1
                return fake
        return None


def _is_same(value: Any, text: str) -> bool:
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            return float(text) == float(value)
        except ValueError:
            return False
    return str(value) == text


def faked(own: LeafBinding | None, entry: Entry, vocabulary: Lexicon, fakes: Fakes, clock: Clock) -> LeafBinding:
    """How a leaf is bound that fakes may stand in for. It takes the ports of the real one, which need not exist: the
    robot's `own`, or that of its `call`.
    """
    take = partial(fakes.take, entry.id)
    real = own or (bind_leaf(entry.id, vocabulary) if entry.call else None)
    if real is None:
        return LeafBinding(_unreal(take, clock) if entry.sort == "action" else _unreal_condition(take))
    kind = LeafSignature(real).kind
    return real.replace(call=_MAKERS[kind](real.call, take, clock))  # type: ignore[no-any-return]


def _unreal(take: Callable[..., Fake | None], clock: Clock) -> Callable[..., Any]:
    """In place of a command that nothing here can do."""

    def act(**values: Any) -> Any:
        fake = take(values)
        if fake is None:
            return Failed("nothing here can do it, and the test has no more fakes for it")
        return (yield from _answer(fake, clock))

    return act


def _unreal_condition(take: Callable[..., Fake | None]) -> Callable[..., Any]:
    def ask(**values: Any) -> Any:
        fake = take(values)
        return Failed(FAKED) if fake is None or not fake.succeeds else True

    return ask


def _answer(fake: Fake, clock: Clock) -> Any:
    """A generator: takes its time, then ends as the fake says."""
    until = clock.now + fake.seconds
    while clock.now < until - 1e-9:
        yield
    return True if fake.succeeds else Failed(FAKED)


def _generator(call: Callable[..., Any], take: Callable[..., Fake | None], clock: Clock) -> Callable[..., Any]:
    @wraps(call)
    def act(**values: Any) -> Any:
        fake = take(values)
        return (yield from (call(**values) if fake is None else _answer(fake, clock)))

    return act


def _function(call: Callable[..., Any], take: Callable[..., Fake | None], clock: Clock) -> Callable[..., Any]:
    """Of a function, whose fake answers at once."""

    @wraps(call)
    def act(**values: Any) -> Any:
        fake = take(values)
        if fake is None:
            return call(**values)
        return True if fake.succeeds else Failed(FAKED)

    return act


def _async(call: Callable[..., Any], take: Callable[..., Fake | None], clock: Clock) -> Callable[..., Any]:
    @wraps(call)
    async def act(**values: Any) -> Any:
        fake = take(values)
        if fake is None:
            return await call(**values)
        return True if fake.succeeds else Failed(FAKED)

    return act


def _class(call: Any, take: Callable[..., Fake | None], clock: Clock) -> Any:
    class Faked(call):  # type: ignore[misc]
        fake: Any = None

        @wraps(call.start)
        def start(self, **values: Any) -> Any:
            fake = take(values)
            self.fake = None if fake is None else _answer(fake, clock)
            return super().start(**values) if self.fake is None else self.tick()

        def tick(self) -> Any:
            if self.fake is None:
                return super().tick()
            try:
                return next(self.fake)
            except StopIteration as answer:
                return answer.value

        def halt(self) -> None:
            if self.fake is None:
                super().halt()

    return Faked


_MAKERS = {"generator": _generator, "function": _function, "thread": _function, "async": _async, "class": _class}
