"""House rules: what holds during every mission of a robot and between them."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.text.formatting import one_line
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.run.snapshot import WatchedNodes

_PREFIX = "house "
"""The prefix of names that the rules define, in the tree of a mission, which may define the same ones."""
_ROLES = ("whenever", "reaction", "work")
_EXAMPLE = "whenever the battery is below 20%, go to the dock then charge to 80%"


class HouseRules:
    """The rules of a robot, the first one the most important. Made by `read_house_rules` or `no_house_rules`."""

    def __init__(self, mission: Mission | None) -> None:
        self._mission = mission
        self.rules: list[Node] = []
        """The nodes of the rules, the first one the most important."""
        node = None if mission is None else mission.tree.root
        while node is not None and _is_rule(node):
            self.rules.append(node)
            node = node.children[2]

    @property
    def idle(self) -> Mission | None:
        """The rules alone, a mission that goes on for ever; None if there are none."""
        return None if self._mission is None else self._mission.replace(rules=self._mission)

    def around(self, mission: Mission) -> Mission:
        """Return the same mission under the rules: a rule suspends it as any rule does, and then it goes on."""
        if self._mission is None:
            return mission
        root = mission.tree.root
        for rule in reversed(self.rules):
            condition, reaction, _ = rule.children
            root = rule.replace(children=(_rename(condition), _rename(reaction), root))
        own = tuple((_PREFIX + name, _rename(body)) for name, body in self._mission.tree.subtrees)
        around: Mission = mission.replace(
            tree=Tree(root, (*own, *mission.tree.subtrees)),
            facts=(*self._mission.facts, *mission.facts),
            rules=self._mission,
        )
        return around

    def inside(self, mission: Mission) -> Mission:
        """Return the mission that `around` was given, of what it returned."""
        root = mission.tree.root
        for _ in self.rules:
            root = root.children[-1] if root.children else root
        own = tuple(each for each in mission.tree.subtrees if not each[0].startswith(_PREFIX))
        inner: Mission = mission.replace(tree=Tree(root, own))
        return inner

    @property
    def words(self) -> list[str]:
        """The words of each rule as they were written, in a line."""
        return ["" if rule.span is None else one_line(" ".join(rule.span.text.split())) for rule in self.rules]

    @property
    def reactions(self) -> list[str]:
        """The paths of what the rules do, in the tree of a mission under them."""
        return ["/" + "2/" * depth + "1" for depth in range(len(self.rules))]

    def is_own(self, path: str) -> bool:
        """Return whether a node at this path belongs to a rule and not to the mission."""
        return not path.startswith("/" + "2/" * (len(self.rules) - 1) + "2") if self.rules else False


def no_house_rules() -> HouseRules:
    """Return the rules of a robot that has none."""
    return HouseRules(None)


def read_house_rules(mission: Mission) -> HouseRules:
    """Read the rules in a mission. Raises MissionError (BT188) if there is anything but rules in it."""
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
    """Return whether it is what lowering puts where rules stand alone: it goes on for ever, and does nothing."""
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.endless and not node.children[0].children


def _rename(root: Node) -> Node:
    """Return a tree with the names of the rules for subtrees."""

    def renamed(node: Node, children: list[Node]) -> Node:
        own = {"ID": _PREFIX + node.port("ID")} if node.id == SUBTREE else {}
        ports = tuple((port, own.get(port, text)) for port, text in node.ports)
        return node.replace(children=tuple(children), ports=ports)  # type: ignore[no-any-return]

    return fold(root, lambda node: node.children, renamed)


def describe_rules(mission: Mission, nodes: WatchedNodes) -> dict[str, Any]:
    """Return what a page shows of the house rules round a mission, whose `nodes` are those of its run.

    - `rules`: of each rule, the most important first, the number of its node, that of what it does, and its words;
    - `root`: the number of the first node of the mission itself.
    """
    found, at = [], 0
    for rule in HouseRules(mission.rules).rules:
        _, acts, rest = (index for index in range(at + 1, nodes.size) if nodes.parent(index) == at)
        words = "" if rule.span is None else rule.span.text.partition("\n")[0].rstrip(" :")
        found.append([at, acts, one_line(words)])
        at = rest
    return {"rules": found, "root": at}
