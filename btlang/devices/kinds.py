"""The kinds of devices: their readings and commands, in metres, degrees, seconds and percent; and images as PNG."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence

from btlang.support.record import Record

_SIGNATURE = b"\x89PNG\r\n\x1a\n"


class Reading(Record):
    """A reading of a device. None stands for a quantity that it doesn't measure."""


class Command(Record):
    """A command to a device; made without arguments, it brings the device to rest."""


class Distance(Reading):
    """A reading of an ultrasonic or infrared sensor: metres to the nearest thing in its cone, inf for none in range."""

    distance: float


class Scan(Reading):
    """A reading of a lidar: metres, inf if nothing is in range, NaN for a beam without a valid measurement.

    The first one is `start` degrees left of ahead, then every `step` degrees.
    """

    ranges: Sequence[float]
    start: float = 0.0
    step: float = 1.0


class Wheels(Reading):
    """A reading of the encoders of two driven wheels: metres that each has rolled since the
    start, and metres a second.
    """

    left: float
    right: float
    left_speed: float
    right_speed: float


class WheelSpeeds(Command):
    """A command to two driven wheels: metres a second of each."""

    left: float = 0.0
    right: float = 0.0


class Motion(Reading):
    """A reading of an inertial unit.

    Degrees a second to the left, metres a second squared ahead, left and up, and the heading in degrees since it was
    switched on.
    """

    turning: float
    ahead: float | None = None
    left: float | None = None
    up: float | None = None
    heading: float | None = None


class Charge(Reading):
    """A reading of a battery: percent left, volts, amperes into it, degrees Celsius."""

    percent: float
    volts: float | None = None
    amperes: float | None = None
    temperature: float | None = None
    charging: bool | None = None


class JointState(Reading):
    """A reading of a servo: degrees (metres if it slides), those a second, load in percent, degrees Celsius."""

    position: float
    speed: float = 0.0
    load: float | None = None
    temperature: float | None = None
    loose: bool = False


class JointTarget(Command):
    """A command to a servo: degrees (metres) to go to, at most that fast; None: stay. `loose` takes its torque away."""

    position: float | None = None
    speed: float | None = None
    loose: bool = False


class Grip(Reading):
    """A reading of a hand: how far it is closed, 0 to 1, and whether something is in it."""

    closed: float
    holds: bool | None = None


class GripTarget(Command):
    """A command to a hand: how far to close, 0 to 1; None: stay."""

    closed: float | None = None


class Image(Reading):
    """A reading of a camera: rows of pixels from the top, three bytes (red, green, blue) each."""

    width: int
    height: int
    pixels: bytes

    def smaller(self, widest: int) -> Image:
        """Return the image at most so many pixels wide: every second pixel, or third one, and so on."""
        each = -(-self.width // widest)
        if each <= 1:
            return self
        rows = [self.pixels[3 * self.width * y : 3 * self.width * (y + 1)] for y in range(0, self.height, each)]
        wide = len(range(0, self.width, each))
        parts = [b"".join(row[3 * x : 3 * x + 3] for x in range(0, self.width, each)) for row in rows]
        return Image(wide, len(rows), b"".join(parts))


class Sound(Reading):
    """A reading of a microphone: samples since the last reading, 16 bits signed, little-endian, one channel."""

    samples: bytes
    rate: int


class Play(Command):
    """A command to a speaker: samples as those of Sound; none: silence at once."""

    samples: bytes = b""
    rate: int = 16_000


class Playing(Reading):
    """A reading of a speaker: seconds that it still has to play."""

    left: float


class Pressed(Reading):
    """A reading of a button or a bumper."""

    pressed: bool


class Measured(Reading):
    """A reading of any other sensor, such as a thermometer, in its usual unit."""

    value: float


class Colour(Command):
    """A command to a light: red, green and blue, 0 to 1."""

    red: float = 0.0
    green: float = 0.0
    blue: float = 0.0


class Shown(Command):
    """A command to a display: the text to show."""

    text: str = ""


class DeviceKind(Record):
    """A kind of device: its readings and its commands, None if it has none.

    `moves`: it is brought to rest as soon as either side is silent. A calibration scales the fields named in `scaled`,
    and both scales and shifts those in `shifted`, in readings and in commands.
    """

    name: str
    reading: type[Reading] | None = None
    command: type[Command] | None = None
    moves: bool = False
    scaled: tuple[str, ...] = ()
    shifted: tuple[str, ...] = ()

    @property
    def rest(self) -> Command | None:
        """The command that brings a device that moves to rest; None for others."""
        return self.command() if self.moves and self.command is not None else None


KINDS = {
    kind.name: kind
    for kind in (
        DeviceKind("range", Distance, shifted=("distance",)),
        DeviceKind("lidar", Scan),
        DeviceKind("drive", Wheels, WheelSpeeds, moves=True, scaled=("left", "right", "left_speed", "right_speed")),
        DeviceKind("imu", Motion, shifted=("turning",)),
        DeviceKind("battery", Charge, shifted=("percent",)),
        DeviceKind("joint", JointState, JointTarget, moves=True, scaled=("speed",), shifted=("position",)),
        DeviceKind("hand", Grip, GripTarget, moves=True),
        DeviceKind("camera", Image),
        DeviceKind("microphone", Sound),
        DeviceKind("speaker", Playing, Play),
        DeviceKind("button", Pressed),
        DeviceKind("gauge", Measured, shifted=("value",)),
        DeviceKind("light", None, Colour),
        DeviceKind("display", None, Shown),
    )
}
"""The kinds by name."""


def png(image: Image) -> bytes:
    """Return an image as a PNG file."""
    row = 3 * image.width
    lines = b"".join(b"\0" + image.pixels[at : at + row] for at in range(0, row * image.height, row))
    header = struct.pack(">IIBBBBB", image.width, image.height, 8, 2, 0, 0, 0)
    return _SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(lines, 1)) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
