"""What `btc robot` does on a server's computer about robots elsewhere: which of them may join."""

from __future__ import annotations

import json
import socket
import time

from btlang.server.command import door_path, notify_changes, server_folder
from btlang.task.applicable import check_robot_words
from btlang.task.checks import refused
from btlang.task.companion import require_server
from btlang.task.messages import wrong
from btlang.task.moments import shown
from btlang.task.paths import checked_name, names_up
from btlang.text.output import pass_on, show

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

    from btlang.server.fleet import Fleet


def serve(options: argparse.Namespace) -> int:
    """Does `invite`, `revoke` and `invited`; returns the exit code. Raises MissionError."""
    check_robot_words(options)
    require_server()
    from btlang.server.accounts import Accounts
    from btlang.server.fleet import Fleet

    accounts = Accounts(server_folder())
    try:
        _do(options, Fleet(accounts.database, notify_changes))
    finally:
        accounts.close()
    return 0


def _do(options: argparse.Namespace, fleet: Fleet) -> None:
    if options.act == "invited":
        _list(fleet, as_json=options.json)
        return
    if not options.item:
        raise wrong(options.act, "it needs a name for the robot")
    name = checked_name(options.item[0])
    if options.act == "revoke":
        fleet.revoke(name)
        show(f"'{name}' may no longer join.")
        return
    if name in names_up():
        raise wrong(options.act, f"a robot '{name}' is up on this computer; choose another name")
    pin, port = _door()
    code = fleet.invite(name, pin)
    show(f"Within an hour, on the computer of '{name}', with the address of this one:")
    show(f"btc robot up --join wss://{socket.gethostname()}:{port} --code {code}")


def _list(fleet: Fleet, *, as_json: bool) -> None:
    now, robots = time.time(), fleet.robots()
    if as_json:
        listed = [{"name": each.name, "joined": bool(each.key), "seen": each.seen} for each in robots]
        pass_on(json.dumps({"robots": listed}, indent=2) + "\n")
        return
    for each in robots:
        seen = "never seen" if each.seen is None else f"last seen at {shown(each.seen, now)}"
        show(f"{each.name}  {seen if each.key else f'invited at {shown(each.invited, now)}'}")


def _door() -> tuple[bytes, int]:
    """The pin and the port of the server. Raises MissionError (BT187)."""
    try:
        with open(door_path(), encoding="ascii") as file:
            kept = json.load(file)
            return bytes.fromhex(kept["pin"]), int(kept["port"])
    except (OSError, ValueError, KeyError, TypeError):
        reason = "has no certificate by which robots could know it; start btc serve first, without --no-tls"
        raise refused("The server", reason) from None
