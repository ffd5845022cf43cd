"""BT163: half turns that are counted, as most people mean whole turns by `turn around three times`.

BT050 for `turn around and drive back 1 m`: backwards, or the way back that the robot faces then.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.other_reading import Readings
from btlang.passes.lint.two_readings import printer_for, warning_of
from btlang.tree import ast

_ENDLESS = "-1"
_HALF, _WHOLE = "TurnAround", "TurnOnceAround"
_BACKWARD, _FORWARD = "MoveBackward", "MoveForward"


def half_turns(compilation: Compilation) -> Iterator[Diagnostic]:
    """Among the loops of the mission and of its definitions."""
    whole = compilation.vocabulary.entry(_WHOLE)
    example = whole.example if whole is not None else ""
    for body in ast.bodies(compilation.mission) if example else ():
        for node in compilation.syntax(body):
            if (
                type(node) is ast.Repeat
                and isinstance(node.body, ast.Phrase)
                and node.body.entry.id == _HALF
                and node.rounds != _ENDLESS
            ):
                said = node.span.text
                fixed = said.replace(node.body.span.text, example, 1)
                note = diagnostic("BT163", node.span, words=said, fixed=fixed)
                yield note.replace(readings=((node.span, fixed),))
            elif type(node) is ast.Chain and node.operator == "sequence":
                yield from _ways_back(node, compilation)


def _ways_back(chain: ast.Chain, compilation: Compilation) -> Iterator[Diagnostic]:
    """Where a robot that has turned around drives back, and not in as many words backwards."""
    vocabulary = compilation.vocabulary
    forward, particles = vocabulary.entry(_FORWARD), vocabulary.values.role_words.particles
    for turn, drive in pairwise(chain.items):
        if forward is None or not isinstance(turn, ast.Phrase) or not isinstance(drive, ast.Phrase):
            continue
        said = drive.span.text.lower().split()
        if (turn.entry.id, drive.entry.id) == (_HALF, _BACKWARD) and not particles.isdisjoint(said):
            printer = printer_for(compilation)
            fix = drive.span, printer.statement(drive)
            yield warning_of(Readings(drive, drive.replace(entry=forward), drive.span, fix), printer)
