"""A launch file's text with small changes made in it; all that is not changed stays as it was."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

from rtron.errors import InputError

_ENCODING = re.compile(r"""\A(\ufeff?<\?xml[^>]*?encoding\s*=\s*)["'][^"']*["']""")
PLAIN_TEXT = re.compile(r"""[^"'&<>$\\\x00-\x1f]*""")
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


def read_utf8(path: str) -> bytes:
    """Return a file's text in UTF-8, and its XML declaration saying so."""
    try:
        data = Path(path).read_bytes()
        text = data.decode(_encoding(data, path))
    except (OSError, LookupError, UnicodeError) as error:
        raise InputError(f"cannot be read: {error}", path=path) from None
    return _ENCODING.sub(r'\1"UTF-8"', text, count=1).encode()


def _encoding(data: bytes, path: str) -> str:
    declared: list[str | None] = []
    parser = _safe_parser(path)
    parser.XmlDeclHandler = lambda _, encoding, __: declared.append(encoding)
    _parse(parser, data, path)
    return next(iter(declared), None) or "utf-8"


def find_elements(text: bytes, path: str) -> tuple[ElementSpan, ...]:
    """Return the elements of an XML text in UTF-8, in document order.

    Raise InputError where it is not XML or has a document type.
    """
    starts: list[tuple[str, int]] = []
    closes: dict[int, int] = {}
    open_elements: list[int] = []
    parser = _safe_parser(path, "utf-8")

    def started(tag: str, _: object) -> None:
        open_elements.append(len(starts))
        starts.append((tag, parser.CurrentByteIndex))

    def ended(_: str) -> None:
        closes[open_elements.pop()] = parser.CurrentByteIndex

    parser.StartElementHandler, parser.EndElementHandler = started, ended
    _parse(parser, text, path)
    return tuple(_span(text, *start, closes[index]) for index, start in enumerate(starts))


def _safe_parser(path: str, encoding: str | None = None) -> expat.XMLParserType:
    """Return a parser that refuses a document type before it reads any entity."""
    parser = expat.ParserCreate(encoding)

    def refuse(*_: object) -> None:
        help = "take the <!DOCTYPE …> out; entities are not read"
        raise InputError("has a document type", path=path, line=parser.CurrentLineNumber, help=help)

    parser.StartDoctypeDeclHandler = refuse
    return parser


def _parse(parser: expat.XMLParserType, text: bytes, path: str) -> None:
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


_ATTRIBUTE = re.compile(rb"""([^\s=<>/"']+)\s*=\s*("[^"]*"|'[^']*')""")


def splice(text: bytes, changes: Iterable[tuple[int, int, bytes]]) -> bytes:
    """Return a text with other bytes from each start to each end."""
    pieces, last = [], 0
    for start, end, new in sorted(changes):
        pieces += [text[last:start], new]
        last = end
    return b"".join([*pieces, text[last:]])


@dataclass(slots=True, kw_only=True)
class LaunchText:
    """Collects changes to one XML text in UTF-8; `elements` stand in document order."""

    text: bytes
    elements: Sequence[ElementSpan]
    _changes: list[tuple[int, int, bytes]] = field(default_factory=list)

    def attribute(self, element: ElementSpan, name: str) -> str | None:
        """Return an attribute as it is written, its quotes and entities included."""
        for match in _ATTRIBUTE.finditer(self.text, element.start, element.content_start):
            if match[1] == name.encode():
                return match[2].decode()
        return None

    def set_attribute(self, element: ElementSpan, name: str, value: str) -> None:
        """Give an attribute that an element has another value."""
        for match in _ATTRIBUTE.finditer(self.text, element.start, element.content_start):
            if match[1] == name.encode():
                self._change(*match.span(2), quoteattr(value))

    def add_attribute(self, element: ElementSpan, name: str, value: str) -> None:
        """Give an element an attribute that it lacks."""
        at = element.start + 1 + len(element.tag.encode())
        self._change(at, at, f" {name}={quoteattr(value)}")

    def insert(self, element: ElementSpan, sibling: str) -> None:
        """Put another element before an element, on a line of its own."""
        self._change(element.start, element.start, sibling + self._line(element))

    def append(self, element: ElementSpan, children: Sequence[str]) -> None:
        """Put children last into an element, a line each."""
        content = self.text[element.content_start : element.content_end]
        at = element.content_start + len(content.rstrip())
        if element.is_empty:
            self._fill(element, children)
        elif b"\n" in self.text[at : element.content_end]:
            self._change(at, at, self._lines(element, children))
        else:
            self._change(at, at, self._lines(element, children) + self._line(element))

    def prepend(self, element: ElementSpan, children: Sequence[str]) -> None:
        """Put children first into an element, a line each."""
        if element.is_empty:
            self._fill(element, children)
        else:
            self._change(
                element.content_start, element.content_start, self._lines(element, children)
            )

    def render(self) -> str:
        """Return the text with all changes made."""
        return splice(self.text, self._changes).decode()

    def _change(self, start: int, end: int, new: str) -> None:
        self._changes.append((start, end, new.encode()))

    def _fill(self, element: ElementSpan, children: Sequence[str]) -> None:
        """Give children to an empty element, `<x/>`."""
        end_of_tag = element.start + len(
            self.text[element.start : element.content_start - 2].rstrip()
        )
        end = f"{self._line(element)}</{element.tag}>"
        self._change(end_of_tag, element.content_start, f">{self._lines(element, children)}{end}")

    def _lines(self, element: ElementSpan, children: Sequence[str]) -> str:
        line = self._line(element)
        step = "\t" if "\t" in line else "  "
        return "".join(f"{line}{step}{child}" for child in children)

    def _line(self, element: ElementSpan) -> str:
        """Return a line break as the file has them, and the indentation of an element."""
        before = self.text[self.text.rfind(b"\n", 0, element.start) + 1 : element.start]
        indentation = before[: len(before) - len(before.lstrip())].decode()
        return ("\r\n" if b"\r\n" in self.text else "\n") + indentation
