"""Robot files: what they say, and what is said of those that are wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.robots.bodies.body import Breathing, Capsule, Idle, RosNode
from btlang.robots.bodies.body_file import BodyError, load_body, shipped_bodies, standard_body
from btlang.vocabulary.shipped import BODIES

DOCK = "[dock]\nwithin = 0.2\nbeyond = 0.3\nbacks_off = 0.4\n"
HEAD = 'name = "x"\nradius = 0.2\n'
LIMITS = "{ speed = 1, top_speed = 2, acceleration = 1, slowing = 1, brake = 1, hard_brake = 1 }"
BASE = f"[base]\ndriving = {LIMITS}\nturning = {LIMITS}\nwheel_gap = 0.3\n"
JOINT = '[[joints]]\nname = "neck"\npart = "head"\nlow = -10\nhigh = 10\nspeed = 1\n'
NODE = '[[component]]\nname = "arm driver"\nnode = "/arm_driver"\n'
IN_CONTAINER = """[[component]]
name = "eye"
node = "/left/eye"
container = "/box"
package = "camera"
plugin = "camera::Driver"
"""


def written(folder: Path, text: str) -> str:
    path = folder / "robot.toml"
    path.write_text(text)
    return str(path)


def test_the_robot_that_ships_is_a_file_like_any_other() -> None:
    body = standard_body()
    assert body == load_body(f"{BODIES}/standard.toml")
    assert body.radius == 0.2
    assert (body.driving.speed, body.driving.top_speed, body.turning.speed) == (0.5, 1.0, 90.0)
    assert {joint.part for joint in body.joints} == {"left arm", "right arm", "head"}
    assert body.bearing_joint("look at") == body.joint("head turn")
    assert "small" in shipped_bodies()


def test_a_robot_needs_a_name_and_a_radius_alone(tmp_path: Path) -> None:
    body = load_body(written(tmp_path, HEAD))
    assert (body.name, body.radius, body.over) == ("x", 0.2, "simulated")
    assert not any(map(body.has, ("base", "pose", "navigation", "joints", "hand", "battery", "voice", "screen")))


def test_parts_are_what_words_need(tmp_path: Path) -> None:
    text = HEAD + BASE + JOINT + '[[joints]]\nname = "a"\npart = "lift"\nlow = 0\nhigh = 1\nspeed = 1\n'
    body = load_body(written(tmp_path, text + "[postures]\nup = { a = 1 }\n"))
    assert all(map(body.has, ("base", "pose", "joints", "head", "lift", "posture up")))
    assert not any(map(body.has, ("navigation", "left arm", "scanner", "posture down")))


def test_a_component_is_a_class_or_a_node(tmp_path: Path) -> None:
    text = HEAD + NODE + 'command = ["ros2", "run", "arm", "driver"]\n' + IN_CONTAINER
    first, second = load_body(written(tmp_path, text)).components
    assert first.node == RosNode("/arm_driver", ("ros2", "run", "arm", "driver"))
    assert (first.place, second.place) == ("/arm_driver", "/left/eye")
    assert second.node == RosNode("/left/eye", (), "/box", "camera", "camera::Driver")


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", None, 'a robot needs a text "name"'),
        ('name = "x"', None, 'a robot needs a number "radius"'),
        (HEAD + NODE + 'class = "arm:Arm"', 6, 'a component has a "class" or a "node", not both'),
        (HEAD + NODE + 'runs = "here"', 6, 'so it has no "runs"'),
        (
            HEAD + NODE.replace("/arm_driver", "arm driver"),
            5,
            'the full name of a ROS 2 node; write node = "/arm_driver"',
        ),
        (HEAD + IN_CONTAINER + 'command = ["eye"]', 9, 'by a "command" or loaded into a "container", not both'),
        ('name = "x"\nradius = "0.2"', 2, '"radius" must be a number; write radius = 0.2'),
        ('name = "x"\nradios = 0.2', 2, 'unknown key "radios" in a robot; it needs a number "radius"'),
        (HEAD + IN_CONTAINER.replace("plugin", "#"), 3, 'needs a text "plugin"'),
        (HEAD + "legs = 2", 3, 'unknown key "legs" in a robot'),
        (HEAD + 'over = "tcp"', 3, '"over" must be one of "simulated", "devices", "ros", "actions"'),
        (HEAD + "[base]\nwheel_gap = 1", 3, 'base needs a table "driving"'),
        (HEAD + BASE.replace("speed = 1,", "speed = 3,"), 4, '"top_speed" must be at least 3, not 2'),
        (HEAD + BASE + "[navigation]\npeople = 1\nobjects = 0.1", 9, '"objects" must be at least 0.2, not 0.1'),
        (HEAD + JOINT.replace("high = 10", "high = -20"), 7, '"high" must be at least -10, not -20'),
        (HEAD + JOINT + "rest = 11", 9, '"rest" must be from -10 to 10, not 11'),
        (HEAD + JOINT.replace('"head"', '"docking"'), 5, '"docking" has another meaning'),
        (HEAD + JOINT + JOINT, 10, '"neck" is given twice in joints'),
        (HEAD + JOINT + "[postures]\nup = { nek = 1 }", 10, 'the robot has no joint "nek"; its joints are neck'),
        (HEAD + JOINT + "[postures]\nup = [\n{ neck = 1 },\n{ neck = 99 },\n]", 12, '"neck" must be from -10 to 10'),
        (HEAD + JOINT + '[postures]\nup = { neck = "left" }', 10, '"neck" must be one of "bearing"'),
        (HEAD + '[[hands]]\nname = "middle"', 4, '"name" must be one of "left", "right"'),
        (HEAD + '[[sensors]]\nkind = "scanner"\nframe = "laser"', 3, 'sensors needs a number "range"'),
        (HEAD + "[dock]\nwithin = 0.2\nbeyond = 0.1", 5, '"beyond" must be at least 0.2, not 0.1'),
        (HEAD + DOCK + "staging = 0.1", 7, '"staging" must be from 0.2 to 100, not 0.1'),
        (HEAD + DOCK + "retries = -1", 7, '"retries" must be from 0 to 100, not -1'),
        (HEAD + "screen = 1", 3, '"screen" must be true or false'),
        ("name = = 3", 1, "this isn't TOML: Invalid value (at line 1, column 8)"),
    ],
)
def test_what_may_be_wrong(tmp_path: Path, text: str, line: int | None, message: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(BodyError) as caught:
        load_body(path)
    assert message in caught.value.message
    assert (caught.value.line, caught.value.path) == (line, path)


def test_a_misspelt_key_is_one_mistake(tmp_path: Path) -> None:
    with pytest.raises(BodyError) as raised:
        load_body(written(tmp_path, 'name = "x"\nradios = 0.2'))
    assert [raised.value.message, *(each.message for each in raised.value.more)] == [
        'unknown key "radios" in a robot; it needs a number "radius"'
    ]


def test_unreadable_files(tmp_path: Path) -> None:
    with pytest.raises(BodyError, match="cannot read the robot file: No such file"):
        load_body(str(tmp_path / "none.toml"))


LINK = 'link = "{}"\nparent = "{}"\nat = [0, 0, 1]\naxis = [0, 0, 2]\n'
TORSO = JOINT + LINK.format("torso", "base")
CAPSULE = '[[capsules]]\nlink = "torso"\nstart = [0, 0, 0]\nend = [0, 0, 1]\nradius = 0.1\n'


def test_links_capsules_and_what_may_not_touch(tmp_path: Path) -> None:
    rates = "acceleration = 20\njerk = 200\n"
    pairs = 'forbidden = [["torso", "base"]]\n'
    shapes = CAPSULE + CAPSULE.replace('"torso"', '"base"')
    body = load_body(written(tmp_path, HEAD + pairs + TORSO + rates + shapes))
    joint = body.joints[0]
    assert (joint.link, joint.parent, joint.at, joint.axis) == ("torso", "", (0, 0, 1), (0, 0, 1))
    assert (joint.acceleration, joint.jerk) == (20, 200)
    assert body.capsules == (Capsule("torso", (0, 0, 0), (0, 0, 1), 0.1), Capsule("", (0, 0, 0), (0, 0, 1), 0.1))
    assert body.forbidden == (("torso", ""),)


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        (JOINT + "jerk = 5\n", 9, 'a joint with "jerk" needs "acceleration" too'),
        (JOINT + "acceleration = 5\n", 9, 'a joint with "acceleration" needs "jerk" too'),
        (JOINT + LINK.format("torso", "hips"), 10, 'there is no link "hips"; the links are "base", "torso"'),
        (JOINT + LINK.format("torso", "torso"), 10, "its parents form a circle"),
        (JOINT + LINK.format("base", "base"), 9, '"base" is the link that no joint moves'),
        (TORSO + TORSO.replace("neck", "hip"), 19, 'two joints move the link "torso"'),
        (TORSO.replace("[0, 0, 2]", "[0, 0, 0]"), 12, '"axis" must point somewhere'),
        (TORSO.replace("[0, 0, 2]", "[0, 0]"), 12, "metres ahead, left and up"),
        (TORSO.replace("[0, 0, 2]", "[nan, 0, 1]"), 12, "metres ahead, left and up"),
        (TORSO + CAPSULE.replace("torso", "tail"), 14, 'there is no link "tail"'),
        (TORSO + CAPSULE.replace("0.1", "0"), 17, '"radius" must be at least 0.001'),
        ('forbidden = [["torso", "base"]]\n' + TORSO + CAPSULE, 3, 'no capsule has the link "base"'),
        ('forbidden = [["torso", "torso"]]\n' + TORSO + CAPSULE, 3, "a link can't touch itself"),
        ('forbidden = ["torso"]\n' + TORSO + CAPSULE, 3, "must be a list of pairs of links"),
        (JOINT + JOINT.replace("neck", "a") + "acceleration = 2\njerk = 2\n", 10, "either all joints have"),
    ],
)
def test_links_that_do_not_fit_together_have_a_line(tmp_path: Path, text: str, line: int, says: str) -> None:
    with pytest.raises(BodyError) as caught:
        load_body(written(tmp_path, HEAD + text))
    assert says in str(caught.value)
    assert caught.value.line == line


SMOOTH = "acceleration = 100\njerk = 1000\n"
BREATHING = '[idle]\nbreathing = { joint = "neck", by = 2, every = 9 }\n'


@pytest.mark.parametrize(
    ("joint", "idle", "says"),
    [
        ("", BREATHING, 'robot.toml:9: only joints with an "acceleration" and a "jerk" can move'),
        (SMOOTH, BREATHING.replace("neck", "tail"), 'robot.toml:12: "joint" must be one of "neck"'),
        (SMOOTH, BREATHING.replace("= 2", "= 11"), 'robot.toml:12: "by" must be from 0.001 to 10, not 11'),
        (SMOOTH, BREATHING.replace("= 2", "= 0"), 'robot.toml:12: "by" must be from 0.001 to 10, not 0'),
        (SMOOTH, BREATHING.replace("= 9", "= 0.5"), 'robot.toml:12: "every" must be from 1 to 60, not 0.5'),
        (SMOOTH, BREATHING.replace("= 2", "= 9"), 'the neck can\'t go so fast; "every" must be at least 86'),
        (SMOOTH, "[idle]\nlook_at_speaker = true\n", '"look_at_speaker" needs the posture "look at"'),
        (SMOOTH, "[idle]\ndance = true\n", 'unknown key "dance"'),
        (SMOOTH, "[idle]\nlook_at_speaker = 1\n", '"look_at_speaker" must be true or false'),
    ],
)
def test_what_is_wrong_with_idle_movements(tmp_path: Path, joint: str, idle: str, says: str) -> None:
    with pytest.raises(BodyError) as caught:
        load_body(written(tmp_path, HEAD + JOINT + joint + idle))
    assert says in str(caught.value)


def test_idle_movements(tmp_path: Path) -> None:
    body = load_body(written(tmp_path, HEAD + JOINT + SMOOTH + BREATHING.replace("9", "30")))
    assert body.idle == Idle(Breathing("neck", 2.0, 30.0))
