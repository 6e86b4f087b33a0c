"""The guarded launch's own files: the launch file and those of its includes that change."""

import os.path
import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias
from xml.sax.saxutils import quoteattr, unescape

from rtron.errors import InputError
from rtron.planning.instrument.common.guarded_launch import PlacedRemap
from rtron.planning.instrument.common.remaps import NodeRemaps
from rtron.planning.instrument.common.xml_text import (
    PLAIN_TEXT,
    ElementSpan,
    LaunchText,
    find_elements,
    read_utf8,
    splice,
)
from rtron.vocabulary import LaunchFile, LaunchInclude, LaunchNode

_NAME = "launch-prefix"
_ENTITIES = {"&quot;": '"', "&apos;": "'", "&#39;": "'", "&#34;": '"'}
_DOUBLED = re.compile(r"_(?=_)")


def add_launch_prefix(text: LaunchText, element: ElementSpan, script: str) -> None:
    """Start a node by `script`, a path below its own file's folder.

    Raise InputError where an expression chooses the prefix that the node has.
    """
    first = f'"$(dirname){script}"'
    written = text.attribute(element, _NAME)
    if written is None:
        text.add_attribute(element, _NAME, first)
        return
    existing = unescape(written[1:-1], _ENTITIES)
    if existing.strip().startswith("$(eval "):
        why = f"a node that starts launch files has its {_NAME} from $(eval …)"
        raise InputError(why, help="put the expression into an <arg> and use $(arg …)")
    text.set_attribute(element, _NAME, f"{first} {existing}")


_DYNAMIC = re.compile(r"\$\( *(anon|arg|env|eval|optenv) ")
_NOT_LETTERS = re.compile(r"[\W_]+")


def redirect_include(
    text: LaunchText, element: ElementSpan, include: LaunchInclude, copy: str
) -> None:
    """Lead an include to `copy`, a path below its own file's folder.

    Where an argument or the environment chooses the file, the copy stands only for the file that
    was chosen: roslaunch then refuses another choice, for which the launch has to be guarded anew.
    """
    written = text.attribute(element, "file") or ""
    if not _DYNAMIC.search(written):
        text.set_attribute(element, "file", f"$(dirname){copy}")
        return
    name = f"rtron_guarded{_NOT_LETTERS.sub('_', copy)}"
    conditions = ((c, text.attribute(element, c)) for c in ("if", "unless"))
    condition = "".join(f" {c}={value}" for c, value in conditions if value)
    text.insert(element, f'<arg name="{name}" value={written}{condition}/>')
    original = eval_literal(include.evaluated_name)
    file = f"{{{original}: dirname() + {eval_literal(copy)}}}[arg('{name}')]"
    text.set_attribute(element, "file", f"$(eval {file})")


Edits: TypeAlias = tuple[object, ...]

_NODES = ("node", "test")
_UNSAFE = re.compile(r"[^\w.-]")


@dataclass(slots=True)
class LaunchCopies:
    """Makes changed copies of launch files; `texts` maps each copy's name to its text.

    Every inclusion has its own copy, as the nodes of each have other names. `scripts` are the
    launch-prefixes of nodes: those that start launch files, or run in a cell.
    """

    remaps: NodeRemaps
    scripts: Mapping[str, str] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)

    def root(self, file: LaunchFile, folder: str, guard: Collection[str]) -> str:
        """Return the launch file's text with the guard; the copies lie beside it in `folder`."""
        text = self._changed_text(file, f"/{folder}")
        launch = next(element for element in text.elements if element.tag == "launch")
        text.prepend(launch, tuple(guard))
        return text.render()

    def render_started(self, file: LaunchFile, copies_path: str) -> str:
        """Return the text of a launch file that a node starts; `copies_path` leads to copies."""
        return self._changed_text(file, copies_path).render()

    def changes(self, file: LaunchFile) -> bool:
        """Tell whether a launch file, or one below it, is to be changed."""
        return any(self._edits(node) for below in file.walk() for node in below.nodes)

    def edits(self, file: LaunchFile) -> Edits:
        """Return all changes of a launch file and those below it, to be compared."""
        nodes = ((node.element_index, self._edits(node)) for node in file.nodes)
        includes = (
            (i.element_index, i.evaluated_name, self.edits(i.file))
            for i in file.includes
            if self.changes(i.file)
        )
        return (*(edit for edit in nodes if edit[1]), *includes)

    def _changed_text(self, file: LaunchFile, copies_path: str) -> LaunchText:
        """Return a file with its remaps, and its includes led to their copies.

        `copies_path` is what leads from the folder of the file's copy to the others.
        """
        text = source_text(file.path, _dirname(file.path))
        for node in file.nodes:
            remaps = self._remaps(node)
            if remaps:
                text.append(_element(text, file, node.element_index, _NODES), remaps)
            if script := self.scripts.get(node.name):
                element = _element(text, file, node.element_index, _NODES)
                add_launch_prefix(text, element, f"{copies_path}/{script}")
        for include in file.includes:
            if self.changes(include.file):
                element = _element(text, file, include.element_index, ("include",))
                redirect_include(
                    text, element, include, f"{copies_path}/{self._copy(include.file)}"
                )
        return text

    def _edits(self, node: LaunchNode) -> tuple[str, ...]:
        return (*self._remaps(node), *(name for name in (node.name,) if name in self.scripts))

    def _remaps(self, node: LaunchNode) -> tuple[str, ...]:
        return tuple(_remap(placed) for placed in self.remaps.get(node, ()) if placed.is_placeable)

    def _copy(self, file: LaunchFile) -> str:
        plain = _UNSAFE.sub("_", os.path.basename(file.path))  # noqa: PTH119
        name = f"{len(self.texts) + 1:02}_{plain}"
        self.texts[name] = ""
        self.texts[name] = self._changed_text(file, "").render()
        return name


def _dirname(path: str) -> str:
    """Return what `$(dirname)` means in a file; roslaunch does not follow links for it."""
    return os.path.abspath(os.path.dirname(path))  # noqa: PTH100, PTH120


def _remap(placed: PlacedRemap) -> str:
    return f"<remap from={quoteattr(placed.written)} to={quoteattr(placed.target)}/>"


def _element(text: LaunchText, file: LaunchFile, index: int, tags: Collection[str]) -> ElementSpan:
    if index >= len(text.elements) or text.elements[index].tag not in tags:
        raise InputError("has changed since it was read", path=file.path, help="start again")
    return text.elements[index]


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
