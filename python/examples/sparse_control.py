"""Sparse control of a membrane: few patches push it into a wanted shape.

    minimise  |y - wanted|^2 / 2 + weight |u|_1   where  -Laplace(y) = u on the unit square, y = 0 on its boundary

The absolute values make most of the control zero. Deviations and controls are outputs, and the cost is a convex function of them.
"""

import sys

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

import nonsmooth

NODES, PATCHES = 23, 6  # Inner nodes and patches per edge.
WEIGHT = 3e-4


def model():
    h = 1 / (NODES + 1)
    line = sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(NODES, NODES)) / h**2
    laplace = sparse.kron(line, sparse.identity(NODES)) + sparse.kron(sparse.identity(NODES), line)
    x = np.arange(1, NODES + 1) * h
    patch = np.minimum((x * PATCHES).astype(int), PATCHES - 1)
    belongs = (patch[:, None] == np.arange(PATCHES)).astype(float)
    spread = np.kron(belongs, belongs)  # Control of a patch to forces at its nodes.
    wanted = 0.1 * np.outer(np.sin(np.pi * x) ** 4, np.sin(2 * np.pi * x)).ravel()
    return splu(laplace.tocsc()), spread, wanted, h


def optimize():
    solver, spread, wanted, h = model()
    effect = h * solver.solve(spread)  # Of every patch on the deviations; the membrane is linear.
    n = PATCHES**2
    jacobian = np.vstack([effect, np.eye(n)])

    def outputs(u):
        return np.concatenate([effect @ u - h * wanted, u]), jacobian

    def cost(c):
        deviation, u = c[:-n], c[-n:]
        weight = WEIGHT / n
        return 0.5 * deviation @ deviation + weight * np.abs(u).sum(), np.concatenate([deviation, weight * np.sign(u)])

    options = {"tolerance": 1e-6, "first_step": 10.0}
    result = nonsmooth.minimize_composite(cost, outputs, np.zeros(n), bounds=[(-20, 20)] * n, options=options)
    return result, solver.solve(spread @ result.x).reshape(NODES, NODES), wanted.reshape(NODES, NODES)


def main(picture=None):
    result, y, wanted = optimize()
    active = np.sum(np.abs(result.x) > 1e-3 * np.abs(result.x).max())
    print(f"objective {result.start_value:.6e} -> {result.fun:.6e} after {result.nfev} evaluations: {result.message}")
    print(f"{active} of {result.x.size} patches push")
    if picture:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(1, 3, figsize=(7, 2.5))
        for axis, field, title in zip(axes, (wanted, y, result.x.reshape(PATCHES, PATCHES)), ("wanted", "reached", "control")):
            size = np.abs(field).max()
            axis.imshow(field.T, origin="lower", cmap="RdBu", vmin=-size, vmax=size)
            axis.set_title(title, fontsize=9)
            axis.set_axis_off()
        figure.tight_layout()
        figure.savefig(picture, dpi=80)
    return result, active


if __name__ == "__main__":
    main(*sys.argv[1:2])
