"""Names of things in the world as parts of names of topics and services."""

from __future__ import annotations

import re
from collections.abc import Iterable

_LONGEST = 50


def graph_names(names: Iterable[str], kind: str) -> dict[str, str]:
    """A token for each name: "lab_door" for "lab door". What has no letter that ROS 2 allows is called by its kind.

    A token that is taken gets a number, in the order of the names.
    """
    tokens: dict[str, str] = {}
    for name in names:
        token = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")[:_LONGEST].strip("_")
        first = token if token[:1].isalpha() else f"{kind}_{token}".strip("_")
        token, count = first, 1
        while token in tokens.values():
            count += 1
            token = f"{first}_{count}"
        tokens[name] = token
    return tokens
