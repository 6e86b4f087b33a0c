"""Text becomes Python's own syntax tree: as Python 3, else Python 2, else without what is broken.

The text is parsed, never compiled. Python's parser bounds its own depth.
"""

import ast
import warnings

from rtron.sources.code.frontends.python.error_recovery import Blanks
from rtron.sources.code.frontends.python.python2_syntax import as_python3
from rtron.sources.code.ir import Problem

_ROUNDS_OF_REPAIR = 3
_MOST_ERRORS = 60
_MOST_PARSED = 4 * 2**20


def parse(text: str) -> tuple[ast.Module, tuple[Problem, ...]]:
    """Return the tree of a text whose lines end with a line feed, and what had to be left out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for _ in range(_ROUNDS_OF_REPAIR):
            tree = _attempt(text)
            if isinstance(tree, ast.Module):
                return tree, ()
            repaired = as_python3(text)
            if repaired == text:
                break
            text = repaired
        return _parse_part(Blanks(text), len(text))


def _attempt(text: str) -> ast.Module | SyntaxError:
    """Parse; whatever Python's parser cannot bear is a syntax error, perhaps without a line."""
    try:
        return ast.parse(text)
    except SyntaxError as error:
        return error
    except (RecursionError, MemoryError, ValueError):
        return SyntaxError("nested too deep for Python itself")


def _parse_part(blanks: Blanks, size: int) -> tuple[ast.Module, tuple[Problem, ...]]:
    """Blank one statement after another until Python reads the rest, or what stands before."""
    attempts = min(_MOST_ERRORS, 1 + _MOST_PARSED // (size + 1))
    for left in reversed(range(attempts)):
        tree = _attempt(blanks.text())
        if isinstance(tree, ast.Module):
            return tree, tuple(blanks.problems)
        if left:
            blanks.blank(tree)
        else:
            blanks.blank_from(tree)
    tree = _attempt(blanks.text())
    if isinstance(tree, SyntaxError):
        tree = ast.Module(body=[], type_ignores=[])
        blanks.problems.append(Problem(0, "too many errors, not read"))
    return tree, tuple(blanks.problems)
