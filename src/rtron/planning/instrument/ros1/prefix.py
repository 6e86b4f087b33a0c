"""Puts a launch-prefix before the one that a node has."""

from xml.sax.saxutils import unescape

from rtron.errors import InputError
from rtron.planning.instrument.common.xml_spans import ElementSpan
from rtron.planning.instrument.common.xml_text import LaunchText

_NAME = "launch-prefix"
_ENTITIES = {"&quot;": '"', "&apos;": "'", "&#39;": "'", "&#34;": '"'}


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
