#!/usr/bin/env bash
# The tests of policies, plans, messages and wire in a Debian for arm64, which qemu runs: as root, with
# debootstrap and qemu-user-static. Debian is kept in build/arm64, or in the folder RTRON_ARM64.
set -euo pipefail
cd "$(dirname "$0")/.."
root=${RTRON_ARM64:-build/arm64}
packages=(pytest pytest-timeout hypothesis jsonschema numpy)
tests=(tests/policies tests/planning tests/messages tests/wire tests/coherence)

give_up() {
  printf 'test-arm64: %s\n' "$@" >&2
  exit 1
}

[ "$(id -u)" -eq 0 ] || give_up "debootstrap and chroot need root"
command -v debootstrap >/dev/null || give_up "run: apt-get install debootstrap qemu-user-static"
[ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || give_up "the kernel does not know qemu for arm64" \
  "run: apt-get install binfmt-support qemu-user-static; update-binfmts --enable qemu-aarch64"

if [ ! -x "$root/usr/bin/python3" ]; then
  mkdir -p "$root"
  debootstrap --arch=arm64 --variant=minbase --include=python3,python3-venv \
    bookworm "$root"
fi
# The wheels are fetched from here, so that Debian needs no network.
python=$(chroot "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
printf '%s\n' "${packages[@]}" cel-python | .venv/bin/uv pip compile -q pyproject.toml - --extra service \
  -c requirements.lock --python-version "$python" --python-platform aarch64-manylinux_2_28 \
  --only-binary :all: -o "$root/wheels.txt"
.venv/bin/python -m pip download -qq --disable-pip-version-check --no-deps --dest "$root/wheels" \
  --only-binary=:all: --implementation cp --python-version "$python" \
  --platform manylinux_2_28_aarch64 --platform manylinux_2_26_aarch64 \
  --platform manylinux2014_aarch64 --platform manylinux_2_17_aarch64 -r "$root/wheels.txt"
[ -x "$root/venv/bin/pip" ] || chroot "$root" python3 -m venv --clear /venv  # pip comes last
chroot "$root" /venv/bin/pip install -qq --no-index --find-links /wheels -r /wheels.txt
rm -rf "$root/rtron"
mkdir "$root/rtron"
tar -c --exclude=__pycache__ src tests scripts docs pyproject.toml README.md | tar -x -C "$root/rtron"
echo "127.0.0.1 localhost" >"$root/etc/hosts"
# It has a /proc of its own. What needs roslaunch does not run: ROS 1 is not in there.
PYTHONPATH=src unshare --mount --root="$root" --wd=/rtron --mount-proc \
  /venv/bin/python -m pytest -q -m "not ros2 and not long and not timed" \
  --ignore=tests/planning/instrument/ros1 --timeout=0 -p no:cacheprovider "${tests[@]}" "$@"
