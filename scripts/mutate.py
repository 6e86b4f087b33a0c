"""Change the tables and properties of the policies one by one, and see whether a test fails.

mutmut changes functions only. Here each entry of a table gets another state or effect, and each
property another result; what cannot arise is left out. Each change is made in a process of its
own. Names what no test finds, and exits 1 if more than one in twenty is not found.
"""

import ast
import inspect
import os
import pkgutil
import sys
import textwrap
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

from rtron import policies
from rtron.policies.state_machine import TransitionEffect

TESTS = Path(__file__).parent.parent / "tests" / "policies"
OPTIONS = ["-x", "-q", "-p", "no:cacheprovider", "--timeout=0", "--hypothesis-profile=mutation"]
LEAST_FOUND = 0.95

Change = tuple[str, Callable[[], None]]


def changes() -> Iterator[Change]:
    """Yield every change, with its name."""
    for info in pkgutil.iter_modules(policies.__path__):
        module = import_module(f"{policies.__name__}.{info.name}")
        if hasattr(module, "TABLE") and hasattr(module, "State"):
            yield from _table_changes(module)
        for owner in vars(module).values():
            if inspect.isclass(owner) and owner.__module__ == module.__name__:
                yield from _property_changes(owner)


def _table_changes(module: ModuleType) -> Iterator[Change]:
    table, effects = module.TABLE, dict.fromkeys(effect for _, effect in module.TABLE.values())
    for key, (state, effect) in table.items():
        if effect is TransitionEffect.NEVER:
            continue
        others = [(other, effect) for other in module.State if other is not state]
        others += [
            (state, other) for other in effects if other not in (effect, TransitionEffect.NEVER)
        ]
        for other in others:
            place = ", ".join(each.name for each in key)
            told = f"{module.__name__}: {place} -> {other[0].name}, {other[1].name}"
            yield told, lambda key=key, other=other: table.__setitem__(key, other)


def _property_changes(owner: type) -> Iterator[Change]:
    for name, found in vars(owner).items():
        if isinstance(found, property) and not getattr(owner, "_is_protocol", False):
            for told, changed in _changed(found.fget):
                path = f"{owner.__module__}.{owner.__name__}.{name}: {told}"
                yield path, lambda name=name, made=changed: setattr(owner, name, property(made))


def _changed(function: Callable[..., object]) -> Iterator[tuple[str, Callable[..., object]]]:
    """Yield a property's function with its result, or a part of it, replaced."""
    source = textwrap.dedent(inspect.getsource(function))
    count = sum(isinstance(node, ast.expr) for node in ast.walk(ast.parse(source)))
    for at in range(count):
        for made in ("None", "not {}"):
            tree = ast.parse(source)
            tree.body[0].decorator_list = []
            swap = _Swap(at, made)
            swap.visit(tree)
            if swap.told:
                names = {**function.__globals__}
                exec(compile(ast.fix_missing_locations(tree), "<changed>", "exec"), names)  # noqa: S102
                yield swap.told, names[function.__name__]


class _Swap(ast.NodeTransformer):
    """Replaces the result number `at`, or the part of a result, by what is made of it."""

    def __init__(self, at: int, made: str) -> None:
        self._at, self._made = at, made
        self._returns = self._passed = 0
        self.told = ""

    def visit_Return(self, node: ast.Return) -> ast.AST:
        self._returns += 1
        node = self.generic_visit(node)
        self._returns -= 1
        return node

    def visit(self, node: ast.AST) -> ast.AST:
        if not self._returns or not isinstance(node, ast.expr):
            return super().visit(node)
        self._passed += 1
        if self._passed != self._at + 1 or isinstance(node, ast.Constant | ast.Name):
            return super().visit(node)
        old = ast.unparse(node)
        made = self._made.format(f"({old})")
        self.told = f"{old} -> {made}"
        return ast.parse(made, mode="eval").body


def found(name: str, change: Callable[[], None]) -> bool:
    """Tell whether the tests fail with a change."""
    child = os.fork()
    if child == 0:
        silence = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        change()
        os._exit(pytest.main([*OPTIONS, *_files(name)]) == 0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def _files(change: str) -> list[str]:
    """Return the tests, those of the changed module first.

    The page of a policy shows its table, so any change would make it stale: that does not count.
    """
    paths = (path for path in TESTS.glob("test_*.py") if path.stem != "test_policy_tables")
    return [str(path) for path in sorted(paths, key=lambda path: (not _about(path, change), path))]


def _about(path: Path, change: str) -> bool:
    return f".{path.stem.removeprefix('test_')}" in change


def main() -> int:
    """Make every change."""
    if pytest.main([*OPTIONS, *_files("")]):
        print("the tests fail as it is", file=sys.stderr)
        return 2
    made = missed = 0
    for name, change in changes():
        made += 1
        if not found(name, change):
            missed += 1
            print(f"not found: {name}", flush=True)
    print(f"{made - missed} of {made} changes are found")
    return int(made - missed < LEAST_FOUND * made)


if __name__ == "__main__":
    sys.exit(main())
