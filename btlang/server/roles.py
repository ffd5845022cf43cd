"""What people may do."""

from __future__ import annotations

from enum import StrEnum

from btlang.task import messages
from btlang.task.messages import Command


class Role(StrEnum):
    """Each may do what those before it may."""

    VIEWER = "viewer"
    OPERATOR = "operator"
    EDITOR = "editor"
    ADMINISTRATOR = "administrator"

    def covers(self, other: Role) -> bool:
        """Whether it may do what the other one may."""
        order = list(Role)
        return order.index(self) >= order.index(other)


_VIEWER = (
    messages.List, messages.Show, messages.Schedules, messages.Library, messages.Status, messages.Report,
    messages.EmergencyStop, messages.Components, messages.Picture, messages.Voice,
    messages.Urdf,
)  # fmt: skip
_OPERATOR = (
    messages.Submit, messages.Cancel, messages.Kill, messages.Interrupt, messages.Resume, messages.Skip,
    messages.Reorder, messages.Again, messages.AddSchedule, messages.RemoveSchedule, messages.Pause, messages.Step,
    messages.Release, messages.Say, messages.Trail, messages.AnswerQuestion, messages.Talk,
    messages.InviteVisitor,
)  # fmt: skip
_EDITOR = (messages.Put, messages.Delete)
_ADMINISTRATOR = (messages.Down, messages.ChangeComponent)

NEEDED: dict[type[Command], Role] = {
    **dict.fromkeys(_VIEWER, Role.VIEWER),
    **dict.fromkeys(_OPERATOR, Role.OPERATOR),
    **dict.fromkeys(_EDITOR, Role.EDITOR),
    **dict.fromkeys(_ADMINISTRATOR, Role.ADMINISTRATOR),
}
"""The least role for each command. Everybody who is logged in may stop the robot; to let it move is another act."""
