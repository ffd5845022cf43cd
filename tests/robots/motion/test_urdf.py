"""URDF out and in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.robots.bodies.body_file import BodyError, load_body
from btlang.robots.bodies.urdf import read_urdf, urdf
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
    again.write_text(found.toml)
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
        ("robot", "sdf", 1, "this isn't URDF: it begins with <sdf>"),
        ("<robot", '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot', 1, "no DOCTYPE"),
        ('parent link="flange"', 'parent link="hip"', 5, 'there is no link "hip"'),
        ('<child link="upper_arm"/>', "", 5, "needs a <child> link"),
        ("revolute", "planar", 5, 'type "planar" can\'t be read'),
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
