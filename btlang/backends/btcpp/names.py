"""IDs of trees: BehaviorTree.CPP 4.10 and Groot2 refuse some that a mission may use, such as those with spaces.

Their rules: docs/name_validation_rules.md of BehaviorTree.CPP.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from btlang.frontends.btcpp.spelling import IN_NO_ID, KINDS, MAIN_TREE
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Tree

_REFUSED = re.compile(f"[{IN_NO_ID}{{}}]+")
"""Also braces, which they take; but a name in braces looks like a reference."""
_RESERVED = frozenset(("", "Root", "root", *KINDS, *CATALOGUE))


def tree_ids(tree: Tree, leaves: Iterable[str], dialect: int) -> dict[str, str]:
    """The ID of each tree by its name, "" being the name of a main tree without one.

    No two are the same, none is the id of a node, and in format 4 each keeps to the rules.
    """
    ids = {tree.name: tree.name or MAIN_TREE}
    taken = {*_RESERVED, *leaves}
    wanted = [tree.name or MAIN_TREE, *(name for name, _ in tree.subtrees)]
    for at, name in enumerate(wanted):
        plain = _REFUSED.sub("_", name).strip("_") if dialect == 4 else name
        made = plain or "tree"
        number = 2
        while made in taken:
            made = f"{plain or 'tree'}_{number}"
            number += 1
        taken.add(made)
        ids[tree.name if at == 0 else name] = made
    return ids
