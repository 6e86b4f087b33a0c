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
from rtron.sources.launch.common.expression import ExpressionEvaluator, evaluate_with
from rtron.sources.launch.common.expression_library import (
    CONSTANTS,
    FUNCTIONS,
    METHODS,
    Function,
    Value,
    check_size,
)

MAX_ITERATIONS = 256

_FUNCTIONS: Mapping[str, Function] = {
    "all": all,
    "any": any,
    "dict": dict,
    "set": set,
    "tuple": tuple,
}
_EXTRA_MATH = "cosh expm1 gcd isclose isfinite log1p log2 remainder sinh tanh"
_MATH_NAMES: Mapping[str, Value] = {
    **{n: v for n, v in {**FUNCTIONS, **CONSTANTS}.items() if getattr(math, n, None) is v},
    **{name: getattr(math, name) for name in _EXTRA_MATH.split()},
}
_SET_METHODS: Mapping[str, Function] = {
    name: getattr(set, name)
    for name in ("difference", "intersection", "issubset", "issuperset", "union")
}
_LIST_METHODS: Mapping[str, Function] = {name: getattr(list, name) for name in ("count", "index")}
_DICT_METHODS: Mapping[str, Function] = {
    name: getattr(dict, name) for name in ("get", "items", "keys", "values")
}
_TEXT_METHODS: Mapping[str, Function] = {
    **METHODS,
    "isnumeric": str.isnumeric,
    "partition": str.partition,
    "removeprefix": str.removeprefix,
    "removesuffix": str.removesuffix,
}
_METHODS: Mapping[type, Mapping[str, Function]] = {
    dict: _DICT_METHODS,
    list: _LIST_METHODS,
    set: _SET_METHODS,
    str: _TEXT_METHODS,
}


def evaluate_python_expression(text: str) -> str:
    """Return the value of an expression as a string.

    Raise ValueError if launch could not evaluate it either, UnresolvableError outside the grammar.
    """
    return str(
        check_size(str(evaluate_with(_PythonEvaluator(_ALL_FUNCTIONS, _undefined_name), text)))
    )


def _undefined_name(name: str) -> Value:
    if hasattr(builtins, name):
        raise UnresolvableError(f"`{name}` is not of what is evaluated here")
    raise ValueError(f"the name '{name}' is not defined")


_ALL_FUNCTIONS: Mapping[str, Function] = {
    **FUNCTIONS,
    **_FUNCTIONS,
    **{name: value for name, value in _MATH_NAMES.items() if callable(value)},
}


class _PythonEvaluator(ExpressionEvaluator):
    """Evaluates one parsed expression; names may be those of comprehensions."""

    def __init__(self, functions: Mapping[str, Function], argument: Function) -> None:
        super().__init__(functions, self._name_value)
        self._names: dict[str, Value] = {}
        self._iterations = 0
        self._unknown_name = argument

    def _name_value(self, name: str) -> Value:
        return self._names[name] if name in self._names else self._unknown_name(name)

    def _unsupported(self, node: ast.expr) -> Value:
        if isinstance(node, ast.Set):
            return {self.value(item) for item in node.elts}
        if isinstance(node, (ast.ListComp, ast.GeneratorExp)):
            return list(self._comprehension(node.elt, node.generators))
        if isinstance(node, ast.SetComp):
            return set(self._comprehension(node.elt, node.generators))
        if not isinstance(node, ast.Attribute):
            return super()._unsupported(node)
        attribute = (
            self._module_attribute(node) if self._is_module(node.value) else self._method(node)
        )
        return super()._unsupported(node) if attribute is None else attribute

    def _function(self, node: ast.expr) -> Function:
        is_module = isinstance(node, ast.Attribute) and self._is_module(node.value)
        function: Function = self._unsupported(node) if is_module else super()._function(node)
        return function

    def _is_module(self, node: ast.expr) -> bool:
        """Tell whether a name can only be a module's: it is no other that is known here."""
        if isinstance(node, ast.Attribute):
            return self._is_module(node.value)
        known = {*CONSTANTS, *self._names}
        return isinstance(node, ast.Name) and not (node.id in known or hasattr(builtins, node.id))

    def _module_attribute(self, node: ast.Attribute) -> Value:
        if (
            isinstance(node.value, ast.Name)
            and node.value.id == "math"
            and node.attr in _MATH_NAMES
        ):
            return _MATH_NAMES[node.attr]
        module_name = ast.unparse(node.value)
        why = (
            "math has more than is known"
            if module_name == "math"
            else f"`{module_name}` is not looked into"
        )
        raise UnresolvableError(f"`{ast.unparse(node)}` is not evaluated: {why} here")

    def _method(self, node: ast.Attribute) -> Function | None:
        owner = self.value(node.value)
        method = _METHODS.get(type(owner), {}).get(node.attr)
        return partial(method, owner) if method is not None else None

    def _comprehension(self, item: ast.expr, loops: list[ast.comprehension]) -> Iterator[Value]:
        if not loops:
            yield self.value(item)
            return
        loop, *inner = loops
        for value in self.value(loop.iter):
            self._iterations += 1
            if self._iterations > MAX_ITERATIONS or not isinstance(loop.target, ast.Name):
                raise UnresolvableError(f"`{ast.unparse(item)}` in a loop is not evaluated here")
            self._names[loop.target.id] = value
            if all(map(self.value, loop.ifs)):
                yield from self._comprehension(item, inner)
