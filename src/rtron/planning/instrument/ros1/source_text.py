"""The text of a launch file as it is read to be copied to another folder."""

import re
from collections.abc import Iterator

from rtron.errors import InputError
from rtron.planning.instrument.common.xml_text import (
    PLAIN_TEXT,
    ElementSpan,
    LaunchText,
    find_elements,
    read_utf8,
    splice,
)

_DOUBLED = re.compile(r"_(?=_)")


def eval_literal(text: str) -> str:
    """Return a Python literal with no two underscores together, which roslaunch refuses."""
    escaped = text.replace("\\", r"\\").replace("'", r"\'")
    return "('" + _DOUBLED.sub("_' '", escaped) + "')"


_QUOTED = re.compile(rb"\"[^\"]*\"|'[^']*'")
_DIRNAME = re.compile(rb"\$\( *dirname(?: [^()$]*)?\)")
_DIRNAME_CALL = re.compile(rb"\bdirname\s*\(\s*\)")


def source_text(path: str, folder: str) -> LaunchText:
    """Read a launch file so that a copy of it elsewhere still means `folder` by `$(dirname)`.

    Raise InputError if it cannot be read, is not XML or has a document type.
    """
    text = read_utf8(path)
    text = _with_folder(text, find_elements(text, path), folder, path)
    return LaunchText(text=text, elements=find_elements(text, path))


def _with_folder(text: bytes, elements: tuple[ElementSpan, ...], folder: str, path: str) -> bytes:
    """Write out what `$(dirname)` means, wherever roslaunch would replace it."""
    ranges = list(_evaluated_ranges(text, elements))
    replacements = [(*range_, _expanded(text[slice(*range_)], folder)) for range_ in ranges]
    changes = [change for change in replacements if change[2] != text[change[0] : change[1]]]
    if changes and not PLAIN_TEXT.fullmatch(folder):
        raise InputError("lies in a folder whose name cannot stand in a launch file", path=path)
    return splice(text, changes)


def _evaluated_ranges(text: bytes, elements: tuple[ElementSpan, ...]) -> Iterator[tuple[int, int]]:
    """Yield the places of all attribute values, and of the YAML that says `subst_value`."""
    for element in elements:
        tag = text[element.start : element.content_start]
        yield from (
            (element.start + match.start(), element.start + match.end())
            for match in _QUOTED.finditer(tag)
        )
        if element.tag.lower() == "rosparam" and b"subst_value" in tag:
            yield element.content_start, element.content_end


def _expanded(value: bytes, folder: str) -> bytes:
    if not value[1:].startswith(b"$(eval "):
        return _DIRNAME.sub(lambda _: folder.encode(), value)
    quoted = eval_literal(folder).replace("'", "&#39;").encode()
    return _DIRNAME_CALL.sub(lambda _: quoted, value)
