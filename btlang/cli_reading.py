"""The options of the verbs that read missions and run nothing, and those that other verbs share with them."""

from __future__ import annotations

import argparse

from btlang.arguments import picture
from btlang.diagnostics.report import CHECK_FORMATS, FORMATS
from btlang.frontends.mission.reader import DEFAULT_PARSER, PARSERS
from btlang.robots.platforms import add_world
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def add_words_options(parser: argparse.ArgumentParser) -> None:
    """Which words there are, and which places."""
    parser.add_argument(
        "--keywords",
        action="append",
        default=[],
        metavar="FILE",
        help="another keyword file, an XML file whose nodes become words, or the name of a pack; may be repeated",
    )
    parser.add_argument(
        "--language", default=ENGLISH, metavar="LANG", help="language of missions: en, es, or a folder (default: en)"
    )
    add_world(parser)


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Those of words, and how missions are read with them."""
    add_words_options(parser)
    parser.add_argument(
        "--parser",
        choices=list(PARSERS),
        default=DEFAULT_PARSER,
        help="which parser to use; both give the same tree (default: %(default)s)",
    )
    parser.add_argument("--include-root", metavar="DIR", help="missions may also include files below DIR")


def add_main_option(parser: argparse.ArgumentParser) -> None:
    """Which tree is meant."""
    parser.add_argument("--main", default="", metavar="ID", help="which tree to use if the file holds several")


def add_mission_options(parser: argparse.ArgumentParser, *, several: bool = False) -> None:
    """Those of reading, and the mission; with `several`, there may be many files."""
    add_reading_options(parser)
    about = "format of messages: text, or json for programs (default: text)"
    parser.add_argument("--format", choices=FORMATS, default="text", help=about)
    add_main_option(parser)
    text = parser.add_mutually_exclusive_group(required=True)
    files: dict[str, Any] = {"nargs": "*", "default": []} if several else {"nargs": "?"}
    text.add_argument("file", **files, metavar="FILE", help="mission, or - for standard input")
    text.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def add_check_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc check`."""
    add_reading_options(parser)
    about = "format of messages: text; json, sarif or github for programs (default: text)"
    parser.add_argument("--format", choices=CHECK_FORMATS, default="text", help=about)
    add_main_option(parser)
    parser.add_argument(
        "--models",
        action="append",
        default=[],
        metavar="FILE",
        help="XML file with models of nodes (TreeNodesModel); may be repeated",
    )
    parser.add_argument("--fix", action="store_true", help="write the corrections that are certain into the files")
    several = parser.add_mutually_exclusive_group(required=True)
    about = "mission, tree or folder of trees, or - for standard input; all XML files are one project"
    several.add_argument("file", nargs="*", default=[], metavar="FILE", help=about)
    several.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def add_diff_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc diff`."""
    add_words_options(parser)
    parser.add_argument(
        "--markdown", action="store_true", help="print a list in Markdown, for example for a pull request"
    )
    parser.add_argument("old", metavar="OLD", help="mission, tree in XML or JSON, or recording")
    parser.add_argument("new", metavar="NEW", help="what to compare with it")


def add_tree_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc tree`."""
    add_mission_options(parser)
    parser.add_argument("--plain", action="store_true", help="one line per node: Id port=value")
    parser.add_argument("--picture", type=picture(".svg", ".png"), metavar="FILE", help="draw the tree: .svg or .png")
    parser.add_argument("--apart", action="store_true", help="draw each named subtree once, below the tree")


def add_compile_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc compile`."""
    from btlang.backends.targets import TARGETS

    add_mission_options(parser, several=True)
    parser.add_argument("--to", choices=list(TARGETS), metavar="TARGET", help="target: " + ", ".join(TARGETS))
    parser.add_argument(
        "-o",
        dest="out",
        metavar="OUT",
        help="file to write, or with markdown a folder; without --to, its ending selects the target",
    )
    parser.add_argument("--dialect", type=int, choices=(3, 4), help="BehaviorTree.CPP version of the XML (default: 4)")
    parser.add_argument(
        "--onto", metavar="XML", help="the file that the mission was made from: change only what was edited"
    )
    parser.add_argument(
        "--force", action="store_true", help="with --onto: even if the file has changed since, or is a different one"
    )


def add_listing_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc words`."""
    add_words_options(parser)
    parser.add_argument("--all", action="store_true", help="list everything, with what it does and an example")
    about = "make a keyword file for the nodes of this XML file; may be repeated"
    parser.add_argument("--from", dest="sources", action="append", default=[], metavar="XML", help=about)
    parser.add_argument("-o", dest="out", metavar="FILE", help="with --from: file to write (default: standard output)")
    parser.add_argument("search", nargs="*", metavar="SEARCH", help="a topic, or words to search for")


def add_grammar_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc grammar`."""
    from btlang.backends.grammar.targets import GRAMMARS

    add_words_options(parser)
    parser.add_argument("--to", choices=list(GRAMMARS), default="gbnf", help="form of the grammar (default: gbnf)")
    parser.add_argument("-o", dest="out", metavar="FILE", help="file to write (default: standard output)")


def add_explain_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc explain`."""
    add_reading_options(parser)
    add_main_option(parser)
    subject = parser.add_mutually_exclusive_group()
    subject.add_argument(
        "file", nargs="?", metavar="FILE|CODE", help="mission, - for standard input, or a code such as BT013"
    )
    subject.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")


def add_format_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc format`."""
    add_reading_options(parser)
    parser.add_argument("--check", action="store_true", help="change nothing; exit with 1 if a file would change")
    several = parser.add_mutually_exclusive_group(required=True)
    several.add_argument("file", nargs="*", default=[], metavar="FILE", help="mission, or - for standard input")
    several.add_argument("-c", dest="text", metavar="TEXT", help="mission as text")
