"""A mission tried in the simulated world, as fast as possible and within limits, before it goes to a robot."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.recording.film import Film
from btlang.robots.world_problem import read_world
from btlang.session import Session
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_SECONDS = 3600.0
"""Of the mission's time."""
_MOST_TICKS = 72_000
_RATE = 20.0
_OURS = "btlang.actions."  # modules whose functions do nothing but lead the robot that they are given


def tried(mission: Mission, seconds: float = 600.0, patience: float = 6.0, seed: int | None = None) -> dict[str, Any]:
    """The film of a run (see Film.data) of at most so many seconds of the mission and `patience` seconds of real time,
    with the `map` of its world, and what `stopped` it: "" if it ended by itself.

    Raises MissionError for a mission that can't be run, and BT221 for one with words that are no words of btlang: what
    they do might move a real robot.
    """
    for node in mission.tree.walk():
        entry = mission.vocabulary.entry(node.id)
        if entry is not None and not str(entry.call).startswith(_OURS):
            words = mission.label(node)
            raise MissionError([diagnostic("BT221", node.span or NOWHERE, words=words, file=entry.file)])
    mission.check()
    film = Film(mission)
    session = Session("simulated", world=mission.world)
    limit = min(max(seconds, 0.0), MOST_SECONDS, _MOST_TICKS / _RATE)
    options = {} if seed is None else {"seed": seed}
    run = session.start(mission, speed="max", rate=_RATE, time_limit=limit, sinks=(film,), **options)
    outcome = run.wait(patience)
    stopped = "it takes too long to simulate"
    if outcome is None:
        run.stop()
        run.wait(patience)
    else:
        stopped = outcome.stopped
    session.close()
    return {**film.data(), "map": read_world(mission.world).as_map(), "stopped": stopped}
