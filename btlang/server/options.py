"""The options of `btc serve`, `btc user` and `btc edit`."""

from __future__ import annotations

import argparse

from btlang.arguments import ros_name
from btlang.option_parser import add_acts
from btlang.task.options import add_address_options

USER_ACTS = {
    "list": "lists the users",
    "add": "adds a user, and asks for the password: btc user add ana --role operator",
    "passwd": "changes a password",
    "role": "changes what somebody may do: btc user role ana editor",
    "remove": "removes a user",
    "token": "makes a token for a program: btc user token ana dashboard",
    "tokens": "lists the tokens of a user",
    "revoke": "ends a token: btc user revoke ana dashboard",
    "logout": "ends all sessions of a user",
    "trail": "lists the latest log-ins, and what was refused",
    "backup": "copies the accounts into a file",
    "restore": "fills an empty server from such a file",
}
"""What `btc user` does."""


def add_serve_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc serve`."""
    add_address_options(parser)
    parser.add_argument("--cert", metavar="FILE", help="a certificate (PEM) instead of its own; needs --key")
    parser.add_argument("--key", metavar="FILE", help="the key of the certificate")
    parser.add_argument("--no-tls", action="store_true", help="plain HTTP, on this computer alone")
    parser.add_argument("--until-eof", action="store_true", help="end when standard input does")
    parser.add_argument(
        "--ros",
        action="append",
        default=[],
        type=ros_name,
        metavar="NAME",
        help="a name of ROS 2 that clients of rosbridge may use, such as '/btlang/*'; may be given several times",
    )


def add_edit_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc edit` that are not those of all words and worlds."""
    parser.add_argument("--port", type=int, default=0, metavar="PORT", help="where it listens (default: a free one)")
    parser.add_argument(
        "--no-browser", action="store_false", dest="browser", help="print the address without opening the browser"
    )
    parser.add_argument("--main", default="", metavar="ID", help="which tree to edit if the file holds several")
    parser.add_argument("--editor", action="store_true", help="in the editor that EDITOR names, not in the browser")
    parser.add_argument(
        "file", metavar="FILE", help="mission, there or not; or a tree in XML, or in JSON, a copy of which is saved"
    )


def add_user_options(parser: argparse.ArgumentParser) -> None:
    """Those of `btc user`."""
    parser.add_argument("--role", default="viewer", metavar="ROLE", help="viewer, operator, editor or administrator")
    add_acts(parser, USER_ACTS)
    parser.add_argument(
        "name", nargs="?", default="", metavar="NAME", help="the name of a user; a file for backup and restore"
    )
    parser.add_argument("item", nargs="?", default="", metavar="WHAT", help="the name of a token, or a role")
