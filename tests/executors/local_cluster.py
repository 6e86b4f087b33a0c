"""A Dask cluster of worker processes; run as a program, it lives until its input ends."""

import os
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

HERE = Path(__file__).parent
SINGLE_ATTEMPT = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
"""Each new try of what ended its worker takes a new worker, and seconds."""


@contextmanager
def local_cluster(workers=2):
    """Run a cluster and yield its address."""
    paths = [str(HERE), *filter(None, sys.path)]
    environment = {**os.environ, **SINGLE_ATTEMPT, "PYTHONPATH": os.pathsep.join(paths)}
    command = [sys.executable, "-W", "ignore", __file__, str(workers)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment, text=True
    ) as running:
        try:
            yield running.stdout.readline().strip()
        finally:
            running.stdin.close()


def main():
    import distributed  # noqa: PLC0415 - the extra may be absent where this is only imported

    with distributed.LocalCluster(
        n_workers=int(sys.argv[1]), threads_per_worker=1, dashboard_address=None, silence_logs=50
    ) as cluster:
        sys.stdout.write(f"{cluster.scheduler_address}\n")
        sys.stdout.flush()
        sys.stdin.read()


if __name__ == "__main__":
    main()
