"""Every code has a page, and the examples of a page do what it says: the wrong one gets its code, the right one none.

A label, an empty line and indented lines are an example. Labels are `Wrong:` and `Right:` for a mission, `Wrong
keyword file:`, `Wrong world:` and `Wrong robot:` for a file that a mission is used with, `Wrong ros keyword file:` for
one whose words are bound to ROS 2, `Wrong schedule:` for the rule of a schedule, `Wrong house rules:` for those of a
robot, `Wrong restored mission:` for one that goes on from a saved run, `Wrong rename:` for a new name in an editor,
`Wrong command:` for a command, and `The file NAME:` for a file beside it. `, saved as ENCODING` may end a label.
Commands for a robot that is up find one.
"""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import NamedTuple

import pytest

from btlang.cli import CRASHED, main
from btlang.diagnostics.codes import CODES, NAMES
from btlang.diagnostics.explain import PAGES
from tests.conftest import take_away_what_is_missed
from tests.editing.edited import edit_sample
from tests.editing.renames import refusal
from tests.profiles import each_of
from tests.recording.trials import try_sample
from tests.ros.bound import bind_words
from tests.task.schedules import read_schedules
from tests.task.up import REFUSALS, read_rules, read_week, restored, robot_for

TEXTS = {path.stem: path.read_text(encoding="utf-8") for path in Path(PAGES).iterdir()}
_LABELLED = re.compile(r"^(Wrong|Right|The file)(?: ([\w. ]+))?(?:, saved as ([\w-]+))?:\n\n((?: {4}.*\n?)+)", re.M)
_COMMANDS = {"": "check FILE", "keyword file": "check -c wave --keywords FILE", "world": "check -c wave --world FILE",
             "answers": "run -c wave --speed max --answers FILE",
             "robot": "run -c 'wait 1 s' --speed max --robot FILE"}  # fmt: skip


class Example(NamedTuple):
    """An example of a page: Wrong, Right or The file; what it is; its encoding; its text."""

    sort: str
    of: str
    encoding: str
    text: str


def examples(page: str) -> list[Example]:
    """All examples of a page, in its order."""
    return [
        Example(sort, of, encoding or "utf-8", re.sub(r"^ {4}", "", text, flags=re.M))
        for sort, of, encoding, text in _LABELLED.findall(page)
    ]


def said(example: Example, page: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    """The exit code and the messages of an example."""
    for file in examples(page):
        if file.sort == "The file":
            (folder / file.of).write_text(file.text, encoding=file.encoding)
    if example.of == "command":
        [btc, *command] = shlex.split(example.text)
        assert btc == "btc"
    elif example.of == "edit":
        return edit_sample(example.text), capsys.readouterr().err
    elif example.of == "mission to try":
        return try_sample(example.text, "words.toml"), capsys.readouterr().err
    elif example.of == "schedule":
        return read_schedules(example.text.splitlines()), capsys.readouterr().err
    elif example.of == "rename":
        problem = refusal(example.text)
        return 2 if problem else 0, problem
    else:
        (folder / "example.txt").write_text(example.text, encoding=example.encoding)
        readers = {"house rules": read_rules, "file of schedules": read_week}
        if example.of in (*readers, "restored mission"):
            problem = readers[example.of]("example.txt") if example.of in readers else restored(example.text)
            return 2 if problem else 0, problem
        if example.of == "ros keyword file":
            (folder / "example.txt").rename(folder / "example.toml")
            return bind_words("example.toml"), capsys.readouterr().err
        command = shlex.split(_COMMANDS[example.of].replace("FILE", "example.txt"))
    code = main(command)
    return code, capsys.readouterr().err


@pytest.mark.parametrize("code", sorted(CODES))
def test_examples(
    code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    take_away_what_is_missed(code, monkeypatch)
    page = TEXTS[code]
    [wrong] = [example for example in examples(page) if example.sort == "Wrong"]
    [right] = [example for example in examples(page) if example.sort == "Right"]
    assert wrong.of == right.of
    with robot_for(code, monkeypatch):
        exit_code, messages = said(wrong, page, tmp_path, capsys)
        assert re.findall(r" (?:error|warning|note) (BT\d+): ", messages)[:1] == [code], messages
        expected = 2 if CODES[code].severity == "error" else 0
        assert exit_code == {"BT099": CRASHED, **dict.fromkeys(REFUSALS, 1)}.get(code, expected)
        assert said(right, page, tmp_path, capsys) == (0, "")


def test_every_code_has_a_page_and_every_page_a_code() -> None:
    assert sorted(TEXTS) == sorted(CODES)


@each_of([(code,) for code in sorted(TEXTS)], at_a_time=70)
def test_form(code: str) -> None:
    """A title, a few lines of prose, no line that a narrow terminal would wrap, no block that is not tested."""
    page = TEXTS[code]
    title, empty, *rest = page.splitlines()
    assert re.fullmatch(rf"# {code}: [a-z][^.]+", title, re.I)
    assert (empty, page[-1], page[-2] == "\n") == ("", "\n", False)
    prose = [line for line in rest if line and not line.startswith(" ")]
    labels = [line for line in prose if re.match(r"(Wrong|Right|The file [\w.]+)\b.*:$", line)]
    assert 1 <= len(prose) - len(labels) <= 10
    assert len(labels) == len(examples(page)) == len(re.findall(r"\n\n {4}", page))
    assert max(map(len, page.splitlines())) <= 84
    assert len([line for line in rest if line]) <= 30


def printed(code: str) -> str:
    """The page of a code, since when there is such a code, and whether it will stay."""
    return f"{TEXTS[code]}\nSince btlang 0.1.0, stable.\n"


def test_explain_prints_a_page(capsys: pytest.CaptureFixture[str]) -> None:
    for written in ("BT013", "bt013", "Bt13", "13", "013"):
        assert main(["explain", written]) == 0
        assert capsys.readouterr() == (printed("BT013"), "")


def test_explain_lists_all_codes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(" ")[0] for line in lines[:-2]] == sorted(CODES)
    assert "BT013  an unknown name" in lines


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("BT079", "Similar: BT078, BT080"),
        ("BT9999999999999", "Similar: BT"),
        ("BT" + "9" * 6000, "Similar: "),
        ("BT", "A code is BT and three digits"),
        ("", "A code is BT and three digits"),
        ("BT\N{SUPERSCRIPT TWO}", "A code is BT and three digits"),
    ],
)
def test_an_unknown_code_is_told(written: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", written]) == 2
    errors = capsys.readouterr().err
    assert "error BT090" in errors
    assert told in errors


def test_every_warning_and_note_has_a_name_that_its_page_tells() -> None:
    for code, kind in CODES.items():
        assert (kind.name != "") == (kind.severity != "error")
        comments = (f"`# allow: {kind.name}`", f"`<!-- allow: {kind.name} -->`")
        assert not kind.name or any(comment in TEXTS[code] for comment in comments)


@pytest.mark.parametrize("written", ["two readings", "Two  Readings", "never runs"])
def test_explain_knows_the_names_of_warnings(written: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", written]) == 0
    assert capsys.readouterr() == (printed(NAMES[" ".join(written.lower().split())]), "")
