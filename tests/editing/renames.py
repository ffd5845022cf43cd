"""What a text becomes when a name in it is changed."""

from __future__ import annotations

import re

from btlang.diagnostics.diagnostic import MissionError, render
from btlang.editing.changes import Change, apply_changes
from btlang.editing.rename import rename
from btlang.editing.words import RobotWords
from btlang.text.source import Source


def renamed(text: str, at: int, name: str, words: RobotWords) -> str:
    """The text with the changes. Raises MissionError."""
    return apply_changes(text, [Change(**change) for change in rename(Source(text), at, words, name)["changes"]])


def refusal(text: str) -> str:
    """What is said of a text whose first line is `# old name -> new name`, "" for nothing."""
    asked = re.match(r"# (.+) -> (.+)\n", text)
    assert asked is not None
    try:
        renamed(text, text.index(asked[1], asked.end()), asked[2], RobotWords())
    except MissionError as error:
        return render(error.diagnostics[0], False)
    return ""
