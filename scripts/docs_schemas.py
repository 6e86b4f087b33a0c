"""The text of schemas/*.json, which editors read, from the code that reads the files."""

import json
from pathlib import Path

from rtron.bridge.rights.document import rights_json_schema
from rtron.planning.plan_file.json_schema import plan_json_schema
from rtron.sources.graph_json import graph_json_schema
from rtron.sources.ignores import config_json_schema
from rtron.workflows.scan import RULE_NAMES

SCHEMAS = Path(__file__).parent.parent / "schemas"


def documents(folder: Path = SCHEMAS) -> dict[Path, str]:
    """Return what stands in each schema."""
    schemas = {
        "rtron.plan.json": plan_json_schema(),
        "rtron.graph.json": graph_json_schema(),
        "rtron.bridge.json": rights_json_schema(),
        "rtron.toml.json": config_json_schema(RULE_NAMES),
    }
    return {folder / name: f"{json.dumps(each, indent=2)}\n" for name, each in schemas.items()}
