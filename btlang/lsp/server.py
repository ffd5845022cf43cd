"""The verb `lsp`: a language server, which speaks to an editor on standard input and output.

It reads files and never runs one. Nothing but the protocol is written to standard output.
"""

from __future__ import annotations

import gc
import logging
import os
import sys
from importlib.util import find_spec

from btlang import __version__
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.editing.words import RobotWords
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_OUTPUT, _ERRORS = 1, 2


def serve(options: argparse.Namespace) -> int:
    """Serve one client until it disconnects. Raises MissionError where the package `pygls` is missing (BT082)."""
    if find_spec("pygls") is None:
        raise MissionError([diagnostic("BT082", Span(Source("", "btc lsp"), 0, 0), verb="lsp", package="pygls")])
    words = RobotWords(options.keywords, options.world, options.language)
    words.vocabulary(Source(""))  # what can't be used is said at the start
    from btlang.lsp.features import make_server

    gc.freeze()  # looking through all words for garbage takes longer than a key may
    logging.getLogger("pygls").setLevel(logging.CRITICAL + 1)  # it logs tracebacks of what is answered anyway
    server = make_server(words, __version__)
    with os.fdopen(os.dup(_OUTPUT), "wb") as output:
        os.dup2(_ERRORS, _OUTPUT)  # whatever else prints, also in other processes, prints elsewhere
        sys.stdout = sys.stderr
        server.start_io(stdout=output)
    return 0
