"""Files that XML includes from packages of ROS 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError, render
from btlang.frontends.btcpp.reader import read_xml
from btlang.text.source import Source

MISSION = """<root BTCPP_format="4"><include ros_pkg="{}" path="{}"/>
<BehaviorTree ID="M"><AlwaysSuccess/></BehaviorTree></root>"""


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    package = tmp_path / "share" / "trees"
    package.mkdir(parents=True)
    (package / "tree.xml").write_text("<root><BehaviorTree ID='T'><Secret/></root>", encoding="utf-8")
    (tmp_path / "outside.xml").write_text("<root/>", encoding="utf-8")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    return tmp_path


def problem(package: str, path: str) -> str:
    source = Source(MISSION.format(package, path), "mission", "", ("",), hides_includes=True)
    with pytest.raises(MissionError) as caught:
        read_xml(source)
    return "\n".join(map(render, caught.value.diagnostics))


@pytest.mark.parametrize("package", ["..", ".", ""])
def test_a_package_is_no_way_out_of_the_packages(prefix: Path, package: str) -> None:
    assert "is not found" in problem(package, str(prefix / "outside.xml"))


def test_those_who_may_not_read_files_see_no_line_of_a_package(prefix: Path) -> None:
    said = problem("trees", "tree.xml")
    assert "tree.xml" in said
    assert "Secret" not in said


@pytest.mark.parametrize(
    "include", ['path="install/rover/share/rover/trees/dock.xml"', 'ros_pkg="rover" path="trees/dock.xml"']
)
def test_what_the_own_package_installs_is_in_its_folder(tmp_path: Path, include: str) -> None:
    """It needn't be built and installed to read, draw or edit its trees."""
    (tmp_path / "package.xml").write_text("<package><name>rover</name></package>", "utf-8")
    (tmp_path / "trees").mkdir()
    (tmp_path / "trees" / "dock.xml").write_text("<root><BehaviorTree ID='Dock'><Nod/></BehaviorTree></root>", "utf-8")
    tree = '<BehaviorTree ID="M"><SubTree ID="Dock"/></BehaviorTree>'
    text = f'<root BTCPP_format="4" main_tree_to_execute="M"><include {include}/>{tree}</root>'
    read = read_xml(Source(text, "main.xml", str(tmp_path / "trees"), (str(tmp_path / "trees"),)))
    assert [name for name, _ in read.subtrees] == ["Dock"]


def test_a_package_is_no_way_up(tmp_path: Path) -> None:
    (tmp_path / "secret.xml").write_text("<root><BehaviorTree ID='T'><Secret/></BehaviorTree></root>", "utf-8")
    trees = tmp_path / "rover" / "trees"
    trees.mkdir(parents=True)
    (tmp_path / "rover" / "package.xml").write_text("<package><name>rover</name></package>", "utf-8")
    with pytest.raises(MissionError, match="BT128"):
        read_xml(Source(MISSION.format("rover", "../secret.xml"), "main.xml", str(trees), (str(trees),)))
