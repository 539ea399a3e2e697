"""Tetrahedral mesh of the soft tip: a cylinder with a spherical end, finest where it touches the plate.

The lowest point is the origin, z points up. A square grid is mapped to discs, in layers from the spherical end to the
bonded top. Each cell is split into six tetrahedra.
"""

import itertools

import numpy as np

import scene

SIDE = 0.009


def to_disc(u, v):
    """Maps the square [-1, 1]^2 to the unit disc."""
    return u * np.sqrt(1 - v * v / 2), v * np.sqrt(1 - u * u / 2)


def graded(count, power):
    s = np.linspace(-1, 1, count)
    return np.sign(s) * np.abs(s) ** power


def tip(across=17, layers=8, power=1.5, up=2.0):
    """Points [n, 3] (m), tetrahedra [m, 4] with positive volume, and the indices of the bonded points."""
    line = graded(across, power)
    heights = np.linspace(0, 1, layers + 1) ** up
    index = np.arange(across * across * (layers + 1)).reshape(layers + 1, across, across)
    points = []
    for share in heights:
        for u, v in itertools.product(line, line):
            x, y = to_disc(u, v)
            x, y = SIDE * x, SIDE * y
            low = scene.RADIUS - np.sqrt(scene.RADIUS**2 - x * x - y * y)
            points.append((x, y, low + share * (scene.RADIUS - low)))
    points = np.array(points)
    tetrahedra = []
    for k, i, j in itertools.product(range(layers), range(across - 1), range(across - 1)):
        for order in itertools.permutations(range(3)):
            at, corners = [k, i, j], []
            corners.append(index[tuple(at)])
            for axis in order:
                at[axis] += 1
                corners.append(index[tuple(at)])
            tetrahedra.append(corners)
    tetrahedra = np.array(tetrahedra)
    a, b, c, d = (points[tetrahedra[:, n]] for n in range(4))
    volume = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    tetrahedra[volume < 0] = tetrahedra[volume < 0][:, [0, 2, 1, 3]]
    if np.abs(volume).min() <= 1e-16:
        raise ValueError(f"expected tetrahedra with a volume, got one of {np.abs(volume).min()} m^3")
    return points, tetrahedra, index[-1].flatten()
