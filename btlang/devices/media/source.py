"""What comes from a camera or microphone, or from a file: read in a thread, since it blocks until there is more."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress

from btlang.devices.driver import DeviceError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_JOIN = 1.0  # seconds that a camera gets to give the picture that it is about to give


def missing(extra: str) -> DeviceError:
    """PyAV isn't installed."""
    return DeviceError(f"it needs the Python package av, which isn't installed: pip install 'btlang[{extra}]'")


class MediaSource:
    """Opens a place with PyAV and hands each frame to `take`, in a thread; files at the speed of their time.

    `form` is the FFmpeg format of a device, such as v4l2; "" for a file, which begins again when it is over if it
    `repeats`. Raises DeviceError where it can't be opened.
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
        """Raises DeviceError where nothing more comes."""
        if self._problem is not None:
            raise DeviceError(self._problem)

    def close(self) -> None:
        """Lets go of it; of a device that gives nothing any more, as soon as it does."""
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
