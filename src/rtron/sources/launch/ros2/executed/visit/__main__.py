"""`python FOLDER REQUEST.json`: visit a launch file, and write what would start."""

import importlib
import importlib.util
import sys
from pathlib import Path

_NAME = "rtron_visit"


def _as_package(folder: Path) -> None:
    """Make the modules of this folder a package, without the folder being looked into by others."""
    sys.path[:] = [entry for entry in sys.path if not entry or Path(entry).resolve() != folder]
    inside = [str(folder)]
    path = folder / "__init__.py"
    spec = importlib.util.spec_from_file_location(_NAME, path, submodule_search_locations=inside)
    if spec is None:
        raise ImportError(str(path))
    sys.modules[_NAME] = importlib.util.module_from_spec(spec)


if __name__ == "__main__":
    _as_package(Path(__file__).resolve().parent)
    importlib.import_module(f"{_NAME}.visitor").main(sys.argv[1])
