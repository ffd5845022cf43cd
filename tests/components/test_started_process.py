"""Programs that components start: they end with their robot, with all that they have started."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from btlang.components.component import ComponentError
from btlang.components.started_process import StartedProcess
from tests.components.test_faults import wait_until

STUBBORN = "trap '' INT TERM; sleep 1000 & echo $$ $! > {file}; wait; wait"


def numbers(folder: Path) -> list[int]:
    """Those of a program that can't be asked to end, and of what it has started."""
    path = folder / "numbers"
    wait_until(lambda: path.exists() and len(path.read_text(encoding="utf-8").split()) == 2)
    return [int(each) for each in path.read_text(encoding="utf-8").split()]


def are_gone(folder: Path) -> bool:
    return not any(is_alive(each) for each in numbers(folder))


def is_alive(process: int) -> bool:
    """A zombie that nobody waits for isn't."""
    try:
        return ") Z " not in Path(f"/proc/{process}/stat").read_text(encoding="utf-8")
    except OSError:
        return False


@pytest.fixture
def command(tmp_path: Path) -> list[str]:
    return ["sh", "-c", STUBBORN.format(file=tmp_path / "numbers")]


def test_it_is_killed_with_what_it_has_started(tmp_path: Path, command: list[str]) -> None:
    program = StartedProcess(command)
    assert numbers(tmp_path)[0] == program.number
    assert program.ending is None
    program.close(0.1)
    program.close(0.1)
    wait_until(lambda: are_gone(tmp_path))
    assert program.ending == "was killed by signal 9"


def test_it_ends_with_a_robot_that_is_killed(tmp_path: Path, command: list[str]) -> None:
    robot = "import sys; from btlang.components.started_process import StartedProcess as S; S(sys.argv[1:]); input()"
    with subprocess.Popen([sys.executable, "-c", robot, *command], stdin=subprocess.PIPE) as process:
        assert len(numbers(tmp_path)) == 2
        process.kill()
    wait_until(lambda: are_gone(tmp_path))


def test_it_ends_with_a_robot_that_is_killed_before_it_knows_of_it(tmp_path: Path, command: list[str]) -> None:
    between = [sys.executable, "-m", "btlang.components.started_process", *command]
    with subprocess.Popen(between, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdout.close()
        assert len(numbers(tmp_path)) == 2
        process.stdin.close()
    wait_until(lambda: are_gone(tmp_path))


@pytest.mark.parametrize(
    ("command", "ending"),
    [(["sh", "-c", "exit 3"], "ended with exit code 3"), (["sh", "-c", "kill -9 $$"], "signal 9")],
)
def test_how_it_has_ended(command: list[str], ending: str) -> None:
    program = StartedProcess(command)
    wait_until(lambda: program.ending is not None)
    assert ending in str(program.ending)
    program.close(0.0)


def test_it_ends_by_itself_where_it_is_asked() -> None:
    program = StartedProcess(["sleep", "1000"])
    program.close(20.0)
    assert program.ending == f"was killed by signal {int(signal.SIGINT)}"


def test_what_cannot_be_started(tmp_path: Path) -> None:
    with pytest.raises(ComponentError, match="no-such-program can't be started: No such file or directory"):
        StartedProcess(["no-such-program"])
    with pytest.raises(ComponentError, match="can't be started: Permission denied"):
        StartedProcess([str(tmp_path)])
