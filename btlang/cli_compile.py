"""The verb `compile`: the tree of a mission in another form, or pages about many trees."""

from __future__ import annotations

import argparse
import sys

from btlang.backends.targets import TARGETS, target_of
from btlang.cli_input import mission_of, parsed_mission

_SUCCESS = 0
_PAGES = "markdown"


def serve(options: argparse.Namespace) -> int:
    """Writes what the options ask for; returns the exit code. Raises MissionError."""
    name = options.to or ("xml" if options.onto is not None else target_of(options.out or ""))
    if not name:
        options.refuse(f"choose a target with --to: {', '.join(TARGETS)}")
    if options.out is None and TARGETS[name].binary and sys.stdout.isatty():
        options.refuse(f"{name} isn't text; write it to a file with -o FILE")
    for option in ("dialect", "onto"):
        if getattr(options, option) is not None and option not in TARGETS[name].options:
            options.refuse(f"--{option} is for xml, not for {name}")
    if name == _PAGES and options.text is None:
        _write_pages(options)
        return _SUCCESS
    if len(options.file) > 1:
        options.refuse(f"{name} takes one file; several are for --to {_PAGES}")
    options.file = options.file[0] if options.file else None
    if options.onto is not None:
        if options.dialect is not None:
            options.refuse("the dialect is that of the file with --onto")
        from btlang.editing.onto import write_onto

        write_onto(mission_of(options), options.onto, options.out, force=options.force)
        return _SUCCESS
    from btlang.backends.files import put

    put(mission_of(options).to(name, dialect=options.dialect), options.out)
    return _SUCCESS


def _write_pages(options: argparse.Namespace) -> None:
    from functools import partial

    from btlang.documents.command import write_pages
    from btlang.documents.project import read_documents
    from btlang.mission_vocabulary import world_vocabulary

    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    project = read_documents(options.file, vocabulary, partial(parsed_mission, options=options))
    if not write_pages(project, options.file, options.out):
        options.refuse("several files become several pages; name a folder for them with -o FOLDER")
