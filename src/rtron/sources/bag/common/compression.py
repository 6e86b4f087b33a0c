"""Compressed chunks, unpacked to the size they declare and no further."""

import sys
from bz2 import BZ2Decompressor
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

from rtron.sources.bag.common.reader import DamageError


def decompress(compression: str, data: bytes, size: int) -> bytes:
    """Return `data` unpacked; raise DamageError if that is not `size` bytes.

    `compression` is what ROS 1 bags and MCAP call it: `none` or empty, `bz2`, `lz4`, `zstd`.
    """
    if compression not in _DECOMPRESSORS:
        raise DamageError(f"unknown compression {compression[:20]!r}")
    unpacked = _DECOMPRESSORS[compression](data, size + 1)
    if len(unpacked) != size:
        raise DamageError(f"a chunk does not unpack to the {size} bytes it declares")
    return unpacked


def decompress_zstd(data: bytes, limit: int) -> bytes:
    """Return a zstd frame unpacked to at most `limit` bytes; raise DamageError if it is more."""
    unpacked = _zstd(data, limit + 1)
    if len(unpacked) > limit:
        raise DamageError(f"a message unpacks to more than {limit} bytes")
    return unpacked


def _uncompressed(data: bytes, _limit: int) -> bytes:
    return data


def _bz2(data: bytes, limit: int) -> bytes:
    try:
        return BZ2Decompressor().decompress(data, limit)
    except (OSError, EOFError) as error:
        raise DamageError(f"a chunk is no bz2: {error}") from None


def _lz4(data: bytes, limit: int) -> bytes:
    from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]  # noqa: PLC0415

    try:
        unpacked: bytes = LZ4FrameDecompressor().decompress(data, max_length=limit)
    except (RuntimeError, EOFError) as error:
        raise DamageError(f"a chunk is no lz4: {error}") from None
    return unpacked


def _zstd(data: bytes, limit: int) -> bytes:
    zstd = _zstd_module()
    try:
        unpacked: bytes = zstd.ZstdDecompressor().decompress(data, max_length=limit)
    except (zstd.ZstdError, EOFError) as error:
        raise DamageError(f"packed data is no zstd: {error}") from None
    return unpacked


def _zstd_module() -> Any:  # noqa: ANN401 - part of Python from 3.14 on, a package before
    return import_module("compression.zstd" if sys.version_info >= (3, 14) else "backports.zstd")


_DECOMPRESSORS: Mapping[str, Callable[[bytes, int], bytes]] = {
    "none": _uncompressed,
    "": _uncompressed,
    "bz2": _bz2,
    "lz4": _lz4,
    "zstd": _zstd,
}
