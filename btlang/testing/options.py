"""The options of `btc test`."""

from __future__ import annotations

import argparse

from btlang.arguments import at_least


def add_test_options(parser: argparse.ArgumentParser) -> None:
    """All of them."""
    parser.add_argument("--name", metavar="TEXT", help="only tests with this in their names")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of random choices (default: 0)")
    parser.add_argument(
        "--repeat", type=at_least(1), default=1, metavar="N", help="run each test with so many seeds, from --seed on"
    )
    parser.add_argument(
        "--chaos", action="store_true", help="let the world go wrong at random, and watch only the rules of safety"
    )
    parser.add_argument(
        "--jobs", type=at_least(1), metavar="N", help="tests to run at the same time (default: one for each core)"
    )
    parser.add_argument("--coverage", action="store_true", help="draw on the trees what never ran or never happened")
    parser.add_argument("--junit", metavar="FILE", help="write the results as JUnit XML")
    parser.add_argument(
        "--keep", default="test-recordings", metavar="FOLDER", help="for recordings of failures (default: %(default)s)"
    )
    parser.add_argument("--include-root", metavar="DIR", help="missions may also lie below DIR")
    parser.add_argument("--quiet", action="store_true", help="print only failures")
    parser.add_argument("path", nargs="*", metavar="PATH", help="files or folders of tests (default: this folder)")
