"""Solves the friction problem that `export --friction-problem` writes, by another program, and compares contact forces.

    cargo run --release -p problems --bin hertz3d -- export --mesh 12 --friction-problem --out FOLDER
    cargo run --release -p problems --bin hertz3d -- evaluate --mesh 12 --out STATE
    python3 problems/tests/solve_friction.py FOLDER --forces STATE/pressure_shape.csv [--solver scipy|admm|nsn_ac]

The problem (docs/exchange.md):

    K u = f + Hᵀ r,   w = H u + (g, s),   0 ≤ r_N ⊥ w_N ≥ 0,   |r_T| ≤ μ r_N,   w_T = −κ r_T

`scipy` is an own semismooth Newton method on all displacements and forces (Alart and Curnier 1991), which needs numpy and scipy
only. `admm` and `nsn_ac` are those of Siconos (Debian: python3-siconos), in the global form of FCLIB: M v = q + H r, u = Hᵀ v + b with
M = K, q = f, H the transposed contact matrix, b = (g, s), displacements in the place of velocities.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np
import scipy.io
import scipy.sparse as sparse
from scipy.sparse.linalg import splu


def read(folder):
    """K, f, H, b = (gap, two slips) per node, μ per node, areas, tangents of the rows."""
    folder = Path(folder) / "friction"
    lists = json.loads((folder / "problem.json").read_text())
    stiffness = scipy.io.mmread(folder / lists["stiffness"]).tocsc()
    contact = scipy.io.mmread(folder / lists["contact"]).tocsr()
    load, gaps = np.array(lists["load"]), np.array(lists["gaps"])
    offset = np.zeros(3 * len(gaps))
    offset[::3] = gaps
    offset.reshape(-1, 3)[:, 1:] = lists["slips"]
    assert stiffness.shape == (len(load),) * 2 and contact.shape == (len(offset), len(load))
    return stiffness, load, contact, offset, np.array(lists["friction"]), np.array(lists["areas"]), np.array(lists["tangents"])


def local_law(w, r, friction, scale, held):
    """Residual r − P(r − ρ w) of the contact law per row, and its derivatives with respect to w and r as sparse matrices."""
    count = len(friction)
    residual, rows, columns, by_w, by_r = np.zeros(3 * count), [], [], [], []

    def put(row, column, dw, dr):
        rows.append(row)
        columns.append(column)
        by_w.append(dw)
        by_r.append(dr)

    for node in range(count):
        n = 3 * node
        tangents = [n + part for part in (1, 2) if not held[n + part]]
        for row in set((n + 1, n + 2)) - set(tangents):
            residual[row] = r[row]
            put(row, row, 0.0, 1.0)
        trial = r[n] - scale * w[n]
        if trial <= 0:
            for row in [n, *tangents]:
                residual[row] = r[row]
                put(row, row, 0.0, 1.0)
            continue
        residual[n] = scale * w[n]
        put(n, n, scale, 0.0)
        if not tangents:
            continue
        push = r[tangents] - scale * w[tangents]
        length, bound = np.linalg.norm(push), friction[node] * trial
        if length <= bound:
            residual[tangents] = scale * w[tangents]
            for row in tangents:
                put(row, row, scale, 0.0)
            continue
        unit = push / length
        residual[tangents] = r[tangents] - bound * unit
        turn = bound / length * (np.eye(len(tangents)) - np.outer(unit, unit))
        for i, row in enumerate(tangents):
            put(row, n, friction[node] * unit[i] * scale, -friction[node] * unit[i])
            for j, column in enumerate(tangents):
                put(row, column, scale * turn[i, j], float(i == j) - turn[i, j])
    shape = (3 * count,) * 2
    return residual, sparse.csr_matrix((by_w, (rows, columns)), shape), sparse.csr_matrix((by_r, (rows, columns)), shape)


def solve_by_newton(stiffness, load, contact, offset, friction):
    """Semismooth Newton method from full contact without sliding, with halved steps where the residual grows."""
    scale = stiffness.diagonal().mean()
    held = np.diff(contact.indptr) == 0
    u, r = np.zeros(len(load)), np.zeros(len(offset))
    size = np.abs(load).sum()
    r[::3] = 1e-9 * size

    def residual(u, r):
        law, by_w, by_r = local_law(contact @ u + offset, r, friction, scale, held)
        return np.concatenate([stiffness @ u - load - contact.T @ r, law]), by_w, by_r

    value, by_w, by_r = residual(u, r)
    for step in range(200):
        error = np.linalg.norm(value)
        if error <= 1e-12 * size:
            return r, f"{step} Newton steps, residual {error / size:.1e} of the load"
        matrix = sparse.bmat([[stiffness, -contact.T], [by_w @ contact, by_r]], format="csc")
        change = splu(matrix).solve(-value)
        for halving in range(6):
            share = 0.5**halving
            trial = u + share * change[: len(u)], r + share * change[len(u) :]
            value, by_w, by_r = residual(*trial)
            if np.linalg.norm(value) < error or halving == 5:
                break
        u, r = trial
    raise SystemExit(f"no convergence: residual {error / size:.1e} of the load")


def wide(matrix):
    """A matrix with the indices that Siconos has."""
    matrix = sparse.csc_matrix(matrix)
    matrix.indices, matrix.indptr = matrix.indices.astype(np.int64), matrix.indptr.astype(np.int64)
    return matrix


def solve_by_siconos(name, stiffness, load, contact, offset, friction):
    import siconos.numerics as numerics

    # Lengths and forces of order one.
    scale = np.abs(stiffness.diagonal()).mean()
    force = np.abs(load).sum() / len(friction)
    length = force / scale
    problem = numerics.GlobalFrictionContactProblem()
    problem.dimension, problem.numberOfContacts = 3, len(friction)
    problem.M, problem.H = (wide(matrix) for matrix in (stiffness / scale, contact.T))
    problem.q, problem.b, problem.mu = load / force, offset / length, friction.copy()
    kind = {"nsn_ac": numerics.SICONOS_GLOBAL_FRICTION_3D_NSN_AC, "admm": numerics.SICONOS_GLOBAL_FRICTION_3D_ADMM}[name]
    options = numerics.SolverOptions(kind)
    options.dparam[numerics.SICONOS_DPARAM_TOL] = 1e-12
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = {"nsn_ac": 500, "admm": 100000}[name]
    r, w, u = np.zeros(len(offset)), np.zeros(len(offset)), np.zeros(len(load))
    info = numerics.gfc3d_driver(problem, r, w, u, options)
    error = options.dparam[numerics.SICONOS_DPARAM_RESIDU]
    steps = options.iparam[numerics.SICONOS_IPARAM_ITER_DONE]
    if info:
        raise SystemExit(f"Siconos {name}: no convergence ({info}), error {error:.1e}")
    return r * force, f"Siconos {name}: {steps} steps, its error {error:.1e}"


def forces(path, areas, tangents):
    """Contact forces of the program from its table of pressures and tractions."""
    table = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding="utf-8")
    tractions = np.stack([table[f"traction_{axis}_MPa"] for axis in (1, 2, 3)], axis=1)
    along = np.einsum("nrk,nk->nr", tangents, tractions)
    return (np.column_stack([table["pressure_MPa"], along]) * areas[:, None]).ravel()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--forces", help="pressure_shape.csv of evaluate --out, to compare with")
    parser.add_argument("--solver", choices=["scipy", "admm", "nsn_ac"], default="scipy")
    parser.add_argument("--within", type=float, default=1e-8, help="largest difference allowed, relative to the largest force")
    arguments = parser.parse_args()
    stiffness, load, contact, offset, friction, areas, tangents = read(arguments.folder)
    print(f"{len(load)} displacements, {len(friction)} contact nodes, {stiffness.nnz} entries of K")
    clock = time.time()
    problem = stiffness, load, contact, offset, friction
    solve = solve_by_newton if arguments.solver == "scipy" else lambda *parts: solve_by_siconos(arguments.solver, *parts)
    found, words = solve(*problem)
    print(f"{words}; {time.time() - clock:.1f} s; total normal force {found[::3].sum():.10e} N")
    if arguments.forces:
        expected = forces(arguments.forces, areas, tangents)
        difference = np.abs(found - expected).max() / np.abs(expected).max()
        print(f"largest difference from the program's forces: {difference:.1e} of the largest force")
        assert difference <= arguments.within, difference


main()
