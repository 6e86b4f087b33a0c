"""`$(eval …)` of ROS 2 and PythonExpression: roslaunch's closed grammar, with sets and loops.

launch hands the text to Python's own eval; here it is parsed and walked. Every value on the way is
bounded, and so is how often a comprehension runs (docs.ros.org: launch substitutions).
"""

import ast
from collections.abc import Iterator, Mapping
from functools import partial

from rtron.sources.launch.expression import Walk, evaluate_with
from rtron.sources.launch.expression_words import FUNCTIONS, METHODS, Function, Value, bounded
from rtron.sources.launch.unresolvable import UnresolvableError

MAX_ROUNDS = 256

_FUNCTIONS: Mapping[str, Function] = {
    "all": all,
    "any": any,
    "dict": dict,
    "set": set,
    "tuple": tuple,
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
    return str(bounded(str(evaluate_with(_Walk({**FUNCTIONS, **_FUNCTIONS}, _no_name), text))))


def _no_name(name: str) -> Value:
    raise KeyError(name)


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
        method = self._method(node)
        return super()._unknown(node) if method is None else method

    def _method(self, node: ast.expr) -> Function | None:
        if not isinstance(node, ast.Attribute):
            return None
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
