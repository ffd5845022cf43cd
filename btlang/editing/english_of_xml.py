"""XML files edited in English: the user's editor shows a mission, which is then written onto the file."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import has_mark, read_source, unwritable, write_file
from btlang.editing.words import RobotWords
from btlang.frontends.btcpp.kept import Kept, digest_of, kept_in, with_digest
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.table import frontend_of
from btlang.text.output import show
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_FAILED = 1
_USUAL = "vi"  # as POSIX has it where neither VISUAL nor EDITOR is set


def write_onto(mission: Mission, path: str, out: str | None = None, *, force: bool = False) -> None:
    """Write a mission onto an XML file at once, or what that gives into the file `out`.

    Unless `force` is set, a file that has changed since the mission was made from it is refused, and so is one that the
    mission wasn't made from. If the mission is a file itself, it then notes the new state of the XML. Raises
    MissionError (BT136, and those of reading and writing).
    """
    if os.path.exists(path) and not os.path.isfile(path):  # a pipe would be waited for
        raise MissionError([unwritable(path, "it isn't a regular file")])
    original = read_source(path)
    source = mission.tree.origin
    text = source.text if isinstance(source, Source) else ""
    file = source.name if isinstance(source, Source) and os.path.isfile(source.name) else ""
    kept = kept_in(text)
    reason = "" if force else _why_not(kept, original, is_replaced=out is None)
    if reason:
        read_xml(original)  # what is no tree is said first
        anyway = shlex.join(["btc", "compile", file or "MISSION", "--onto", path, "--force"])
        advice = f"Make it again with 'btc compile {shlex.quote(path)} --to english', or write it anyway: {anyway}"
        raise MissionError([diagnostic("BT136", Span(original, 0, 0), path=path, reason=reason, advice=advice)])
    made = str(mission.to("xml", onto=original))
    mark = "\ufeff" if has_mark(path) else ""
    write_file(out or path, mark + made)
    if file and kept.digest and out is None:
        write_file(file, with_digest(text, digest_of(made)))


def _why_not(kept: Kept, original: Source, *, is_replaced: bool) -> str:
    """Return why a mission would undo what is in a file that it knows nothing of; "" where it would not."""
    if not kept.digest:
        return "it doesn't say which file it was made from" if is_replaced else ""
    if kept.digest == digest_of(original.text):
        return ""
    if kept.file != os.path.basename(original.name):
        return f"it was made from {kept.file}"
    return "the file has changed since the mission was made from it"


def edit_xml(options: argparse.Namespace) -> int:
    """Open the English of the file in the editor; return the exit code.

    Raises MissionError for a file that can't be read, said or written, and for a text that doesn't compile, which is
    kept then.
    """
    source = read_source(options.file)
    if frontend_of(source) != "xml":
        raise MissionError([diagnostic("BT001", Span(source, 0, 0), file=source.name, reason="it isn't a tree in XML")])
    words = RobotWords(options.keywords, options.world, options.language)
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
