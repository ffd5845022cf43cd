"""docs/devices.md and docs/components.md say what the code says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from btlang.components.component import TRANSITIONS
from btlang.devices.driver import DRIVERS, SIMULATED
from btlang.devices.kinds import KINDS
from btlang.devices.simulated import _OPTIONS
from btlang.robots.bodies.body import ComponentPart, Device

DOCS = Path(__file__).parent.parent.parent / "docs"
DEVICES = (DOCS / "devices.md").read_text(encoding="utf-8")
COMPONENTS = (DOCS / "components.md").read_text(encoding="utf-8")


def cells(line: str) -> list[list[str]]:
    """What is in back quotes in each cell of a table's row."""
    return [re.findall(r"`([a-z_A-Z]+)`", cell) for cell in line.strip("|").split("|")]


@pytest.mark.parametrize("kind", KINDS.values(), ids=lambda kind: kind.name)
def test_the_table_of_kinds(kind) -> None:
    rows = [cells(line) for line in DEVICES.splitlines() if line.startswith(f"| `{kind.name}` |")]
    [row] = [row for row in rows if len(row) == 4]
    _, reading, command, calibrated = row
    for told, record in ((reading, kind.reading), (command, kind.command)):
        named = [name for name in told if name != "inf"]
        assert named == ([] if record is None else [record.__name__, *record.fields])
    assert {name for name in calibrated if name != "offset"} == {*kind.scaled, *kind.shifted}


def test_what_moves_is_named() -> None:
    [line] = [line for line in DEVICES.splitlines() if "are brought to rest within 0.2 s" in line]
    assert re.findall(r"`(\w+)`", line) == [kind.name for kind in KINDS.values() if kind.moves]


def test_every_key_option_and_driver_is_named() -> None:
    for name in ("class" if field == "place" else field for field in ComponentPart.fields):
        assert f"| `{name}` |" in COMPONENTS
    assert [name for name in Device.fields if f"`{name}`" not in DEVICES] == []
    simulated = {"noise", "delay", "silent", "frozen", *(name for names in _OPTIONS.values() for name in names)}
    assert [name for name in simulated if f"`{name}" not in DEVICES] == []
    assert [name for name in (SIMULATED, *DRIVERS) if f'`"{name}"`' not in DEVICES] == []
    assert [each.hook for each in TRANSITIONS.values() if f"| `{each.hook}` |" not in COMPONENTS] == []
