"""Edits of a mission by its tree: what somebody does to nodes is done to the English that says them.

The English afterwards compiles to exactly the tree that was meant, only what was touched is rewritten, and all
comments stay. Which form says a node is looked up in the syntax (btlang.editing.syntax).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.editing.changes import Change, apply_changes, find_at_path, find_difference, find_path, find_place
from btlang.editing.palette import FORMS, amount_of
from btlang.editing.syntax import ChangeStep, Syntax, Unplaced, are_equal, joined
from btlang.editing.values import find_place_of_value
from btlang.editing.words import RobotWords
from btlang.editing.writing import Writer
from btlang.frontends.mission.reader import read_mission
from btlang.frontends.table import frontend_of
from btlang.passes import compile_mission, lower_mission
from btlang.printer.sentence import statements
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Source, Span
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.editing.changes import Path


class Edit(Record):
    """An edit of the node with this number, in the order of `Tree.walk`; or to it and its next siblings up to `last`.

    - `delete`: it goes, with what only serves it.
    - `insert`: the commands or conditions `words` come `place` ("before", "after", "inside") the node.
    - `copy`, `move`: the node comes `place` the node `to`.
    - `wrap`: it becomes the body of the `form` (a key of btlang.editing.palette.FORMS), with `words` for what that
      needs: a condition, a number, a duration or a time.
    - `unwrap`: the parts of a form or chain take its place, conditions and amounts go.
    - `turn`: a condition, or that of a form, becomes its opposite; the parts of a chain of commands change their order.
    - `value`: its `port` gets the value `words`.
    - `name`: it gets the name `words`, under which it is defined before its statement.
    """

    do: str
    node: int
    last: int | None = None
    to: int | None = None
    place: str = "after"
    form: str = ""
    port: str = ""
    words: str = ""


def read_edit(data: object) -> Edit:
    """Return an edit from JSON: an object with its fields. Raises MissionError (BT220)."""
    fields = data if isinstance(data, dict) else {}
    for name, value in fields.items():
        kind = int if name in ("node", "last", "to") else str
        optional = value is None and name in ("last", "to")
        if name not in Edit.fields or not (type(value) is kind or optional):
            raise _refuse(f"'{name}' can't be {value!r}")
    if "do" not in fields or "node" not in fields:
        raise _refuse("it must be an object with 'do' and 'node'")
    return Edit(**fields)


def _refuse(reason: str, span: Span = NOWHERE) -> MissionError:
    return MissionError([diagnostic("BT220", span, reason=reason)])


class Edited(Record):
    """The result of an edit: the new text, the change that makes it, and the characters in it of what was touched."""

    text: str
    change: Change
    start: int
    end: int


def edit(source: Source, words: RobotWords, edit: Edit) -> dict[str, Any]:
    """Return the `changes` of a mission in English, and `start` and `end` of what they touched, in the text that they
    make.

    Raises MissionError: BT220 if the edit can't be done or said, any other code for what would be wrong with the
    mission then, or is wrong with it now.
    """
    if frontend_of(source) != "english":
        raise _refuse("it isn't English")
    editor = Editor(source, words.vocabulary(source))
    try:
        done = editor.edited(edit)
    except Unplaced as error:
        raise _refuse(str(error), editor.span(edit)) from None
    return {"changes": [done.change.as_dict()], "start": done.start, "end": done.end}


class Editor:
    """An editor that does one edit of one text. Raises MissionError if that has something wrong."""

    def __init__(self, source: Source, vocabulary: Lexicon) -> None:
        self._source, self._vocabulary = source, vocabulary
        self._syntax = Syntax(read_mission(source, vocabulary).mission, vocabulary)
        _, self._sources = self._syntax.lowered()
        self._given: dict[int, tuple[str, ...]] = {}

    def span(self, wanted: Edit) -> Span:
        """Return where the node of an edit stands."""
        found = self._sources[wanted.node] if 0 <= wanted.node < len(self._sources) else None
        return Span(self._source, 0, 0) if found is None else found.span

    def edited(self, wanted: Edit) -> Edited:
        """Raise Unplaced and MissionError."""
        if wanted.do not in _DOES:
            raise Unplaced(f"there is no edit '{wanted.do}'; there are {', '.join(_DOES)}")
        text, program, focus = _DOES[wanted.do](self, wanted)
        read = read_mission(self._source.with_text(text), self._vocabulary).mission
        if not are_equal(compile_mission(read, self._vocabulary), lower_mission(program, self._vocabulary)):
            raise Unplaced("no English says it there")
        start, end = find_place(focus, Syntax(program, self._vocabulary), read)
        return Edited(text, find_difference(self._source.text, text), start, end)

    # -- what is done, as the text and the syntax afterwards, and what of that was touched

    def delete(self, wanted: Edit) -> _Done:
        nodes = self._nodes(wanted)
        return self._write(self._syntax.steps(nodes, ()), None)

    def insert(self, wanted: Edit) -> _Done:
        target = self._node(wanted.node)
        new = self._read(wanted.words, self._takes_condition(target, wanted.place))
        return self._write(self._place(target, wanted.place, new), new[0])

    def copy(self, wanted: Edit) -> _Done:
        nodes = self._nodes(wanted)
        target = self._target(wanted)
        if self._takes_condition(target, wanted.place) != self._syntax.is_condition(nodes[0]):
            raise Unplaced("a condition stands where a condition is asked for, and a command elsewhere")
        copies = [node.replace(bracketed=True) if isinstance(node, ast.Chain) else node.replace() for node in nodes]
        steps = self._place(target, wanted.place, copies)
        program = self._syntax.changed(steps[-1])
        writer = Writer(self._source, self._syntax, copies=dict(zip(map(id, copies), nodes, strict=True)))
        return self._done(writer.written(steps, program), program, copies[0])

    def move(self, wanted: Edit) -> _Done:
        """Return a copy, without what was copied: so each of the two places is written for itself."""
        nodes = self._nodes(wanted)
        target = self._target(wanted)
        if any(target is inner for node in nodes for inner in ast.parents_first(node)):
            raise Unplaced("it can't come into itself")
        text, program, focus = self.copy(wanted)
        copied = Syntax(program, self._vocabulary)
        if any(id(node) not in copied.slots for node in nodes):  # it holds the copy now
            raise Unplaced("it can't come into itself")
        paths = [find_path(node, copied) for node in nodes]
        text, _ = self._replace(text, paths, ())
        return text, copied.changed(copied.steps(nodes, ())[-1]), focus

    def wrap(self, wanted: Edit) -> _Done:
        nodes = self._nodes(wanted)
        if wanted.form not in FORMS:
            raise Unplaced(f"there is no form '{wanted.form}'; there are {', '.join(FORMS)}")
        form = FORMS[wanted.form]
        if form.of_conditions != self._syntax.is_condition(nodes[0]):
            raise Unplaced(f"it is {'no' if form.of_conditions else 'a'} condition")
        if form.operator:
            if len(nodes) < 2:
                raise Unplaced("that takes two or more")
            new = joined(nodes, form.operator, self._operator(nodes[0]) == form.operator)
        else:
            condition = self._read(wanted.words, True)[0] if form.needs == "condition" else None
            what = condition or amount_of(form.needs, wanted.words, self._vocabulary)
            new = form.made(joined(nodes, self._operator(nodes[0])), what)
        return self._write(self._syntax.steps(nodes, (new,)), new)

    def unwrap(self, wanted: Edit) -> _Done:
        node = self._node(wanted.node)
        parts = ast.parts(node)
        if node is self._syntax.mission.body and isinstance(node, ast.Chain) and "\n" in node.span.text:
            raise Unplaced("it is the whole mission, and in no form")
        if not self._syntax.is_condition(node):
            parts = [part for part in parts if part is not getattr(node, "condition", None)]
        if not parts:
            raise Unplaced("it holds nothing that could take its place")
        new: list[ast.Ast] = []
        for part in parts:  # a body's commands become those of what is around it
            is_body = not isinstance(node, ast.Chain) and isinstance(part, ast.Chain) and part.operator == "sequence"
            new += ast.parts(part) if is_body else (part,)
        operator = "all" if self._syntax.is_condition(node) else "sequence"
        return self._write(self._syntax.steps((node,), new, operator=operator), new[0])

    def turn(self, wanted: Edit) -> _Done:
        node = self._node(wanted.node)
        first: Sequence[Change] = ()
        if isinstance(node, ast.If | ast.While):
            new: ast.Ast = node.replace(negated=not node.negated)
            roles = ("if", "unless") if isinstance(node, ast.If) else ("while", "until")
            first = self._writer().words(node, roles[node.negated], roles[not node.negated])
        elif isinstance(node, ast.Not):
            new = node.condition
        elif self._syntax.is_condition(node):
            new = ast.Not(node, node.span)
        elif isinstance(node, ast.Chain):
            return self._write(self._syntax.steps(node.items, node.items[::-1]), node.items[-1])
        else:
            raise Unplaced("it has no opposite")
        return self._write(self._syntax.steps((node,), (new,)), new, first)

    def value(self, wanted: Edit) -> _Done:
        node = self._node(wanted.node)
        place = find_place_of_value(node, wanted.port)
        new = place.filled(amount_of(place.kind, wanted.words, self._vocabulary))
        first = self._writer().values(node, place.kind, place.text, wanted.words)
        return self._write(self._syntax.steps((node,), (new,)), new, first)

    def name(self, wanted: Edit) -> _Done:
        """Name commands in two steps: a definition that nothing uses yet, and then its name in the place of what it
        says.
        """
        nodes = self._nodes(wanted)
        name = " ".join(wanted.words.split())
        if not name or any(each.name == name for each in self._syntax.mission.definitions):
            raise Unplaced(f"the name '{name}' is used already" if name else "it needs a name")
        body = joined(nodes, self._operator(nodes[0]))
        defined = ast.Definition(name, (), body, nodes[0].span, nodes[0].span)
        mission = self._syntax.mission
        step = ChangeStep(mission, "definitions", len(mission.definitions), (), (defined,))
        writer, program = self._writer(), self._syntax.changed(step)
        near = self._statement(nodes[0])
        try:
            change = writer.written([step], program, near)
        except (Unplaced, MissionError):
            change = writer.written([step], program)
        used = ast.Name(name, (), nodes[0].span)
        paths = [find_path(node, self._syntax) for node in nodes]
        return *self._replace(apply_changes(self._source.text, [change]), paths, (used,)), used

    # -- parts of edits

    def _replace(self, text: str, paths: Sequence[Path], new: Sequence[ast.Ast]) -> tuple[str, ast.Program]:
        """Return the second step of an edit, in the text that the first one made: other nodes in the place of those at
        the end of some ways. Their comments go, as far as they stand elsewhere by then.
        """
        source = self._source.with_text(text)
        syntax = Syntax(read_mission(source, self._vocabulary).mission, self._vocabulary)
        old = [find_at_path(path, syntax.mission) for path in paths]
        steps = syntax.steps(old, new)
        after = syntax.changed(steps[-1])
        writer = Writer(source, syntax)
        change = writer.written(steps, after, gone=writer.comments_of(old, self._source.text))
        return apply_changes(text, [change]), after

    def _operator(self, node: ast.Ast) -> str:
        """Return the operator of the chain that a node is a part of, or would be with others in its place."""
        around = self._syntax.holder(node)
        return around.operator if isinstance(around, ast.Chain) else "sequence"

    def _place(self, target: ast.Ast, place: str, new: Sequence[ast.Ast]) -> list[ChangeStep]:
        """Return what comes before, after or inside a node."""
        syntax = self._syntax
        if place == "inside":
            if isinstance(target, ast.Chain):
                return syntax.steps((target,), new, len(target.items))
            body = getattr(target, "body", None) or getattr(target, "items", ())
            if isinstance(body, tuple) or body is None:
                raise Unplaced("it holds no other commands")
            if isinstance(body, ast.Chain) and body.operator == "sequence":
                return syntax.steps((body,), new, len(body.items))
            return syntax.steps((body,), (body, *new))
        if place not in ("before", "after"):
            raise Unplaced("'place' is before, after or inside")
        slot = syntax.slots[id(target)]
        behind = place == "after"
        if isinstance(slot.parent, ast.Chain) and slot.at is not None:
            return syntax.steps((slot.parent,), new, slot.at + behind, before=not behind)
        if isinstance(target, ast.Chain) and target.operator == "sequence" and slot.at is None:
            return syntax.steps((target,), new, len(target.items) if behind else 0)
        operator = "all" if self._syntax.is_condition(target) else "sequence"
        return syntax.steps((target,), (target, *new) if behind else (*new, target), operator=operator)

    def _writer(self) -> Writer:
        return Writer(self._source, self._syntax, self._given)

    def _write(self, steps: list[ChangeStep], focus: ast.Ast | None, first: Iterable[Change] = ()) -> _Done:
        program = self._syntax.changed(steps[-1])
        if program.body is None and self._syntax.mission.body is not None:
            raise Unplaced("a mission needs a command")
        return self._done(self._writer().written(steps, program, first=first), program, focus)

    def _done(self, change: Change, program: ast.Program, focus: ast.Ast | None) -> _Done:
        return apply_changes(self._source.text, [change]), program, focus

    def _read(self, words: str, is_condition: bool) -> list[ast.Ast]:
        """Read new commands or a condition, where all names of the mission are known."""
        check = f"{self._vocabulary.word('check')} " if is_condition else ""
        text = self._source.text
        source = self._source.with_text(f"{text}{'' if text.endswith(chr(10)) else chr(10)}{check}{words.strip()}\n")
        before = list(statements(self._syntax.mission.body))
        read = [item for item, _ in statements(read_mission(source, self._vocabulary).mission.body)][len(before) :]
        if not read or read[0].span.start < len(text):
            raise Unplaced("these words are no commands of their own")
        if is_condition:
            if len(read) > 1 or not isinstance(read[0], ast.Check):
                raise Unplaced("these words are no condition")
            read = [read[0].condition]
        for node in read:
            said = node.span.text
            if "\n" not in said and (is_condition or not isinstance(node, ast.Chain)):
                self._given[id(node)] = (said,)
        return read

    def _takes_condition(self, target: ast.Ast, place: str) -> bool:
        """Return whether conditions stand there, and no commands."""
        return self._syntax.is_condition(target) and (place != "inside" or isinstance(target, ast.Chain | ast.AtLeast))

    def _target(self, wanted: Edit) -> ast.Ast:
        if wanted.to is None:
            raise Unplaced("'to' must be the number of a node")
        return self._node(wanted.to)

    def _node(self, number: int) -> ast.Ast:
        found = self._sources[number] if 0 <= number < len(self._sources) else None
        if found is None or found.span.source is not self._source:
            raise Unplaced("it isn't said in this text")
        return found

    def _nodes(self, wanted: Edit) -> list[ast.Ast]:
        """Return the node, or it and its siblings up to another."""
        first, last = self._node(wanted.node), self._node(wanted.node if wanted.last is None else wanted.last)
        if first is last:
            is_mission = first is self._syntax.mission.body and isinstance(first, ast.Chain) and "\n" in first.span.text
            return list(ast.parts(first)) if is_mission else [first]  # definitions may stand between its lines
        slots = self._syntax.slots[id(first)], self._syntax.slots[id(last)]
        one, other = sorted(slot.at or 0 for slot in slots)
        if slots[0].parent is not slots[1].parent or not isinstance(slots[0].parent, ast.Chain):
            raise Unplaced("they don't stand side by side")
        return list(slots[0].parent.items[one : other + 1])

    def _statement(self, node: ast.Ast) -> ast.Ast:
        """Return the statement of the mission, or the definition, in which a node stands."""
        while True:
            around = self._syntax.holder(node)
            slot = self._syntax.slots.get(id(around))
            if slot is None or (isinstance(slot.parent, ast.Program) and isinstance(around, ast.Chain)):
                return node
            node = around


if TYPE_CHECKING:
    from typing import TypeAlias

    _Done: TypeAlias = tuple[str, ast.Program, ast.Ast | None]

_DOES: Mapping[str, Callable[[Editor, Edit], _Done]] = {
    "delete": Editor.delete,
    "insert": Editor.insert,
    "copy": Editor.copy,
    "move": Editor.move,
    "wrap": Editor.wrap,
    "unwrap": Editor.unwrap,
    "turn": Editor.turn,
    "value": Editor.value,
    "name": Editor.name,
}
