"""Certificates of guards: issued by the operator's own authority, for one robot each."""

from collections.abc import Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path

from cryptography import x509
from cryptography.exceptions import InvalidSignature
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from rtron.errors import InputError
from rtron.vocabulary import SECOND

_CLIENT = {ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.ANY_EXTENDED_KEY_USAGE}


class GuardCertificates:
    """Checks whether a certificate is of a robot; InputError if the authority cannot be read."""

    def __init__(self, authority: Path) -> None:
        try:
            self._authorities = x509.load_pem_x509_certificates(authority.read_bytes())
        except (OSError, ValueError) as error:
            help = "give the certificates of your authority for guards, as PEM"
            raise InputError(f"no certificates: {error}", path=str(authority), help=help) from None

    def problem(self, shown: bytes | None, robot: str, now: int) -> str:
        """Return why a certificate (DER) is not that of a robot at `now` (ns); "" if it is."""
        if shown is None:
            return "the guard shows no certificate"
        try:
            certificate = x509.load_der_x509_certificate(shown)
            names = set(_names(certificate))
            is_for_clients = _is_for_clients(certificate)
        except ValueError:
            return "the guard's certificate cannot be read"
        if not _is_issued(certificate, self._authorities):
            return "the guard's certificate is not of this service's authority"
        moment = datetime.fromtimestamp(now / SECOND, timezone.utc)
        if not certificate.not_valid_before_utc <= moment < certificate.not_valid_after_utc:
            return "the guard's certificate is not valid now"
        if not is_for_clients:
            return "the guard's certificate is not for clients"
        return "" if robot in names else f"the guard's certificate is not that of {robot}"


def _is_issued(certificate: x509.Certificate, authorities: Sequence[x509.Certificate]) -> bool:
    """Tell whether an authority has signed a certificate itself; there is none in between."""
    for authority in authorities:
        try:
            certificate.verify_directly_issued_by(authority)
        except (InvalidSignature, ValueError, TypeError):
            continue
        return True
    return False


def _names(certificate: x509.Certificate) -> Iterator[str]:
    for attribute in certificate.subject.get_attributes_for_oid(NameOID.COMMON_NAME):
        yield str(attribute.value)
    try:
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName)
    except x509.ExtensionNotFound:
        return
    yield from names.value.get_values_for_type(x509.DNSName)


def _is_for_clients(certificate: x509.Certificate) -> bool:
    try:
        usage = certificate.extensions.get_extension_for_class(x509.ExtendedKeyUsage)
    except x509.ExtensionNotFound:
        return True
    return not _CLIENT.isdisjoint(usage.value)
