"""The README and `docs/` are true: their commands and snippets run, and the output that they show is what is printed.

A block with a file name is that file. What `btc tree` and `btc explain` show is what both parsers give.
`UPDATE_README=1 pytest -n0` writes the shown output anew.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

from btlang.backends.grammar.targets import GRAMMARS
from btlang.cli import main
from btlang.frontends.mission.reader import PARSERS
from btlang.recording.latest import note_latest
from btlang.task.layer import read_schedules
from tests.backends.test_grammar import grammar
from tests.conftest import without_overruns
from tests.forked import popen
from tests.profiles import amount

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs").rglob("*.md"))]
IN_REAL_TIME = ("btc run --keywords my_services.toml", "btc run --speed max --robot kettle_robot.toml")
"""Commands that talk to devices or services."""
SET_UP = "python3 -m venv "  # what lines start with that only `.ci/run` runs
_LINK = re.compile(r"\]\((?!\w+:)([^)#\s]*)(#([^)\s]*))?\)")
_BLOCK = re.compile(r"^```(\w+)(?: ([\w.]+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class Block(NamedTuple):
    """A block of a page: its language, the name of the file that it is ("" where it is none), its text."""

    page: Path
    language: str
    file: str
    text: str


def blocks_of(page: Path) -> list[Block]:
    """The blocks of a page."""
    text = page.read_text(encoding="utf-8")
    return [Block(page, match[1], match[2] or "", match[3]) for match in _BLOCK.finditer(text)]


BLOCKS = [block for page in PAGES for block in blocks_of(page)]


def blocks(language: str) -> list[Block]:
    """The blocks of a language that are no files."""
    return [block for block in BLOCKS if block.language == language and not block.file]


def first_line(block: Block) -> str:
    """What a block is called in the list of tests."""
    return block.text.partition("\n")[0]


def command_and_output(block: Block) -> tuple[str, str]:
    """A shown command, which may be several lines in quotes, and the lines below it."""
    assert block.text.startswith("$ "), block.text
    lines = block.text.splitlines(keepends=True)
    for last in range(1, len(lines) + 1):
        command = "".join(lines[:last])
        with contextlib.suppress(ValueError):  # the quotes are still open
            shlex.split(command)
            return command[2:].rstrip("\n"), "".join(lines[last:])
    raise AssertionError(f"quotes are missing: {block.text}")


def commands() -> list[str]:
    """The lines of shell blocks, each once and without its comment, and without those that set up an environment."""
    lines = [line.partition("  #")[0].rstrip() for block in blocks("sh") for line in block.text.splitlines()]
    return [line for line in dict.fromkeys(lines) if line and not line.startswith((SET_UP, "git clone "))]


def run(arguments: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs this Python in a folder, as an installed command would; both outputs in one."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    words = [sys.executable, "-P", *arguments]
    streams = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with popen(words, cwd=folder, env=environment, text=True, **streams) as process:
        printed, _ = process.communicate()
    return subprocess.CompletedProcess(words, process.returncode or 0, printed)


def btc(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a line `btc ...`, `python3 FILE` or `pytest FILE`."""
    words = shlex.split(line, comments=True)
    if words[0] == "pytest":
        return run(["-m", *words, "-n0", "-p", "no:cacheprovider"], folder)
    if words[0] == "python3":
        return run(["-W", "error", *words[1:]], folder)
    assert words[0] == "btc", line
    if needs_own_process(line):
        return run(["-m", "btlang", *words[1:]], folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr(sys, "stdin", io.StringIO())
        code, printed = quick(line)
    return subprocess.CompletedProcess(words, code, printed)


def needs_own_process(line: str) -> bool:
    """Whether a command imports modules of its folder, or runs in real time. Others start longer than they run."""
    is_paced = line.startswith(("btc run", 'btc "')) and "--speed max" not in line
    return is_paced or re.search(r"--(robot|keywords|groot|chaos)\b|^btc (test|robot|gesture|new)\b", line) is not None


def quick(line: str) -> tuple[int, str]:
    """What a line `btc ...` returns and prints, in this process as it is quicker."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        code = main(shlex.split(line, comments=True)[1:])
    return code, printed.getvalue()


def readings(line: str) -> list[str]:
    """What a line `btc tree ...` or `btc explain ...` prints with each parser."""
    return [quick(f"{line} --parser {parser}")[1] for parser in PARSERS]


@pytest.fixture(scope="module")
def read_only(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the examples and the files that the pages show, for all tests: to lay it out takes longer than
    to read a mission, and the words of files that stay where they are stay known.
    """
    return laid_out(tmp_path_factory.mktemp("pages"))


@pytest.fixture
def folder(read_only: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The same, for tests that write into it, with a latest run. The next test finds it as this one did."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    note_latest(str(read_only / "tea.mcap"))
    before = stamps(read_only)
    yield read_only
    after = stamps(read_only)
    if any(after.get(path) != stamp for path, stamp in before.items()):
        shutil.rmtree(read_only)
        laid_out(read_only)
        return
    for path in sorted(after.keys() - before.keys(), reverse=True):  # folders behind what they contain
        path.rmdir() if after[path] is None else path.unlink()


def stamps(folder: Path) -> dict[Path, tuple[int, int] | None]:
    """The time and the size of each file in a folder, None for folders."""
    found: dict[Path, tuple[int, int] | None] = {}
    for path in folder.rglob("*"):
        status = path.lstat()
        found[path] = None if stat.S_ISDIR(status.st_mode) else (status.st_mtime_ns, status.st_size)
    return found


def laid_out(folder: Path) -> Path:
    """The folder, with all of that in it."""
    left_out = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "examples", folder / "examples", ignore=left_out)
    shutil.copytree(ROOT / "examples" / "guide", folder / "guide", ignore=left_out)
    for block in BLOCKS:
        if block.file:
            (folder / block.file).write_text(block.text, encoding="utf-8")
    (folder / "tea.mcap").write_bytes(recording())
    return folder


@cache
def recording() -> bytes:
    """Of the run that docs/recording.md records."""
    with tempfile.TemporaryDirectory() as made:
        path = Path(made, "tea.mcap")
        words = ["run", str(ROOT / "examples" / "tea_service.txt"), "--speed", "max", "--quiet", "--record", str(path)]
        assert main(words) == 0
        return path.read_bytes()


SHORTER = {
    "examples --to markdown": "examples/patrol.txt --to markdown",
    "btc test guide": "btc test guide/tests/reception.test.txt",
}
"""What takes long since it is done of many missions, each with the same of one."""


@pytest.mark.long
@pytest.mark.parametrize("line", commands())
def test_commands_run(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real_time = line.startswith(("btc run", 'btc "')) and "--speed" not in line
    for to in ("gbnf", "ebnf"):  # of the words that ship: in another process
        monkeypatch.setitem(GRAMMARS, to, lambda _, to=to: grammar(to))
    for said, less in SHORTER.items() if amount(1, 0) else ():
        line = line.replace(said, less)
    done = btc(f"{line} --speed max" if real_time else line, folder)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("block", blocks("console"), ids=first_line)
def test_shown_output_is_real(block: Block, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    line, shown = command_and_output(block)
    if is_reading(line):
        monkeypatch.chdir(request.getfixturevalue("read_only"))
        monkeypatch.setenv("COLUMNS", "100")
        printed, *others = readings(line)
        assert all(other == printed for other in others)
    else:
        printed = without_overruns(btc(line, request.getfixturevalue("folder")).stdout)
    assert "Traceback" not in printed
    if os.environ.get("UPDATE_README"):
        page = block.page.read_text(encoding="utf-8")
        fresh = page.replace(f"```console\n{block.text}```", f"```console\n$ {line}\n{printed}```")
        block.page.write_text(fresh, encoding="utf-8")
    else:
        masked = without_times if line.startswith(IN_REAL_TIME) else without_dates
        assert masked(printed) == masked(shown)


def is_reading(line: str) -> bool:
    """Whether a command shows how a mission is read."""
    return re.match(r"btc (tree|explain) (?!BT\d)", line) is not None


def without_dates(text: str) -> str:
    """What is printed, without the time of the day. Simulated times are exact."""
    return re.sub(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d", "(when)", text)


def without_times(text: str) -> str:
    """What is printed of a run with parts that take real time."""
    return re.sub(r" *\b\d+\.\d+\b", " T", text)


@pytest.mark.parametrize("block", blocks("python"))
def test_snippets_run(block: Block, folder: Path) -> None:
    (folder / "snippet.py").write_text(block.text, encoding="utf-8")
    done = run(["-W", "error", "snippet.py"], folder)
    assert done.returncode == 0, done.stdout
    assert done.stdout


def commands_with(file: str) -> list[str]:
    """The shown commands that name a file."""
    lines = [command_and_output(block)[0] for block in blocks("console")]
    return [line for line in lines if file in line.split()]


@pytest.mark.parametrize("block", [block for block in BLOCKS if block.language == "mission"], ids=first_line)
def test_missions_compile(block: Block, read_only: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the world and the words of the first command that runs it, and without a warning."""
    line = next(iter(commands_with(block.file)), "")
    options = re.findall(r"--(?:world|keywords|language) \S+", line)
    (read_only / "shown.txt").write_text(block.text, encoding="utf-8")  # which each of these tests writes anew
    monkeypatch.chdir(read_only)
    assert quick(f"btc check shown.txt {' '.join(options)}") == (0, "No problems found.\n")


def test_every_python_file_runs() -> None:
    """A command runs it, or a keyword file or robot file names it."""
    calls = "".join(block.text for block in BLOCKS if block.language in ("toml", "sh"))
    files = [block.file for block in BLOCKS if block.language == "python" and block.file]
    idle = [file for file in files if not commands_with(file) and not called(file, calls)]
    assert idle == []


def called(file: str, calls: str) -> bool:
    return f'"{file.removesuffix(".py")}:' in calls or f"pytest {file}" in calls


def test_no_two_files_of_the_pages_have_one_name() -> None:
    names = [block.file for block in BLOCKS if block.file]
    assert sorted(names) == sorted(set(names))


def test_the_tutorial_leaves_no_snippet_out() -> None:
    """Each of its blocks is of a language that a test reads: those here, and for screens tests/terminal."""
    page = ROOT / "docs" / "tutorial.md"
    text = page.read_text(encoding="utf-8")
    blocks_there = [block for block in BLOCKS if block.page == page]
    assert len(blocks_there) == len(re.findall(r"^```\w", text, re.MULTILINE)) == text.count("```") / 2
    assert {block.language for block in blocks_there} <= {"console", "mission", "python", "toml", "sh", "screen"}
    assert all(block.file for block in blocks_there if block.language == "toml")


def test_commands_named_in_the_tutorial_are_known(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those in a sentence; no robot runs for them, and no browser comes."""
    monkeypatch.setattr("btlang.server.page.local_page.OPEN", 0.0)
    text = re.sub(r"^```.*?^```$", "", (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8"), flags=re.M | re.S)
    named = re.findall(r"`(btc (?!(?:run|tree)`)[^`]+)`", text)
    assert len(named) > 5
    for line in named:
        done = btc(line + " --speed max" if line.startswith("btc run ") and "--help" not in line else line, folder)
        assert done.returncode == 0, done.stdout


def test_the_readme_has_700_words_at_most() -> None:
    assert len(README.read_text(encoding="utf-8").split()) <= 700


def test_ci_runs_the_two_set_up_commands() -> None:
    lines = [line for line in README.read_text(encoding="utf-8").splitlines() if line.startswith(SET_UP)]
    first, second = lines
    assert first.split(" && ")[0] == second.split(" && ")[0]  # one environment for both
    assert "btc run" in first
    assert second.endswith("pytest")
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    [pattern] = re.findall(r"grep '\^(.*)' \S*README.md", script)
    assert pattern == SET_UP
    assert 'bash -euo pipefail -c "${commands[0]}"' in script
    assert 'bash -euo pipefail -c "${commands[1]}"' in script


def test_links_between_the_pages_lead_somewhere() -> None:
    """To a file, and to a heading of it."""
    for page in (*PAGES, *ROOT.glob("*.md")):
        for name, _, anchor in _LINK.findall(_BLOCK.sub("", page.read_text(encoding="utf-8"))):
            target = page.parent / name if name else page
            assert target.exists(), f"{page}: {name}"
            if anchor and target.suffix == ".md":
                headings = re.findall(r"^#+ (.*)$", _BLOCK.sub("", target.read_text(encoding="utf-8")), re.MULTILINE)
                assert anchor in map(as_anchor, headings), f"{page}: {name}#{anchor}"


def as_anchor(heading: str) -> str:
    """As GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def test_files_of_the_pages_load(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keyword files, worlds and robots that are shown without a command."""
    monkeypatch.chdir(folder)
    for block in BLOCKS:
        if block.language == "toml" and block.file.endswith("schedules.toml"):
            assert read_schedules(block.file)
        elif block.language == "toml" and block.file:
            option = "--world" if block.file.endswith("world.toml") else "--keywords"
            command = f"btc check {option} {block.file} -c wave"
            if block.file.endswith("robot.toml"):
                twins = "--simulate" if 'over = "devices"' in block.text else ""
                command = f"btc run --speed max {twins} --robot {block.file} -c 'wait 1 s'"
            code, printed = quick(command)
            assert code == 0, printed
