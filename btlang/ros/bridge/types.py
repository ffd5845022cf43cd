"""Types of ROS 2 that clients name: nothing else is imported for them."""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from pathlib import Path

from btlang.ros.bridge.replies import BridgeError
from btlang.text.escaping import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_TYPE = re.compile(r"([a-z][a-z0-9_]{0,99})/(?:(msg|srv|action)/)?([A-Z][A-Za-z0-9_]{0,99})")
_FORMS = {"msg": "a type of messages", "srv": "a type of services", "action": "a type of actions"}


@cache
def type_of(name: str, kind: str) -> Any:
    """The class of a type, with or without its kind: std_msgs/msg/String, std_msgs/String. Raises BridgeError."""
    found = _TYPE.fullmatch(name)
    shown = one_line(name[:100])
    if found is None:
        raise BridgeError(f"'{shown}' isn't a type. Write for example: std_msgs/msg/String.")
    if found[2] not in (None, kind):
        raise BridgeError(f"'{shown}' isn't {_FORMS[kind]}.")
    if not _is_interfaces(found[1]):
        raise BridgeError(f"There's no package of interfaces called '{found[1]}' on this computer.")
    try:
        return getattr(import_module(f"{found[1]}.{kind}"), found[3])
    except (ImportError, AttributeError):
        raise BridgeError(f"There's no type '{found[1]}/{kind}/{found[3]}' on this computer.") from None


def _is_interfaces(package: str) -> bool:
    """Whether rosidl made it. To import any other package would run the code of that."""
    spec = PathFinder.find_spec(package)
    folders = (spec.submodule_search_locations or ()) if spec is not None else ()
    return any(any(Path(folder).glob("*__rosidl_typesupport_c*")) for folder in folders)
