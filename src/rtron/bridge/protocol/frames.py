"""The frames of rosbridge v2: JSON objects with an `op`, in one piece or in fragments.

What comes in is a stranger's: bounded in size and depth, without NaN, and put together from a
bounded number of fragments (rosbridge v2.0, 3.1).
"""

import base64
import json
import re
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import ceil, isfinite, isqrt
from typing import Any, NoReturn

from rtron.errors import WireError
from rtron.vocabulary import SECOND

Document = dict[str, Any]
NODE_HEADER = "RTron-Node"
"""Where the answer to a handshake with a token names the node of the client."""
MAX_DEPTH = 32
"""How deep the values of a frame may be nested."""
MAX_ID = 256
"""The longest id of a frame, characters."""
MAX_FRAGMENTS = 1024
MAX_OPEN = 4
"""How many messages may be incomplete at a time."""
FRAGMENT_TIMEOUT = 10 * SECOND
"""How long the fragments of a message may take, ns."""
MIN_FRAGMENT = 128
"""The smallest `fragment_size` that is kept to, characters: each fragment costs a frame."""
_BRACKETS = re.compile(r'"(?:[^"\\]+|\\.?)*"?|[\[{]|[\]}]', re.DOTALL)
"""Texts, ended or not, and brackets; nothing in it can fail once it has begun, so it is linear."""
_MAX_DIGITS = 400
_PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_PNG_NUMBER = struct.Struct(">I")
_PNG_HEADER = struct.Struct(">IIBBBBB")
_PNG_BITS, _PNG_RGB = 8, 2
_PNG_PIXEL = 3
_PNG_FILL = b"\n"
_PNG_LEVEL = 1


def size_of(text: str) -> int:
    """Return how many bytes a text takes in a frame (UTF-8)."""
    return len(text) if text.isascii() else len(text.encode("utf-8", "surrogatepass"))


def decode_frame(text: str) -> Document:
    """Return the object of a frame; WireError if it is none that the protocol has."""
    try:
        document = parse_json(text)
    except ValueError as error:
        raise WireError(f"the frame is not JSON: {str(error)[:100]}") from None
    if not isinstance(document, dict):
        raise WireError("the frame is no JSON object")
    if not isinstance(document.get("op"), str):
        raise WireError("the frame has no `op`")
    frame_id(document)
    return document


def parse_json(text: str) -> Any:  # noqa: ANN401 - any JSON
    """Return a JSON value; WireError if it is too deep or has no finite number, else ValueError."""
    _check_depth(text)
    return json.loads(
        text, parse_constant=_refuse_constant, parse_int=_parse_int, parse_float=_parse_float
    )


def frame_id(document: Document) -> "str | int | None":
    """Return the id of a frame; WireError if it is neither a short text nor a number."""
    found = document.get("id")
    is_number = isinstance(found, int) and not isinstance(found, bool)
    if found is None or is_number or (isinstance(found, str) and len(found) <= MAX_ID):
        return found
    raise WireError(f"the frame's `id` is no text of at most {MAX_ID} characters")


def text_of(document: Document, name: str) -> str:
    """Return a text of a frame; WireError if it is missing or no text."""
    found = document.get(name)
    if not isinstance(found, str) or not found:
        raise WireError(f"{document['op']} needs `{name}`, a text")
    return found


def name_of(document: Document, name: str) -> str:
    """Return a topic or service of a frame by its full name; one without `/` is below the root."""
    found = text_of(document, name)
    return found if found.startswith("/") else f"/{found}"


def whole_number(document: Document, name: str, default: int = 0) -> int:
    """Return a number of a frame that counts something; WireError if it is none."""
    found = document.get(name, default)
    found = default if found is None else found
    if isinstance(found, float) and found.is_integer():
        found = int(found)
    if isinstance(found, bool) or not isinstance(found, int) or found < 0:
        raise WireError(f"`{name}` is no whole number from 0 on")
    return found


def encode_frame(document: Document) -> str:
    """Return the text of a frame."""
    return json.dumps(document, separators=(",", ":"), allow_nan=False)


def split_frame(text: str, size: int, id: str) -> Iterator[str]:
    """Yield a frame's text as it is sent: whole, or as fragments of at most `size` characters."""
    size = max(size, MIN_FRAGMENT)
    if len(text) <= size:
        yield text
        return
    total = -(-len(text) // size)
    for num in range(total):
        part = text[num * size : (num + 1) * size]
        yield encode_frame({"op": "fragment", "id": id, "data": part, "num": num, "total": total})


def png_text(text: str) -> str:
    """Return a text as the base64 of a PNG (rosbridge v2.0, 3.1.2): its bytes are the pixels.

    Line feeds fill the last row. Only what goes out: a picture that comes in may be a bomb.
    """
    data = text.encode()
    width = max(1, isqrt(ceil(len(data) / _PNG_PIXEL)))
    height = max(1, ceil(len(data) / (_PNG_PIXEL * width)))
    data = data.ljust(width * height * _PNG_PIXEL, _PNG_FILL)
    row = width * _PNG_PIXEL
    rows = b"".join(b"\0" + data[at : at + row] for at in range(0, len(data), row))
    header = _PNG_HEADER.pack(width, height, _PNG_BITS, _PNG_RGB, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows, _PNG_LEVEL)), (b"IEND", b""))
    image = _PNG_SIGNATURE + b"".join(_png_chunk(kind, body) for kind, body in chunks)
    return base64.b64encode(image).decode()


def _png_chunk(kind: bytes, body: bytes) -> bytes:
    return _PNG_NUMBER.pack(len(body)) + kind + body + _PNG_NUMBER.pack(zlib.crc32(kind + body))


@dataclass(slots=True)
class _OpenMessage:
    """A message of which some fragments are there."""

    total: int
    began: int
    parts: dict[int, str] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """The characters that are there."""
        return sum(map(len, self.parts.values()))


class FragmentAssembler:
    """Puts messages together from their fragments, never more than `max_size` characters of all."""

    def __init__(self, max_size: int) -> None:
        self._max_size = max_size
        self._open: dict[str | int, _OpenMessage] = {}

    def add(self, document: Document, now: int) -> str | None:
        """Take a fragment; return the text of its message once that is complete.

        WireError if the fragment does not fit; its message is forgotten then.
        """
        self._forget_late(now)
        id = frame_id(document)
        if id is None:
            raise WireError("a fragment needs the `id` of its message")
        try:
            return self._add(id, document, now)
        except WireError:
            self._open.pop(id, None)
            raise

    def _add(self, id: "str | int", document: Document, now: int) -> str | None:
        num, total = whole_number(document, "num"), whole_number(document, "total")
        if not 0 < total <= MAX_FRAGMENTS or num >= total:
            raise WireError(f"fragment {num} of {total}: a message has 1 to {MAX_FRAGMENTS}")
        message = self._message(id, total, now)
        if num in message.parts:
            raise WireError(f"fragment {num} came twice")
        message.parts[num] = text_of(document, "data")
        if sum(each.size for each in self._open.values()) > self._max_size:
            raise WireError(f"the fragments have more than {self._max_size} characters")
        if len(message.parts) < total:
            return None
        del self._open[id]
        return "".join(message.parts[each] for each in range(total))

    def _message(self, id: "str | int", total: int, now: int) -> _OpenMessage:
        message = self._open.get(id)
        if message is None:
            if len(self._open) >= MAX_OPEN:
                raise WireError(f"{MAX_OPEN} messages are incomplete, send their fragments first")
            message = self._open[id] = _OpenMessage(total, now)
        if message.total != total:
            raise WireError(f"there were {message.total} fragments to come, now {total}")
        return message

    def _forget_late(self, now: int) -> None:
        late = [id for id, each in self._open.items() if now - each.began > FRAGMENT_TIMEOUT]
        for id in late:
            del self._open[id]


def _check_depth(text: str) -> None:
    """Refuse a frame that is nested so deep that reading it would use up the stack."""
    if text.count("[") + text.count("{") <= MAX_DEPTH:
        return
    depth = 0
    for found in _BRACKETS.finditer(text):
        character = found[0][0]
        depth += (character in "[{") - (character in "]}")
        if depth > MAX_DEPTH:
            raise WireError(f"the JSON is nested deeper than {MAX_DEPTH}")


def _refuse_constant(name: str) -> NoReturn:
    raise WireError(f"{name} is no number of JSON")


def _parse_int(digits: str) -> int:
    if len(digits) > _MAX_DIGITS:
        raise WireError("a number has too many digits")
    return int(digits)


def _parse_float(digits: str) -> float:
    number = float(digits)
    if not isfinite(number):
        raise WireError(f"{digits[:20]} is larger than any number here")
    return number
