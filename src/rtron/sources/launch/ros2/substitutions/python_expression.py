"""`$(eval …)` of ROS 2 and PythonExpression: roslaunch's closed grammar, with sets and loops.

launch hands the text to Python's own eval, with the module math and its bare names, or with what
`python_modules` lists; here it is parsed and walked, and no other module is looked into. Every
value on the way is bounded, and so is how often a comprehension runs (docs.ros.org: launch
substitutions; github.com/ros2/launch, substitutions/python_expression.py).
"""

import ast
import builtins
import math
from collections.abc import Iterator, Mapping
from functools import partial

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import Walk, evaluate_with
from rtron.sources.launch.common.expression_library import (
    CONSTANTS,
    FUNCTIONS,
    METHODS,
    Function,
    Value,
    bounded,
)

MAX_ROUNDS = 256

_FUNCTIONS: Mapping[str, Function] = {
    "all": all,
    "any": any,
    "dict": dict,
    "set": set,
    "tuple": tuple,
}
_MORE_MATH = "cosh expm1 gcd isclose isfinite log1p log2 remainder sinh tanh"
_MATH: Mapping[str, Value] = {
    **{n: v for n, v in {**FUNCTIONS, **CONSTANTS}.items() if getattr(math, n, None) is v},
    **{name: getattr(math, name) for name in _MORE_MATH.split()},
}
_OF_SETS: Mapping[str, Function] = {
    name: getattr(set, name)
    for name in ("difference", "intersection", "issubset", "issuperset", "union")
}
_OF_LISTS: Mapping[str, Function] = {name: getattr(list, name) for name in ("count", "index")}
_OF_DICTS: Mapping[str, Function] = {
    name: getattr(dict, name) for name in ("get", "items", "keys", "values")
}
_OF_TEXTS: Mapping[str, Function] = {
    **METHODS,
    "isnumeric": str.isnumeric,
    "partition": str.partition,
    "removeprefix": str.removeprefix,
    "removesuffix": str.removesuffix,
}
_METHODS: Mapping[type, Mapping[str, Function]] = {
    dict: _OF_DICTS,
    list: _OF_LISTS,
    set: _OF_SETS,
    str: _OF_TEXTS,
}


def python_expression(text: str) -> str:
    """Return the value of an expression as a string.

    Raise ValueError if launch could not evaluate it either, UnresolvableError outside the grammar.
    """
    return str(bounded(str(evaluate_with(_Walk(_KNOWN, _no_name), text))))


def _no_name(name: str) -> Value:
    if hasattr(builtins, name):
        raise UnresolvableError(f"`{name}` is not of what is evaluated here")
    raise ValueError(f"the name '{name}' is not defined")


_KNOWN: Mapping[str, Function] = {
    **FUNCTIONS,
    **_FUNCTIONS,
    **{name: value for name, value in _MATH.items() if callable(value)},
}


class _Walk(Walk):
    """Evaluates one parsed expression; names may be those of comprehensions."""

    def __init__(self, functions: Mapping[str, Function], argument: Function) -> None:
        super().__init__(functions, self._named)
        self._names: dict[str, Value] = {}
        self._rounds = 0
        self._outer = argument

    def _named(self, name: str) -> Value:
        return self._names[name] if name in self._names else self._outer(name)

    def _unknown(self, node: ast.expr) -> Value:
        if isinstance(node, ast.Set):
            return {self.value(item) for item in node.elts}
        if isinstance(node, (ast.ListComp, ast.GeneratorExp)):
            return list(self._looped(node.elt, node.generators))
        if isinstance(node, ast.SetComp):
            return set(self._looped(node.elt, node.generators))
        if not isinstance(node, ast.Attribute):
            return super()._unknown(node)
        found = self._of_module(node) if self._is_module(node.value) else self._method(node)
        return super()._unknown(node) if found is None else found

    def _function(self, node: ast.expr) -> Function:
        is_module = isinstance(node, ast.Attribute) and self._is_module(node.value)
        found: Function = self._unknown(node) if is_module else super()._function(node)
        return found

    def _is_module(self, node: ast.expr) -> bool:
        """Tell whether a name can only be a module's: it is no other that is known here."""
        if isinstance(node, ast.Attribute):
            return self._is_module(node.value)
        known = {*CONSTANTS, *self._names}
        return isinstance(node, ast.Name) and not (node.id in known or hasattr(builtins, node.id))

    def _of_module(self, node: ast.Attribute) -> Value:
        if isinstance(node.value, ast.Name) and node.value.id == "math" and node.attr in _MATH:
            return _MATH[node.attr]
        where = ast.unparse(node.value)
        why = "math has more than is known" if where == "math" else f"`{where}` is not looked into"
        raise UnresolvableError(f"`{ast.unparse(node)}` is not evaluated: {why} here")

    def _method(self, node: ast.Attribute) -> Function | None:
        owner = self.value(node.value)
        method = _METHODS.get(type(owner), {}).get(node.attr)
        return partial(method, owner) if method is not None else None

    def _looped(self, item: ast.expr, loops: list[ast.comprehension]) -> Iterator[Value]:
        if not loops:
            yield self.value(item)
            return
        loop, *inner = loops
        for value in self.value(loop.iter):
            self._rounds += 1
            if self._rounds > MAX_ROUNDS or not isinstance(loop.target, ast.Name):
                raise UnresolvableError(f"`{ast.unparse(item)}` in a loop is not evaluated here")
            self._names[loop.target.id] = value
            if all(map(self.value, loop.ifs)):
                yield from self._looped(item, inner)
