"""The connections of a server: who has how many, how long each may be silent, and which goes where there are too many.

Nobody is refused because others came before: a newcomer takes the place of the stranger who has been here the longest,
of the address that has the most. A stranger is who hasn't logged in on a connection.
"""

from __future__ import annotations

import asyncio
import socket
import ssl
from collections import OrderedDict
from collections.abc import Callable, Sequence
from contextlib import suppress
from ipaddress import IPv6Address, ip_address, ip_network

TYPE_CHECKING = False
if TYPE_CHECKING:
    from ipaddress import IPv4Network, IPv6Network

    Network = IPv4Network | IPv6Network

HEAD = 10.0
"""The seconds for a handshake and the head of a request, and between two requests."""
_UNREAD = 20.0  # seconds for which a client may leave unread what was sent to it
_SITE = 64  # bits of an IPv6 address: whoever has one has all that begin like it
_RECENT = 1000  # addresses that are known because somebody logged in there
_KNOWN = 4  # times as many connections of such an address: all pages come back at once after a restart
_AT_ONCE = 100  # connections that are taken before others get their turn
_REST = 0.1  # seconds of rest where no descriptor is left


class Connection:
    """A connection of one client, from its first byte to its end, for one event loop."""

    def __init__(self, connections: Connections, given: socket.socket, address: str) -> None:
        self._connections, self._socket, self.address = connections, given, address
        self.user = ""
        """The user who has logged in on it, "" for a stranger; for a proxy, the proxy."""
        self.is_proxy = False
        self.transport: asyncio.Transport | None = None
        self._beginning: asyncio.Task[object] | None = None
        self._loop = asyncio.get_running_loop()
        self._deadline: asyncio.TimerHandle | None = None

    def begin(self, protocol: Callable[[], asyncio.Protocol], tls: ssl.SSLContext | None) -> None:
        """Wait for its first byte: a handshake that nobody begins would take 280 kB of memory."""
        self.expect(HEAD)
        self._loop.add_reader(self._socket, self._shake_hands, protocol, tls)

    def _shake_hands(self, protocol: Callable[[], asyncio.Protocol], tls: ssl.SSLContext | None) -> None:
        self._loop.remove_reader(self._socket)
        self._beginning = self._loop.create_task(self._connect(protocol, tls))

    async def _connect(self, protocol: Callable[[], asyncio.Protocol], tls: ssl.SSLContext | None) -> None:
        limit = None if tls is None else HEAD
        try:
            await self._loop.connect_accepted_socket(protocol, self._socket, ssl=tls, ssl_handshake_timeout=limit)
        except (OSError, ssl.SSLError, asyncio.CancelledError):  # it isn't TLS, takes too long or has to go
            self.end()

    def expect(self, seconds: float) -> None:
        """End it unless `met` is called in time."""
        self.met()
        self._deadline = self._loop.call_later(seconds, self.end)

    def met(self) -> None:
        """Wait no longer for what was expected."""
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None

    def admit(self, user: str) -> bool:
        """Note who has logged in on it; return whether that user may have one more."""
        return self._connections.admit(self, user)

    def end(self) -> None:
        """End it at once; what was sent and not read is lost. May be called twice."""
        self.gone()
        if self.transport is not None:
            self.transport.abort()
        elif self._beginning is not None:
            self._beginning.cancel()
        else:
            self._loop.remove_reader(self._socket)
            self._socket.close()

    def gone(self) -> None:
        """Forget it: it has ended."""
        self.met()
        self._connections.discard(self)
        self._connections.ended += 1


class Connections:
    """The connections of a server, for one event loop.

    At most `most` are open: `strangers` of them before somebody has logged in there, each address with at most
    `of_address`, and each user with `of_user`. Where strangers have no place left, the addresses from which somebody
    has logged in have as many again. Connections from `proxies` aren't limited by address.
    """

    def __init__(
        self,
        most: int = 4000,
        strangers: int = 256,
        of_address: int = 64,
        of_user: int = 128,
        proxies: Sequence[Network] = (),
    ) -> None:
        self.most, self.strangers, self.of_address, self.of_user = most, strangers, of_address, of_user
        self._proxies = proxies
        self._strangers: dict[str, OrderedDict[Connection, None]] = {}  # by address, the oldest first
        self._users: dict[str, set[Connection]] = {}
        self._recent: OrderedDict[str, None] = OrderedDict()
        self.ended = 0
        """The number of those that have ended, which who gives memory back sets to 0."""

    def __len__(self) -> int:
        return sum(map(len, self._strangers.values())) + sum(map(len, self._users.values()))

    def add(self, given: socket.socket, host: str) -> Connection | None:
        """Add a connection that was taken; None if there is no place for it, since all are of users."""
        address = group_of(host)
        connection = Connection(self, given, address)
        connection.is_proxy = any(_contains(network, host) for network in self._proxies)
        own = self._strangers.get(address, ())
        count = sum(map(len, self._strangers.values()))
        is_known = address in self._recent
        if len(own) >= self.of_address * (_KNOWN if is_known else 1):
            next(iter(own)).end()
        elif count >= self.strangers * (2 if is_known else 1) or len(self) >= self.most:
            if not self.drop_stranger() and not connection.is_proxy:
                return None
        if connection.is_proxy:
            connection.user = f"proxy {address}"
            self._users.setdefault(connection.user, set()).add(connection)
        else:
            self._strangers.setdefault(address, OrderedDict())[connection] = None
        return connection

    def admit(self, connection: Connection, user: str) -> bool:
        """Make a stranger's connection one of a user; return whether that user may have it."""
        if connection.is_proxy or connection.user == user:  # a proxy's connection is that of many
            return True
        if len(self._users.get(user, ())) >= self.of_user:
            return False
        self.discard(connection)
        connection.user = user
        self._users.setdefault(user, set()).add(connection)
        self.remember(connection.address)
        return True

    def remember(self, host: str) -> None:
        """Keep places for an address at which somebody has logged in."""
        address = group_of(host)
        self._recent[address] = None
        self._recent.move_to_end(address)
        if len(self._recent) > _RECENT:
            self._recent.popitem(last=False)

    def discard(self, connection: Connection) -> None:
        """Forget a connection."""
        own = self._users.get(connection.user) if connection.user else None
        if own is not None:
            own.discard(connection)
            if not own:
                del self._users[connection.user]
            return
        found = self._strangers.get(connection.address)
        if found is not None:
            found.pop(connection, None)
            if not found:
                del self._strangers[connection.address]

    def drop_stranger(self) -> bool:
        """End the connection of the stranger who has been here the longest, of the address that has the most.

        Returns whether there was one. Addresses from which somebody has logged in come last.
        """
        groups = self._strangers
        address = max(groups, key=lambda each: (each not in self._recent, len(groups[each])), default=None)
        if address is None:
            return False
        next(iter(groups[address])).end()
        return True

    def end_strangers(self) -> None:
        """End all connections on which nobody has logged in, as the server ends."""
        while self.drop_stranger():
            pass


class Acceptor:
    """What takes connections from a listening socket, and makes each a `protocol`.

    It has the two methods that uvicorn calls of asyncio.Server, which takes all who come until no descriptor is left.
    """

    def __init__(
        self,
        listener: socket.socket,
        connections: Connections,
        protocol: Callable[[Connection], asyncio.Protocol],
        tls: ssl.SSLContext | None,
    ) -> None:
        self._listener, self._connections, self._protocol, self._tls = listener, connections, protocol, tls
        self._loop = asyncio.get_running_loop()
        listener.setblocking(False)
        self._loop.add_reader(listener, self._accept)

    def close(self) -> None:
        """Take no more; those who have said nothing yet are hung up on."""
        self._loop.remove_reader(self._listener)
        self._connections.end_strangers()
        self._listener.close()

    async def wait_closed(self) -> None:
        """Return at once: it has closed what it took."""

    def _accept(self) -> None:
        for _ in range(_AT_ONCE):
            try:
                given, address = self._listener.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError:  # no descriptor or no memory is left
                if not self._connections.drop_stranger():
                    self._loop.remove_reader(self._listener)
                    self._loop.call_later(_REST, self._go_on)
                return
            given.setblocking(False)
            with suppress(OSError, AttributeError):  # the client has gone, or this isn't Linux
                given.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, int(_UNREAD * 1000))
            connection = self._connections.add(given, str(address[0]))
            if connection is None:
                given.close()
            else:
                connection.begin(lambda connection=connection: self._protocol(connection), self._tls)  # type: ignore[misc]

    def _go_on(self) -> None:
        if self._listener.fileno() >= 0:
            self._loop.add_reader(self._listener, self._accept)


def group_of(host: str) -> str:
    """Return the address whose connections count together: that of an IPv6 site, of which one client has many."""
    try:
        known = ip_address(host.partition("%")[0])
    except ValueError:
        return host
    if isinstance(known, IPv6Address):
        if known.ipv4_mapped is not None:
            return str(known.ipv4_mapped)
        return str(ip_network((int(known), _SITE), strict=False)) if not known.is_loopback else host
    return host


def _contains(network: Network, host: str) -> bool:
    try:
        return ip_address(host.partition("%")[0]) in network
    except ValueError:
        return False
