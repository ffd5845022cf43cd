"""Which goals of a mission lie in zones to keep out of: said before anything moves."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.robots.geometry import Point
from btlang.robots.needs import needs_of, words_of
from btlang.robots.world import World
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon

_OPENS = "OpenZone"
"""The id of the word that lets the robot into a zone."""


def check_zones(world: World, tree: Tree, vocabulary: Lexicon) -> None:
    """Raises MissionError for each journey into a zone to keep out of that the mission doesn't open (BT074).

    Only what the mission says is looked at: not goals that it computes, nor zones that it closes itself.
    """
    closed = [zone for zone in world.zones if zone.is_closed]
    if not closed:
        return
    opened = {node.port("zone").lower() for node in tree.walk() if node.id == _OPENS}
    closed = [zone for zone in closed if zone.name.lower() not in opened]
    places = {place.name.lower(): (place.x, place.y) for place in world.places}
    problems: list[Diagnostic] = []
    for node in tree.walk():
        if closed and "navigation" in needs_of(node, vocabulary):
            for point in _goals(node, places, vocabulary):
                zone = next((zone for zone in closed if zone.contains(point)), None)
                if zone is not None:
                    place = node.span or NOWHERE
                    problems.append(diagnostic("BT074", place, words=words_of(node), zone=zone.name))
    if problems:
        raise MissionError(problems)


def _goals(node: Node, places: dict[str, Point], vocabulary: Lexicon) -> Iterator[Point]:
    """The places and the point that are the goals of a leaf."""
    slots = {slot.name: slot.type for entry in vocabulary.entries.get(node.id, ()) for slot in entry.slots}
    for name, value in node.ports:
        if slots.get(name) == "place" and value.lower() in places:
            yield places[value.lower()]
    try:
        yield float(node.port("x")), float(node.port("y"))
    except ValueError:
        return
