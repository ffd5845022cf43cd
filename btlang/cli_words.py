"""The verb `words`: what missions can say, or words for the nodes of somebody's XML files."""

from __future__ import annotations

import argparse

from btlang.mission_vocabulary import world_vocabulary
from btlang.text.output import listing_width, show

_SUCCESS = 0


def serve(options: argparse.Namespace) -> int:
    """Lists words, or with `--from` writes a keyword pack; returns the exit code. Raises MissionError."""
    search = " ".join(options.search)
    if options.sources:
        if search or options.all:
            options.refuse("--from makes words and lists none; leave out --all and what to search for")
        _make(options)
        return _SUCCESS
    if options.out is not None:
        options.refuse("-o is for the words that --from makes")
    from btlang.vocabulary.listing import listing, overview

    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    if search or options.all:
        show("\n".join(listing(vocabulary, search, listing_width())))
    else:
        show("\n".join(overview(vocabulary, listing_width())))
    return _SUCCESS


def _make(options: argparse.Namespace) -> None:
    """Writes the pack; the nodes that it has no words for go to the report."""
    from functools import partial

    from btlang.backends.files import put
    from btlang.backends.keyword_pack import pack_of_files
    from btlang.diagnostics.reading import read_source
    from btlang.passes.lint.allow import not_allowed
    from btlang.vocabulary.load import vocabulary_with

    vocabulary = world_vocabulary(options.keywords, options.world, options.language)
    load = partial(vocabulary_with, keywords=options.keywords, language=options.language)
    pack, _ = pack_of_files([read_source(path) for path in options.sources], vocabulary, load)
    options.report.add(not_allowed(pack.warnings))
    put(pack.text, options.out)
