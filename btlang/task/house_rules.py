"""House rules: what holds during every mission and between them, as rules in English in one file."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold

_PREFIX = "house "
"""Of the names that the rules define, in the tree of a mission, which may define the same ones."""
_ROLES = ("whenever", "reaction", "work")
_EXAMPLE = "whenever the battery is below 20%, go to the dock then charge to 80%"


class HouseRules:
    """The rules of a robot, the first one the most important. Made by `house_rules` or `no_house_rules`."""

    def __init__(self, mission: Mission | None) -> None:
        self._mission = mission
        self._rules: list[Node] = []
        node = None if mission is None else mission.tree.root
        while node is not None and _is_rule(node):
            self._rules.append(node)
            node = node.children[2]

    @property
    def idle(self) -> Mission | None:
        """The rules alone, a mission that goes on for ever; None if there are none."""
        return self._mission

    def around(self, mission: Mission) -> Mission:
        """The same mission under the rules: a rule suspends it as any rule does, and then it goes on."""
        if self._mission is None:
            return mission
        root = mission.tree.root
        for rule in reversed(self._rules):
            condition, reaction, _ = rule.children
            root = rule.replace(children=(_renamed(condition), _renamed(reaction), root))
        own = tuple((_PREFIX + name, _renamed(body)) for name, body in self._mission.tree.subtrees)
        around: Mission = mission.replace(
            tree=Tree(root, (*own, *mission.tree.subtrees)), facts=(*self._mission.facts, *mission.facts)
        )
        return around

    @property
    def reactions(self) -> list[str]:
        """The paths of what the rules do, in the tree of a mission under them."""
        return ["/" + "2/" * depth + "1" for depth in range(len(self._rules))]

    def is_own(self, path: str) -> bool:
        """Whether a node at this path belongs to a rule and not to the mission."""
        return not path.startswith("/" + "2/" * (len(self._rules) - 1) + "2") if self._rules else False


def no_house_rules() -> HouseRules:
    """A robot without any."""
    return HouseRules(None)


def house_rules(mission: Mission) -> HouseRules:
    """Those in a mission. Raises MissionError (BT188) if there is anything but rules in it."""
    node = mission.tree.root
    while _is_rule(node):
        node = node.children[2]
    if node is mission.tree.root or not _watches_on(node):
        raise MissionError([diagnostic("BT188", node.span or NOWHERE, example=_EXAMPLE)])
    return HouseRules(mission)


def _is_rule(node: Node) -> bool:
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.roles == _ROLES


def _watches_on(node: Node) -> bool:
    """Whether it is what lowering puts where rules stand alone: it goes on for ever, and does nothing."""
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.endless and not node.children[0].children


def _renamed(root: Node) -> Node:
    """With the names of the rules for subtrees."""

    def renamed(node: Node, children: list[Node]) -> Node:
        own = {"ID": _PREFIX + node.port("ID")} if node.id == SUBTREE else {}
        ports = tuple((port, own.get(port, text)) for port, text in node.ports)
        return node.replace(children=tuple(children), ports=ports)  # type: ignore[no-any-return]

    return fold(root, lambda node: node.children, renamed)
