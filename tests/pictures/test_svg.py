"""Trees as SVG: valid, complete, the same each time, made without matplotlib, and what a run's tree says."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import btlang
from btlang.pictures import letters
from btlang.pictures.run_record import LastStatuses
from btlang.pictures.tree_layout import Maker, title_of
from btlang.pictures.tree_picture import draw_tree, picture_of
from btlang.text.source import Source, Span
from btlang.tree.node import Node, Tree
from tests.conftest import matches_golden
from tests.pictures.test_tree_layout import label, roots
from tests.trial import Trial

ROOT = Path(__file__).parent.parent.parent
SVG = "{http://www.w3.org/2000/svg}"
ROUNDS = 'for each place in the kitchen, the office: go to the place then say "Here is {place}"'


def titles(svg: ElementTree.Element) -> list[str]:
    """The text of each node that is drawn."""
    return [group.findtext(f"{SVG}title") or "" for group in svg.iter(f"{SVG}g")]


def said(mission: str, apart: bool = False, **options: float) -> list[str]:
    """The texts of the picture of a run's tree."""
    trial, statuses = Trial(mission), LastStatuses()
    trial.run(speed="max", sinks=[statuses], **options)
    assert trial.sink_errors == []
    sheets = Maker(trial.mission.tree, trial.mission.label, trial.mission.is_action, statuses).sheets(apart)
    return titles(ElementTree.fromstring(picture_of(sheets, "", ".svg", has_run=True)))


def extent(group: ElementTree.Element) -> tuple[float, float, float, float] | None:
    """Left, top, right and bottom of the outline of a node; None where it has none or is a frame."""
    rect, polygon = group.find(f"{SVG}rect"), group.find(f"{SVG}polygon")
    if rect is not None and rect.get("rx") != "6":
        x, y, width, height = (float(rect.attrib[key]) for key in ("x", "y", "width", "height"))
        return x, y, x + width, y + height
    if polygon is not None:
        points = [tuple(map(float, point.split(","))) for point in polygon.attrib["points"].split()]
        return (*map(min, zip(*points, strict=True)), *map(max, zip(*points, strict=True)))
    return None


def test_a_small_tree() -> None:
    mission = btlang.parse_tree(
        'greet is say "Good <morning> & hello" and wave\nUnless bumped, greet. Try to pick up the cup 3 times'
    )
    sheets = Maker(mission.tree, mission.label, mission.is_action).sheets()
    data = picture_of(sheets, "small & simple", ".svg")
    assert data == picture_of(sheets, "small & simple", ".svg")
    matches_golden(data.decode(), Path(__file__).parent / "samples" / "small.svg")


names = st.text(max_size=90) | st.sampled_from(["a\x00b\x1b[2J", "]]></title><script>", "\udcff \ufffe", "&amp;<g>"])


@given(roots, st.lists(names, min_size=1, max_size=6), st.booleans())
def test_each_node_of_a_random_tree_is_drawn_once(root: Node, texts: list[str], apart: bool) -> None:
    parts = tuple((name, Node("Do", name=text or "x")) for name, text in zip("abc", texts, strict=False))
    tree = Tree(root, parts)
    sheets = Maker(tree, label, lambda node: True).sheets(apart)
    svg = ElementTree.fromstring(picture_of(sheets, "random", ".svg"))
    assert sorted(titles(svg)) == sorted(box.text for sheet in sheets for box in sheet.boxes)
    outlines = []
    for group in svg.iter(f"{SVG}g"):
        outline = extent(group)
        if outline is None:
            continue
        outlines.append(outline)
        for text in group.iter(f"{SVG}text"):
            size, bold = float(text.get("font-size", "9")), text.get("font-weight") == "bold"
            x, end = float(text.attrib["x"]), float(text.attrib["x"]) + letters.width(text.text or "", size, bold)
            assert outline[0] < x <= end < outline[2]
    outlines.sort()
    for i, one in enumerate(outlines):
        for other in outlines[i + 1 :]:
            if other[0] >= one[2]:
                break
            assert other[1] >= one[3] or one[1] >= other[3], "boxes overlap"


def test_widths_are_those_of_the_font() -> None:
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    for bold, table in ((False, letters._NORMAL), (True, letters._BOLD)):
        font = FontProperties(family=letters.FAMILY, size=100, weight="bold" if bold else "normal")
        for first, advances in table.items():
            for character in map(chr, range(first, first + len(advances.split()))):
                if character.isprintable():
                    real, _, _ = text_to_path.get_text_width_height_descent(character, font, ismath=False)
                    assert letters.width(character, 100, bold) == pytest.approx(real, abs=0.51), character
    assert letters.width("é", 9) == letters.width("e\u0301", 9) == letters.width("e", 9)
    assert letters.width("\u4f60\u597d", 10) >= 20


def test_trees_are_drawn_where_matplotlib_cannot_be_imported(tmp_path: Path) -> None:
    (tmp_path / "visit.txt").write_text(f"{ROUNDS}\n", encoding="utf-8")
    blocked = "import sys; sys.modules |= dict.fromkeys(['matplotlib', 'PIL']); from btlang.cli import main; "
    for arguments in (
        ["tree", "visit.txt", "--picture", "a.svg"],
        ["run", "visit.txt", "--speed", "max", "--quiet", "--tree-picture", "b.svg"],
        ["compile", "visit.txt", "-o", "c.svg"],
    ):
        command = [sys.executable, "-c", f"{blocked}sys.exit(main({arguments!r}))"]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        subprocess.run(command, cwd=tmp_path, env=environment, check=True, timeout=60)
    a, b, c = (ElementTree.parse(tmp_path / name).getroot() for name in ("a.svg", "b.svg", "c.svg"))
    assert a.findtext(f"{SVG}title") == b.findtext(f"{SVG}title") == "visit.txt"
    assert "go to {place}" in titles(a)
    assert titles(c) == titles(a)
    assert "go to kitchen" in titles(b)
    assert all("Script" not in title for title in titles(b))


def test_the_tree_of_a_run_says_the_values_of_each_round() -> None:
    texts = said(ROUNDS)
    assert [text for text in texts if text not in ("Sequence", "each_place")] == [
        "go to kitchen",
        'say "Here is kitchen"',
        "go to office",
        'say "Here is office"',
    ]
    assert texts.count("Sequence") == 3, "one of the mission, one of each round, none around a prepared command"


def test_what_was_not_reached_says_its_arguments() -> None:
    texts = said(ROUNDS, time_limit=3)
    assert [text for text in texts if text.startswith("go")] == ["go to kitchen", "go to office"]


def test_a_definition_that_is_drawn_for_all_its_uses_says_no_value() -> None:
    texts = said("greet {someone} is say 'Hello {someone}' then wave; greet Alice then greet Bob", apart=True)
    assert {"greet Alice", "greet Bob", "say 'Hello {someone}'"} <= set(texts)
    assert all("Script" not in text for text in texts)


def test_values_of_the_latest_round_and_commands_of_the_mission() -> None:
    texts = said("set n to 0; repeat 3 times (increase n by 1 then say 'round {n}')")
    assert texts[-1] == 'say "round 3"'
    assert {"set n to 0", "increase n by 1"} <= set(texts), "these the mission asks for"


def test_a_script_of_the_tree_and_one_that_failed_are_shown() -> None:
    tree = '<BehaviorTree ID="T"><Sequence><Script code="a:=1"/><Wave/></Sequence></BehaviorTree>'
    assert said(f'<root BTCPP_format="4">{tree}</root>')[1] == 'Script code="a:=1"'
    assert "Script code=\"_1 := 'x is ' .. x\"" in said("if bumped, set x to 3\nsay 'x is {x}'")


@pytest.mark.parametrize(
    ("text", "name", "title"),
    [
        ("wave", "missions/tea.txt", "tea.txt"),
        ("# hi\nwave\nnod", "<command line>", "wave"),
        ('{"format": 1, "trees": [{"name": "", "nodes": [{"id": "Wave"}]}]}', "-", "mission"),
        ('<root BTCPP_format="4"><BehaviorTree ID="Tidy"><Wave/></BehaviorTree></root>', "<text>", "Tidy"),
        ("wave", "a\x1b\n.txt", "a\N{REPLACEMENT CHARACTER} .txt"),
    ],
)
def test_a_picture_has_a_title(text: str, name: str, title: str) -> None:
    assert title_of(btlang.parse_tree(Source(text, name)).tree) == title
    assert title_of(Tree(Node("Wave"), name="Given")) == "Given"
    assert title_of(Tree(Node("Wave", span=Span(Source("wave"), 0, 0)))) == "mission"


def test_titles_are_in_files(tmp_path: Path) -> None:
    mission = btlang.parse_tree("wave")
    for name in ("a.svg", "a.png"):
        draw_tree(mission.tree, mission.label, mission.is_action, str(tmp_path / name), title="A & B\x07")
    assert ElementTree.parse(tmp_path / "a.svg").getroot().findtext(f"{SVG}title") == "A & B\N{REPLACEMENT CHARACTER}"
    with Image.open(tmp_path / "a.png") as image:
        assert image.info["Title"] == "A & B\N{REPLACEMENT CHARACTER}"
