"""The syntax tree of a mission, as both parsers make it: what was said, with the exact characters of each part.

Commands: Phrase, Name, Chain, If, IfWorks, While, Provided, StopWhen, Repeat, Retry, Try, Within, For, UpTo, Every,
UntilTime, ByTime, Apart, Delay, Constrained, Wait, WaitUntil, WaitTime, WaitForever, Check, Nothing, Fail, Assign,
Remember, ForEach, Exact, Named; Whenever in a sequence.
Conditions: Phrase, Name, Compared, Chain ("all", "any"), AtLeast, Not, Held, Exact. `parts` are fields with subtrees.
Amounts and values are port texts in base units (seconds); they may refer to values of the mission: `{level}`, in a
text also `it is {level} percent` (see btlang/vocabulary/references.py).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from btlang.support.record import Record
from btlang.text.source import Span
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.references import choice_of, keys_in

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ClassVar


class Ast(Record):
    """The base of all syntax nodes."""

    if TYPE_CHECKING:  # each class has it as its last field

        @property
        def span(self) -> Span: ...

    parts: ClassVar[tuple[str, ...]] = ()


class Phrase(Ast):
    """A phrase of a keyword file; `arguments` are (slot, port text) in the order spoken.

    The name of the node and its further `ports` are as they stand, as in Exact.
    """

    entry: Entry
    arguments: tuple[tuple[str, str], ...]
    span: Span
    name: str = ""
    ports: tuple[tuple[str, str], ...] = ()
    outputs: tuple[str, ...] = ()


class Name(Ast):
    """A defined name (`greet {someone}`); `arguments` are (parameter, port text) in the order spoken."""

    name: str
    arguments: tuple[tuple[str, str], ...]
    span: Span


class Compared(Ast):
    """A condition: the value of a key, which is of the type `kind`, compared as `arguments` of a quantity would be."""

    key: str
    kind: str
    arguments: tuple[tuple[str, str], ...]
    span: Span


class Assign(Ast):
    """An assignment to a key; `operation` is "set", "increase" or "decrease", `text` is a port text of the type
    `kind`.
    """

    key: str
    operation: str
    kind: str
    text: str
    span: Span


class Remember(Ast):
    """A measurement: the key gets the number that a quantity measures now."""

    key: str
    entry: Entry
    arguments: tuple[tuple[str, str], ...]
    span: Span


class ForEach(Ast):
    """A loop over values (port texts of the type `kind`), each of which the key has in the body."""

    key: str
    kind: str
    values: tuple[str, ...]
    body: Ast
    span: Span
    parts = ("body",)


class Chain(Ast):
    """A chain of operands joined by one connective: "sequence", "fallback", "parallel", or "all" and "any" of
    conditions.

    The lines below a node that is said by its id are "children", as long as it is not made (see Exact).

    Never directly inside an equal chain unless one of them is `bracketed`.
    """

    operator: str
    items: tuple[Ast, ...]
    bracketed: bool
    span: Span
    parts = ("items",)


class AtLeast(Ast):
    """A condition: so many of the items are true."""

    number: int
    items: tuple[Ast, ...]
    span: Span
    parts = ("items",)


class Not(Ast):
    condition: Ast
    span: Span
    parts = ("condition",)


class _Branching(Ast):
    """A form with a condition; `negated` is "unless" or "until"."""

    negated: bool
    condition: Ast
    body: Ast
    otherwise: Ast | None
    span: Span
    parts = ("condition", "body", "otherwise")


class If(_Branching):
    """A form with `if` or `unless`."""


class While(_Branching):
    """A form with `while` or `until`."""


class IfWorks(Ast):
    """A form in which one command decides which of two others is next; without `otherwise` its failure skips."""

    tried: Ast
    body: Ast
    otherwise: Ast | None
    span: Span
    parts = ("tried", "body", "otherwise")


class Whenever(Ast):
    """A standing rule over the other commands of its block; with `once` it fires no second time."""

    condition: Ast
    body: Ast
    once: bool
    span: Span
    parts = ("condition", "body")


class Provided(Ast):
    condition: Ast
    body: Ast
    span: Span
    parts = ("condition", "body")


class Named(Ast):
    """A command whose node has a name. Phrases and nodes by their ids have theirs themselves."""

    name: str
    body: Ast
    span: Span
    parts = ("body",)


class StopWhen(Ast):
    """A body that runs once, ended early with success when the condition becomes true."""

    condition: Ast
    body: Ast
    span: Span
    parts = ("condition", "body")


class Repeat(Ast):
    """A loop; `rounds` is a port text, "-1" for without end."""

    rounds: str
    body: Ast
    span: Span
    parts = ("body",)


class Retry(Ast):
    """A retried body; `attempts` is a port text; `pause` are the seconds after each failure, "" for none."""

    attempts: str
    body: Ast
    pause: str
    span: Span
    parts = ("body",)


class Try(Ast):
    """A body whose failure leads to `otherwise`; without one it is ignored."""

    body: Ast
    otherwise: Ast | None
    span: Span
    parts = ("body", "otherwise")


class _Timed(Ast):
    seconds: str
    body: Ast
    span: Span
    parts = ("body",)


class Within(_Timed):
    """A body that fails when it takes longer."""


class For(_Timed):
    """A body that runs over and over until the time is over."""


class UpTo(_Timed):
    """A body that runs once, ended with success when the time is over."""


class _Paced(Ast):
    seconds: str
    body: Ast
    rounds: str
    span: Span
    parts = ("body",)


class Every(_Paced):
    """A body that runs once in each period; `rounds` is a port text, "" for without end."""


class Apart(_Paced):
    """A body that runs so many rounds, with the time between one and the next."""


class Delay(_Timed):
    """A body that runs after the time."""


class Constrained(Ast):
    """A body during which the robot keeps out of zones, or stays in them; `kind` is "keep out" or "keep in"."""

    kind: str
    zones: tuple[str, ...]
    body: Ast
    span: Span
    parts = ("body",)


class Wait(Ast):
    seconds: str
    span: Span


class Held(Ast):
    """A condition that has to hold for some time, without a break."""

    condition: Ast
    seconds: str
    span: Span
    parts = ("condition",)


class WaitUntil(Ast):
    condition: Ast
    span: Span
    parts = ("condition",)


class WaitTime(Ast):
    """A wait for a time of day, which is a port text (18:30), or for the next of some (08:00;18:00)."""

    time: str
    span: Span


class UntilTime(Ast):
    """A body that runs over and over until a time of day."""

    time: str
    body: Ast
    span: Span
    parts = ("body",)


class ByTime(Ast):
    """A body that fails when it isn't over at a time of day."""

    time: str
    body: Ast
    span: Span
    parts = ("body",)


class Check(Ast):
    condition: Ast
    span: Span
    parts = ("condition",)


class WaitForever(Ast):
    span: Span


class Nothing(Ast):
    span: Span


class Fail(Ast):
    span: Span


class Exact(Ast):
    """A node said by its id: it, its ports and its instance name are as they stand; `items` are its children.

    `outputs` are the ports that it gives values to.
    """

    id: str
    ports: tuple[tuple[str, str], ...]
    name: str
    items: tuple[Ast, ...]
    is_condition: bool
    span: Span
    outputs: tuple[str, ...] = ()
    parts = ("items",)


class Definition(Ast):
    """A definition; `name_span` covers the words of the name where it is defined, `parameters` are (name, type).

    One that `is_quoted` is the name of a subtree as it stands, and no phrase.
    """

    name: str
    parameters: tuple[tuple[str, str], ...]
    body: Ast
    name_span: Span
    span: Span
    is_quoted: bool = False
    parts = ("body",)


class Fact(Ast):
    """A place of this mission, in metres and degrees; `facing` is None if any direction will do."""

    name: str
    x: float
    y: float
    facing: float | None
    span: Span


class Include(Ast):
    """Another mission, whose definitions and facts hold here too; `path` is as it was written."""

    path: str
    mission: Program
    span: Span

    @property
    def name(self) -> str:
        """What it is called where definitions and facts have names."""
        return self.path


class Program(Ast):
    """A whole text: the sequence of its commands (None if there are none), its definitions and facts in order.

    `name` is that of its tree, "" where it has none. `needs` are the roles and paths of lines that name what it needs,
    such as ("needs_world", "museum.toml"), `given` the keys of values that come from outside. `all_definitions` and
    `all_facts` also give those of what it includes.
    """

    body: Ast | None
    definitions: tuple[Definition, ...]
    span: Span
    facts: tuple[Fact, ...] = ()
    includes: tuple[Include, ...] = ()
    name: str = ""
    needs: tuple[tuple[str, str], ...] = ()
    given: tuple[str, ...] = ()
    parts = ("body", "definitions")


def all_definitions(mission: Program) -> list[Definition]:
    """List the definitions of the included missions, then its own; of one name the last."""
    found: dict[str, Definition] = {}
    for part in _with_included(mission):
        for definition in part.definitions:
            found.pop(definition.name, None)
            found[definition.name] = definition
    return list(found.values())


def all_facts(mission: Program) -> list[Fact]:
    """List the facts of the included missions, then its own; of one place the last."""
    return list({fact.name: fact for part in _with_included(mission) for fact in part.facts}.values())


def _with_included(mission: Program) -> Iterator[Program]:
    for include in mission.includes:
        yield from _with_included(include.mission)
    yield mission


def parts(node: Ast) -> list[Ast]:
    """List the subtrees of a node in the order of its fields."""
    found: list[Ast] = []
    for field in node.parts:
        part = getattr(node, field)
        if type(part) is tuple:
            found += part
        elif part is not None:
            found.append(part)
    return found


def with_parts(node: Ast, made: Sequence[Ast]) -> Ast:
    """Return the node with other subtrees, in the order of `parts`; the node itself if none is another."""
    if all(new is old for new, old in zip(made, parts(node), strict=True)):
        return node
    rest, changed = iter(made), dict[str, object]()
    for field in node.parts:
        old = getattr(node, field)
        if old is not None:
            changed[field] = tuple(next(rest) for _ in old) if type(old) is tuple else next(rest)
    return node.replace(**changed)  # type: ignore[no-any-return]


def with_bodies(mission: Program, body: Callable[[Ast], Ast], included: Callable[[Program], Program]) -> Program:
    """Return the mission with other bodies of itself and of its definitions, and with other included missions."""
    return mission.replace(  # type: ignore[no-any-return]
        body=None if mission.body is None else body(mission.body),
        definitions=tuple(each.replace(body=body(each.body)) for each in mission.definitions),
        includes=tuple(each.replace(mission=included(each.mission)) for each in mission.includes),
    )


def parents_first(root: Ast) -> list[Ast]:
    """List every node, parents before their parts, in the order of the text."""
    found: list[Ast] = []
    stack = [root]
    while stack:
        node = stack.pop()
        found.append(node)
        if node.parts:
            stack += reversed(parts(node))
    return found


def bodies(mission: Program) -> list[Ast]:
    """List the bodies of all definitions, then the mission's own."""
    return [each.body for each in all_definitions(mission)] + ([] if mission.body is None else [mission.body])


def exact_nodes(mission: Program) -> list[Exact]:
    """List the nodes that a mission and its definitions say by their ids."""
    return [node for body in bodies(mission) for node in parents_first(body) if type(node) is Exact]


def says_ports(mission: Program) -> bool:
    """Whether a node or port is said by its name: nothing has checked that there is such a one."""
    nodes = (node for body in bodies(mission) for node in parents_first(body))
    return any(type(node) is Exact or (type(node) is Phrase and node.ports) for node in nodes)


def is_list(node: Ast) -> bool:
    """Whether it is a list of values in one phrase, whose parts all stand for the same words."""
    if not isinstance(node, Chain):
        return False
    start, end = node.span.start, node.span.end
    return all(item.span.start == start and item.span.end == end for item in node.items)


def keys_of(node: Ast) -> list[str]:
    """List the keys of values of the mission that a node itself uses, not those in its parts."""
    texts_of = _TEXTS.get(type(node))
    if texts_of is None:
        return []
    keys = [key for text in texts_of(node) if "{" in text for key in keys_in(text)]
    return [node.key, *keys] if isinstance(node, (Compared, Remember, Assign)) else keys


def chosen_keys(node: Ast) -> list[str]:
    """List the keys into which the robot puts what it chooses for a node itself."""
    texts_of = _TEXTS.get(type(node))
    choices = [choice_of(text) for text in texts_of(node)] if texts_of is not None else []
    return [choice.key for choice in choices if choice is not None]


def _of_arguments(node: Phrase | Name | Compared | Remember) -> list[str]:
    return [text for _, text in node.arguments]


_TEXTS: dict[type[Ast], Callable[[Any], Iterable[str]]] = {
    **dict.fromkeys((Phrase, Name, Compared, Remember), _of_arguments),
    **dict.fromkeys((Within, For, UpTo, Delay, Wait, Held), lambda node: (node.seconds,)),
    **dict.fromkeys((Every, Apart), lambda node: (node.seconds, node.rounds)),
    Constrained: lambda node: node.zones,
    **dict.fromkeys((WaitTime, UntilTime, ByTime), lambda node: (node.time,)),
    Assign: lambda node: (node.text,),
    ForEach: lambda node: node.values,
    Repeat: lambda node: (node.rounds,),
    Retry: lambda node: (node.attempts, node.pause),
}
"""The port texts of a node, where it has some."""
