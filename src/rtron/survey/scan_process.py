"""The process that scans one app: `python -m rtron.survey.scan_process FOLDER LAUNCH_FILE`.

It prints the graph of the app as JSON. If there is none it prints why, and ends with NO_GRAPH.
"""

import json
import shlex
import sys

from rtron.errors import RTronError
from rtron.sources.graph_json import graph_to_json
from rtron.workflows.app_selection import AppSelection, select_app
from rtron.workflows.source_app import SourceOptions

NO_GRAPH = 2


def _main(folder: str, launch: str) -> int:
    source = SourceOptions(launches=(shlex.quote(launch),), jobs=1)
    try:
        app = select_app(AppSelection(inputs=(folder,), live=None, source=source))
        json.dump(graph_to_json(app.source.read()), sys.stdout)
    except RTronError as error:
        sys.stdout.write(str(error))
        return NO_GRAPH
    return 0


if __name__ == "__main__":
    sys.exit(_main(*sys.argv[1:]))
