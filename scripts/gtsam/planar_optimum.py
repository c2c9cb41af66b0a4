"""The optimum of a planar pose graph in extended precision, as a judge between solvers that work in double.

Gauss-Newton whose residuals, gradient and poses are numpy's longdouble (64 bits of mantissa on x86), while steps come from a
factorisation in double: the fixed point is where the *extended* gradient vanishes, however rough the factor is (iterative refinement).
"""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

REAL = np.longdouble


def read(path):
    """Poses, ends, measurements and information matrices of a g2o file, as the doubles that are printed."""
    poses, edges = {}, []
    for line in open(path):
        tag, *fields = line.split() or [""]
        if tag == "VERTEX_SE2":
            poses[int(fields[0])] = [float(field) for field in fields[1:4]]
        elif tag == "EDGE_SE2":
            edges.append([float(field) for field in fields])
    keys = sorted(poses)
    place = {key: index for index, key in enumerate(keys)}
    edges = np.array(edges)
    ends = np.array([[place[int(a)], place[int(b)]] for a, b in edges[:, :2]])
    upper = edges[:, 5:].astype(REAL)
    return (np.array([poses[key] for key in keys], REAL), ends, edges[:, 2:5].astype(REAL),
            upper[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3))


def linearise(poses, ends, measured):
    """Residuals Log(Z^-1 X_i^-1 X_j) and their derivatives by (x, y, theta) of both ends."""
    first, second = poses[ends[:, 0]], poses[ends[:, 1]]
    delta = second - first
    cosine, sine = np.cos(first[:, 2]), np.sin(first[:, 2])
    relative = np.stack([cosine * delta[:, 0] + sine * delta[:, 1], -sine * delta[:, 0] + cosine * delta[:, 1]], 1)
    turn = delta[:, 2] - measured[:, 2]
    turn = np.arctan2(np.sin(turn), np.cos(turn))
    c, s = np.cos(measured[:, 2]), np.sin(measured[:, 2])
    back = np.stack([np.stack([c, s], 1), np.stack([-s, c], 1)], 1)  # R_z^T
    offset = np.einsum("eij,ej->ei", back, relative - measured[:, :2])
    half = turn / 2
    small = np.abs(turn) < REAL(1e-3)
    safe = np.where(small, REAL(1), half)
    # (half) cot(half) and its derivative by the whole angle; the next terms of the series are below 1e-24.
    scale = np.where(small, 1 - turn**2 / 12 - turn**4 / 720 - turn**6 / 30240, safe / np.tan(safe))
    slope = np.where(small, -turn / 6 - turn**3 / 180 - turn**5 / 5040, 1 / np.tan(safe) / 2 - safe / np.sin(safe) ** 2 / 2)
    inverse = np.stack([np.stack([scale, half], 1), np.stack([-half, scale], 1)], 1)
    by_turn = np.stack([slope * offset[:, 0] + offset[:, 1] / 2, slope * offset[:, 1] - offset[:, 0] / 2], 1)
    residual = np.concatenate([np.einsum("eij,ej->ei", inverse, offset), turn[:, None]], 1)
    left = np.einsum("eij,ejk->eik", inverse, back)
    rotation = np.stack([np.stack([cosine, sine], 1), np.stack([-sine, cosine], 1)], 1)  # R_i^T
    by_second = np.zeros((len(ends), 3, 3), REAL)
    by_second[:, :2, :2] = np.einsum("eij,ejk->eik", left, rotation)
    by_second[:, :2, 2] = by_turn
    by_second[:, 2, 2] = 1
    by_first = -by_second
    lever = np.stack([relative[:, 1], -relative[:, 0]], 1)  # d(R_i^T d) / d theta_i
    by_first[:, :2, 2] += np.einsum("eij,ej->ei", left, lever)
    return residual, by_first, by_second


def optimum(poses, ends, measured, information, tolerance=1e-12, most=2000):
    """The stationary point next to `poses` with the first of them held, its cost, and the length of the last step, which is
    at most `tolerance` (metres, radians) where that could be reached."""
    poses = np.array(poses, REAL)
    size = 3 * len(poses)
    places = 3 * ends[:, :, None] + np.arange(3)
    previous = np.inf
    for _ in range(most):
        residual, by_first, by_second = linearise(poses, ends, measured)
        jacobian = np.concatenate([by_first, by_second], 2)  # 3 x 6
        weighed = np.einsum("eij,eik->ejk", information, jacobian)
        gradient = np.zeros(size, REAL)
        columns = places.reshape(len(ends), 6)
        np.add.at(gradient, columns, np.einsum("eij,ei->ej", weighed, residual))
        blocks = np.einsum("eij,eik->ejk", jacobian, weighed).astype(float)
        rows = np.repeat(columns, 6, axis=1).ravel()
        matrix = coo_matrix((blocks.ravel(), (rows, np.tile(columns, (1, 6)).ravel())), (size, size)).tocsc()[3:, 3:]
        factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        step = np.zeros(size, REAL)
        step[3:] = -factor.solve(gradient[3:].astype(float)).astype(REAL)
        poses += step.reshape(-1, 3)
        length = np.abs(step).max()
        if length <= tolerance or (length < 1e-9 and length > previous):
            break
        previous = length
    residual, _, _ = linearise(poses, ends, measured)
    return poses, np.einsum("ei,eij,ej->", residual, information, residual), float(length)
