"""An XML file in English in the user's editor, written onto the file when that ends."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile

from btlang.backends.files import write_file
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.reading import read_source
from btlang.editing.onto import write_onto
from btlang.editing.words import Words
from btlang.frontends.table import frontend_of
from btlang.text.output import show
from btlang.text.source import Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_FAILED = 1
_USUAL = "vi"  # as POSIX has it where neither VISUAL nor EDITOR is set


def edit_xml(options: argparse.Namespace) -> int:
    """Open the English of the file in the editor; return the exit code.

    Raises MissionError for a file that can't be read, said or written, and for a text that doesn't compile, which is
    kept then.
    """
    source = read_source(options.file)
    if frontend_of(source) != "xml":
        raise MissionError([diagnostic("BT001", Span(source, 0, 0), file=source.name, reason="it isn't a tree in XML")])
    words = Words(options.keywords, options.world, options.language)
    text = str(words.mission(source, main=options.main).to("english"))
    folder = tempfile.mkdtemp(prefix="btlang-")
    path = os.path.join(folder, f"{os.path.splitext(os.path.basename(options.file))[0]}.txt")
    write_file(path, text)
    command = os.environ.get("VISUAL") or os.environ.get("EDITOR") or _USUAL
    try:
        editor = shlex.split(command)
    except ValueError:
        options.refuse(f"the editor {command} can't be started: a quote isn't closed")
    kept = f"{options.file} stays as it is. Your text is in {path}."
    try:
        code = subprocess.run([*editor, path], check=False).returncode
        if not os.path.isfile(path):
            show(f"{options.file} stays as it is. The editor left no file.")
            return _FAILED
        edited = read_source(path)
        if edited.text == text:
            show(f"{options.file} stays as it is.")
        elif code:  # it may not have written all of it
            show(kept)
            return _FAILED
        else:
            write_onto(words.mission(edited), options.file)
            show(f"Wrote {options.file}.")
    except OSError as error:
        options.refuse(f"the editor {editor[0]} can't be started: {os.strerror(error.errno or 0).lower()}")
    except (MissionError, KeyboardInterrupt):
        show(kept)
        raise
    os.remove(path)
    os.rmdir(folder)
    return 0
