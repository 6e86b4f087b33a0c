"""From bytes to text: byte order mark, the encoding a file names (PEP 263), else UTF-8."""

import codecs
import re

from rtron.sources.code.ir import SourceProblem

_COOKIE = re.compile(rb"[ \t\f]*#.*?coding[:=][ \t]*([-\w.]+)")
_BLANK = re.compile(rb"[ \t\f]*(?:#.*)?")
_KNOWN = re.compile(
    r"(?:utf-?8|ascii$|us-ascii$|latin|iso-?8859|cp\d|windows-|gbk$|gb\d|big5|euc|shift|sjis|koi8)"
)


def decode(data: bytes) -> tuple[str, tuple[SourceProblem, ...]]:
    """Return a file's text with a line feed at its line ends, and what was wrong with its bytes.

    Bytes that are not of the file's encoding are read as Latin-1, NUL bytes as spaces: lines
    stay where they are.
    """
    data = data.removeprefix(codecs.BOM_UTF8)
    encoding = _named_encoding(data)
    try:
        text, problems = data.decode(encoding), list[SourceProblem]()
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        text, problems = data.decode("latin-1"), [SourceProblem(line, f"this is not {encoding}")]
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        problems.append(SourceProblem(line, "NUL bytes"))
    return text.replace("\0", " "), tuple(problems)


def _named_encoding(data: bytes) -> str:
    """Return the encoding of the cookie in the first two lines; one we do not know is UTF-8."""
    for line in data.split(b"\n", 2)[:2]:
        if found := _COOKIE.match(line):
            return _codec(found[1].decode("ascii", "replace").lower().replace("_", "-"))
        if not _BLANK.fullmatch(line.rstrip(b"\r")):
            break
    return "utf-8"


def _codec(name: str) -> str:
    if name.startswith(("utf-8", "utf8")) or not _KNOWN.match(name):
        return "utf-8"
    try:
        return codecs.lookup(name).name
    except LookupError:
        return "utf-8"
