"""What a Python module does that `btc compile --to python` has made."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from btlang.diagnostics.diagnostic import MissionError
from btlang.run.terminal import run_mission
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from btlang.run.terminal import RunnableMission, RunnerSession


def run_module(
    mission: RunnableMission,
    open_session: Callable[[], AbstractContextManager[RunnerSession]],
    arguments: Sequence[str] | None = None,
) -> int:
    """Run the mission in a session as `btc run` does, with its option --speed; return its exit code."""
    parser = argparse.ArgumentParser(description="Runs a behavior tree on the simulated robot.")
    parser.add_argument("--speed", default="real", help="real, max, or a factor of real time")
    speed = parser.parse_args(arguments).speed
    try:
        factor = speed if speed in ("real", "max") else float(speed)
        return run_mission(mission, open_session, speed=factor, rate=20.0, time_limit=None, log=None, quiet=False)
    except MissionError as error:
        show(str(error), stream=sys.stderr)
        return 2
    except ValueError as error:
        parser.error(str(error))
