"""One file of Python as a unit of the intermediate representation."""

from rtron.sources.code.frontends.python.parser import parse
from rtron.sources.code.frontends.python.source_file import SourceFile, decode
from rtron.sources.code.frontends.python.statements import lower_statements
from rtron.sources.code.ir import SourceLanguage, SourceProblem, Unit

MAX_BYTES = 2 * 2**20


def lower_python(path: str, text: bytes) -> Unit:
    """Lower a file of Python 2 or 3, which is parsed and never run; it raises nothing.

    What cannot be read is left out, and is among the unit's problems.
    """
    if len(text) > MAX_BYTES:
        return _unreadable_unit(path, f"larger than {MAX_BYTES // 2**20} MiB, not read")
    decoded, encoding_problems = decode(text)
    tree, syntax_problems = parse(decoded)
    source = SourceFile(file=path, lines=decoded.encode("utf-8", "replace").split(b"\n"))
    try:
        body = lower_statements(tree.body, source)
    except RecursionError:
        return _unreadable_unit(path, "nested too deep, not read")
    problems = (*encoding_problems, *syntax_problems, *source.problems)
    return Unit(file=path, language=SourceLanguage.PYTHON, body=body, problems=problems)


def _unreadable_unit(path: str, why: str) -> Unit:
    return Unit(file=path, language=SourceLanguage.PYTHON, problems=(SourceProblem(0, why),))
