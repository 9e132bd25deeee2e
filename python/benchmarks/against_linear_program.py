"""Time of a dense fit in absolute values beside that of its linear program.

`python against_linear_program.py [VARIABLES RESIDUALS]` minimizes |Ax - b|_1 of a random A with `minimize_composite("l1")` and by scipy's
`linprog(method="highs")`, and prints the processor time of both, without that of the evaluations, and their ratio.
"""

import sys
import time

import numpy as np
from scipy.optimize import linprog

import nonsmooth


def main(variables=500, residuals=1000):
    random = np.random.default_rng(0)
    matrix, wanted = random.standard_normal((residuals, variables)), random.standard_normal(residuals)
    costs = np.r_[np.zeros(variables), np.ones(residuals)]
    unit = np.eye(residuals)
    sides = np.block([[matrix, -unit], [-matrix, -unit]])
    clock = time.process_time()
    program = linprog(costs, A_ub=sides, b_ub=np.r_[wanted, -wanted], bounds=(None, None), method="highs")
    of_program = time.process_time() - clock
    clock, evaluations = time.process_time(), 0.0

    def fit(x):
        nonlocal evaluations
        begin = time.process_time()
        answer = matrix @ x - wanted, matrix
        evaluations += time.process_time() - begin
        return answer

    result = nonsmooth.minimize_composite("l1", fit, np.zeros(variables))
    own = time.process_time() - clock - evaluations
    print(f"linprog {of_program:.2f} s, value {program.fun:.10g}")
    print(f"minimize_composite {own:.2f} s, value {result.fun:.10g}, {result.nfev} evaluations, ratio {own / of_program:.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
