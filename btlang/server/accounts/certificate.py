"""The certificate of a server that nobody else vouches for."""

from __future__ import annotations

import hashlib
import ipaddress
import os
import socket
from contextlib import suppress
from datetime import UTC, datetime, timedelta

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from btlang.support.private_file import write_private
from btlang.support.record import Record

_DAYS, _RENEWED = 365, 30  # days that one is valid, and before its end when it is renewed


class Certificate(Record):
    """A certificate: paths of PEM files, and the SHA-256 as people compare it."""

    certificate: str
    key: str
    fingerprint: str


def load_certificate(folder: str, host: str, now: datetime | None = None) -> Certificate:
    """Load the certificate of a folder, or make one: the one that is there, if it is for this host and not about to
    end. Raises OSError.

    The key stays the same when it is renewed, so that whoever pinned it needs nothing new.
    """
    now = now or datetime.now(UTC)
    certificate, key = os.path.join(folder, "certificate.pem"), os.path.join(folder, "key.pem")
    kept = _read(certificate)
    private = _key(key)
    if kept is None or kept.public_key() != private.public_key() or _is_old(kept, now) or not _is_for(kept, host):
        kept = _made(private, host, now)
        write_private(certificate, kept.public_bytes(serialization.Encoding.PEM))
    return Certificate(certificate, key, fingerprint(kept))


def fingerprint_of(path: str) -> str:
    """Return the fingerprint of the first certificate in a PEM file. Raises OSError or ValueError."""
    with open(path, "rb") as file:
        return fingerprint(x509.load_pem_x509_certificate(file.read()))


def fingerprint(certificate: x509.Certificate) -> str:
    """Return the SHA-256 of a certificate, as pairs of digits."""
    return certificate.fingerprint(hashes.SHA256()).hex(":").upper()


def pin(certificate: bytes) -> bytes:
    """Return what robots know a server by: the SHA-256 of the public key in its certificate (DER), which outlives
    that.
    """
    return _pin(x509.load_der_x509_certificate(certificate))


def pin_of(path: str) -> bytes:
    """Return the pin of the first certificate in a PEM file. Raises OSError or ValueError."""
    with open(path, "rb") as file:
        return _pin(x509.load_pem_x509_certificate(file.read()))


def _pin(certificate: x509.Certificate) -> bytes:
    key = certificate.public_key()
    form = serialization.PublicFormat.SubjectPublicKeyInfo
    return hashlib.sha256(key.public_bytes(serialization.Encoding.DER, form)).digest()


def _read(path: str) -> x509.Certificate | None:
    with suppress(FileNotFoundError, ValueError), open(path, "rb") as file:
        return x509.load_pem_x509_certificate(file.read())
    return None


def _key(path: str) -> ec.EllipticCurvePrivateKey:
    with suppress(FileNotFoundError, ValueError), open(path, "rb") as file:
        kept = serialization.load_pem_private_key(file.read(), None)
        if isinstance(kept, ec.EllipticCurvePrivateKey):
            return kept
    made = ec.generate_private_key(ec.SECP256R1())
    encoding, form = serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8
    write_private(path, made.private_bytes(encoding, form, serialization.NoEncryption()))
    return made


def _is_old(certificate: x509.Certificate, now: datetime) -> bool:
    return not certificate.not_valid_before_utc <= now < certificate.not_valid_after_utc - timedelta(days=_RENEWED)


def _is_for(certificate: x509.Certificate, host: str) -> bool:
    names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    return _names(host)[-1] in names


def _names(host: str) -> list[x509.GeneralName]:
    """Return the names of this computer, and the one under which the server listens as the last one."""
    names: list[x509.GeneralName] = [x509.DNSName("localhost"), x509.IPAddress(ipaddress.ip_address("127.0.0.1"))]
    names += [x509.IPAddress(ipaddress.ip_address("::1"))]
    with suppress(ValueError):
        names.append(x509.DNSName(socket.gethostname()))
    try:
        address = ipaddress.ip_address(host)
        names += [] if address.is_unspecified else [x509.IPAddress(address)]
    except ValueError:
        names.append(x509.DNSName(host))
    return names


def _made(key: ec.EllipticCurvePrivateKey, host: str, now: datetime) -> x509.Certificate:
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "btlang")])
    builder = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))  # clocks of robots are often behind
        .not_valid_after(now + timedelta(days=_DAYS))
        .add_extension(x509.SubjectAlternativeName(_names(host)), critical=False)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
    )
    return builder.sign(key, hashes.SHA256())
