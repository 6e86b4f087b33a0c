"""The processes of a machine as /proc shows them: made by hand, file by file (proc(5))."""

from shutil import rmtree

from rtron.guard.transport.ros2.process_table import ProcessTable

FIRST_NAMESPACE, ANOTHER = "pid:[4026531836]", "pid:[4026532198]"
OUR_NETWORK, THEIR_NETWORK = "net:[4026531840]", "net:[4026532281]"
FAST_DDS = "7f00-7f01 r-xp 00000000 08:02 17 /opt/ros/jazzy/lib/libfastdds.so.3.2\n"
LIBC = "7f00-7f01 r-xp 00000000 08:02 18 /usr/lib/libc.so.6\n"


class ProcFolder:
    """A machine with its first process, and us among them."""

    def __init__(self, folder, *, namespace=FIRST_NAMESPACE):
        self.proc = folder
        self._link("self", "pid", namespace)
        self._link("self", "net", OUR_NETWORK)
        self.start(1, maps=LIBC)

    def processes(self):
        return ProcessTable(self.proc)

    def start(
        self, pid, *, own=(), began=7, maps=FAST_DDS, network=OUR_NETWORK, state="S", threads=9
    ):
        """Let a process run; `own` are the ids that it has in containers, from outside inwards."""
        place = self.proc / str(pid)
        place.mkdir(exist_ok=True)
        ids = "\t".join(map(str, (pid, *own)))
        (place / "status").write_text(f"Name:\tnode\nState:\t{state}\nNSpid:\t{ids}\nThreads:\t9\n")
        fields = [state, 1, *[0] * 15, threads, 0, began, 0]
        (place / "stat").write_text(f"{pid} (a node) {' '.join(map(str, fields))}\n")
        (place / "maps").write_text(maps)
        self._link(str(pid), "net", network)

    def end(self, pid):
        rmtree(self.proc / str(pid))

    def _link(self, who, kind, target):
        place = self.proc / who / "ns"
        place.mkdir(parents=True, exist_ok=True)
        (place / kind).unlink(missing_ok=True)
        (place / kind).symlink_to(target)
