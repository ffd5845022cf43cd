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
