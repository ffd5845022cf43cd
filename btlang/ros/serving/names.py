"""The names of served actions, so that clients with the same words find them, and which actions a server serves."""

from __future__ import annotations

import re
from collections.abc import Sequence

from btlang.text.spelling import nearest
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.ros_binding import RosBinding

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.vocabulary.entry import Entry


RUN_PHRASE = "btlang_interfaces/action/RunPhrase"
"""The type of all served actions."""
WORD, SILENCE = 2.0, 10.0
"""Real seconds after which a server repeats its feedback, and after which a client takes it for dead without any."""
FOLDER = "actions"
"""The prefix of their names, after the namespace of the node."""


def action_name(node_id: str) -> str:
    """Return the name of an action by its id: `MoveForward` is served as `move_forward`. "" if ROS 2 allows no such
    name.
    """
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", node_id).lower()
    return name if re.fullmatch(r"[a-z][a-z0-9_]*", name) and "__" not in name else ""


def use_server(entry: Entry, vocabulary: Lexicon, servers: str) -> Entry:
    """Return an entry as one that is served by its name in the folder `servers`; one with a
    `ros` table stays as it is.
    """
    if entry.sort != "action" or entry.ros is not None:
        return entry
    slots = {slot.name: slot for same in vocabulary.entries[entry.id] for slot in same.slots}
    binding = RosBinding("phrase", entry.id, f"{servers}/{action_name(entry.id)}")
    made: Entry = entry.replace(slots=tuple(slots.values()), ros=binding)
    return made


def find_servable(vocabulary: Lexicon, *, ros: bool) -> list[str]:
    """Return the ids of actions that Python or a ROS 2 interface does, but not another server of actions."""
    found = []
    for node_id, entries in vocabulary.entries.items():
        kinds = [entry.ros.kind for entry in entries if entry.ros is not None] if ros else []
        if entries[0].sort == "action" and (entries[0].call or kinds) and "phrase" not in kinds:
            found.append(node_id)
    return found


def choose_actions(only: Sequence[str], ids: Sequence[str], vocabulary: Lexicon) -> list[str]:
    """Return the ids that have one of these names, or are listed under such a topic; all if none is given.

    Raises ValueError for an unknown name, and for two actions with the same name in ROS.
    """
    named: dict[str, list[str]] = {}
    for node_id in ids:
        for name in {node_id.lower(), action_name(node_id), vocabulary.entries[node_id][0].topic.lower()} - {""}:
            named.setdefault(name, []).append(node_id)
    for name in only:
        if name.lower() not in named:
            near = nearest(name.lower(), named, 1)
            raise ValueError(f"--only: there is no action '{name}'" + (f"; similar: {near[0]}" if near else ""))
    found = list(dict.fromkeys(node_id for name in only for node_id in named[name.lower()])) if only else list(ids)
    served: dict[str, str] = {}
    for node_id in found:
        name = action_name(node_id)
        if not name or name in served:
            known = f"{served[name]} has the same" if name else "it takes a-z, digits and single _"
            raise ValueError(f"{node_id} has no valid ROS 2 name: {known}; use --only")
        served[name] = node_id
    return found
