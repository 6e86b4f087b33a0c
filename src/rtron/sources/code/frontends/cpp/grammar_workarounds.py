"""Code that the grammar cannot read, given a form it can: macros of headers that were not read."""

import re

from rtron.sources.code.frontends.cpp.macros import CHARACTER, STRING, call_arguments

_MACRO_NAME = r"[A-Z][A-Z0-9_]{2,}"
_BUILT_IN = (
    "static|inline|virtual|explicit|extern|void|bool|char|short|int|long|unsigned|signed|float"
    "|double|auto|constexpr|template|friend|struct|class|std::"
)
_EXPORTED = re.compile(
    rf"\b(class|struct|union)(\s+){_MACRO_NAME}(?:\([^()]*\))?"
    r"(?=\s+[A-Za-z_][\w:]*(?:\s+final)?\s*(?:\{|:[^:]))"
)
_DECLARED = re.compile(rf"\b(class)(\s+){_MACRO_NAME}(?=\s+[A-Za-z_]\w*\s*;)")
_BEFORE_TYPE = re.compile(
    rf"^([ \t]*(?:(?:static|inline|virtual|extern)\s[ \t]*)?){_MACRO_NAME}"
    rf"(?=\s+(?:(?:{_BUILT_IN})\b|~))",
    re.MULTILINE,
)
_NAMED_EXPORT = re.compile(
    r"\b[A-Z][A-Z0-9_]*_(?:EXPORTS?|PUBLIC|API|DECL|LOCAL|VISIBLE)\b(?!\s*[(=,;)\]])"
)
_AFTER_PARAMETERS = re.compile(rf"(\)(?:\s*const\b)?\s*){_MACRO_NAME}(?=\s*[;{{])")
_INSTANTIATED = re.compile(r"\btemplate\s+(?:class|struct)\s[^;{}]*;")
_STATEMENT = re.compile(rf"(?:^|(?<=\)))[ \t]*{_MACRO_NAME}(?=[ \t]*\()", re.MULTILINE)
_ADJACENT_CALLS = re.compile(rf"\)(?=[ \t]+{_MACRO_NAME}[ \t]*\()")
_MAX_UNCLOSED = 100
_STATEMENT_START = re.compile(r"(?:\A|[;{}):])\s*\Z")
_STATEMENT_END = re.compile(rf"[ \t]*\n\s*(?:[\w~}}]|\Z)|[ \t]+{_MACRO_NAME}[ \t]*\(")
_POINTED_MEMBER = re.compile(r"->\*(?=\s*[A-Za-z_])")
_NUMBERED_METHOD = re.compile(r"(?<=[\w)\]])(\.|->)(?=[A-Za-z_]\w*<\d+>\()")
_MAX_PARAMETERS = 2_000
_WORD_BEFORE = re.compile(r"(\w+)\s*\Z")
_BEFORE_CONDITIONS = {"if", "while", "for", "switch", "return", "sizeof", "catch", "constexpr"}
_KERNEL_LAUNCH = re.compile(r"<<[ ]?<(?!<)[^<>;{}]*>>[ ]?>(?=\s*\()")
_C_NAME = re.compile(
    rf"{STRING}|{CHARACTER}"
    r"|\b(?P<name>class|new|delete|this|template|namespace|private|public|operator|try|catch|using)\b"
)


def work_around_grammar(code: str, *, is_c: bool = False) -> str:
    """Return preprocessed code without what hinders the parser; its lines keep their numbers.

    Macros in front of types and between `class` and its name go, macro calls alone on their line
    get semicolons, explicit instantiations and the launch parameters of a CUDA kernel go;
    `p->*f` is read as `p.*f`, `v.emplace<1>(x)` as the call that it is; C may use the words of C++
    as names.
    """
    code = _C_NAME.sub(_rename_keyword, code) if is_c else _INSTANTIATED.sub(_newlines, code)
    code = _NAMED_EXPORT.sub("", code)
    code = _EXPORTED.sub(r"\1\2", code)
    code = _DECLARED.sub(r"\1\2", code)
    code = _BEFORE_TYPE.sub(r"\1", code)
    code = _AFTER_PARAMETERS.sub(_drop_behind_parameters, code)
    code = _end_macro_calls(_POINTED_MEMBER.sub(".*", code))
    code = _NUMBERED_METHOD.sub(r"\1template ", code)
    return _KERNEL_LAUNCH.sub(_newlines, code) if "<<" in code else code


def _end_macro_calls(code: str) -> str:
    """Return the code with a semicolon behind each macro call that stands as a statement."""
    out: list[str] = []
    copied = unclosed = 0
    for found in _STATEMENT.finditer(code):
        start = found.start()
        if start < copied or unclosed > _MAX_UNCLOSED:
            continue
        call = call_arguments(code, found.end())
        unclosed += call is None
        if (
            call
            and _STATEMENT_END.match(code, call[1])
            and _STATEMENT_START.search(code[max(start - 200, 0) : start])
        ):
            out += [code[copied : found.end()], _without_lists(code, found.end(), call), ";"]
            copied = call[1]
    return "".join([*out, code[copied:]])


def _without_lists(code: str, start: int, call: tuple[list[str], int]) -> str:
    """Return a call's arguments without those that are calls side by side, no expression."""
    args, end = call
    plain = [arg for arg in args if not _ADJACENT_CALLS.search(arg)]
    if len(plain) == len(args):
        return code[start:end]
    inner = ", ".join(plain)
    return f"({inner})" + "\n" * (code.count("\n", start, end) - inner.count("\n"))


def _drop_behind_parameters(found: re.Match[str]) -> str:
    """Drop a macro behind a function's parameters; what stands behind a cast or `if (…)` stays."""
    code, start = found.string, found.start()
    depth, at = 1, start - 1
    while depth and at > max(start - _MAX_PARAMETERS, -1):
        depth += {")": 1, "(": -1}.get(code[at], 0)
        at -= 1
    before = _WORD_BEFORE.search(code, max(at - 80, 0), at + 1)
    is_function = before is not None and before[1] not in _BEFORE_CONDITIONS
    return found[1] if is_function else found.group()


def _newlines(found: re.Match[str]) -> str:
    return "\n" * found.group().count("\n")


def _rename_keyword(found: re.Match[str]) -> str:
    return f"{found.group()}_" if found["name"] else found.group()
