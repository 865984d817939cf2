"""Reads PNG files as the program writes them."""
import struct
import zlib


def pixels(file):
    """Width, height and rows of bytes of a PNG file of gray or RGB, 8 or 16 bits each."""
    with open(file, "rb") as source:
        data = source.read()
    width, height, bits, color = struct.unpack(">IIBB", data[16:26])
    each = (3 if color == 2 else 1) * bits // 8
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride, rows = zlib.decompress(packed), each * width, []
    above = bytearray(stride)
    for y in range(height):
        method, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, corner = (line[i - each], above[i - each]) if i >= each else (0, 0)
            up = above[i]
            both = abs(left + up - 2 * corner)
            nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (both, 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[method]) & 255
        rows.append(line)
        above = line
    return width, height, rows


def words(file):
    """Rows of numbers of a PNG file of 16 bits."""
    return [[row[i] << 8 | row[i + 1] for i in range(0, len(row), 2)] for row in pixels(file)[2]]
