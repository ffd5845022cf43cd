"""Who is here: what each open page shows. Nothing is kept once the socket of a page has ended."""

from __future__ import annotations

import asyncio
import itertools
import json

from btlang.server.access import AccessError
from btlang.server.bodies import text_in
from btlang.server.sockets import Visitor
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SCREENS = ("robots", "watch", "tasks", "write", "runs")
MOST_PAGES, MOST_PAGES_OF_USER = 200, 20
LONGEST = 200
"""Characters of the name of a robot or mission."""
_PAUSE = 0.2  # seconds between two lists of people


class Place(Record):
    """What a page shows. `mission` is the name of the one that is open, "" for none; `is_changing` says that it isn't
    saved.
    """

    robot: str
    screen: str
    mission: str
    is_changing: bool


class Presence:
    """In one event loop. All pages that say what they show are sent the list of people whenever it changes."""

    def __init__(self) -> None:
        self._pages: dict[Visitor, tuple[int, Place]] = {}
        self._numbers = itertools.count(1)
        self._sending: asyncio.TimerHandle | None = None

    def show(self, visitor: Visitor, data: dict[str, Any]) -> int:
        """A page shows something else. Returns its number in the list. Raises AccessError (400, 403, 429)."""
        if not visitor.identity.is_session:
            raise AccessError(403, "Only pages say what they show: a program isn't a person.")
        place = _place_in(data)
        number, before = self._pages.get(visitor, (0, None))
        if before is None:
            self._make_room(visitor)
            number = next(self._numbers)
        if place != before:
            self._pages[visitor] = number, place
            self._changed()
        return number

    def leave(self, visitor: Visitor) -> None:
        """The socket of a page has ended."""
        if self._pages.pop(visitor, None) is not None:
            self._changed()

    def _make_room(self, visitor: Visitor) -> None:
        user = visitor.identity.user
        own = sum(page.identity.user == user for page in self._pages)
        if own >= MOST_PAGES_OF_USER or len(self._pages) >= MOST_PAGES:
            raise AccessError(429, "Too many pages are open to list them all.")

    def _changed(self) -> None:
        if self._sending is None:
            self._sending = asyncio.get_running_loop().call_later(_PAUSE, self._send)

    def _send(self) -> None:
        self._sending = None
        people = [
            {
                "page": number, "user": page.identity.user, "robot": place.robot, "screen": place.screen,
                "mission": place.mission, "changing": place.is_changing,
            }
            for page, (number, place) in self._pages.items()
        ]  # fmt: skip
        text = json.dumps({"type": "people", "people": people}, separators=(",", ":"))
        for page in self._pages:
            page.outlet.keep("people", text, 1)


def _place_in(data: dict[str, Any]) -> Place:
    robot, screen, mission = (text_in(data, name) for name in ("robot", "screen", "mission"))
    is_changing = data.get("changing")
    if screen not in SCREENS:
        raise AccessError(400, f"'screen' must be one of these: {', '.join(SCREENS)}.")
    if max(len(robot), len(mission)) > LONGEST:
        raise AccessError(400, f"'robot' and 'mission' must have at most {LONGEST} characters.")
    if not isinstance(is_changing, bool):
        raise AccessError(400, "'changing' must be true or false.")
    return Place(robot, screen, mission, is_changing)
