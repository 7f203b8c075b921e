# SPDX-License-Identifier: Apache-2.0
"""Reads and writes the float planes of EXR files with the standard library alone: scan lines, as they are or in ZIP blocks. For
tests that hold others against a file, so that the program's own reader is not asked."""

import array
import struct
import zlib

MAGIC = b"\x76\x2f\x31\x01"
LINES = {0: 1, 2: 1, 3: 16}  # per block: none, ZIPS, ZIP


def _attributes(data):
    """Names, values; and where the offsets of the blocks begin."""
    at, found = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        found[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return found, at + 1


def _channels(chlist):
    names, at = [], 0
    while chlist[at]:
        name = chlist[at:].split(b"\0", 1)[0]
        at += len(name) + 1
        if struct.unpack_from("<i", chlist, at)[0] not in (1, 2):
            raise ValueError(f"channel {name.decode()} is neither half nor float")
        names.append((name.decode(), 2 * struct.unpack_from("<i", chlist, at)[0]))
        at += 16
    return names


def _unzipped(data, size):
    """ZIP blocks hold differences of bytes, and the even ones before the odd ones."""
    if len(data) == size:
        return data
    coded = bytearray(zlib.decompress(data))
    for i in range(1, len(coded)):
        coded[i] = (coded[i - 1] + coded[i] - 128) & 0xFF
    plain, half = bytearray(size), (size + 1) // 2
    plain[0::2], plain[1::2] = coded[:half], coded[half:]
    return bytes(plain)


def read(path):
    """(width, height, {channel: float32 array, rows from the top}) of a file; half channels are left out."""
    data = path.read_bytes()
    if not data.startswith(MAGIC):
        raise ValueError(f"{path} is no EXR file")
    attributes, table = _attributes(data)
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height, lines = x1 - x0 + 1, y1 - y0 + 1, LINES[attributes["compression"][0]]
    channels = _channels(attributes["channels"])
    planes = {name: array.array("f") for name, size in channels if size == 4}
    for block in range((height + lines - 1) // lines):
        (offset,) = struct.unpack_from("<Q", data, table + 8 * block)
        _, size = struct.unpack_from("<2i", data, offset)
        rows = min(lines, height - block * lines)
        plain = _unzipped(data[offset + 8 : offset + 8 + size], rows * width * sum(size for _, size in channels))
        at = 0
        for _ in range(rows):
            for name, size in channels:
                if size == 4:
                    planes[name].frombytes(plain[at : at + 4 * width])
                at += size * width
    return width, height, planes


def write(path, width, height, planes):
    """Float channels of equal size, uncompressed."""
    names = sorted(planes)

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for name in names) + b"\0"
    head = MAGIC + struct.pack("<i", 2)
    for each in (("channels", "chlist", channels), ("compression", "compression", b"\0"), ("dataWindow", "box2i", window),
                 ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"),
                 ("pixelAspectRatio", "float", struct.pack("<f", 1)), ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
                 ("screenWindowWidth", "float", struct.pack("<f", 1))):
        head += attribute(*each)
    head += b"\0"
    size = 4 * width * len(names)
    first = len(head) + 8 * height
    offsets = b"".join(struct.pack("<Q", first + y * (size + 8)) for y in range(height))
    rows = b"".join(struct.pack("<2i", y, size) + b"".join(planes[n][y * width : (y + 1) * width].tobytes() for n in names)
                    for y in range(height))
    path.write_bytes(head + offsets + rows)
