"""What was made of files, kept between runs: a vocabulary loads eight times faster than it is made.

It is kept as a pickle, which can run code when it is loaded. So nothing is loaded or written unless the folder and the
file are the user's own and nobody else can write to them. Whatever is wrong with the cache costs time and nothing else.
"""

from __future__ import annotations

import os
import stat
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from zlib import crc32

from btlang.support.gc_pause import gc_paused
from btlang.support.user_dirs import user_dir

try:
    import _pickle as pickle  # the rest of the module takes as long to import as a vocabulary to load
except ImportError:
    import pickle  # type: ignore[no-redef]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    Key = TypeVar("Key")
    Made = TypeVar("Made")

_PROTOCOL = 5
_MOST_IN_PROCESS = 16
_in_process: dict[tuple[Any, ...], Any] = {}
MOST_FILES = 20  # of a kind; those that were used longest ago are deleted
_PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_CODE = ("", "diagnostics", "robots", "robots/worlds", "text", "vocabulary")  # they make it; "" holds the version
_OTHERS_MAY_WRITE = stat.S_IWGRP | stat.S_IWOTH


def cached(kind: str, files: Sequence[str], make: Callable[[], Made]) -> Made:
    """What `make` gives, from the cache where it was made before of the same files by the same code.

    `kind` and `files` distinguish it from other entries. What `make` raises comes through, and nothing is kept.
    Within a process it is the same object each time, so it must not be changed.
    """
    identity = (kind, _PACKAGE, sys.version, *files)
    try:
        key = (identity, *map(stamp, files), _code())  # before they are read: a later change makes it another one
    except OSError:
        return make()
    return recent(_in_process, key, lambda: _from_folder(key, make))  # type: ignore[no-any-return]


def recent(made: dict[Key, Made], key: Key, make: Callable[[], Made]) -> Made:
    """What was made for the key before, where it is one of the latest; `made` keeps those."""
    found = made.pop(key, None)
    if found is None:
        found = make()
    made[key] = found
    while len(made) > _MOST_IN_PROCESS:
        made.pop(next(iter(made)), None)
    return found


def _from_folder(state: tuple[Any, ...], make: Callable[[], Made]) -> Made:
    key, identity = (repr(part).encode(errors="surrogateescape") for part in (state, state[0]))
    try:
        folder = own_folder()
    except OSError:
        return make()
    path = os.path.join(folder, f"{state[0][0]}-{crc32(identity):08x}")
    found = _loaded(path, key)
    if found is not None:
        return found  # type: ignore[no-any-return]
    made = make()
    _write(path, key, made)
    return made


def own_folder() -> str:
    """The folder of the cache. Raises OSError if there is none that only the user can write to."""
    folder = user_dir("cache")
    if not os.path.isabs(folder):  # a user without a home
        raise FileNotFoundError(folder)
    os.makedirs(folder, 0o700, exist_ok=True)
    if not _is_own(os.stat(folder)):
        raise PermissionError(folder)
    return folder


def _is_own(status: os.stat_result) -> bool:
    # Windows has no such numbers; the folder is in the user's profile there
    return os.name == "nt" or (status.st_uid == os.getuid() and not status.st_mode & _OTHERS_MAY_WRITE)


@cache
def _code() -> str:
    """The state of the code when it was first asked for, which is the code that runs."""
    modules: list[str] = []
    for folder in _CODE:
        path = os.path.join(_PACKAGE, folder)
        modules += [os.path.join(path, name) for name in os.listdir(path) if name.endswith(".py")]
    return repr([stamp(path) for path in sorted(modules)])


def stamp(path: str) -> tuple[str, int, int, int, int]:
    """Changes with each change of a file, as the times do (to 4 ms), and costs a tenth of reading it all."""
    status = os.stat(path)
    if not stat.S_ISREG(status.st_mode):
        raise OSError(f"{path} is no file")  # a pipe is another one each time
    if sys.platform == "emscripten":  # in a browser files come out of an archive, anew each time, and never change
        return path, 0, status.st_size, 0, 0
    return path, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns


def _loaded(path: str, key: bytes) -> Any:
    """None where there is nothing for the key."""
    try:
        with open(path, "rb") as file:
            if not _is_own(os.fstat(file.fileno())):
                return None
            data = file.read()
        head = _head(key, memoryview(data)[len(key) + 4 :])
        if not data.startswith(head):
            return None
        with gc_paused:
            found = pickle.loads(memoryview(data)[len(head) :])
    except Exception:  # whatever a damaged pickle raises
        return None
    with suppress(OSError):  # a folder that can only be read
        os.utime(path)  # each command uses the words that ship: many files of users' own words must not displace them
    return found


def _head(key: bytes, body: bytes | memoryview) -> bytes:
    return key + crc32(body).to_bytes(4, "big")


def _write(path: str, key: bytes, made: object) -> None:
    """Other processes see the old file or the new one, whole."""
    new = f"{path}.{os.getpid()}-{time.time_ns()}"
    try:
        body = pickle.dumps(made, _PROTOCOL)
        descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o600)
        try:
            with open(descriptor, "wb") as file:
                file.write(_head(key, body) + body)
            os.replace(new, path)
        except OSError:
            os.unlink(new)
            raise
        _delete_least_used(*os.path.split(path))
    except (OSError, RecursionError):
        return


def _delete_least_used(folder: str, written: str) -> None:
    """Of the kind of the file that was written: what is made of users' own files must not displace what ships."""
    kind = written[: written.index("-") + 1]
    with os.scandir(folder) as entries:
        files = [entry for entry in entries if entry.name.startswith(kind) and entry.is_file()]
    files.sort(key=lambda entry: entry.stat().st_mtime_ns)
    for entry in files[:-MOST_FILES]:
        os.unlink(entry.path)
