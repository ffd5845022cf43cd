"""Writes `mission.tables.json`, the LALR tables that Lark makes of `mission.lark`. Run it after changing the grammar.

The package reads only the tables: the wheels of ROS 2 bring lark-parser, an old Lark that overwrites a new one, so a
parser that imports Lark would break when `btlang[ros]` is installed.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

GRAMMAR = Path(__file__).with_name("mission.lark")
TABLES = Path(__file__).with_name("mission.tables.json")


def tables(grammar: str) -> dict[str, Any]:
    """The rules, and for each state what follows each symbol.

    `rules` are [symbol, callback, number of parts, flag]: "inline" for Lark's own helpers of `*` and `+`, "single" for
    a rule that stands for its only part. `states` map a symbol to n >= 0, "go to state n", or to -n, "reduce by rule
    n - 1"; the text begins in state 0 and is complete in state `end`. Raises lark.GrammarError where the grammar has a
    conflict.
    """
    from lark import Lark
    from lark.parsers.lalr_analysis import Shift

    lark: Any = Lark(grammar, start="mission", parser="lalr", lexer="contextual", strict=True)
    table = lark.parser.parser.parser.parse_table
    numbers = {rule: number for number, rule in enumerate(lark.rules)}
    [start], [end] = table.start_states.values(), table.end_states.values()
    order = [start]  # Lark's own order of states changes from run to run
    for state in order:
        for _, (action, target) in sorted(table.states[state].items()):
            if action is Shift and target not in order:
                order.append(target)
    return {
        "rules": [
            [rule.origin.name, rule.alias or rule.origin.name, len(rule.expansion), _flag(rule)] for rule in lark.rules
        ],
        "states": [
            {
                symbol: order.index(argument) if action is Shift else -1 - numbers[argument]
                for symbol, (action, argument) in sorted(table.states[state].items())
            }
            for state in order
        ],
        "end": order.index(end),
    }


def text_of(grammar: str) -> str:
    """The file, a state a line."""
    made = tables(grammar)
    lines = ",\n".join(json.dumps(state) for state in made["states"])
    return f'{{"rules": {json.dumps(made["rules"])},\n"end": {made["end"]},\n"states": [\n{lines}\n]}}\n'


def _flag(rule: Any) -> str:
    if rule.origin.name.startswith("_"):
        return "inline"
    return "single" if rule.options.expand1 and not rule.alias else ""


if __name__ == "__main__":
    TABLES.write_text(text_of(GRAMMAR.read_text(encoding="utf-8")), encoding="utf-8")
    sys.stdout.write(f"{TABLES.name} is up to date.\n")
