"""How files of tests are read: their lines, their missions, and what is wrong with them."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.testing.runner import run_test
from btlang.testing.statements import OPENERS
from btlang.testing.test_file import format_tests, read_tests
from btlang.text.source import Source
from tests.profiles import searches
from tests.testing.files import codes, told

HEAD = 'test "t":\n  run:\n    round is nod\n    wave then go to the lab then round\n'


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("eventually it waves", "BT029"),
        ("within it has said hello", "BT180"),
        ("within 5 m it has said hello", "BT180"),
        ("within 5 s", "BT180"),
        ("finally", "BT180"),
        ("when it has said hello the battery drops to 5%", "BT180"),
        ("before it has said hello", "BT180"),
        ('"wave" explodes', "BT180"),
        ('"wave" fails after lunch', "BT180"),
        ('"wave" fails 0 times', "BT180"),
        ('"wave" fails, then succeeds', "BT180"),
        ('"wave"', "BT180"),
        ('"juggle" fails', "BT182"),
        ('"round" fails', "BT182"),
        ('finally it has done "juggle"', "BT182"),
        ("after 5 s go to the lab", "BT182"),
        ("finally go to the lab", "BT029"),
        ("finally it has reached the moon", "BT013"),
        ("finally it has said hello or", "BT020"),
        ("finally the battery is below 5 m", "BT011"),
        ("with the battery at 20%", "BT181"),
        ('in the world "museum.toml"', "BT001"),
        ('run "other.txt"', "BT181"),
        ("finally it has said \"hello", "BT004"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_line(line: str, code: str) -> None:
    assert code in codes(f"{HEAD}  {line}\n")


def test_places_are_those_in_the_file() -> None:
    text = f"{HEAD}  finally it has reached the mon\n"
    with pytest.raises(MissionError) as raised:
        read_tests(Source(text, "t.test.txt"))
    [problem] = raised.value.diagnostics
    assert (problem.span.text, problem.span.place) == ("mon", "t.test.txt:5:30")


def test_what_is_wrong_with_the_mission_has_its_place_in_the_test() -> None:
    with pytest.raises(MissionError) as raised:
        read_tests(Source('test "t":\n  run:\n    wave\n    jugle\n', "t.test.txt"))
    [problem] = raised.value.diagnostics
    assert problem.span.place == "t.test.txt:4:5"


def test_all_tests_are_told_at_once() -> None:
    assert codes('test "a":\n  run:\n    wav\ntest "b":\n  finally nonsense\nnonsense\n') == ["BT010", "BT181", "BT180"]


@pytest.mark.parametrize("text", ["", "# nothing\n", "\n\n", "wave", 'test "a"', "test a:\n  run:\n    wave"])
def test_what_is_no_file_of_tests(text: str) -> None:
    assert set(codes(text)) <= {"BT180", "BT181"}
    assert codes(text)


def test_missions_and_worlds_lie_beside_the_test(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    below = tmp_path / "tests"
    below.mkdir()
    (tmp_path / "m.txt").write_text("go to the bench")
    (tmp_path / "w.toml").write_text(
        "start = { x = 0, y = 0, facing = 0 }\nwalls = [[[-3, -3], [3, -3], [3, 3], [-3, 3], [-3, -3]]]\n"
        '[[places]]\nname = "bench"\nx = 1\ny = 1\n'
    )
    (below / "m.test.txt").write_text(
        'test "t":\n  in the world "../w.toml"\n  run "../m.txt"\n  finally it has reached the bench\n'
    )
    path = str(below / "m.test.txt")
    monkeypatch.chdir(tmp_path)
    [test] = read_tests(read_source(path))
    assert test.mission.world == str(below / "../w.toml")
    monkeypatch.chdir(below)
    [test] = read_tests(read_source(path))
    assert test.mission.world == str(below / "../w.toml")
    other = below.rename(tmp_path / "others")
    monkeypatch.chdir(other)
    with pytest.raises(MissionError, match="outside the folder"):
        read_tests(read_source(str(other / "m.test.txt")))


def test_the_words_of_the_mission_are_words_of_its_test(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "w.toml").write_text('[[condition]]\nphrase = "it is raining"\nid = "Raining"\ncall = "rain:asked"\n')
    (tmp_path / "rain.py").write_text("def asked():\n    return True\n")
    (tmp_path / "m.txt").write_text('words "w.toml"\nbench is at (1, 1)\ngo to the bench then wait until it is raining')
    (tmp_path / "m.test.txt").write_text(
        'test "t":\n  run "m.txt"\n  finally it is raining and it has reached the bench\n'
    )
    [test] = read_tests(read_source("m.test.txt"))
    assert run_test(test).problem == ""


def test_the_layout_is_that_of_missions() -> None:
    text = 'test  "t" :\n     run :\n          wave   then nod\n     finally   the mission succeeds   # it does\n\n\n'
    laid_out = 'test "t":\n  run:\n    wave then nod\n  finally the mission succeeds  # it does\n'
    assert format_tests(Source(text, "t.test.txt")) == laid_out
    assert format_tests(Source(laid_out, "t.test.txt")) == laid_out


PIECES = [
    *OPENERS, "the battery", "is below 20%", "drops to 15%", "it has said", "hello", '"wave"', "fails", "twice", ",",
    "10 s", "the mission succeeds", "never bumped", "and", "not", ".", ";", ":", "(", "run:", '"', "go to the lab",
    "\n  ", "\n    ", "\n", "5 m", "it has done", "in the world", '"x.toml"', "é", "\x00", "test", '"t":',
]  # fmt: skip


@searches(60, 3000)
@given(st.lists(st.sampled_from(PIECES), max_size=12))
def test_any_words_are_read_or_told(pieces: list[str]) -> None:
    for head in (HEAD + "  ", ""):
        text = head + " ".join(pieces)
        for one in told(text):
            assert one.message
            assert 0 <= one.span.start <= one.span.end <= len(text)
