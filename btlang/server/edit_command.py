"""What `btc edit` does: a page for one file, until Ctrl-C; or an XML file in English in an editor."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse


def serve(options: argparse.Namespace) -> int:
    """Does the verb `edit`; returns the exit code. Raises MissionError."""
    if options.editor:
        from btlang.editing.in_editor import edit_xml

        return edit_xml(options)
    from btlang.server.editor import edit

    return edit(options)
