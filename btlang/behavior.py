"""Trees in Python: what the functions of btlang.builders make, and how a mission is made of it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import CoroutineType, GeneratorType
from typing import TypeAlias

from btlang.api import Mission, mission_of_tree, source_of
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.engine.script.values import to_stored
from btlang.frontends.table import read_text
from btlang.passes import compile_mission, errors_of
from btlang.robots.mission_vocabulary import described, world_vocabulary
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Source, Span, find_calling_line
from btlang.tree.ast import Fact, all_facts
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, POST_CONDITIONS, PRE_CONDITIONS, NodeKind
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    import os
    from typing import Any, overload

    from btlang.backends.targets import BinaryTarget, TextTarget
    from btlang.run.outcome import Outcome
    from btlang.vocabulary.load import Keywords

Value: TypeAlias = str | float | bool
"""What a port can be set to; a text `{key}` refers to the blackboard."""


class Behavior(Record, uncompared=("span", "numbers")):
    """A node of a tree in Python, with its children. Immutable; `mission` checks it and finds the words of its texts.

    A child is another behavior, a command or condition in English, the text of a mission, XML or JSON, a function
    decorated with `btlang.action` or `btlang.condition`, a btlang.Mission or a tree. `call` is the decorated function
    of a leaf, None for others. `span` is the line of the script that made it, which messages show. `numbers` are the
    ports that were set to a number or a bool.
    """

    id: str
    children: tuple[Child, ...] = ()
    ports: tuple[tuple[str, str], ...] = ()
    name: str = ""
    call: Callable[..., Any] | None = None
    span: Span | None = None
    numbers: tuple[str, ...] = ()

    def __repr__(self) -> str:
        count = len(self.children)
        return f"<Behavior {self.id}{f', {count} child' + 'ren' * (count > 1) if count else ''}>"

    def mission(
        self,
        *,
        keywords: Keywords = (),
        world: str | os.PathLike[str] | Source | None = None,
        language: str = ENGLISH,
        subtrees: Mapping[str, Child] = {},
    ) -> Mission:
        """Compile it. Its functions are words of its texts, too; the options are those of `btlang.parse_tree`.

        Its texts may also use the other decorated functions of the scripts that made the tree, such as quantities. A
        function of `keywords` with `replace=True` and the id or the phrase of a function in the tree runs in its place.
        `subtrees` are the trees that `sub_tree` nodes name. Raises MissionError for all mistakes of the first text that
        has some, or of the tree: ports of known nodes are checked (BT132), unknown nodes only when it runs.
        """
        parts = [self, *subtrees.values()]
        own = list(dict.fromkeys(_functions([*parts])))
        others = [each for each in _functions_of_scripts([*parts]) if each not in own]
        try:
            return self._compile(_with_fakes(keywords, [*own, *others]), world, language, subtrees)
        except MissionError as error:
            if not others:
                raise
            try:  # the functions of the script may not go together, or with the words that ship
                return self._compile(_with_fakes(keywords, own), world, language, subtrees)
            except MissionError as left:
                raise min(error, left, key=lambda each: len(each.diagnostics)) from None

    def _compile(
        self,
        keywords: Keywords,
        world: str | os.PathLike[str] | Source | None,
        language: str,
        subtrees: Mapping[str, Child],
    ) -> Mission:
        vocabulary = world_vocabulary(keywords, world, language)
        assembly = _Assembly(vocabulary)
        for name, child in subtrees.items():
            assembly.define(name, assembly.node(child))
        root = assembly.node(self)
        tree = Tree(root, tuple(assembly.subtrees.items()))
        mission = mission_of_tree(tree, vocabulary, world, tuple(assembly.facts))
        misfits, found = assembly.misfits, {each.span for each in assembly.misfits}
        misfits += [each for each in mission.problems() if each.code == _MISFIT and each.span not in found]
        if misfits:
            raise MissionError(misfits)
        return mission

    def run(self, *, keywords: Keywords = (), **options: Any) -> Outcome:
        """Compile and run it, with further words; the options are those of `btlang.Mission.run`."""
        return self.mission(keywords=keywords).run(**options)

    if TYPE_CHECKING:

        @overload
        def to(self, target: TextTarget, **options: Any) -> str: ...

        @overload
        def to(self, target: BinaryTarget, **options: Any) -> bytes: ...

        @overload
        def to(self, target: str, **options: Any) -> str | bytes: ...

    def to(self, target: str, **options: Any) -> str | bytes:
        """Return the tree as "english", "xml" or another target of `btlang.Mission.to`."""
        return self.mission().to(target, **options)

    def __str__(self) -> str:
        return str(self.mission())


Child: TypeAlias = "Behavior | str | Source | Node | Tree | Mission | Callable[..., object]"


def leaf(what: str | Callable[..., object], /, *values: Value, name: str = "", **ports: Value) -> Behavior:
    """Make a command or condition: a decorated function (`btlang.action`, `btlang.condition`), or the id of a known
    one.

    `leaf(cheer, "Alice", times=2)` and `leaf("GoTo", place="lab")`. The values are for the slots of the function in the
    order of its phrase. A port called `name` is set with a value in that order. Raises TypeError if they don't fit.
    """
    if isinstance(what, str):
        if values:
            raise TypeError(f"the ports of {what} are set by their names")
        return Behavior(what, (), _ports(ports), name, span=find_calling_line(), numbers=_numbers(ports))
    entry = _entry(what)
    slots = [slot.name for slot in entry.slots]
    if "name" in slots[len(values) :] and name:
        ports, name = {**ports, "name": name}, ""
    given = dict(zip(slots, values, strict=False))
    unknown = [port for port in ports if port not in slots or port in given]
    if len(values) > len(slots) or unknown:
        wrong = f"{unknown[0]!r}" if unknown else f"{len(values)} values"
        raise TypeError(f"{entry.id} takes {', '.join(slots) or 'no values'}, not {wrong}")
    ports = {**given, **ports}
    return Behavior(entry.id, (), _ports(ports), name, what, find_calling_line(), _numbers(ports))


def from_py_trees(root: object, *, names: bool = True) -> Behavior:
    """Return the behavior of a live py_trees tree: its root, or a `BehaviourTree`.

    Nodes become their counterparts (docs/engine.md lists the differences). Leaves that btlang made for py_trees are
    commands and conditions again. Other behaviours without children stay what they are, and are ticked as leaves: call
    their `setup` before. Without `names` the nodes don't get the names of their behaviours, and the English is plainer.
    Raises MissionError (BT134) for all nodes without a counterpart.
    """
    from btlang.backends.py_trees.lift import read_py_trees  # which needs py_trees

    span = find_calling_line()
    tree, leaves = read_py_trees(root, span, names)

    def made(node: Node, children: list[Behavior]) -> Behavior:
        return Behavior(node.id, tuple(children), node.ports, node.name, leaves.get(node.id), node.span or span)

    return fold(tree, lambda node: node.children, made)


def built(
    kind: NodeKind,
    children: tuple[Child | None, ...],
    ports: Mapping[str, object],
    name: str,
    scripts: Mapping[str, object],
) -> Behavior:
    """Make a behavior of a built-in node: what the functions of btlang.builders do. Raises TypeError for a misfit."""
    own = tuple(child for child in children if child is not None)
    if None in (children if kind.most >= MOST_NODES else children[: kind.least]):
        raise TypeError(_misfit(None))
    if not kind.least <= len(own) <= kind.most:
        most = "" if kind.most >= MOST_NODES else f" to {kind.most}" if kind.most != kind.least else ""
        least = f"at least {kind.least}" if kind.most >= MOST_NODES else f"{kind.least}{most}"
        raise TypeError(
            f"{kind.id} takes {least} child{'ren' * (max(kind.least, kind.most % MOST_NODES) > 1)}, not {len(own)}"
        )
    for child in own:
        if not isinstance(child, Behavior | str | Source | Node | Tree | Mission):
            _entry(child)
    given = {**ports, **scripts}
    return Behavior(kind.id, own, _ports(given), name, span=find_calling_line(), numbers=_numbers(given))


def _ports(ports: Mapping[str, object]) -> tuple[tuple[str, str], ...]:
    return tuple((port, _text(port, value)) for port, value in ports.items() if value is not None)


def _numbers(ports: Mapping[str, object]) -> tuple[str, ...]:
    return tuple(port for port, value in ports.items() if isinstance(value, int | float))


def _text(port: str, value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return str(to_stored(value))
    if isinstance(value, str):
        return value
    raise TypeError(f"{port} is a text, a number or a bool, not {described(value)}")


def _entry(what: object) -> Entry:
    entry = getattr(what, "btlang_entry", None)
    if isinstance(entry, Entry):
        return entry
    raise TypeError(_misfit(what))


def _misfit(what: object) -> str:
    """Say that something can't be a part of a tree, and what to write in its place."""
    return f"{getattr(what, '__name__', '') or described(what)} can't be a part of a tree; {_advice(what)}"


def _advice(what: object) -> str:
    if isinstance(what, list | tuple):
        return "give its children one by one, or with a star: sequence(*children)"
    if isinstance(what, GeneratorType | CoroutineType):  # `weld(1)`, whose function is a leaf
        return f"give the function and its values, and don't call it: {_as_leaf(what)}"
    if any(base.__module__.startswith("py_trees.") for base in type(what).__mro__):
        return "write btlang.from_py_trees(...) round it"
    decorated = "decorate a function with btlang.action or btlang.condition"
    return decorated if callable(what) else f"{decorated}, and give it its values with leaf(function, value)"


def _as_leaf(called: GeneratorType[Any, Any, Any] | CoroutineType[Any, Any, Any]) -> str:
    """Return the leaf that is meant by a call of a function that is to run later."""
    frame = called.gi_frame if isinstance(called, GeneratorType) else called.cr_frame
    values: dict[str, object] = {}
    if frame is not None:
        code = frame.f_code
        names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
        values = {name: frame.f_locals[name] for name in names if name in frame.f_locals}
    called.close()  # nobody will run it
    entry = getattr(frame and frame.f_globals.get(called.__name__), "btlang_entry", None)
    slots = [slot.name for slot in entry.slots] if isinstance(entry, Entry) else list(values)
    given = [repr(values[slot]) for slot in slots if slot in values]
    return f"leaf({', '.join([called.__name__, *given])})"


def _with_fakes(keywords: Keywords, functions: Iterable[Callable[..., object]]) -> list[Any]:
    """Return all words, each once; of those that replace one of these functions its entry, with what they call."""
    words = list(keywords)
    for function in functions:
        own = _entry(function)
        fake = next((each for each in words if _is_fake(each, own)), None)
        if fake is None:
            if function not in words:
                words.append(function)
            continue
        words[words.index(fake)] = own.replace(call=fake, thread=_entry(fake).thread)
        if function in words:
            words.remove(function)
    return words


def _is_fake(word: object, own: Entry) -> bool:
    entry = getattr(word, "btlang_entry", None)
    if not isinstance(entry, Entry) or not entry.replaces:
        return False
    return entry.id == own.id if entry.id else (entry.phrases, entry.quantity) == (own.phrases, own.quantity)


def _functions(waiting: list[Child]) -> list[Callable[..., object]]:
    """Return the functions in behaviors, and those that the words of their missions call."""
    found: list[Callable[..., object]] = []
    while waiting:
        child = waiting.pop()
        if isinstance(child, Behavior):
            found += (child.call,) if child.call is not None else ()
            waiting += child.children
        elif isinstance(child, Mission):
            entries = (child.vocabulary.entry(node.id) for node in child.tree.walk())
            found += (entry.call for entry in entries if entry is not None and hasattr(entry.call, "btlang_entry"))  # type: ignore[misc]
        elif hasattr(child, "btlang_entry"):
            found.append(child)  # type: ignore[arg-type]
    return found


def _functions_of_scripts(waiting: list[Child]) -> list[Callable[..., object]]:
    """Return the decorated functions of the scripts that made behaviors with texts.

    Without those that replace words, and those that have the words of another one.
    """
    paths, has_texts = set[str](), False
    while waiting:
        child = waiting.pop()
        has_texts |= isinstance(child, str | Source)
        if isinstance(child, Behavior):
            paths |= {child.span.source.name} if child.span is not None else set()
            waiting += child.children
    scripts = paths if has_texts else ()
    modules = [module for module in list(sys.modules.values()) if getattr(module, "__file__", None) in scripts]
    functions = dict.fromkeys(each for module in modules for each in vars(module).values() if _is_word(each))
    said = [(entry.phrases, entry.quantity) for entry in map(_entry, functions)]
    return [each for each, own in zip(functions, said, strict=True) if said.count(own) == 1]


def _is_word(value: object) -> bool:
    entry = getattr(value, "btlang_entry", None)
    return isinstance(entry, Entry) and not entry.replaces


_ONLY_A_CONDITION, _MISFIT = "BT028", "BT132"
_IN_TEXT = {"text": "a text", "names": "the name of a {type}", "time": "a time such as '18:30'"}


class _Assembly:
    """An assembly of one tree from behaviors, which collects what their texts define."""

    def __init__(self, vocabulary: Lexicon) -> None:
        self._vocabulary = vocabulary
        self.subtrees: dict[str, Node] = {}
        self.facts: list[Fact] = []
        self.misfits: list[Diagnostic] = []

    def define(self, name: str, root: Node) -> None:
        """Define a tree by its name. Raises MissionError (BT127) for another tree with a name that is taken."""
        if self.subtrees.setdefault(name, root) != root:
            raise MissionError([diagnostic("BT127", root.span or NOWHERE, name=name)])

    def node(self, child: Child) -> Node:
        return fold(child, _parts, self._made)

    def _made(self, child: Child, children: list[Node]) -> Node:
        if isinstance(child, Behavior):
            self.misfits += self._misfits(child) if child.numbers else ()
            return Node(child.id or self._id_of(child.call), tuple(children), child.ports, child.name, child.span)
        if isinstance(child, Node):
            return child
        if isinstance(child, str | Source):
            return self._root(self._read(source_of(child)))
        if isinstance(child, Mission):
            self.facts += child.facts
            return self._root(child.tree)
        if isinstance(child, Tree):
            return self._root(child)
        return Node(_entry(child).id or self._id_of(child))

    def _misfits(self, child: Behavior) -> Iterator[Diagnostic]:
        """Find ports that hold texts but were set to a number (BT132)."""
        slots = {slot.name: slot.type for entry in self._vocabulary.entries.get(child.id, ()) for slot in entry.slots}
        ports = CATALOGUE[child.id].ports if child.id in CATALOGUE else {}
        for port, text in child.ports:
            kind = self._vocabulary.types.get(slots.get(port, ""))
            wanted = _IN_TEXT.get("" if kind is None else kind.kind, "")
            if port in ports and (ports[port].type == "std::string" or ports[port].holds):
                wanted = "a text"
            if port in (*PRE_CONDITIONS, *POST_CONDITIONS):
                wanted = "a script"
            if port in child.numbers and wanted:
                reason = f"{port} must be {wanted.format(type=kind and kind.name)}, not the value {text}"
                yield diagnostic(_MISFIT, child.span or NOWHERE, id=child.id, reason=reason)

    def _root(self, tree: Tree) -> Node:
        for name, root in tree.subtrees:
            self.define(name, root)
        return tree.root

    def _read(self, source: Source) -> Tree:
        try:
            read = read_text(source, vocabulary=self._vocabulary, errors_of=errors_of)
        except MissionError as error:
            if [problem.code for problem in error.diagnostics] != [_ONLY_A_CONDITION]:
                raise
            checked = source.with_text(f"{self._vocabulary.word('check')} {source.text}")
            read = read_text(checked, vocabulary=self._vocabulary, errors_of=errors_of)
        if isinstance(read, Tree):
            return read
        self.facts += all_facts(read.mission)
        return compile_mission(read.mission, self._vocabulary)

    def _id_of(self, call: object) -> str:
        """Return the id of a function that replaces the word with its phrase."""
        found = (node_id for node_id, known in self._vocabulary.entries.items() if any(e.call is call for e in known))
        return next(found, "")


def _parts(child: Child) -> tuple[Child, ...]:
    """Return the children of a behavior; texts and functions are at its line."""
    if not isinstance(child, Behavior):
        return ()
    span = child.span
    if span is None:
        return child.children
    return tuple(_placed(part, span) for part in child.children)


def _placed(child: Child, span: Span) -> Child:
    if isinstance(child, str):
        line, _ = span.source.position(span.start)
        return Source(child, f"{span.source.name}:{line} <text>", folder="")
    if hasattr(child, "btlang_entry"):
        return Behavior(_entry(child).id, call=child, span=span)  # type: ignore[arg-type]
    return child
