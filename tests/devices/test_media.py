"""Cameras, microphones and speakers through files, in the real loop; without hardware ALSA and Video4Linux say so."""

from __future__ import annotations

import math
import struct
import time
import wave
from pathlib import Path
from typing import Any

import pytest

from btlang.devices.driver import Device, DeviceError, DeviceSilent
from btlang.devices.kinds import Command, Image, Play, Playing, Reading, Sound
from btlang.devices.loop import DeviceLoop
from btlang.devices.media import Camera, SoundCard

av = pytest.importorskip("av")
import numpy as np  # noqa: E402

TONE = b"".join(struct.pack("<h", int(9000 * math.sin(at / 6))) for at in range(8000))


def video(path: Path, seconds: float = 1.0) -> str:
    """Grey pictures that become brighter."""
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=20)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for at in range(int(20 * seconds)):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 10 * at, dtype=np.uint8), format="rgb24")
            for packet in stream.encode(frame):
                container.mux(packet)
        for packet in stream.encode():
            container.mux(packet)
    return str(path)


def sound(path: Path, rate: int = 8000) -> str:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(TONE)
    return str(path)


def loop_of(driver: Any, device: Device) -> DeviceLoop:
    loop = DeviceLoop(driver(device.port, [device]), (device,), silence=2.0)
    loop.start()
    return loop


def until(read: Any, holds: Any) -> Any:
    end = time.monotonic() + 30
    while True:
        try:
            found: Reading | None = read()
        except DeviceSilent:
            found = None
        if found is not None and holds(found):
            return found
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_file_in_place_of_a_camera(tmp_path: Path) -> None:
    device = Device("eye", "camera", "camera", video(tmp_path / "film.mp4"), {"rate": 20})
    loop = loop_of(Camera, device)
    try:
        seen: Image = until(lambda: loop.read("eye"), lambda image: image.pixels[0] > 80)
        assert (seen.width, seen.height, len(seen.pixels)) == (64, 48, 64 * 48 * 3)
        until(lambda: loop.read("eye"), lambda image: image.pixels[0] < 40)  # it begins again
    finally:
        loop.close()


def test_a_film_that_is_over_is_silent(tmp_path: Path) -> None:
    device = Device("eye", "camera", "camera", video(tmp_path / "film.mp4", 0.3), {"repeat": False})
    loop = loop_of(Camera, device)
    try:
        until(lambda: loop.read("eye"), lambda image: True)
        end = time.monotonic() + 30
        while "is over" not in (loop.silent("eye") or ""):
            assert time.monotonic() < end
            time.sleep(0.02)
    finally:
        loop.close()


def test_a_file_in_place_of_a_microphone(tmp_path: Path) -> None:
    device = Device("ear", "microphone", "sound", sound(tmp_path / "said.wav"))
    loop = loop_of(SoundCard, device)
    try:
        heard: Sound = until(lambda: loop.read("ear"), lambda reading: any(reading.samples))
        assert heard.rate == 16_000
        assert max(np.frombuffer(heard.samples, dtype="<i2")) > 5000
    finally:
        loop.close()


def test_a_speaker_writes_what_it_is_told_and_is_silent_at_once(tmp_path: Path) -> None:
    device = Device("mouth", "speaker", "sound", str(tmp_path / "said.wav"))
    loop = loop_of(SoundCard, device)
    command: Command = Play(TONE, 8000)

    def left() -> Reading:
        loop.write("mouth", command)
        return loop.read("mouth")

    try:
        until(left, lambda reading: isinstance(reading, Playing) and reading.left > 0.5)
        until(left, lambda reading: 0 < reading.left < 0.9)  # the same command goes on
        command = Play()
        until(left, lambda reading: reading.left == 0)
    finally:
        loop.close()
    with wave.open(str(tmp_path / "said.wav")) as file:
        assert 0.05 < file.getnframes() / file.getframerate() < 1.0


@pytest.mark.parametrize(
    ("driver", "kind", "port", "reason"),
    [
        (Camera, "camera", "/dev/video97", "/dev/video97 can't be opened"),
        (Camera, "camera", "nothing.mp4", "nothing.mp4 can't be opened"),
        (SoundCard, "microphone", "hw:97", "hw:97 can't be opened"),
        (SoundCard, "speaker", "hw:97", "hw:97 can't be opened"),
    ],
)
def test_what_is_not_there(driver: Any, kind: str, port: str, reason: str) -> None:
    made = driver(port, [Device("thing", kind, "camera", port)])
    with pytest.raises(DeviceError, match=reason):
        made.open()
    made.close()


def test_a_file_that_is_no_film(tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    path.write_bytes(b"no film at all" * 100)
    with pytest.raises(DeviceError, match="can't be opened"):
        Camera(str(path), [Device("eye", "camera", "camera", str(path))]).open()
    with pytest.raises(DeviceError, match="has no video"):
        Camera(sound(tmp_path / "a.wav"), [Device("eye", "camera", "camera")]).open()


@pytest.mark.parametrize("options", [{"zoom": 2}, {"rate": 0}, {"width": "wide"}])
def test_options_of_a_camera(options: dict[str, Any]) -> None:
    with pytest.raises(DeviceError):
        Camera("/dev/video0", [Device("eye", "camera", "camera", "/dev/video0", options)])
