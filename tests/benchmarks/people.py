"""What people in a world cost: `python -m tests.benchmarks.people`.

The simulated robot drives from place to place in the museum, its scanner read ten times a second: alone, and with ten
people who walk; how many times faster than real time that is, in time of the processor.
"""

from __future__ import annotations

import time
from random import Random

from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.planning import PathPlanner
from tests.world.worlds import museum

_SECONDS = 1200.0
_STEP = 0.05


def main() -> None:
    """Prints the figures."""
    alone, together = (_times_real_time(people) for people in (0, 10))
    print(f"alone                  {alone[0]:6.0f} times real time   longest plan {alone[1]:5.1f} ms")
    print(f"with ten people        {together[0]:6.0f} times real time   longest plan {together[1]:5.1f} ms")
    print(f"people and zones cost  {alone[0] / together[0]:6.2f} times the time")


def _times_real_time(people: int) -> tuple[float, float]:
    robot, random = SimulatedRobot(museum(people, zones=bool(people))), Random(5)
    robot.seed_choices(1)
    names = [place.name for place in robot.world.places]
    longest, plan = 0.0, PathPlanner.path

    def timed(*args: object, **named: object) -> object:
        nonlocal longest
        began = time.process_time()
        path = plan(*args, **named)  # type: ignore[arg-type]
        longest = max(longest, time.process_time() - began)
        return path

    PathPlanner.path = timed  # type: ignore[assignment,method-assign]
    try:
        began, steps, goal = time.process_time(), 0, robot.navigate_to(names[0])
        while robot.time < _SECONDS:
            robot.power.set_level(100)
            robot.step(_STEP)
            steps += 1
            if steps % 2 == 0:
                robot.scan()
            if goal.done:
                goal = robot.navigate_to(random.choice(names))
        return _SECONDS / (time.process_time() - began), 1e3 * longest
    finally:
        PathPlanner.path = plan  # type: ignore[method-assign]


if __name__ == "__main__":
    main()
