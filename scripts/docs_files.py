"""Write the pages of the rules and the policies, and the schemas, which are made from the code.

With --check, write nothing, name the files that are stale and exit 1 if there are any.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path

import docs_policies
import docs_rules
import docs_schemas


def stale(documents: Mapping[Path, str]) -> dict[Path, str]:
    """Return what should stand in each file that does not."""
    return {
        path: text
        for path, text in documents.items()
        if not path.exists() or path.read_text(encoding="utf-8") != text
    }


def main() -> int:
    """Write the stale files, or name them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing, exit 1 if stale")
    check = parser.parse_args().check
    sources = (docs_rules, docs_policies, docs_schemas)
    found = stale({path: text for each in sources for path, text in each.documents().items()})
    for path, text in found.items():
        if check:
            print(f"{path} is stale: run make docs", file=sys.stderr)
        else:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
    return 1 if check and found else 0


if __name__ == "__main__":
    sys.exit(main())
