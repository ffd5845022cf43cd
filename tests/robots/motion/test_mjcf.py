"""Robots of MuJoCo as the body of a robot file."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.robots.bodies.body_file import BodyError
from btlang.robots.bodies.urdf_reader import read_urdf
from btlang.text.source import Source

URDF = """
<robot name="cart">
  <link name="base"><collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision></link>
  <link name="left wheel"><collision><origin rpy="1.5 0 0"/><geometry><cylinder radius="0.05" length="0.02"/>
    </geometry></collision></link>
  <link name="right wheel"><collision><origin rpy="1.5 0 0"/><geometry><cylinder radius="0.05" length="0.02"/>
    </geometry></collision></link>
  <link name="mast"><collision><origin xyz="0 0 0.25"/><geometry><capsule radius="0.03" length="0.5"/></geometry>
    </collision></link>
  <link name="camera"><collision><geometry><sphere radius="0.04"/></geometry></collision></link>
  <joint name="left" type="continuous"><parent link="base"/><child link="left wheel"/><origin xyz="0 0.2 0"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="right" type="continuous"><parent link="base"/><child link="right wheel"/><origin xyz="0 -0.2 0"/>
    <axis xyz="0 1 0"/></joint>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="mast"/><origin xyz="0.1 0 0.05" rpy="0 0 0.5"/>
    <axis xyz="0 0 1"/><limit lower="0" upper="0.3"/></joint>
  <joint name="tilt" type="revolute"><parent link="mast"/><child link="camera"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 1 0"/><limit lower="-0.5" upper="0.5"/></joint>
</robot>
"""
MJCF = """
<mujoco model="cart">
  <compiler angle="radian"/>
  <default>
    <geom type="capsule"/>
    <default class="wheel"> <joint axis="0 1 0"/> <geom type="cylinder" size="0.05 0.01" euler="1.5 0 0"/> </default>
  </default>
  <worldbody>
    <geom type="plane" size="5 5 0.1"/>
    <body name="base" pos="0 0 0.1"> <freejoint/>
      <geom type="box" size="0.2 0.15 0.05"/>
      <body name="left wheel" pos="0 0.2 0" childclass="wheel"> <joint name="left"/> <geom/> </body>
      <body name="right wheel" pos="0 -0.2 0" childclass="wheel"> <joint name="right"/> <geom/> </body>
      <body name="mast" pos="0.1 0 0.05" axisangle="0 0 1 0.5">
        <joint name="lift" type="slide" range="0 0.3"/>
        <geom fromto="0 0 0 0 0 0.5" size="0.03"/>
        <body name="camera" pos="0 0 0.5">
          <joint name="tilt" axis="0 1 0" range="-0.5 0.5"/>
          <geom type="sphere" size="0.04"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def test_a_robot_is_the_same_in_both_formats() -> None:
    assert read_urdf(Source(MJCF, "cart.xml")).toml() == read_urdf(Source(URDF, "cart.urdf")).toml()


def test_degrees_are_usual_and_quaternions_begin_with_w() -> None:
    degrees = MJCF.replace("radian", "degree").replace('range="-0.5 0.5"', 'range="-30 30"')
    degrees = degrees.replace('axisangle="0 0 1 0.5"', 'quat="0.968912422 0 0 0.247403959"')
    tilt = read_urdf(Source(degrees, "cart.xml")).joints[-1]
    assert (tilt.low, tilt.high) == (pytest.approx(-30), pytest.approx(30))
    assert tilt.axis == pytest.approx((-0.479425539, 0.877582562, 0.0))


def test_two_joints_of_a_body_are_two_links() -> None:
    pan = '<joint name="pan" pos="0.02 0 0" range="-1 1"/><joint name="tilt"'
    one, pan_joint, tilt = read_urdf(Source(MJCF.replace('<joint name="tilt"', pan), "cart.xml")).joints
    assert (pan_joint.parent, pan_joint.link, tilt.parent, tilt.link) == (one.link, "camera 1", "camera 1", "camera")
    assert pan_joint.at == pytest.approx((0.02 * 0.877582562, 0.02 * 0.479425539, 0.5))
    assert tilt.at == pytest.approx((-pan_joint.at[0], -pan_joint.at[1], 0.0))


def test_meshes_are_in_their_folder(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "eye.obj").write_text("v -1 -2 -3\nv 1 2 3\n")
    text = MJCF.replace('angle="radian"', 'angle="radian" meshdir="meshes"')
    text = text.replace("<worldbody>", '<asset><mesh file="eye.obj" scale="0.1 0.1 0.1"/></asset><worldbody>')
    path = tmp_path / "cart.xml"
    path.write_text(text.replace('type="sphere" size="0.04"', 'type="mesh" mesh="eye"'))
    camera = read_urdf(Source(path.read_text(), str(path))).capsules[-1]
    assert (camera.start, camera.end) == ((0.0, 0.0, -0.3), (0.0, 0.0, 0.3))


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ("<freejoint/>", '<include file="arm.xml"/>', 10, "<include> of MJCF can't be read"),
        ('type="slide"', 'type="ball"', 15, 'a joint of the type "ball" can\'t be read'),
        ('range="0 0.3"', 'range="0"', 15, '"range" of <joint> must be 2 numbers'),
        ('type="sphere" size="0.04"', 'type="mesh" mesh="eye"', 19, 'there is no mesh "eye"'),
        ('<body name="base"', '<body><joint/></body><body name="base"', 2, "has 2 bodies that may be the robot"),
        ("worldbody", "sensor", 2, "has no bodies that may be the robot"),
    ],
)
def test_what_cannot_be_read_has_a_line(old: str, new: str, line: int, says: str) -> None:
    with pytest.raises(BodyError, match=says.replace("(", r"\(")) as caught:
        read_urdf(Source(MJCF.replace(old, new), "cart.xml"))
    assert caught.value.line == line
