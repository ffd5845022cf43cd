"""Cameras, microphones and speakers of this computer, and files in their place, through PyAV (FFmpeg)."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from typing import ClassVar

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import Command, Image, Play, Playing, Reading, Sound

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_JOIN = 1.0  # seconds that a camera gets to give the picture that it is about to give
_OPTIONS = ("width", "height", "rate", "repeat")
_RATE = 16_000
_LONGEST = 5 * _RATE * 2  # bytes that wait for somebody who listens
_PIECE = 0.05  # seconds that are written at once


def missing_av(extra: str) -> DeviceError:
    """Return the error that PyAV isn't installed."""
    return DeviceError(f"it needs the Python package av, which isn't installed: pip install 'btlang[{extra}]'")


class MediaSource:
    """A source that PyAV opens; a thread passes each frame to `take`, those of files at their own speed.

    `form` is the FFmpeg format of a device, such as v4l2; "" for a file, which starts again when it is over if it
    `repeats`. Raises DeviceError if it can't be opened.
    """

    def __init__(
        self, place: str, form: str, kind: str, options: dict[str, str], repeats: bool, take: Callable[[Any], object]
    ) -> None:
        self._place, self._form, self._kind, self._options = place, form, kind, options
        self._repeats, self._take = repeats, take
        self._problem: str | None = None
        self._ended = threading.Event()
        container = self._open()
        self._thread = threading.Thread(target=self._work, args=(container,), name="btlang media", daemon=True)
        self._thread.start()

    def check(self) -> None:
        """Raise DeviceError if nothing more comes."""
        if self._problem is not None:
            raise DeviceError(self._problem)

    def close(self) -> None:
        """Close the source; a device that sends nothing any more, as soon as it does."""
        self._ended.set()
        self._thread.join(_JOIN)

    def _open(self) -> Any:
        import av

        try:
            container = av.open(self._place, format=self._form or None, options=self._options)
        except (av.FFmpegError, OSError, ValueError) as problem:
            reason = getattr(problem, "strerror", None) or str(problem)
            raise DeviceError(f"{self._place} can't be opened: {reason}") from None
        if not getattr(container.streams, self._kind):
            container.close()
            raise DeviceError(f"{self._place} has no {self._kind}")
        return container

    def _work(self, container: Any) -> None:
        try:
            self._read(container)
            while self._repeats and not self._ended.is_set():
                self._read(self._open())
            self._problem = f"{self._place} is over"
        except Exception as problem:  # of FFmpeg, when a device is pulled
            self._problem = f"{self._place} is lost: {getattr(problem, 'strerror', None) or problem}"

    def _read(self, container: Any) -> None:
        began, first = time.monotonic(), None
        try:
            for frame in container.decode(**{self._kind: 0}):
                if not self._form and frame.time is not None:
                    first = frame.time if first is None else first
                    self._ended.wait(max(0.0, began + frame.time - first - time.monotonic()))
                if self._ended.is_set():
                    return
                self._take(frame)
        finally:
            with suppress(Exception):
                container.close()


class Camera:
    """The driver `camera`. The port is a device such as /dev/video0, or a video or picture file.

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
        if find_spec("av") is None:
            raise missing_av("camera")
        options, wanted = self._device.options, {}
        is_device = self._port.startswith("/dev/")
        if is_device and "width" in options and "height" in options:
            wanted["video_size"] = f"{options['width']:g}x{options['height']:g}"
        if is_device and "rate" in options:
            wanted["framerate"] = f"{options['rate']:g}"
        repeats = not is_device and options.get("repeat", True) is True
        self._source = MediaSource(self._port, "v4l2" if is_device else "", "video", wanted, repeats, self._take)

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        assert self._source is not None
        frame, self._newest = self._newest, None
        if frame is None:
            self._source.check()
            return {}
        pixels = frame.to_ndarray(format="rgb24")
        return {self._device.name: Image(frame.width, frame.height, pixels.tobytes())}

    def close(self) -> None:
        source, self._source, self._newest = self._source, None, None
        if source is not None:
            source.close()

    def _take(self, frame: Any) -> None:
        self._newest = frame


class SoundCard:
    """The driver `sound`. The port is a device of ALSA such as "default" or "hw:1", or a file that ends in .wav.

    It has one microphone or one speaker; sound is mono, 16 bits, 16 kHz. A speaker plays on if its command is repeated;
    a different one begins, and one without samples is silence at once.
    """

    kinds: ClassVar[Sequence[str]] = ("microphone", "speaker")
    needs_port: ClassVar[bool] = True
    rate = 20.0

    def __init__(self, port: str, devices: Sequence[Device]) -> None:
        if len(devices) > 1:
            raise DeviceError(f"{port} is one device: the {devices[1].name} needs another port")
        self._port, self._device = port, devices[0]
        for name in self._device.options:
            raise DeviceError(f'unknown option "{name}" of the {self._device.name}; it has none')
        self._form = "" if port.endswith(".wav") else "alsa"
        self._source: MediaSource | None = None
        self._speaker: Speaker | None = None
        self._heard: deque[bytes] = deque()
        self._waiting = 0
        self._resampler: Any = None

    def open(self) -> None:
        if find_spec("av") is None:
            raise missing_av("ears" if self._device.kind == "microphone" else "voice")
        if self._device.kind == "speaker":
            self._speaker = Speaker(self._port, self._form)
            return
        from av import AudioResampler

        self._resampler = AudioResampler(format="s16", layout="mono", rate=_RATE)
        self._source = MediaSource(self._port, self._form, "audio", {}, False, self._hear)

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        name = self._device.name
        if self._speaker is not None:
            return {name: self._speaker.play(commands.get(name))}
        assert self._source is not None
        samples = b""
        while self._heard:
            samples += self._heard.popleft()
        self._waiting -= len(samples)
        if not samples:
            self._source.check()
            return {}
        return {name: Sound(samples, _RATE)}

    def close(self) -> None:
        source, self._source = self._source, None
        speaker, self._speaker = self._speaker, None
        for each in (source, speaker):
            if each is not None:
                each.close()

    def _hear(self, frame: Any) -> None:
        for each in self._resampler.resample(frame):
            data = each.to_ndarray().tobytes()
            self._heard.append(data)
            self._waiting += len(data)
        while self._waiting > _LONGEST:  # nobody listens: the oldest is lost
            self._waiting -= len(self._heard.popleft())


class Speaker:
    """A thread that writes samples in pieces, so that silence comes at once. Raises DeviceError if it can't."""

    def __init__(self, place: str, form: str) -> None:
        import av

        try:
            self._container = av.open(place, "w", format=form or "wav")
            self._stream: Any = self._container.add_stream("pcm_s16le", rate=_RATE, layout="mono")
            self._container.start_encoding()
        except (av.FFmpegError, OSError, ValueError) as problem:
            reason = getattr(problem, "strerror", None) or str(problem)
            raise DeviceError(f"{place} can't be opened: {reason}") from None
        self._place, self._in_real_time = place, bool(form)
        self._left = b""
        self._command: Command | None = None
        self._problem: str | None = None
        self._news, self._changing, self._ended = threading.Event(), threading.Lock(), threading.Event()
        self._thread = threading.Thread(target=self._work, name="btlang speaker", daemon=True)
        self._thread.start()

    def play(self, command: Command | None) -> Playing | DeviceError:
        """Begin a command that differs from the last one; return how much of it is left."""
        with self._changing:
            if isinstance(command, Play) and command is not self._command:
                self._left = _resample(command)
            elif command is None and self._command is not None:
                self._left = b""
            self._command = command
        self._news.set()
        return Playing(len(self._left) / 2 / _RATE) if self._problem is None else DeviceError(self._problem)

    def close(self) -> None:
        """Silence the speaker, and close it."""
        self._left = b""
        self._ended.set()
        self._news.set()
        self._thread.join(1.0)

    def _work(self) -> None:
        piece = int(_PIECE * _RATE) * 2
        try:
            while not self._ended.is_set():
                with self._changing:
                    now, self._left = self._left[:piece], self._left[piece:]
                if now:
                    self._write(now)
                    self._ended.wait(0.0 if self._in_real_time else len(now) / 2 / _RATE)
                else:
                    self._news.wait(1.0)
                    self._news.clear()
            self._container.close()
        except Exception as problem:  # of FFmpeg, when a device is pulled
            self._problem = f"{self._place} is lost: {getattr(problem, 'strerror', None) or problem}"

    def _write(self, samples: bytes) -> None:
        import numpy as np
        from av import AudioFrame

        frame = AudioFrame.from_ndarray(np.frombuffer(samples, dtype="<i2")[None, :], format="s16", layout="mono")
        frame.rate = _RATE
        for packet in self._stream.encode(frame):
            self._container.mux(packet)


def _resample(command: Play) -> bytes:
    """Return the samples at the rate of the speaker."""
    if command.rate == _RATE or not command.samples:
        return command.samples
    import numpy as np

    samples = np.frombuffer(command.samples, dtype="<i2")
    at = np.arange(0, len(samples), command.rate / _RATE)
    return bytes(np.interp(at, np.arange(len(samples)), samples).astype("<i2").tobytes())
