"""YAML from anywhere, taken apart: bounded in size and depth, without aliases, anchors and tags."""

from pathlib import Path

import yaml

from rtron.errors import PlanError
from rtron.yaml_safety import YamlRules, compose_yaml

MAX_BYTES = 2**20
_RULES = YamlRules(max_depth=20, allows_tags=False, refusal="a plan has no", error=PlanError)


def read_text(path: Path) -> str:
    """Return a plan's text; raise PlanError if it cannot be read or is too large."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        text = data.decode("utf-8")
    except OSError as error:
        why = error.strerror or "cannot be read"
        raise PlanError(why, path=str(path), help="`rtron plan` writes one") from None
    except UnicodeDecodeError:
        raise PlanError("not UTF-8 text", path=str(path)) from None
    if len(data) > MAX_BYTES:
        raise PlanError(f"larger than {MAX_BYTES} bytes", path=str(path))
    return text


def parse_yaml(text: str, path: str) -> yaml.Node:
    """Return the tree of a YAML text with its lines; raise PlanError if it is none or unsafe."""
    root = compose_yaml(text, path, _RULES)
    if root is None:
        raise PlanError("the plan is empty", path=path, help="`rtron plan` writes one")
    return root
