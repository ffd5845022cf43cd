"""`btc format`: files in place, `--check`, standard input, and what is refused."""

from __future__ import annotations

import errno
import io
import os
from pathlib import Path

import pytest

from btlang.cli import main

MESSY, TIDY = b"wave  then nod\r\n\r\n\r\nstop  # now", b"wave then nod\n\nstop  # now\n"


def mission(folder: Path, name: str, data: bytes) -> Path:
    path = folder / name
    path.write_bytes(data)
    return path


def test_files_in_place(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, other = mission(tmp_path, "one.txt", b"\xef\xbb\xbf" + MESSY), mission(tmp_path, "other.txt", TIDY)
    os.chmod(one, 0o640)
    before = other.stat()
    assert main(["format", str(one), str(other)]) == 0
    assert capsys.readouterr().out == f"Formatted {one}.\n"
    assert (one.read_bytes(), other.read_bytes()) == (TIDY, TIDY)
    assert one.stat().st_mode & 0o777 == 0o640
    assert other.stat().st_mtime_ns == before.st_mtime_ns
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one.txt", "other.txt"]


def test_check_changes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, other = mission(tmp_path, "one.txt", MESSY), mission(tmp_path, "other.txt", TIDY)
    assert main(["format", "--check", str(one), str(other)]) == 1
    assert capsys.readouterr().out == f"{one} would change.\n"
    assert one.read_bytes() == MESSY
    assert main(["format", "--check", str(other)]) == 0
    assert main(["format", "--check", "-c", "wave"]) == 1  # its last line has no end


def test_a_filter(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(MESSY)))
    assert main(["format", "-"]) == 0
    assert capsys.readouterr().out.encode() == TIDY
    assert main(["format", "-c", " wave "]) == 0
    assert capsys.readouterr().out == "wave\n"


def test_a_mission_with_mistakes_is_left_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wrong, right = mission(tmp_path, "wrong.txt", b"fly  up"), mission(tmp_path, "right.txt", MESSY)
    assert main(["format", str(wrong), str(tmp_path / "missing.txt"), str(right)]) == 2
    errors = capsys.readouterr().err
    assert "BT010" in errors
    assert "BT001" in errors
    assert (wrong.read_bytes(), right.read_bytes()) == (b"fly  up", TIDY)
    assert main(["format", "--check", str(wrong), str(right)]) == 2


def test_definitions_alone_have_a_layout(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["format", "-c", "bow  is nod"]) == 0
    assert capsys.readouterr().out == "bow is nod\n"


def test_a_file_that_cannot_be_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_arguments: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    path = mission(tmp_path, "one.txt", MESSY)
    monkeypatch.setattr("os.replace", full)
    assert main(["format", str(path)]) == 2
    assert "BT009: I can't write" in capsys.readouterr().err
    assert path.read_bytes() == MESSY
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    path = mission(tmp_path, "one.txt", MESSY)
    link = tmp_path / "link.txt"
    link.symlink_to(path)
    assert main(["format", str(link)]) == 0
    assert link.is_symlink()
    assert path.read_bytes() == TIDY


@pytest.mark.parametrize("arguments", [["format"], ["format", "a.txt", "-c", "wave"], ["explain", "a", "-c", "wave"]])
def test_wrong_options(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    assert capsys.readouterr().err.endswith(f"\nRun 'btc help {arguments[0]}' for help.\n")
