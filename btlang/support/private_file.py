"""Files for their owner alone."""

from __future__ import annotations

import os


def write_private(path: str, data: bytes) -> None:
    """Write a file that only its owner can read, whole or not at all. Raises OSError."""
    part = f"{path}.{os.getpid()}"
    descriptor = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    try:
        os.write(descriptor, data)
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
    os.replace(part, path)
