"""Pages that stand alone: their scripts and style inside them, and allowed by their hashes."""

import json
from base64 import b64encode
from functools import cache
from hashlib import sha256
from importlib.resources import files
from typing import Any

_UNSAFE = {ord(character): f"\\u{ord(character):04x}" for character in "<>&"}


def policy(scripts: tuple[str, ...], style: str) -> str:
    """Return a Content-Security-Policy that allows these scripts, this style and no network."""
    allowed = " ".join(map(_hash, scripts))
    return (
        f"default-src 'none'; script-src {allowed}; style-src {_hash(style)}; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


@cache
def page_text(name: str) -> str:
    """Return a part of a page; raise FileNotFoundError if there is none of that name."""
    return (files("rtron.reports") / "page" / name).read_text(encoding="utf-8")


def inline_json(value: Any) -> str:  # noqa: ANN401 - plain JSON
    """Return JSON that ends no script and opens no comment, whatever the names in it are."""
    return json.dumps(value, separators=(",", ":")).translate(_UNSAFE)


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
