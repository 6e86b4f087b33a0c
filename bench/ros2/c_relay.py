"""The relay in C (`relay.c`): `python -m bench.ros2.c_relay LIBRARY MESSAGE FROM TO`.

Python only loads it: the wheels' libraries want a Python around them.
"""

import ctypes
import shutil
import signal
import subprocess
import sys
from pathlib import Path

from bench.common.testbed import Testbed
from bench.ros2.messages import DEPTH, MESSAGES


def relay_library(testbed: Testbed) -> Path:
    """Return the library of the relay, compiled on first use with the headers of the wheels."""
    library = testbed.folder / "librelay.so"
    if not library.exists():
        compiler = shutil.which("gcc") or "gcc"
        source = Path(__file__).with_name("relay.c")
        headers = [f"-I{each}" for each in Path(sys.prefix, "include").iterdir()]
        command = [compiler, "-O2", "-shared", "-fPIC", "-o", str(library), str(source), *headers]
        subprocess.run([*command, f"-L{Path(sys.prefix, 'lib')}", "-lrcl", "-lrmw"], check=True)
    return library


def main() -> None:
    """Relay until ended."""
    library, message, source, target = sys.argv[1:]
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    relay = ctypes.CDLL(library).relay
    code = relay(_type_support(message), source.encode(), target.encode(), ctypes.c_size_t(DEPTH))
    sys.exit(f"rcl cannot relay: error {code}")


def _type_support(message: str) -> ctypes.c_void_p:
    package, _, name = MESSAGES[message].type.split("/")
    library = ctypes.CDLL(f"lib{package}__rosidl_typesupport_c.so")
    symbol = f"rosidl_typesupport_c__get_message_type_support_handle__{package}__msg__{name}"
    find = getattr(library, symbol)
    find.restype = ctypes.c_void_p
    return ctypes.c_void_p(find())


if __name__ == "__main__":
    main()
