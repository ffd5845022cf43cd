"""The `ros` table of a keyword entry as data: how a phrase uses an interface of a ROS 2 robot."""

from __future__ import annotations

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Value: TypeAlias = "str | bool | int | float | Fields | tuple[Value, ...]"


class Fields(Record):
    """Fields of a message by their paths, in the order written, and what to fill them with."""

    given: tuple[tuple[str, Value], ...]


class RosBinding(Record):
    """`kind` is one of those of ros_table.py; `interface` is what stands behind it, a type such as std_msgs/msg/String
    or the name of a parameter; `name` is that of the topic, service, action or node; `options` are the other keys.
    """

    kind: str
    interface: str
    name: str
    options: tuple[tuple[str, Value], ...] = ()

    def get(self, key: str, default: Any = None) -> Any:
        """The value of another key."""
        return dict(self.options).get(key, default)
