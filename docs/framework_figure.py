"""The figure of docs/framework.md: the layers of btlang, with their modules."""

from __future__ import annotations

from btlang.pictures.drawing import SvgSurface
from btlang.pictures.surface import INK, SMALL, SOFT, TITLE

CLIENTS = ("page", "HTTP, WebSocket", "programs", "ROS 2")
LAYERS = (
    (
        "Representative server", "who may say what to which robot",
        ("server/accounts", "server/http", "server/live", "server/fleet"), "commands",
    ),
    (
        "Task layer", "which mission is due, which one waits",
        ("task/commands", "task/execution", "task/schedule", "task/store"), "one run at a time",
    ),
    (
        "Behavior trees", "sentences, a tree, ticks",
        ("frontends/mission", "passes", "engine", "run/runner.py"), "actions and conditions",
    ),
    (
        "Component layer", "what the robot can do",
        ("actions", "robots/robot.py", "robots/motion", "components/manager.py"), "readings and commands",
    ),
    (
        "Hardware layer", "motors, sensors, speakers",
        ("devices/kinds.py", "devices/loop.py", "devices/driver.py", "ros/devices"), "",
    ),
)  # fmt: skip
"""From top to bottom: what each is, what it decides, its modules below btlang, and what goes to the next one."""
STOP = ("task/commands", "task/execution", "run/controls.py", "robots/command_gate.py")
"""The modules on the way of the emergency stop."""
_FILL, _EDGE, _ALARM, _PALE = "#f8faf8", "#4f7d62", "#c0440c", "#fde4da"


def draw_layers() -> bytes:
    """The layers, one below the other, and beside them the way of the emergency stop."""
    width, high, gap, top, left, wide = 640.0, 66.0, 34.0, 60.0, 16.0, 470.0
    bottom = top + len(LAYERS) * (high + gap) - gap
    sheet = SvgSurface(width, bottom + 16, "The five layers of btlang")
    each = wide / len(CLIENTS)
    for number, client in enumerate(CLIENTS):
        sheet.box(left + number * each + 4, 12, each - 8, 20, round=10, fill="#ffffff", edge=SOFT)
        sheet.text(left + (number + 0.5) * each, 22, client, align="center")
    _arrow(sheet, left + wide / 2, 32, top)
    for number, (title, does, modules, sends) in enumerate(LAYERS):
        y = top + number * (high + gap)
        with sheet.group(title):
            sheet.box(left, y, wide, high, round=6, fill=_FILL, edge=_EDGE)
            sheet.text(left + 12, y + 16, title, size=TITLE, colour=_EDGE, bold=True)
            sheet.text(left + wide - 12, y + 16, does, align="right")
            for place, module in enumerate(modules):
                chip = (wide - 16) / len(modules)
                sheet.box(left + 8 + place * chip + 3, y + 32, chip - 6, 22, round=3, fill="#ffffff", edge=SOFT)
                sheet.text(left + 8 + (place + 0.5) * chip, y + 43, module, size=SMALL, colour=INK, align="center")
        if sends:
            _arrow(sheet, left + wide / 2, y + high, y + high + gap)
            sheet.text(left + wide / 2 + 10, y + high + gap / 2, sends, colour=SOFT)
    with sheet.group("Emergency stop"):
        at, deep = left + wide + 40, bottom - 12
        sheet.box(at, 12, width - at - 12, deep, round=6, fill=_PALE, edge=_ALARM)
        middle = (at + width - 12) / 2
        sheet.text(middle, 30, "Emergency", size=TITLE, colour=_ALARM, bold=True, align="center")
        sheet.text(middle, 44, "stop", size=TITLE, colour=_ALARM, bold=True, align="center")
        for place, module in enumerate(STOP):
            y = top + 30 + place * (deep - 90) / len(STOP)
            sheet.text(middle, y, module, size=SMALL, align="center")
            if place:
                _arrow(sheet, middle, y - (deep - 90) / len(STOP) + 10, y - 10, _ALARM)
        for layer in (3, 4):
            y = top + layer * (high + gap) + high / 2
            sheet.line(((at, y), (left + wide + 7, y)), colour=_ALARM)
            sheet.polygon(((left + wide + 1, y), (left + wide + 8, y - 4), (left + wide + 8, y + 4)), fill=_ALARM)
    return sheet.encode(".svg")


def _arrow(sheet: SvgSurface, x: float, start: float, end: float, colour: str = SOFT) -> None:
    sheet.line(((x, start), (x, end - 7)), colour=colour)
    sheet.polygon(((x, end), (x - 4, end - 8), (x + 4, end - 8)), fill=colour)
