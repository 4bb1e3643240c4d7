#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A closed triangle mesh with fewer facets and the same volume: decimate.py IN.off OUT.stl FACETS

Edges are collapsed, cheapest first, after Lindstrom and Turk (Fast and memory efficient polygonal simplification, 1998):
the new vertex keeps the enclosed volume (one linear equation), and of the points that do, moves least volume across the
surface (the sum of the squared volumes between each old triangle and the new one). Points end on multiples of 1/8192 mm,
which the floats of STL hold exactly. The mesh stays a closed manifold: an edge whose ends have a neighbour in common
beside the two opposite corners stays, and so does one whose collapse would turn a triangle over.
"""
import heapq
import struct
import sys

GRID = 8192


def read_off(name):
    words = open(name).read().split()
    points, faces = int(words[1]), int(words[2])
    values = [float(w) for w in words[4:4 + 3 * points]]
    indices = [int(w) for w in words[4 + 3 * points:4 + 3 * points + 4 * faces]]
    if words[0] != 'OFF' or any(n != 3 for n in indices[::4]):
        sys.exit(f'{name}: not an OFF file of triangles')
    return ([tuple(values[3 * i:3 * i + 3]) for i in range(points)],
            [tuple(indices[4 * i + 1:4 * i + 4]) for i in range(faces)])


def normal(a, b, c):
    """Twice the area, outwards."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


def solve(m):
    """Gauss with pivots; each row of `m` ends with its right side."""
    n = len(m)
    for i in range(n):
        p = max(range(i, n), key=lambda r: abs(m[r][i]))
        m[i], m[p] = m[p], m[i]
        for r in range(i + 1, n):
            f = m[r][i] / m[i][i]
            for c in range(i, n + 1):
                m[r][c] -= f * m[i][c]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (m[i][n] - sum(m[i][c] * x[c] for c in range(i + 1, n))) / m[i][i]
    return x


class Mesh:
    def __init__(self, points, faces):
        self.points, self.faces = list(points), dict(enumerate(faces))
        self.around = [set() for _ in points]  # the triangles of each point
        self.version = [0] * len(points)
        for f, corners in self.faces.items():
            for p in corners:
                self.around[p].add(f)

    def neighbours(self, p):
        return {q for f in self.around[p] for q in self.faces[f]} - {p}

    def best_point(self, a, b):
        """Cost and place of the point that stands for the edge a b."""
        pa, pb = self.points[a], self.points[b]
        o = tuple((x + y) / 2 for x, y in zip(pa, pb))
        xx = xy = xz = yy = yz = zz = rx = ry = rz = gx = gy = gz = g = rr = 0.0
        for f in self.around[a] | self.around[b]:
            p, q, r = (self.points[i] for i in self.faces[f])
            nx, ny, nz = normal(p, q, r)
            d = nx * (p[0] - o[0]) + ny * (p[1] - o[1]) + nz * (p[2] - o[2])
            xx += nx * nx; xy += nx * ny; xz += nx * nz; yy += ny * ny; yz += ny * nz; zz += nz * nz
            rx += d * nx; ry += d * ny; rz += d * nz; rr += d * d
            gx += nx; gy += ny; gz += nz; g += d
        # Where the surface is flat any point of it would do: the nearest to the edge's middle, then.
        e = 1e-3 * (xx + yy + zz)
        x, y, z, _ = solve([[xx + e, xy, xz, gx, rx], [xy, yy + e, yz, gy, ry], [xz, yz, zz + e, gz, rz],
                            [gx, gy, gz, -1e-12 * (gx * gx + gy * gy + gz * gz + 1e-300), g]])
        cost = (xx * x * x + yy * y * y + zz * z * z + 2 * (xy * x * y + xz * x * z + yz * y * z)
                - 2 * (rx * x + ry * y + rz * z) + rr)
        length = sum((u - v) ** 2 for u, v in zip(pa, pb))
        place = tuple(round((c + d) * GRID) / GRID for c, d in zip(o, (x, y, z)))
        return max(cost, 0.0) + 1e-6 * length ** 3, place

    def may_collapse(self, a, b, place):
        shared = self.around[a] & self.around[b]
        if len(shared) != 2 or len(self.neighbours(a) & self.neighbours(b)) != 2:
            return False
        for f in (self.around[a] | self.around[b]) - shared:
            old = [self.points[p] for p in self.faces[f]]
            new = [place if p in (a, b) else self.points[p] for p in self.faces[f]]
            n, m = normal(*old), normal(*new)
            dot = sum(x * y for x, y in zip(n, m))
            nn, mm = sum(x * x for x in n), sum(x * x for x in m)
            longest = max(sum((x - y) ** 2 for x, y in zip(new[i], new[i - 1])) for i in range(3))
            if dot <= 0 or dot * dot < 0.25 * nn * mm or mm < 0.01 * longest * longest:
                return False  # turned by more than 60 degrees, or a needle
        return True

    def collapse(self, a, b, place):
        """Into a."""
        for f in self.around[a] & self.around[b]:
            for p in self.faces.pop(f):
                self.around[p].discard(f)
        for f in self.around[b]:
            self.faces[f] = tuple(a if p == b else p for p in self.faces[f])
        self.around[a] |= self.around[b]
        self.around[b] = set()
        self.points[a] = place
        self.version[b] += 1
        for p in self.neighbours(a) | {a}:
            self.version[p] += 1


def decimate(points, faces, target):
    mesh = Mesh(points, faces)
    heap = []

    def offer(a, b):
        a, b = min(a, b), max(a, b)
        cost, place = mesh.best_point(a, b)
        heapq.heappush(heap, (cost, a, b, mesh.version[a], mesh.version[b], place))

    for a, b in sorted({(min(f[i], f[i - 1]), max(f[i], f[i - 1])) for f in faces for i in range(3)}):
        offer(a, b)
    while heap and len(mesh.faces) > target:
        _, a, b, version_a, version_b, place = heapq.heappop(heap)
        if not mesh.around[a] or not mesh.around[b]:
            continue
        if (version_a, version_b) != (mesh.version[a], mesh.version[b]):
            if b in mesh.neighbours(a):
                offer(a, b)  # the surface around it has changed since
            continue
        if mesh.may_collapse(a, b, place):
            mesh.collapse(a, b, place)
            for p in sorted(mesh.neighbours(a)):
                offer(a, p)
    return [tuple(tuple(round(c * GRID) / GRID for c in mesh.points[p]) for p in mesh.faces[f])
            for f in sorted(mesh.faces)]


def write_stl(name, triangles):
    with open(name, 'wb') as file:
        file.write(b'decimated'.ljust(80, b' ') + struct.pack('<I', len(triangles)))
        for t in triangles:
            n = normal(*t)
            length = sum(x * x for x in n) ** 0.5
            file.write(struct.pack('<12fH', *(x / length for x in n), *(c for p in t for c in p), 0))


def volume(triangles):
    return sum(sum(x * y for x, y in zip(normal(*t), t[0])) for t in triangles) / 6


def main():
    points, faces = read_off(sys.argv[1])
    triangles = decimate(points, faces, int(sys.argv[3]))
    ratio = volume(triangles) / volume([tuple(points[p] for p in f) for f in faces])
    write_stl(sys.argv[2], triangles)
    print(f'{sys.argv[2]}: {len(triangles)} facets of {len(faces)}, volume {volume(triangles):.3f}, {ratio:.6f} of the mesh')


if __name__ == '__main__':
    main()
