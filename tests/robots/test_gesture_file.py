"""Gesture files: what they make, and what is wrong with them."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.robots.bodies.body_file import BodyError, load_body
from btlang.robots.bodies.gesture import Gesture, KeyFrame
from btlang.robots.bodies.gesture_file import GestureError, load_gestures
from btlang.text.source import Source
from tests.robots.motion.bodies import GUIDE, guide

NOD = 'stroke = 0.4\n[[frame]]\nat = 0.4\n"head tilt" = -15\n[[frame]]\nat = 0.8\nhold = 0.2\n"head tilt" = 0\n'
RIGHT = '[[frame]]\nat = 0.5\n"right elbow" = 90\n"head turn" = 20\n"waist tilt" = 5\n'
POINT = 'aim = "right arm"\n[[frame]]\nat = 0.8\n"right shoulder lift" = 80\n"right shoulder spread" = "-bearing"\n'


def read(text: str, name: str = "a_nod.toml") -> tuple[Gesture, ...]:
    return load_gestures(Source(text, name), guide().joints)


def test_a_file_has_key_frames_and_what_they_are_called() -> None:
    (nod,) = read('phrase = ["nod", "nod [your] head"]\nhelp = "Nods."\nleast = 0.5\nmost = 2\n' + NOD)
    assert nod == Gesture(
        "a nod", (KeyFrame(0.4, {"head tilt": -15}), KeyFrame(0.8, {"head tilt": 0}, 0.2)), 0.4,
        ("nod", "nod [your] head"), "Nods.", "", 0.5, 2.0, None, "a_nod.toml",
    )  # fmt: skip
    assert nod.seconds == 1.0


def test_the_stroke_is_at_the_first_key_frame_and_the_name_is_the_phrase_where_nothing_is_said() -> None:
    (nod,) = read(NOD.replace("stroke = 0.4\n", 'name = "a bow"\n'))
    assert (nod.name, nod.phrases, nod.stroke, nod.least, nod.most) == ("a bow", ("a bow",), 0.4, 0.7, 1.5)


def test_key_frames_between_two_times_are_repeated() -> None:
    frames = "".join(
        f'[[frame]]\nat = {at}\n"head tilt" = {tilt}\n' for at, tilt in ((0.4, -9), (0.6, -3), (0.8, -9), (1.2, 0))
    )
    (nod,) = read("stroke = 1.2\nrepeat = { from = 0.4, to = 0.8, times = 3 }\n" + frames)
    assert [round(frame.at, 6) for frame in nod.frames] == [0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6, 2.0]
    assert [frame.joints["head tilt"] for frame in nod.frames] == [-9, -3, -9, -3, -9, -3, -9, 0]
    assert nod.stroke == pytest.approx(2.0)  # its key frame comes later


def test_a_gesture_has_a_mirror_image() -> None:
    _, left = read('mirror = true\nphrase = ["raise right hand"]\n' + RIGHT, "raise_the_right_hand.toml")
    assert (left.name, left.phrases) == ("raise the left hand", ("raise left hand",))
    assert left.frames[0].joints == {"left elbow": 90, "head turn": -20, "waist tilt": 5}


def test_the_nearer_arm_points() -> None:
    (point,) = read('mirror = "nearer"\n' + POINT)
    assert point.towards(-10) is point
    assert point.towards(0) is point
    assert point.towards(10).aim == "left arm"
    assert point.towards(10).frames[0].joints == {"left shoulder lift": 80, "left shoulder spread": "bearing"}


FRAME = '[[frame]]\nat = 0.5\n"head tilt" = 0\n'


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", None, "a gesture needs key frames; write [[frame]]"),
        ("[[frame]\n", 1, "this isn't TOML"),
        ('[[frame]]\nat = 1\n"tail" = 3\n', 3, 'the robot has no joint "tail"; its joints are waist turn, waist tilt'),
        ('[[frame]]\nat = 1\n"head tilt" = 41\n', 3, '"head tilt" must be from -40 to 40, not 41'),
        ('[[frame]]\nat = 1\n"head tilt" = "up"\n', 3, '"head tilt" must be one of "bearing", "-bearing"'),
        ('[[frame]]\n"head tilt" = 1\n', 1, 'frame needs a number "at"'),
        ("[[frame]]\nat = 1\n", 2, 'a key frame needs joints; write "head tilt" = -15'),
        (FRAME + FRAME, 5, "key frames follow each other: this one must be at 0.55 or later, not at 0.5"),
        (FRAME.replace("0.5", "0.01"), 2, '"at" must be from 0.05 to 60, not 0.01'),
        ("stroke = 0.6\n" + FRAME, 1, '"stroke" must be from 0 to 0.5, not 0.6'),
        ("least = 2\n" + FRAME, 1, '"least" must be from 0.2 to 1, not 2'),
        ("most = 0.5\n" + FRAME, 1, '"most" must be from 1 to 10, not 0.5'),
        ('aim = "tail"\n' + FRAME, 1, '"aim" must be one of "waist", "head", "left arm", "right arm"'),
        ('phrase = "[nod]"\n' + FRAME, 1, "the phrase '[nod]' has no required word"),
        ("phrase = []\n" + FRAME, 1, '"phrase" must be one phrase or a list of them'),
        ('phrase = "nod at {person}"\n' + FRAME, 1, "the slot of a gesture is {target}"),
        ('phrase = "nod at {target}"\n' + FRAME, 1, "needs to know what points at it"),
        ("colour = 1\n" + FRAME, 1, 'unknown key "colour" in a gesture'),
        ("repeat = { from = 0, to = 0.5, times = 99 }\n" + FRAME, 1, '"times" must be from 1 to 50'),
        ("repeat = { from = 0, to = 0.5, times = 1.5 }\n" + FRAME, 1, '"times" must be a whole number'),
        ("repeat = { from = 0, to = 0.2, times = 2 }\n" + FRAME, 1, "there is no key frame between these times"),
        ("repeat = { from = 0, to = 0.5, times = 2 }\n" + FRAME + "hold = 1\n", 1, "is held until 1.5; repeat up"),
        ("repeat = { from = 0, to = 20, times = 9 }\n" + FRAME + "hold = 19.5\n", None, "takes at most 60 seconds"),
        ("mirror = true\n" + FRAME, 1, 'mirror = true needs "left" or "right" in the name, not "a nod"'),
        ('mirror = "nearer"\n' + FRAME, 1, 'mirror = "nearer" is for an "aim" that is left or right'),
        ('mirror = "both"\n' + FRAME, 1, '"mirror" must be one of "nearer"'),
    ],
)  # fmt: skip
def test_what_may_be_wrong(text: str, line: int | None, says: str) -> None:
    with pytest.raises(GestureError) as caught:
        read(text)
    assert says in caught.value.message
    assert (caught.value.line, caught.value.path) == (line, "a_nod.toml")


def robot_file(folder: Path, gestures: str, **files: str) -> str:
    (folder / "gestures").mkdir()
    for name, text in files.items():
        (folder / "gestures" / f"{name}.toml").write_text(text)
    files = ("gestures =", "world =", "rules =", "missions =", "schedules =")
    text = re.sub(r"\[\[component\]\]\n(.+\n)*", "", GUIDE.read_text())
    kept = [line for line in text.splitlines() if not line.startswith(files)]
    path = folder / "robot.toml"
    path.write_text("\n".join((gestures, *kept)))
    return str(path)


def test_a_robot_file_names_files_and_folders(tmp_path: Path) -> None:
    path = robot_file(tmp_path, 'gestures = ["gestures"]', nod=NOD, raise_the_right_hand="mirror = true\n" + RIGHT)
    assert [*load_body(path).gestures] == ["nod", "raise the right hand", "raise the left hand"]


@pytest.mark.parametrize("named", ['"../gestures"', '"/etc"', '"none.toml"', '"\\u0000"'])
def test_only_what_is_in_the_folder_of_the_robot_file(tmp_path: Path, named: str) -> None:
    path = robot_file(tmp_path, f"gestures = [{named}]", nod=NOD)
    with pytest.raises(BodyError, match="must be files and folders in the folder of the robot file"):
        load_body(path)


def test_a_text_from_outside_names_no_files(tmp_path: Path) -> None:
    path = Path(robot_file(tmp_path, 'gestures = ["gestures"]', nod=NOD))
    with pytest.raises(BodyError, match="must be files and folders in the folder of the robot file"):
        load_body(Source(path.read_text(), str(path)))


def test_gestures_that_clash(tmp_path: Path) -> None:
    path = robot_file(
        tmp_path, 'gestures = ["gestures"]', bow='phrase = "nod [your] head"\n' + NOD,
        clap='phrase = "nod the head"\n' + NOD, take='name = "bow"\nphrase = "c d"\n' + NOD,
    )  # fmt: skip
    with pytest.raises(
        GestureError, match='"nod head" is said for the gesture "bow" too; change one of them'
    ) as caught:
        load_body(path)
    assert [error.message for error in caught.value.more] == [
        'there is another gesture "bow"; give one of them another "name"'
    ]


KEYS = [
    "phrase",
    "stroke",
    "least",
    "aim",
    "mirror",
    "repeat",
    "name",
    "frame",
    "at",
    "hold",
    "head tilt",
    "left elbow",
]
VALUES = st.recursive(
    st.one_of(st.integers(-100, 100), st.floats(), st.booleans(), st.text(max_size=8), st.sampled_from(KEYS)),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.sampled_from(KEYS), inner, max_size=4)),
    max_leaves=8,
)


def toml(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {toml(each)}" for key, each in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return str(value) if isinstance(value, float) else json.dumps(value)


@given(st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=5), st.text(max_size=20))
def test_any_file_is_read_or_refused(values: dict[str, object], more: str) -> None:
    for text in ("\n".join(f"{json.dumps(key)} = {toml(each)}" for key, each in values.items()), more):
        try:
            made = read(text)
        except GestureError:
            continue
        assert all(gesture.frames and gesture.stroke <= gesture.seconds for gesture in made)
