#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which placed copies lie inside the statue, by numpy alone: count_copies.py statue.stl cells.csv SCALE CLEARANCE EXPECTED

`cells.csv` is what `meso eval statue.meso` writes: where each copy stands. A copy is inside if its first point is (the
winding number, by solid angles) and no point of its surface is nearer than CLEARANCE to the statue's: distances of all
corners from all triangles and of all edges from all edges that come near, both ways, and edges through triangles.
Nothing here is shared with the engine. Exit 1 if the copies are not EXPECTED many. Prints the number of copies, and the smallest distance of those inside and the
largest of those that are not: the two must not be near CLEARANCE, or the answer would hang on rounding.
"""
import csv
import struct
import sys

import numpy as np


def read_stl(name):
    data = open(name, 'rb').read()
    count = struct.unpack_from('<I', data, 80)[0]
    facets = np.frombuffer(data, dtype=np.dtype([('n', '<f4', 3), ('t', '<f4', (3, 3)), ('a', '<u2')]), count=count,
                           offset=84)
    return facets['t'].astype(float)


def winding(p, triangles):
    a, b, c = (triangles[:, i] - p for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    top = np.einsum('ij,ij->i', a, np.cross(b, c))
    bottom = la * lb * lc + np.einsum('ij,ij->i', a, b) * lc + np.einsum('ij,ij->i', b, c) * la \
        + np.einsum('ij,ij->i', c, a) * lb
    return np.arctan2(top, bottom).sum() / (2 * np.pi)


def dot(a, b):
    return np.einsum('...i,...i->...', a, b)


def segments_apart(a, b, c, d):
    """Distance of segments a b and c d, row by row (Ericson, Real-Time Collision Detection, 5.1.9)."""
    u, v, r = b - a, d - c, a - c
    uu, vv, uv, ur, vr = dot(u, u), dot(v, v), dot(u, v), dot(u, r), dot(v, r)
    det = uu * vv - uv * uv
    s = np.where(det > 1e-14 * uu * vv, np.clip((uv * vr - ur * vv) / np.where(det == 0, 1, det), 0, 1), 0)
    t = (uv * s + vr) / vv
    s = np.where(t < 0, np.clip(-ur / uu, 0, 1), np.where(t > 1, np.clip((uv - ur) / uu, 0, 1), s))
    t = np.clip(t, 0, 1)
    return np.linalg.norm(a + s[:, None] * u - c - t[:, None] * v, axis=1)


def heights(p, t):
    """Distance of points from triangles they are above; infinite for the others, whose edges decide."""
    n = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    above = np.ones(len(p), bool)
    for i in range(3):
        above &= dot(np.cross(t[:, (i + 1) % 3] - t[:, i], p - t[:, i]), n) >= 0
    return np.where(above, abs(dot(p - t[:, 0], n)) / np.linalg.norm(n, axis=1), np.inf)


def pierced(a, b, t):
    n = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    da, db = dot(a - t[:, 0], n), dot(b - t[:, 0], n)
    through = da * db < 0
    p = a + (da / np.where(da == db, 1, da - db))[:, None] * (b - a)
    for i in range(3):
        through &= dot(np.cross(t[:, (i + 1) % 3] - t[:, i], p - t[:, i]), n) >= 0
    return through


def distance(s, t, reach):
    """Of two sets of triangles; exact where it is less than `reach`, 0 where they cross."""
    low_t, high_t = t.min(axis=1), t.max(axis=1)
    near = np.all((low_t <= s.max(axis=(0, 1)) + reach) & (high_t >= s.min(axis=(0, 1)) - reach), axis=1)
    t, low_t, high_t = t[near], low_t[near], high_t[near]
    best = np.inf
    for first in range(0, len(s), 64):
        part = s[first:first + 64]
        low, high = part.min(axis=1) - reach, part.max(axis=1) + reach
        i, k = np.nonzero(np.all((low[:, None] <= high_t) & (high[:, None] >= low_t), axis=2))
        if len(i) == 0:
            continue
        a, b = part[i], t[k]
        for e in range(3):
            if pierced(a[:, e], a[:, (e + 1) % 3], b).any() or pierced(b[:, e], b[:, (e + 1) % 3], a).any():
                return 0.0
            best = min(best, heights(a[:, e], b).min(), heights(b[:, e], a).min())
            for f in range(3):
                best = min(best, segments_apart(a[:, e], a[:, (e + 1) % 3], b[:, f], b[:, (f + 1) % 3]).min())
    return best


def main():
    if len(sys.argv) != 6:
        sys.exit(__doc__)
    expected = int(sys.argv[5])
    statue, cells, scale, clearance = read_stl(sys.argv[1]), sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
    copy = statue * scale
    inside, nearest_in, farthest_out = [], np.inf, 0.0
    low, high = statue.min(axis=(0, 1)), statue.max(axis=(0, 1))
    rows = list(csv.DictReader(open(cells)))
    for row in rows:
        at = np.array([float(row[c]) for c in ('m14', 'm24', 'm34')])
        placed = copy + at
        if np.any(placed.min(axis=(0, 1)) < low) or np.any(placed.max(axis=(0, 1)) > high):
            continue
        # A quick no: some corners are outside.
        if any(winding(p, statue) < 0.5 for p in placed[::500, 0]):
            continue
        d = distance(placed, statue, 4 * clearance)
        if d >= clearance:
            inside.append(row)
            nearest_in = min(nearest_in, d)
        else:
            farthest_out = max(farthest_out, d)
    print(f'{len(inside)} of {len(rows)} copies inside; nearest of them {nearest_in:.6f} mm from the surface, '
          f'farthest of those left out {farthest_out:.6f} mm')
    if len(inside) != expected:
        sys.exit(f'FAIL: {expected} were expected')


if __name__ == '__main__':
    main()
