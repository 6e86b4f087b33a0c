"""No process lives on when the one that started it was killed."""

import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from harness import lives, wait_for

INTERPRETING = """
from rtron.sources.declaration import NodeSite
from rtron.sources.static.common.worker_pool import WorkerPool
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.sources.workspace import read_workspace
folder = Path(sys.argv[1])
pool = WorkerPool(read_workspace([folder], {}), 1, 60)
site = NodeSite(name="/n")
task = InterpretationTask(kind=TaskKind.PYTHON, sources=(folder,), site=site)
list(pool.run_tasks([task]))
for process in pool._executor._processes:
    (folder / str(process)).touch()
sys.stdin.read()
"""


def test_processes_end_when_the_one_that_started_them_is_killed(tmp_path):
    code = f"import sys\nfrom pathlib import Path\n{INTERPRETING}"
    started = lambda: [int(path.name) for path in tmp_path.iterdir()]  # noqa: E731
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        cwd=Path(__file__).parent,
        stdin=subprocess.PIPE,
    ) as starter:
        try:
            wait_for(lambda: len(started()) == 1)
            assert all(map(lives, started()))
            starter.kill()
            starter.wait()
            wait_for(lambda: not any(map(lives, started())))
        finally:
            starter.kill()
            for process in started():
                with suppress(ProcessLookupError):
                    os.kill(process, signal.SIGKILL)
