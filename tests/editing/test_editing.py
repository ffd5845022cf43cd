"""What editors ask of a text: any text has an answer, and all places lie within it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.document import document, text_messages
from btlang.editing.help import complete, hover
from btlang.editing.palette import palette
from btlang.editing.words import RobotWords
from btlang.printer.mission import english as printed
from btlang.text.source import Source
from tests.language.letters import ENTRIES, letters
from tests.language.sentences import broken_missions, english, missions
from tests.printer import trees
from tests.profiles import amount, searches

LETTERS: Any = RobotWords(ENTRIES)  # type: ignore[arg-type]
SHIPPED = RobotWords()
TEA = """# for the afternoon
include "tea.txt"
patrol is go to the lobby, then wave
greet {someone} means wave at {someone}
lab door is at (1, 2)
whenever the battery is low, dock
if the path is clear, patrol, otherwise nod
set counter to 3
repeat 3 times:
  nod
  wave at Alice and Bob
"""
TREE = """<root BTCPP_format="4">
  <BehaviorTree ID="Main"><Sequence><GoTo place="lab"/><SubTree ID="Other"/></Sequence></BehaviorTree>
  <BehaviorTree ID="Other"><Wave/></BehaviorTree>
</root>"""
BARN = """start = { x = 0, y = 0 }
places = [{ name = "barn", x = 1, y = 2 }]
people = [{ name = "Ruth", x = 2, y = 2 }]
"""
_texts = st.one_of(
    st.text(),
    st.one_of(missions, broken_missions()).map(english),
    st.lists(st.sampled_from([*re.findall(r"\w+|\W", TEA), "\0", "\ud800", "🤖", '"', "(", "#"])).map("".join),
    st.lists(st.sampled_from(re.findall(r"\w+|\W", TREE))).map("".join),
)


def places(data: object) -> list[tuple[int, int]]:
    """All that are in an answer."""
    if isinstance(data, dict):
        here = [(data["start"], data["end"])] if data.get("start") is not None and "end" in data else []
        return [*here, *([data["of"]] if "of" in data else []), *(p for part in data.values() for p in places(part))]
    return [place for part in data for place in places(part)] if isinstance(data, list | tuple) else []


@searches(40, 800, deadline=None)
@given(_texts, st.data())
def test_any_text_has_an_answer_within_it(text: str, data: st.DataObject) -> None:
    shown = document(Source(text, roots=()), LETTERS)
    assert shown["ok"] or shown["messages"]
    assert shown["ok"] == ("nodes" in shown)
    at = data.draw(st.integers(0, len(text)))
    found = [hover(Source(text, roots=()), at, LETTERS), complete(Source(text, roots=()), LETTERS, at)]
    assert all(0 <= start <= end <= len(text) for start, end in places([shown, found]))
    palette(Source(text, roots=()), LETTERS)


@searches(15, 400, deadline=None)
@given(trees.missions())
def test_nodes_are_those_of_the_tree(mission: Any) -> None:
    source = Source(printed(mission, letters()))
    nodes = document(source, LETTERS)["nodes"]
    read = LETTERS.mission(source)
    walked = list(read.tree.walk())
    assert [(each["id"], each["ports"], each["name"]) for each in nodes] == [(n.id, n.ports, n.name) for n in walked]
    assert [each["label"] for each in nodes] == [read.words(node) for node in walked]
    children: list[list[str]] = [[] for _ in nodes]
    for each in nodes:
        if each["parent"] >= 0:
            children[each["parent"]].append(each["id"])
    assert children == [[child.id for child in node.children] for node in walked]


@searches(20, 400)
@given(st.data())
def test_messages_before_a_document_change_nothing_but_its_time(data: st.DataObject) -> None:
    texts = ("wave\n", "wavee\n", "<a/>", TEA)
    alone = {text: document(Source(text, roots=()), SHIPPED) for text in texts}
    for text, first in data.draw(st.lists(st.tuples(st.sampled_from(texts), st.booleans()), max_size=6)):
        source = Source(text, roots=())
        if first:
            assert text_messages(source, SHIPPED) == {key: alone[text][key] for key in ("ok", "sort", "messages")}
        else:
            assert document(source, SHIPPED) == alone[text]


def test_a_document_is_read_anew_once_it_was_told(tmp_path: Path) -> None:
    included = tmp_path / "tea.txt"
    source = Source('include "tea.txt"\npour tea\n', str(tmp_path / "x.txt"))
    included.write_text("pour tea is nod\n")
    assert text_messages(source, SHIPPED)["ok"]
    assert "nod" in [each["label"] for each in document(source, SHIPPED)["nodes"]]
    included.write_text("pour tea is wave\n")
    assert "wave" in [each["label"] for each in document(source, SHIPPED)["nodes"]]


def test_a_document_has_its_tree_and_outline(tmp_path: Path) -> None:
    (tmp_path / "tea.txt").write_text("pour tea is say tea\n")
    text = TEA + "pour tea\n"
    shown = document(Source(text, str(tmp_path / "x.txt")), SHIPPED)
    assert (shown["ok"], shown["sort"]) == (True, "english")
    assert [(each["name"], each["kind"]) for each in shown["outline"]] == [
        ("tea.txt", "include"),
        ("patrol", "definition"),
        ("greet {someone}", "definition"),
        ("lab door", "fact"),
        ("whenever the battery is low, dock", "rule"),
        ("if the path is clear, patrol, otherwise nod", "command"),
        ("set counter to 3", "command"),
        ("repeat 3 times:", "command"),
        ("pour tea", "command"),
    ]
    patrol = shown["outline"][1]
    assert text[patrol["start"] : patrol["end"]] == "patrol"
    assert text[slice(*patrol["of"])] == "patrol is go to the lobby, then wave"
    nodes = shown["nodes"]
    going = next(each for each in nodes if each["id"] == "GoTo")
    assert (going["tree"], text[going["start"] : going["end"]], going["label"]) == (
        "patrol", "go to the lobby", "go to lobby",
    )  # fmt: skip
    elsewhere = next(each for each in nodes if each["tree"] == "pour tea")
    assert (elsewhere["start"], elsewhere["end"]) == (None, None)


def test_what_can_be_changed_of_a_node() -> None:
    shown = document(Source("if the battery is low, go to the lab\nrepeat wave twice\nwave"), RobotWords())
    found = {node["label"]: shown["kinds"][node["kind"]] for node in shown["nodes"]}
    assert found["battery is low"]["sort"] == "condition"
    assert found["go to lab"]["values"] == [("place", "place", "lab")]
    assert found["repeat … twice"]["values"] == [("rounds", "count", "2")]
    assert {"unwrap", "delete", "inside"} <= set(found["repeat … twice"]["edits"])
    assert not {"delete", "move", "wrap"} & set(found["then"]["edits"])
    assert len(shown["kinds"]) < len(shown["nodes"])


def test_a_document_of_xml_has_its_places_and_what_is_wrong_with_it() -> None:
    shown = document(Source(TREE.replace("<Wave/>", "<Wavee/>")), SHIPPED)
    assert (shown["ok"], shown["sort"]) == (True, "xml")
    going = shown["nodes"][1]
    assert TREE[going["start"] : going["end"]] == '<GoTo place="lab"/>'
    assert [each["name"] for each in shown["outline"]] == ["Other"]
    [message] = shown["messages"]
    assert (message["severity"], message["words"]) == ("error", "<Wavee/>")


def test_messages_have_offsets_everywhere() -> None:
    text = 'go to the lab then say "🤖" then move forwarrd 1 m'
    [message] = document(Source(text), SHIPPED)["messages"]
    assert text[message["start"] : message["end"]] == message["words"] == "move forwarrd 1 m"
    assert text[message["fix"]["start"] : message["fix"]["end"]] == "move forwarrd"
    warned = document(Source("when bumped, wave"), SHIPPED)["messages"]
    assert warned[0]["readings"]
    assert all("start" in each for each in (*warned[0]["readings"], *warned[0]["notes"]))


@pytest.mark.parametrize(
    ("words", "understood", "id", "kind"),
    [
        ("patrol is", "patrol: go to lobby then wave", "patrol", "name"),
        ("go to the lobby", "go to lobby", "GoTo", "command"),
        ("lobby", "go to lobby", "GoTo", "command"),
        ("then", "go to lobby then wave", "then", "word"),
        ("battery", "battery is low", "BatteryLow", "condition"),
        ("whenever", "whenever battery is low, dock", "whenever", "word"),
        ("patrol, otherwise", "patrol", "patrol", "name"),
        ("otherwise", "if path is clear, patrol otherwise nod", "otherwise", "word"),
        ("set", "set counter to 3", "set", "word"),
        ("3 times", "(nod then (wave at Alice then wave at Bob)) 3 times", "count", "word"),
        ("Bob", "wave at Alice then wave at Bob", "Wave", "command"),
    ],
)
def test_hovering_shows_what_was_understood(words: str, understood: str, id: str, kind: str) -> None:
    text = TEA.replace('include "tea.txt"\n', "")
    for source in (Source(text), Source(text + "frob")):  # also where another line is wrong
        found = hover(source, text.index(words), SHIPPED)["found"]
        assert (found["id"], found["kind"]) == (id, kind)
        assert found["start"] <= text.index(words) < found["end"]
        assert found["help"]
        if not source.text.endswith("frob"):
            assert found["words"] == understood


def test_hovering_over_a_tree() -> None:
    found = hover(Source(TREE), TREE.index("GoTo"), SHIPPED)["found"]
    assert (found["words"], found["kind"], found["help"][:6]) == ("go to lab", "node", "Drives")
    assert hover(Source(TREE), 0, SHIPPED)["found"] is None


def test_completions_end_at_their_place() -> None:
    text = "go to the kit\nwave"
    found = complete(Source(text), SHIPPED, text.index("\n"))["completions"]
    assert [(each["text"], each["start"]) for each in found] == [("kitchen", 10), ("kitchen door", 10)]
    assert complete(Source(TREE), SHIPPED) == {"completions": []}


def test_a_block_can_be_begun() -> None:
    """Phrases may stand there whose roles have no help."""
    found = complete(Source("wave\nin parallel:\n    "), RobotWords())["completions"]
    assert "nod" in [each["text"] for each in found]


@pytest.mark.long
@pytest.mark.parametrize("world", [None, BARN])
def test_all_of_the_palette_can_be_put_in(world: str | None) -> None:
    words = RobotWords(world_text=world or "")
    text = 'look is look around\ngreet {someone} means wave at {someone}\n"quick" is nod\nlook\n'
    topics = palette(Source(text), words)["topics"]
    own, *others = topics
    assert [each["insert"] for each in own["items"]][:1] == ["look"]
    assert own["items"][2]["insert"] == 'do "quick"'
    assert {"motion", "power", "repeating"} <= {each["topic"] for each in others}
    for topic in topics:
        for item in topic["items"][:: amount(3 if world is None else 9, 1)]:
            before = text + ("check " if item["sort"] == "condition" else "")
            words.mission(Source(before + item["insert"]))
    going = next(item for topic in others for item in topic["items"] if item["words"].startswith("go to {place}"))
    assert (going["insert"], going["sort"]) == ("go to barn" if world else "go to the kitchen", "action")


def test_words_that_cannot_be_used_are_told() -> None:
    words = RobotWords(("nowhere.toml",))
    assert [each["code"] for each in document(Source("wave"), words)["messages"]] == ["BT001"]
    with pytest.raises(MissionError, match="BT001"):
        palette(Source("wave"), words)
