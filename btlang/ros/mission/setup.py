"""The options of a mission node. Imports no ROS."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.files import read_included
from btlang.robots.registry import connector
from btlang.support.record import Record
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer, make_robot_layer
from btlang.task.store.records import MissionText
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any


class Setup(Record):
    """The options of a mission node. `robot` and `over` are as for Session.

    `file` is the mission that the node runs when activated, "" for none. Missions of other programs may include only
    files below `include_root`, and use only the keyword files of `allowed_keywords`: names of packs, and folders.
    `layer` has further arguments of the TaskLayer.
    """

    name: str = "btlang"
    robot: str = "simulated"
    over: str | None = None
    sim_time: bool = False
    namespace: str = ""
    speed: float | str = "real"
    file: str = ""
    keywords: Sequence[str] = ()
    world: str | None = None
    parser: str = "shunting-yard"
    include_root: str | None = None
    allowed_keywords: Sequence[str] = ()
    language: str = ENGLISH
    layer: Mapping[str, Any] = {}

    def reader(self) -> MissionReader:
        """Return the reader of missions for this robot."""
        return MissionReader(
            self.keywords, self.world, parser=self.parser, language=self.language, include_root=self.include_root,
            allowed_keywords=self.allowed_keywords,
        )  # fmt: skip

    def mission(self, text: str, file: str, reader: MissionReader) -> MissionText | None:
        """Return the mission of the node's parameters; None if they name none. Raises MissionError (BT001, BT002)."""
        if text:
            return MissionText(text)
        if file in ("", self.file):
            return MissionText("", file=file) if file else None
        return MissionText(read_included(file, reader.source("")).text, file)  # any program may set a parameter

    def task_layer(self, reader: MissionReader, **options: Any) -> TaskLayer:
        """Return the task layer of the robot, made with further arguments. Raises MissionError."""
        named = {"sim_time": self.sim_time, "namespace": self.namespace, "name": f"{self.name}_robot"}
        robot = connector(self.robot, self.over, **named)
        return make_robot_layer(robot, reader, speed=self.speed, **self.layer, **options)


def robot_name(namespace: str, name: str) -> str:
    """Return the name of a node's robot for `btc task --name`."""
    return "-".join([*filter(None, namespace.split("/")), name])
