"""Pictures as PNG (ISO/IEC 15948), without filters: Pillow is in an extra, and this is all that pages need."""

from __future__ import annotations

import struct
import zlib

from btlang.devices.kinds import Image

_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def png(image: Image) -> bytes:
    """The file."""
    row = 3 * image.width
    lines = b"".join(b"\0" + image.pixels[at : at + row] for at in range(0, row * image.height, row))
    header = struct.pack(">IIBBBBB", image.width, image.height, 8, 2, 0, 0, 0)
    return _SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(lines, 1)) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
