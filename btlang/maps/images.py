"""Images of maps: PGM is read here, other formats by Pillow."""

from __future__ import annotations

import io
import re
import warnings

import numpy as np

from btlang.maps.data_text import missing
from btlang.support.record import Record
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

MOST_CELLS = 25_000_000
"""Of the largest map."""
_MOST_IN_TEXT = 4_000_000  # pixels; each is an object while it is read
_MOST_BYTES = 60_000_000
_GAP = rb"(?:\s|#[^\n]*\n)+"
_PGM = re.compile(rb"P([25])" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,6})" + _GAP + rb"(\d{1,5})(?:#[^\n]*\n|\s)")


class MapImage(Record):
    """Brightness from 0 (black) to 1, a row from the top for each first index; `alpha` (1 is opaque) None for none."""

    shades: npt.NDArray[np.float32]
    alpha: npt.NDArray[np.float32] | None = None


def read_image(path: str) -> MapImage:
    """A PGM, PNG or BMP file. Raises Problem, OSError, and MissionError (BT087) where it takes Pillow."""
    with open(path, "rb") as file:
        data = file.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise Problem(f"the image may have at most {_MOST_BYTES:,} bytes")
    return _read_pgm(data) if data[:2] in (b"P2", b"P5") else _read_other(data)


def _read_pgm(data: bytes) -> MapImage:
    header = _PGM.match(data)
    if header is None:
        raise Problem("the image has no complete PGM header")
    width, height, white = int(header[2]), int(header[3]), int(header[4])
    _check_size(width, height)
    if not 0 < white < 65_536:
        raise Problem("the image has a wrong PGM header: its white must be from 1 to 65535")
    count, body = width * height, data[header.end() :]
    if header[1] == b"5":
        wide = np.dtype(">u2") if white > 255 else np.dtype(np.uint8)
        if len(body) < count * wide.itemsize:
            raise Problem(f"the image ends before its {count:,} pixels")
        pixels = np.frombuffer(body, wide, count).astype(np.float32)
    else:
        if count > _MOST_IN_TEXT:
            raise Problem(f"an image whose pixels are text may have at most {_MOST_IN_TEXT:,} pixels, not {count:,}")
        words = re.sub(rb"#[^\n]*", b"", body).split(None, count)[:count]
        if len(words) < count:
            raise Problem(f"the image ends before its {count:,} pixels")
        if not all(word.isdigit() and len(word) < 6 for word in words):
            raise Problem("a pixel of the image isn't a number")
        pixels = np.array(words, dtype=np.float32)
    return MapImage(np.minimum(pixels / np.float32(white), 1.0).reshape(height, width))


def _read_other(data: bytes) -> MapImage:
    try:
        from PIL import Image
    except ImportError:
        raise missing("images that aren't PGM", "Pillow") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a large image; it is looked at here
            with Image.open(io.BytesIO(data), formats=("PNG", "BMP", "PPM")) as image:
                _check_size(*image.size)
                if image.mode.startswith(("I", "F")):  # 16 bits a pixel, which Pillow would cut off
                    return MapImage(np.minimum(np.asarray(image, dtype=np.float32) / 65_535, 1.0))
                has_alpha = image.has_transparency_data
                pixels = np.asarray(image.convert("RGBA"), dtype=np.uint8)
    except Problem:
        raise
    except Exception as error:  # what a decoder raises for a broken file is not one class
        raise Problem(
            f"the image can't be read: {str(error).splitlines()[0] if str(error) else 'it is broken'}"
        ) from None
    shades = pixels[:, :, :3].mean(axis=2, dtype=np.float32) / np.float32(255)
    return MapImage(shades, pixels[:, :, 3].astype(np.float32) / np.float32(255) if has_alpha else None)


def _check_size(width: int, height: int) -> None:
    if width < 1 or height < 1 or width * height > MOST_CELLS:
        raise Problem(f"an image must have from 1 to {MOST_CELLS:,} pixels, not {width:,} x {height:,}")
