"""The XML of missions is taken by BehaviorTree.CPP 4.10, whose entries keep their types: a model of its rules.

When a tree is made, an entry gets the type of the constant that a SubTree has for it, else of the first port that names
it. A port of another type is refused, unless the entry is a text. When it runs, an entry that a script has made with a
whole number takes no fraction.
"""

from __future__ import annotations

import re

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import btlang
from btlang.api import parse_tree
from btlang.backends.btcpp import to_xml
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import SUCCESS
from btlang.run.events import Said
from btlang.tree.node import Node, Tree
from tests.engine.scripted import n
from tests.profiles import searches

PORTS = {
    "Repeat": {"num_cycles": "int"},
    "RetryUntilSuccessful": {"num_attempts": "int"},
    "Sleep": {"msec": "unsigned"},
    "Timeout": {"msec": "unsigned"},
    "Delay": {"delay_msec": "unsigned"},
}
_STATEMENT = re.compile(r"\s*(\w+)\s*(:=|=|\+=|-=|\*=|/=)\s*([^=].*?)\s*")


class Refused(Exception):
    """By BehaviorTree.CPP."""


class Entry:
    def __init__(self, type: str = "") -> None:
        self.type = type
        self.is_whole = False  # a script has made it with a whole number
        self.is_fraction = type == "double"
        self.sources: list[Entry] = []


class Board:
    def __init__(self, above: Board | None = None) -> None:
        self.entries: dict[str, Entry] = {}
        self.names: dict[str, str] = {}
        self.above = above

    def entry(self, key: str) -> Entry:
        if key in self.names and self.above is not None:
            return self.above.entry(self.names[key])
        return self.entries.setdefault(key, Entry())


class Library:
    """Makes a tree as the library does."""

    def __init__(self, tree: Tree) -> None:
        self.subtrees = dict(tree.subtrees)
        self.ports = {model.id: {port.name: port.type for port in model.ports} for model in tree.models} | PORTS
        self.entries: list[Entry] = []
        self.make(tree.root, Board())
        grown = True
        while grown:
            grown = False
            for entry in self.entries:
                if not entry.is_fraction and any(source.is_fraction for source in entry.sources):
                    entry.is_fraction = grown = True
        if any(entry.is_whole and entry.is_fraction for entry in self.entries):
            raise Refused("a whole number takes no fraction")

    def make(self, node: Node, board: Board) -> None:
        if node.id == "SubTree":
            inner = Board(board)
            for port, text in node.ports:
                if port != "ID":
                    if text[:1] == "{":
                        inner.names[port] = text[1:-1]
                    else:
                        inner.entries[port] = Entry(constant(text))
            self.make(self.subtrees[node.port("ID")], inner)
            return
        for port, text in node.ports:
            if port == "code":
                for statement in text.split(";"):
                    self.script(statement, board)
            elif text[:1] == "{" and (wanted := self.ports.get(node.id, {}).get(port, "")):
                entry = board.entry(text[1:-1])
                if entry.type not in ("", "std::string", wanted):
                    raise Refused(f"[{text}] was created with type [{entry.type}] and, later type [{wanted}]")
                entry.type = entry.type or wanted
                entry.is_fraction |= wanted == "double"
        for child in node.children:
            self.make(child, board)

    def script(self, statement: str, board: Board) -> None:
        found = _STATEMENT.fullmatch(statement)
        if found is None:
            return
        key, sign, value = found.groups()
        entry = board.entry(key)
        self.entries.append(entry)
        if "'" in value or ".." in value:
            return
        entry.is_whole |= sign in (":=", "=") and re.fullmatch(r"-?\d+", value) is not None
        entry.is_fraction |= "/" in sign + value or re.fullmatch(r"-?\d*\.\d+", value) is not None
        entry.sources += [board.entry(name) for name in re.findall(r"[a-z_]\w*", value)]


def constant(text: str) -> str:
    """The type of a constant of a SubTree."""
    if re.fullmatch(r"-?\d+", text):
        return "int" if -(2**31) <= int(text) < 2**31 else "int64_t"
    return "double" if re.fullmatch(r"-?\d+\.?\d*(e-?\d+)?", text) else ""


def taken(text: str) -> Tree:
    """The tree of the XML of a mission, which the library takes."""
    tree = parse_tree(str(parse_tree(text).to("xml"))).tree
    Library(tree)
    return tree


# The model itself


def test_the_model_refuses_what_the_library_refuses() -> None:
    inner = ("go", n("MoveForward", distance="{d}"))
    move = btlang.parse_tree(str(parse_tree("move forward 2 m").to("xml"))).tree.models
    with pytest.raises(Refused, match=r"created with type \[int\] and, later type \[double\]"):
        Library(Tree(n("SubTree", ID="go", d="2"), (inner,), models=move))
    Library(Tree(n("SubTree", ID="go", d="2.0"), (inner,), models=move))
    Library(Tree(n("SubTree", ID="go", d="two"), (inner,), models=move))
    with pytest.raises(Refused, match="fraction"):
        Library(Tree(n("Script", code="_1 := 0; _1 = 0.5")))
    Library(Tree(n("Script", code="_1 := 0.0; _1 = 0.5")))


# Missions

_BODIES = {
    "distance": ("move forward {p}", 'say "{p} metres"', "say {p}", "set gap to {p}", "if {p} is above 1 m, wave"),
    "duration": ("wait {p}", 'say "{p} seconds"', "say {p}", "wave within {p}", "wave for {p}"),
    "count": ("nod {p} times", 'say "{p} times"', "increase total by {p}", "retry wave {p} times", "say {p}"),
    "number": ("increase total by {p}", 'say "{p} more"', "set total to {p}", "if {p} is above 2, wave", "say {p}"),
    "text": ('say "hello {p}"', "say {p}", 'if {p} is "3", wave', 'say "{p}{p}"'),
    "place": ("go to {p}", 'say "to {p}"', "say {p}"),
}
_GIVEN = {
    "distance": ("2 m", "0.5 m", "50 cm", "{gap}"),
    "duration": ("2 s", "0.5 s", "a minute", "{pause}"),
    "count": ("2", "3", "{rounds}"),
    "number": ("2", "2.5", "0", "{total}", "{rounds}"),
    "text": ('"Alice"', '"3"', '"2.5"', '"007"', "{mood}"),
    "place": ("the lab", "the lobby", "{goal}"),
}
_SET = (
    "set gap to 2 m", "set gap to 0.5 m", "set pause to 1 s", "set pause to 0.1 s", "set rounds to 2",
    "set total to 1", "set total to 1.5", "increase total by 0.5", "increase total", "decrease total by {rounds}",
    'set mood to "fine"', 'set mood to "3"', "set goal to the lab", "remember the distance ahead as gap", "say {total}",
    'say "{total}, {mood}"', "say {gap}", "say {rounds}", "nod {rounds} times", "move forward {gap}", "wait {pause}",
    "for each k in 1, 2: say {k}", "for each k in 1, 2.5: increase total by {k}",
    "for each k in 2 m, 0.5 m: move forward {k}",
)  # fmt: skip
_BEFORE = 'set gap to 1 m; set pause to 1 s; set rounds to 1; set total to 0; set mood to "well"; set goal to the lobby'


@st.composite
def missions(draw: st.DrawFn) -> str:
    """Definitions with a parameter, some of which hand it on, and uses of them among values that are set."""
    lines: list[str] = []
    uses: list[str] = []
    for at, kind in enumerate(draw(st.lists(st.sampled_from(sorted(_BODIES)), min_size=1, max_size=3))):
        name = ("alpha", "beta", "gamma")[at]
        body = " then ".join(draw(st.lists(st.sampled_from(_BODIES[kind]), min_size=1, max_size=3)))
        lines.append(f"{name} {{p}} means {body}")
        if draw(st.booleans()):
            lines.append(f"outer {name} {{q}} means {name} {{q}} then say {{q}}")
            name = f"outer {name}"
        uses += [f"{name} {value}" for value in draw(st.lists(st.sampled_from(_GIVEN[kind]), min_size=1, max_size=3))]
    rest = draw(st.permutations([*uses, *draw(st.lists(st.sampled_from(_SET), max_size=5))]))
    return "\n".join([*lines, _BEFORE, *rest])


@searches(20, 4000, deadline=None)
@given(missions())
def test_random_missions_are_taken(text: str) -> None:
    try:
        parse_tree(text)
    except MissionError:
        assume(False)
    taken(text)


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("go {far} means move forward {far}\ngo 2 m", ['<SubTree ID="go_far" far="2.0"/>']),
        ("set gap to 2 m\nmove forward {gap}", ['<Script code="gap := 2.0"/>']),
        ("set x to 1\nincrease x by 0.5\nsay {x}", ['<Script code="x := 1.0"/>', '<Script code="x += 0.5"/>']),
        ("set x to 1\nincrease x by 2\nsay {x}", ['<Script code="x := 1"/>', '<Script code="x += 2"/>']),
        ("set x to 1\nset y to 0.5\nincrease x by {y}\nsay {x}", ['<Script code="x := 1.0"/>']),
        ("nod {n} often means nod {n} times\nnod 2 often", ['n="2"/>']),
        ("tell {what} means say {what}\ntell 7", ["""<Script code="_1 := '7'"/>""", 'what="{_1}"/>']),
        (
            "go {far} means move forward {far} then say {far}\ngo 2 m",
            ['<MoveForward distance="{far}"/>', "<Script code=\"_1 := '' .. far\"/>", '<Say text="{_1}"/>'],
        ),
    ],
)
def test_what_is_written(text: str, lines: list[str]) -> None:
    written = str(parse_tree(text).to("xml"))
    for line in lines:
        assert line in written
    taken(text)


def test_what_is_written_runs_as_the_mission_does() -> None:
    text = 'set x to 1\nincrease x by 0.5\ntell {what} means say {what}\ntell 7\ntell 2.5\nsay "{x}"'

    def said(source: str) -> list[str]:
        words: list[str] = []
        tree = parse_tree(source)
        hear = lambda event: words.append(event.text) if isinstance(event, Said) else None  # noqa: E731
        assert tree.run(speed="max", sinks=[hear]).status == SUCCESS
        return words

    assert said(text) == said(str(parse_tree(text).to("xml"))) == ["7", "2.5", "1.5"]


def test_a_tree_that_is_written_once_is_written_so_again() -> None:
    tree = parse_tree("go {far} means move forward {far} then say {far}\ngo 2 m")
    once = to_xml(tree.tree, tree.vocabulary)
    again = parse_tree(once)
    assert to_xml(again.tree.replace(origin=None), again.vocabulary) == once
