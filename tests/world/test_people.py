"""People who live in a world: they come, walk, make room, speak, answer, follow and leave."""

from __future__ import annotations

from collections.abc import Callable
from math import dist

import pytest

import btlang
from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.vocabulary.shipped import shipped
from tests.profiles import amount
from tests.world.worlds import doorway, museum, rooms

VERA = """
[[people]]
name = "Vera"
x = 9
y = 3.5
"""


class Life:
    """A robot in a world, and what happened to it."""

    def __init__(self, world: World, seed: int = 1) -> None:
        self.events: list[tuple[float, str, str]] = []
        self.robot = SimulatedRobot(world)
        self.robot.seed_choices(seed)
        self.robot.on_event = lambda kind, data: self.events.append(
            (self.robot.time, kind, str(data.get("text", data.get("name", ""))))
        )

    def until(self, wanted: Callable[[], bool], seconds: float = 60.0) -> float:
        """Lets time pass until something is true; fails where it never is. Returns the time."""
        end = self.robot.time + seconds
        while not wanted():
            assert self.robot.time < end, self.events[-5:]
            self.robot.step(0.05)
        return self.robot.time

    def after(self, seconds: float) -> None:
        """Lets time pass."""
        for _ in range(round(seconds / 0.05)):
            self.robot.step(0.05)

    def point(self, name: str) -> tuple[float, float] | None:
        """Where somebody really is."""
        return self.robot._obstacles.point(name)

    def near(self, name: str, x: float, y: float) -> bool:
        """Whether somebody is there."""
        at = self.point(name)
        return at is not None and dist(at, (x, y)) < 0.3

    def kinds(self, *kinds: str) -> list[tuple[str, str]]:
        """What happened, of these kinds."""
        return [(kind, text) for _, kind, text in self.events if kind in kinds]


def test_a_visitor_comes_walks_her_route_and_leaves() -> None:
    life = Life(rooms(VERA + 'comes = 5\nwalks = [[9, 1], { to = "west", at = 20, stays = 5 }]\nleaves = 60'))
    assert life.point("Vera") is None
    assert life.until(lambda: life.point("Vera") is not None) == pytest.approx(5, abs=0.2)
    life.until(lambda: life.near("Vera", 9, 1), 6)
    life.after(4)
    assert life.near("Vera", 9, 1)  # she waits for second 20
    life.robot.put(Pose(1, 3.4))
    begun = life.until(lambda: life.near("Vera", 1, 2), 40)
    assert 25 < begun < 45  # 8.6 m round the doorway at 1.1 m/s, no earlier than second 20
    life.until(lambda: life.point("Vera") is None, 60)
    assert life.kinds("come", "leave") == [("come", "Vera"), ("leave", "Vera")]
    assert life.robot.bumps == 0


def test_she_walks_at_her_speed_through_the_doorway_and_not_through_walls() -> None:
    life = Life(rooms(VERA + "walks = [[8, 3.5], [1, 3.5]]\nspeed = 2.0"))
    life.robot.put(Pose(1, 0.5))
    before, fastest = life.point("Vera"), 0.0
    while not life.near("Vera", 1, 3.5):
        life.robot.step(0.05)
        now = life.point("Vera")
        assert now is not None
        assert before is not None
        fastest = max(fastest, dist(before, now) / 0.05)
        assert not life.robot._obstacles.wall_between(before, now) if before != now else True
        before = now
        assert life.robot.time < 30
    assert 1.9 < fastest < 2.01


def test_the_same_seed_gives_the_same_people_and_another_one_others() -> None:
    def ways(seed: int) -> list[object]:
        life = Life(museum(4), seed)
        life.after(30)
        return [life.point(f"P{index}") for index in range(4)]

    assert ways(1) == ways(1)
    assert ways(1) != ways(2)


@pytest.mark.long
def test_two_people_and_the_robot_in_one_doorway() -> None:
    for seed in range(amount(25, 1000)):
        life = Life(doorway(seed), seed)
        goal = life.robot.navigate_to("east")
        walkers = life.robot.surroundings.people._walkers
        end = life.until(lambda goal=goal: goal.done, 60)
        assert goal.failure is None, (seed, goal.failure)
        life.until(lambda life=life: life.near("A", 9, 3) and life.near("B", 1, 1), 60 - end)
        assert life.robot.bumps == 0
        assert walkers


def test_a_bystander_is_waited_for_then_walked_around() -> None:
    life = Life(rooms(VERA + "walks = [{ to = [5, 2], stays = 25 }, [9, 1]]"))
    life.until(lambda: life.near("Vera", 5, 2), 20)
    goal = life.robot.navigate_to("east")
    life.until(lambda: life.robot.held_up == "Vera")
    life.until(lambda: goal.done, 60)
    assert (goal.failure, life.robot.bumps) == (None, 0)


def test_who_never_makes_room_is_the_reason_why_not() -> None:
    life = Life(rooms(VERA + "walks = [[5, 2]]"))
    life.until(lambda: life.near("Vera", 5, 2), 20)
    goal = life.robot.navigate_to("east")
    end = life.until(lambda: goal.done, 90)
    assert goal.failure == "Vera is in the way to the east"
    assert end > 38


def test_patience_can_be_said() -> None:
    life = Life(rooms(VERA + "walks = [[8, 2.3]]"))  # a wide room: there is another way
    life.until(lambda: life.near("Vera", 8, 2.3), 20)
    times = []
    for patience in (2.0, 12.0):
        life.robot.put(Pose(6.5, 2))
        life.robot.wait_for_way(patience)
        goal, begun = life.robot.navigate_to("east"), life.robot.time
        times.append(life.until(lambda goal=goal: goal.done) - begun)
        assert goal.failure is None
    assert times[0] < times[1]


def test_she_calls_out_and_answers() -> None:
    life = Life(
        rooms(
            '[[people]]\nname = "Vera"\nx = 3\ny = 2\nsays = [{ at = 2, text = "Hello!" }]\n'
            'answers = { "coffee" = "yes, please", "*" = "pardon?" }\n'
            '[[people]]\nname = "Otto"\nx = 9\ny = 2\nanswers = { "*" = "what?" }\n'
        )
    )
    life.after(3)
    assert life.kinds("hear") == [("hear", "Hello!")]
    life.robot.ask("Would you like coffee?", "Vera")
    life.robot.ask("Are you there?", "Otto")  # in another room, 8 m away
    life.robot.ask("How are you?")
    life.after(3)
    assert life.kinds("hear")[1:] == [("hear", "yes, please"), ("hear", "pardon?")]
    life.robot.surroundings.people.answer("Vera", "no")
    life.robot.ask("Coffee?", "Vera")
    life.after(3)
    assert life.kinds("hear")[-1] == ("hear", "no")
    assert [heard.who for heard in life.robot.ears.since(0)] == ["Vera"] * 4


def test_who_is_guided_follows_and_may_fall_behind() -> None:
    def farthest(follows: float) -> float:
        life = Life(rooms(f'[[people]]\nname = "Vera"\nx = 2\ny = 2.6\nfollows = {follows}\n'), 3)
        life.robot.guide("Vera", True)
        goal, found = life.robot.navigate_to("east"), 0.0
        while not goal.done:
            life.robot.step(0.05)
            pose, at = life.robot.pose, life.point("Vera")
            assert at is not None
            found = max(found, dist(at, (pose.x, pose.y)))
        assert goal.failure is None
        return found

    assert farthest(1.0) < 2.5
    assert farthest(0.0) > 3.0


def test_nobody_is_guided_whom_the_robot_does_not_see() -> None:
    life = Life(rooms(VERA))
    with pytest.raises(RobotError, match="I don't see Vera"):
        life.robot.guide("Vera", True)


def test_a_guest_can_be_invited() -> None:
    life = Life(rooms(VERA + "comes = 1000"))
    assert life.robot.invite() == "Vera"
    assert life.point("Vera") is not None
    assert life.robot.invite() == "visitor 1"
    life.after(1)
    assert life.kinds("come") == [("come", "Vera"), ("come", "visitor 1")]


def test_who_stands_can_be_told_to_walk() -> None:
    life = Life(rooms(VERA))
    assert life.robot.locate("Vera") == (9, 3.5)  # the world's list says so, and she doesn't walk
    life.robot.surroundings.people.walk("Vera", (9, 1))
    life.until(lambda: life.near("Vera", 9, 1), 10)
    assert life.robot.locate("Vera") == (9, 3.5)  # where the robot last knew her


@pytest.mark.parametrize("seed", range(4))
def test_a_guided_tour_comes_to_its_end_whatever_happens_on_the_way(seed: int) -> None:
    """Followers had turned back and forth at doors, and were lost."""
    with open(shipped("examples/guided_tour.txt"), encoding="utf-8") as file:
        mission = btlang.parse_tree(file.read(), world=shipped("examples/worlds/hotel.toml"))
    assert mission.run(speed="max", seed=seed, time_limit=600).succeeded
