"""Packs btlang for browsers: compiled modules, data files, and the cache of the words, which takes seconds to make."""

from __future__ import annotations

import compileall
import os
import sys
import zipfile
from pathlib import Path
from py_compile import PycInvalidationMode

_WARM_UP = 'go to the kitchen\nask Alice "Coffee?"\nif you can see a cup, wave\n', "go to the kichen"


def pack(folder: str, home: str, archive: str) -> None:
    """Compile the modules in a folder of Python's path, fill the cache in a home, and write both to an archive.

    For the Python that is to use them: it's the one that calls this.
    """
    compileall.compile_dir(
        folder, quiet=1, optimize=2, legacy=True, invalidation_mode=PycInvalidationMode.UNCHECKED_HASH, stripdir=folder
    )
    for source in Path(folder).rglob("*.py"):
        source.unlink()
    for name in [name for name in sys.modules if name.split(".")[0] == "btlang" and name != __name__]:
        del sys.modules[name]  # what was read of sources has to be read again
    from btlang.playground.playground import Playground

    playground = Playground()
    for text in _WARM_UP:
        playground.ask("document", text)
        playground.ask("english", text)
    playground.begin(_WARM_UP[0])
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as packed:
        for root in (folder, home):
            for path in sorted(path for path in Path(root).rglob("*") if path.is_file()):
                packed.write(path, os.path.relpath(path, "/"))
