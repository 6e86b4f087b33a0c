"""Runs the real xacro (PyPI) on files, in a process of its own: what it prints, as JSON lines.

Standard input: {"packages": {name: folder}, "jobs": [[file, {argument: value}], …]}. Without ROS,
`$(find …)` is looked up in `packages`. Kinetic's spellings are rewritten to today's when a file is
parsed, as the xacro of today reads them no more.
"""

import json
import signal
import sys

import xacro
import xacro.substitution_args

NEEDED = {
    "arg": {"name", "default"},
    "if": {"value"},
    "include": {"filename"},
    "insert_block": {"name"},
    "macro": {"name"},
    "property": {"name"},
    "unless": {"value"},
}
SECONDS = 20

parse, handle_macro_call = xacro.parse, xacro.handle_macro_call


def rename(element):
    element.tagName = element.nodeName = f"xacro:{element.tagName}"


def parse_old(inp, filename=None):
    document = parse(inp, filename)
    for element in list(document.getElementsByTagName("*")):
        needed = NEEDED.get(element.tagName)
        has_elements = any(child.nodeType == child.ELEMENT_NODE for child in element.childNodes)
        is_include_of_sdf = element.tagName == "include" and has_elements
        if needed and needed <= set(element.attributes.keys()) and not is_include_of_sdf:
            rename(element)
    return document


def handle_old_call(node, macros, symbols):
    if not node.tagName.startswith("xacro:"):
        try:
            macro = xacro.resolve_macro(node.tagName, macros, symbols)[2]
        except (KeyError, TypeError):
            return False
        if macro in xacro.macrostack or not set(node.attributes.keys()) <= set(macro.params):
            return False
        rename(node)
    return handle_macro_call(node, macros, symbols)


def run(path, arguments):
    signal.alarm(SECONDS)
    try:
        return {"xml": xacro.process_file(path, mappings=dict(arguments), verbosity=0).toxml()}
    except BaseException as error:  # noqa: BLE001 - whatever it says, it could not
        return {"error": f"{type(error).__name__}: {error}"}
    finally:
        signal.alarm(0)


def too_long(*_):
    raise TimeoutError


def main():
    work = json.load(sys.stdin)
    signal.signal(signal.SIGALRM, too_long)
    xacro.substitution_args._eval_find = work["packages"].__getitem__
    xacro.parse, xacro.handle_macro_call = parse_old, handle_old_call
    for path, arguments in work["jobs"]:
        print(json.dumps({"path": path, **run(path, arguments)}), flush=True)


main()
