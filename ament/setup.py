# ruff: noqa: INP001 - beside the package
"""RTron as an `ament_python` package: the same code, where `ros2 run` and `ros2 launch` look.

Its Python requirements come with `pip install` of the repository: rosdep knows no fitting ones.
"""

import re
from pathlib import Path

from setuptools import find_packages, setup

NAME = "rtron"
CODE = Path(NAME).resolve()  # a link to ../src/rtron
FILES = [path for path in CODE.rglob("*") if path.is_file() and path.suffix != ".pyc"]
VERSION = re.search(r'__version__ = "(.+)"', (CODE / "__init__.py").read_text())[1]

setup(
    name=NAME,
    version=VERSION,
    packages=find_packages(),
    package_data={NAME: [str(path.relative_to(CODE)) for path in FILES]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/guard.launch.py"]),
    ],
    install_requires=["setuptools"],
    zip_safe=False,
    entry_points={
        "console_scripts": [
            "guard = rtron.cli.main:run_guard_node",
            "rtron = rtron.__main__:main",
        ],
        "ros2cli.command": ["rtron = rtron.cli.ros2_extension:RtronCommand"],
    },
)
