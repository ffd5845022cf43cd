"""The library as a program uses it."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import btlang
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.robots.robot import RobotError
from btlang.robots.worlds.world_file import read_world
from btlang.run.events import Chosen, Event, Printed
from tests.trial import Trial


def test_the_founding_sentence_moves_the_robot(capsys: pytest.CaptureFixture[str]) -> None:
    for parser in ("shunting-yard", "lark"):
        tree = Trial("move forward then twist right and print hello", parser=parser)
        ids = [node.id for node in tree.mission.tree.walk()]
        assert ids == ["Sequence", "MoveForward", "Parallel", "TurnRight", "Print"]
        start = tree.robot.pose
        events: list[Event] = []
        outcome = tree.run(speed="max", sinks=[events.append])
        assert outcome.status == SUCCESS
        end = tree.robot.pose
        assert math.hypot(end.x - start.x, end.y - start.y) == pytest.approx(0.5, abs=0.02)
        assert end.heading - start.heading == pytest.approx(-90, abs=1)
        assert [e.text for e in events if isinstance(e, Printed)] == ["hello"]
    tree.mission.print()
    assert "TurnRight: turn right" in capsys.readouterr().out


def test_ticking_by_hand() -> None:
    tree = Trial("wait 0.2 s then fail")
    statuses = [tree.tick() for _ in range(5)]
    assert statuses == [RUNNING] * 4 + [FAILURE]
    tree.tick()
    tree.halt()
    assert [tree.tick() for _ in range(5)] == statuses


def test_halting_stops_the_robot() -> None:
    tree = Trial("move forward 3 m")
    for _ in range(20):
        tree.tick()
    assert tree.robot.velocity[0] > 0.2
    tree.halt()
    assert not tree.robot.moving


def test_functions_generators_and_classes_become_words() -> None:
    said: list[object] = []

    @btlang.action("cheer for {name}", slots={"name": "text"})
    def cheer(name: str) -> None:
        said.append(name)

    @btlang.action("count to {number}", resources=["voice"])
    def count(number: float, clock: object) -> Iterator[None]:
        for i in range(int(number)):
            said.append(i)
            yield

    @btlang.condition("{number} things were said")
    def said_enough(number: float) -> bool:
        return len(said) == number

    @btlang.action("hold breath")
    class HoldBreath:
        def __init__(self, robot: object) -> None:
            self.ticks = 0

        def start(self) -> None:
            said.append("in")

        def tick(self) -> bool | None:
            self.ticks += 1
            return True if self.ticks > 1 else None

        def halt(self) -> None:
            said.append("halt")

    words = [cheer, count, said_enough, HoldBreath]
    text = "cheer for Alice then count to 2 then hold breath then check 4 things were said"
    assert btlang.parse_tree(text, keywords=words).run(speed="max").status == SUCCESS
    assert said == ["Alice", 0, 1, "in"]
    assert cheer("direct") is None


def test_a_leaf_that_raises_fails_with_a_reason() -> None:
    @btlang.action("stumble")
    def stumble() -> None:
        raise ZeroDivisionError("over a stone")

    @btlang.action("refuse")
    def refuse() -> None:
        raise btlang.ActionFailed("too tired")

    outcome = btlang.parse_tree("stumble or refuse", keywords=[stumble, refuse]).run(speed="max")
    assert outcome.status == FAILURE
    assert outcome.failure is not None
    assert outcome.failure.reason == "too tired"
    outcome = btlang.parse_tree("stumble", keywords=[stumble]).run(speed="max")
    assert outcome.failure is not None
    assert outcome.failure.reason == "ZeroDivisionError: over a stone"
    assert isinstance(outcome.failure.exception, ZeroDivisionError)


def test_why_it_failed() -> None:
    tree = Trial("try grasp the cup up to 2 times, otherwise check not the battery is above 20%")
    assert tree.why() == ""
    tree.run(speed="max")
    told = [
        "The mission failed after 0.1 s.",
        "<text>:1:50: not the battery is above 20%",
        "  try grasp the cup up to 2 times, otherwise check not the battery is above 20%",
        f"  {'':49}{'^' * 28}",
        "  Battery: 'battery is above 20%' was true",
        "What had been tried before:",
        "    0.0 s  grasp cup: the cup is not within reach of the right hand (2 times, last at 0.1 s)",
    ]
    assert tree.why().splitlines() == told
    assert tree.latest is not None
    assert tree.latest.why(colour=True).splitlines()[3] == f"  {'':49}\x1b[1;31m{'^' * 28}\x1b[0m"
    other = Trial("try grasp the cup up to 2 times, otherwise check not the battery is above 20%")
    assert (other.tick(), other.why()) == (RUNNING, "")
    assert other.tick() == FAILURE
    assert other.why().splitlines() == told


def test_a_mission_whose_commands_are_all_skipped() -> None:
    assert btlang.parse_tree("if bumped, wave").run(speed="max").status == SKIPPED


def test_one_exception_holds_all_diagnostics() -> None:
    with pytest.raises(btlang.MissionError) as caught:
        btlang.parse_tree("fly high\nwave and and nod\ngo to the moon")
    assert [(d.code, d.span.place) for d in caught.value.diagnostics] == [
        ("BT010", "<text>:1:1"),
        ("BT020", "<text>:2:6"),
        ("BT013", "<text>:3:11"),
    ]
    assert str(caught.value).count("error") == 3


@pytest.mark.parametrize("read", [btlang.parse_tree, btlang.Session().run])
def test_the_name_of_a_file_as_a_mission(read: Callable[[str], object]) -> None:
    with pytest.raises(btlang.MissionError, match=r"btlang\.parse_file\('patrol\.txt'\)"):
        read("patrol.txt")
    for text in ("fly", "fly to a.txt", "fly."):
        with pytest.raises(btlang.MissionError) as caught:
            read(text)
        assert "parse_file" not in str(caught.value)


def test_every_run_starts_in_a_fresh_world_and_is_the_same() -> None:
    tree = Trial("go to the lab then pick up the bottle, then look around")
    ends = []
    for _ in range(2):
        outcome = tree.run(speed="max")
        ends.append((outcome.status, outcome.seconds, tree.robot.pose))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("wrong", [{"speed": 0}, {"speed": "fast"}, {"rate": 0}])
def test_wrong_options(wrong: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"^(speed|rate)"):
        btlang.parse_tree("wave").run(**wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="parser"):
        btlang.parse_tree("wave", parser="earley")
    with pytest.raises(AttributeError):
        btlang.nothing  # type: ignore[attr-defined]  # noqa: B018


def test_a_place_of_one_mission_is_not_there_for_the_next() -> None:
    session = btlang.Session()
    first = btlang.parse_tree("the lobby is at (1.5, 2.5)\nbay is at (2, 2)\ngo to the lobby")
    second = btlang.parse_tree("go to the lobby")
    for mission in (first, second):
        assert session.prepare(mission, speed="max").execute().succeeded
    lobby = next(place for place in read_world().places if place.name == "lobby")
    assert session.robot.pose.distance_to((lobby.x, lobby.y)) < 0.3
    with pytest.raises(RobotError):
        session.robot.locate("bay")


def test_words_are_compiled_once_and_shared() -> None:
    @btlang.action("hop over")
    def hop() -> None:
        """An own word."""

    first, second = (btlang.parse_tree("wave then nod").vocabulary for _ in range(2))
    assert first is second
    assert btlang.parse_tree("the bay is at (1, 1)\ngo to the bay").vocabulary is first
    own, again = (btlang.parse_tree("hop over", keywords=[hop]).vocabulary for _ in range(2))
    assert own is again
    assert own is not first
    with pytest.raises(btlang.MissionError):
        btlang.parse_tree("hop over")


@pytest.mark.skipif(sys.platform != "linux", reason="reads the size of the process from /proc")
def test_a_thousand_trees_are_small() -> None:
    """They had taken 1.6 MB each, and so had each run."""
    program = (
        "import btlang\n"
        "trees = [btlang.parse_tree(f'if the battery is below {i % 90}%, wave {i + 1} times') for i in range(1000)]\n"
        "for tree in trees[:100]: tree.run(speed='max', time_limit=0.1)\n"
        "print(int(open('/proc/self/statm').read().split()[1]) * 4096 // 1_000_000)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(btlang.__file__).parents[1])}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert int(done.stdout) < 100


def test_a_seed_repeats_the_random_choices_of_a_run() -> None:
    mission = btlang.parse_tree("repeat 12 times: set goal to a random place then print {goal}")

    def chosen(seed: int | None) -> list[tuple[str, int]]:
        with btlang.Session() as session:
            run = session.run(mission, speed="max", seed=seed)
            events = [event for event in run.events() if isinstance(event, Chosen)]
        assert all(event.seed == run.seed for event in events)
        return [(event.name, run.seed) for event in events]

    first = chosen(None)
    assert len(first) == 12
    assert chosen(first[0][1]) == first
    assert chosen(7) != chosen(8)
