"""Each pass alone: texts and trees with what the pass makes of them, in a file of its own in `fixtures/`.

A block is a text, a line `=>` and what the pass finds; `---` parts blocks. UPDATE_GOLDEN=1 writes the files anew.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.mission.reader import read_mission
from btlang.passes import PASSES
from btlang.passes.compilation import Compilation, Pass
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.dump import outline

FIXTURES = Path(__file__).parent / "fixtures"


def blocks(path: Path) -> list[str]:
    return [block.partition("\n=>")[0].strip("\n") for block in path.read_text(encoding="utf-8").split("\n---\n")]


def made_of(text: str, wanted: Pass) -> str:
    """What a pass makes of a text, behind all that come before it."""
    source, vocabulary = Source(text), world_vocabulary()
    if text.startswith("<"):
        compilation = Compilation(vocabulary, tree=read_xml(source))
    else:
        reading = read_mission(source, vocabulary)
        compilation = Compilation(vocabulary, reading.mission, warnings=reading.warnings)
    for one in PASSES[: PASSES.index(wanted)]:
        if compilation.is_text or not one.needs_text:
            before = list(one.run(compilation))
            assert one.goes_on or wanted.goes_on or not any(problem.is_error for problem in before), before
            compilation.warnings += before
    found = list(wanted.run(compilation))
    lines = [shown(problem) for problem in found]
    if wanted.name == "names":
        lines.append(" ".join(definition.name for definition in compilation.ordered))
    elif wanted.name == "lowering" and not found:
        lines.append(outline(compilation.tree))
    elif wanted.name.startswith("allow"):
        lines += [f"heard: {shown(warning)}" for warning in compilation.warnings]
    return "\n".join(lines)


def shown(problem: Diagnostic) -> str:
    line, column = problem.span.source.position(problem.span.start)
    return f"{problem.code} {line}:{column} {problem.message}"


@pytest.mark.parametrize("one", PASSES, ids=lambda one: one.name)
def test_a_pass_does_as_its_fixture_says(one: Pass) -> None:
    path = FIXTURES / f"{one.name.replace(' ', '_')}.txt"
    made = "\n---\n".join(f"{text}\n=>\n{made_of(text, one)}".rstrip() for text in blocks(path)) + "\n"
    if os.environ.get("UPDATE_GOLDEN"):
        path.write_text(made, encoding="utf-8")
    assert made == path.read_text(encoding="utf-8")


def test_no_fixture_is_without_a_pass() -> None:
    assert {path.stem for path in FIXTURES.iterdir()} == {one.name.replace(" ", "_") for one in PASSES}
