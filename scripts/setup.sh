#!/usr/bin/env bash
# Installs what RTron needs: Debian's ROS 1 packages, then .venv, and .venv-ros2 for all that runs on
# ROS 2, whose wheels change the library path of every Python beside them. Does nothing when all is
# there. `setup.sh demo` makes .venv-ros2 alone, which needs no root.
set -euo pipefail
cd "$(dirname "$0")/.."

RUN_PACKAGES=(
  python3-venv python3-rospy python3-roslaunch python3-rosmaster python3-rosnode python3-rosparam
  python3-rostopic rosout topic-tools
  python3-diagnostic-msgs python3-geometry-msgs python3-nav-msgs python3-sensor-msgs
  python3-std-msgs python3-tf2-msgs
)
TEST_PACKAGES=(
  chromium chromium-driver fonts-dejavu-core g++ graphviz haproxy libactionlib-dev libgeometry-msgs-dev
  libroscpp-dev libstd-msgs-dev make pkg-config postgresql python3-actionlib
)

ROS2_BELOW=3.14 # the wheels of ROS 2 are for Python 3.10 to 3.13

installed() {
  dpkg-query -W -f '${db:Status-Status}\n' "$1" 2>/dev/null | grep -qx installed
}

missing_packages() {
  local package
  for package in "${RUN_PACKAGES[@]}" "${TEST_PACKAGES[@]}"; do
    installed "$package" || echo "$package"
  done
}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  else
    sudo "$@"
  fi
}

may_install() {
  [ "$(id -u)" -eq 0 ] || { command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; }
}

give_up() {
  printf 'setup: %s\n' "$@" >&2
  exit 1
}

install_packages() {
  command -v dpkg-query >/dev/null || give_up "this is not Debian or Ubuntu" \
    "install ROS 1 (rospy, roslaunch, rosmaster, topic_tools) and Python >= 3.10 by hand," \
    "then: python3 -m venv .venv && .venv/bin/pip install -r requirements.lock -e ."
  local missing
  mapfile -t missing < <(missing_packages)
  [ "${#missing[@]}" -eq 0 ] && return
  may_install || give_up "Debian packages are missing, and only root may install them" \
    "run: sudo apt-get install --no-install-recommends ${missing[*]}" "then run this again"
  echo "setup: installing ${missing[*]}"
  as_root apt-get update -q || echo "setup: the package lists could not be renewed" >&2
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -qy --no-install-recommends "${missing[@]}" || give_up \
    "apt-get could not install them: is this Debian 12 or later, or Ubuntu 22.04 or later?" \
    "on Ubuntu they are in 'universe': sudo add-apt-repository universe"
}

# find_python BELOW FIRST: the first Python that is at least 3.10, below BELOW, and can make a venv.
find_python() {
  local python fits="import sys, venv, ensurepip
sys.exit(not (3, 10) <= sys.version_info < tuple(map(int, '$1'.split('.'))))"
  for python in "${PYTHON:-$2}" python3 /usr/bin/python3; do
    "$python" -c "$fits" 2>/dev/null && { echo "$python"; return; }
  done
  give_up "no Python >= 3.10 and < $1 found that can make a virtual environment" \
    "on Debian and Ubuntu: sudo apt-get install python3-venv" \
    "or set PYTHON to another, for example: PYTHON=python3.12 make setup"
}

wanted_state() {
  sha256sum "$1" pyproject.toml scripts/setup.sh
  pwd
}

# make_venv FOLDER LOCK BELOW FIRST: have a virtual environment of a Python below BELOW, of FIRST where
# that is there, with all that a lock file names, and RTron.
make_venv() {
  local folder=$1 lock=$2 below=$3 first=$4
  if [ "$(cat "$folder/.ready" 2>/dev/null)" = "$(wanted_state "$lock")" ]; then
    return
  fi
  if ! "$folder/bin/python" -m pip --version >/dev/null 2>&1; then
    local python
    python=$(find_python "$below" "$first")
    echo "setup: making $folder with $("$python" --version)"
    "$python" -m venv --clear "$folder"
  fi
  echo "setup: installing what $lock names"
  install_locked "$folder/bin/python" "$lock"
  wanted_state "$lock" >"$folder/.ready"
}

# locked NAME LOCK: what a lock file says of one package.
locked() {
  awk -v name="$1" '/^[^ ]/ { ours = index($0, name "==") == 1 } ours' "$2"
}

# install_locked PYTHON LOCK: all that a lock file names, and RTron; by pip alone where uv does not reach the
# index that pip's configuration names.
install_locked() {
  local python=$1 lock=$2
  local pip=("$python" -m pip install -qq --disable-pip-version-check)
  "${pip[@]}" -r <(locked uv "$lock")
  "$python" -m uv pip install -q --python "$python" -r "$lock" || {
    echo "setup: uv could not; pip takes a few minutes"
    "${pip[@]}" -r "$lock"
  }
  "${pip[@]}" --no-deps -e .
}

has_ros2_wheels() {
  [ "$(uname -m)" = x86_64 ]
}

if [ "${1:-}" = demo ]; then
  has_ros2_wheels || give_up "there are no wheels of ROS 2 for $(uname -m)" \
    "with a ROS of your own: make setup, then .venv/bin/rtron demo all"
  make_venv .venv-ros2 requirements-ros2.lock $ROS2_BELOW python3
  exit
fi
install_packages
# Distributions optimise their Python; with one built by hand the tests take an eighth longer.
make_venv .venv requirements.lock 4 /usr/bin/python3
if has_ros2_wheels; then
  make_venv .venv-ros2 requirements-ros2.lock $ROS2_BELOW /usr/bin/python3
else
  echo "setup: no wheels of ROS 2 for $(uname -m): its tests are left out"
fi
