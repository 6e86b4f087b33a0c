"""`${…}` as a closed grammar: launch's expressions, and what xacro's own may use besides.

xacro hands the text to Python's eval; here nothing is executed, and what lies outside the grammar
is unresolvable (ROS wiki: xacro, math expressions).
"""

import ast
import math
import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.common.expression import ExpressionEvaluator, NodeMethod
from rtron.sources.launch.common.expression_library import (
    FUNCTIONS,
    MAX_LENGTH,
    Function,
    Value,
    check_size,
)
from rtron.sources.xacro.budget import MAX_WEIGHT, EvaluationBudget
from rtron.sources.xacro.scopes import NamespaceView

_CONSTANTS: Mapping[str, Value] = {
    "e": math.e,
    "inf": math.inf,
    "nan": math.nan,
    "pi": math.pi,
    "tau": math.tau,
}
_DICT_METHODS = frozenset({"get", "items", "keys", "values"})


class XacroExpressionEvaluator(ExpressionEvaluator):
    """Evaluates one expression of a description; `name` gives a property and raises KeyError."""

    def __init__(
        self,
        functions: Mapping[str, Function],
        name: Callable[[str], Value],
        budget: EvaluationBudget,
    ) -> None:
        known = {**FUNCTIONS, **XACRO_FUNCTIONS, **functions}
        super().__init__(known, name)
        self._known, self._name, self._budget = known, name, budget
        self._locals: dict[str, Value] = {}

    def value(self, node: ast.expr) -> Value:
        """Return a value; raise UnresolvableError if it is too large to go on with."""
        value = check_size(self._value(node))
        self._budget.count_steps(value_weight(value))
        return value

    @NodeMethod
    def _value(self, node: ast.expr) -> Value:
        return super()._value(node)

    @_value.register
    def _(self, node: ast.Name) -> Value:
        if node.id in self._locals:
            return self._locals[node.id]
        try:
            return self._name(node.id)
        except KeyError:
            return self._global(node.id)

    @_value.register
    def _(self, node: ast.Attribute) -> Value:
        owner = self._module(node) or self.value(node.value)
        if isinstance(owner, (Mapping, NamespaceView)):
            return owner[node.attr]
        return self._unsupported(node)

    @_value.register
    def _(self, node: ast.ListComp) -> Value:
        outer = dict(self._locals)
        try:
            return [self.value(node.elt) for _ in self._rounds(node.generators)]
        finally:
            self._locals = outer

    @_value.register
    def _(self, node: ast.Call) -> Value:
        keywords = {str(word.arg): self.value(word.value) for word in node.keywords if word.arg}
        arguments = [self.value(argument) for argument in node.args]
        function = self._function(node.func)
        if keywords and function is not dict:
            self._unsupported(node)
        return function(*arguments, **keywords)

    def _function(self, node: ast.expr) -> Function:
        if not isinstance(node, ast.Attribute):
            return super()._function(node)
        module = self._module(node)
        if module is not None:
            return module[node.attr] if callable(module.get(node.attr)) else self._unsupported(node)
        if node.attr in _DICT_METHODS:
            owner = self.value(node.value)
            if isinstance(owner, dict):
                return partial(_call_dict_method, getattr(owner, node.attr))
        return super()._function(node)

    def _module(self, node: ast.Attribute) -> Mapping[str, Value] | None:
        """Return the names of `math`, `python` or `xacro` where an attribute is of one of them."""
        if isinstance(node.value, ast.Name) and node.value.id in {"math", "python", "xacro"}:
            return {**_CONSTANTS, **self._known}
        return None

    def _global(self, name: str) -> Value:
        if name in _CONSTANTS:
            return _CONSTANTS[name]
        if name in self._known:
            return self._known[name]
        raise ValueError(f"property '{name}' is not defined")

    def _rounds(self, generators: list[ast.comprehension]) -> Iterator[None]:
        if not generators:
            yield
            return
        for item in _iterable(self.value(generators[0].iter)):
            self._budget.count_steps()
            self._bind(generators[0].target, item)
            if all(self.value(condition) for condition in generators[0].ifs):
                yield from self._rounds(generators[1:])

    def _bind(self, target: ast.expr, item: Value) -> None:
        if isinstance(target, ast.Name):
            self._locals[target.id] = item
        elif isinstance(target, ast.Tuple):
            for part, value in zip(target.elts, _iterable(item), strict=True):
                self._bind(part, value)
        else:
            self._unsupported(target)


def value_weight(value: Value) -> int:
    """Return how many values stand in a value; raise UnresolvableError if too many.

    What is shared counts as often as it would be printed.
    """
    total, waiting = 0, [value]
    while waiting:
        item = waiting.pop()
        total += 1 + (len(item) // 64 if isinstance(item, str) else 0)
        if total > MAX_WEIGHT:
            raise UnresolvableError("an expression's value is too large")
        if isinstance(item, Mapping):
            waiting.extend(item.keys())
            waiting.extend(item.values())
        elif isinstance(item, (list, tuple)):
            waiting.extend(item)
    return total


def _call_dict_method(method: Function, *arguments: Value) -> Value:
    result = method(*arguments)
    return result if arguments else list(result)


def _iterable(value: Value) -> Value:
    if isinstance(value, (str, list, tuple, dict)):
        return value
    raise TypeError(f"'{type(value).__name__}' is not iterable")


def _range(*bounds: int) -> list[int]:
    numbers = range(*bounds)
    if len(numbers) > MAX_LENGTH:
        raise UnresolvableError("a range is too long")
    return list(numbers)


def _map(function: Function, *lists: Value) -> list[Value]:
    return [function(*items) for items in zip(*map(_iterable, lists), strict=False)]


def _tokenize(text: str, separators: str = ",; ") -> list[str]:
    return [token for token in re.split(f"[{re.escape(separators)}]", text) if token]


def _enumerate(values: Value) -> list[tuple[int, Value]]:
    return list(enumerate(_iterable(values)))


def _zip(*values: Value) -> list[tuple[Value, ...]]:
    return list(zip(*map(_iterable, values), strict=False))


XACRO_FUNCTIONS: Mapping[str, Function] = {
    "all": all,
    "any": any,
    "dict": dict,
    "dotify": lambda value: value,
    "enumerate": _enumerate,
    "map": _map,
    "range": _range,
    "tokenize": _tokenize,
    "tuple": tuple,
    "zip": _zip,
}
