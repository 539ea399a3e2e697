"""Load and sticking shear stiffness of the soft tip by linear finite elements: the effect of its finite size and of the mesh.

Small strain, linear tetrahedra, contact without friction by an active set. Prints relative differences from Hertz at
each depth, for the mesh of the peers and finer ones. Needs scipy.
"""

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

import mesh
import scene


def stiffness(points, tetrahedra):
    """Stiffness matrix of linear elasticity [3n, 3n] (N/m)."""
    lame = scene.YOUNG * scene.POISSON / ((1 + scene.POISSON) * (1 - 2 * scene.POISSON))
    edges = np.stack([points[tetrahedra[:, k]] - points[tetrahedra[:, 0]] for k in (1, 2, 3)], axis=2)
    inverse = np.linalg.inv(edges)
    gradients = np.concatenate([-inverse.sum(1, keepdims=True), inverse], axis=1)
    volume = np.linalg.det(edges) / 6
    same = np.einsum("eai,ebi->eab", gradients, gradients)
    blocks = (lame * np.einsum("eai,ebj->eaibj", gradients, gradients)
              + scene.SHEAR_MODULUS * np.einsum("eaj,ebi->eaibj", gradients, gradients)
              + scene.SHEAR_MODULUS * np.einsum("eab,ij->eaibj", same, np.eye(3)))
    blocks = (blocks * volume[:, None, None, None, None]).reshape(len(tetrahedra), 12, 12)
    index = (3 * tetrahedra[:, :, None] + np.arange(3)).reshape(-1, 12)
    rows, columns = np.repeat(index, 12, axis=1), np.tile(index, (1, 12))
    return sparse.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * len(points),) * 2)


def solve(matrix, free, moved):
    """Sets the displacements of the degrees of freedom `free` to balance, with the others given."""
    part = matrix[free][:, free]
    scale = sparse.diags(1 / part.diagonal())
    moved[free], failed = linalg.cg(part, -(matrix[free] @ moved), rtol=1e-8, M=scale)
    if failed:
        raise ValueError("expected a solution within the tolerance 1e-8")


def press(matrix, points, bonded, depth, touching):
    """Force on the plate that lies `depth` above the lowest point, the points in contact, and their displacements."""
    fixed = (3 * bonded[:, None] + np.arange(3)).ravel()
    while True:
        given = np.concatenate([fixed, 3 * touching + 2])
        free = np.setdiff1d(np.arange(matrix.shape[0]), given)
        moved = np.zeros(matrix.shape[0])
        moved[3 * touching + 2] = depth - points[touching, 2]
        solve(matrix, free, moved)
        force = matrix @ moved
        below = np.flatnonzero(points[:, 2] + moved[2::3] < depth - 1e-9)
        pulled = touching[force[3 * touching + 2] < 0]
        after = np.setdiff1d(np.union1d(touching, below), pulled)
        if np.array_equal(after, touching):
            return force[3 * touching + 2].sum(), touching
        touching = after


def stuck_shear(matrix, bonded, touching):
    """Tangential stiffness while all touching points stick (N/m)."""
    held = np.concatenate([(3 * bonded[:, None] + np.arange(3)).ravel(), (3 * touching[:, None] + np.arange(3)).ravel()])
    free = np.setdiff1d(np.arange(matrix.shape[0]), held)
    moved = np.zeros(matrix.shape[0])
    moved[3 * touching] = 1.0
    solve(matrix, free, moved)
    return (matrix @ moved)[3 * touching].sum()


if __name__ == "__main__":
    for across, layers in ((13, 6), (17, 8), (25, 12)):
        points, tetrahedra, bonded = mesh.tip(across, layers)
        matrix = stiffness(points, tetrahedra)
        touching, errors = np.array([np.argmin(points[:, 2])]), []
        for depth in scene.DEPTHS:
            load, touching = press(matrix, points, bonded, depth, touching)
            errors.append(100 * (load / scene.hertz_force(depth) - 1))
        shear = 100 * (stuck_shear(matrix, bonded, touching) / scene.shear_stiffness() - 1)
        loads = ", ".join(f"{e:+.1f}" for e in errors)
        print(f"{len(points)} points: load {loads} %, shear slope {shear:+.1f} %, {len(touching)} points touch", flush=True)
