"""The verb `serve`: a server for the robots that are up on this computer."""

from __future__ import annotations

import json
import os
import signal
import ssl
import sys
import threading
import time
from contextlib import suppress
from ipaddress import ip_address, ip_network

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import os_error_reason
from btlang.support.user_dirs import user_dir
from btlang.task.commands.companion import Companion, require_server
from btlang.text.output import show
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse
    import socket

    from btlang.server.accounts.accounts import Accounts
    from btlang.server.accounts.certificate import Certificate

_ADMINISTRATOR = "admin"
_TAKEN = 1.5  # seconds for which the port of the emergency stop may still be that of a server before
_FIRST_TO_GO = "300"  # where memory is short, the server goes before a robot, and before what stops that
_NICE = 5  # robots on this computer come first


def server_folder() -> str:
    """Return the folder of the users, the certificate and the server's secret."""
    return os.path.join(user_dir("data"), "server")


def serve(options: argparse.Namespace) -> int:
    """Serve until SIGINT or SIGTERM; return the exit code. Raises MissionError."""
    require_server()
    from btlang.ros.available import require_package
    from btlang.server.accounts.accounts import Accounts
    from btlang.server.http.app import Api
    from btlang.server.http.connections import Connections
    from btlang.server.http.listener import load_key, most_connections, open_listener, web_server
    from btlang.server.http.listener import serve as serve_listener

    if (options.cert is None) != (options.key is None):
        options.refuse("--cert and --key go together")
    if options.no_tls and options.cert is not None:
        options.refuse("--no-tls needs no certificate")
    if options.ros:
        require_package("rclpy")
    if options.no_tls and not _is_loopback(options.host):
        raise _refuse(options, "without TLS it listens on this computer alone")
    accounts = Accounts(server_folder())
    if not accounts.users() and not _is_loopback(options.host):
        reason = f"there are no users yet; make one first: btc user add {_ADMINISTRATOR} --role administrator"
        raise _refuse(options, reason)
    certificate = None if options.no_tls else _certificate(options)
    listener = open_listener(options.host, options.port)
    password = _first_password(accounts)
    port = listener.getsockname()[1]
    _write_listener(certificate, port)
    scheme = "http" if certificate is None else "https"
    key = load_key(server_folder())
    api = Api(accounts, key, ros=options.ros)
    stop_listener = _open_stop_listener(options, port)
    api.stop_port = stop_listener.getsockname()[1]
    settings = {
        "folder": server_folder(), "key": key, "cookie": api.access.cookie,
        "certificate": None if certificate is None else list(certificate.as_dict().values()),
        "descriptor": stop_listener.fileno(), "proxies": options.proxy, "notice": listener_path(),
    }  # fmt: skip
    connections = Connections(most_connections(), proxies=[ip_network(each) for each in options.proxy])
    for _, address in accounts.addresses():
        connections.remember(address)

    def ready() -> None:
        if stop.start():
            api.stop_port = 0
            show("The process of the emergency stop can't start: robots are stopped by the server alone.", sys.stderr)
        show(f"The server is up: {scheme}://{_format_host(options.host)}:{port}")
        if certificate is not None:
            show(f"Fingerprint (SHA-256): {certificate.fingerprint}")
        if password:
            show(f"Log in as '{_ADMINISTRATOR}' with the password {password}")
            show(f"It is shown this once. For another one: btc user passwd {_ADMINISTRATOR}")

    # uvicorn ends with the signal that ended it, which would leave the process of the emergency stop alone
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(128 + number))
    stop = Companion(
        "emergency stop", ["btlang.server.stop.stop_server"], json.dumps(settings), _report_stop_server,
        [stop_listener.fileno()],
    )  # fmt: skip
    try:
        os.nice(_NICE)
        with suppress(OSError), open("/proc/self/oom_score_adj", "w", encoding="ascii") as file:
            file.write(_FIRST_TO_GO)
        if options.until_eof:
            threading.Thread(target=_end_at_eof, daemon=True).start()
        serve_listener(web_server(api.app(), certificate, connections, options.proxy), listener, ready)
    except (OSError, ssl.SSLError) as error:
        raise _refuse(options, os_error_reason(error)) from None
    finally:
        stop.close()
        stop_listener.close()
        accounts.close()
        show("The server is down.")
    return 0


def _report_stop_server(line: str) -> None:
    from btlang.server.stop.stop_server import UP

    if line != UP:
        show(line, sys.stderr)


def _open_stop_listener(options: argparse.Namespace, port: int) -> socket.socket:
    """Open the socket of the emergency stop, by default the next port, or any where that is taken.

    The process of a server that was killed gives it free once it sees that there is another one.
    """
    from btlang.server.http.listener import open_listener

    until = time.monotonic() + _TAKEN
    while True:
        try:
            return open_listener(options.host, options.stop_port or min(port + 1, 65535))
        except MissionError:
            if time.monotonic() > until:
                if options.stop_port:
                    raise
                return open_listener(options.host, 0)
        time.sleep(0.1)


def _end_at_eof() -> None:
    sys.stdin.read()
    os.kill(os.getpid(), signal.SIGTERM)


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _certificate(options: argparse.Namespace) -> Certificate:
    from btlang.server.accounts.certificate import Certificate, fingerprint_of, load_certificate
    from btlang.server.http.listener import tls

    try:
        if options.cert is None:
            return load_certificate(server_folder(), options.host)
        given = Certificate(options.cert, options.key, fingerprint_of(options.cert))
        tls(given)
        return given
    except (OSError, ssl.SSLError) as error:
        raise _refuse(options, f"its certificate can't be used: {os_error_reason(error)}") from None
    except ValueError:
        raise _refuse(options, "its certificate can't be read: it must be in PEM") from None


def listener_path() -> str:
    """Return the file in which a server writes its process, its port and, with TLS, its pin, for other processes."""
    return os.path.join(server_folder(), "door.json")


def _write_listener(certificate: Certificate | None, port: int) -> None:
    """Write what other processes need to know of this one."""
    from btlang.server.accounts.certificate import pin_of
    from btlang.support.private_file import write_private

    with suppress(FileNotFoundError):
        os.unlink(listener_path())
    known: dict[str, object] = {"port": port, "process": os.getpid()}
    if certificate is not None:
        known["pin"] = pin_of(certificate.certificate).hex()
    write_private(listener_path(), json.dumps(known).encode())


def _first_password(accounts: Accounts) -> str:
    """Add an administrator if there is no user, and return the password; return "" if there is one."""
    from btlang.server.accounts.accounts import UserRole
    from btlang.server.accounts.passwords import hash_password, random_password

    if accounts.users():
        return ""
    password = random_password()
    accounts.add(_ADMINISTRATOR, UserRole.ADMINISTRATOR, hash_password(password))
    return password


def _refuse(options: argparse.Namespace, reason: str) -> MissionError:
    place = f"{_format_host(options.host)}:{options.port}"
    return MissionError([diagnostic("BT201", NOWHERE, place=place, reason=reason)])


def _format_host(host: str) -> str:
    return f"[{host}]" if ":" in host else host
