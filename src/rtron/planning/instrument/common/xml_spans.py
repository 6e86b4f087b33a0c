"""Where the elements of a launch file stand in its text, so that the rest of it stays as it is."""

import re
from dataclasses import dataclass
from xml.parsers import expat

from rtron.errors import InputError

_START_TAG = re.compile(rb"""<(?:[^"'>]|"[^"]*"|'[^']*')*>""")


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementSpan:
    """An element's place: offsets in bytes; `content_start` is behind its start tag.

    `content_end` is where its end tag begins, or the end of the start tag of an empty element.
    """

    tag: str
    start: int
    content_start: int
    content_end: int
    is_empty: bool


def find_elements(text: bytes, path: str) -> tuple[ElementSpan, ...]:
    """Return the elements of an XML text in UTF-8, in document order.

    Raise InputError where it is not XML or has a document type.
    """
    starts: list[tuple[str, int]] = []
    closes: dict[int, int] = {}
    open_elements: list[int] = []
    parser = safe_parser(path, "utf-8")

    def started(tag: str, _: object) -> None:
        open_elements.append(len(starts))
        starts.append((tag, parser.CurrentByteIndex))

    def ended(_: str) -> None:
        closes[open_elements.pop()] = parser.CurrentByteIndex

    parser.StartElementHandler, parser.EndElementHandler = started, ended
    parse(parser, text, path)
    return tuple(_span(text, *start, closes[index]) for index, start in enumerate(starts))


def safe_parser(path: str, encoding: str | None = None) -> expat.XMLParserType:
    """Return a parser that refuses a document type before it reads any entity."""
    parser = expat.ParserCreate(encoding)

    def refuse(*_: object) -> None:
        help = "take the <!DOCTYPE …> out; entities are not read"
        raise InputError("has a document type", path=path, line=parser.CurrentLineNumber, help=help)

    parser.StartDoctypeDeclHandler = refuse
    return parser


def parse(parser: expat.XMLParserType, text: bytes, path: str) -> None:
    """Run a parser over a whole text; raise InputError where it is not XML."""
    try:
        parser.Parse(text, True)  # noqa: FBT003 - that this is all of it
    except expat.ExpatError as error:
        raise InputError(f"not XML: {error}", path=path, line=error.lineno) from None


def _span(text: bytes, tag: str, start: int, close: int) -> ElementSpan:
    match = _START_TAG.match(text, start)
    inner = match.end() if match else start
    empty = text.endswith(b"/>", start, inner)
    return ElementSpan(
        tag=tag,
        start=start,
        content_start=inner,
        content_end=inner if empty else close,
        is_empty=empty,
    )
