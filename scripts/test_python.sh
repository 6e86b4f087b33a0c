#!/usr/bin/env bash
# test_python.sh VERSION: the tests that need no ROS 2, on another Python, with what the lock file names.
set -euo pipefail
cd "$(dirname "$0")/.."
version=$1
shift

# find_python: a Python of this version, of the path or of pyenv.
find_python() {
  local python
  for python in "python$version" "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$version".*/bin/python; do
    "$python" -c "import sys, ensurepip; sys.exit('%d.%d' % sys.version_info[:2] != '$version')" \
      2>/dev/null && { echo "$python"; return; }
  done
  echo "test-pythons: no Python $version found that can make a virtual environment" >&2
  exit 1
}

venv=build/python-$version
[ -x "$venv/bin/python" ] || "$(find_python)" -m venv "$venv"
if [ "$(cat "$venv/.ready" 2>/dev/null)" != "$(sha256sum requirements.lock)" ]; then
  "$venv/bin/python" -m pip install -qq --disable-pip-version-check --require-hashes -r requirements.lock
  sha256sum requirements.lock >"$venv/.ready"
fi
site=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
echo "$PWD/src" >"$site/rtron.pth" # tests start `python -m rtron` in other folders and environments
echo "test-pythons: $("$venv/bin/python" --version)"
"$venv/bin/python" -m pytest -m "not ros2 and not long" "$@"
