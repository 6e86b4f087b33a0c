"""Text becomes Python's own syntax tree.

As Python 3, else as Python 3.12 or Python 2 rewritten, else without what is broken.
The text is parsed, never compiled. Python's parser bounds its own depth.
"""

import ast
import warnings

from rtron.sources.code.frontends.python.error_recovery import RecoverableText
from rtron.sources.code.frontends.python.python2_syntax import as_python3
from rtron.sources.code.frontends.python.python312_syntax import as_python311
from rtron.sources.code.ir import SourceProblem

_MAX_REPAIRS = 3
_MAX_ERRORS = 60
_MAX_PARSED = 4 * 2**20


def parse(text: str) -> tuple[ast.Module, tuple[SourceProblem, ...]]:
    """Return the tree of a text whose lines end with a line feed, and what had to be left out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(_MAX_REPAIRS):
            tree = _try_parse(text)
            if isinstance(tree, ast.Module):
                return tree, ()
            repaired = as_python3(as_python311(text))
            if repaired == text:
                break
            text = repaired
        return _parse_recovering(RecoverableText(text), len(text))


def _try_parse(text: str) -> ast.Module | SyntaxError:
    """Parse; whatever Python's parser cannot bear is a syntax error, perhaps without a line."""
    try:
        return ast.parse(text)
    except SyntaxError as error:
        return error
    except (RecursionError, MemoryError, ValueError):
        return SyntaxError("nested too deep for Python itself")


def _parse_recovering(
    blanks: RecoverableText, size: int
) -> tuple[ast.Module, tuple[SourceProblem, ...]]:
    """Blank one statement after another until Python reads the rest, or what stands before."""
    attempts = min(_MAX_ERRORS, 1 + _MAX_PARSED // (size + 1))
    for left in reversed(range(attempts)):
        tree = _try_parse(blanks.text())
        if isinstance(tree, ast.Module):
            return tree, tuple(blanks.problems)
        if left:
            blanks.remove_statement(tree)
        else:
            blanks.remove_rest(tree)
    tree = _try_parse(blanks.text())
    if isinstance(tree, SyntaxError):
        tree = ast.Module(body=[], type_ignores=[])
        blanks.problems.append(SourceProblem(0, "too many errors, not read"))
    return tree, tuple(blanks.problems)
