"""Writes what happens in runs into an MCAP file (https://mcap.dev), readable up to the last moment whatever happens."""

from __future__ import annotations

import json
import os
import struct
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import unwritable
from btlang.recording.bundle import files_of
from btlang.recording.channels import RecordingChannel, messages
from btlang.run.bus import BLOCK
from btlang.run.events import Ended, Event, PeriodPassed
from btlang.run.robot_state import Movements
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

ABOUT = "btlang"
"""The name of the metadata that say what was run."""
_encode = json.JSONEncoder(ensure_ascii=False, default=str, separators=(",", ":")).encode
_MESSAGE, _OPCODE, _BEFORE = struct.Struct("<BQHIQQ"), 0x05, 9  # https://mcap.dev/spec#message-op0x05
_SYNCED = 1.0  # seconds of real time after which the file is brought to the disk: what a loss of power may take


class Recorder:
    """A sink for one run. `files` are kept with it (the mission, its words, the world), `about` says what else to know.

    What happens is in the file at the end of each period, also if the process is killed. From `most_bytes` on there is
    a next file (`run.2.mcap`), which has all of that too. A file that cannot be written to ends the recording, and the
    bus drops this sink. `label` gives the words of a node. `opened` gets the path of each file. Raises OSError if it
    can't be opened.
    """

    policy = BLOCK

    def __init__(
        self,
        path: str,
        label: Callable[[Node], str],
        files: Mapping[str, bytes],
        about: Mapping[str, str],
        most_bytes: int | None = None,
        opened: Callable[[str], object] = lambda path: None,
    ) -> None:
        self.path = path
        self._opened = opened
        self._label, self._files, self._about, self._most = label, files, dict(about), most_bytes
        self.is_broken = False
        """Whether the file could not be written to its end."""
        self._began: int | None = None
        self._count = 0
        self._synced = time.monotonic()
        self._open()

    def __call__(self, event: Event) -> None:
        """Write an event. Raises OSError if that isn't possible."""
        try:
            self._write(event)
        except OSError as error:
            self.is_broken = True
            with suppress(OSError):
                self._file.close()
            raise OSError(error.errno, error.strerror, self.path) from None

    def _write(self, event: Event) -> None:
        if self._began is None:
            self._began = int((event.wall - event.t) * 1e9)
            self._about["run"] = event.run
            self._writer.add_metadata(ABOUT, self._about)
        at = self._began + int(event.t * 1e9)  # mission time, so that it is played at its pace
        published = int(event.wall * 1e9)
        for channel, data in messages(event, at, self._label, self._movements):
            text = (data if isinstance(data, str) else _encode(data)).encode(errors="backslashreplace")
            known = self._channels.get(channel.topic)
            if known is None:  # the writer puts the channel before its first message
                self._writer.add_message(self._new_id(channel), at, text, published)
            else:  # as the writer does it in 3 us, a third of all that an event may cost
                head = _MESSAGE.pack(_OPCODE, _MESSAGE.size - _BEFORE + len(text), known, 0, at, published)
                self._file.write(head + text)
        if not isinstance(event, PeriodPassed | Ended):
            return  # what belongs to one tick goes into the file together
        self._file.flush()
        now = time.monotonic()
        if now >= self._synced + _SYNCED:
            os.fsync(self._file.fileno())
            self._synced = now
        if self._most is not None and self._file.tell() >= self._most:
            self.close()
            self._open()

    def close(self) -> None:
        """End the file. May be called twice, and after the disk was full."""
        with suppress(OSError, ValueError):
            if not self._file.closed:
                self._writer.finish()  # type: ignore[no-untyped-call]
        with suppress(OSError):
            self._file.close()

    def _open(self) -> None:
        from mcap.writer import CompressionType, Writer

        self._count += 1
        stem, ending = os.path.splitext(self.path)
        path = self.path if self._count == 1 else f"{stem}.{self._count}{ending}"
        self._file = open(path, "wb")  # noqa: SIM115 - closed by `close`
        # in chunks, what is not yet written of one would be lost with the process
        self._writer = Writer(self._file, compression=CompressionType.NONE, use_chunking=False, use_statistics=False)
        self._channels: dict[str, int] = {}
        self._movements = Movements()
        now = time.time_ns()
        self._writer.start(library=f"btlang {self._about.get('btlang', '')}".strip())
        self._writer.add_metadata(ABOUT, self._about)
        for name, data in self._files.items():
            self._writer.add_attachment(now, now, name, _media_type(name), data)
        self._file.flush()
        self._opened(path)

    def _new_id(self, channel: RecordingChannel) -> int:
        schema = self._writer.register_schema(channel.schema, "jsonschema", _schema(channel).encode())
        number: int = self._writer.register_channel(channel.topic, "json", schema)
        self._channels[channel.topic] = number
        return number


def _schema(channel: RecordingChannel) -> str:
    fields: dict[str, Any] = {"title": channel.schema, **channel.described, "type": "object"}
    return json.dumps(fields)


def _media_type(name: str) -> str:
    return {".xml": "application/xml", ".json": "application/json"}.get(os.path.splitext(name)[1], "text/plain")


def recorder_in(
    folder: str,
    mission: Mission,
    keywords: Sequence[str],
    about: Mapping[str, str],
    most_bytes: int | None = None,
    opened: Callable[[str], object] = lambda path: None,
) -> Recorder:
    """Return a recorder for a run of a mission, in a file of a folder that is named after the time.

    Raises MissionError.
    """
    import btlang

    path = os.path.join(folder, time.strftime("%Y-%m-%d-%H%M%S-") + os.urandom(2).hex() + ".mcap")
    known = {"btlang": btlang.__version__, "wall": f"{time.time():.3f}", **about}
    try:
        os.makedirs(folder, exist_ok=True)
        return Recorder(path, mission.label, files_of(mission, keywords), known, most_bytes, opened)
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None
