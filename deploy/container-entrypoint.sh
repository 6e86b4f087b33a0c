#!/bin/sh
# Runs rtron, in an image of ROS 2 with its environment; `exec` keeps the process that signals reach.
set -e
setup="/opt/ros/${ROS_DISTRO:-}/setup.sh"
if [ -n "${ROS_DISTRO:-}" ] && [ -f "$setup" ]; then
    # shellcheck disable=SC1090
    . "$setup"
fi
exec rtron "$@"
