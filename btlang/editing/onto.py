"""English that goes back onto the XML file that it was made from."""

from __future__ import annotations

import os
import shlex

from btlang.api import Mission
from btlang.backends.files import write_file
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.reading import has_mark, read_source, unwritable
from btlang.frontends.btcpp.kept import Kept, digest_of, kept_in, with_digest
from btlang.frontends.btcpp.reader import read_xml
from btlang.text.source import Source, Span


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
