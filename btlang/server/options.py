"""The options of `btc serve`, `btc user`, `btc edit` and `btc watch`."""

from __future__ import annotations

import argparse

from btlang.arguments import ros_name
from btlang.option_parser import add_acts
from btlang.recording.options import add_browser_option, add_recording_file
from btlang.task.options import add_address_options

USER_ACTS = {
    "list": "lists the users",
    "add": "adds a user, and asks for a password: btc user add ana --role operator",
    "passwd": "changes a password: btc user passwd ana",
    "role": "changes the role of a user: btc user role ana editor",
    "remove": "removes a user: btc user remove ana",
    "token": "creates a token for a program: btc user token ana dashboard",
    "tokens": "lists the tokens of a user: btc user tokens ana",
    "revoke": "revokes a token: btc user revoke ana dashboard",
    "logout": "ends all sessions of a user: btc user logout ana",
    "trail": "lists the latest log-ins, and refused requests",
    "backup": "copies the accounts into a file: btc user backup users.json",
    "restore": "restores the accounts on a server without users: btc user restore users.json",
}
"""What `btc user` does."""


def add_serve_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc serve`."""
    add_address_options(parser)
    parser.add_argument(
        "--cert", metavar="FILE", help="certificate (PEM) to use instead of a generated one; needs --key"
    )
    parser.add_argument("--key", metavar="FILE", help="key of the certificate (PEM)")
    parser.add_argument("--no-tls", action="store_true", help="use plain HTTP, on this computer only")
    parser.add_argument("--until-eof", action="store_true", help="end when standard input ends")
    parser.add_argument(
        "--ros",
        action="append",
        default=[],
        type=ros_name,
        metavar="NAME",
        help="ROS 2 name that rosbridge clients may use, such as '/btlang/*'; may be repeated",
    )


def add_edit_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc edit` that are not those of all words and worlds."""
    parser.add_argument("--port", type=int, default=0, metavar="PORT", help="port to listen on (default: a free one)")
    add_browser_option(parser)
    parser.add_argument("--main", default="", metavar="ID", help="which tree to edit if the file holds several")
    parser.add_argument(
        "--editor", action="store_true", help="open the editor that the variable EDITOR names, not the browser"
    )
    parser.add_argument(
        "file", metavar="FILE", help="mission, which may be new, or a tree in XML or JSON; of JSON, a copy is saved"
    )


def add_watch_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc watch`."""
    add_browser_option(parser)
    add_recording_file(parser)


def add_user_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc user`."""
    parser.add_argument(
        "--role", default="viewer", metavar="ROLE", help="with add: viewer (default), operator, editor or administrator"
    )
    add_acts(parser, USER_ACTS)
    parser.add_argument(
        "name", nargs="?", default="", metavar="NAME", help="name of a user; for backup and restore: a file"
    )
    parser.add_argument("item", nargs="?", default="", metavar="WHAT", help="name of a token; for role: a role")
