"""What `btc user` does: who may come in through `btc serve`."""

from __future__ import annotations

import getpass
import sys
import time

from btlang.server.command import notify_changes, server_folder
from btlang.task.companion import require_server
from btlang.task.messages import wrong
from btlang.task.moments import shown
from btlang.text.escaping import one_line
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from btlang.server.accounts import Accounts
    from btlang.server.roles import Role


def serve(options: argparse.Namespace) -> int:
    """Does the verb `user`; returns the exit code. Raises MissionError."""
    require_server("user")
    from btlang.server.accounts import Accounts

    accounts = Accounts(server_folder(), notify_changes)
    try:
        _do(options, accounts)
    finally:
        accounts.close()
    return 0


def _do(options: argparse.Namespace, accounts: Accounts) -> None:
    act, name = options.act, options.name
    now = time.time()
    if act == "list":
        for user in accounts.users():
            show(f"{one_line(user.name)}  {user.role}")
        return
    if act == "trail":
        for entry in accounts.entries():
            by = f"{one_line(entry.user)} from {one_line(entry.address)}"
            show(f"{shown(entry.time, now)}  {by}: {one_line(entry.what)}: {one_line(entry.outcome)}")
        return
    if act in ("backup", "restore"):
        _copy(options, accounts)
        return
    if not name:
        raise wrong(act, "it needs the name of a user")
    if act == "tokens":
        for token in accounts.tokens(name):
            used = "never used" if token.used is None else f"used at {shown(token.used, now)}"
            show(f"{one_line(token.name)}  {used}")
        return
    show(_changed(options, accounts))


def _copy(options: argparse.Namespace, accounts: Accounts) -> None:
    """A backup of the accounts, or one brought back."""
    act, path = options.act, options.name
    if not path:
        raise wrong(act, "it needs a file")
    if options.item:
        raise wrong(act, f"'{one_line(options.item)}' is more than it takes")
    if act == "restore":
        accounts.restore(path)
        show(f"Restored {one_line(path)}.")
    else:
        accounts.backup(path)
        show(f"Wrote {one_line(path)}.")


def _changed(options: argparse.Namespace, accounts: Accounts) -> str:
    """Does what changes something; returns what to say."""
    from btlang.server.passwords import hashed

    act, name, item = options.act, options.name, options.item
    if act == "add":
        _check_name(name)
        accounts.add(name, _role(options.role, act), hashed(_asked_password(name)))
        return f"'{one_line(name)}' may come in as {options.role}."
    if act == "passwd":
        accounts.set_password(name, hashed(_asked_password(name)))
        return f"'{one_line(name)}' has another password, and is logged out everywhere."
    if act == "role":
        accounts.set_role(name, _role(item or options.role, act))
        return f"'{one_line(name)}' is {item or options.role}."
    if act == "remove":
        accounts.remove(name)
        return f"'{one_line(name)}' may no longer come in."
    if act == "logout":
        accounts.log_out(name)
        return f"'{one_line(name)}' is logged out everywhere."
    if not item:
        raise wrong(act, "it needs the name of a token")
    if act == "revoke":
        accounts.revoke(name, item)
        return f"The token '{one_line(item)}' is no longer valid."
    return accounts.add_token(name, item)


def _check_name(name: str) -> None:
    if not name.strip() or len(name) > 64 or not name.isprintable():
        raise wrong("add", "a name must have up to 64 characters that can be shown")


def _role(role: str, act: str) -> Role:
    from btlang.server.roles import Role
    from btlang.task.checks import choice

    return choice(Role, role, "role", act)


def _asked_password(name: str) -> str:
    """Typed twice at a terminal, or a line of standard input."""
    from btlang.server.passwords import problem

    if sys.stdin is not None and sys.stdin.isatty():
        password = getpass.getpass("Password: ")
        if getpass.getpass("Again: ") != password:
            raise wrong("password", "the two aren't the same")
    else:
        password = sys.stdin.readline().rstrip("\n") if sys.stdin is not None else ""
    reason = problem(password, name)
    if reason:
        raise wrong("password", reason)
    return password
