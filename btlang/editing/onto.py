"""English that goes back onto the XML file that it was made from."""

from __future__ import annotations

import os
import shlex

from btlang.api import Mission
from btlang.backends.files import write_file
from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import has_mark, read_source
from btlang.frontends.btcpp.kept import digest_of, kept_in, with_digest
from btlang.frontends.btcpp.reader import read_xml
from btlang.text.source import Source, Span


def write_onto(mission: Mission, path: str, out: str | None = None, *, force: bool = False) -> None:
    """Writes a mission onto an XML file at once, or what that gives into the file `out`.

    Unless `force` is set, a file that has changed since the mission was made from it is refused. If the mission is a
    file itself, it then notes the new state of the XML. Raises MissionError (BT136, and those of reading and writing).
    """
    original = read_source(path)
    source = mission.tree.origin
    text = source.text if isinstance(source, Source) else ""
    kept = kept_in(text)
    if not force and kept.digest not in ("", digest_of(original.text)):
        read_xml(original)  # what is no tree hasn't only changed
        again = f"btc compile {shlex.quote(path)} --to english"
        advice = f"Make the mission again with '{again}', or write it anyway with --force."
        raise MissionError([diagnostic("BT136", Span(original, 0, 0), path=path, advice=advice)])
    made = str(mission.to("xml", onto=original))
    mark = "\ufeff" if has_mark(path) else ""
    write_file(out or path, mark + made)
    if isinstance(source, Source) and kept.digest and out is None and os.path.isfile(source.name):
        write_file(source.name, with_digest(text, digest_of(made)))
