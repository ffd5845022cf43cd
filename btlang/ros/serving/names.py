"""Under which names actions are served, so that whoever has the same words finds them."""

from __future__ import annotations

import re

from btlang.vocabulary.ros_binding import RosBinding

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon

RUN_PHRASE = "btlang_interfaces/action/RunPhrase"
"""The type of them all."""
WORD, SILENCE = 2.0, 10.0
"""Real seconds after which a server repeats its feedback, and after which a client takes it for dead without any."""
FOLDER = "actions"
"""What stands before their names, behind the namespace of the node."""


def action_name(node_id: str) -> str:
    """Of an action by its id: `MoveForward` is served as `move_forward`. "" where ROS 2 allows no such name."""
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", node_id).lower()
    return name if re.fullmatch(r"[a-z][a-z0-9_]*", name) and "__" not in name else ""


def served(entry: Entry, vocabulary: Lexicon, servers: str) -> Entry:
    """An action as one that is served by its name in the folder `servers`; what has a `ros` table stays as it is."""
    if entry.sort != "action" or entry.ros is not None:
        return entry
    slots = {slot.name: slot for same in vocabulary.entries[entry.id] for slot in same.slots}
    binding = RosBinding("phrase", entry.id, f"{servers}/{action_name(entry.id)}")
    made: Entry = entry.replace(slots=tuple(slots.values()), ros=binding)
    return made
