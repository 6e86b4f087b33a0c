"""Code that the grammar cannot read, given a form it can: macros of headers that were not read."""

import re

from rtron.sources.code.frontends.cpp.macros import CHARACTER, STRING, called

_CAPITALS = r"[A-Z][A-Z0-9_]{2,}"
_BUILT_IN = (
    "static|inline|virtual|explicit|extern|void|bool|char|short|int|long|unsigned|signed|float"
    "|double|auto|constexpr|template|friend|struct|class|std::"
)
_EXPORTED = re.compile(
    rf"\b(class|struct|union)(\s+){_CAPITALS}(?:\([^()]*\))?"
    r"(?=\s+[A-Za-z_][\w:]*(?:\s+final)?\s*(?:\{|:[^:]))"
)
_DECLARED = re.compile(rf"\b(class)(\s+){_CAPITALS}(?=\s+[A-Za-z_]\w*\s*;)")
_BEFORE_TYPE = re.compile(
    rf"^([ \t]*(?:(?:static|inline|virtual|extern)\s[ \t]*)?){_CAPITALS}"
    rf"(?=\s+(?:(?:{_BUILT_IN})\b|~))",
    re.MULTILINE,
)
_NAMED_EXPORT = re.compile(
    r"\b[A-Z][A-Z0-9_]*_(?:EXPORTS?|PUBLIC|API|DECL|LOCAL|VISIBLE)\b(?!\s*[(=,;)\]])"
)
_BEHIND_PARAMETERS = re.compile(rf"(\)(?:\s*const\b)?\s*){_CAPITALS}(?=\s*[;{{])")
_INSTANTIATED = re.compile(r"\btemplate\s+(?:class|struct)\s[^;{}]*;")
_STATEMENT = re.compile(rf"^[ \t]*{_CAPITALS}(?=[ \t]*\()", re.MULTILINE)
_MAX_UNCLOSED = 100
_BEFORE = re.compile(r"(?:\A|[;{}):])\s*\Z")
_BEHIND = re.compile(r"[ \t]*\n\s*(?:[\w~}]|\Z)")
_LAUNCH = re.compile(r"<<[ ]?<(?!<)[^<>;{}]*>>[ ]?>(?=\s*\()")
_C_NAME = re.compile(
    rf"{STRING}|{CHARACTER}"
    r"|\b(?P<name>class|new|delete|this|template|namespace|private|public|operator|try|catch|using)\b"
)


def mended(code: str, *, is_c: bool = False) -> str:
    """Return preprocessed code without what hinders the parser; its lines keep their numbers.

    Macros in front of types and between `class` and its name go, a macro call alone on its line
    gets a semicolon, explicit instantiations and the launch parameters of a CUDA kernel go; C may
    use the words of C++ as names.
    """
    code = _C_NAME.sub(_renamed, code) if is_c else _INSTANTIATED.sub(_newlines, code)
    code = _NAMED_EXPORT.sub("", code)
    code = _EXPORTED.sub(r"\1\2", code)
    code = _DECLARED.sub(r"\1\2", code)
    code = _BEFORE_TYPE.sub(r"\1", code)
    code = _BEHIND_PARAMETERS.sub(r"\1", code)
    code = _ended(code)
    return _LAUNCH.sub(_newlines, code) if "<<" in code else code


def _ended(code: str) -> str:
    """Return the code with a semicolon behind each macro call that stands as a statement."""
    out: list[str] = []
    copied = unclosed = 0
    for found in _STATEMENT.finditer(code):
        start = found.start()
        if start < copied or unclosed > _MAX_UNCLOSED:
            continue
        call = called(code, found.end())
        unclosed += call is None
        if (
            call
            and _BEHIND.match(code, call[1])
            and _BEFORE.search(code[max(start - 200, 0) : start])
        ):
            out += [code[copied : call[1]], ";"]
            copied = call[1]
    return "".join([*out, code[copied:]])


def _newlines(found: re.Match[str]) -> str:
    return "\n" * found.group().count("\n")


def _renamed(found: re.Match[str]) -> str:
    return f"{found.group()}_" if found["name"] else found.group()
