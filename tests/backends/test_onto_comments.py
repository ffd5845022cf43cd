"""Comments of a file whose English is edited: each is there once, as the mission has it, around the mission's tree.

Instructions for other programs, which English doesn't say, are all there, too.
"""

from __future__ import annotations

import re
from itertools import count

from hypothesis import example, given
from hypothesis import strategies as st

from btlang.backends.btcpp.onto import write_onto
from btlang.backends.english import to_english
from btlang.backends.english.comments import lines_of
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.btcpp.reader import read_xml
from btlang.text.source import Source
from btlang.tree.dump import plain
from tests.backends.test_onto import WORDS, mission_of
from tests.profiles import searches

LEAVES = ("Foo", "Bar", "Baz", "Qux")
Shape = tuple[str, tuple["Shape", ...], tuple[int, int, int, int], bool]
"""A node: its id, its children, how many lines its comments have (before it, behind its tag, inside it and behind it),
and whether it begins on a line of its own.
"""


def comments_in(xml: str) -> list[str]:
    """All comments of a file, as English has them."""
    return sorted(lines_of(re.findall(r"<!--.*?-->", xml, re.DOTALL)))


def instructions_in(xml: str) -> list[str]:
    return sorted(re.findall(r"<\?keep.*?\?>", xml))


def comments_of(text: str) -> list[str]:
    """All comments of a mission."""
    return sorted(line.strip()[2:] for line in text.splitlines() if line.strip().startswith("# "))


def written(shapes: list[Shape], line_end: str) -> str:
    """A file with a tree for each of these nodes."""
    numbers = count(1)

    def comment(lines: int, margin: str) -> str:
        texts = [f"note {next(numbers)}" for _ in range(lines)]
        return f"<!-- {f'{line_end}{margin}  '.join(texts)} --><?keep {next(numbers)}?>" if texts else ""

    def element(shape: Shape, depth: int) -> str:
        name, children, (before, heading, inside, behind), on_line = shape
        margin = line_end + "  " * depth if on_line else ""
        text = f"{margin}{comment(before, margin.strip(line_end))}" if before else ""
        if not children:
            return f"{text}{margin}<{name}/>{comment(behind, '')}"
        inner = "".join(element(child, depth + 1) for child in children)
        end = line_end + "  " * depth
        last = f"{end}  {comment(inside, '  ' * depth)}" if inside else ""
        return f"{text}{margin}<{name}>{comment(heading, '')}{inner}{last}{end}</{name}>{comment(behind, '')}"

    trees = (f'{line_end}  <BehaviorTree ID="T{number}">{element(shape, 2)}{line_end}  </BehaviorTree>'
             for number, shape in enumerate(shapes))  # fmt: skip
    return f'<root BTCPP_format="4" main_tree_to_execute="T0">{"".join(trees)}{line_end}</root>{line_end}'


NUMBERS = st.tuples(*[st.sampled_from([0, 0, 1, 2])] * 4)
ON_LINE = st.sampled_from([True, True, False])
SHAPES = st.recursive(
    st.tuples(st.sampled_from(LEAVES), st.just(()), NUMBERS, ON_LINE),
    lambda inner: st.tuples(
        st.sampled_from(["Sequence", "Fallback", "MyControl"]),
        st.lists(inner, min_size=1, max_size=4).map(tuple), NUMBERS, ON_LINE,
    ),
    max_leaves=8,
)  # fmt: skip


def edited(text: str, edits: list[tuple[str, int, int]]) -> str:
    """A mission in which lines that are commands are taken away, changed, added and exchanged."""
    lines = text.split("\n")
    for kind, one, other in edits:
        places = [at for at, line in enumerate(lines) if line.strip().startswith("do ") and line[-1:] != ":"]
        if not places:
            break
        first, second = places[one % len(places)], places[other % len(places)]
        margin = lines[first][: len(lines[first]) - len(lines[first].lstrip())]
        if kind == "remove":
            del lines[first]
        elif kind == "change":
            lines[first] = f"{margin}do something new"
        elif kind == "add":
            lines.insert(first, f"{margin}do something new")
        elif kind == "comment":
            lines.insert(first, f"{margin}# a new note {one}")
        else:
            words = lines[first].strip(), lines[second].strip()
            lines[first] = lines[first].replace(words[0], words[1])
            if first != second:
                lines[second] = lines[second].replace(words[1], words[0])
    return "\n".join(lines)


KINDS = st.sampled_from(["remove", "change", "add", "comment", "exchange"])
EDITS = st.lists(st.tuples(KINDS, st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=3)
NOTHING, NOTE = (0, 0, 0, 0), (1, 0, 0, 0)
PAIR: Shape = ("Sequence", (("Foo", (), NOTE, True), ("Bar", (), NOTHING, True)), NOTHING, True)
ROW: Shape = ("MyControl", (("Baz", (), NOTHING, True), ("Bar", (), NOTE, True)), NOTHING, True)
NOTED: Shape = ("Foo", (), (2, 0, 0, 1), True)
TIGHT: Shape = ("Sequence", (NOTED, ("Bar", (), NOTHING, False), ("Baz", (), NOTHING, True)), (0, 1, 0, 0), True)


@searches(60, 20_000, deadline=None)
@given(st.lists(SHAPES, min_size=1, max_size=3), st.sampled_from(["\n", "\r\n"]), EDITS)
@example([PAIR], "\n", [("remove", 1, 0)])
@example([("Foo", (), NOTHING, True), ROW], "\n", [("exchange", 0, 2)])
@example([("Foo", (), NOTE, True)], "\n", [("change", 0, 0)])
@example([("Foo", (), NOTE, True)], "\n", [("add", 0, 0)])
@example([("Foo", (), (0, 0, 0, 0), False)], "\r\n", [("comment", 0, 0)])
@example([TIGHT], "\r\n", [("remove", 0, 0)])
def test_they_are_those_of_the_mission(shapes: list[Shape], line_end: str, edits: list[tuple[str, int, int]]) -> None:
    original = Source(written(shapes, line_end), "tree.xml")
    text = edited(to_english(read_xml(original), WORDS), edits)
    try:
        tree = mission_of(text)
    except MissionError:  # a block is empty now
        return
    made = write_onto(original, tree, WORDS)
    told = f"{original.text}\n{text}\n{made}"
    assert plain(read_xml(Source(made))) == plain(tree), told
    assert comments_in(made) == comments_of(text), told
    assert instructions_in(made) == instructions_in(original.text), told
    assert write_onto(Source(made), tree, WORDS) == made, told
    assert not re.search(r"(?<!\r)\n|\r(?!\n)" if line_end == "\r\n" else "\r", made), told
