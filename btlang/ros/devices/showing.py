"""The messages of what people see and hear: sound, light and text."""

from __future__ import annotations

from array import array

import numpy as np
from std_msgs.msg import ColorRGBA, Float64, Int16MultiArray, MultiArrayDimension, String

from btlang.devices import kinds
from btlang.devices.driver import DeviceSilent
from btlang.devices.kinds import Command, Reading
from btlang.ros.devices.translation import Translation, number

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_RATE = "rate"


class MicrophoneTranslation(Translation):
    """Samples of 16 bits; the size of the second dimension, "rate", says how many of them are a second."""

    reads = Int16MultiArray

    def _read(self, message: Any) -> Reading:
        return kinds.Sound(*_samples(message))

    def shown(self, reading: Any) -> Any:
        """See Translation."""
        return _sound(reading)


class SpeakerTranslation(Translation):
    """The seconds that it still has to play, and the sound to play, in the message type of a microphone."""

    reads, takes = Float64, Int16MultiArray

    def _read(self, message: Any) -> Reading:
        return kinds.Playing(number(message.data, "time"))

    def shown(self, reading: Any) -> Any:
        """See Translation."""
        return Float64(data=float(reading.left))

    def sent(self, command: Any) -> Any:
        """See Translation."""
        return _sound(command)

    def command(self, message: Any) -> Command:
        """See Translation."""
        return kinds.Play(*_samples(message))


class LightTranslation(Translation):
    """A colour, each part from 0 to 1; `a` is 1."""

    takes = ColorRGBA

    def sent(self, command: Any) -> Any:
        """See Translation."""
        return ColorRGBA(r=float(command.red), g=float(command.green), b=float(command.blue), a=1.0)

    def command(self, message: Any) -> Command:
        """See Translation."""
        return kinds.Colour(*(min(1.0, max(0.0, number(each, "colour"))) for each in (message.r, message.g, message.b)))


class DisplayTranslation(Translation):
    """The text that it shows."""

    takes = String

    def sent(self, command: Any) -> Any:
        """See Translation."""
        return String(data=command.text)

    def command(self, message: Any) -> Command:
        """See Translation."""
        return kinds.Shown(message.data)


def _samples(message: Any) -> tuple[bytes, int]:
    rate = next((each.size for each in message.layout.dim if each.label == _RATE), 0)
    if not 1000 <= rate <= 200_000:
        raise DeviceSilent('its sound has no dimension "rate" with the samples a second')
    return np.asarray(message.data, dtype="<i2").tobytes(), int(rate)


def _sound(sound: Any) -> Any:
    message = Int16MultiArray(data=array("h", np.frombuffer(sound.samples, "<i2").astype(np.int16).tobytes()))
    count = len(message.data)
    samples = MultiArrayDimension(label="samples", size=count, stride=count)
    message.layout.dim = [samples, MultiArrayDimension(label=_RATE, size=sound.rate)]
    return message
