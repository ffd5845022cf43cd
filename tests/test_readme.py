"""The README is true: its missions compile, its commands and snippets run, and what it shows is what they print.

`UPDATE_README=1` writes the shown output anew.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
_BLOCK = re.compile(r"^```(\w+)(?: ([\w.]+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
BLOCKS = [match.groups() for match in _BLOCK.finditer(README.read_text(encoding="utf-8"))]
SET_UP = "python3 -m venv "  # what lines start with that only `.ci/run` runs


def texts(kind: str) -> list[str]:
    """What stands in the blocks of a kind."""
    return [text for block, _, text in BLOCKS if block == kind]


def commands() -> list[str]:
    """The lines of shell blocks, without those that set up an environment."""
    lines = [line for text in texts("sh") for line in text.splitlines()]
    return [line for line in lines if line.strip() and not line.startswith(SET_UP)]


def run(arguments: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs this Python in a folder with the btlang of this checkout; both outputs in one."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, encoding="utf-8", timeout=120, check=False,
    )  # fmt: skip


def btc(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a line that starts with `btc`."""
    name, *arguments = shlex.split(line, comments=True)
    assert name == "btc", line
    return run(["-m", "btlang", *arguments], folder)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the examples and the missions of the README."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for kind, name, text in BLOCKS:
        if kind == "mission":
            (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("line", commands())
def test_commands_run(line: str, folder: Path) -> None:
    done = btc(line, folder)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("text", texts("console"), ids=lambda text: text.splitlines()[0])
def test_shown_output_is_real(text: str, folder: Path) -> None:
    line, _, shown = text.partition("\n")
    assert line.startswith("$ ")
    done = btc(line[2:], folder)
    assert "Traceback" not in done.stdout
    if os.environ.get("UPDATE_README"):
        readme = README.read_text(encoding="utf-8")
        README.write_text(readme.replace(f"```console\n{text}```", f"```console\n{line}\n{done.stdout}```"), encoding="utf-8")
    else:
        assert without_times(done.stdout) == without_times(shown)


def without_times(text: str) -> str:
    """A run's lines without their times, which a better model of the robot may change."""
    return re.sub(r" *\b\d+\.\d+\b", " T", text)


@pytest.mark.parametrize("text", texts("python"))
def test_snippets_run(text: str, tmp_path: Path) -> None:
    (tmp_path / "snippet.py").write_text(text, encoding="utf-8")
    done = run(["-W", "error", "snippet.py"], tmp_path)
    assert done.returncode == 0, done.stdout
    assert done.stdout


def test_ci_runs_the_two_set_up_commands() -> None:
    lines = [line for line in README.read_text(encoding="utf-8").splitlines() if line.startswith(SET_UP)]
    first, second = lines
    assert "btc run" in first
    assert second.endswith("pytest")
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    [pattern] = re.findall(r"grep '\^(.*)' \S*README.md", script)
    assert pattern == SET_UP
    assert 'bash -euo pipefail -c "${commands[0]}"' in script
    assert 'bash -euo pipefail -c "${commands[1]}"' in script


def test_files_that_it_names_exist() -> None:
    for link in re.findall(r"\]\(([^)#]+)\)", README.read_text(encoding="utf-8")):
        assert (ROOT / link).exists(), link
