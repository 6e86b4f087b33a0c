"""What an import of Python brings: modules of the own package, and of folders in it (PEP 328)."""

import pytest
from file_tree import write
from ros2_runs import explicit_declarations, site

from rtron.sources.code.program_runner import run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.workspace import Workspace

MAIN = """import rclpy
{imported}


def main():
    rclpy.init()
    node = rclpy.create_node('n')
    {used}(node)
"""
MAKING = (
    "from std_msgs.msg import Bool\n\n\ndef make(node):\n    node.create_publisher(Bool, 'a', 1)\n"
)
TAKEN = "from .inner.parts import make\n"


@pytest.mark.parametrize(
    ("imported", "used", "files"),
    [
        ("from . import parts", "parts.make", {"__init__.py": "", "parts.py": MAKING}),
        ("from . import parts as p", "p.make", {"parts.py": MAKING}),
        ("from . import make", "make", {"__init__.py": TAKEN, "inner/parts.py": MAKING}),
        ("from .inner import parts", "parts.make", {"inner/parts.py": MAKING}),
        ("from .inner import parts", "parts.make",
         {"inner/__init__.py": "", "inner/parts.py": MAKING}),
        ("from p import parts", "parts.make", {"__init__.py": "", "parts.py": MAKING}),
        ("from p.inner import parts", "parts.make", {"__init__.py": "", "inner/parts.py": MAKING}),
        ("from .. import other", "other.make", {"../other.py": MAKING}),
        ("from ..p import parts", "parts.make", {"__init__.py": "", "parts.py": MAKING}),
        ("from . import p", "p.make", {"__init__.py": "", "p.py": MAKING, "../p.py": ""}),
    ],
)  # fmt: skip
def test_a_module_of_the_own_package_is_imported(tmp_path, imported, used, files):
    files = {"n.py": MAIN.format(imported=imported, used=used), **files}
    write(tmp_path / "p" / "p", files)
    workspace = Workspace({"p": tmp_path / "p"}, [tmp_path])
    program = tmp_path / "p" / "p" / "n.py"
    found = run_python(program, site(), WorkspaceSources(workspace), "main")
    assert explicit_declarations(found) == ["publish /ns/a std_msgs/msg/Bool"]


@pytest.mark.parametrize("dots", ["...", "." * 40])
def test_no_file_outside_of_the_packages_is_imported(tmp_path, dots):
    (tmp_path / "p" / "p").mkdir(parents=True)
    program = tmp_path / "p" / "p" / "n.py"
    program.write_text(MAIN.format(imported=f"from {dots} import stranger", used="stranger.make"))
    (tmp_path / "stranger.py").write_text(MAKING)
    workspace = Workspace({"p": tmp_path / "p"}, [tmp_path])
    found = run_python(program, site(), WorkspaceSources(workspace), "main")
    assert not [text for text in explicit_declarations(found) if "std_msgs" in text]
