"""Code that generate_parameter_library makes of a package's description of its parameters.

A node's class `ParamListener` declares the parameters, `get_params()` gives them as a struct. What
is written here does the same. Where the generated file would stand, the description stands.
"""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.code.ir import SourceLanguage
from rtron.yaml_safety import SAFE_LOADER, YamlRules, check_yaml, yaml_errors

DESCRIPTION_SUFFIXES = frozenset({".yaml", ".yml"})
_MAX_BYTES = 2**20
_RULES = YamlRules(max_depth=32, max_values=20_000)
_BUILD_FILES = ("CMakeLists.txt", "setup.py")
_CALL = re.compile(
    r"\bgenerate_parameter_(?:library|module)\(\s*[\"']?(?P<name>\w+)[\"']?\s*,?\s*"
    r"(?:#[^\n]*\n\s*)?[\"']?(?:\$\{\w+\}/)?(?P<file>[\w./-]+\.ya?ml)"
)
_NAME = re.compile(r"[A-Za-z_]\w*")
_NAMESPACE = re.compile(r"[A-Za-z_]\w*(?:::[A-Za-z_]\w*)*")
_CPP_TYPES = {"string": "std::string", "double": "double", "int": "int64_t", "bool": "bool"}
_PYTHON_TYPES = {"string": "STRING", "double": "DOUBLE", "int": "INTEGER", "bool": "BOOL"}


@dataclass(frozen=True, slots=True)
class DescribedParameter:
    """A parameter: the names that lead to it, the type of its value or items, its default."""

    path: tuple[str, ...]
    type: str
    is_array: bool
    default: object = None

    @property
    def name(self) -> str:
        """The name that the node declares."""
        return ".".join(self.path)


def described_libraries(package: Path) -> Mapping[str, Path]:
    """Return the descriptions that a package's build makes code of, by the name of that code."""
    found: dict[str, Path] = {}
    for name in _BUILD_FILES:
        try:
            text = read_regular_file(package / name, _MAX_BYTES).decode("utf-8", "replace")
        except InputError:
            continue
        found.update({call["name"]: package / call["file"] for call in _CALL.finditer(text)})
    return {name: path for name, path in found.items() if path.is_file()}


def generated_code(text: bytes, path: Path, language: SourceLanguage) -> bytes:
    """Return what is generated of a description; nothing of one that is none."""
    try:
        with yaml_errors(str(path)):
            check_yaml(text, str(path), _RULES)
            root = yaml.load(text, Loader=SAFE_LOADER)  # noqa: S506 - a safe loader
    except InputError:
        return b""
    parts = root.items() if isinstance(root, dict) else ()
    write = _cpp_code if language is SourceLanguage.CPP else _python_code
    made = (
        write(str(namespace), list(_parameters(groups, ())))
        for namespace, groups in parts
        if _NAMESPACE.fullmatch(str(namespace))
    )
    return "\n".join(made).encode()


def _parameters(groups: Any, above: tuple[str, ...]) -> Iterator[DescribedParameter]:  # noqa: ANN401 - any YAML
    """Yield the parameters of a group; those whose names other parameters hold are left out."""
    for name, inner in groups.items() if isinstance(groups, dict) else ():
        path = (*above, str(name))
        if not _NAME.fullmatch(str(name)) or str(name).startswith("__map_"):
            continue
        kind = inner.get("type") if isinstance(inner, dict) else None
        if isinstance(kind, str):
            plain = kind.partition("_")[0]
            if plain in _CPP_TYPES:
                yield DescribedParameter(path, plain, "_array" in kind, inner.get("default_value"))
        else:
            yield from _parameters(inner, path)


def _cpp_code(namespace: str, parameters: list[DescribedParameter]) -> str:
    declared = " ".join(map(_cpp_declaration, parameters))
    return (
        f"namespace {namespace} {{ {_cpp_struct('Params', parameters, 0)} "
        "class ParamListener { public: template <typename NodeT> "
        'ParamListener(NodeT node, const std::string & prefix = "") { std::string at = prefix; '
        f"if (!at.empty() && at.back() != '.') {{ at += \".\"; }} {declared} }} "
        "Params get_params() const { return params_; } "
        "bool is_old(const Params & other) const { return false; } Params params_; }; }"
    )


def _cpp_struct(name: str, parameters: list[DescribedParameter], depth: int) -> str:
    own = [p for p in parameters if len(p.path) == depth + 1]
    groups = dict.fromkeys(p.path[depth] for p in parameters if len(p.path) > depth + 1)
    fields = [f"{_cpp_type(p)} {p.path[depth]};" for p in own]
    for group in groups:
        inner = [p for p in parameters if len(p.path) > depth + 1 and p.path[depth] == group]
        fields.append(f"{_cpp_struct(f'{group}_group', inner, depth + 1)} {group}_group {group};")
    return f"struct {name} {{ {' '.join(fields)} }};"


def _cpp_type(parameter: DescribedParameter) -> str:
    plain = _CPP_TYPES[parameter.type]
    return f"std::vector<{plain}>" if parameter.is_array else plain


def _cpp_declaration(parameter: DescribedParameter) -> str:
    type, default = _cpp_type(parameter), parameter.default
    if isinstance(default, list):
        given = f", {type}{{{', '.join(map(_cpp_literal, default))}}}"
    else:
        given = "" if default is None else f", {_cpp_literal(default)}"
    name = f'at + "{parameter.name}"'
    return f"params_.{parameter.name} = node->template declare_parameter<{type}>({name}{given});"


def _cpp_literal(value: object) -> str:
    return json.dumps(value, default=str)


def _python_code(namespace: str, parameters: list[DescribedParameter]) -> str:
    groups = dict.fromkeys(p.path[:at] for p in parameters for at in range(1, len(p.path)))
    made = [f"        self.params.{'.'.join(path)} = _Group()" for path in groups]
    declared = [f"        self.params.{p.name} = {_python_declaration(p)}" for p in parameters]
    return "\n".join(
        [
            "import rclpy",
            "class _Group: pass",
            "class ParamListener:",
            "    def __init__(self, node, prefix=''):",
            "        at = prefix + '.' if prefix and not prefix.endswith('.') else prefix",
            "        self.params = _Group()",
            *made,
            *declared,
            "    def get_params(self): return self.params",
            "    def is_old(self, other): return False",
            "    def refresh_dynamic_parameters(self): pass",
            f"class {namespace.rpartition('::')[2]}:",
            "    ParamListener = ParamListener",
            "    Params = _Group",
        ]
    )


def _python_declaration(parameter: DescribedParameter) -> str:
    type = f"{_PYTHON_TYPES[parameter.type]}{'_ARRAY' if parameter.is_array else ''}"
    default = _python_default(parameter)
    given = f"rclpy.Parameter.Type.{type}" if default is None else repr(default)
    return f"node.declare_parameter(at + '{parameter.name}', {given}).value"


def _python_default(parameter: DescribedParameter) -> object:
    """Return a default, whole numbers of a double as floats."""
    default = parameter.default
    if parameter.type != "double":
        return default
    if isinstance(default, list):
        return [float(item) if type(item) is int else item for item in default]
    return float(default) if isinstance(default, int) else default
