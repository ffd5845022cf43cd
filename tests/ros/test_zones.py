"""Goals and plans of a ROS 2 robot against the zones of the world, without a graph."""

from __future__ import annotations

from math import inf
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path

from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world import KEEP_OUT, SLOW, Zone
from btlang.robots.zones import Zones
from btlang.ros.graph import graph_names
from btlang.ros.robot.zones import PLAN, SPEED_LIMIT, RosZones, _fault, enters

STAIRS = Zone("stairs", KEEP_OUT, ((2.0, 0.0), (3.0, 0.0), (3.0, 1.0), (2.0, 1.0)))
CARPET = Zone("carpet", SLOW, ((5.0, 0.0), (6.0, 0.0), (6.0, 1.0), (5.0, 1.0)), 0.2)
HERE = Pose(0.0, 0.5)


class Graph:
    """What a node and its subscriptions do for zones."""

    def __init__(self) -> None:
        self.plans: list[Path] = []
        self.told: dict[str, list[Any]] = {}

    def create_publisher(self, kind: Any, topic: str, qos: object) -> Any:
        told = self.told.setdefault(topic, [])
        return type("Publisher", (), {"publish": staticmethod(told.append)})

    def listen(self, *arguments: object, **options: object) -> None:
        pass

    def events(self, topic: str) -> list[Path]:
        assert topic == PLAN
        plans, self.plans = self.plans, []
        return plans


def path(*points: Point) -> Path:
    message = Path()
    for x, y in points:
        at = PoseStamped()
        at.pose.position.x, at.pose.position.y = x, y
        message.poses.append(at)
    return message


@pytest.fixture
def graph() -> Graph:
    return Graph()


@pytest.fixture
def zones(graph: Graph) -> RosZones:
    made = (STAIRS, CARPET)
    zones = RosZones(graph, graph, Zones(made), made, 0.5)  # type: ignore[arg-type]
    zones.begin()
    assert zones.step(2.0, HERE) == ""
    return zones


def test_a_goal_in_a_closed_zone_is_refused(zones: RosZones) -> None:
    with pytest.raises(RobotError, match=r"^the landing is in the stairs, where the robot may not go$"):
        zones.set_out("landing", Pose(2.5, 0.5))
    zones.set_out("lab", Pose(5.5, 0.5))


def test_a_plan_through_a_closed_zone_is_not_followed(graph: Graph, zones: RosZones) -> None:
    zones.set_out("lab", Pose(4.0, 0.5))
    graph.plans = [path((0.0, 0.5), (4.0, 0.5))]
    assert zones.step(0.1, HERE) == "the way to the lab leads through the stairs, where the robot may not go"
    graph.plans = [path((0.0, 0.5), (0.0, 2.0), (4.0, 2.0), (4.0, 0.5))]
    assert zones.step(0.1, HERE) == ""


def test_a_plan_to_somewhere_else_is_none_of_its_business(graph: Graph, zones: RosZones) -> None:
    zones.set_out("lab", Pose(0.0, 3.0))
    graph.plans = [path((0.0, 0.5), (4.0, 0.5)), path()]
    assert zones.step(0.1, HERE) == ""


def test_the_robot_may_leave_a_zone(zones: RosZones) -> None:
    assert not enters([(2.5, 0.5), (4.0, 0.5)], STAIRS)
    assert enters([(2.5, 0.5), (4.0, 0.5), (2.9, 0.5)], STAIRS)
    assert not enters([(2.5, 0.5)], STAIRS)


def test_a_zone_that_is_closed_on_the_way_leaves_time_for_a_new_plan(graph: Graph, zones: RosZones) -> None:
    zones.set_out("lab", Pose(8.0, 0.5))
    graph.plans = [path((4.0, 0.5), (8.0, 0.5))]
    assert zones.step(0.1, HERE) == ""
    zones.zones.close("carpet")
    assert zones.step(0.9, HERE) == ""
    assert [message.data for message in graph.told["zones/carpet/closed"]][-1] is True
    assert zones.step(1.1, HERE) == "the way to the lab leads through the carpet, where the robot may not go"


def test_a_plan_out_of_the_zone_to_stay_in_is_not_followed(graph: Graph, zones: RosZones) -> None:
    graph.plans = [path((5.5, 0.5), (6.5, 0.5), (5.2, 0.5))]
    with zones.zones.keep_in("carpet"):
        with pytest.raises(RobotError, match=r"^the lab is outside the carpet, where the robot has to stay$"):
            zones.set_out("lab", Pose(4.0, 0.5))
        zones.set_out("sofa", Pose(5.2, 0.5))
        zones.step(1.1, HERE)
        graph.plans = [path((5.5, 0.5), (6.5, 0.5), (5.2, 0.5))]
        reason = "the way to the sofa leads out of the carpet, where the robot has to stay"
        assert zones.step(1.1, HERE) == reason
        graph.plans = [path((5.5, 0.5), (5.2, 0.5))]
        assert zones.step(1.1, HERE) == ""


def test_slow_zones_limit_the_speed(graph: Graph, zones: RosZones) -> None:
    pytest.importorskip("nav2_msgs.msg._speed_limit")
    assert (zones.limit(HERE), zones.limit(Pose(5.5, 0.5)), zones.limit(None)) == (inf, 0.2, inf)
    for at, seconds in ((5.5, 0.1), (5.6, 0.1), (5.7, 1.0), (7.0, 0.1), (7.1, 2.0)):
        zones.step(seconds, Pose(at, 0.5))
    assert [message.speed_limit for message in graph.told["speed_limit"]] == [0.2, 0.2, 0.0]


def test_the_slower_of_pace_and_zone_is_the_limit(graph: Graph, zones: RosZones) -> None:
    pytest.importorskip("nav2_msgs.msg._speed_limit")
    zones.pace = 0.5
    for at in (0.0, 5.5, 7.0):
        zones.step(0.1, Pose(at, 0.5))
    zones.pace = 0.2
    zones.step(0.1, Pose(5.5, 0.5))
    zones.begin()
    zones.pace = 1.6
    zones.step(0.1, HERE)
    told = [(limit.percentage, limit.speed_limit) for limit in graph.told[SPEED_LIMIT]]
    assert told == [(True, 50.0), (False, 0.2), (True, 50.0), (True, 20.0), (False, 0.0)]


def test_a_plan_that_cannot_be_is_refused() -> None:
    assert _fault(path((0.0, 0.0))) == ""
    assert _fault(path((float("nan"), 0.0))) == "sends numbers that are not finite"


def test_names_become_names_of_the_graph() -> None:
    names = ["lab door", "Lab-Door", "Café", "2nd door", "门"]
    assert list(graph_names(names, "door").values()) == ["lab_door", "lab_door_2", "caf", "door_2nd_door", "door"]
