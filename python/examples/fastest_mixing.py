"""Eigenvalue optimization: the fastest mixing random walk on a graph.

The probabilities of the edges are chosen so that the second largest absolute eigenvalue of the transition matrix, which
says how fast the walk forgets its start, is least. It has kinks wherever two eigenvalues meet, and the optimum lies there.
"""

import sys

import numpy as np

import nonsmooth

# Two clusters of five with a bridge.
NODES = 10
EDGES = [(i, j) for i in range(5) for j in range(i)] + [(i, j) for i in range(5, 10) for j in range(5, i)] + [(0, 5), (1, 6)]


def walk(p):
    matrix = np.eye(NODES)
    for probability, (i, j) in zip(p, EDGES):
        matrix[[i, j], [j, i]] += probability
        matrix[[i, j], [i, j]] -= probability
    return matrix


def slowest(p):
    """The second largest absolute eigenvalue and one subgradient."""
    values, vectors = np.linalg.eigh(walk(p) - 1 / NODES)
    k = -1 if values[-1] >= -values[0] else 0
    u, sign = vectors[:, k], 1.0 if k == -1 else -1.0
    return sign * values[k], np.array([-sign * (u[i] - u[j]) ** 2 for i, j in EDGES])


def usual():
    """The probabilities of Metropolis and Hastings: one over the larger degree."""
    degree = np.bincount(np.ravel(EDGES))
    return np.array([1 / max(degree[i], degree[j]) for i, j in EDGES])


def optimize():
    leaving = np.array([[float(node in edge) for edge in EDGES] for node in range(NODES)])
    return nonsmooth.minimize(
        slowest,
        usual(),
        bounds=[(0, 1)] * len(EDGES),
        constraints=(leaving, -np.inf, 1),
        options={"convex": True},
    )


def main(picture=None):
    result, before = optimize(), slowest(usual())[0]
    print(f"second eigenvalue {before:.6f} -> {result.fun:.6f} after {result.nfev} evaluations, success {result.success}")
    print(f"no walk on this graph has less than {result.fun - result.gap:.6f}")
    if picture:
        import matplotlib.pyplot as plt

        angle = np.arange(5) * 2 * np.pi / 5
        place = np.concatenate([np.c_[-np.cos(angle) * -1 - 2, np.sin(angle)], np.c_[-np.cos(angle) + 2, np.sin(angle)]])
        figure, axes = plt.subplots(figsize=(6, 2.6))
        for probability, (i, j) in zip(result.x, EDGES):
            axes.plot(*place[[i, j]].T, color="C0", linewidth=0.3 + 10 * probability, solid_capstyle="round")
        axes.plot(*place.T, "o", color="k")
        axes.set_axis_off()
        axes.set_title(f"width: probability of the edge; second eigenvalue {before:.3f} → {result.fun:.3f}", fontsize=9)
        figure.tight_layout()
        figure.savefig(picture, dpi=80)
    return before, result


if __name__ == "__main__":
    main(*sys.argv[1:2])
