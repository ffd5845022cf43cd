"""One entry in a keyword file is all that a new word needs: it is listed, completed and suggested without new code."""

from __future__ import annotations

import pytest

from btlang.cli import main
from btlang.repl.draft import MissionDraft
from btlang.repl.preview import continuations

ENTRY = """
[[action]]
phrase = "juggle {count} ball(s) [for {person}]"
id = "Juggle"
topic = "circus"
help = "Keeps balls in the air."
example = "juggle 3 balls for Alice"
resources = ["left arm", "right arm"]
"""


@pytest.fixture(scope="module")
def pack(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("pack") / "circus.toml"
    path.write_text(ENTRY, encoding="utf-8")
    return str(path)


def printed(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """All that a command prints."""
    main(list(arguments))
    out, err = capsys.readouterr()
    return out + err


def test_it_is_listed(pack: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert printed(capsys, "words", "juggle").startswith("No phrase has the words: juggle")
    assert printed(capsys, "words", "juggle", "--keywords", pack) == (
        "circus:\n"
        "  juggle {count} ball(s) [for {person}]\n"
        "      Keeps balls in the air.\n"
        "      {count}: a whole number from 1 on\n"
        "      {person}: Alice, Bob, Carol; optional\n"
        "      needs: left arm, right arm\n"
        "      node: Juggle\n"
        "      for example: juggle 3 balls for Alice\n"
    )
    assert "circus:\n  juggle {count} ball(s)" in printed(capsys, "words", "--all", "--keywords", pack)


def offers(draft: MissionDraft, text: str) -> list[str]:
    """The completions of a text, each with what the REPL says about it."""
    return [f"{offer.text.strip()}: {offer.help}" for offer in continuations(draft, text)]


def test_it_is_completed(pack: str) -> None:
    before, after = MissionDraft(), MissionDraft([pack])
    for text in ("wave then ju", "if bumped, ju"):
        assert offers(before, text) == []
        assert offers(after, text) == ["juggle: Keeps balls in the air."]
    assert [offer.text for offer in continuations(after, "juggle 3 balls for A")] == ["Alice", "at most "]


def test_it_is_suggested(pack: str, capsys: pytest.CaptureFixture[str]) -> None:
    mistake = ("check", "-c", "wave then jugle 3 balls")
    assert "juggle" not in printed(capsys, *mistake)
    suggested = printed(capsys, *mistake, "--keywords", pack)
    assert "Similar: juggle" in suggested
    assert "Did you mean: wave then juggle 3 balls\n" in suggested
    missing = printed(capsys, "check", "-c", "juggle 3 balls for Alise", "--keywords", pack)
    assert "Did you mean: juggle 3 balls for Alice\n" in missing


def test_it_is_read_and_said(pack: str, capsys: pytest.CaptureFixture[str]) -> None:
    said = printed(capsys, "explain", "--keywords", pack, "-c", "juggle two balls; juggle three balls for Alice twice")
    assert "  read as: juggle 2 balls\n" in said
    assert "  read as: juggle 3 balls for Alice 2 times\n" in said
    clash = printed(capsys, "check", "--keywords", pack, "-c", "juggle 3 balls and wave at the same time")
    assert "both need the right arm at the same time" in clash
