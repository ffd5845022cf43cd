"""What still commands the robot when it was halted, or when the run has ended: it does not get through."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import btlang
from btlang import Session
from btlang.engine.status import SUCCESS
from btlang.robots.robot import RobotError
from btlang.run import runner
from btlang.run.bus import INLINE
from btlang.run.events import PeriodPassed, Said
from tests.trial import Trial

PATIENCE = 20.0  # seconds of real time, for what takes a moment


class Straggler:
    """Words for commands that drive off and never cease; `robot` is that of the mission, from the first command on."""

    def __init__(self) -> None:
        self.refusals: list[str] = []
        self.done = threading.Event()

        @btlang.action("run wild", thread=True)
        def run_wild(robot: Any) -> None:
            while not self.done.is_set():
                self.command(robot)

        @btlang.action("run free")
        async def run_free(robot: Any) -> None:
            while not self.done.is_set():
                try:
                    self.command(robot)
                    await asyncio.sleep(0.001)
                except asyncio.CancelledError:
                    pass

        @btlang.action("run away")
        def run_away(robot: Any) -> Iterator[None]:
            def drive() -> None:
                while not self.done.wait(0.001):
                    self.command(robot)

            threading.Thread(target=drive, daemon=True).start()
            while True:
                yield

        self.words = [run_wild, run_free, run_away]

    def command(self, robot: Any) -> None:
        try:
            robot.drive(0.4, 0.0)
            robot.move_joints({"head turn": 90.0})
        except RobotError as error:
            raise AssertionError from error
        except btlang.ActionFailed as problem:
            self.refusals.append(str(problem))
            time.sleep(0.001)


@pytest.fixture
def straggler() -> Iterator[Straggler]:
    straggler = Straggler()
    yield straggler
    straggler.done.set()


def once_moving(tree: Trial, do: Callable[[], object]) -> Callable[[object], None]:
    """A sink that does something once, when the robot of a tree moves."""
    asked: list[object] = []

    def watch(event: object) -> None:
        if isinstance(event, PeriodPassed) and not asked and event.robot is not None and tree.robot.velocity[0] > 0.3:
            asked.append(do())

    return watch


@pytest.mark.parametrize("command", ["run wild", "run free", "run away"])
@pytest.mark.parametrize("how", ["stop", "emergency_stop"])
def test_a_robot_that_was_stopped_stays_where_it_is(
    straggler: Straggler, command: str, how: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(runner, "_PATIENCE", 0.1)  # for commands that never end
    tree = Trial(command, keywords=straggler.words)
    outcome = tree.run(rate=100, sinks=[once_moving(tree, getattr(tree.controls, how))])
    assert outcome.stopped == {"stop": "interrupted", "emergency_stop": "emergency stop"}[how]
    robot = tree.robot
    assert not robot.moving
    place, head = robot.pose, robot.joint("head turn")
    for _ in range(50):
        robot.step(0.1)
        time.sleep(0.001)
    assert (robot.pose, robot.joint("head turn"), robot.moving) == (place, head, False)
    if command != "run away":
        assert set(straggler.refusals) == {"it was halted"}


def test_a_pause_holds_and_the_end_lets_go() -> None:
    """The robot takes commands again when the run goes on, and not after its end."""
    straggler = Straggler()
    tree = Trial("run away", keywords=straggler.words)
    speeds: list[float] = []

    def watch(event: object) -> None:
        if not isinstance(event, PeriodPassed):
            return
        speed = tree.robot.velocity[0]
        if not speeds and speed > 0.3:
            tree.controls.pause()
            speeds.append(speed)
        elif len(speeds) == 1 and not tree.robot.moving:
            speeds.append(speed)
            threading.Timer(0.05, tree.controls.resume).start()
        elif len(speeds) == 2 and speed > 0.3:
            speeds.append(speed)
            tree.controls.stop()

    outcome = tree.run(rate=100, sinks=[watch], time_limit=60)
    straggler.done.set()
    assert (outcome.stopped, speeds[1], len(speeds)) == ("interrupted", 0.0, 3)


def test_between_two_runs_nothing_moves() -> None:
    session = Session()
    tree = Trial("pick up the cup", session)
    robot = session.robot
    robot.drive(0.3, 0.0)  # before the first run it obeys
    robot.step(0.1)
    assert robot.moving
    assert tree.run(speed="max").status == SUCCESS
    place = robot.pose
    robot.drive(0.3, 0.0)
    robot.move_joints({"head turn": 90.0})
    robot.release("right")
    assert robot.navigate_to("lab").failure == "the robot was stopped"
    with pytest.raises(RobotError, match="the robot was stopped"):
        robot.grasp("left")
    robot.step(1.0)
    assert (robot.pose, robot.joint("head turn"), robot.holding("right")) == (place, 0.0, "cup")
    again = Trial("move forward 10 cm then put down the cup", session)
    assert again.run(speed="max").status == SUCCESS
    assert robot.holding("right") is None


def test_a_halt_ends_what_a_thread_has_set_about() -> None:
    @btlang.action("wander", thread=True)
    def wander(robot: Any, halted: threading.Event) -> None:
        robot.drive(0.3, 0.0)
        robot.move_joints({"head turn": 90.0})
        robot.say("a sentence that takes longer than the time that there is")
        halted.wait()

    tree = Trial("wander within 0.5 s, otherwise wait 2 s", keywords=[wander])
    seen: list[tuple[float, bool]] = []
    tree.run(speed=2, sinks=[lambda event: seen.append((event.t, tree.robot.moving or tree.robot.speaking))])
    assert any(moving for t, moving in seen)
    assert not any(moving for t, moving in seen if t > 1.2)
    assert 0.0 < tree.robot.joint("head turn") < 90.0


def test_what_a_thread_asks_of_the_robot_is_done_by_the_thread_that_ticks() -> None:
    ticking, did = threading.get_ident(), []
    found: list[object] = []

    @btlang.action("study the room", thread=True)
    def study(robot: Any) -> None:
        robot.say("hello")
        found.extend([robot.battery, len(robot.scan()), threading.get_ident() != ticking])
        robot.navigate_to("nowhere")

    def note(event: object) -> None:
        if isinstance(event, Said):
            did.append(threading.get_ident())

    note.policy = INLINE  # type: ignore[attr-defined]
    outcome = btlang.parse_tree("study the room", keywords=[study]).run(rate=1, sinks=[note])
    assert outcome.failure is not None
    assert outcome.failure.reason == "I don't know where 'nowhere' is"
    assert found == [pytest.approx(100.0, abs=0.1), 360, True]
    assert set(did) == {ticking}
    assert outcome.seconds < 2.0  # each brought the next tick at once


def test_a_thread_that_fails_leaves_nothing_moving() -> None:
    @btlang.action("trip", thread=True)
    def trip(robot: Any) -> None:
        robot.drive(0.3, 0.0)
        raise ValueError("oops")

    tree = Trial("trip, otherwise wait 2 s", keywords=[trip])
    late: list[bool] = []
    outcome = tree.run(speed=5, sinks=[lambda event: late.append(tree.robot.moving) if event.t > 1.5 else None])
    assert (outcome.status, any(late), len(late) > 5) == (SUCCESS, False, True)
