"""Projects of trees for tests, and what `btc check` says of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main

TREE = '<BehaviorTree ID="{}">{}</BehaviorTree>'


def write(folder: Path, name: str, *trees: str, models: str = "", attributes: str = "") -> None:
    """A file of format 4 in a folder that needn't be there."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    described = f"<TreeNodesModel>{models}</TreeNodesModel>" if models else ""
    path.write_text(f'<root BTCPP_format="4" {attributes}>{"".join(trees)}{described}</root>', "utf-8")


def problems(capsys: pytest.CaptureFixture[str], *arguments: str) -> list[dict[str, Any]]:
    main(["check", "--format", "json", *arguments])
    found: list[dict[str, Any]] = json.loads(capsys.readouterr().out)
    return found
