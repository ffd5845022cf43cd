"""Boxes of a tree: nothing overlaps, text fits, order is kept, size is bounded."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from btlang.pictures.letters import clip_text, make_printable, width, wrap_text
from btlang.pictures.tree_layout import DEEPEST, IN_PLACE, MOST, Maker, Sheet, TreeLayout, lay_out, side
from btlang.tree.node import Node, Tree

WORDS = ("go to the kitchen", "wave", 'say "Good morning, dear visitors of our museum, follow me please!"', "w" * 60)


def label(node: Node) -> str:
    return node.name or node.id


def sheets(tree: Tree, apart: bool = False) -> list[Sheet]:
    return Maker(tree, label, lambda node: True).sheets(apart)


def overlapping(layout: TreeLayout) -> list[tuple[str, str]]:
    """Pairs of boxes that overlap, where neither is a frame around the other."""
    found = []
    spots = sorted(layout.spots, key=lambda spot: spot.y)
    for i, a in enumerate(spots):
        for b in spots[i + 1 :]:
            if b.y >= a.y + a.height:
                break
            if a.x < b.x + b.width and b.x < a.x + a.width:
                frames = [spot for spot in (a, b) if spot.box.shape == "frame"]
                held = any(
                    f.x < o.x and f.y < o.y and o.x + o.width < f.x + f.width and o.y + o.height < f.y + f.height
                    for f in frames
                    for o in (a, b)
                )
                if not held:
                    found.append((a.box.text, b.box.text))
    return found


def check(layout: TreeLayout) -> None:
    assert overlapping(layout) == []
    for spot in layout.spots:
        assert spot.x >= 0
        assert spot.y >= 0
        assert spot.x + spot.width <= layout.width + 1e-6
        assert spot.y + spot.height <= layout.height + 1e-6
        bold = spot.box.shape in ("control", "decorator", "frame", "subtree")
        assert all(width(line, 9.0, bold) + 2 * side(spot.box) <= spot.width + 1e-6 for line in spot.lines)


def large(leaves: int) -> Tree:
    parts = []
    for i in range(leaves // 3):
        words = tuple(Node("Do", name=WORDS[(i + j) % 4]) for j in range(3))
        inner = Node("Sequence", words) if i % 2 else Node("IfThenElse", words)
        parts.append(Node("Repeat", (inner,), (("num_cycles", "3"),)) if i % 3 == 0 else inner)
    return Tree(Node("Sequence", tuple(parts)))


def test_a_tree_of_500_nodes_fits() -> None:
    tree = large(345)
    assert 490 <= sum(1 for _ in tree.walk()) <= 580
    [sheet] = sheets(tree)
    layout = lay_out(sheet.boxes)
    check(layout)
    assert 0.4 < layout.width / layout.height < 2.5, "columns keep it from becoming a ribbon"


leaf = st.sampled_from(WORDS).map(lambda words: Node("Do", name=words)) | st.sampled_from("abc").map(
    lambda name: Node("SubTree", ports=(("ID", name),))
)
ids = st.sampled_from(["Sequence", "IfThenElse", "Parallel"])
roots = st.recursive(
    leaf,
    lambda inner: (
        st.builds(lambda id, parts: Node(id, tuple(parts)), ids, st.lists(inner, min_size=1, max_size=5))
        | inner.map(lambda node: Node("Inverter", (node,)))
    ),
    max_leaves=60,
)
plain = leaf.filter(lambda node: node.id == "Do") | st.just(Node("Sequence", (Node("Do", name="nod"),) * 3))


@given(roots, plain, st.booleans(), st.booleans())
def test_random_trees(root: Node, part: Node, apart: bool, signs: bool) -> None:
    tree = Tree(root, (("a", part), ("b", Node("Inverter", (part,))), ("c", Node("Do", name="wave"))))
    drawn = sheets(tree, apart)
    for sheet in drawn:
        check(lay_out(sheet.boxes, signs))
    assert [sheet.name for sheet in drawn] == (["", "a", "b", "c"] if apart else [""])


def test_children_stand_in_order() -> None:
    [sheet] = sheets(Tree(Node("Sequence", tuple(Node("Do", name=str(i)) for i in range(9)))))
    spots = lay_out(sheet.boxes).spots[1:]
    assert [spot.box.text for spot in sorted(spots, key=lambda spot: spot.y)] == [str(i) for i in range(9)]
    assert {spot.x for spot in spots} == {spots[0].x}


def test_a_large_tree_is_drawn_apart() -> None:
    job = Node("Sequence", (Node("Do", name="wave"),) * 9)
    call = Node("SubTree", ports=(("ID", "job"),))
    few, many = (Tree(Node("Sequence", (call,) * n), (("job", job),)) for n in (40, 60))
    assert [sheet.name for sheet in sheets(few)] == [""]
    assert len(sheets(few)[0].boxes) == 1 + 40 * 11 <= IN_PLACE
    assert [(sheet.name, len(sheet.boxes)) for sheet in sheets(many)] == [("", 61), ("job", 10)]


def test_what_is_too_deep_or_too_large_is_counted() -> None:
    deep = Node("Do", name="wave")
    for _ in range(10_000):
        deep = Node("Inverter", (deep,))
    [sheet] = sheets(Tree(deep))
    assert len(sheet.boxes) == DEEPEST + 2
    assert sheet.boxes[-1].text == f"… and {10_001 - DEEPEST - 1} more"
    check(lay_out(sheet.boxes))
    [sheet] = sheets(Tree(Node("Sequence", (Node("Do", name="wave"),) * 5000)))
    assert len(sheet.boxes) == MOST + 1
    assert sheet.boxes[-1].text == "… and 3001 more"


@given(st.text(max_size=80), st.floats(30, 200))
def test_wrapped_text_fits(text: str, room: float) -> None:
    lines = wrap_text(text, room, 3, 9.0, False)
    assert 1 <= len(lines) <= 3
    assert all(width(line, 9.0, False) <= room for line in lines)


def test_long_text_ends_in_an_ellipsis() -> None:
    assert wrap_text("one two three four", 60, 2, 9.0, False) == ["one two", "three four"]
    assert wrap_text("one two three four", 40, 2, 9.0, False) == ["one two", "three f…"]
    assert clip_text("kitchen", 30, 9.0) == "kitc…"


def test_text_that_cannot_be_printed() -> None:
    assert make_printable("a\tb\n c") == "a b c"
    assert make_printable("\u4f60 \udcff\x07 $x$") == "\u4f60 �� $x$"
    assert width("wide", 9.0) > width("i", 9.0) > 0
