"""The text of a C++ file, whatever its encoding."""

_UTF16 = (b"\xff\xfe", b"\xfe\xff")


def decode_source(data: bytes) -> str:
    """Return the text: UTF-16 by its mark, UTF-8, or else Latin-1; lines end with a newline only.

    NULs, which no parser expects, become spaces; lone surrogates become question marks.
    """
    text = _decode(data).replace("\r\n", "\n").replace("\r", "\n").replace("\0", " ")
    return text.encode("utf-8", "replace").decode("utf-8")


def _decode(data: bytes) -> str:
    if data.startswith(_UTF16):
        return data.decode("utf-16", "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")
