"""Mission files that are written anew."""

from __future__ import annotations

import os
import shutil

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.reading import unwritable


def replace_text(path: str, text: str) -> None:
    """Gives a file another text. Raises MissionError (BT009) where that fails; the file is then as it was."""
    target = os.path.realpath(path)
    new = f"{target}.{os.getpid()}.new"
    try:
        with open(target, "r+b"):  # a file that is protected stays as it is
            pass
        try:
            with open(new, "xb") as file:
                file.write(text.encode())
            shutil.copymode(target, new)
            os.replace(new, target)
        finally:
            if os.path.exists(new):
                os.remove(new)
    except OSError as error:
        raise MissionError([unwritable(path, error)]) from None
