"""`btc completion`: what the scripts offer, in the shells themselves as far as they are installed."""

from __future__ import annotations

import shlex
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.cli.completion import SHELLS
from btlang.cli.parser import verb_parser
from btlang.cli.verbs import VERBS as TABLE
from tests.terminal.emulator import Terminal

VERBS = list(TABLE)
OFFERS = [
    ("btc ch", ["check"]),
    ("btc help expl", ["explain"]),
    ("btc run --pars", ["--parser"]),
    ("btc run --parser ", ["lark", "shunting-yard"]),
    ("btc run --robot sm", ["small"]),
    ("btc compile --to js", ["json"]),
    ("btc words mot", ["motion"]),
    ("btc completion z", ["zsh"]),
    ("btc check my", ["my mission.txt"]),
    ("btc run --world wo", ["world.toml"]),
    ("btc world.toml --quie", ["--quiet"]),
    ("btc run --main wo", []),
    ("btc version wo", []),
]
"""Command lines, and what may follow."""


@pytest.fixture(params=SHELLS)
def script(request: pytest.FixtureRequest, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[str, Path]:
    """A shell and its script, in a folder with two files."""
    shell = str(request.param)
    assert main(["completion", shell]) == 0
    path = tmp_path / f"script.{shell}"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    (tmp_path / "my mission.txt").touch()
    (tmp_path / "world.toml").touch()
    return shell, path


def test_every_verb_and_option_is_in_every_script(script: tuple[str, Path]) -> None:
    shell, path = script
    text = path.read_text(encoding="utf-8")
    for verb in VERBS:
        assert verb in text
        for action in verb_parser(TABLE[verb])._actions:
            names = [name.lstrip("-") if shell == "fish" else name for name in action.option_strings]
            assert [name for name in names if name not in text] == []


def test_the_shell_reads_its_script(script: tuple[str, Path]) -> None:
    shell, path = script
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed here")
    subprocess.run([shell, "-n", path], check=True)


@pytest.mark.parametrize("script", ["bash"], indirect=True)
@pytest.mark.parametrize(("line", "offered"), OFFERS)
def test_bash_offers(script: tuple[str, Path], line: str, offered: list[str]) -> None:
    words = line.split(" ")
    typed = f"COMP_WORDS=({' '.join(map(shlex.quote, words))}) COMP_CWORD={len(words) - 1}"
    program = f"source {script[1]}; {typed}; _btc; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    done = subprocess.run(["bash", "-c", program], cwd=script[1].parent, capture_output=True, text=True, check=True)
    assert sorted(filter(None, done.stdout.splitlines())) == offered


@pytest.mark.parametrize("script", ["fish"], indirect=True)
@pytest.mark.parametrize(("line", "offered"), OFFERS)
@pytest.mark.skipif(shutil.which("fish") is None, reason="fish is not installed here")
def test_fish_offers(script: tuple[str, Path], line: str, offered: list[str]) -> None:
    program = f"source {script[1]}; complete -C {shlex.quote(line)}"
    done = subprocess.run(["fish", "-c", program], cwd=script[1].parent, capture_output=True, text=True, check=True)
    assert sorted(found.partition("\t")[0].replace("\\", "") for found in done.stdout.splitlines()) == offered


@pytest.mark.parametrize("shell", [
    pytest.param(shell, marks=pytest.mark.skipif(shutil.which(shell[0]) is None, reason=f"no {shell[0]} here"))
    for shell in (("bash", "--norc", "--noprofile"), ("zsh", "-f"))
], ids=["bash", "zsh"])  # fmt: skip
def test_at_the_keyboard(
    shell: tuple[str, ...], terminal: Callable[..., Terminal], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["completion", shell[0]])
    (tmp_path / "script").write_text(capsys.readouterr().out, encoding="utf-8")
    (tmp_path / "my mission.txt").touch()
    user = terminal(*shell, folder=tmp_path)
    user.type("autoload -U compinit && compinit -D" if shell[0] == "zsh" else "true")
    user.type("source ./script; echo rea''dy")
    user.wait_for("ready")
    for typed, completed in [("btc compl", "btc completion"), ("b", "btc completion bash")]:
        user.type(typed, enter=False)
        user.press("Tab")
        user.wait_for(completed)
    user.press("C-u")
    user.type("btc check --format=j" if shell[0] == "bash" else "btc check --format j", enter=False)
    user.press("Tab")
    user.wait_for("json")
    user.type("my", enter=False)
    user.press("Tab")
    user.wait_for("my\\ mission.txt")
