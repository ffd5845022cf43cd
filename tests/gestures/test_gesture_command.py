"""`btc gesture` as it is typed."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from btlang.cli import main
from tests.robots.motion.bodies import GUIDE

ROBOT = ["--robot", str(GUIDE)]
FAST = '[[frame]]\nat = 0.5\n"head tilt" = -10\n[[frame]]\nat = 0.6\n"head tilt" = 20\n'
TOUCHES = (
    '[[frame]]\nat = 1.0\n"right elbow" = 10\n'
    '[[frame]]\nat = 2\n"right shoulder lift" = 40\n"right arm turn" = 90\n"right elbow" = 130\n'
)


def typed(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    try:
        code = main(["gesture", *words])
    except SystemExit as ended:
        code = int(ended.code or 0)
    found = capsys.readouterr()
    return code, found.out + found.err


def test_check_of_a_robot_and_of_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert typed(capsys, "check", str(GUIDE)) == (0, "No problems found.\n")
    assert typed(capsys, "check", str(GUIDE.parent / "gestures/bow.toml")) == (0, "No problems found.\n")


@pytest.mark.parametrize(
    ("text", "code", "says"),
    [
        (FAST, 2, 'fast.toml:5:1: error BT077: The gesture \'fast\' takes '),
        (TOUCHES, 2, "fast.toml:5:1: error BT076: This gesture can't be used: fast: the right "),
        (FAST.replace("tilt", "tail"), 2, 'fast.toml:3:1: error BT076: This gesture can\'t be used: the robot has'),
    ],
)  # fmt: skip
def test_what_check_finds_is_at_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, code: int, says: str
) -> None:
    (tmp_path / "fast.toml").write_text(text)
    found, lines = typed(capsys, "check", str(tmp_path / "fast.toml"), *ROBOT)
    assert says in lines
    assert found == code


def test_play(capsys: pytest.CaptureFixture[str]) -> None:
    code, lines = typed(capsys, "play", "bow", "--speed", "max", *ROBOT)
    assert code == 0
    assert "gestures bow" in lines
    code, lines = typed(capsys, "play", "point at", "--at", "the statue", "--speed", "max", *ROBOT)
    assert code == 0
    assert "done   point at statue" in lines


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("play", "point at", *ROBOT), 'the gesture "point at" needs --at TARGET'),
        (("play", "bow", "--at", "Greta", *ROBOT), 'the gesture "bow" takes no --at'),
        (("play", "bov", *ROBOT), "The robot 'guide' has no gesture \"bov\""),
        (("play", "bow"), "play needs --robot FILE"),
        (("play", "finger", "to", "lips", *ROBOT), 'put its name in quotes: btc gesture play "finger to lips"'),
        (("picture", "bow", *ROBOT), "picture needs -o OUT"),
        (("check", "bow.toml", "-o", "x.png"), "-o isn't for check"),
        (("dance", "bow"), "there's no act 'dance'"),
    ],
)
def test_what_is_refused(capsys: pytest.CaptureFixture[str], words: tuple[str, ...], says: str) -> None:
    code, lines = typed(capsys, *words)
    assert (code, says in lines) == (2, True), lines


@pytest.mark.parametrize(("kind", "begins"), [("svg", b"<svg"), ("png", b"\x89PNG"), ("gif", b"GIF89a")])
def test_pictures(tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, begins: bytes) -> None:
    pytest.importorskip("matplotlib")
    path = tmp_path / f"nod.{kind}"
    assert typed(capsys, "picture", "nod", "-o", str(path), *ROBOT) == (0, f"Wrote {path}.\n")
    assert path.read_bytes().startswith(begins)


def test_poses_that_are_typed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "peek.toml"
    lines = "head tilt = -10\n\nhead tilt = 99\ntail = 1\nhead tilt = 0, head turn = 20\nend\nhead tilt = 5\n"
    monkeypatch.setattr("sys.stdin", io.StringIO(lines))
    code, said = typed(capsys, "record", "peek", "-o", str(path), *ROBOT)
    assert code == 0
    assert "The robot runs simulated, so nobody can move it by hand." in said
    assert '"head tilt" must be a number from -40 to 40' in said
    assert 'the robot has no joint "tail"' in said
    assert f"Wrote {path}: 2 key frames." in said
    assert typed(capsys, "check", str(path), *ROBOT) == (0, "No problems found.\n")
    assert path.read_text() == (
        'name = "peek"\n\n[[frame]]\nat = 0.5\n"head tilt" = -10\n'
        '\n[[frame]]\nat = 1\n"head tilt" = 0\n"head turn" = 20\n'
    )


def test_without_a_pose_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    code, said = typed(capsys, "record", "peek", "-o", str(tmp_path / "peek.toml"), *ROBOT)
    assert (code, "nothing was written" in said) == (1, True)
    assert not (tmp_path / "peek.toml").exists()
