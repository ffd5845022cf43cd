"""Parameters that may be a place or a person: their first use decides."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.frontends.mission.symbols.scopes import Scopes


@pytest.mark.parametrize(
    ("text", "node"),
    [
        ("serve {guest} is go to {guest}; serve Alice", "GoToPerson"),
        ("serve {guest} is go to {guest}; serve the kitchen", "GoTo"),
        ("serve {guest} is go to {guest}\nfor each client in Alice, Bob: serve {client}", "GoToPerson"),
        ("serve {guest} is:\n  go to {guest}\nfor each guest in Alice and Bob: serve the guest", "GoToPerson"),
        ("serve {guest} is go to {guest}\nfor each person: serve the person", "GoToPerson"),
    ],
)
def test_a_parameter_is_what_it_is_first_used_with(text: str, node: str) -> None:
    for parser in ("shunting-yard", "lark"):
        ids = {each.id for each in parse_tree(text, parser=parser).tree.walk()}
        assert node in ids
        assert len({"GoTo", "GoToPerson"} & ids) == 1


def test_more_names_with_parameters_make_no_more_scopes(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Scopes] = []
    init = Scopes.__init__
    monkeypatch.setattr(Scopes, "__init__", lambda self, *given: made.append(self) or init(self, *given))
    counts = []
    for names in ("abc", "abcdefghijkl"):
        made.clear()
        lines = [f"serve table {name} to {{guest}} is go to {{guest}}" for name in names]
        parse_tree("\n".join([*lines, *(f"serve table {name} to Alice" for name in names)]))
        counts.append(len(made))
    assert counts[0] == counts[1]
