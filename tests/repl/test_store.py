"""What the prompt keeps of what was typed."""

from __future__ import annotations

from pathlib import Path

from btlang.repl.store import DraftStore


def test_what_is_typed_is_readable_by_the_user_only(tmp_path: Path) -> None:
    (tmp_path / "state").mkdir(mode=0o755)
    (tmp_path / "state" / "history").write_text("+wave\n")
    store = DraftStore(tmp_path / "state")
    store.save(["say secret"], "")
    kept = [path for path in (tmp_path / "state").rglob("*") if path.is_file()]
    assert len(kept) >= 2
    assert not any(path.stat().st_mode & 0o077 for path in (*kept, tmp_path / "state"))
