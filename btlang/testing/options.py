"""The options of `btc test`."""

from __future__ import annotations

import argparse

from btlang.arguments import at_least


def add_test_options(parser: argparse.ArgumentParser) -> None:
    """All of them."""
    parser.add_argument("--name", metavar="TEXT", help="run only tests with this text in their names")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of random choices (default: 0)")
    parser.add_argument(
        "--repeat", type=at_least(1), default=1, metavar="N", help="run each test with N seeds, from --seed on"
    )
    parser.add_argument("--chaos", action="store_true", help="inject faults at random, and check only the safety rules")
    parser.add_argument(
        "--jobs", type=at_least(1), metavar="N", help="run N tests at the same time (default: one for each core)"
    )
    parser.add_argument(
        "--coverage",
        action="store_true",
        help="mark in the trees which nodes never ran and which outcomes never happened",
    )
    parser.add_argument("--junit", metavar="FILE", help="write the results as JUnit XML")
    parser.add_argument(
        "--keep",
        default="test-recordings",
        metavar="FOLDER",
        help="folder for recordings of failed tests (default: %(default)s)",
    )
    parser.add_argument("--include-root", metavar="DIR", help="tests may also run missions below DIR")
    parser.add_argument("--quiet", action="store_true", help="print only failures")
    parser.add_argument("path", nargs="*", metavar="PATH", help="files or folders of tests (default: this folder)")
