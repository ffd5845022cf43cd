"""A session without a terminal: entries, definitions, undo, what is saved."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import FAILURE, SUCCESS
from btlang.repl.session import Session
from btlang.text.source import Source
from btlang.tree.dump import plain

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.txt"))


def entered(*texts: str) -> Session:
    session = Session()
    for text in texts:
        session.add(session.compile(text).entry)
    return session


def test_definitions_serve_later_entries() -> None:
    session = entered("patrol is go to the lab then go to the lobby", "patrol twice")
    assert session.definitions == {"patrol": "patrol is go to the lab then go to the lobby"}
    assert session.text == "patrol is go to the lab then go to the lobby\npatrol twice\n"
    assert [entry.has_command for entry in session.entries] == [False, True]
    assert plain(session.compile_all().tree).startswith("Repeat num_cycles=2\n  SubTree ID=patrol")


def test_an_entry_shows_only_the_subtrees_it_uses() -> None:
    session = entered("a cheer is wave", "party is cheer then nod", "bow is nod")
    assert [name for name, _ in session.compile("party").tree.tree.subtrees] == ["cheer", "party"]
    assert [name for name, _ in session.compile("fest is bow").tree.tree.subtrees] == ["bow", "fest"]


def test_a_condition_can_be_named() -> None:
    session = entered("company is someone is near")
    assert session.compile("wave if company").tree.tree.root.id == "IfThenElse"


def test_a_definition_replaces_an_older_one() -> None:
    session = entered("greet is wave", "greet", "greet is nod", "greet")
    assert session.text == "greet\ngreet is nod\ngreet\n"
    assert not session.compile("greet is say hello").tree.warnings


def test_places_in_messages_are_those_of_the_entry() -> None:
    session = entered("patrol is wave")
    with pytest.raises(MissionError) as caught:
        session.compile("patrol then go to the ktichen")
    assert caught.value.diagnostics[0].span.place == "<entry>:1:23"


def test_undo_and_redo() -> None:
    session = entered("wave", "nod")
    assert session.undo()
    assert session.text == "wave\n"
    assert session.redo()
    assert session.text == "wave\nnod\n"
    assert session.undo()
    session.add(session.compile("dock").entry)
    assert not session.redo()
    assert [session.undo() for _ in range(3)] == [True, True, False]
    assert session.text == ""


def test_the_world_goes_on() -> None:
    session = Session()
    for text in ("go to the lab", "go to the lobby"):
        assert session.compile(text).tree.run(speed="max").status == SUCCESS
    assert session.simulation.robot.pose.distance_to((3.0, 1.5)) < 0.05
    assert session.simulation.robot.battery < 100
    session.reset()
    assert session.simulation.robot.battery == 100


def option(text: str, name: str) -> str | None:
    """The file that the command at the top of an example gives an option."""
    return next((str(ROOT / line.split(name)[1].split()[0]) for line in text.splitlines() if name in line), None)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_mission_falls_into_its_statements(path: Path) -> None:
    text = path.read_text()
    world = option(text, "--world ")
    keywords = [file for file in [option(text, "--keywords ")] if file]
    session = Session(keywords, world)
    entries = session.entries_of(text, str(path))
    session.file = str(path)
    assert "\n".join(entry.text for entry in entries).split() == text.split()
    session.change(entries)
    for entry in entries:  # alone, with the definitions and values of the others
        assert session.compile(entry.text).entry == entry
    tree = btlang.parse_tree(Source(text, str(path)), keywords=keywords, world=world).tree
    assert plain(session.compile_all().tree) == plain(tree)


def test_statements_of_a_mission() -> None:
    text = (
        "# About.\n\nPlease wave. Nod!  # both\nrepeat:\n  wave\n  if stuck, nod\notherwise nod\n\n"
        "# Names.\nbow is wave; fest is nod\nbow\n"
    )
    entries = Session().entries_of(text)
    assert [entry.text for entry in entries] == [
        "# About.\n\nPlease wave. Nod!  # both",
        "repeat:\n  wave\n  if stuck, nod\notherwise nod",
        "# Names.\nbow is wave; fest is nod",
        "bow",
    ]
    assert [tuple(name for name, _ in entry.definitions) for entry in entries] == [(), (), ("bow", "fest"), ()]


def test_values_go_on_from_entry_to_entry() -> None:
    session = Session()
    said = []
    for text in ("set counter to 3", "increase counter by 2", 'say "{counter} rounds"', "say {counter}"):
        compiled = session.compile(text)
        session.add(compiled.entry)
        outcome = compiled.tree.run(
            speed="max", sinks=[lambda event: said.append(getattr(event, "data", {}).get("text", ""))]
        )
        assert outcome.status == SUCCESS
    assert [text for text in said if text and text[0].isdigit()] == ["5 rounds", "5"]
    with pytest.raises(MissionError, match="BT048"):
        session.compile("set counter to the lab")
    session.reset()
    assert session.compile("say {counter}").tree.run(speed="max").status == FAILURE


def test_values_of_another_mission_are_forgotten() -> None:
    session = Session()
    first = session.compile("set counter to 3")
    session.add(first.entry)
    first.tree.run(speed="max")
    session.change(())
    second = session.compile('set counter to "three"')
    assert second.tree.run(speed="max").status == SUCCESS
