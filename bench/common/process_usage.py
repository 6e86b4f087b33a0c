"""The processor time and the memory of a process, from /proc."""

from pathlib import Path


def processor_ns(pid: int) -> int:
    """Return the processor time that the threads of a process have used, ns."""
    threads = Path(f"/proc/{pid}/task").iterdir()
    return sum(int((each / "schedstat").read_text().split()[0]) for each in threads)


def resident_mb(pid: int) -> float:
    """Return the resident memory of a process, MB."""
    return _status_mb(pid, "VmRSS:")


def peak_resident_mb(pid: int) -> float:
    """Return the largest resident memory that a process has had, MB."""
    return _status_mb(pid, "VmHWM:")


def _status_mb(pid: int, key: str) -> float:
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith(key):
            return int(line.split()[1]) * 1024 / 1e6
    raise ProcessLookupError(f"process {pid} has no memory")
