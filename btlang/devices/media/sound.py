"""The driver `sound`: microphones and speakers over ALSA, and files in their place, through PyAV (FFmpeg)."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import ClassVar

from btlang.devices.driver import Device, DeviceError
from btlang.devices.kinds import Command, Play, Playing, Reading, Sound
from btlang.devices.media.source import MediaSource, missing

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_RATE = 16_000
_LONGEST = 5 * _RATE * 2  # bytes that wait for somebody who listens
_PIECE = 0.05  # seconds that are written at once


class SoundCard:
    """See btlang.devices.driver.Driver. The port is a device of ALSA such as "default" or "hw:1", or a file that ends
    in .wav. One microphone or one speaker on it; sound is mono, 16 bits, 16 kHz.

    A speaker plays on if its command is repeated; a different one begins, and one without samples is silence at once.
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
        """See Driver."""
        if find_spec("av") is None:
            raise missing("ears" if self._device.kind == "microphone" else "voice")
        if self._device.kind == "speaker":
            self._speaker = Speaker(self._port, self._form)
            return
        from av import AudioResampler

        self._resampler = AudioResampler(format="s16", layout="mono", rate=_RATE)
        self._source = MediaSource(self._port, self._form, "audio", {}, False, self._hear)

    def exchange(self, commands: Mapping[str, Command]) -> Mapping[str, Reading | DeviceError]:
        """See Driver."""
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
        """See Driver."""
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
    """Writes samples in a thread, in pieces, so that silence comes at once. Raises DeviceError where it can't."""

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
        """Begins a command that is another one than the last, and says how much of it is left."""
        with self._changing:
            if isinstance(command, Play) and command is not self._command:
                self._left = _resampled(command)
            elif command is None and self._command is not None:
                self._left = b""
            self._command = command
        self._news.set()
        return Playing(len(self._left) / 2 / _RATE) if self._problem is None else DeviceError(self._problem)

    def close(self) -> None:
        """Silence, and lets go of it."""
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


def _resampled(command: Play) -> bytes:
    """The samples at the rate of the speaker."""
    if command.rate == _RATE or not command.samples:
        return command.samples
    import numpy as np

    samples = np.frombuffer(command.samples, dtype="<i2")
    at = np.arange(0, len(samples), command.rate / _RATE)
    return bytes(np.interp(at, np.arange(len(samples)), samples).astype("<i2").tobytes())
