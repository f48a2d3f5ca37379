"""STL files of simple bodies, made where a test needs them. A body is an array of triangles, (n, 3 corners, 3 coordinates)."""

import struct

import numpy as np


def drum(radius, length, segments, blades=0, depth=0.0):
    """A drum along y about the origin, with lids; blades without thickness stand inward on it."""
    angles = 2 * np.pi * np.arange(segments + 1) / segments
    ring = [np.array([radius * np.cos(a), 0.0, radius * np.sin(a)]) for a in angles[:-1]]
    ring.append(ring[0])
    low, high = np.array([0, -length / 2, 0]), np.array([0, length / 2, 0])
    triangles = []
    for k in range(segments):
        a, b = ring[k], ring[k + 1]
        triangles += [(a + low, b + low, b + high), (a + low, b + high, a + high), (low, b + low, a + low), (high, a + high, b + high)]
        if blades and k % (segments // blades) == 0:
            inner = a * (1 - depth / radius)
            triangles += [(a + low, inner + low, inner + high), (a + low, inner + high, a + high)]
    return np.array(triangles)


def box(lower, upper):
    """The faces of a box."""
    lower, upper = np.asarray(lower, float), np.asarray(upper, float)
    triangles = []
    for axis in range(3):
        one, other = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
        for corner, sign in ((lower, 1), (upper, -1)):
            a = sign * one * (upper - lower)
            b = sign * other * (upper - lower)
            triangles += [(corner, corner + a, corner + a + b), (corner, corner + a + b, corner + b)]
    return np.array(triangles)


def write_binary(path, triangles, header=b"made by a test"):
    with open(path, "wb") as file:
        file.write(header.ljust(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *np.float32(triangle).ravel(), 0))


def write_text(path, triangles):
    """Enough digits to say 32-bit numbers exactly: the text and the binary file hold the same."""
    with open(path, "w") as file:
        file.write("solid made by a test\n")
        for triangle in np.float32(triangles):
            file.write(" facet normal 0 0 0\n  outer loop\n")
            for corner in triangle:
                file.write("   vertex " + " ".join(f"{float(x):.17g}" for x in corner) + "\n")
            file.write("  endloop\n endfacet\n")
        file.write("endsolid made by a test\n")
