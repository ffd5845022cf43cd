"""What C++ sources beside the trees say of ports."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.projects.cpp_ports import CppSources
from tests.projects.trees import TREE, problems, write

HEADER = """
#include "nodes.hpp"
// class Old : public Base { static PortsList providedPorts() { return { InputPort<int>("old") }; } };
template <class ActionT>
class RosAction : public BT::StatefulActionNode
{
public:
  static BT::PortsList providedBasicPorts(BT::PortsList more)
  {
    BT::PortsList basic = { BT::InputPort<std::string>("server_name", "the server") };
    basic.insert(more.begin(), more.end());
    return basic;
  }
};

class ROBOT_PUBLIC DriveAction final : public robot::RosAction<robot_msgs::action::Drive>
{
  static BT::PortsList providedPorts()
  {
    return providedBasicPorts({
      BT::InputPort<double>("speed", 0.5, "metres, at most (per second)"),
      BT::InputPort<std::vector<std::pair<int, int>>>(
        "lanes",
        "where it may"
        " drive"),
      InputPort<std::string>("side"), BT::InputPort<std::string>("label", "a, \\"b\\"", "quoted"),
      BT::OutputPort<double>("length", "driven"), BT::BidirectionalPort<int>("count"),
      BT::InputPort<int>(kMode, 1, "by a name that this doesn't know"),
    });
  }
};
"""
SOURCE = """
DriveAction::DriveAction(const std::string & name) : RosAction(name)
{
  std::string given;
  if (getInput("server_name", given)) { connect(given); }
  getInput<std::string>("side", side_);
  if (!this->getInput("lanes", lanes_)) { throw BT::RuntimeError("no lanes"); }
}
BT::NodeStatus DriveAction::tick() { count_ = getInput<int>("count").value(); return run(); }
BT_REGISTER_NODES(factory)
{
  factory.registerNodeType<robot::DriveAction>("Drive");
  factory.registerSimpleCondition("IsTired", is_tired);
}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "drive.hpp").write_text(HEADER, "utf-8")
    (tmp_path / "src" / "drive.cpp").write_text(SOURCE, "utf-8")
    (tmp_path / "src" / "broken.cpp").write_bytes(b"providedPorts \xff")
    return tmp_path


def test_ports_with_directions_types_and_defaults(folder: Path) -> None:
    models = CppSources([str(folder)]).models
    drive, place = models["Drive"]
    assert place.source.name.endswith("drive.hpp")
    assert {port.name: (port.direction, port.type, port.default) for port in drive.ports} == {
        "server_name": ("input", "std::string", ""),
        "speed": ("input", "double", "0.5"),
        "lanes": ("input", "std::vector<std::pair<int, int>>", None),
        "side": ("input", "std::string", ""),
        "label": ("input", "std::string", 'a, \\"b\\'),
        "length": ("output", "double", None),
        "count": ("inout", "int", None),
    }
    assert models["IsTired"][0].ports == ()
    assert "Old" not in models


def test_they_say_what_models_leave_open(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = ("server_name", "speed", "lanes", "side")
    ports = "".join(f'<input_port name="{name}"/>' for name in names)
    trees = TREE.format("Main", '<Sequence><IsTired/><Drive/><Drive lanes="1" label="x"/></Sequence>')
    write(folder, "trees/main.xml", trees, models=f'<Action ID="Drive">{ports}</Action>')
    found = problems(capsys, str(folder))
    assert [(problem["code"], problem["message"]) for problem in found] == [
        ("BT234", "The port lanes of Drive is missing."),
        ("BT239", "The model of Drive lacks ports that its nodes have: 'label'."),
    ]
    assert [Path(note["file"]).name for note in found[1]["notes"]] == ["main.xml", "drive.hpp"]


def test_a_node_without_a_model_is_known_by_them(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Only what is surely misspelt is reported: the sources may hide other ports."""
    write(folder, "trees/main.xml", TREE.format("Main", '<Sequence><Drive servr_name="1" mode="2"/><Fly/></Sequence>'))
    found = problems(capsys, str(folder))
    assert [(problem["code"], problem["words"]) for problem in found] == [("BT232", "servr_name"), ("BT231", "Fly")]


def test_misspelt_ports_of_nodes_of_nav2(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    use = '<ComputePathToPose gaol="{goal}" path="{path}" planner_plugin="x"/>'
    write(tmp_path, "main.xml", TREE.format("Main", f'<Sequence>{use}<FollowPath path="{{path}}"/></Sequence>'))
    [problem] = problems(capsys, str(tmp_path))
    assert (problem["code"], problem["words"], problem["fix"]["text"]) == ("BT232", "gaol", "goal")
