#!/bin/sh
# Runs rtron, in an image of ROS 2 with its environment; `exec` keeps the process that signals reach.
set -e
setup="/opt/ros/${ROS_DISTRO:-}/setup.sh"
if [ -n "${ROS_DISTRO:-}" ] && [ -f "$setup" ]; then
    # shellcheck disable=SC1090
    . "$setup"
fi
[ "${1:-}" = guard ] || exec rtron "$@"

# A container ends with its first process, and the guard with it: the base would keep its last velocity.
# So this shell is the first, and where a supervisor is killed, the guard stops the robot and both are started again.
# The trap tells the newest by `$!`, which is there before a variable could be.
told=
trap 'told=1; kill -TERM "$!" 2>/dev/null || :' TERM INT
status=137
while [ "$status" -gt 128 ] && [ -z "$told" ]; do
    rtron "$@" &
    supervisor=$!
    status=0
    wait "$supervisor" || status=$?
    while kill -0 "$supervisor" 2>/dev/null; do # it was only told
        status=0
        wait "$supervisor" || status=$?
    done
done
exit "$status"
