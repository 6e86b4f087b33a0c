"""One file of Python as a unit of the intermediate representation."""

from rtron.sources.code.frontends.python.parser import parse
from rtron.sources.code.frontends.python.source_encoding import decode
from rtron.sources.code.frontends.python.source_file import Source
from rtron.sources.code.frontends.python.statements import statements
from rtron.sources.code.ir import Language, Problem, Unit

MAX_BYTES = 2 * 2**20


def lower_python(path: str, text: bytes) -> Unit:
    """Lower a file of Python 2 or 3, which is parsed and never run; it raises nothing.

    What cannot be read is left out, and is among the unit's problems.
    """
    if len(text) > MAX_BYTES:
        return _unread(path, f"larger than {MAX_BYTES // 2**20} MiB, not read")
    decoded, wrong_bytes = decode(text)
    tree, wrong_syntax = parse(decoded)
    source = Source(file=path, lines=decoded.encode("utf-8", "replace").split(b"\n"))
    try:
        body = statements(tree.body, source)
    except RecursionError:
        return _unread(path, "nested too deep, not read")
    problems = (*wrong_bytes, *wrong_syntax, *source.problems)
    return Unit(file=path, language=Language.PYTHON, body=body, problems=problems)


def _unread(path: str, why: str) -> Unit:
    return Unit(file=path, language=Language.PYTHON, problems=(Problem(0, why),))
