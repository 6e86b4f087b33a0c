"""Which ROS distribution a workspace is for, guessed from its files and never from the machine."""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import path_exists
from rtron.sources.bounded_file import read_regular_file

_DISTRIBUTIONS: Mapping[int, tuple[str, ...]] = {
    1: ("hydro", "indigo", "jade", "kinetic", "lunar", "melodic", "noetic"),
    2: (
        *("rolling", "ardent", "bouncy", "crystal", "dashing", "eloquent", "foxy"),
        *("galactic", "humble", "iron", "jazzy", "kilted", "lyrical"),
    ),
}
"""The distributions of each ROS by release (docs.ros.org: Distributions), rolling before them."""
_BRANCH = (".git/HEAD", ".git")
"""A worktree and a submodule have a file `.git`, which says where their HEAD is."""
_REPOSITORIES = ("*.repos", ".rosinstall", "*.rosinstall")
_CI = (
    *(".github/workflows/*.yml", ".github/workflows/*.yaml", ".gitlab-ci.yml", ".travis.yml"),
    *(".circleci/config.yml", "Dockerfile", "*/Dockerfile", ".devcontainer/*"),
)
_MANIFESTS = ("package.xml", "*/package.xml", "*/*/package.xml")
_SOURCES = (_BRANCH, _REPOSITORIES, _CI, _MANIFESTS)
"""Files that name a distribution, those that tell most surely first."""
_MAX_BYTES = 1 << 20
_MAX_FILES = 200
_WORD = re.compile("[a-z]+")
_GIT_FOLDER = re.compile(r"gitdir: ([^\0\n]+)\n?")
_BRANCH_NAME = re.compile(r"refs/heads/(?:ros2?/)?([a-z]+)(?:-devel)?\s*$")
"""`humble-devel` and `ros2/jazzy` are of a distribution, `fix/rolling-window` is not."""
_CONDITION = re.compile(r"\$ROS_DISTRO\W+([a-z]+)")
"""A manifest says many words; of a distribution it speaks in conditions (REP 149)."""


@dataclass(frozen=True, slots=True)
class DistroGuess:
    """A distribution's name, and the file that names it."""

    name: str
    file: str


def guess_distro(folders: Sequence[Path], ros: int) -> DistroGuess | None:
    """Return the distribution that most files of the surest kind name; the later one of two."""
    tops = list(dict.fromkeys(top for folder in folders for top in _tops(folder.absolute())))
    for patterns in _SOURCES:
        named_in: dict[str, Path] = {}
        counts: Counter[str] = Counter()
        for file in _files(tops, patterns):
            for name in _names(file, _DISTRIBUTIONS[ros]):
                counts[name] += 1
                named_in.setdefault(name, file)
        if counts:
            name = max(counts, key=lambda each: (counts[each], _DISTRIBUTIONS[ros].index(each)))
            return DistroGuess(name, _shown(named_in[name], tops))
    return None


def _tops(folder: Path) -> Iterator[Path]:
    """Yield a folder, its repository where it lies in one, and the folders in it."""
    yield folder
    for above in folder.parents:
        if path_exists(above / ".git"):
            yield above
            break
    yield from sorted(each for each in folder.glob("*") if each.is_dir())[:_MAX_FILES]


def _files(tops: Iterable[Path], patterns: Sequence[str]) -> Iterator[Path]:
    found = (file for top in tops for pattern in patterns for file in sorted(top.glob(pattern)))
    for _, file in zip(range(_MAX_FILES), dict.fromkeys(found), strict=False):
        yield file


def _names(file: Path, known: Sequence[str]) -> set[str]:
    """Return the distributions that a file names: `robot.jazzy.repos` is of the one in its name."""
    is_list = file.suffix in {".repos", ".rosinstall"}
    if is_list and (named := set(_WORD.findall(file.name)).intersection(known)):
        return named
    try:
        text = _text(file)
    except InputError:
        return set()
    return set(_pattern(file).findall(text)) & set(known)


def _text(file: Path) -> str:
    """Return the text of a file, for a `.git` that of the HEAD which it leads to."""
    text = read_regular_file(file, _MAX_BYTES).decode("utf-8", errors="replace")
    folder = _GIT_FOLDER.fullmatch(text) if file.name == ".git" else None
    return _text(file.parent / folder[1] / "HEAD") if folder else text


def _pattern(file: Path) -> re.Pattern[str]:
    if file.name == "package.xml":
        return _CONDITION
    return _BRANCH_NAME if file.name in {"HEAD", ".git"} else _WORD


def _shown(file: Path, tops: Sequence[Path]) -> str:
    above = next(top for top in tops if file.is_relative_to(top))
    return str(file.relative_to(above.parent))
