"""What the prompt begins with: the map of its world, three things to try there, and how to see more."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from itertools import islice, pairwise

from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.explanations.suggestions import example_commands
from btlang.repl.draft import MissionDraft
from btlang.run.robot_state import read_robot
from btlang.text.output import is_unicode
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from rich.text import Text

_TRIES = 3
_MORE = "More: 'help' explains, 'words' lists what you can say. Ctrl-D twice leaves."
_MOST_COLUMNS, _MOST_ROWS, _OTHER_ROWS = 100, 18, 10  # of the map, and rows of the terminal that it leaves free


def world_map(draft: MissionDraft, columns: int, rows: int) -> Text | None:
    """Return the map of the world with the robot in it, None if there's none or no room for it."""
    drawn = draft.session.map(is_unicode(sys.stdout))
    if drawn is None:
        return None
    height = min(rows - _OTHER_ROWS, _MOST_ROWS)
    return drawn.text(read_robot(draft.session.robot), min(columns, _MOST_COLUMNS), height)


def welcome(draft: MissionDraft) -> str:
    """Return what follows the map: what can be tried in this world, and how to see more."""
    tries = list(islice(_tries(draft), _TRIES)) or example_commands(draft.vocabulary)
    lines = [f"{'Try:' if number == 0 else '':5}{line}" for number, line in enumerate(tries)]
    return "\n".join([*lines, _MORE])


def _tries(draft: MissionDraft) -> Iterator[str]:
    """Yield what can be said about what the world has, the most telling first. These are English."""
    if draft.language != ENGLISH:
        return
    names = draft.session.world.names
    places, people, objects = [*names.places], [*names.people], [*names.objects]
    middle = places[len(places) // 3 :]  # the first one is often where the robot is
    wanted = [f"go to the {place}, then wave" for place in middle[:1]]
    wanted += [f"bring the {thing} to {person}" for thing in objects[:1] for person in people[:1]]
    wanted += [f'go to {person}, then say "Hello, {person}!"' for person in people[1:2] or people[:1]]
    wanted += [f"visit the {one} and the {other}" for one, other in pairwise(middle)]
    for text in [*wanted, "wave", 'say "Hello!"', "turn around"]:
        try:
            draft.compile(text, suggest=False)
        except MissionError:  # in words of another kind, or with a robot that lacks a part
            continue
        yield text
