"""How the processes of a guarded launch get their enclaves: a script that starts each of them.

It stands in front of a process's command, as launch's `launch-prefix`, and needs a shell and
util-linux alone. `bwrap` would stay between launch and the process, and does not hand on the signal
with which launch ends it.
"""

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

ENCLAVE_SCRIPT = "enclave"
_TABLE = "enclaves"
_TEMPLATE = "enclave.sh.in"


@dataclass(frozen=True, slots=True, kw_only=True)
class Enclaves:
    """A keystore, and the enclaves in it: by node, a name or a pattern, and by PACKAGE/PROGRAM.

    The programs are for processes whose command does not name their node.
    """

    keystore: Path
    of_nodes: Mapping[str, str]
    of_programs: Mapping[str, str]

    def texts(self) -> dict[str, str]:
        """Return the files of the launch's folder by name."""
        template = files("rtron.planning.instrument.ros2").joinpath(_TEMPLATE).read_text()
        script = template.replace("__KEYSTORE__", shlex.quote(str(self.keystore)))
        names_first = sorted(self.of_nodes, key=lambda node: ("*" in node, node))
        rows = [
            *(f"node {node} {self.of_nodes[node]}\n" for node in names_first),
            *(f"program {name} {each}\n" for name, each in sorted(self.of_programs.items())),
        ]
        return {ENCLAVE_SCRIPT: script, _TABLE: "".join(rows)}

    def environment(self) -> Mapping[str, str]:
        """Return the variables with which nobody joins the domain without a certificate."""
        return {
            "ROS_SECURITY_ENABLE": "true",
            "ROS_SECURITY_STRATEGY": "Enforce",
            "ROS_SECURITY_KEYSTORE": str(self.keystore),
        }
