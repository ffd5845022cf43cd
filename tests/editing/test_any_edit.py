"""Any edit of any mission: the tree afterwards is the one that was meant, and what wasn't touched stands as it stood.

What is meant is said here of trees alone, with nothing of how texts are changed.
"""

from __future__ import annotations

import random
from collections.abc import Sequence

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.changes import apply_changes
from btlang.editing.edits import Edit, Editor
from btlang.editing.lines import comments_in
from btlang.editing.syntax import Syntax, Unplaced
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.printer.mission import mission_lines, printer_of
from btlang.text.source import Source
from btlang.tree import ast
from btlang.tree.node import Node, Tree
from tests.language.letters import COMMANDS, CONDITIONS, letters
from tests.printer.trees import SPAN, phrase
from tests.profiles import searches

CHAINS = ("Sequence", "Fallback", "Parallel")
DOES = ("delete", "insert", "copy", "move", "wrap", "unwrap", "turn", "name")

Way = tuple[int, ...]


def plain(inner: st.SearchStrategy[ast.Ast]) -> st.SearchStrategy[ast.Ast]:
    """Chains and forms without values and rules."""
    condition, span = st.sampled_from(CONDITIONS).map(phrase), st.just(SPAN)
    chains = st.sampled_from(["sequence", "fallback", "parallel"])
    return st.one_of(
        st.builds(chain, chains, st.lists(inner, min_size=2, max_size=3)),
        st.builds(ast.If, st.booleans(), condition, inner, st.one_of(st.none(), inner), span),
        st.builds(ast.While, st.booleans(), condition, inner, st.none(), span),
        st.builds(ast.Repeat, st.sampled_from(["2", "-1"]), inner, span),
        st.builds(ast.Retry, st.just("3"), inner, st.just(""), span),
        st.builds(ast.Try, inner, st.one_of(st.none(), inner), span),
        st.builds(ast.Provided, condition, inner, span),
        st.builds(ast.Within, st.just("5"), inner, span),
        st.builds(ast.For, st.just("90"), inner, span),
    )


def chain(operator: str, items: list[ast.Ast]) -> ast.Ast:
    bracketed = [
        item.replace(bracketed=True) if isinstance(item, ast.Chain) and item.operator == operator else item
        for item in items
    ]
    return ast.Chain(operator, tuple(bracketed), False, SPAN)


@st.composite
def texts(draw: st.DrawFn) -> str:
    """Missions with comments and empty lines, laid out in some way; without values and rules."""
    commands = st.recursive(st.sampled_from(COMMANDS).map(phrase), plain, max_leaves=6)
    statements = draw(st.lists(commands, min_size=2, max_size=4))
    program = ast.Program(chain("sequence", statements), (), SPAN)
    printer = printer_of(program, letters(), draw(st.sampled_from(["needed", "clear", "all"])))
    chance = random.Random(draw(st.integers(0, 1000)))
    lines: list[str] = []
    for line in mission_lines(program, printer, draw(st.sampled_from([30, 60, 1000]))):
        margin = line[: len(line) - len(line.lstrip())]
        if chance.random() < 0.3:
            lines.append(chance.choice(["", f"{margin}# above {len(lines)}"]))
        lines.append(line + (f"  # behind {len(lines)}" if chance.random() < 0.3 else ""))
    return "\n".join(lines) + draw(st.sampled_from(["", "\n", "\n\n# the end\n"]))


def tree_of(text: str) -> Tree:
    return compile_mission(read_mission(Source(text), letters()).mission, letters())


def ways(tree: Tree) -> list[Way]:
    """The way to each node of the main tree, in the order of `Tree.walk`."""
    found: list[Way] = []
    stack: list[tuple[Node, Way]] = [(tree.root, ())]
    while stack:
        node, way = stack.pop()
        found.append(way)
        stack += [(child, (*way, i)) for i, child in reversed(list(enumerate(node.children)))]
    return found


def at(root: Node, way: Way) -> Node:
    for i in way:
        root = root.children[i]
    return root


def put(root: Node, way: Way, nodes: Sequence[Node]) -> Node:
    """The tree with nodes in the place of one; a chain of one is that one, and equal chains are one."""
    if not way:
        [node] = nodes
        return node
    [*before, i] = way
    parent = at(root, tuple(before))
    children = (*parent.children[:i], *nodes, *parent.children[i + 1 :])
    made = [parent.replace(children=children)] if len(children) > 1 or parent.id not in CHAINS else list(children)
    return put(root, tuple(before), made)


def flat(node: Node) -> object:
    """A tree where a chain in an equal chain is no other one, as it depends on brackets."""
    children: list[object] = []
    for child in node.children:
        inner = flat(child)
        if isinstance(inner, tuple) and inner[0] == node.id and node.id in CHAINS and child.ports == node.ports:
            children += inner[2]
        else:
            children.append(inner)
    return node.id, node.ports, children


def meant(text: str, edit: Edit) -> Node | None:
    """The main tree after an edit of a part of a chain that is said, None where that is not said here."""
    tree = tree_of(text)
    syntax = Syntax(read_mission(Source(text), letters()).mission, letters())
    said = syntax.lowered()[1][edit.node]
    if said is None or not isinstance(syntax.holder(said), ast.Chain):
        return None
    places = ways(tree)
    way, root = places[edit.node], tree.root
    node = at(root, way)
    parent = at(root, way[:-1]) if way else None
    is_implied = len(way) > 0 and syntax.lowered()[1][places.index(way[:-1])] is not syntax.holder(said)
    if parent is None or is_implied or parent.id not in ("Sequence", "Fallback") or edit.last is not None:
        return None
    match edit.do:
        case "delete":
            return put(root, way, ())
        case "insert" if edit.words == "u":
            new = [node, Node("U")] if edit.place == "after" else [Node("U"), node]
            return put(root, way, new) if edit.place != "inside" else None
        case "wrap" if edit.form == "try":
            return put(root, way, [Node("ForceSuccess", (node,))])
        case "turn" if node.id in ("Sequence", "Fallback"):
            return put(root, way, [node.replace(children=node.children[::-1])])
    return None


@st.composite
def edits(draw: st.DrawFn, count: int) -> Edit:
    """Of a tree with so many nodes."""
    node, to = draw(st.integers(0, count - 1)), draw(st.integers(0, count - 1))
    do = draw(st.sampled_from(DOES))
    form, words = draw(st.sampled_from([("try", ""), ("retry", "2"), ("if", "p"), ("within", "5 s"), ("in order", "")]))
    if do != "wrap":
        form, words = "", draw(st.sampled_from(["u", "v then w"])) if do == "insert" else "new thing"
    last = to if do in ("wrap", "delete") and draw(st.booleans()) else None
    return Edit(do, node, last, to, draw(st.sampled_from(["before", "after", "inside"])), form, "", words)


def outside(text: str, edit: Edit) -> list[str]:
    """What stands before, between and behind the statements that an edit touches."""
    syntax = Syntax(read_mission(Source(text), letters()).mission, letters())
    _, sources = syntax.lowered()
    body = syntax.mission.body
    items = body.items if isinstance(body, ast.Chain) and body.operator == "sequence" and not body.bracketed else [body]
    touched: list[tuple[int, int]] = []
    for number in (edit.node, edit.last, edit.to):
        node = sources[number] if number is not None else None
        touched += [
            (_head(text, item.span.start), item.span.end)
            for item in items
            if node is not None and item is not None and any(node is each for each in ast.parents_first(item))
        ]
        if node is body:
            touched.append((0, len(text)))
    if edit.last is not None and touched:
        touched = [(min(touched)[0], max(end for _, end in touched))]
    lines = text.split("\n")
    starts = [sum(len(line) + 1 for line in lines[:i]) for i in range(len(lines))]
    kept, block = [], []
    for line, start in zip(lines, starts, strict=True):
        comment = line.strip().startswith("#") or not line.strip()
        if comment or any(first <= start + len(line) and start <= last for first, last in touched):
            kept.append("\n".join(block))
            block = []
        else:
            block.append(line)
    return [part for part in (*kept, "\n".join(block)) if part]


def _head(text: str, start: int) -> int:
    """Where the line of a statement begins, which has no blanks before it: what was read may begin below `try:`."""
    start = text.rfind("\n", 0, start) + 1
    while text[start : start + 1] in (" ", "#", "\n"):
        start = text.rfind("\n", 0, start - 1) + 1
    return start


def check(text: str, edit: Edit) -> bool:
    """Whether the edit could be done."""
    try:
        edited = Editor(Source(text), letters()).edited(edit)
    except Unplaced as error:
        said_why = "no English" not in str(error)
        assert said_why, (text, edit)
        return False
    except MissionError as error:
        codes = {each.code for each in error.diagnostics}
        if edit.do != "insert" or not codes & {"BT028", "BT029"}:  # a command where a condition stands
            raise
        return False
    after = tree_of(edited.text)
    wanted = meant(text, edit)
    if wanted is not None:
        assert flat(after.root) == flat(wanted), (text, edit, edited.text)
    assert not comments_in(text, letters().orthography) - comments_in(edited.text, letters().orthography)
    assert apply_changes(text, [edited.change]) == edited.text
    place = 0
    for part in outside(text, edit):
        assert part in edited.text[place:], (text, edit, edited.text)
        place = edited.text.index(part, place) if edit.do != "move" else 0
    return True


@searches(30, 3000)
@given(data=st.data(), text=texts())
def test_any_edit(data: st.DataObject, text: str) -> None:
    check(text, data.draw(edits(len(ways(tree_of(text))))))


@searches(8, 800)
@given(data=st.data(), text=texts())
def test_many_edits_one_after_the_other(data: st.DataObject, text: str) -> None:
    editor_text, done = text, 0
    for _ in range(6):
        edit = data.draw(edits(len(ways(tree_of(editor_text)))))
        if check(editor_text, edit):
            editor_text = Editor(Source(editor_text), letters()).edited(edit).text
            done += 1
    assume(done)


def test_what_stands_between_statements_stays() -> None:
    text = "u\n\ntea means v\n# first\ntea\nw  # last\n"
    assert done(text, Edit("insert", 2, place="before", words="x")) == "u\n\ntea means v\nx\n# first\ntea\nw  # last\n"
    assert done(text, Edit("insert", 1, place="after", words="x")) == "u\nx\n\ntea means v\n# first\ntea\nw  # last\n"
    wrapped = "\ntea means v\ntry:\n  u\n  # first\n  tea\nw  # last\n"
    assert done(text, Edit("wrap", 1, last=2, form="try")) == wrapped
    assert done(text, Edit("wrap", 0, form="try")) == wrapped.replace("w  # last", "  w  # last")
    with pytest.raises(Unplaced, match="no form"):
        done(text, Edit("unwrap", 0))


def test_nothing_comes_into_itself() -> None:
    for node, to in ((1, 0), (0, 1), (1, 2)):
        with pytest.raises(Unplaced, match="into itself"):
            done("try:\n  u\n  v", Edit("move", node, to=to, place="inside" if to == 0 else "after"))


def done(text: str, edit: Edit) -> str:
    return Editor(Source(text), letters()).edited(edit).text


def test_edits_are_mostly_possible() -> None:
    """Else the tests above would show nothing."""
    text = "u then v\nw\nif p, x otherwise y\n(u and v) twice\n"
    wanted = [Edit(do, node, form="try", words="u") for do in ("delete", "insert", "wrap") for node in range(5)]
    assert sum(check(text, edit) for edit in wanted) >= len(wanted) - 3
