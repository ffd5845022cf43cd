"""Clients of the server that cost little, for benchmarks: many in one niced process, which answers lines.

    BTLANG_TOKEN=... python -m tests.benchmarks.server_clients --port 8443 --count 200 --rate 20

They know of WebSocket only what they need: they read frames, answer pings, and look for the time in statuses. "report"
prints what there was since the last one; after "silence" one of them reads no more.
"""

from __future__ import annotations

import argparse
import base64
import json
import os
import re
import selectors
import socket
import ssl
import sys
import time
from contextlib import suppress
from statistics import median

from tests.server.doors import trusting

_TEXT, _PING, _PONG = 1, 9, 10
_TIME = re.compile(rb'"type":"statuses".{0,100}?"t":([0-9.]+)')
_LARGEST = 262_144


class Client:
    """One that is logged in, and subscribed unless the rate is 0."""

    def __init__(self, port: int, token: str, rate: float, tls: ssl.SSLContext) -> None:
        plain = socket.create_connection(("127.0.0.1", port), 60.0)
        self.socket = tls.wrap_socket(plain)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(
            f"GET /api/ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            f"Authorization: Bearer {token}\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        head = b""
        while b"\r\n\r\n" not in head:
            head += self.socket.recv(65_536)
        assert head.startswith(b"HTTP/1.1 101 "), head
        self._waiting = bytearray(head.partition(b"\r\n\r\n")[2])
        if rate:
            self._send(_TEXT, json.dumps({"id": 1, "type": "subscribe", "rate": rate}).encode())
        self.socket.setblocking(False)

    def read(self, delays: list[float]) -> int:
        """Takes what there is; the number of messages with statuses. Raises ConnectionError where it is the last."""
        waiting, found = self._waiting, 0
        with suppress(ssl.SSLWantReadError):
            while True:
                data = self.socket.recv(_LARGEST)
                if not data:
                    raise ConnectionError
                waiting += data
                if not self.socket.pending():
                    break
        now = time.time()
        while (head := _head(waiting)) is not None and len(waiting) >= sum(head):
            start, length = head
            kind, body = waiting[0] & 15, bytes(waiting[start : start + length])
            del waiting[: start + length]
            if kind == _PING:
                self._send(_PONG, body)
            elif kind == _TEXT and (time_of := _TIME.search(body[:300])):
                delays.append(now - float(time_of[1]))
                found += 1
        return found

    def _send(self, kind: int, body: bytes) -> None:
        assert len(body) < 126
        self.socket.sendall(bytes([128 | kind, 128 | len(body), 0, 0, 0, 0]) + body)  # a mask of zeros changes nothing


def _head(data: bytearray) -> tuple[int, int] | None:
    """The length of a frame's head and of its body; None where the head isn't complete."""
    if len(data) < 2:
        return None
    length = data[1] & 127
    more = {126: 2, 127: 8}.get(length, 0)
    if len(data) < 2 + more:
        return None
    return 2 + more, int.from_bytes(data[2 : 2 + more], "big") if more else length


def figures(times: list[float]) -> str:
    """Percentiles of seconds."""
    if not times:
        return "(none)"
    ordered = sorted(times)
    p99 = ordered[min(len(ordered) - 1, int(len(ordered) * 0.99))]
    return f"p50 {median(times) * 1e3:.1f} ms, p99 {p99 * 1e3:.1f} ms, the slowest {ordered[-1] * 1e3:.1f} ms"


def main() -> None:
    """Until standard input ends."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--count", type=int, required=True)
    parser.add_argument("--rate", type=float, required=True)
    options = parser.parse_args()
    os.nice(10)
    tls, selector = trusting(), selectors.DefaultSelector()
    tokens = os.environ["BTLANG_TOKEN"].split()  # as each user may have so many sockets
    for number in range(options.count):
        client = Client(options.port, tokens[number % len(tokens)], options.rate, tls)
        selector.register(client.socket, selectors.EVENT_READ, client)
        client.read([])  # what came with the head is decrypted already
    selector.register(sys.stdin, selectors.EVENT_READ)
    print("up", flush=True)
    subscribed, delays, messages = options.count, list[float](), 0
    while True:
        for key, _ in selector.select():
            if isinstance(key.data, Client):
                try:
                    messages += key.data.read(delays)
                except OSError as error:
                    if subscribed == options.count:
                        print(f"a client was hung up on: {error!r}", file=sys.stderr)
                    selector.unregister(key.fileobj)
                    subscribed -= 1
                continue
            line = sys.stdin.readline().strip()
            if not line:
                return
            if line == "silence":
                silent = next(each for each in selector.get_map().values() if isinstance(each.data, Client))
                selector.unregister(silent.fileobj)
                subscribed -= 1
            print(json.dumps({"text": figures(delays), "messages": messages, "subscribed": subscribed}), flush=True)
            delays, messages = [], 0


if __name__ == "__main__":
    main()
