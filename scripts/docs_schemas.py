"""Write schemas/*.json, the JSON Schemas that editors read, from the code that reads the files.

With --check, write nothing, name the schemas that are stale and exit 1 if there are any.
"""

import argparse
import json
import sys
from pathlib import Path

from rtron.bridge.rights.document import rights_json_schema
from rtron.planning.plan_file.json_schema import plan_json_schema
from rtron.sources.graph_json import graph_json_schema
from rtron.sources.ignores.config_file import config_json_schema
from rtron.workflows.scan import RULE_NAMES

SCHEMAS = Path(__file__).parent.parent / "schemas"


def stale(folder: Path) -> dict[Path, str]:
    """Return what should stand in each schema that does not."""
    documents = {
        "rtron.plan.json": plan_json_schema(),
        "rtron.graph.json": graph_json_schema(),
        "rtron.bridge.json": rights_json_schema(),
        "rtron.toml.json": config_json_schema(RULE_NAMES),
    }
    texts = {folder / name: f"{json.dumps(each, indent=2)}\n" for name, each in documents.items()}
    return {
        path: text
        for path, text in texts.items()
        if not path.exists() or path.read_text(encoding="utf-8") != text
    }


def main() -> int:
    """Write the stale schemas, or name them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing, exit 1 if stale")
    check = parser.parse_args().check
    found = stale(SCHEMAS)
    for path, text in found.items():
        if check:
            print(f"{path} is stale: run scripts/docs_schemas.py", file=sys.stderr)
        else:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
    return 1 if check and found else 0


if __name__ == "__main__":
    sys.exit(main())
