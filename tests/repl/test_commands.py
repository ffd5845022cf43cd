"""The words of the REPL itself, without a terminal."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.repl.commands import COMMANDS, Leave, ReplCommands, command_of, near_command
from btlang.repl.draft import MissionDraft
from btlang.repl.keys import entries, needs_more
from btlang.repl.store import DraftStore


class Repl:
    """A session with commands, and what they wrote."""

    def __init__(self, *texts: str, store: DraftStore | None = None) -> None:
        self.session = MissionDraft()
        self.said: list[str] = []
        self.runs = 0
        self.commands = ReplCommands(self.session, lambda text: self.said.append(str(text)), self._run, store)
        for text in texts:
            self.session.add(self.session.compile(text).entry)

    def _run(self) -> None:
        self.runs += 1

    def do(self, line: str) -> str:
        found = command_of(line, self.session)
        assert found is not None, line
        self.said.clear()
        self.commands.do(*found)
        return "\n".join(self.said)


@pytest.fixture(autouse=True)
def _empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_every_word_is_done() -> None:
    repl = Repl("bow is nod", "bow")
    for command in COMMANDS:
        if command.name == "quit":
            with pytest.raises(Leave):
                repl.do("quit")
        else:
            assert repl.do(command.name) or command.name in ("run", "clear")
    assert repl.runs == 1


@pytest.mark.parametrize(
    ("line", "own"),
    [
        ("undo", ("undo", "")),
        ("  Undo  ", ("undo", "")),
        ("load my file.txt", ("load", "my file.txt")),
        (":show hello", ("show", "hello")),
        ("show tree", ("show", "tree")),
        ("show bow", ("show", "bow")),
        ("show hello", None),  # the robot prints it
        ("wave", None),
        ("undo is wave", None),
        ("fest", None),
        ("undo\nwave", None),
        (":flarp", ("flarp", "")),
        ("exit", ("quit", "")),
        (":Exit", ("quit", "")),
        ("bye", ("quit", "")),
        (":bye", ("quit", "")),
        (":quit", ("quit", "")),
        ("clear", ("clear", "")),
    ],
)
def test_whose_a_line_is(line: str, own: tuple[str, str] | None) -> None:
    assert command_of(line, Repl("bow is nod").session) == own


def test_a_defined_name_hides_a_word_of_the_repl() -> None:
    repl = Repl("world is wave")
    assert command_of("world", repl.session) is None
    assert "places" in repl.do(":world")


def test_undo_and_redo_say_what_they_change() -> None:
    repl = Repl("wave", "bow is nod", "bow is wave")
    assert repl.do("undo").startswith("- bow is wave\n+ bow is nod")
    assert repl.do("redo") == "- bow is nod\n+ bow is wave"
    assert "nothing to redo" in repl.do("redo")
    assert "nothing to undo" in Repl().do("undo")


def test_save_and_load() -> None:
    repl = Repl("bow is nod", "bow")
    assert not repl.commands.is_saved
    assert "which file" in repl.do("save")
    assert repl.do("save a.txt") == "Saved 2 lines to a.txt."
    assert repl.commands.is_saved
    other = Repl("wave")
    assert "exists already" in other.do("save a.txt")
    assert "which file" in other.do("load")
    other.do("load a.txt")
    assert other.session.text == "bow is nod\nbow\n"
    other.session.add(other.session.compile("nod").entry)
    assert other.do("save") == "Saved 3 lines to a.txt."
    other.do("undo")
    other.do("undo")
    assert other.session.text == "wave\n"
    assert other.do("save over a.txt") == "Saved 1 line to a.txt."
    assert Path("a.txt").read_text(encoding="utf-8") == "wave\n"


@pytest.mark.parametrize("line", ["load missing.txt", "load .", "save no/folder.txt", "world missing.toml"])
def test_wrong_files_change_nothing(line: str) -> None:
    repl = Repl("wave")
    with pytest.raises(MissionError):
        repl.do(line)
    assert (repl.session.text, repl.session.world) == ("wave\n", None)


def test_a_wrong_mission_is_not_loaded() -> None:
    Path("wrong.txt").write_text("wave\nflarp\n", encoding="utf-8")
    repl = Repl("wave")
    with pytest.raises(MissionError) as caught:
        repl.do("load wrong.txt")
    assert caught.value.diagnostics[0].span.place == "wrong.txt:2:1"
    assert repl.session.text == "wave\n"


def test_worlds() -> None:
    Path("room.toml").write_text(
        'start = { x = 1, y = 1 }\nplaces = [{ name = "corner", x = 2, y = 2 }]\n', encoding="utf-8"
    )
    repl = Repl("go to the lab")
    with pytest.raises(MissionError):  # the mission goes where that world has no place
        repl.do("world room.toml")
    assert "lab" in repl.do("world")
    repl.do("new")
    assert "places  corner" in repl.do("world room.toml")
    repl.session.compile("go to the corner")
    assert "(1.0, 1.0)" in repl.do("reset")


def test_speed() -> None:
    repl = Repl()
    assert repl.do("speed") == "The speed is real."
    assert repl.do("speed 2.5") == "The speed is 2.5 times real time."
    assert "factor" in repl.do("speed fast")
    assert repl.do("speed max") == "The speed is max."
    assert repl.commands.speed == "max"


def test_show_and_names() -> None:
    repl = Repl("bow is nod then wave", "bow")
    assert repl.do("show") == "bow is nod then wave\nbow"
    assert repl.do("show bow").splitlines() == [
        "bow is nod then wave", "bow:", "Sequence", "├── Nod: nod", "└── Wave: wave",
    ]  # fmt: skip
    assert repl.do("show tree").startswith("SubTree ID=bow")
    assert repl.do("names") == "bow is nod then wave"
    assert "There's no definition 'fest'" in repl.do(":show fest")
    assert "takes no words after it" in repl.do("undo now")
    assert "There's no 'flarp'" in repl.do(":flarp")


def test_help() -> None:
    repl = Repl()
    assert "Ctrl-D" in repl.do("help")
    assert "wave [at {person}]" in repl.do("help wave")
    assert repl.do("help save").startswith("save [over] FILE")
    assert "sensing" in repl.do("words sensing")


@pytest.mark.parametrize(
    ("text", "more"),
    [
        ("wave", False),
        ("repeat:", True),
        ("repeat:  # so", True),
        ("repeat:\n  wave", True),
        ("repeat:\n  wave\n", False),
    ],
)
def test_needs_more(text: str, more: bool) -> None:
    assert needs_more(text) is more


def test_entries_of_lines() -> None:
    lines = ["wave", "", "if stuck:", "  nod", "otherwise:", "  wave", "nod", "repeat:", "  nod", "", "say end"]
    assert list(entries(lines, MissionDraft().vocabulary)) == [
        "wave", "if stuck:\n  nod\notherwise:\n  wave", "nod", "repeat:\n  nod", "say end",
    ]  # fmt: skip


def test_a_store_keeps_what_was_left(tmp_path: Path) -> None:
    gone = DraftStore(tmp_path)
    gone.save(["bow is nod", "bow\ud800"], "bow the")
    store = DraftStore(tmp_path)
    assert store.left() is None  # its process runs still
    del gone
    (tmp_path / "sessions" / "broken.json").write_text("{", encoding="utf-8")
    kept = store.left()
    assert kept is not None
    assert (kept.entries, kept.draft, kept.world) == (("bow is nod", "bow\ud800"), "bow the", None)
    store.done_with(kept)
    assert store.left() is None


def test_restore_takes_one_session_after_the_other_with_its_world(tmp_path: Path) -> None:
    Path("room.toml").write_text(
        'start = { x = 1, y = 1 }\nplaces = [{ name = "corner", x = 2, y = 2 }]\n', encoding="utf-8"
    )
    for texts, draft, world in ((["bow is nod", "bow"], "bow the", None), (["go to the corner"], "", "room.toml")):
        gone = DraftStore(tmp_path)
        gone.save(texts, draft, world)
        del gone
    repl = Repl(store=DraftStore(tmp_path))
    assert "1 line" in repl.do("restore")
    assert repl.session.text == "go to the corner\n"
    assert repl.session.world == str(tmp_path / "room.toml")
    assert "3 lines" in repl.do("restore")
    assert repl.commands.draft == "bow the"
    assert "There's no earlier session" in repl.do("restore")


def test_a_store_that_cannot_write(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    store = DraftStore(tmp_path / "file")
    assert "file" in store.problem
    store.save(["wave"], "")
    store.forget()
    assert store.left() is None


def test_clear_clears_the_screen_and_not_the_mission() -> None:
    repl = Repl("bow is nod")
    cleared: list[bool] = []
    repl.commands.clear_screen = lambda: cleared.append(True)
    assert (repl.do("clear"), cleared, len(repl.session.entries)) == ("", [True], 1)
    repl.do(":clear")
    assert len(cleared) == 2


def test_help_fits_the_screen_and_leads_to_every_word() -> None:
    repl = Repl()
    overview = repl.do("help")
    assert len(overview.splitlines()) <= 16
    assert max(map(len, overview.splitlines())) <= 80
    assert [command.name for command in COMMANDS if command.name not in overview] == []
    for command in COMMANDS:
        assert command.help in repl.do(f"help {command.topic}")
        assert command.help in repl.do(f"help {command.name}")
    assert "leaves, like Ctrl-D" in repl.do("help exit")
    assert "Space" in repl.do("help keys")


def test_a_misspelt_word_of_the_repl() -> None:
    assert near_command("hepl") == "help"
    assert near_command(" Undoo") == "undo"
    assert near_command("frobnicate") == ""
