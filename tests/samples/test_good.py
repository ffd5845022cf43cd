"""Missions with their syntax tree, their behavior tree and their English as golden files, by both parsers.

Beside a sample may stand a keyword file of its name. Together the samples show every heading of the language reference,
every class of syntax node, every role of connective words and every way to compare.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.files import read_source
from btlang.frontends.mission.reader import read_mission
from btlang.printer.mission import english
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree import ast
from btlang.tree.dump import plain
from btlang.vocabulary.entry import COMPARISONS
from btlang.vocabulary.language_tables import ROLES
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import forms
from tests.conftest import matches_golden
from tests.language.letters import shown

GOOD = Path(__file__).parent / "good"
SAMPLES = sorted(GOOD.glob("*.txt"))
PAGES = sorted((Path(__file__).parents[2] / "docs" / "language").glob("*.md"))

ROWS = {
    # commands.md, when.md, talking.md
    "A command": "layout", "Several commands": "connectives", "Places, things and people": "verbs_with_roles",
    "More than one": "rounds", "It, them, there": "pronouns",
    "Under a condition": "conditions", "When something fails": "tries", "Again and again": "loops",
    "In which order": "order", "Time": "timing", "All the time": "whenever", "Where not to go": "constraints",
    "Ask the robot for something": "requests", "Let the robot speak": "requests",
    "Let the robot ask and listen": "messages", "Give a part a name": "definitions",
    "When btlang doesn't understand": "silenced",
    # missions.md
    "Statements": "layout", "What does not matter": "layout", "Lists of statements": "list_items",
    "Blocks": "joined_blocks", "Brackets": "brackets", "What a mission needs": "needs",
    "Silencing a warning": "silenced",
    # phrases.md
    "Phrases": "values", "Verbs with roles": "verbs_with_roles", "Journeys": "order", "Values and units": "values",
    "Texts": "layout", "Points": "points",
    # joining.md
    "One after the other": "connectives", "and": "connectives", "At the same time": "connectives",
    "Parts that never end": "going_on", "One if the other fails": "connectives",
    "either, both and one of": "lists_of_commands", "Words left out": "left_out",
    "Before, after and while with a verb": "verb_forms", "Words with another meaning": "meanings",
    "Resources": "connectives",  # what breaks the rule of resources is a bad sample
    # grouping.md
    "From tight to loose": "connectives", "A form after a command": "postfix", "A form before a command": "reach",
    "Where repeat ends": "reach", "Which form an otherwise belongs to": "otherwise", "A bare comma": "commas",
    'A comma before "and" or "or"': "commas", "A comma before a form at the end": "reach", "Merging": "merging",
    # sentences.md
    **dict.fromkeys(("Going on after a full stop", "If that works", "In any case"), "going_on"),
    "What a command has settled": "order",
    "Each of the places before": "each_place", "Do that again": "again",
    # things.md
    "Lists": "lists_and_quantities", "Every name": "every_name", "Which one": "which_one",
    "Descriptions": "nouns", "Sets and rounds": "rounds", "Pronouns": "pronouns",
    # conditions.md
    **dict.fromkeys(("check", "Joined conditions", "Where a condition ends", "not"), "conditions"),
    "Lists as subjects": "lists_of_conditions", "neither, both, any of": "lists_of_conditions",
    "Shared words": "shared_words", "Quantities": "lists_and_quantities", "Names of conditions": "definitions",
    # forms.md
    "if and unless": "if", "while and until": "loops", "provided that": "postfix", "but stop when": "early",
    "as soon as": "early", "repeat": "loops", "try and retry": "tries", "do nothing and fail": "words",
    "Skipped rounds": "skipped_rounds",
    # time.md
    "Limits, rounds and delays": "timing", "Waiting": "timing", "Times of day": "clock_times",
    # rules.md
    "Standing rules": "whenever", "Constraints": "constraints", "Prohibitions and permissions": "constraints",
    # requests.md
    **dict.fromkeys(("Requests", "Questions", "Values in speech", "Remarks"), "requests"),
    "Messages to people": "messages", "Asking and listening": "messages",
    # names.md
    "Names": "definitions", "Parameters": "parameters", "Places of the mission": "facts", "include": "includes",
    "Values of the mission": "values_of_the_mission", "Values from outside": "given", "for each": "for_each",
    # nodes.md
    "A node by its id": "nodes", "Ports and names behind phrases": "given", "Nodes with children": "nodes",
    "Names and forms of nodes with children": "node_forms", "Subtrees": "nodes",
}  # fmt: skip
"""The headings of the language reference, each with the sample of what stands below it."""


def keywords(sample: Path) -> list[str]:
    """The keyword file of a sample, where there is one."""
    own = sample.with_suffix(".toml")
    return [str(own)] if own.exists() else []


def mission(sample: Path, vocabulary: Lexicon, parser: str = "shunting-yard") -> ast.Program:
    return read_mission(read_source(str(sample)), vocabulary, parser).mission


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize("sample", SAMPLES, ids=[s.stem for s in SAMPLES])
def test_reading(sample: Path, parser: str) -> None:
    words = keywords(sample)
    vocabulary = world_vocabulary(words)
    read = mission(sample, vocabulary, parser)
    definitions = [f"{d.name} = {shown(d.body)}" for d in read.definitions]
    items = getattr(read.body, "items", (read.body,))
    tree = plain(parse_tree(read_source(str(sample)), parser=parser, keywords=words).tree)
    said = english(read, vocabulary, brackets="all")
    actual = "\n".join(["-- syntax", *definitions, *map(shown, items), "-- tree", tree, "-- english", said, ""])
    matches_golden(actual, sample.with_suffix(".out"))


@cache
def nodes() -> tuple[ast.Ast, ...]:
    """All syntax nodes of all samples."""
    return tuple(node for sample in SAMPLES for node in below(mission(sample, world_vocabulary(keywords(sample)))))


def below(root: ast.Ast) -> Iterator[ast.Ast]:
    """A node and all in it, facts and includes too."""
    stack = [root]
    while stack:
        node = stack.pop()
        yield node
        stack += ast.parts(node)
        if isinstance(node, ast.Program):
            stack += [*node.facts, *node.includes]


def test_every_heading_of_the_reference_has_a_sample() -> None:
    headings = re.findall("^## (.*)$", "".join(page.read_text(encoding="utf-8") for page in PAGES), re.MULTILINE)
    assert sorted(headings) == sorted(ROWS)
    assert set(ROWS.values()) <= {sample.stem for sample in SAMPLES}


def test_every_section_of_the_reference_has_an_example() -> None:
    for page in PAGES:
        for section in page.read_text(encoding="utf-8").split("\n## ")[1:]:
            assert "```console\n$ btc " in section or "```mission\n" in section, section.partition("\n")[0]


def test_every_class_of_syntax_node_occurs() -> None:
    known = {each for each in vars(ast).values() if isinstance(each, type) and issubclass(each, ast.Ast)}
    public = {each.__name__ for each in known - {ast.Ast} if not each.__name__.startswith("_")}
    assert public - {type(node).__name__ for node in nodes()} == set()


def test_every_kind_of_chain_occurs_with_and_without_brackets() -> None:
    found = {(node.operator, node.bracketed) for node in nodes() if isinstance(node, ast.Chain)}
    operators = ("sequence", "fallback", "parallel", "all", "any")
    assert found == {(operator, bracketed) for operator in operators for bracketed in (True, False)}


def test_every_way_to_compare_occurs() -> None:
    ports = {port for node in nodes() if isinstance(node, ast.Phrase | ast.Compared) for port, _ in node.arguments}
    assert set(COMPARISONS) - ports == set()


@pytest.mark.parametrize("role", [role for role, slot in ROLES.items() if not slot])
def test_every_role_occurs(role: str) -> None:
    """Those with a slot make a class of their own or, as `count`, belong to `repeat` and `retry`."""
    vocabulary = world_vocabulary()
    said = " ".join(" ".join(re.findall(r"[\w',]+", read_source(str(sample)).text.lower())) for sample in SAMPLES)
    plainly = " ".join(word for word in said.split() if word not in vocabulary.articles)
    phrases = {" ".join(map(str, form)) for phrase in vocabulary.roles[role] for form in forms(phrase)}
    assert any(re.search(rf"\b{re.escape(phrase)}\b", plainly) for phrase in phrases)
