"""What keeps a mission from running on a robot, said before anything moves."""

from __future__ import annotations

from collections.abc import Collection

from btlang.robots.languages import check_languages
from btlang.robots.needs import check_body
from btlang.robots.said_gestures import check_marks
from btlang.robots.zone_check import check_zones

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.body import Body
    from btlang.robots.world import World
    from btlang.tree.node import Tree
    from btlang.vocabulary.lexicon import Lexicon


def check_mission(world: World, body: Body | None, tree: Tree, vocabulary: Lexicon, but: Collection[str] = ()) -> None:
    """Raises MissionError where the body, if it is known, lacks what a leaf needs, a language or a gesture in what it
    says (BT072), where the target of one isn't in the world (BT013), and where a goal is in a closed zone (BT074).

    Leaves with an id in `but` need no parts of the body.
    """
    if body is not None:
        check_body(body, tree, vocabulary, but)
    check_zones(world, tree, vocabulary)
    if body is not None:
        check_marks(world, body, tree, vocabulary)
        check_languages(body, tree, vocabulary)
