"""Two recorded runs as data that a page shows side by side."""

from __future__ import annotations

from contextlib import ExitStack

from btlang.recording.compare import describe_step, ended_differently, first_pair, run_differences
from btlang.recording.diff import mission_differences
from btlang.recording.film import Film
from btlang.recording.open import opened
from btlang.recording.story import Story

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def side_by_side(one: str, other: str) -> dict[str, Any]:
    """Two recordings, by their paths, as JSON has it; runs nothing. Raises MissionError for what can't be read.

    - `films`: see Film.data; `stories`: what only one of the runs did, as `btc diff` writes it;
    - `missions`: what differs between their trees, as `btc diff` writes it; nodes are compared only where nothing does:
    - `first`: of each run the time, node and words of the first change of status that the other one doesn't have, with
      None and -1 for a run that has no more; None if there is none. Times don't count;
    - `ended`: the numbers of the nodes whose last status isn't the same.
    """
    with ExitStack() as stack:
        sides = [stack.enter_context(opened(path, ())) for path in (one, other)]
        films = [Film(mission, dict(recording.about)) for recording, mission, _ in sides]
        events = [list(recording.events(nodes)) for recording, _, nodes in sides]
        stories = [
            Story(mission, nodes, {}).take(happened)
            for (_, mission, nodes), happened in zip(sides, events, strict=True)
        ]
        missions = list(mission_differences(sides[0][1], sides[1][1]))
        pair = None if missions else first_pair(*events)
        first = pair and [
            {
                "t": None if step is None else step[0], "node": -1 if step is None else step[1],
                "words": describe_step(step, nodes.node, mission.label),
            }
            for step, (_, mission, nodes) in zip(pair, sides, strict=True)
        ]  # fmt: skip
        return {
            "films": [film.take(happened).data() for film, happened in zip(films, events, strict=True)],
            "stories": list(run_differences(*(story.body() for story in stories))),
            "missions": missions,
            "first": first,
            "ended": [] if missions else ended_differently(*events),
        }
