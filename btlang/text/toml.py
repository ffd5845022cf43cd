"""TOML as keyword files and worlds are written in: whatever is wrong with a text is one exception."""

from __future__ import annotations

import re
import tomllib

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_MOST_PARTS = 16  # of a key such as a.b.c: the time that tomllib takes grows with their square
_QUOTED = re.compile(
    r'"""(?:\\.|[^\\])*?(?:"{3,5}|\Z)|"(?:\\.|[^"\\\n])*"?' r"|'''.*?(?:'{3,5}|\Z)|'[^'\n]*'?|#[^\n]*", re.DOTALL
)  # fmt: skip
_LONG_KEY = re.compile(rf"(?<![\w-])[\w-]+(?:[ \t]*\.[ \t]*[\w-]+){{{_MOST_PARTS}}}")


def parse_toml(text: str) -> dict[str, Any]:
    """The table of a text. Raises tomllib.TOMLDecodeError, also for what is nested too deep or too long a number."""
    if _LONG_KEY.search(_QUOTED.sub(lambda quoted: "" if quoted[0][0] == "#" else "s", text)):
        raise tomllib.TOMLDecodeError(f"a key has more than {_MOST_PARTS} parts")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise tomllib.TOMLDecodeError("it is nested too deep") from None
    except ValueError:
        raise tomllib.TOMLDecodeError("a number is too long") from None


def line_of(error: tomllib.TOMLDecodeError) -> int | None:
    """The line that the error names: "... (at line 3, column 5)"."""
    place = re.search(r"\(at line (\d+), column \d+\)$", str(error))
    return int(place[1]) if place else None
