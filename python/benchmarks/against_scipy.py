"""Evaluations and success of nonsmooth and of other methods on the same functions; prints the tables of docs/python.md.

`python against_scipy.py` prints for each function and method f - f* at the end, relative to 1 + |f*|, and the evaluations to
1e-6 (or all that were used, in brackets), and marks a claimed success that is none with `!`. A second table has the methods of
NLopt, CMA-ES, nsopy and PyGRANSO that are installed.
"""

import contextlib
import importlib.util
import io
import warnings

import numpy as np
import scipy.optimize
from scipy.optimize import LinearConstraint

import nonsmooth

METHODS = ["BFGS", "L-BFGS-B", "SLSQP", "trust-constr", "COBYLA"]
# Column, package of the index.
OTHERS = [
    ("NLopt MMA", "nlopt"),
    ("NLopt SLSQP", "nlopt"),
    ("CMA-ES", "cma"),
    ("nsopy subgradient", "nsopy"),
    ("PyGRANSO", "pygranso"),
]
LEVEL = 1e-6
EVALUATIONS = 1500


def maxq(x):
    i = np.argmax(x * x)
    return x[i] ** 2, 2 * x[i] * np.eye(len(x))[i]


def crescent(x):
    circle = x[0] ** 2 + (x[1] - 1) ** 2
    pieces = (circle + x[1] - 1, -circle + x[1] + 1)
    sign = 1.0 if pieces[0] >= pieces[1] else -1.0
    return max(pieces), np.array([2 * sign * x[0], 2 * sign * (x[1] - 1) + 1])


def chained_lq(x):
    a, b = x[:-1], x[1:]
    first, second = -a - b, -a - b + (a * a + b * b - 1)
    curved = second > first
    gradient = np.zeros_like(x)
    gradient[:-1] += -1 + 2 * a * curved
    gradient[1:] += -1 + 2 * b * curved
    return np.maximum(first, second).sum(), gradient


def cb2(x):
    e = 2 * np.exp(x[1] - x[0])
    pieces = [x[0] ** 2 + x[1] ** 4, (2 - x[0]) ** 2 + (2 - x[1]) ** 2, e]
    slopes = [[2 * x[0], 4 * x[1] ** 3], [2 * x[0] - 4, 2 * x[1] - 4], [-e, e]]
    i = int(np.argmax(pieces))
    return pieces[i], np.array(slopes[i])


def maxquad():
    """Lemarechal's maximum of five quadratics in ten variables."""
    i = np.arange(1, 11)
    pieces = []
    for k in range(1, 6):
        matrix = np.exp(np.minimum.outer(i, i) / np.maximum.outer(i, i)) * np.cos(np.outer(i, i)) * np.sin(k)
        np.fill_diagonal(matrix, 0)
        np.fill_diagonal(matrix, i / 10 * abs(np.sin(k)) + np.abs(matrix).sum(axis=1))
        pieces.append((matrix, np.exp(i / k) * np.sin(i * k)))

    def fun(x):
        values = [x @ a @ x - b @ x for a, b in pieces]
        a, b = pieces[int(np.argmax(values))]
        return max(values), 2 * a @ x - b

    return fun


def simplex():
    """|B x - c|_1 over the unit simplex; the optimum by linear programming."""
    random = np.random.default_rng(5)
    n, m = 8, 20
    matrix, right = random.normal(size=(m, n)), random.normal(size=m)

    def fun(x):
        residual = matrix @ x - right
        return np.abs(residual).sum(), matrix.T @ np.sign(residual)

    rows = np.block([[matrix, -np.eye(m)], [-matrix, -np.eye(m)]])
    program = scipy.optimize.linprog(
        np.r_[np.zeros(n), np.ones(m)], rows, np.r_[right, -right], np.r_[np.ones(n), np.zeros(m)][None], [1],
        [(0, None)] * n + [(None, None)] * m,
    )
    sets = dict(bounds=[(0, 1)] * n, constraints=LinearConstraint(np.ones((1, n)), 1, 1))
    return fun, np.full(n, 1 / n), program.fun, sets


def functions():
    """Name, function, start, optimal value, constraints, convex."""
    big = np.arange(1.0, 21) * np.where(np.arange(1, 21) <= 10, 1, -1)
    fun, start, least, sets = simplex()
    return [
        ("MAXQ, 20 variables", maxq, big, 0.0, {}, True),
        ("Crescent, 2", crescent, np.array([-1.5, 2.0]), 0.0, {}, False),
        ("CB2, 2", cb2, np.array([1.0, -0.1]), 1.9522244939, {}, True),
        ("MAXQUAD, 10", maxquad(), np.ones(10), -0.8414083346, {}, True),
        ("Chained LQ, 20", chained_lq, np.full(20, -0.5), -19 * np.sqrt(2), {}, True),
        ("L1 on a simplex, 8", fun, start, least, sets, True),
    ]


def nlopt_claims(name, fun, start):
    """Whether NLopt says that it has converged."""
    import nlopt

    algorithm = {"NLopt MMA": nlopt.LD_MMA, "NLopt SLSQP": nlopt.LD_SLSQP}[name]
    method = nlopt.opt(algorithm, len(start))

    def objective(x, gradient):
        value, subgradient = fun(x.copy())
        if gradient.size:
            gradient[:] = subgradient
        return value

    method.set_min_objective(objective)
    method.set_xtol_rel(1e-9)
    method.set_maxeval(EVALUATIONS)
    try:
        method.optimize(start)
    except (nlopt.RoundoffLimited, RuntimeError):
        return False
    return method.last_optimize_result() in (nlopt.SUCCESS, nlopt.FTOL_REACHED, nlopt.XTOL_REACHED)


def cma_claims(fun, start):
    """Whether CMA-ES, which uses the values alone, says that it has converged."""
    import cma

    strategy = cma.CMAEvolutionStrategy(start, 0.5, {"verbose": -9, "seed": 1, "maxfevals": EVALUATIONS})
    strategy.optimize(lambda x: fun(np.asarray(x))[0])
    return bool({"tolfun", "tolx", "tolfunhist"} & set(strategy.stop()))


def nsopy_claims(fun, start):
    """The subgradient method of nsopy with steps 1/k; it claims nothing."""
    from nsopy.methods.subgradient import SubgradientMethod

    method = SubgradientMethod(lambda x: (x, *fun(x)), lambda x: x, dimension=len(start))
    method.lambda_k = start.copy()
    while True:
        method.dual_step()


def pygranso_claims(fun, start, sets):
    """Whether PyGRANSO says that it has converged; bounds [0, 1] and rows are constraints that it may violate by 1e-10."""
    import torch
    from pygranso.pygranso import pygranso
    from pygranso.pygransoStruct import pygransoStruct

    def column(values):
        return torch.tensor(np.atleast_2d(values).reshape(len(values), -1), dtype=torch.double)

    def combined(variables):
        x = variables.x.detach().numpy().ravel().copy()
        value, subgradient = fun(x)
        if not sets:
            return [value, column(subgradient), None, None, None, None]
        one, row = np.eye(len(x)), sets["constraints"].A[0]
        outside, slopes = np.r_[-x, x - 1], np.hstack([-one, one])
        return [value, column(subgradient), column(outside), column(slopes), column([row @ x - 1]), column(row)]

    options = pygransoStruct()
    options.x0, options.globalAD, options.print_level, options.QPsolver = column(start), False, 0, "osqp"
    options.maxit, options.opt_tol, options.quadprog_info_msg = EVALUATIONS, 1e-8, False
    if sets:
        options.viol_ineq_tol = options.viol_eq_tol = 1e-10
    torch.set_default_dtype(torch.double)
    # It prints whatever the function raises, and ends the program.
    with contextlib.redirect_stdout(io.StringIO()):
        return pygranso({"x": [len(start), 1]}, combined, options).termination_code in (0, 1)


def run(method, fun, start, least, sets, convex):
    """Relative error, evaluations, whether 1e-6 was reached, whether success was claimed."""
    values = []

    def counted(x):
        answer = fun(x)
        feasible = True
        if sets:
            feasible = x.min() >= -1e-8 and x.max() <= 1 + 1e-8 and abs(x.sum() - 1) <= 1e-8
        values.append((answer[0] - least) / (1 + abs(least)) if feasible else np.inf)
        if len(values) > EVALUATIONS:
            raise StopIteration
        return answer

    claimed = False
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if method == "nonsmooth":
                claimed = nonsmooth.minimize(counted, start, options={"convex": convex}, **sets).success
            elif method.startswith("NLopt"):
                claimed = nlopt_claims(method, counted, start)
            elif method == "CMA-ES":
                claimed = cma_claims(counted, start)
            elif method == "nsopy subgradient":
                nsopy_claims(counted, start)
            elif method == "PyGRANSO":
                claimed = pygranso_claims(counted, start, sets)
            elif method == "COBYLA":
                value = lambda x: counted(x)[0]
                claimed = scipy.optimize.minimize(value, start, method=method, options={"maxiter": EVALUATIONS}, **sets).success
            else:
                options = {"maxiter": EVALUATIONS}
                claimed = scipy.optimize.minimize(counted, start, jac=True, method=method, options=options, **sets).success
    except (StopIteration, SystemExit):
        pass
    best = min(values)
    hits = [index + 1 for index, value in enumerate(values) if value <= LEVEL]
    return best, hits[0] if hits else len(values), bool(hits), bool(claimed)


def table(methods=METHODS):
    """Lines of the table, and (reached, claimed, claimed wrongly) per method."""
    lines = ["| error / evaluations | nonsmooth | " + " | ".join(methods) + " |", "|---" * (len(methods) + 2) + "|"]
    totals = {method: [0, 0, 0] for method in ["nonsmooth", *methods]}
    unconstrained = {"BFGS", "L-BFGS-B", *(name for name, _ in OTHERS if name != "PyGRANSO")}
    for name, fun, start, least, sets, convex in functions():
        cells = []
        for method, total in totals.items():
            if sets and method in unconstrained:
                cells.append("–")
                continue
            error, count, reached, claimed = run(method, fun, start, least, sets, convex)
            total[0] += reached
            total[1] += claimed
            total[2] += claimed and not reached
            mark = "!" if claimed and not reached else ""
            cells.append(f"{max(error, 0):.0e} / {count if reached else f'({count})'}{mark}")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    for text, index in (("reached 1e-6", 0), ("claimed success", 1), ("claimed wrongly", 2)):
        lines.append(f"| {text} | " + " | ".join(str(total[index]) for total in totals.values()) + " |")
    return lines, totals


if __name__ == "__main__":
    print("\n".join(table()[0]))
    installed = [name for name, package in OTHERS if importlib.util.find_spec(package)]
    if installed:
        print("\n" + "\n".join(table(installed)[0]))
