"""One file of Python as a unit of the intermediate representation."""

from rtron.sources.code import ir
from rtron.sources.code.frontends.python.parser import parse
from rtron.sources.code.frontends.python.source_file import SourceFile, decode
from rtron.sources.code.frontends.python.statements import lower_statements

MAX_BYTES = 2 * 2**20


def lower_python(path: str, text: bytes) -> ir.Unit:
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
    return ir.Unit(file=path, language=ir.SourceLanguage.PYTHON, body=body, problems=problems)


def _unreadable_unit(path: str, why: str) -> ir.Unit:
    return ir.Unit(
        file=path, language=ir.SourceLanguage.PYTHON, problems=(ir.SourceProblem(0, why),)
    )
