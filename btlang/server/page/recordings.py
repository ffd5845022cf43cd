"""The files of recordings in the folder of a robot, also of robots elsewhere, whose recordings come in pieces."""

from __future__ import annotations

import asyncio
import base64
import os
import re
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

from starlette.responses import StreamingResponse
from starlette.types import Send

from btlang.recording.reader import read_about
from btlang.server.http.access import AccessError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.server.live.robot_feeds import RobotFeed

    Read: TypeAlias = Callable[[dict[str, Any]], Awaitable[Any]]

    """Asks the program beside a robot (`dialer`). Raises ConnectionError if it doesn't answer."""


NAME = re.compile(r"[\w-]+(\.\d+)?\.mcap", re.ASCII)
"""The names that recordings may have."""
MOST = 200
"""The number of recordings in a list, the newest."""
PIECE = 49_152
"""The bytes that are read at once."""


def list_recordings(folder: str) -> list[dict[str, Any]]:
    """List name, size in bytes, time (seconds since 1970) and task of each recording, newest first.

    Raises AccessError (404).
    """
    found: list[tuple[float, str, int]] = []
    with suppress(OSError):
        for entry in os.scandir(_check_folder(folder)):
            if NAME.fullmatch(entry.name):
                status = entry.stat()
                found.append((status.st_mtime, entry.name, status.st_size))
    recordings = []
    for time, name, size in sorted(found, reverse=True)[:MOST]:
        about = read_about(os.path.join(folder, name))
        task = int(about["task"]) if about.get("task", "").isdigit() else 0
        recordings.append(
            {"name": name, "bytes": size, "time": time, "task": task, "mission": about.get("mission", "")}
        )
    return recordings


def path_of(folder: str, name: str) -> str:
    """Return the file of a recording. Raises AccessError (404)."""
    path = os.path.join(_check_folder(folder), name)
    if not NAME.fullmatch(name) or not os.path.isfile(path):
        raise AccessError(404, "There's no such recording.")
    return path


def piece(folder: str, name: str, at: int) -> tuple[int, bytes]:
    """Return the size of a recording in bytes, and at most PIECE of them from a place on. Raises AccessError (404)."""
    path = path_of(folder, name)
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            file.seek(at)
            return size, file.read(PIECE)
    except (OSError, ValueError, OverflowError):
        raise AccessError(404, "There's no such recording.") from None


def _check_folder(folder: str) -> str:
    if not folder:
        raise AccessError(404, "The recordings of this robot aren't on this computer.")
    return folder


async def recordings_of(feed: RobotFeed) -> list[dict[str, Any]]:
    """List the recordings of a robot, as `list_recordings` does. Raises AccessError (404, 503)."""
    if feed.is_elsewhere:
        return await list_recordings_elsewhere(feed.read)
    return await asyncio.to_thread(list_recordings, feed.recordings)


MOST_RUNS = 50
"""The number of runs of a mission that are looked at together, the newest."""
_MOST_TOGETHER = 20_000_000  # bytes of their recordings


async def runs_like(feed: RobotFeed, name: str) -> list[str]:
    """List the recordings of missions with the name that the mission of one has. Raises AccessError (404, 503)."""
    found = await recordings_of(feed)
    mission, left, names = next((each["mission"] for each in found if each["name"] == name), ""), _MOST_TOGETHER, []
    for each in found:
        left -= each["bytes"]
        if each["name"] != name and each["mission"] == mission and left > 0:
            names.append(each["name"])
    return names[: MOST_RUNS - 1]


_LATEST = 1e11  # seconds since 1970
MOST_BYTES = 100_000_000
"""The limit of a recording that is fetched to be shown."""


class Fetched:
    """A recording of a robot elsewhere: its size in bytes, and what it is made of."""

    def __init__(self, read: Read, name: str, size: int, first: bytes) -> None:
        self.size = size
        self._read, self._name, self._first = read, name, first

    async def pieces(self) -> AsyncIterator[bytes]:
        """Yield all pieces, in order. Raises ConnectionError or AccessError (404) where they break off."""
        piece, at = self._first, 0
        while piece:
            yield piece
            at += len(piece)
            if at >= self.size:
                return
            piece = (await _piece(self._read, self._name, at))[1][: self.size - at]
        if at < self.size:
            raise ConnectionError("the recording has become shorter")


async def list_recordings_elsewhere(read: Read) -> list[dict[str, Any]]:
    """List the recordings of a robot elsewhere, as `list_recordings` does. Raises AccessError (503)."""
    try:
        found = await read({"type": "recordings"})
        return [
            {
                "name": str(each["name"]), "bytes": int(each["bytes"]), "task": int(each["task"]),
                "time": min(max(0.0, float(each["time"])), _LATEST), "mission": str(each["mission"]),
            }
            for each in found["recordings"][:MOST] if NAME.fullmatch(str(each["name"]))
        ]  # fmt: skip
    except (KeyError, TypeError, ValueError, OverflowError):  # a robot may say anything
        raise AccessError(503, "The robot didn't say which recordings it has.") from None
    except ConnectionError as error:
        raise AccessError(503, str(error)) from None


async def fetch(read: Read, name: str) -> Fetched:
    """Fetch a recording; returns once its first piece is here. Raises AccessError (404, 503)."""
    if not NAME.fullmatch(name):
        raise AccessError(404, "There's no such recording.")
    try:
        size, first = await _piece(read, name, 0)
    except ConnectionError as error:
        raise AccessError(503, str(error)) from None
    return Fetched(read, name, size, first[:size])


@asynccontextmanager
async def in_file(recording: Fetched, is_wanted: Callable[[], Awaitable[bool]]) -> AsyncIterator[str]:
    """Give the path of a copy, for as long as it is used.

    Raises AccessError (413, 503); is given up if nobody wants it.
    """
    if recording.size > MOST_BYTES:
        text = f"This recording has more than {MOST_BYTES // 1_000_000} MB: download it, and use btc replay."
        raise AccessError(413, text)
    descriptor, path = tempfile.mkstemp(prefix="btlang-", suffix=".mcap")
    try:
        with open(descriptor, "wb") as file:
            async for piece in recording.pieces():
                await asyncio.to_thread(file.write, piece)
                if not await is_wanted():
                    raise ConnectionError("nobody waits for it any more")
        yield path
    except ConnectionError as error:
        raise AccessError(503, str(error)) from None
    finally:
        with suppress(OSError):
            os.unlink(path)


class RecordingResponse(StreamingResponse):
    """A recording on its way. Where it breaks off so does the connection: nobody takes a part for the whole."""

    def __init__(self, recording: Fetched) -> None:
        headers = {"content-length": str(recording.size)}
        super().__init__(recording.pieces(), headers=headers, media_type="application/octet-stream")

    async def stream_response(self, send: Send) -> None:
        """See StreamingResponse."""
        with suppress(ConnectionError, AccessError):
            await super().stream_response(send)


async def _piece(read: Read, name: str, at: int) -> tuple[int, bytes]:
    """Return the bytes of all, and some from a place on. Raises AccessError (404), and ConnectionError."""
    answer = await read({"type": "recording", "name": name, "at": at})
    try:
        if answer.get("missing"):
            raise AccessError(404, "There's no such recording.")
        size, data = answer["size"], base64.b64decode(answer["data"], validate=True)
        if type(size) is not int or size < 0 or len(data) > PIECE:
            raise ValueError("no piece")
    except (AttributeError, KeyError, TypeError, ValueError):
        raise ConnectionError("The robot didn't send the recording.") from None
    return size, data
