"""Leads an `<include>` to the changed copy of its file."""

import re

from rtron.planning.instrument.common.xml_spans import ElementSpan
from rtron.planning.instrument.common.xml_text import LaunchText
from rtron.planning.instrument.ros1.literal import eval_literal
from rtron.vocabulary import LaunchInclude

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
    file = f"{{{eval_literal(include.evaluated_name)}: dirname() + {eval_literal(copy)}}}[arg('{name}')]"
    text.set_attribute(element, "file", f"$(eval {file})")
