"""Limits on the largest eigenvalue."""

import math

import numpy as np
from collection import add_eigenvalue


def laplacian(edges, n):
    total = np.zeros((n, n))
    for i, j in edges:
        total += edge(i, j, n)
    return total


def edge(i, j, n):
    v = np.zeros(n)
    v[i], v[j] = 1, -1
    return np.outer(v, v)


PETERSEN = (
    [(i, (i + 1) % 5) for i in range(5)] + [(i, i + 5) for i in range(5)] + [(5 + i, 5 + (i + 2) % 5) for i in range(5)]
)
CUBE = [(i, i ^ (1 << b)) for i in range(8) for b in range(3) if i < i ^ (1 << b)]
unit = lambda n, i: np.diag(np.eye(n)[i])
add_eigenvalue(
    "MaxCutPetersen",
    [3.0] * 10,
    [1] * 10,
    [(laplacian(PETERSEN, 10) / 4, [-unit(10, i) for i in range(10)])],
    known=12.5,
)
swap = lambda i, j, n: np.outer(np.eye(n)[i], np.eye(n)[j]) + np.outer(np.eye(n)[j], np.eye(n)[i])
add_eigenvalue(
    "LovaszHeptagon",
    [8.0] + [0.0] * 7,
    [1] + [0] * 7,
    [(np.ones((7, 7)), [-np.eye(7)] + [swap(i, (i + 1) % 7, 7) for i in range(7)])],
    known=7 * math.cos(math.pi / 7) / (1 + math.cos(math.pi / 7)),
)
add_eigenvalue(
    "ConnectivityCube",
    [1.0] * 12,
    [1] * 12,
    [(np.eye(8) - np.ones((8, 8)), [-edge(i, j, 8) for i, j in CUBE])],
    lower=0,
    known=6,
)
covariance = np.array(
    [[math.exp(-abs(i - j) / 2) + (1.0 if i == j else 0.0) + 0.1 * math.cos(i * j) for j in range(6)] for i in range(6)]
)
add_eigenvalue("EducationalTesting6", [0.0] * 6, [-1] * 6, [(-covariance, [unit(6, i) for i in range(6)])], lower=0)
family = lambda s: [
    [[math.cos(s * (k + 1) * (min(i, j) + 1) + max(i, j)) for j in range(4)] for i in range(4)] for k in range(6)
]
add_eigenvalue("TwoSpectra", [0.0] * 6, [-1, 0, 1, 0, -1, 1], [(-np.eye(4), family(1.0)), (-np.eye(4), family(0.8))])
