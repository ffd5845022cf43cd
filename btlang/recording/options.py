"""The options of the verbs of recordings, apart from what these do: most commands need no more."""

from __future__ import annotations

import argparse
from contextlib import AbstractContextManager, nullcontext

from btlang.arguments import between, duration, picture, port, size

USUAL_PORT = 1667
"""At which Groot2 looks for a run; it listens to the next one, too."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.api import Mission
    from btlang.run.events import Sink


def recording(mission: Mission, options: argparse.Namespace) -> AbstractContextManager[list[Sink]]:
    """The sinks that record a run, none where the options ask for no recording."""
    if options.record is None:
        return nullcontext([])
    from btlang.recording.command import recorded

    return recorded(mission, options)


def add_recording_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc run`."""
    parser.add_argument("--record", metavar="FILE", help="record the run as MCAP, for replay, why and Foxglove")
    parser.add_argument(
        "--record-scans",
        type=between(0, 100),
        default=2.0,
        metavar="HZ",
        help="with --record: scans per second (default: 2)",
    )
    add_groot_option(parser)
    parser.add_argument(
        "--record-size", type=size, metavar="SIZE", help="with --record: begin another file at this size, such as 100MB"
    )


def add_picture_options(parser: argparse.ArgumentParser) -> None:
    """Of the verbs that show a run: pictures of it."""
    parser.add_argument(
        "--picture", type=picture(".svg", ".png", ".gif"), metavar="FILE", help="draw the run: .svg, .png or .gif"
    )
    parser.add_argument(
        "--tree-picture",
        type=picture(".svg", ".png"),
        metavar="FILE",
        help="draw the tree with the final status of every node: .svg or .png",
    )


def add_groot_option(parser: argparse.ArgumentParser) -> None:
    """Of the verbs that show a run to Groot2."""
    parser.add_argument(
        "--groot", nargs="?", type=port, const=USUAL_PORT, metavar="PORT",
        help=f"show the run in Groot2, which connects to this port (default: {USUAL_PORT})",
    )  # fmt: skip


def add_browser_option(parser: argparse.ArgumentParser) -> None:
    """Of the verbs that have a page."""
    parser.add_argument(
        "--no-browser", action="store_false", dest="browser", help="print the address without opening the browser"
    )


def add_replay_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc replay`, but for its speed."""
    parser.add_argument("--lines", action="store_true", help="print plain lines, even on a terminal")
    parser.add_argument(
        "--from", type=duration, dest="start", metavar="DURATION", help="begin at this time, such as 5min"
    )
    parser.add_argument("--failure", action="store_true", help="begin at the first failure")
    add_groot_option(parser)
    add_picture_options(parser)
    parser.add_argument("--why", action="store_true", help="at the end, explain what happened, as btc why does")
    parser.add_argument("--to", metavar="FILE", help="write the recording as a log file of Groot2 (.btlog)")
    parser.add_argument(
        "--as-mission", action="store_true", help="run the recorded mission again, and report where the run differs"
    )
    parser.add_argument(
        "--keywords",
        action="append",
        default=[],
        metavar="FILE",
        help="with --as-mission: keyword file; may be repeated",
    )
    add_recording_file(parser)


def add_recording_file(parser: argparse.ArgumentParser) -> None:
    """The recording that a verb reads."""
    parser.add_argument("file", metavar="FILE", help="recording that btc run --record wrote")
