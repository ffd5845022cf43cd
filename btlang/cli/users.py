"""Who may log in to a server: the verb `user`, and the invitations of robots by `btc robot`."""

from __future__ import annotations

import getpass
import json
import shlex
import socket
import sys
import time

from btlang.cli.server import listener_path, server_folder
from btlang.task.commands.checks import refusal_error
from btlang.task.commands.client import check_name, names_up
from btlang.task.commands.companion import require_server
from btlang.task.messages import wrong
from btlang.task.schedule.calendar import format_moment
from btlang.text.formatting import one_line
from btlang.text.output import pass_on, show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from btlang.server.accounts.accounts import Accounts, UserRole
    from btlang.server.fleet.fleet import Fleet


def run_act(options: argparse.Namespace) -> int:
    """Do what the act says; return the exit code. Raises MissionError."""
    require_server("user")
    from btlang.server.accounts.accounts import Accounts

    accounts = Accounts(server_folder())
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
            show(f"{format_moment(entry.time, now)}  {by}: {one_line(entry.what)}: {one_line(entry.outcome)}")
        return
    if act in ("backup", "restore"):
        _copy(options, accounts)
        return
    if not name:
        raise wrong(act, "it needs the name of a user")
    if act == "tokens":
        for token in accounts.tokens(name):
            used = "never used" if token.used is None else f"used at {format_moment(token.used, now)}"
            show(f"{one_line(token.name)}  {used}")
        return
    show(_change(options, accounts))


def _copy(options: argparse.Namespace, accounts: Accounts) -> None:
    """Back up the accounts, or restore them."""
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


def _change(options: argparse.Namespace, accounts: Accounts) -> str:
    """Do what changes something; return what to say."""
    from btlang.server.accounts.accounts import check_account_name
    from btlang.server.accounts.passwords import hash_password

    act, name, item = options.act, options.name, options.item
    if act == "add":
        check_account_name(name, act)
        if accounts.user(name) is not None:
            change = f"exists already. For another role: btc user role {shlex.quote(name)} {options.role}"
            raise refusal_error(f"The user '{one_line(name)}'", change)
        accounts.add(name, _role(options.role, act), hash_password(_ask_password(name)))
        return f"'{one_line(name)}' can log in, with the role {options.role}."
    if act == "passwd":
        accounts.set_password(name, hash_password(_ask_password(name)))
        return f"The password of '{one_line(name)}' is changed, and all their sessions are ended."
    if act == "role":
        accounts.set_role(name, _role(item or options.role, act))
        return f"'{one_line(name)}' now has the role {item or options.role}."
    if act == "remove":
        accounts.remove(name)
        return f"'{one_line(name)}' is removed, and all their sessions and tokens are ended."
    if act == "logout":
        accounts.log_out(name)
        return f"'{one_line(name)}' is logged out everywhere."
    if not item:
        raise wrong(act, "it needs the name of a token")
    if act == "revoke":
        accounts.revoke(name, item)
        return f"The token '{one_line(item)}' is no longer valid."
    return accounts.add_token(name, item)


def _role(role: str, act: str) -> UserRole:
    from btlang.server.accounts.accounts import UserRole
    from btlang.task.commands.checks import choose_member

    return choose_member(UserRole, role, "role", act)


def _ask_password(name: str) -> str:
    """Ask for a password: twice at a terminal, else a line of standard input."""
    from btlang.server.accounts.passwords import problem

    if sys.stdin is not None and sys.stdin.isatty():
        password = getpass.getpass("Password: ")
        if getpass.getpass("Again: ") != password:
            raise refusal_error("The password", "wasn't the same the second time")
    else:
        password = sys.stdin.readline().rstrip("\n") if sys.stdin is not None else ""
    reason = problem(password, name)
    if reason:
        raise refusal_error("This password", f"can't be taken: {reason}")
    return password


def change_invitations(options: argparse.Namespace) -> int:
    """Invite a robot elsewhere, revoke an invitation or list them; return the exit code. Raises MissionError."""
    require_server()
    from btlang.server.accounts.accounts import Accounts
    from btlang.server.fleet.fleet import Fleet

    accounts = Accounts(server_folder())
    try:
        _invite(options, Fleet(accounts.database))
    finally:
        accounts.close()
    return 0


def _invite(options: argparse.Namespace, fleet: Fleet) -> None:
    if options.act == "invited":
        _list_invited(fleet, as_json=options.json)
        return
    if not options.item:
        raise wrong(options.act, "it needs a name for the robot")
    name = check_name(options.item[0])
    if options.act == "revoke":
        fleet.revoke(name)
        show(f"'{name}' may no longer join.")
        return
    if name in names_up():
        raise wrong(options.act, f"a robot '{name}' is up on this computer; choose another name")
    pin, port = _read_listener()
    code = fleet.invite(name, pin)
    show(f"Within an hour, on the computer of '{name}', with the address of this one:")
    show(f"btc robot up --join wss://{socket.gethostname()}:{port} --code {code}")


def _list_invited(fleet: Fleet, *, as_json: bool) -> None:
    now, robots = time.time(), fleet.robots()
    if as_json:
        listed = [{"name": each.name, "joined": bool(each.key), "seen": each.seen} for each in robots]
        pass_on(json.dumps({"robots": listed}, indent=2) + "\n")
        return
    for each in robots:
        seen = "never seen" if each.seen is None else f"last seen at {format_moment(each.seen, now)}"
        show(f"{each.name}  {seen if each.key else f'invited at {format_moment(each.invited, now)}'}")


def _read_listener() -> tuple[bytes, int]:
    """Read the pin and the port of the server. Raises MissionError (BT187)."""
    try:
        with open(listener_path(), encoding="ascii") as file:
            kept = json.load(file)
            return bytes.fromhex(kept["pin"]), int(kept["port"])
    except (OSError, ValueError, KeyError, TypeError):
        reason = "has no certificate by which robots could know it; start btc serve first, without --no-tls"
        raise refusal_error("The server", reason) from None
