"""The certificates of a keystore: two authorities, and an identity for each enclave.

Keys are on the curve P-256, which DDS-Security 1.1 names (9.3.1). `now` is an aware UTC time.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timedelta
from ipaddress import ip_address

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec, rsa
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from rtron.errors import InputError

_CA_LIFE = timedelta(days=3650)
SERVER_NAME = "zenoh_router"
"""The name of a server, which no enclave has: theirs begin with a slash."""
CLOCK_SKEW = timedelta(hours=1)
"""How far a robot's clock may be behind: what is made is valid that long before."""


@dataclass(frozen=True, slots=True)
class Authority:
    """A certificate authority that can sign."""

    certificate: x509.Certificate
    key: ec.EllipticCurvePrivateKey


def create_authority(name: str, now: datetime) -> Authority:
    """Return a new authority, which signs itself and nothing below another authority."""
    key = ec.generate_private_key(ec.SECP256R1())
    constraint = x509.BasicConstraints(ca=True, path_length=0)
    subject = _name(name)
    builder = _builder(subject, subject, key, now, now + _CA_LIFE)
    certificate = builder.add_extension(constraint, critical=True).sign(key, hashes.SHA256())
    return Authority(certificate, key)


def create_identity(
    enclave: str, authority: Authority, now: datetime, until: datetime
) -> tuple[x509.Certificate, ec.EllipticCurvePrivateKey]:
    """Return the certificate of an enclave with its new key."""
    key = ec.generate_private_key(ec.SECP256R1())
    builder = _builder(_name(enclave), authority.certificate.subject, key, now, until)
    constraint = x509.BasicConstraints(ca=False, path_length=None)
    signed = builder.add_extension(constraint, critical=False).sign(authority.key, hashes.SHA256())
    return signed, key


def create_server(
    host: str, authority: Authority, now: datetime, until: datetime
) -> tuple[x509.Certificate, ec.EllipticCurvePrivateKey]:
    """Return the certificate of a TLS server with its new key; `host` is a name or an address.

    No enclave's certificate names a host, so that none can be used in the server's place.
    """
    key = ec.generate_private_key(ec.SECP256R1())
    extensions = (
        x509.BasicConstraints(ca=False, path_length=None),
        x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]),
        x509.SubjectAlternativeName([_general_name(host)]),
    )
    builder = _builder(_name(SERVER_NAME), authority.certificate.subject, key, now, until)
    for extension in extensions:
        builder = builder.add_extension(extension, critical=False)
    return builder.sign(authority.key, hashes.SHA256()), key


def is_for_host(certificate: x509.Certificate, host: str) -> bool:
    """Tell whether a certificate is for a host, and for no other."""
    try:
        extension = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName)
    except (x509.ExtensionNotFound, ValueError):
        return False
    return list(extension.value) == [_general_name(host)]


def create_revocation_list(
    serials: Iterable[int], authority: Authority, now: datetime
) -> x509.CertificateRevocationList:
    """Return the list of what an authority takes back, by the certificates' serial numbers."""
    builder = (
        x509.CertificateRevocationListBuilder()
        .issuer_name(authority.certificate.subject)
        .last_update(now - CLOCK_SKEW)
        .next_update(authority.certificate.not_valid_after_utc)
    )
    for serial in sorted(set(serials)):
        revoked = x509.RevokedCertificateBuilder().serial_number(serial).revocation_date(now)
        builder = builder.add_revoked_certificate(revoked.build())
    return builder.sign(authority.key, hashes.SHA256())


def is_issued_by(certificate: x509.Certificate, authority: x509.Certificate) -> bool:
    """Tell whether an authority has signed a certificate."""
    try:
        certificate.verify_directly_issued_by(authority)
    except (InvalidSignature, ValueError, TypeError):
        return False
    return True


def is_signed_by(revoked: x509.CertificateRevocationList, authority: x509.Certificate) -> bool:
    """Tell whether an authority has signed a list of revoked certificates."""
    key = authority.public_key()
    if not isinstance(key, (ec.EllipticCurvePublicKey, rsa.RSAPublicKey)):
        return False
    return revoked.is_signature_valid(key)


def common_name(certificate: x509.Certificate) -> str:
    """Return the name of a certificate's subject, empty if it has none."""
    names = certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME)
    return str(names[0].value) if len(names) == 1 else ""


def certificate_pem(certificate: x509.Certificate) -> bytes:
    """Return a certificate as text."""
    return certificate.public_bytes(serialization.Encoding.PEM)


def revocation_list_pem(revoked: x509.CertificateRevocationList) -> bytes:
    """Return a list of revoked certificates as text."""
    return revoked.public_bytes(serialization.Encoding.PEM)


def key_pem(key: ec.EllipticCurvePrivateKey) -> bytes:
    """Return a private key as text; without a password, which a robot could not type."""
    return key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )


def load_certificate(data: bytes, path: str) -> x509.Certificate:
    """Return a certificate; InputError if the text is none."""
    try:
        return x509.load_pem_x509_certificate(data)
    except ValueError as error:
        raise InputError(f"is no certificate: {error}", path=path) from None


def load_revocation_list(data: bytes, path: str) -> x509.CertificateRevocationList:
    """Return a list of revoked certificates; InputError if the text is none."""
    try:
        return x509.load_pem_x509_crl(data)
    except ValueError as error:
        raise InputError(f"is no revocation list: {error}", path=path) from None


def load_key(data: bytes, path: str) -> ec.EllipticCurvePrivateKey:
    """Return a private key; InputError if the text is none, or one of another kind."""
    try:
        key = serialization.load_pem_private_key(data, None)
    except (ValueError, TypeError) as error:
        raise InputError(f"is no private key: {error}", path=path) from None
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise InputError("is no key on an elliptic curve", path=path)
    return key


def _general_name(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _name(common: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, common)])


def _builder(
    subject: x509.Name,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    now: datetime,
    until: datetime,
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - CLOCK_SKEW)
        .not_valid_after(until)
        .public_key(key.public_key())
    )
