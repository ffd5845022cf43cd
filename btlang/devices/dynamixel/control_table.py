"""The control table of the X series: where a servo keeps what, as its maker's pages say (https://emanual.robotis.com)."""

from __future__ import annotations

from struct import Struct

from btlang.support.record import Record

TICKS = 4096
"""Ticks of a turn. In the middle of it, at 2048, a joint is at 0 degrees."""
CENTRE = 2048
SPEED_UNIT = 0.229 * 6
"""Degrees a second of a unit: velocities come in 0.229 turns a minute."""
MOST_TICKS = 1_048_575
"""How far a servo that counts turns goes to either side."""

OPERATING_MODE, TEMPERATURE_LIMIT, MAX_POSITION, MIN_POSITION = 11, 31, 48, 52
TORQUE, STATUS_RETURN, HARDWARE_ERROR, WATCHDOG, PROFILE_VELOCITY, GOAL_POSITION = 64, 68, 70, 98, 112, 116
LOAD, VELOCITY, POSITION, TEMPERATURE = 126, 128, 132, 146
INDIRECT_ADDRESS = 168

SETTINGS = Struct("<9xBBB19xB12xIii")
"""Bytes 0 to 55: return delay in 2 us, drive mode, operating mode, highest temperature, highest speed, limits of
positions (the high one first)."""
GOAL = Struct("<Ii")
"""Profile velocity and goal position, which are next to each other."""
STATE = Struct("<BBBhiiB")
"""The state that is read in each cycle: torque, hardware error, watchdog, load, velocity, position, temperature."""
STATE_ADDRESSES = (TORQUE, HARDWARE_ERROR, WATCHDOG, *range(LOAD, POSITION + 4), TEMPERATURE)
"""Where the bytes of STATE are; the servo's indirect addresses are set to show them side by side."""
INDIRECT = b"".join(address.to_bytes(2, "little") for address in STATE_ADDRESSES)

WATCHDOG_UNIT = 0.02
"""Seconds of a unit of the watchdog."""
WATCHDOG_TRIPPED = 0xFF
FIRST_FIRMWARE = 38
"""The first firmware with a bus watchdog."""
POSITION_MODE, EXTENDED_MODE, CURRENT_POSITION_MODE = 3, 4, 5
TIME_PROFILE, TORQUE_BY_GOAL = 0x04, 0x08
"""Bits of the drive mode."""
HARDWARE_ERRORS = {
    0x01: "its input voltage is out of range",
    0x04: "it is overheating",
    0x08: "its encoder or motor is broken",
    0x10: "it had an electrical shock",
    0x20: "it is overloaded",
}


class Model(Record):
    """A model of servo: where its indirect data begin, and the raw load that is 100 percent."""

    name: str
    indirect_data: int
    full_load: int


MODELS = {
    1060: Model("XL430-W250", 224, 1000),
    1090: Model("2XL430-W250", 224, 1000),
    1070: Model("XC430-W150", 224, 1000),
    1080: Model("XC430-W240", 224, 1000),
    1160: Model("2XC430-W250", 224, 1000),
    1020: Model("XM430-W350", 224, 1193),
    1030: Model("XM430-W210", 224, 1193),
    1120: Model("XM540-W270", 224, 2047),
    1130: Model("XM540-W150", 224, 2047),
    1190: Model("XL330-M077", 208, 1750),
    1200: Model("XL330-M288", 208, 1750),
    1210: Model("XC330-T181", 208, 910),
    1220: Model("XC330-T288", 208, 910),
    1230: Model("XC330-M181", 208, 910),
    1240: Model("XC330-M288", 208, 910),
}
"""The models by model number."""
