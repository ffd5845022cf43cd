"""The driver `camera`: Video4Linux cameras, and files in their place, through PyAV (FFmpeg)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import ClassVar

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import Command, Image, Reading
from btlang.devices.media.source import MediaSource, missing

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_OPTIONS = ("width", "height", "rate", "repeat")


class Camera:
    """See btlang.devices.driver.Driver. The port is a device such as /dev/video0, or a video or picture file.

    Options: `width`, `height` and `rate` that a device is asked for, pictures a second at most (10); `repeat` = false
    ends a file when it is over.
    """

    kinds: ClassVar[Sequence[str]] = ("camera",)
    needs_port: ClassVar[bool] = True

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        if len(devices) > 1:
            raise DeviceError(f"{port} is one camera: the {devices[1].name} needs another port")
        self._port, self._device = port, devices[0]
        for name in self._device.options:
            if name not in _OPTIONS:
                listed = ", ".join(_OPTIONS)
                raise DeviceError(f'unknown option "{name}" of the {self._device.name}; it has {listed}')
        options = self._device.options
        for name in ("width", "height", "rate"):
            if name in options and not (isinstance(options[name], int | float) and options[name] > 0):
                raise DeviceError(f'"{name}" of the {self._device.name} must be a positive number')
        self.rate = float(options.get("rate", 10.0))
        self._source: MediaSource | None = None
        self._newest: Any = None

    def open(self) -> None:
        """See Driver."""
        if find_spec("av") is None:
            raise missing("camera")
        options, wanted = self._device.options, {}
        is_device = self._port.startswith("/dev/")
        if is_device and "width" in options and "height" in options:
            wanted["video_size"] = f"{options['width']:g}x{options['height']:g}"
        if is_device and "rate" in options:
            wanted["framerate"] = f"{options['rate']:g}"
        repeats = not is_device and options.get("repeat", True) is True
        self._source = MediaSource(self._port, "v4l2" if is_device else "", "video", wanted, repeats, self._take)

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """See Driver."""
        assert self._source is not None
        frame, self._newest = self._newest, None
        if frame is None:
            self._source.check()
            return {}
        pixels = frame.to_ndarray(format="rgb24")
        return {self._device.name: Image(frame.width, frame.height, pixels.tobytes())}

    def close(self) -> None:
        """See Driver."""
        source, self._source, self._newest = self._source, None, None
        if source is not None:
            source.close()

    def _take(self, frame: Any) -> None:
        self._newest = frame
