"""The command `btc`: `verbs.py` is the table of its verbs, with the handler of each."""

from __future__ import annotations

import errno
import os
import sys
from importlib import import_module

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import os_error_reason
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

SUCCESS, FAILED, BAD_INPUT, CRASHED, INTERRUPTED = 0, 1, 2, 70, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb; return the exit code.

    0 success or skipped, 1 mission failed, 2 bad input, 3 the robot still moves at the end, 70 a bug in btlang,
    130 interrupted, 131 emergency stop, 143 terminated. With BTC_DEBUG set, what a bug raises comes through.
    """
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal that cannot show a character still gets the rest
    try:
        from btlang.cli.missions import add_robot_files
        from btlang.cli.parser import parse_arguments
        from btlang.cli.verbs import VERBS
        from btlang.diagnostics.report import DiagnosticReport

        options = parse_arguments(arguments)
        options.report = DiagnosticReport(options.format, on_output=options.verb in ("check", "world"))
        try:
            add_robot_files(options)
            code = _run_handler(options, VERBS[options.verb].handler)
        except MissionError as error:
            options.report.add(error.diagnostics)
            code = BAD_INPUT
        options.report.close()
        if sys.stdout is not None:
            sys.stdout.flush()
        return code
    except OSError as error:
        # the reader of our output has seen enough, or the terminal is gone
        codes = {errno.EPIPE: SUCCESS, errno.EIO: INTERRUPTED}
        if error.errno not in codes:
            show(f"btc: {os_error_reason(error)}", stream=sys.stderr)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nowhere, stream.fileno())
        return codes.get(error.errno or 0, BAD_INPUT)
    except KeyboardInterrupt as interrupt:
        return 128 + interrupt.args[0] if interrupt.args else INTERRUPTED  # see `interrupted_by_signals`
    except Exception as error:
        if os.environ.get("BTC_DEBUG"):
            raise
        from btlang.diagnostics.report import report_crash

        show(report_crash(error), sys.stderr)
        return CRASHED


def print_version(options: argparse.Namespace) -> int:
    """Print the version."""
    import btlang

    show(f"btc {btlang.__version__}")
    return SUCCESS


def _run_handler(options: argparse.Namespace, place: str) -> int:
    module, _, function = place.partition(":")
    code: int = getattr(import_module(module), function)(options)
    return code
