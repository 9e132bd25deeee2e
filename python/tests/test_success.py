"""Success is claimed where it is true, on the whole collection."""

import collections

import numpy as np
import pytest

import nonsmooth


@pytest.mark.parametrize("tells, least", [(False, 22), (True, 34)])
def test_success_is_never_claimed_wrongly(collection, tells, least):
    reasons, solved = collections.Counter(), 0
    for name, problem in collection.items():
        rows, lower, upper = problem.rows
        result = nonsmooth.minimize(
            problem,
            problem.start,
            bounds=np.transpose(problem.bounds),
            constraints=[(rows, lower, upper)] if len(rows) else (),
            options={"convex": tells and problem.convex},
        )
        reached = result.fun - problem.optimal_value <= 1e-6 * (1 + abs(problem.optimal_value))
        solved += reached
        reasons[result.reason] += 1
        assert reached or not result.success, name
        # An optimum that is not confirmed is called stationary, but no success.
        assert result.success == (result.reason == "stationary")
    # Two of 44 are not solved. The last bits, and with them the processor, decide a problem or two.
    assert solved >= 42 and reasons["stationary"] >= least - 2, (solved, reasons)
