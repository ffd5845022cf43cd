"""Reading and writing whole files. Everything that can be wrong with a file becomes a diagnostic."""

from __future__ import annotations

import errno
import os
import stat
import sys
from codecs import BOM_UTF8
from collections.abc import Callable
from contextlib import nullcontext

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.text.output import pass_on
from btlang.text.source import Source, Span

MOST_BYTES = 10_000_000
"""The size of the largest text that is read: missions, keyword files, worlds, XML, JSON."""

MOST_DEEP = 50
"""Files that include each other in a row."""
TOO_DEEP = f"more than {MOST_DEEP} files include each other in a row"
OUTSIDE = "it is outside the folder of the mission; to allow another folder, use --include-root"
_pipes: dict[str, bytes] = {}  # what came out of them: a world is read for its names, and again for the run


def read_source(path: str, include_root: str | None = None) -> Source:
    """Read the text of a file that the user names, or of standard input for `-`. Raises MissionError (BT001, BT002).

    What it includes lies in its folder, or below `include_root`. It may be a pipe, too.
    """
    folder = os.path.dirname(path)
    roots = (folder,) if include_root is None else (folder, include_root)
    return _decode(Source("", path, folder, roots, may_load=True), lambda: read_bytes(path))


def read_included(path: str, source: Source) -> Source:
    """Read the text of a file that another text names, with the same roots: a regular file below one of them.

    Raises MissionError (BT001, BT002).
    """
    where, real = included_path(path, source)

    def read() -> bytes:
        if not any(is_below(real, root) for root in source.roots):
            raise OSError(errno.EACCES, OUTSIDE if source.roots else "files can't be included here")
        # a pipe that nobody writes to would block; O_NONBLOCK changes nothing for regular files
        with open(real, "rb", opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NONBLOCK", 0))) as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise OSError(errno.EINVAL, "it isn't a regular file")
            return _limit(file.read(MOST_BYTES + 1))

    hides = source.hides_includes
    return _decode(Source("", where, os.path.dirname(where), source.roots, hidden=hides, hides_includes=hides), read)


def included_path(path: str, source: Source) -> tuple[str, str]:
    """Return where a file that a text names is looked for, and where that really is. Reads nothing."""
    where = os.path.join(source.folder, path)
    return where, real_path(where)


def real_path(path: str) -> str:
    """Return a path without links; as it is if no file can have such a name."""
    try:
        return os.path.realpath(path)
    except ValueError:
        return path


def read_bytes(path: str) -> bytes:
    """Read the content of a file that the user names, or of standard input for `-`. Raises OSError."""
    if path in _pipes:
        return _pipes[path]
    if path == "-":
        data = sys.stdin.buffer.read(MOST_BYTES + 1) if sys.stdin is not None else b""
        return _limit(data)
    with open(path, "rb") as file:
        data = _limit(file.read(MOST_BYTES + 1))
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            _pipes[path] = data
    return data


def has_mark(path: str) -> bool:
    """Whether a file begins with a mark of the byte order, which texts are read without. Raises OSError."""
    return read_bytes(path).startswith(BOM_UTF8)


def _limit(data: bytes) -> bytes:
    if len(data) > MOST_BYTES:
        raise OSError(errno.EFBIG, f"it has more than {MOST_BYTES:,} bytes")
    return data


_PARTS = ("missions", "tests")
"""How folders are called that are parts of the folder above them."""


def is_within(real: str, source: Source, *others: str) -> bool:
    """Return whether a real path is in a folder from which a text that the user named may load files.

    These are its roots, `others`, and the folder above one that is called `missions` or `tests`.
    """
    above, name = os.path.split(os.path.realpath(source.folder or os.curdir))
    parts = (above,) if name in _PARTS else ()
    return bool(source.roots) and any(is_below(real, root) for root in (*source.roots, *others, *parts))


def is_below(real: str, root: str) -> bool:
    """Whether a real path is a folder, or something below it."""
    return os.path.join(real, "").startswith(os.path.join(os.path.realpath(root or os.curdir), ""))


def _decode(source: Source, read: Callable[[], bytes]) -> Source:
    """Return the source with the text that was read."""
    try:
        data = read()
    except (OSError, ValueError) as error:  # ValueError: a path with a NUL
        reason = os_error_reason(error) if isinstance(error, OSError) else str(error)
        raise MissionError([diagnostic("BT001", Span(source, 0, 0), file=source.name, reason=reason)]) from None
    data = data.removeprefix(BOM_UTF8)
    try:
        source.text = data.decode()
    except UnicodeDecodeError as error:
        readable = data[: error.start].decode("utf-8")
        source.text = readable + data[error.start :].decode("latin-1")
        raise MissionError([diagnostic("BT002", Span(source, len(readable), len(readable) + 1))]) from None
    return source


def unwritable(path: str, reason: str | OSError) -> Diagnostic:
    """Make the message that a file can't be written (BT009)."""
    text = reason if isinstance(reason, str) else os_error_reason(reason)
    return diagnostic("BT009", Span(Source("", path), 0, 0), file=path, reason=text)


def os_error_reason(error: OSError) -> str:
    """Return the reason in the words of the operating system, to be used in a sentence."""
    reason = error.strerror or str(error)
    return reason[:1].lower() + reason[1:]


def write_output(made: str | bytes, path: str | None) -> None:
    """Write into the file, or else to standard output."""
    if path is not None:
        write_file(path, made)
    elif isinstance(made, bytes):
        sys.stdout.buffer.write(made)
    else:
        pass_on(made)


def replace_text(path: str, text: str) -> None:
    """Give an existing file another text, as `write_file` does."""
    try:
        with open(path, "r+b"):
            pass
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None
    write_file(path, text)


def write_file(path: str, content: str | bytes) -> None:
    """Write a file, new or not, at once. Raises MissionError (BT009) if that fails; the file is then as it was.

    What a mission may hold and UTF-8 does not becomes an escape, which JSON and Python read back.
    """
    import shutil  # only what writes needs it

    data = content.encode(errors="backslashreplace") if isinstance(content, str) else content
    target = os.path.realpath(path)
    new = f"{target}.{os.getpid()}.new"
    try:
        with open(target, "ab") if os.path.exists(target) else nullcontext():  # a protected file stays as it is
            pass
        if os.path.exists(target) and not os.path.isfile(target):  # a device such as /dev/stdout cannot be replaced
            with open(target, "wb") as device:
                device.write(data)
            return
        try:
            with open(new, "xb") as file:
                file.write(data)
            if os.path.exists(target):
                shutil.copymode(target, new)
            os.replace(new, target)
        finally:
            if os.path.exists(new):
                os.remove(new)
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None
