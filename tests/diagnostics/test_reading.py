"""What a text may name: regular files of a limited size below the folder of the mission."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError, render
from btlang.diagnostics.files import MOST_BYTES, read_source
from btlang.text.source import Source

XML = '<root BTCPP_format="4"><include path="{}"/><BehaviorTree ID="M"><AlwaysSuccess/></BehaviorTree></root>'


@pytest.fixture
def folders(tmp_path: Path) -> Path:
    """A folder `mine` for missions, beside a folder `other` with a secret in it."""
    (tmp_path / "mine" / "parts").mkdir(parents=True)
    (tmp_path / "other").mkdir()
    for name in ("other/secret.txt", "mine/parts/near.txt"):
        (tmp_path / name).write_text("dance is nod\nxyzzy\n" if "secret" in name else "dance is nod\n")
    (tmp_path / "other" / "tree.xml").write_text(XML.format("x").replace('<include path="x"/>', "").replace("M", "N"))
    return tmp_path


def run(*command: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(Path(btlang.__file__).parents[1])}
    return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=False)


def reasons(source: Source) -> str:
    with pytest.raises(MissionError) as error:
        btlang.parse_tree(source)
    return "\n".join(map(render, error.value.diagnostics))


OUTSIDE = ["../other/secret.txt", "{}/other/secret.txt", "link.txt", "parts/../../other/secret.txt"]


@pytest.mark.parametrize("path", OUTSIDE)
@pytest.mark.parametrize("form", ['include "{}"\nwave', XML])
def test_what_is_outside_the_folder_is_not_included(folders: Path, path: str, form: str) -> None:
    (folders / "mine" / "link.txt").symlink_to(folders / "other" / "secret.txt")
    mission = folders / "mine" / "mission.txt"
    mission.write_text(form.format(path.format(folders)))
    said = reasons(read_source(str(mission)))
    assert "it is outside the folder of the mission" in said
    assert "xyzzy" not in said


def test_another_root_is_named_on_the_command_line(folders: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folders / "other" / "good.txt").write_text('include "more.txt"\ndance is nod')
    (folders / "other" / "more.txt").write_text("bow is nod")
    mission = folders / "mine" / "mission.txt"
    mission.write_text('include "parts/near.txt"\ninclude "../other/good.txt"\ndance then bow')
    root = ["--include-root", str(folders / "other")]
    assert main(["check", str(mission)]) == 2
    assert main(["check", str(mission), *root]) == 0
    assert main(["check", "-c", f'include "{folders}/other/good.txt"\nbow', *root]) == 0
    assert main(["tree", str(mission), *root, "--parser", "lark"]) == 0
    assert "--include-root" in capsys.readouterr().err


def test_what_a_sender_may_not_read_is_not_shown_to_him(folders: Path) -> None:
    root = str(folders / "other")
    sent = Source('include "secret.txt"\nwave', "mission", root, (root,), hides_includes=True)
    said = reasons(sent)
    assert said == f"{root}/secret.txt:2:1: error BT010 (its text isn't shown here)"


def test_nothing_is_included_where_nothing_may_be() -> None:
    assert "files can't be included here" in reasons(Source('include "/etc/passwd"\nwave', "mission", roots=()))


@pytest.mark.parametrize("form", ['include "{}"\nwave', XML])
def test_pipes_and_devices_are_not_included(folders: Path, form: str) -> None:
    os.mkfifo(folders / "mine" / "pipe")
    mission = folders / "mine" / "mission.txt"
    for path in ("pipe", "parts"):
        mission.write_text(form.format(path))
        assert re.search("it isn't a regular file|is a directory", reasons(read_source(str(mission))))


def test_a_name_that_no_file_can_have() -> None:
    assert "BT001" in reasons(Source('include "a\0b"\nwave'))


def test_long_texts_are_refused(folders: Path) -> None:
    long = folders / "mine" / "long.txt"
    long.write_text("#" * (MOST_BYTES + 1))
    mission = folders / "mine" / "mission.txt"
    mission.write_text('include "long.txt"\nwave')
    assert "more than 10,000,000 bytes" in reasons(read_source(str(mission)))
    with pytest.raises(MissionError, match="more than 10,000,000 bytes"):
        read_source("/dev/zero")


@pytest.mark.parametrize("option", [["--keywords", "/dev/zero"], ["--world", "/dev/zero"], []])
def test_endless_files_of_the_command_line_are_refused(option: list[str]) -> None:
    command = ["check", *option, "-c", "wave"] if option else ["check", "/dev/zero"]
    done = run(sys.executable, "-m", "btlang", *command)
    assert done.returncode == 2
    assert "more than 10,000,000 bytes" in done.stderr


def test_pipes_of_the_command_line_are_read(tmp_path: Path) -> None:
    (tmp_path / "words.toml").write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "btlang.actions.speech:say"\n')
    world = Path(btlang.__file__).parent / "robots" / "worlds" / "default.toml"
    given = f'--world <(cat "{world}") --keywords <(cat "{tmp_path}/words.toml") <(echo "go to the lobby")'
    done = run("bash", "-c", f'"{sys.executable}" -m btlang run --speed max {given}')
    assert (done.returncode, done.stderr) == (0, "")


def test_many_files_in_a_row_are_no_circle(tmp_path: Path) -> None:
    for number in range(60):
        (tmp_path / f"{number}.txt").write_text(f'include "{number + 1}.txt"\nwave')
    said = reasons(read_source(str(tmp_path / "0.txt")))
    assert "more than 50 files include each other in a row" in said
    assert "BT046" not in said
