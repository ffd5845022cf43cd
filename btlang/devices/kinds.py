"""The kinds of devices: their readings and their commands, in metres, degrees, seconds and percent.

A driver fills these records, and whoever uses a device knows nothing else of it. Angles are counter-clockwise positive.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.support.record import Record


class Reading(Record):
    """A reading of a device. None stands for a quantity that it doesn't measure."""


class Command(Record):
    """A command to a device; made without arguments, it brings the device to rest."""


class Distance(Reading):
    """Of an ultrasonic or infrared sensor: metres to the nearest thing in its cone, inf if there is none in range."""

    distance: float


class Scan(Reading):
    """Of a lidar: metres, inf where nothing is in range, NaN for a beam without a valid measurement.

    The first one is `start` degrees left of ahead, then every `step` degrees.
    """

    ranges: Sequence[float]
    start: float = 0.0
    step: float = 1.0


class Wheels(Reading):
    """Of the encoders of two driven wheels: metres that each has rolled since the start, and metres a second."""

    left: float
    right: float
    left_speed: float
    right_speed: float


class WheelSpeeds(Command):
    """Metres a second of each wheel."""

    left: float = 0.0
    right: float = 0.0


class Motion(Reading):
    """Of an inertial unit: degrees a second to the left, metres a second squared ahead, left and up, and the heading in
    degrees since it was switched on."""

    turning: float
    ahead: float | None = None
    left: float | None = None
    up: float | None = None
    heading: float | None = None


class Charge(Reading):
    """Of a battery: percent left, volts, amperes into it, degrees Celsius."""

    percent: float
    volts: float | None = None
    amperes: float | None = None
    temperature: float | None = None
    charging: bool | None = None


class JointState(Reading):
    """Of a servo: degrees (metres where it slides), those a second, load in percent, degrees Celsius."""

    position: float
    speed: float = 0.0
    load: float | None = None
    temperature: float | None = None
    loose: bool = False


class JointTarget(Command):
    """Degrees (metres) to go to, at most that fast; None: it stays where it is. `loose` takes its torque away."""

    position: float | None = None
    speed: float | None = None
    loose: bool = False


class Grip(Reading):
    """Of a hand: how far it is closed, 0 to 1, and whether something is in it."""

    closed: float
    holds: bool | None = None


class GripTarget(Command):
    """How far it closes, 0 to 1; None: it stays as it is."""

    closed: float | None = None


class Image(Reading):
    """Of a camera: rows of pixels from the top, three bytes (red, green, blue) each."""

    width: int
    height: int
    pixels: bytes

    def smaller(self, widest: int) -> Image:
        """At most so many pixels wide: every second one, or third one, and so on."""
        each = -(-self.width // widest)
        if each <= 1:
            return self
        rows = [self.pixels[3 * self.width * y : 3 * self.width * (y + 1)] for y in range(0, self.height, each)]
        wide = len(range(0, self.width, each))
        parts = [b"".join(row[3 * x : 3 * x + 3] for x in range(0, self.width, each)) for row in rows]
        return Image(wide, len(rows), b"".join(parts))


class Sound(Reading):
    """Of a microphone: samples since the last reading, 16 bits signed, little-endian, one channel."""

    samples: bytes
    rate: int


class Play(Command):
    """Samples for a speaker, as those of Sound; none: silence at once."""

    samples: bytes = b""
    rate: int = 16_000


class Playing(Reading):
    """Of a speaker: seconds that it still has to play."""

    left: float


class Pressed(Reading):
    """Of a button or a bumper."""

    pressed: bool


class Measured(Reading):
    """Of any other sensor, such as a thermometer: a number in the unit that is usual for what it measures."""

    value: float


class Colour(Command):
    """Red, green and blue of a light, 0 to 1."""

    red: float = 0.0
    green: float = 0.0
    blue: float = 0.0


class Shown(Command):
    """The text on a display."""

    text: str = ""


class Kind(Record):
    """A kind of device: its readings and its commands, None where it has none.

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
        """What brings a device that moves to rest; None of the others."""
        return self.command() if self.moves and self.command is not None else None


KINDS = {
    kind.name: kind
    for kind in (
        Kind("range", Distance, shifted=("distance",)),
        Kind("lidar", Scan),
        Kind("drive", Wheels, WheelSpeeds, moves=True, scaled=("left", "right", "left_speed", "right_speed")),
        Kind("imu", Motion, shifted=("turning",)),
        Kind("battery", Charge, shifted=("percent",)),
        Kind("joint", JointState, JointTarget, moves=True, scaled=("speed",), shifted=("position",)),
        Kind("hand", Grip, GripTarget, moves=True),
        Kind("camera", Image),
        Kind("microphone", Sound),
        Kind("speaker", Playing, Play),
        Kind("button", Pressed),
        Kind("gauge", Measured, shifted=("value",)),
        Kind("light", None, Colour),
        Kind("display", None, Shown),
    )
}
"""By name."""
