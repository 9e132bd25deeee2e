"""Optimal values of `testset::constrained` by IPOPT, SLSQP and Clarabel.

This folder states every problem a second time. A maximum or a magnitude becomes a smooth program with additional
variables. IPOPT solves it from the published start and from points around it; SLSQP of SciPy starts near the best
result and has to confirm it. Limits on eigenvalues are semidefinite programs, which Clarabel solves, and which IPOPT
confirms with Cholesky factors as variables.

    python3 -m pip install casadi==3.8.2 scipy clarabel
    python3 testset/reference/constrained.py                # all; writes constrained.json next to this file
    python3 testset/reference/constrained.py HS71 TFI3      # some; writes nothing
"""

import json
import math
import pathlib
import sys

import casadi as ca
import clarabel
import numpy as np
import eigenvalues  # noqa: F401  (adds problems to the collection)
import hock_schittkowski  # noqa: F401  (adds problems to the collection)
import nonsmooth  # noqa: F401  (adds problems to the collection)
from collection import EIGENVALUE, SMOOTH
from scipy import sparse
from scipy.optimize import minimize

INF = math.inf
ACTIVE = 1e-6
IPOPT = {
    "print_time": False,
    "show_eval_warnings": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "tol": 1e-11,
        "constr_viol_tol": 1e-12,
        "dual_inf_tol": 1e-9,
        "compl_inf_tol": 1e-12,
        "acceptable_iter": 0,
        "bound_relax_factor": 0.0,
        "max_iter": 3000,
    },
}


class Program:
    """The smooth program min f(z), lower <= g(z) <= upper in z = (x, additional variables)."""

    def __init__(self, p):
        self.p = p
        x = ca.SX.sym("x", p["n"])
        z, rows, lower, self.owner = [x], [], [], []

        def variable():
            z.append(ca.SX.sym("t"))
            return z[-1]

        def row(value, kind_lower, owner):
            rows.append(value)
            lower.append(kind_lower)
            self.owner.append(owner)

        def smooth(outer, pieces, owner):
            """A smooth expression that is at least the value of outer(pieces), and equal to it at a solution."""
            if outer == "identity":
                return pieces[0]
            if outer == "maximum":
                t = variable()
                for piece in pieces:
                    row(piece - t, -INF, owner)
                return t
            total = 0
            for piece in pieces:  # "absolutes", or "maxima": lists of pieces whose largest ones are added
                total += smooth("maximum", [piece, -piece] if outer == "absolutes" else piece, owner)
            return total

        self.f = smooth(*p["objective"](x), None)
        for j, (kind, outer, pieces) in enumerate(p["constraints"](x)):
            if outer == "maximum":
                for piece in pieces:
                    row(piece, -INF, j)
            else:
                row(smooth(outer, pieces, None), 0.0 if kind == "equality" else -INF, j)
        self.z, self.g = ca.vertcat(*z), ca.vertcat(*rows)
        self.glower, self.count = np.array(lower), len(lower)
        self.solver = ca.nlpsol("s", "ipopt", {"x": self.z, "f": self.f, "g": self.g}, IPOPT)
        self.evaluate = ca.Function(
            "e", [self.z], [self.f, ca.gradient(self.f, self.z), self.g, ca.jacobian(self.g, self.z)]
        )
        self.true = ca.Function(
            "t", [x], [value(*p["objective"](x))] + [value(o, q) for _, o, q in p["constraints"](x)]
        )
        free = np.full(self.z.numel() - p["n"], INF)
        self.zlower, self.zupper = np.concatenate([p["lower"], -free]), np.concatenate([p["upper"], free])

    def at(self, x):
        values = [float(v) for v in self.true(x)]
        return values[0], values[1:]

    def complete(self, x):
        """The additional variables start at a common large value, where the rows of the maxima hold."""
        f, c = self.at(x)
        return np.concatenate([x, np.full(self.z.numel() - self.p["n"], 1.0 + abs(f))])

    def ipopt(self, x):
        r = self.solver(
            x0=self.complete(x), lbx=self.zlower, ubx=self.zupper, lbg=self.glower, ubg=np.zeros(self.count)
        )
        ok = self.solver.stats()["success"]
        return ok, np.array(r["x"]).ravel(), np.array(r["lam_g"]).ravel()

    def slsqp(self, z):
        cache = {}

        def call(v):
            key = v.tobytes()
            if key not in cache:
                cache.clear()
                cache[key] = [np.array(a.full()) for a in self.evaluate(v)]
            return cache[key]

        eq = self.glower == 0.0
        parts = []
        for kind, mask, sign in [("eq", eq, 1.0), ("ineq", ~eq, -1.0)]:
            if mask.any():
                fun = lambda v, m=mask, s=sign: s * call(v)[2].ravel()[m]
                jac = lambda v, m=mask, s=sign: s * call(v)[3][m]
                parts.append({"type": kind, "fun": fun, "jac": jac})
        bounds = [(None if l == -INF else l, None if u == INF else u) for l, u in zip(self.zlower, self.zupper)]
        r = minimize(
            lambda v: float(call(v)[0].ravel()[0]),
            z,
            jac=lambda v: call(v)[1].ravel(),
            method="SLSQP",
            bounds=bounds,
            constraints=parts,
            options={"ftol": 1e-15, "maxiter": 300},
        )
        return r.x, float(r.fun)


def value(outer, pieces):
    if outer == "identity":
        return pieces[0]
    if outer == "maximum":
        return ca.mmax(ca.vertcat(*pieces))
    if outer == "absolutes":
        return ca.sum1(ca.fabs(ca.vertcat(*pieces)))
    return sum(value("maximum", part) for part in pieces)


def violation(p, x, c):
    kinds = [kind for kind, _, _ in p["constraints"](ca.SX.sym("x", p["n"]))]
    outside = [abs(v) if kind == "equality" else max(v, 0.0) for kind, v in zip(kinds, c)]
    return max([0.0] + outside + list(np.maximum(p["lower"] - x, 0)) + list(np.maximum(x - p["upper"], 0)))


def rounded_up(v):
    """Two significant digits, at least one half."""
    if v <= 0.5:
        return 0.5
    unit = 10.0 ** (math.floor(math.log10(v)) - 1)
    return round(math.ceil(v / unit - 1e-9) * unit, 10)


def solve(p):
    program, rng = Program(p), np.random.default_rng(1)
    starts = [p["start"]]
    for spread in [0.05, 0.2, 0.5, 1.0] if p["n"] < 80 else [0.1]:
        starts.append(p["start"] + spread * (np.abs(p["start"]) + 0.1) * rng.uniform(-1, 1, p["n"]))
    found = []
    for start in starts:
        ok, z, multipliers = program.ipopt(np.clip(start, p["lower"], p["upper"]))
        x = z[: p["n"]]
        f, c = program.at(x)
        if math.isfinite(f) and violation(p, x, c) < 1e-7:
            found.append((f, ok, z, multipliers, c))
    if not found:
        return None
    from_start = found[0][0]
    best = min(found, key=lambda r: r[0] + (0 if r[1] else 1e-9 * (1 + abs(r[0]))))
    f, ok, z, multipliers, c = best
    others = sorted({f"{r[0]:.9g}" for r in found if r[0] > f + 1e-7 * (1 + abs(f))})
    x = z[: p["n"]]
    disturbed = z + 1e-3 * (1e-3 + np.abs(z)) * rng.uniform(-1, 1, z.size)
    zs, fs = program.slsqp(np.clip(disturbed, program.zlower, program.zupper))
    cs = program.at(zs[: p["n"]])[1]
    own = [abs(m) for m, owner in zip(multipliers, program.owner) if owner is not None]
    kinds = p["constraints"](ca.SX.sym("x", p["n"]))
    nonlinear = [j for j in range(len(c)) if j not in p["linear"]]
    active = [j for j in nonlinear if kinds[j][0] == "equality" or c[j] > -ACTIVE]
    ties = [kinks(p, j, x) for j in active if kinds[j][0] == "nonsmooth"]
    return record(
        p, program, f, x, sum(own), active, ok, fs, violation(p, zs[: p["n"]], cs), others, "SLSQP", ties, from_start
    )


def kinks(p, j, x):
    """Active pieces of a maximum; of a sum of maxima, the terms with two equal pieces."""
    _, outer, pieces = p["constraints"](ca.DM(x))[j]
    if outer == "maximum":
        return sum(1 for v in pieces if float(v) > -ACTIVE)
    return sum(1 for part in pieces if len(part) > 1 and abs(float(part[0] - part[1])) < ACTIVE)


def record(p, program, f, x, multipliers, active, ok, second, second_violation, others, second_name, ties, from_start):
    probe = p["start"] + 0.1 * np.sin(np.arange(1.0, p["n"] + 1)) * (np.abs(p["start"]) + 0.1)
    probe = np.clip(probe, p["lower"], p["upper"])
    probe_f, probe_c = program.at(probe)
    return {
        "name": p["name"],
        "n": p["n"],
        "m": len(probe_c),
        "optimum": f,
        "active": len(active),
        "active_constraints": [j + 1 for j in active],
        "multiplier_sum": multipliers,
        "penalty": rounded_up(1.5 * multipliers),
        "converged": bool(ok),
        "second_solver": second_name,
        "second_optimum": second,
        "second_violation": second_violation,
        "known": p["known"],
        "optimum_from_start": from_start,
        "other_local_optima": [float(v) for v in others],
        "kinks": ties,
        "start": [float(v) for v in p["start"]],
        "lower": [float(v) if math.isfinite(v) else None for v in p["lower"]],
        "upper": [float(v) if math.isfinite(v) else None for v in p["upper"]],
        "probe": [float(v) for v in probe],
        "probe_value": probe_f,
        "probe_constraints": probe_c,
        "minimiser": [float(v) for v in x],
    }


class Matrices:
    """The functions of a problem with limits on eigenvalues."""

    def __init__(self, p):
        self.p = p

    def at(self, x):
        largest = [float(np.linalg.eigvalsh(a0 + np.tensordot(x, a, 1))[-1]) for a0, a in self.p["matrices"]]
        return float(self.p["cost"] @ x), largest


def solve_eigenvalue(p):
    """min cost . x, every largest eigenvalue of A0 + sum x_i A_i at most 0, x in a box."""
    n, blocks, rows, rhs, cones = p["n"], p["matrices"], [], [], []
    for i in range(n):
        for sign, bound in [(-1.0, -p["lower"][i]), (1.0, p["upper"][i])]:
            if math.isfinite(bound):
                rows.append(sign * np.eye(n)[i])
                rhs.append(bound)
    if rows:
        cones.append(clarabel.NonnegativeConeT(len(rows)))
    scale = lambda a: np.array([a[i, j] * (1 if i == j else math.sqrt(2)) for j in range(len(a)) for i in range(j + 1)])
    for a0, a in blocks:
        rows.extend(np.array([scale(m) for m in a]).T)
        rhs.extend(-scale(a0))
        cones.append(clarabel.PSDTriangleConeT(len(a0)))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-11
    matrix = sparse.csc_matrix(np.array(rows))
    s = clarabel.DefaultSolver(sparse.csc_matrix((n, n)), p["cost"], matrix, np.array(rhs), cones, settings).solve()
    x, f = np.array(s.x), float(s.obj_val)
    gap = abs(f - s.obj_val_dual) / (1 + abs(f))
    offset = len(rhs) - sum(len(a0) * (len(a0) + 1) // 2 for a0, _ in blocks)
    multipliers = 0.0
    for a0, _ in blocks:
        size = len(a0)
        multipliers += sum(s.z[offset + j * (j + 3) // 2] for j in range(size))
        offset += size * (size + 1) // 2
    program = Matrices(p)
    spectra = [np.linalg.eigvalsh(a0 + np.tensordot(x, a, 1)) for a0, a in blocks]
    ties = [int(sum(v > -1e-4 for v in spectrum)) for spectrum in spectra]
    active = [j for j, spectrum in enumerate(spectra) if spectrum[-1] > -1e-6]
    second, outside = cholesky(p, x)
    return record(p, program, f, x, multipliers, active, gap < 1e-9, second, outside, [], "IPOPT", ties, f)


def cholesky(p, x):
    v = ca.SX.sym("x", p["n"])
    variables, rows, starts = [v], [], [x]
    for a0, a in p["matrices"]:
        size = len(a0)
        factor = ca.SX.sym("l", ca.Sparsity.lower(size))
        total = ca.SX(a0) + sum((v[i] * ca.SX(a[i]) for i in range(p["n"])), ca.SX(size, size))
        gap = -total - ca.densify(factor) @ ca.densify(factor).T
        rows += [gap[i, j] for i in range(size) for j in range(i + 1)]
        current = -(a0 + np.tensordot(x, a, 1)) + 1e-3 * np.eye(size)
        start = np.linalg.cholesky(current)
        variables.append(ca.vertcat(*factor.nonzeros()))
        starts.append(np.array([start[i, j] for j in range(size) for i in range(j, size)]))
    z = ca.vertcat(*variables)
    solver = ca.nlpsol("s", "ipopt", {"x": z, "f": ca.dot(ca.DM(p["cost"]), v), "g": ca.vertcat(*rows)}, IPOPT)
    free = z.numel() - p["n"]
    lower, upper = [
        np.concatenate([p[side], np.full(free, sign * INF)]) for side, sign in [("lower", -1), ("upper", 1)]
    ]
    r = solver(x0=np.concatenate(starts), lbx=lower, ubx=upper, lbg=0, ubg=0)
    found = np.array(r["x"]).ravel()[: p["n"]]
    return float(r["f"]), max(0.0, *Matrices(p).at(found)[1])


def main():
    chosen, results = sys.argv[1:], []
    for p in SMOOTH + EIGENVALUE:
        if chosen and p["name"] not in chosen:
            continue
        r = solve_eigenvalue(p) if "matrices" in p else solve(p)
        if r is None:
            print(f"{p['name']:22} NOT SOLVED")
            continue
        results.append(r)
        scale = 1 + abs(r["optimum"])
        gap = (r["second_optimum"] - r["optimum"]) / scale
        known = "-" if r["known"] is None else f"{(r['known'] - r['optimum']) / scale:.0e}"
        print(
            f"{r['name']:24} n {r['n']:3} m {r['m']:2} f* {r['optimum']:20.13g} active {r['active']:2}",
            f"kinks {r['kinks']}",
            f"sum of multipliers {r['multiplier_sum']:.5g} converged {r['converged']}",
            f"second solver {gap:.0e} violation {r['second_violation']:.0e} known {known}",
            f"other minima {r['other_local_optima']}",
            flush=True,
        )
    if not chosen:
        path = pathlib.Path(__file__).with_name("constrained.json")
        lines = ",\n".join(json.dumps(r, allow_nan=False) for r in results)
        path.write_text('{"problems": [\n' + lines + "\n]}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
