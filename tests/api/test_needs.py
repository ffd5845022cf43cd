"""Missions that say at their top which world and which words they need."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.reader import PARSERS
from btlang.repl.commands import ReplCommands
from btlang.repl.draft import MissionDraft
from btlang.text.source import Source

WORLD = """\
start = { x = 1, y = 1 }
places = [{ name = "pitch", x = 3, y = 1 }]
"""
WORDS = """\
[[action]]
phrase = "blow whistle"
id = "BlowWhistle"
call = "referee:blow"
"""
MISSION = """\
# The second half.

world "worlds/field.toml"
the words "referee.toml"   # the whistle

go to the pitch then blow the whistle
"""
RUN = ["--speed", "max", "--lines"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder `match` with the mission; the current folder is above it."""
    match = tmp_path / "match"
    (match / "worlds").mkdir(parents=True)
    (match / "worlds" / "field.toml").write_text(WORLD)
    (match / "referee.toml").write_text(WORDS)
    (match / "referee.py").write_text("def blow():\n    print('Tweet!')\n")
    (match / "half.txt").write_text(MISSION)
    (tmp_path / "other.toml").write_text(WORLD.replace("pitch", "tunnel"))
    monkeypatch.chdir(tmp_path)
    return match


@pytest.mark.parametrize("parser", PARSERS)
def test_every_verb_reads_what_a_mission_needs(parser: str, capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("run", "check", "tree", "explain"):
        options = RUN if verb == "run" else []
        assert main([verb, "match/half.txt", "--parser", parser, *options]) == 0, capsys.readouterr().err
    out = capsys.readouterr().out
    assert "done   go to pitch" in out
    assert "Tweet!" in out
    assert "BlowWhistle: blow whistle" in out


def test_the_library_does_too() -> None:
    mission = btlang.parse_file("match/half.txt")
    assert mission.world == "match/worlds/field.toml"
    assert mission.run(speed="max").succeeded


def test_a_given_world_wins(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "match/half.txt", "--world", "other.toml"]) == 2
    assert "Known: tunnel" in capsys.readouterr().err


def test_given_words_are_added(folder: Path) -> None:
    Path("more.toml").write_text(WORDS.replace("blow whistle", "shrug").replace("BlowWhistle", "Shrug"))
    path = folder / "half.txt"
    path.write_text(MISSION + "shrug\n")
    assert main(["check", str(path), "--keywords", "more.toml", "--keywords", "match/referee.toml"]) == 0


def test_format_and_english_keep_the_lines(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["format", "match/half.txt"]) == 0
    assert (folder / "half.txt").read_text() == MISSION.replace("   #", "  #")
    capsys.readouterr()
    assert main(["compile", "match/half.txt", "--to", "english", "-o", "match/again.txt"]) == 0
    first = ['world "worlds/field.toml"', 'words "referee.toml"']
    assert (folder / "again.txt").read_text().splitlines()[:2] == first
    assert main(["run", "match/again.txt", *RUN]) == 0


def test_the_prompt_loads_it() -> None:
    draft = MissionDraft()
    said: list[str] = []
    commands = ReplCommands(draft, lambda text: said.append(str(text)), lambda: None)
    commands.do("load", "match/half.txt")
    assert draft.world == "match/worlds/field.toml"
    assert draft.session.world.names.places == ("pitch",)
    assert str(draft.compile_all()).endswith("BlowWhistle: blow whistle")
    assert draft.text == MISSION
    with pytest.raises(MissionError):
        commands.do("world", '"nowhere.toml"')
    assert draft.world == "match/worlds/field.toml"


def test_a_world_chosen_at_the_prompt_stays() -> None:
    draft = MissionDraft(world="other.toml")
    commands = ReplCommands(draft, lambda _: None, lambda: None)
    with pytest.raises(MissionError):  # without a pitch
        commands.do("load", "match/half.txt")
    assert (draft.world, draft.text) == ("other.toml", "")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('wave\nworld "worlds/field.toml"', "match/half.txt:2:1: error BT049: 'world \"worlds/field.toml\"'"),
        ('world "worlds/field.toml"; world "worlds/field.toml"\nwave', "1:28: error BT049"),
        ('words "../other.toml"\nwave', "BT049: 'words \"../other.toml\"' can't be used: it is outside the folder"),
        ('world "worlds"\nwave', "it isn't a regular file"),
        ('world "none.toml"\nwave', "match/half.txt:1:1: error BT070: This world file can't be used: cannot read"),
        ('words "none.toml"\nwave', "match/half.txt:1:1: error BT001: I can't read match/none.toml"),
        ('words "worlds/field.toml"\nwave', "match/half.txt:1:1: The mission needs this file."),
        ('world "referee.toml"\nwave', "match/half.txt:1:1: The mission needs this file."),
    ],
)  # fmt: skip
def test_what_is_wrong_is_shown_at_the_line(
    text: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "half.txt").write_text(text)
    assert main(["check", "match/half.txt"]) == 2
    assert message in capsys.readouterr().err


def test_only_a_mission_that_the_user_names_loads_files() -> None:
    """Keyword files run Python: a text that comes from anywhere else must not choose them."""
    for source in (MISSION, Source(MISSION, "mission", "match")):
        with pytest.raises(MissionError) as caught:
            btlang.parse_tree(source)
        assert {problem.code for problem in caught.value.diagnostics} == {"BT049"}


def test_an_included_mission_needs_nothing(folder: Path) -> None:
    (folder / "tunnel.txt").write_text('words "referee.toml"\nbow is nod\n')
    (folder / "half.txt").write_text('include "tunnel.txt"\nbow\n')
    assert btlang.parse_file("match/half.txt").world is None


@pytest.mark.parametrize("name", ["world", "words"])
def test_these_words_are_names_like_any_other(name: str) -> None:
    tree = str(btlang.parse_tree(f'{name} is wave\n{name} then say "{name}"'))
    assert f"SubTree ID={name}" in tree


def test_in_spanish(folder: Path) -> None:
    (folder / "half.txt").write_text('mundo "worlds/field.toml"\nve a pitch\n', encoding="utf-8")
    assert btlang.parse_file("match/half.txt", language="es").world == "match/worlds/field.toml"
