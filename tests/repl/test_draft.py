"""A draft without a terminal: entries, definitions, undo, what is saved."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import btlang
from btlang import Outcome
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import FAILURE, SUCCESS
from btlang.repl.draft import Compiled, MissionDraft
from btlang.run.events import Event
from btlang.text.source import Source
from btlang.tree.dump import plain
from tests.examples.cases import world_of

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.txt"))


def ran(draft: MissionDraft, compiled: Compiled, *sinks: Callable[[Event], object]) -> Outcome:
    """As the prompt runs an entry."""
    return draft.session.prepare(compiled.mission, speed="max", sinks=sinks, values=draft.values()).execute()


def entered(*texts: str) -> MissionDraft:
    draft = MissionDraft()
    for text in texts:
        draft.add(draft.compile(text).entry)
    return draft


def test_definitions_serve_later_entries() -> None:
    draft = entered("patrol is go to the lab then go to the lobby", "patrol twice")
    assert draft.definitions == {"patrol": "patrol is go to the lab then go to the lobby"}
    assert draft.text == "patrol is go to the lab then go to the lobby\npatrol twice\n"
    assert [entry.has_command for entry in draft.entries] == [False, True]
    assert plain(draft.compile_all().tree).startswith("Repeat num_cycles=2\n  SubTree ID=patrol")


def test_an_entry_shows_only_the_subtrees_it_uses() -> None:
    draft = entered("a cheer is wave", "party is cheer then nod", "bow is nod")
    assert [name for name, _ in draft.compile("party").mission.tree.subtrees] == ["cheer", "party"]
    assert [name for name, _ in draft.compile("fest is bow").mission.tree.subtrees] == ["bow", "fest"]


def test_a_condition_can_be_named() -> None:
    draft = entered("company is someone is near")
    assert draft.compile("wave if company").mission.tree.root.id == "IfThenElse"


def test_a_definition_replaces_an_older_one() -> None:
    draft = entered("greet is wave", "greet", "greet is nod", "greet")
    assert draft.text == "greet\ngreet is nod\ngreet\n"
    assert not draft.compile("greet is say hello").mission.warnings


def test_places_in_messages_are_those_of_the_entry() -> None:
    draft = entered("patrol is wave")
    with pytest.raises(MissionError) as caught:
        draft.compile("patrol then go to the ktichen")
    assert caught.value.diagnostics[0].span.place == "prompt:1:23"


def test_undo_and_redo() -> None:
    draft = entered("wave", "nod")
    assert draft.undo()
    assert draft.text == "wave\n"
    assert draft.redo()
    assert draft.text == "wave\nnod\n"
    assert draft.undo()
    draft.add(draft.compile("dock").entry)
    assert not draft.redo()
    assert [draft.undo() for _ in range(3)] == [True, True, False]
    assert draft.text == ""


def test_the_world_goes_on() -> None:
    draft = MissionDraft()
    for text in ("go to the lab", "go to the lobby"):
        assert ran(draft, draft.compile(text)).status == SUCCESS
    assert draft.session.robot.pose.distance_to((3.0, 1.5)) < 0.05
    assert draft.session.robot.battery < 100
    draft.reset()
    assert draft.session.robot.battery == 100


def option(text: str, name: str) -> str | None:
    """The file that the command at the top of an example gives an option."""
    return next((str(ROOT / line.split(name)[1].split()[0]) for line in text.splitlines() if name in line), None)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_mission_falls_into_its_statements(path: Path) -> None:
    text = path.read_text()
    world = world_of(path, text)
    keywords = [file for file in [option(text, "--keywords ")] if file]
    draft = MissionDraft(keywords, world)
    entries = draft.entries_of(text, str(path))
    draft.file = str(path)
    assert "\n".join(entry.text for entry in entries).split() == text.split()
    draft.change(entries)
    for entry in entries:  # alone, with the definitions and values of the others
        assert draft.compile(entry.text).entry == entry
    tree = btlang.parse_tree(Source(text, str(path)), keywords=keywords, world=world).tree
    assert plain(draft.compile_all().tree) == plain(tree)


def test_a_block_stays_with_its_head() -> None:
    text = "  as soon as the path is clear:\n    wave\n    nod\n  at 6 pm:\n    nod\n  wave"
    entries = [entry.text.split() for entry in MissionDraft().entries_of(text)]
    assert [(words[0], words[-1]) for words in entries] == [("as", "nod"), ("at", "nod"), ("wave", "wave")]


def test_statements_of_a_mission() -> None:
    text = (
        "# About.\n\nPlease wave. Nod!  # both\nrepeat:\n  wave\n  if stuck, nod\notherwise nod\n\n"
        "# Names.\nbow is wave; fest is nod\nbow\n"
    )
    entries = MissionDraft().entries_of(text)
    assert [entry.text for entry in entries] == [
        "# About.\n\nPlease wave. Nod!  # both",
        "repeat:\n  wave\n  if stuck, nod\notherwise nod",
        "# Names.\nbow is wave; fest is nod",
        "bow",
    ]
    assert [tuple(name for name, _ in entry.definitions) for entry in entries] == [(), (), ("bow", "fest"), ()]


def test_values_go_on_from_entry_to_entry() -> None:
    draft = MissionDraft()
    said = []
    for text in ("set counter to 3", "increase counter by 2", 'say "{counter} rounds"', "say {counter}"):
        compiled = draft.compile(text)
        draft.add(compiled.entry)
        outcome = ran(draft, compiled, lambda event: said.append(getattr(event, "text", "")))
        assert outcome.status == SUCCESS
    assert [text for text in said if text and text[0].isdigit()] == ["5 rounds", "5"]
    with pytest.raises(MissionError, match="BT048"):
        draft.compile("set counter to the lab")
    draft.reset()
    assert ran(draft, draft.compile("say {counter}")).status == FAILURE


def test_values_of_another_mission_are_forgotten() -> None:
    draft = MissionDraft()
    first = draft.compile("set counter to 3")
    draft.add(first.entry)
    ran(draft, first)
    draft.change(())
    second = draft.compile('set counter to "three"')
    assert ran(draft, second).status == SUCCESS


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Do that again.", "wave then nod"),
        ("again", "wave then nod"),
        ("do it 3 more times", "repeat 3 times:\n  wave then nod"),
        ("Repeat that twice", "repeat 2 times:\n  wave then nod"),
    ],
)
def test_the_latest_command_once_more(text: str, said: str) -> None:
    draft = entered("nod", "wave then nod", "hello is nod")
    again = draft.compile(text)
    assert again.entry.text == said
    assert again.mission.tree.root == draft.compile(said).mission.tree.root
    draft.add(again.entry)
    assert draft.text == f"nod\nwave then nod\nhello is nod\n{said}\n"


@pytest.mark.parametrize("text", ["do that 3 times", "do it until bumped", "if that fails, nod"])
def test_what_goes_on_with_an_entry_that_has_run_is_refused(text: str) -> None:
    with pytest.raises(MissionError, match="BT067"):
        entered("wave").compile(text)


def test_there_is_nothing_to_do_again_at_the_start() -> None:
    with pytest.raises(MissionError, match="BT067"):
        MissionDraft().compile("again")
