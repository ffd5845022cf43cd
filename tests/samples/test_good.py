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

from btlang.api import parse_tree, world_vocabulary
from btlang.diagnostics.reading import read_source
from btlang.frontends.mission.reader import read_mission
from btlang.printer.mission import english
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
    # nodes.md
    "A node by its id": "nodes", "Nodes with children": "nodes", "Subtrees": "nodes",
    # missions.md
    "Statements": "layout", "What does not matter": "layout", "Blocks": "if", "Joined blocks": "joined_blocks",
    "Brackets": "brackets", "Silencing a warning": "silenced",
    "What a mission needs": "needs", "Lists of statements": "list_items",
    # phrases.md
    "Phrases": "values", "Values and units": "values", "Texts": "layout", "Lists": "lists_and_quantities",
    "Every name": "every_name", "Points": "points",
    "The nearest and a random one": "chosen", "Descriptions": "nouns", "Constraints": "constraints",
    "Verbs with roles": "verbs_with_roles", "Things by description": "verbs_with_roles",
    "Sets and rounds": "rounds", "Pronouns": "pronouns",
    "Quantities": "lists_and_quantities",
    # conditions.md
    "check": "conditions", "Joined conditions": "conditions", "not": "conditions",
    "Nobody and nothing": "lists_of_conditions", "Lists as subjects": "lists_of_conditions",
    "neither, both, any of": "lists_of_conditions", "Shared words": "shared_words",
    "Where a condition ends": "conditions", "Names of conditions": "definitions",
    # requests.md
    **dict.fromkeys(("Requests", "Questions", "Values in speech", "Remarks"), "requests"),
    "Messages to people": "messages",
    # joining.md
    "After a command": "postfix", "and": "connectives", "At the same time": "connectives",
    "One if the other fails": "connectives",
    "One after the other": "connectives", "Tighter and looser": "connectives",
    "How far a form before a command reaches": "reach", "Where repeat ends": "reach",
    "Which form an otherwise belongs to": "otherwise",
    "either, both and one of": "lists_of_commands",
    "Merging": "merging", "Words with another meaning in a pack": "meanings",
    # commas.md
    "A bare comma": "commas", 'A comma before "and" or "or"': "commas", "A comma before a form at the end": "reach",
    # forms.md
    "if and unless": "if", "while and until": "loops", "provided that": "postfix", "repeat": "loops",
    "try and retry": "tries", "Limits, rounds and delays": "timing", "Waiting": "timing",
    "Times of day": "clock_times",
    "do nothing and fail": "words",
    # rules.md; what breaks the rule of resources is a bad sample
    "Standing rules": "whenever", "Resources": "connectives", "Skipped rounds": "skipped_rounds",
    # sentences.md
    "Going on after a full stop": "going_on", "If that works": "going_on", "In any case": "going_on",
    "Do that again": "again", "One meaning of and for a mission": "again", "Parts that never end": "going_on",
    "Words left out": "left_out", "Before, after and while with a verb": "verb_forms",
    "but stop when": "early", "as soon as": "early",
    # names.md
    "Names": "definitions", "Parameters": "parameters", "Places of the mission": "facts", "include": "includes",
    "Values of the mission": "values_of_the_mission", "for each": "for_each",
    "Values from outside": "given",
    "Ports and names behind phrases": "given",
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
            assert "```console\n$ btc " in section, section.partition("\n")[0]


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
