"""Documents that an authority has signed, in clear text: S/MIME (RFC 8551), as DDS-Security asks.

`cryptography` signs and does not verify, so the signature is taken apart with asn1crypto (RFC 5652,
5.4) and its value checked by `cryptography`.
"""

import base64
import hashlib
import re

from asn1crypto import cms
from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec, padding, rsa
from cryptography.hazmat.primitives.serialization import pkcs7
from cryptography.x509 import Certificate

from rtron.errors import InputError

_BOUNDARY = re.compile(rb'boundary="([^"\r\n]{1,70})"')
_HEADER = b"Content-Type: text/plain\r\n\r\n"
_HASHES = {"sha256": hashes.SHA256(), "sha384": hashes.SHA384(), "sha512": hashes.SHA512()}
_OPTIONS = [pkcs7.PKCS7Options.Text, pkcs7.PKCS7Options.DetachedSignature]


def sign_document(data: bytes, certificate: Certificate, key: ec.EllipticCurvePrivateKey) -> bytes:
    """Return a document with the signature of an authority."""
    builder = pkcs7.PKCS7SignatureBuilder().set_data(data)
    signer = builder.add_signer(certificate, key, hashes.SHA256())
    return signer.sign(serialization.Encoding.SMIME, _OPTIONS)


def verify_document(signed: bytes, certificate: Certificate, path: str) -> bytes:
    """Return the document, without carriage returns; InputError if the authority did not sign it.

    The certificates that come with a signature do not count.
    """
    content, signature = _split(signed, path)
    try:
        data = cms.ContentInfo.load(base64.b64decode(signature))["content"]
        is_signed = any(_is_signed_by(each, content, certificate) for each in data["signer_infos"])
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise InputError(f"has no signature that can be read: {error}", path=path) from None
    if not is_signed:
        raise InputError("is not signed by the keystore's permissions CA", path=path)
    return content.removeprefix(_HEADER).replace(b"\r\n", b"\n")


def _split(signed: bytes, path: str) -> tuple[bytes, bytes]:
    """Return the part that is signed, its lines as they were signed, and the signature's Base64."""
    text = signed.replace(b"\r\n", b"\n")
    boundary = _BOUNDARY.search(text)
    parts = text.split(b"\n--" + boundary[1]) if boundary else []
    if len(parts) != 4 or b"\n\n" not in parts[2]:  # noqa: PLR2004 - RFC 1847: before, two, end
        raise InputError("is no signed document", path=path)
    content = parts[1].removeprefix(b"\n").replace(b"\n", b"\r\n")
    return content, parts[2].partition(b"\n\n")[2]


def _is_signed_by(signer: cms.SignerInfo, content: bytes, certificate: Certificate) -> bool:
    algorithm = signer["digest_algorithm"]["algorithm"].native
    attributes = signer["signed_attrs"]
    digests = [each["values"][0].native for each in attributes if _is_digest(each)]
    if algorithm not in _HASHES or digests != [hashlib.new(algorithm, content).digest()]:
        return False
    signature: bytes = signer["signature"].native
    return _is_valid(certificate, signature, attributes.untag().dump(), algorithm)


def _is_digest(attribute: cms.CMSAttribute) -> bool:
    return bool(attribute["type"].native == "message_digest")


def _is_valid(certificate: Certificate, signature: bytes, data: bytes, algorithm: str) -> bool:
    key, hash = certificate.public_key(), _HASHES[algorithm]
    try:
        if isinstance(key, ec.EllipticCurvePublicKey):
            key.verify(signature, data, ec.ECDSA(hash))
            return True
        if isinstance(key, rsa.RSAPublicKey):
            key.verify(signature, data, padding.PKCS1v15(), hash)
            return True
    except InvalidSignature:
        pass
    return False
