"""Keyword entries bound to the ROS 2 interfaces that their `ros` tables name."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature, signature

from btlang.backends.engine import leaf_binding
from btlang.engine.leaves.leaf import LeafBinding
from btlang.ros.words.clients import RosClients, Unusable
from btlang.ros.words.motion import drive_leaf, joints_leaf
from btlang.ros.words.parameters import parameter_leaf
from btlang.ros.words.servers import action_leaf, phrase_leaf, service_leaf
from btlang.ros.words.topics import publish_leaf, topic_leaf
from btlang.ros.words.word import RosWord
from btlang.vocabulary.entry import COMPARISONS, Entry
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.ros.words.word import Locate

_LEAVES: dict[str, Callable[[RosWord, RosClients], Callable[..., Any]]] = {
    "action": action_leaf,
    "phrase": phrase_leaf,
    "service": service_leaf,
    "publish": publish_leaf,
    "topic": topic_leaf,
    "parameter": parameter_leaf,
    "drive": drive_leaf,
    "joints": joints_leaf,
}


def bind_ros(entry: Entry, vocabulary: Lexicon, clients: RosClients, locate: Locate) -> LeafBinding | None:
    """Bind an entry to a ROS 2 robot; None if it has no `ros` table.

    Makes the clients that the entry needs, and doesn't wait. `locate` gives the pose of a place (see RosWord). Raises
    MissionError (BT104 to BT106) if a type isn't installed or a table doesn't fit it.
    """
    if entry.ros is None:
        return None
    word = RosWord(entry, vocabulary, locate)
    try:
        call = _LEAVES[entry.ros.kind](word, clients)
    except Unusable as error:
        raise word.misfit(entry.ros.interface, entry.ros.name, str(error)) from None
    compared = COMPARISONS if entry.measures else ()  # which are for what compares the quantity
    _name_parameters(call, [slot.name for slot in entry.slots if slot.name not in compared])
    return leaf_binding(entry, vocabulary, call, entry.slots)


def _name_parameters(call: Callable[..., Any], slots: list[str]) -> None:
    """Give a leaf that takes any values the slots of its entry as parameters, so that the engine checks them."""
    own = [p for p in signature(call).parameters.values() if p.kind != Parameter.VAR_KEYWORD]
    own = [p.replace(kind=Parameter.KEYWORD_ONLY) for p in own]
    named = [Parameter(slot, Parameter.KEYWORD_ONLY, default=None) for slot in slots]
    call.__signature__ = Signature([*own, *named])  # type: ignore[attr-defined]
