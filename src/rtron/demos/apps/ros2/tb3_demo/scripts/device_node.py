"""What the nodes share: one thread runs all callbacks, also those for the frames of a device."""
# Beside the scripts, which find it there, and of no package of RTron.
# ruff: noqa: INP001
# mypy: ignore-errors

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Thread

import rclpy
from demo_logic.device import Device, Frame, Head
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

_MOST = 20
"""So many frames wait at most; then the oldest is left out."""
FrameHandler = Callable[[Head, bytes], None]


def spin(node: Node, device: Device | None = None, on_frame: FrameHandler | None = None) -> None:
    """Spin a node until ^C or SIGTERM, and then destroy it.

    `on_frame` is called with each frame of a device; the node ends with the device, too.
    """
    reader = _reader(node, device, on_frame) if device and on_frame else None
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)
    if reader:
        device.close()
        reader.join()  # a thread that holds the node keeps its shared memory
    node.destroy_node()
    rclpy.try_shutdown()


def _reader(node: Node, device: Device, on_frame: FrameHandler) -> Thread:
    """Start a thread that hands the frames of a device to a node's executor."""
    frames: deque[Frame] = deque(maxlen=_MOST)

    def take() -> None:
        while frames:
            on_frame(*frames.popleft())

    came = node.create_guard_condition(take)

    def read() -> None:
        for frame in device:
            frames.append(frame)
            came.trigger()
        rclpy.try_shutdown()

    thread = Thread(target=read, name=f"{device.role} device", daemon=True)
    thread.start()
    return thread
