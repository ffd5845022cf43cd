"""Interfaces are compiled by one command, and what is missing or wrong is told."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from btlang.ros import interfaces
from btlang.ros.interfaces import InterfaceError, compile_interfaces, find_missing_tools, main
from tests.ros.processes import REPOSITORY


def test_an_empty_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    if find_missing_tools() is not None:
        pytest.skip(str(find_missing_tools()))
    assert main([str(tmp_path)]) == 2
    assert "there are no interfaces in" in capsys.readouterr().err


def test_a_file_that_cannot_be_read(tmp_path: Path):
    if find_missing_tools() is not None:
        pytest.skip(str(find_missing_tools()))
    message = tmp_path / "odd_msgs" / "msg" / "Odd.msg"
    message.parent.mkdir(parents=True)
    message.write_text("this is = no message\n", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "btlang.ros.interfaces", str(tmp_path / "odd_msgs")],
        cwd=REPOSITORY, text=True, capture_output=True, check=False, timeout=60,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith("error: odd_msgs cannot be read: ")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("tool", ["gcc", "g++"])
def test_a_missing_compiler(tool: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    if find_missing_tools() is not None:
        pytest.skip(str(find_missing_tools()))
    which = shutil.which
    monkeypatch.setattr(interfaces.shutil, "which", lambda name: None if name == tool else which(name))
    with pytest.raises(InterfaceError, match=f"^{tool.replace('+', '.')} is missing: apt install"):
        compile_interfaces(tmp_path)


def test_without_folders_it_tells_its_use(capsys: pytest.CaptureFixture[str]):
    assert main([]) == 2
    assert "python -m btlang.ros.interfaces FOLDER" in capsys.readouterr().out
