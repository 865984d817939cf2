"""Reads PNG files as the program writes them."""
import struct
import zlib


def pixels(file):
    """Width, height and rows of a PNG file of 8-bit RGB."""
    with open(file, "rb") as source:
        data = source.read()
    width, height = struct.unpack(">II", data[16:24])
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    raw, stride, rows, above = zlib.decompress(packed), 3 * width, [], bytearray(3 * width)
    for y in range(height):
        method, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = line[i - 3] if i >= 3 else 0, above[i], above[i - 3] if i >= 3 else 0
            both = abs(left + up - 2 * corner)
            nearest = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (both, 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[method]) & 255
        rows.append(line)
        above = line
    return width, height, rows
