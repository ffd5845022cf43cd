"""Sentences of tests/speech/ears as sound: several voices and speeds, in rooms of several noise."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from btlang.speech.engine import Settings
from btlang.speech.espeak import Espeak
from btlang.speech.recogniser import RATE, Expected

EARS = Path(__file__).parent / "ears"
VOICES = {
    "train": (
        Settings("en-us", "", 160, 50), Settings("en-us", "f2", 150, 55), Settings("en-us", "m3", 175, 45),
        Settings("en-gb-x-rp", "", 150, 50),
    ),
    "test": (
        Settings("en-us", "m1", 150, 50), Settings("en-us", "f4", 160, 50), Settings("en-us", "m7", 140, 60),
        Settings("en-us", "f1", 170, 40), Settings("en-gb-x-rp", "m2", 150, 45),
    ),
    "confirm": (
        Settings("en-us", "m5", 165, 35), Settings("en-us", "f3", 145, 60), Settings("en", "m4", 180, 50),
        Settings("en-us-nyc", "", 155, 65), Settings("en-gb-scotland", "f5", 150, 45),
    ),
}  # fmt: skip
LIGHT = 30.0
"""Decibels between speech and the noise of a quiet room."""
BEFORE, AFTER = 0.6, 1.2
"""Seconds of the room around a sentence."""
_LOUDNESS = 3000.0

Samples = npt.NDArray[np.float64]


def lines(name: str) -> list[str]:
    """Those of a list, without its comments."""
    text = (EARS / name).read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def guide() -> Expected:
    """What a guide listens for, yes and no apart."""
    pairs = (line.split(":") for line in lines("names.txt"))
    names = {kind.strip(): tuple(name.strip() for name in listed.split(",")) for kind, listed in pairs}
    return Expected(tuple(lines("guide.txt")), names)


@lru_cache(maxsize=4096)
def speech(text: str, voice: Settings) -> Samples:
    """A sentence without noise, at the rate of recognisers."""
    said = Espeak(voice).speak(text)
    samples = np.frombuffer(said.samples, dtype="<i2").astype(np.float64)
    spectrum = np.fft.rfft(samples)
    count = int(len(samples) * RATE / said.rate)
    spoken: Samples = np.fft.irfft(spectrum[: count // 2 + 1], count)
    loud = spoken[np.abs(spoken) > 0.05 * np.abs(spoken).max()]
    return spoken * (_LOUDNESS / float(np.sqrt(np.mean(loud**2))))


def room(seconds: float, decibels: float, seed: int) -> Samples:
    """Pink noise, so far below speech."""
    spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(int(seconds * RATE)))
    noise: Samples = np.fft.irfft(spectrum / np.sqrt(np.maximum(np.arange(len(spectrum)), 1)), int(seconds * RATE))
    return noise * (_LOUDNESS * 10 ** (-decibels / 20) / float(noise.std()))


def recorded(text: str, voice: Settings, decibels: float = LIGHT, seed: int = 1) -> bytes:
    """A sentence in a room, as a microphone gives it."""
    spoken = speech(text, voice)
    heard = room(BEFORE + len(spoken) / RATE + AFTER, decibels, seed)
    begin = int(BEFORE * RATE)
    heard[begin : begin + len(spoken)] += spoken
    return np.clip(heard, -32768, 32767).astype("<i2").tobytes()
