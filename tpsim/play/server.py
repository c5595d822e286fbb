"""The web server of the playground: one port, to this machine alone or with a token to others."""

import contextlib
import secrets
import socket
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING
from unittest import mock
from urllib.parse import parse_qs, urlsplit

from tpsim.errors import ArgumentError
from tpsim.extras import extra
from tpsim.film.offline import quiet_server

if TYPE_CHECKING:
    import viser

HERE = "127.0.0.1"
"""Host to which nobody else has access."""


@dataclass(frozen=True)
class Address:
    """Where the playground is.

    Parameters
    ----------
    host : str
        127.0.0.1 unless others shall see it.
    port : int
        0 for any that is free.
    token : str
        What an address from elsewhere must have; empty on this machine alone.
    """

    host: str = HERE
    port: int = 8080
    token: str = ""

    @classmethod
    def of(cls, host: str, port: int) -> "Address":
        """With a new token where others can reach it."""
        return cls(host, port, "" if _is_here(host) else secrets.token_urlsafe(12))

    def url(self, port: int) -> str:
        """What a person opens."""
        host = socket.gethostname() if self.host in ("0.0.0.0", "::") else self.host
        place = f"{host}:{port}"
        if not self.token:
            return f"http://{place}"
        return f"http://{place}/?websocket=ws://{place}/?token={self.token}"


def open_server(address: Address, label: str) -> "viser.ViserServer":
    """Start the server of the page.

    Raises
    ------
    ArgumentError
        If the port is in use or the host is none of this machine.
    RecordingError
        If viser is not installed.
    """
    with extra("the pages of the playground", "play"):
        import mjviser  # noqa: F401
    _check_free(address)
    with _guarded(address):
        server = quiet_server(address.host, address.port, label)
    if address.port not in (0, server.get_port()):
        server.stop()
        raise _in_use(address)
    return server


def warn(address: Address) -> None:
    """Say on standard error that others may see and move the robot."""
    if address.token:
        print(
            f"tpsim: --host {address.host}: everybody who is given the address with its token "
            "can see and push this simulation; it is not encrypted",
            file=sys.stderr,
        )


def _check_free(address: Address) -> None:
    """Viser would take the next port that is free, and people would look at another's page."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((address.host, address.port))
        except OSError as error:
            if error.strerror and "use" in error.strerror:
                raise _in_use(address) from None
            raise ArgumentError(
                f"--host {address.host} --port {address.port}: {error.strerror or error}"
            ) from None


def _in_use(address: Address) -> ArgumentError:
    return ArgumentError(
        f"port {address.port} is in use, perhaps by another playground; close it, or give --port "
        f"{address.port + 1} or --port 0"
    )


@contextlib.contextmanager
def _guarded(address: Address) -> Iterator[None]:
    """Let in who has the token, and no page of another site.

    Viser has no place for it: what it hands to websockets is wrapped while the server starts.
    """
    import websockets.asyncio.server as sockets

    serve = sockets.serve

    def guarded(handler, host, port, *, process_request, **options):  # type: ignore[no-untyped-def]
        def process(connection, request):  # type: ignore[no-untyped-def]
            if request.headers.get("Upgrade") == "websocket" and not allowed(
                address, request.path, request.headers.get("Origin"), request.headers.get("Host")
            ):
                return connection.respond(HTTPStatus.FORBIDDEN, "the token is missing or wrong\n")
            return process_request(connection, request)

        return serve(handler, host, port, process_request=process, **options)

    # The thread of the server looks it up before ViserServer() returns.
    with mock.patch.object(sockets, "serve", guarded):
        yield


def allowed(address: Address, path: str, origin: str | None, host: str | None) -> bool:
    """Whether who asks for a connection may have it.

    Parameters
    ----------
    address : Address
    path : str
        That is asked for, with the token.
    origin, host : str, optional
        Page that asks, and whom it asks, as browsers say: pages of other sites may not.
    """
    if origin is not None and urlsplit(origin).netloc != host:
        return False
    given = parse_qs(urlsplit(path).query).get("token", [""])[0]
    return not address.token or secrets.compare_digest(given.encode(), address.token.encode())


def _is_here(host: str) -> bool:
    return host in (HERE, "localhost", "::1")
