"""A mission tried in the simulated world, as fast as possible and within limits, before it goes to a robot."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.recording.film import Film
from btlang.session import Session
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from btlang.run.events import Sink
    from btlang.run.outcome import Outcome
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon

MOST_SECONDS = 3600.0
"""Of the mission's time."""
_MOST_TICKS = 72_000
_RATE = 20.0
_ENDING = 2.0  # seconds that a stopped run may take at least to end
OURS = "btlang.actions."
"""The prefix of modules whose functions do nothing but command the robot that they are given."""


def simulated(
    mission: Mission,
    sink: Sink,
    seconds: float,
    patience: float,
    ticks: int = _MOST_TICKS,
    seed: int | None = None,
) -> tuple[Outcome | None, str]:
    """Runs a mission on the simulated robot, as fast as possible, for at most so many seconds of the mission and ticks.

    The outcome, None for a mission with a command that never returns, and what stopped it: "" if it ended by itself. It
    is stopped after `patience` seconds of real time. Raises MissionError for a mission that can't be run.
    """
    mission.check()
    limit = min(max(seconds, 0.0), MOST_SECONDS, min(max(ticks, 1), _MOST_TICKS) / _RATE)
    options = {} if seed is None else {"seed": seed}
    session = Session("simulated", world=mission.world)
    run = session.start(mission, speed="max", rate=_RATE, time_limit=limit, sinks=(sink,), **options)
    outcome = run.wait(patience)
    if outcome is not None:
        session.close()
        return outcome, outcome.stopped
    run.stop()
    outcome = run.wait(max(patience, _ENDING))
    if outcome is not None:  # closing the session would wait for the command
        session.close()
    return outcome, "it took too long to simulate"


def check_words(tree: Tree, vocabulary: Lexicon, label: Callable[[Node], str], further: str = OURS) -> None:
    """Raises MissionError (BT221) for a tree with words that are no words of btlang: what they do might move a real
    robot. `further` is where the names of functions of other words that are allowed begin.
    """
    for node in tree.walk():
        entry = vocabulary.entry(node.id)
        if entry is not None and not str(entry.call).startswith((OURS, further)):
            raise MissionError([diagnostic("BT221", node.span or NOWHERE, words=label(node), file=entry.file)])


def tried(mission: Mission, seconds: float = 600.0, patience: float = 6.0, seed: int | None = None) -> dict[str, Any]:
    """The film of a run (see Film.data) of at most so many seconds of the mission and `patience` seconds of real time,
    and what `stopped` it: "" if it ended by itself.

    Raises MissionError for a mission that can't be run, and BT221 for one with words that are no words of btlang: what
    they do might move a real robot.
    """
    check_words(mission.tree, mission.vocabulary, mission.label)
    film = Film(mission)
    _, stopped = simulated(mission, film, seconds, patience, seed=seed)
    return {**film.data(), "stopped": stopped}
