"""Backups of the users: complete, of one moment, and never restored over users."""

from __future__ import annotations

import io
import os
import sqlite3
import stat
import threading
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts import accounts as module
from btlang.server.accounts.accounts import Accounts, UserRole, hash_secret
from btlang.task.store.backup import restore_backup
from btlang.task.store.task_store import open_store
from tests.server.doors import Door
from tests.task.places import execute_at

NEXT = ("ALTER TABLE token ADD COLUMN colour TEXT NOT NULL DEFAULT 'red'",)


@pytest.fixture
def accounts(tmp_path: Path) -> Iterator[Accounts]:
    with closing(Accounts(str(tmp_path / "server"))) as accounts:
        accounts.add("ann", UserRole.ADMINISTRATOR, "hash")
        yield accounts


def refusal(accounts: Accounts, path: Path) -> str:
    """Why a backup isn't restored."""
    with pytest.raises(MissionError) as refused:
        accounts.restore(str(path))
    return refused.value.diagnostics[0].message


def test_a_backup_has_all_but_the_sessions(accounts: Accounts, tmp_path: Path) -> None:
    accounts.add("bo", UserRole.VIEWER, "other hash")
    token, session = accounts.add_token("bo", "screen"), accounts.log_in("ann", "::1")
    accounts.log("ann", "::1", "log in", "ok")
    path = tmp_path / "copy"
    accounts.backup(str(path))
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert session not in path.read_bytes().decode("latin-1")
    with closing(Accounts(str(tmp_path / "elsewhere"))) as restored:
        restored.restore(str(path))
        assert restored.users() == accounts.users()
        assert restored.tokens("bo") == accounts.tokens("bo")
        assert restored.entries() == accounts.entries()
        assert restored.identity(session) is None
        known = restored.identity(token)
        assert known is not None
        assert (known.user, known.role) == ("bo", UserRole.VIEWER)
        restored.log("bo", "::1", "status", "ok")
        assert [entry.user for entry in restored.entries()] == ["bo", "ann"]


def test_sessions_in_a_copied_file_are_not_restored(accounts: Accounts, tmp_path: Path) -> None:
    """One was copied by other means, before its user logged out."""
    session = accounts.log_in("ann", "::1")
    accounts.database.copy(str(tmp_path / "copy"))
    with closing(Accounts(str(tmp_path / "elsewhere"))) as restored:
        restored.restore(str(tmp_path / "copy"))
        assert restored.users() == accounts.users()
        assert restored.identity(session) is None


def test_nothing_is_overwritten(accounts: Accounts, tmp_path: Path) -> None:
    path = tmp_path / "copy"
    path.write_text("mine")
    with pytest.raises(MissionError, match="there's such a file already"):
        accounts.backup(str(path))
    assert path.read_text() == "mine"
    path.unlink()
    accounts.backup(str(path))
    accounts.set_password("ann", "another hash")
    assert "it isn't empty, so a backup can't be restored there" in refusal(accounts, path)
    assert [user.password for user in accounts.users()] == ["another hash"]


def test_a_backup_is_one_moment(accounts: Accounts, tmp_path: Path) -> None:
    ended = threading.Event()

    def work() -> None:
        number = 0
        while not ended.is_set():
            accounts.add(f"u{number}", UserRole.VIEWER, "hash")
            accounts.add_token(f"u{number}", "program")
            number += 1

    writer = threading.Thread(target=work)
    writer.start()
    try:
        for number in range(4):
            accounts.backup(str(tmp_path / f"copy{number}"))
    finally:
        ended.set()
        writer.join()
    sizes = []
    for number in range(4):
        with closing(Accounts(str(tmp_path / f"restored{number}"))) as restored:
            restored.restore(str(tmp_path / f"copy{number}"))
            users = [user.name for user in restored.users() if user.name != "ann"]
            with_token = [name for name in users if restored.tokens(name)]
            assert len(users) - len(with_token) in (0, 1)
            sizes.append(len(users))
    assert sizes == sorted(sizes)


def test_an_older_backup_is_migrated(accounts: Accounts, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, newer = tmp_path / "copy", tmp_path / "newer"
    accounts.add_token("ann", "program")
    accounts.backup(str(path))
    before = path.read_bytes()
    monkeypatch.setattr(module, "_STEPS", [*module._STEPS, NEXT])
    with closing(Accounts(str(tmp_path / "elsewhere"))) as restored:
        restored.restore(str(path))
        assert [token.name for token in restored.tokens("ann")] == ["program"]
        restored.backup(str(newer))
    assert path.read_bytes() == before
    monkeypatch.undo()
    with closing(Accounts(str(tmp_path / "again"))) as again:
        assert "belongs to a newer btlang" in refusal(again, newer)


def test_what_is_no_backup_of_users(accounts: Accounts, tmp_path: Path) -> None:
    text, tasks, users = tmp_path / "text", tmp_path / "tasks", tmp_path / "users"
    text.write_text("ann\n" * 200)
    accounts.backup(str(users))
    with open_store(str(tmp_path / "tasks.db")) as store:
        store.backup(str(tasks))
    with closing(Accounts(str(tmp_path / "elsewhere"))) as empty:
        assert "it isn't a store of btlang" in refusal(empty, text)
        assert "it has other tables than it should" in refusal(empty, tasks)
        assert "there's no such file" in refusal(empty, tmp_path / "nothing")
        execute_at(str(users), "UPDATE user SET role = 'king'")
        empty.restore(str(users))
        with pytest.raises(MissionError, match="it's damaged: a user can't be read"):
            empty.users()
    with pytest.raises(MissionError, match="it has other tables than it should"):
        restore_backup(str(users), str(tmp_path / "other.db"))


def test_on_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    path = str(tmp_path / "copy")
    for words, told in (
        (["backup"], "it needs a file"),
        (["backup", path, "more"], "'more' is more than it takes"),
        (["restore", path], "there's no such file"),
    ):
        assert main(["user", *words]) == 2
        assert told in capsys.readouterr().err
    assert not os.path.exists(path)


def test_a_server_goes_on_elsewhere(door: Door, tmp_path: Path) -> None:
    """Written while it is up; who was logged in logs in again, a token needs nothing."""
    token, session = door.user("token", "vic", "moved"), door.log_in("vic")
    path = str(tmp_path / "copy")
    assert door.user("backup", path) == f"Wrote {path}."
    folder = door.folder / "elsewhere"
    (folder / "btlang").mkdir(0o700, parents=True)
    moved = {**door.environment, "XDG_DATA_HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}
    here, door.environment = door.environment, moved
    try:
        assert door.user("restore", path) == f"Restored {path}."
    finally:
        door.environment = here
    with closing(Door(folder)) as other:
        assert other.ask("GET", "/api/me", authorization=f"Bearer {token}").data["user"] == "vic"
        assert other.ask("GET", "/api/me", **session).status == 401
        assert other.log_in("vic")
        assert not (folder / "btlang" / "server" / "copy").exists()
    with closing(sqlite3.connect(path)) as copied:
        assert copied.execute("SELECT count(*) FROM session").fetchone() == (0,)


def test_users_of_an_older_btlang_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    steps = module._STEPS
    monkeypatch.setattr(module, "_STEPS", steps[:1])
    with closing(Accounts(str(tmp_path))) as older:
        token, session = "btl_program", "page"
        with older.database.transaction() as execute:
            execute("INSERT INTO user VALUES ('ann', 'administrator', 'hash', 1.0)")
            execute("INSERT INTO token VALUES (?, 'program', 'ann', 1.0, NULL)", [hash_secret(token)])
            now = time.time()
            execute("INSERT INTO session VALUES (?, 'ann', '::1', ?, ?)", [hash_secret(session), now, now])
        monkeypatch.undo()
        with closing(Accounts(str(tmp_path))) as newer:  # beside one that is up
            assert newer.identity(token) is not None
            assert newer.identity(session) is not None
            newer.log("ann", "::1", "look", "ok")
        assert older.entries()[0].what == "look"


def test_what_changes_about_a_user_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.setattr("sys.stdin", io.StringIO("short\na long password\n"))
    assert main(["user", "add", "ann"]) == 2
    assert "This password can't be taken: a password must have 8 to 4096 characters." in capsys.readouterr().err
    for act in (["add", "ann"], ["role", "ann", "operator"], ["remove", "ann"]):
        assert main(["user", *act]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "'ann' can log in, with the role viewer.",
        "'ann' now has the role operator.",
        "'ann' is removed, and all their sessions and tokens are ended.",
    ]
