"""A test as data: a mission, its world, what is to happen, and the fakes of commands and conditions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial, wraps

from btlang.api import Mission
from btlang.backends.engine import bind_leaf
from btlang.engine.clock import Clock
from btlang.engine.leaves.leaf import Failed, LeafBinding, LeafSignature
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.text.words import split
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.trie import longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.vocabulary.entry import Entry


class NamedCommand(Record):
    """A command of a mission that a test names: the nodes with one of these ids and, where the words say them, these
    values of ports.

    With `is_denied` the words say the opposite of a condition: `nobody is near`.
    """

    ids: frozenset[str]
    ports: tuple[tuple[str, str], ...] = ()
    is_denied: bool = False

    def matches(self, node: Node) -> bool:
        """Return whether a node, with its values filled in, is meant."""
        return node.id in self.ids and all(node.port(name) == text for name, text in self.ports)


def find_command(text: str, mission: Mission) -> NamedCommand | None:
    """Return what the words name: a definition of the mission, a whole command, or the first words of commands.

    None where the mission has no such command.
    """
    vocabulary = mission.vocabulary.with_places(tuple(fact.name for fact in mission.facts))
    words = split(Source(text), vocabulary.orthography)
    wanted = words.words[:-2]
    if not wanted:
        return None
    name = " ".join(wanted)
    for known, _ in mission.tree.subtrees:
        if known.lower() == name:
            return NamedCommand(frozenset((SUBTREE,)), (("ID", known),))
    match = longest(vocabulary.trie, words, 0, vocabulary.context)
    if match is not None and match.last == len(wanted) and match.meaning.entry is not None:
        ports = tuple((value.name, value.text) for value in match.values)
        is_denied = match.meaning.role == "negated"
        return _if_there(NamedCommand(frozenset((match.meaning.entry.id,)), ports, is_denied), mission)
    entries = [entry for same in vocabulary.entries.values() for entry in same]
    ids = {entry.id for entry in entries if _begins(entry.phrases, wanted, vocabulary.articles)}
    ids |= {id for id in vocabulary.entries if id.lower() == "".join(wanted)}
    return _if_there(NamedCommand(frozenset(ids)), mission)


def _begins(phrases: tuple[str, ...], wanted: list[str], articles: frozenset[str]) -> bool:
    """Return whether a way to say one of the phrases begins with these words."""
    for phrase in phrases:
        for form in forms(phrase, articles):
            first = form[: len(wanted)]
            if len(first) == len(wanted) and not any(isinstance(part, Slot) for part in first) and [*first] == wanted:
                return True
    return False


def _if_there(command: NamedCommand, mission: Mission) -> NamedCommand | None:
    """Return the command if the mission has it.

    Values that the mission takes from its blackboard are only known while it runs.
    """
    for node in mission.tree.walk():
        ports = tuple((name, text) for name, text in command.ports if not node.port(name).startswith("{"))
        if node.id in command.ids and command.replace(ports=ports).matches(node):
            return command
    return None


FAKED = "the test lets it fail"


class Fake(Record):
    """A fake of a command: it `succeeds` after `seconds`, or fails, `times` times (0: always); then comes the next
    fake, or the command.
    """

    words: str
    command: NamedCommand
    succeeds: bool
    seconds: float = 0.0
    times: int = 0


class Fakes:
    """The fakes of one run, counted."""

    def __init__(self, fakes: Sequence[Fake]) -> None:
        self._fakes = fakes
        self._left = [fake.times for fake in fakes]

    def has(self, node_id: str) -> bool:
        """Return whether one may stand in for nodes with this id."""
        return any(node_id in fake.command.ids for fake in self._fakes)

    def take(self, node_id: str, values: dict[str, Any]) -> Fake | None:
        """Return the fake for a call with these values, which counts it; None where the real one is to be called."""
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


def make_fake(own: LeafBinding | None, entry: Entry, vocabulary: Lexicon, fakes: Fakes, clock: Clock) -> LeafBinding:
    """Return how a leaf is bound that fakes may stand in for.

    It takes the ports of the real one, which need not exist: the robot's `own`, or that of its `call`.
    """
    take = partial(fakes.take, entry.id)
    real = own or (bind_leaf(entry.id, vocabulary) if entry.call else None)
    if real is None:
        return LeafBinding(_unreal(take, clock) if entry.sort == "action" else _unreal_condition(take))
    kind = LeafSignature(real).kind
    return real.replace(call=_MAKERS[kind](real.call, take, clock))  # type: ignore[no-any-return]


def _unreal(take: Callable[..., Fake | None], clock: Clock) -> Callable[..., Any]:
    """Make a leaf in place of a command that nothing here can do."""

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
    """Return a generator: takes its time, then ends as the fake says."""
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
    """Fake a function, which answers at once."""

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


USUAL_LIMIT = 600.0
"""The seconds of mission time after which a test is cut where it says nothing else."""

EVENT, HOLDS, WITHIN, FOR, BEFORE, ALWAYS, NEVER, FINALLY = (
    "event", "holds", "within", "for", "before", "always", "never", "finally",
)  # fmt: skip


class ScriptStep(Record):
    """A line of a test behind `run`; times count from the end of the step before it.

    `EVENT`: after `seconds`, and once `condition` is true, `event` happens in the world. `HOLDS`: after `seconds` the
    condition is true. `WITHIN`: it is true at some time in these seconds. `FOR`: it is true all that time. `BEFORE`: it
    is true before `other` is. `ALWAYS`, `NEVER` (whose condition is negated): from here to the end of the test.
    `FINALLY`: when the mission is over.
    """

    kind: str
    span: Span
    condition: Tree | None = None
    seconds: float = 0.0
    other: Tree | None = None
    event: Tree | None = None


class MissionTest(Record):
    """A test of a mission.

    `setup` are the events before the first tick; `limit` is in seconds of mission time, and the test ends then.

    With `is_cut` that is too long: a test that gets there has failed. `vocabulary` has the words of its conditions.
    `texts` are the commands in quotes that its conditions ask for, as they are written. `robot` is the path of a robot
    file; "" is the robot that ships.
    """

    name: str
    span: Span
    mission: Mission
    vocabulary: Lexicon
    setup: tuple[Tree, ...] = ()
    fakes: tuple[Fake, ...] = ()
    steps: tuple[ScriptStep, ...] = ()
    texts: tuple[str, ...] = ()
    limit: float = USUAL_LIMIT
    is_cut: bool = True
    robot: str = ""

    @property
    def is_inline(self) -> bool:
        """Return whether its mission stands in it."""
        syntax = self.mission.syntax
        return syntax is not None and syntax.span.source.name == self.span.source.name

    @property
    def place(self) -> str:
        """The place `file:line` of the test."""
        return self.span.place.rpartition(":")[0]
