"""URDF out and in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from btlang.cli import main
from btlang.robots.bodies.body_file import BodyError, load_body
from btlang.robots.bodies.urdf import urdf
from btlang.robots.bodies.urdf_reader import read_urdf
from btlang.text.source import Source
from tests.robots.motion.bodies import GUIDE, guide


@pytest.fixture
def typed(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    def call(*words: str) -> tuple[int, str, str]:
        code = main([*words])
        found = capsys.readouterr()
        return code, found.out, found.err

    return call


LIMIT = '<limit lower="-1" upper="1" velocity="2"/>'
ARM = f"""<robot name="my_arm"><link name="base_link"/><link name="flange"/><link name="upper_arm">
<collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.05" length="0.4"/></geometry></collision></link>
<joint name="mount" type="fixed"><parent link="base_link"/><child link="flange"/>
<origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/></joint>
<joint name="shoulder_lift" type="revolute"><parent link="flange"/><child link="upper_arm"/>
<origin xyz="0.1 0 0"/><axis xyz="1 0 0"/>{LIMIT}</joint>
</robot>"""


def test_what_is_written_is_read_as_it_was(tmp_path: Path) -> None:
    found = read_urdf(Source(urdf(guide()), "guide.urdf"))
    assert found.capsules == guide().capsules
    again = tmp_path / "again.toml"
    again.write_text(found.toml())
    joints = {joint.name: joint for joint in load_body(str(again)).joints}
    assert joints.keys() == {joint.name for joint in guide().joints}
    for joint in guide().joints:
        read = joints[joint.name]
        assert (read.link, read.parent, read.at, read.axis) == (joint.link, joint.parent, joint.at, joint.axis)
        assert (read.low, read.high, read.speed) == pytest.approx((joint.low, joint.high, joint.speed))


def test_what_is_fixed_is_a_piece_of_what_carries_it() -> None:
    found = read_urdf(Source(ARM, "arm.urdf"))
    (joint,), (capsule,) = found.joints, found.capsules
    assert (joint.name, joint.link, joint.parent) == ("shoulder lift", "upper arm", "")
    assert (joint.at, joint.axis) == ((0.0, 0.1, 1.0), (0.0, 1.0, 0.0))
    assert joint.high == pytest.approx(57.29578)
    assert (capsule.link, capsule.start, capsule.end) == ("upper arm", (0.0, 0.0, 0.0), (0.0, 0.0, 0.4))


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ('<robot name="my_arm">', "<robot", 1, "this isn't XML: "),
        ("robot", "body", 1, "this isn't URDF: it begins with <body>"),
        ("<robot", '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot', 1, "no DOCTYPE"),
        ('parent link="flange"', 'parent link="hip"', 5, 'there is no link "hip"'),
        ('<child link="upper_arm"/>', "", 5, "needs a <child> link"),
        ("revolute", "screw", 5, 'type "screw" can\'t be read'),
        ("<link", "<xacro:include filename='wheel.xacro'/><link", 1, "this is xacro, which makes URDF"),
        ('radius="0.05"', 'radius="${r / 2}"', 2, 'this is xacro, which makes URDF: "radius" is an expression'),
        ("robot", "sdf", 1, "this is SDF, the format of Gazebo"),
        (LIMIT, "", 5, 'the joint "shoulder_lift" needs a <limit>'),
        ('upper="1"', 'upper="-3"', 6, "leaves it no room"),
        ('upper="1"', 'upper="nan"', 6, '"upper" of <limit> must be a number'),
        ('xyz="1 0 0"', 'xyz="0 0 0"', 6, "points nowhere"),
        ('radius="0.05"', 'radius="wide"', 2, '"radius" of <cylinder> must be a number'),
        ('parent link="base_link"', 'parent link="upper_arm"', 1, "form a circle"),
        ('<link name="base_link"/>', "", 3, 'there is no link "base_link"'),
        ('<link name="base_link"/>', '<link name="base_link"/><link name="wheel"/>', 1, "2 links have none"),
    ],
)
def test_what_cannot_be_read_has_a_line(old: str, new: str, line: int, says: str) -> None:
    with pytest.raises(BodyError) as caught:
        read_urdf(Source(ARM.replace(old, new), "arm.urdf"))
    assert says in str(caught.value)
    assert caught.value.line == line


def test_the_command_writes_and_reads(typed: Callable[..., tuple[int, str, str]], tmp_path: Path) -> None:
    code, text, _ = typed("robot", "urdf", str(GUIDE))
    assert (code, text) == (0, urdf(guide()))
    written = tmp_path / "guide.urdf"
    written.write_text(text)
    code, text, _ = typed("robot", "import", str(written))
    assert code == 0
    (tmp_path / "guide.toml").write_text(text)
    assert typed("robot", "check", str(tmp_path / "guide.toml"))[:2] == (0, "No problems found.\n")
    written.write_text("<robot>")
    code, _, problem = typed("robot", "import", str(written))
    assert code == 2
    assert f"{written}:1:1: error BT071: This robot file can't be used: this isn't XML: no element found" in problem


WHEEL = '<collision><geometry><cylinder radius="0.05" length="0.02"/></geometry></collision>'
ROVER = f"""<!-- made by hand -->
<?xml version="1.0"?>
<robot name="rover" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:arg name="ns" default=""/>
<link name="${{ns}}base_link"><collision><origin xyz="-0.1 0 0.1"/><geometry><box size="0.4 0.2 0.1"/></geometry>
</collision></link>
<link name="left_wheel">{WHEEL}</link><link name="right_wheel">{WHEEL}</link><link name="tail_caster"/>
<link name="lidar_link"/><link name="head"/>
<joint name="left_joint" type="continuous"><parent link="${{ns}}base_link"/><child link="left_wheel"/>
<origin xyz="0 0.15 0.05" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="right_joint" type="continuous"><parent link="base_link"/><child link="right_wheel"/>
<origin xyz="0 -0.15 0.05" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="tail" type="continuous"><parent link="base_link"/><child link="tail_caster"/>
<origin xyz="-0.2 -0.4 0"/></joint>
<joint name="front" type="fixed"><parent link="base_link"/><child link="lidar_link"/>
<origin xyz="0.1 0 0.2" rpy="0 0 3.14159265"/></joint>
<joint name="neck" type="continuous"><parent link="base_link"/><child link="head"/></joint>
PLUGIN</robot>"""
PLUGIN = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
<wheel_separation>0.28</wheel_separation><wheel_diameter>0.1</wheel_diameter><max_linear_velocity>0.8</max_linear_velocity></plugin></gazebo>
<gazebo reference="lidar_link"><sensor type="gpu_lidar" name="scan">
<lidar><scan><horizontal><min_angle>-1.5708</min_angle><max_angle>1.5708</max_angle></horizontal></scan><range><min>0.1</min><max>12</max></range></lidar></sensor></gazebo>"""


def test_wheels_are_a_base_and_no_joints(tmp_path: Path) -> None:
    found = read_urdf(Source(ROVER.replace("PLUGIN", ""), "rover.urdf"))
    assert [joint.name for joint in found.joints] == ["neck"]
    assert (found.joints[0].low, found.joints[0].high) == (-180.0, 180.0)
    assert found.gap == 0.3  # the caster is farther out
    assert found.radius == 0.317  # to the corners of the box behind
    assert found.notes == (
        'the joint "neck" has no top speed; 57 degrees per second is a guess',
        "the wheels are 0.3 m apart, by the places of their joints",
        "the speeds and accelerations of the base are guesses",
        'the link "lidar_link" is taken for a laser scanner that sees 8 m',
        "names are without expressions such as ${namespace}, which a launch file fills in",
    )
    (tmp_path / "rover.toml").write_text(found.toml())
    body = load_body(str(tmp_path / "rover.toml"))
    assert body.base is not None
    assert (body.base.wheel_gap, body.driving.top_speed) == (0.3, 0.5)
    [scanner] = body.sensors
    assert (scanner.frame, scanner.ahead, scanner.angle, scanner.range) == ("lidar_link", 0.1, 180.0, 8.0)


def test_plugins_say_more_of_wheels_and_scanners() -> None:
    found = read_urdf(Source(ROVER.replace("PLUGIN", PLUGIN), "rover.urdf"))
    assert found.notes[1:3] == (
        'the wheels are 0.28 m apart, 0.05 m in radius, as the plugin "drive" has it',
        "the accelerations of the base are guesses",
    )
    assert found.drive is not None
    assert (found.gap, found.drive.speed) == (0.28, 0.8)
    [scanner] = found.scanners
    assert (scanner.range, round(scanner.view)) == (12.0, 180)


TRIANGLES = [(-0.1, -0.2, 0.0), (0.3, 0.2, 0.0), (0.1, 0.0, 0.5)]
MESH_ROBOT = """<robot name="r"><link name="base_link"><collision><origin xyz="1 0 0"/>
<geometry><mesh filename="FILE" scale="2 2 2"/></geometry></collision></link></robot>"""


@pytest.mark.parametrize("name", ["body.stl", "text.stl", "body.obj"])
def test_meshes_of_the_package_have_their_bounds(tmp_path: Path, name: str) -> None:
    (tmp_path / "package.xml").write_text("<package/>")
    for folder in ("meshes", "urdf"):
        (tmp_path / folder).mkdir()
    facet = np.array([(0, 0, 0), *TRIANGLES], dtype="<f4").tobytes() + b"\0\0"
    lines = [" ".join(map(str, corner)) for corner in TRIANGLES]
    content = {
        "body.stl": b"\0" * 80 + (1).to_bytes(4, "little") + facet,
        "text.stl": ("solid a\n" + "".join(f"  vertex {line}\n" for line in lines)).encode(),
        "body.obj": "".join(f"v {line}\n" for line in lines).encode(),
    }[name]
    (tmp_path / "meshes" / name).write_bytes(content)
    path = tmp_path / "urdf" / "r.urdf"
    path.write_text("")
    for file in (f"package://some_robot/meshes/{name}", f"../meshes/{name}"):
        found = read_urdf(Source(MESH_ROBOT.replace("FILE", file), str(path)))
        [capsule] = found.capsules
        assert (*capsule.start, *capsule.end) == pytest.approx((1.2, 0, 0, 1.2, 0, 1.0), abs=1e-6)
        assert found.radius == pytest.approx(1.65, abs=0.002)


@pytest.mark.parametrize("file", ["package://other/no.stl", "../../secret.stl", "body.dae", "/etc/hostname", "bad.stl"])
def test_a_mesh_that_cannot_be_read_is_named(tmp_path: Path, file: str) -> None:
    (tmp_path / "secret.stl").write_text("vertex 0 0 0")
    folder = tmp_path / "robot" / "urdf"
    folder.mkdir(parents=True)
    (folder / "r.urdf").write_text("")
    (folder / "bad.stl").write_text("vertex a b c")
    found = read_urdf(Source(MESH_ROBOT.replace("FILE", file), str(folder / "r.urdf")))
    assert found.capsules == ()
    assert f"{file.rpartition('/')[2]} (base_link)" in found.notes[-1] + found.notes[0]
    assert found.radius == 0.2


def test_limits_that_say_nothing(tmp_path: Path) -> None:
    endless = ARM.replace(LIMIT, '<limit lower="-1e16" upper="1e16" velocity="2"/>')
    assert read_urdf(Source(endless, "arm.urdf")).joints[0].high == 180.0
    rigid = read_urdf(Source(ARM.replace(LIMIT, '<limit effort="1" velocity="2"/>'), "arm.urdf"))
    assert (rigid.joints, rigid.notes[0]) == ((), 'the joint "shoulder_lift" has no room to move, so it is rigid')


def test_a_joint_that_another_one_should_move_is_named() -> None:
    follows = read_urdf(Source(ARM.replace(LIMIT, f'{LIMIT}<mimic joint="elbow" multiplier="-1"/>'), "arm.urdf"))
    assert follows.notes[0] == 'the joint "shoulder_lift" moves by itself here, and not with "elbow"'
