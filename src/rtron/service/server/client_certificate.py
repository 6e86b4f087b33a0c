"""The certificate that a client shows: in TLS, or as the header of the proxy that speaks TLS."""

import asyncio
import base64
import binascii
import ssl
from collections.abc import Iterable
from urllib.parse import unquote

HEADER = b"client-cert"
STATE_KEY = "client_certificate"
"""Under this key the state of a WebSocket has the certificate (DER), None if none is shown."""


def shown_certificate(
    transport: asyncio.BaseTransport, headers: Iterable[tuple[bytes, bytes]], *, is_proxy: bool
) -> bytes | None:
    """Return the certificate that a client shows, DER; None if it shows none.

    What a proxy hands on counts from a proxy only, and what the proxy itself shows does not.
    """
    if is_proxy:
        values = [value for name, value in headers if name.lower() == HEADER]
        return _parse_header(values[0]) if len(values) == 1 else None
    tls = transport.get_extra_info("ssl_object")
    certificate: bytes | None = tls.getpeercert(binary_form=True) if tls else None
    return certificate


def _parse_header(value: bytes) -> bytes | None:
    """Return what RFC 9440 (`:base64:`), or nginx' $ssl_client_escaped_cert (PEM), hands on."""
    try:
        text = value.decode("ascii").strip()
        if text.startswith(":") and text.endswith(":"):
            return base64.b64decode(text[1:-1], validate=True) or None
        return ssl.PEM_cert_to_DER_cert(unquote(text)) if text else None
    except (ValueError, binascii.Error):
        return None
