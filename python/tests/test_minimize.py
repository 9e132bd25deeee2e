"""Calls in the habits of scipy: bounds, constraints, options, results."""

import pickle
import re
import time

import numpy as np
import pytest
import scipy.optimize
import scipy.sparse
from scipy.optimize import Bounds, LinearConstraint

import nonsmooth
from conftest import l1, same_bits


def test_the_minimum_of_a_convex_function_is_confirmed():
    result = nonsmooth.minimize(l1, [5.0, -3.0], options={"convex": True})
    assert result.success and result.status == 0 and result.reason == "stationary"
    # The tolerance 1e-7 is relative to the size of the function near the minimum, here at most its variation.
    assert result.fun < 1e-6
    assert result.gap < 1e-6
    assert result.nfev == len(result.history) == result.njev
    assert isinstance(result, scipy.optimize.OptimizeResult)
    assert result.x.shape == result.jac.shape == (2,)


@pytest.mark.parametrize(
    "constraints",
    [
        LinearConstraint([[1, 1]], -np.inf, 2),
        LinearConstraint([1, 1], ub=2),
        LinearConstraint(scipy.sparse.csr_array([[1.0, 1.0]]), ub=[2]),
        [LinearConstraint([[1, 1]], ub=2)],
        ([[1, 1]], -np.inf, 2),
        (np.array([[1.0, 1.0]]), -np.inf, 2),
        [([[1, 1]], -np.inf, 2), LinearConstraint([[1, 0]], -50, 50)],
        [LinearConstraint([[1, 1]], ub=2), Bounds(-50, 50)],
    ],
)
def test_linear_constraints_in_all_forms(constraints):
    result = nonsmooth.minimize(l1, [5.0, -3.0], constraints=constraints, options={"convex": True})
    assert result.success
    assert abs(result.fun - 1) < 1e-6
    # Never outside, up to rounding.
    assert result.largest_violation < 1e-12
    assert abs(result.certificate.row_multipliers[0] - 1) < 1e-6


@pytest.mark.parametrize(
    "bounds",
    [Bounds([2, -np.inf], [np.inf, 1.5]), [(2, None), (None, 1.5)], ((2, np.inf), (-np.inf, 1.5)), np.array([[2, 9], [-9, 1.5]])],
)
def test_bounds_in_all_forms(bounds):
    result = nonsmooth.minimize(l1, [5.0, -3.0], bounds=bounds, options={"convex": True})
    assert result.success
    assert np.abs(result.x - [2, 1.5]).max() < 1e-6
    assert np.abs(result.certificate.bound_multipliers - [-1, 1]).max() < 1e-6


def test_an_equality_holds_at_every_point():
    seen = []

    def fun(x):
        seen.append(x.copy())
        return l1(x)

    equality = LinearConstraint([[1, 2]], 3, 3)
    result = nonsmooth.minimize(fun, [5.0, -3.0], constraints=equality, options={"convex": True})
    assert result.success and abs(result.fun - 1) < 1e-6
    assert max(abs(x @ [1, 2] - 3) for x in seen) < 1e-12


def test_contradicting_constraints_are_infeasible():
    rows = [LinearConstraint([[1, 1]], ub=0), LinearConstraint([[1, 1]], lb=1)]
    with pytest.raises(nonsmooth.InfeasibleError, match="contradict"):
        nonsmooth.minimize(l1, [0.0, 0.0], constraints=rows)
    with pytest.raises(ValueError, match="variable 1: lower bound 2 exceeds upper bound 1"):
        nonsmooth.minimize(l1, [0.0, 0.0], bounds=[(0, 1), (2, 1)])


def test_dicts_are_refused():
    with pytest.raises(ValueError, match=r"a constraint is a dict.*NonlinearConstraint\(fun, lb, ub, jac\)"):
        nonsmooth.minimize(l1, [0.0, 0.0], constraints={"type": "ineq", "fun": lambda x: x[0]})


@pytest.mark.parametrize(
    "call, words",
    [
        (dict(options={"max_evaluation": 5}), "did you mean 'max_evaluations'"),
        (dict(options={"tolerance": 2.0}), "tolerance = 2.0 is not allowed; allowed: 0 < x < 1"),
        (dict(options={"tol": 1e-6, "tolerance": 1e-5}), "tolerance is given twice with different values"),
        (dict(tol=1e-8, options={"tolerance": 1e-6}), "option 'tolerance' = 1e-06, tol = 1e-08"),
        (dict(tol=2.0), "tolerance = 2.0 is not allowed; allowed: 0 < x < 1"),
        (dict(options={"curved_model": False}), "unknown option 'curved_model'.*allowed: accuracy, bundle_size, confirm, convex"),
        (dict(options={"serious_fraction": 0.1}), "unknown option 'serious_fraction'"),
        (dict(options={"composite_model": True}), "unknown option 'composite_model'"),
        (dict(x_scale=[1.0]), "x_scale has shape .1,., expected one number or 2"),
        (dict(x_scale=[1.0, 0.0]), "x_scale = .1.0, 0.0. is not allowed; allowed: finite numbers > 0"),
        (dict(x_scale=[1.0, np.inf]), "finite numbers > 0"),
        (dict(x_scale=2.0, options={"scaling": np.eye(2)}), "x_scale and the option scaling are both given"),
        (dict(x_scale=2.0, options={"x_scale": 3.0}), "x_scale is given twice"),
        (dict(options={"scaling": [1.0]}), "scaling has 1 entries, expected 2"),
        (dict(jac=None), "Finite differences are no subgradients"),
        (dict(bounds=[(0, 1)]), "2 pairs"),
        (dict(bounds=Bounds([0, 0, 0], 1)), "expected one number or 2"),
        (dict(constraints=LinearConstraint([[1, 1, 1]], ub=2)), "expected 2 columns"),
    ],
)
def test_bad_input_is_refused_with_words(call, words):
    with pytest.raises(ValueError, match=words):
        nonsmooth.minimize(l1, [0.0, 0.0], **call)


@pytest.mark.parametrize(
    "options, words",
    [
        ({"tolerance": "small"}, "tolerance = 'small' is not allowed; expected a number"),
        ({"max_evaluations": 2.5}, "expected an integer"),
        ({"convex": 1}, "expected True or False"),
        ({"accuracy": "rough"}, "'tightest', 'on_demand' or"),
    ],
)
def test_options_of_a_wrong_type_are_refused(options, words):
    with pytest.raises(TypeError, match=words):
        nonsmooth.minimize(l1, [0.0, 0.0], options=options)


def test_a_limit_is_no_success():
    result = nonsmooth.minimize(l1, [5.0, -3.0], options={"maxfev": 2})
    assert not result.success and result.reason == "evaluation_limit" and result.nfev == 2
    assert "max_evaluations" in result.message
    short = nonsmooth.minimize(l1, [5.0, -3.0], options={"max_seconds": 1e-9})
    assert not short.success and short.reason == "time_limit"


def test_a_wrong_subgradient_is_no_success():
    result = nonsmooth.minimize(lambda x: (x @ x, -x), [5.0, -3.0])
    assert not result.success and result.fun > 1
    # A constant slope that the values contradict.
    result = nonsmooth.minimize(lambda x: (1.0, np.ones(2)), [5.0, -3.0])
    assert not result.success and result.fun == 1


def test_an_unbounded_function_is_no_success():
    result = nonsmooth.minimize(lambda x: (x[0], np.array([1.0])), [0.0])
    assert not result.success and result.reason == "unbounded_below"


def test_args_and_separate_jac():
    both = nonsmooth.minimize(l1, [5.0, -3.0], args=((4.0, 4.0),))
    apart = nonsmooth.minimize(
        lambda x, at: l1(x, at)[0], [5.0, -3.0], jac=lambda x, at: l1(x, at)[1], args=((4.0, 4.0),)
    )
    assert np.abs(both.x - 4).max() < 1e-6
    assert same_bits(both.x, apart.x) and both.nfev == apart.nfev


def test_scipy_minimize_with_the_method():
    own = nonsmooth.minimize(l1, [5.0, -3.0], bounds=[(2, 9), (-9, 9)], options={"convex": True, "tolerance": 1e-5})
    for kind in (dict(jac=True, fun=l1), dict(jac=lambda x: l1(x)[1], fun=lambda x: l1(x)[0])):
        result = scipy.optimize.minimize(
            x0=[5.0, -3.0],
            bounds=Bounds([2, -9], 9),
            method=nonsmooth.bundle_trust,
            tol=1e-5,
            options={"convex": True},
            **kind,
        )
        assert result.success and same_bits(result.x, own.x) and result.nfev == own.nfev
        assert result.recheck().agrees


def test_callbacks_of_both_forms_and_their_stop():
    points, results = [], []
    plain = nonsmooth.minimize(l1, [5.0, -3.0], callback=points.append)
    assert len(points) == plain.nfev and same_bits(points[-1], plain.x)

    def named(intermediate_result):
        results.append(intermediate_result)
        if intermediate_result.nfev == 3:
            raise StopIteration

    stopped = nonsmooth.minimize(l1, [5.0, -3.0], callback=named)
    assert stopped.nfev == 3 and stopped.reason == "stopped" and not stopped.success
    assert results[0].record["kind"] == "start" and same_bits(results[-1].x, stopped.x)
    through = scipy.optimize.minimize(l1, [5.0, -3.0], jac=True, method=nonsmooth.bundle_trust, callback=named)
    assert through.nfev == 3
    points.clear()
    scipy.optimize.minimize(l1, [5.0, -3.0], jac=True, method=nonsmooth.bundle_trust, callback=points.append)
    assert len(points) == plain.nfev and points[0].shape == (2,)


def test_the_certificate_is_computed_again_and_pickled():
    result = nonsmooth.minimize(l1, [5.0, -3.0], constraints=([[1, 1]], -np.inf, 2), options={"convex": True})
    check = result.recheck()
    assert check.agrees and check.confirms(1e-3, 1e-5) and check.composite_difference is None
    certificate = result.certificate
    assert abs(certificate.multipliers.sum() - 1) < 1e-9
    # The aggregate subgradient by hand: cuts and the row; the norm of the run is Euclidean without a box.
    aggregate = certificate.multipliers @ certificate.subgradients + certificate.row_multipliers @ [[1, 1]]
    assert abs(np.linalg.norm(aggregate) - check.aggregate_norm) < 1e-12
    again = pickle.loads(pickle.dumps(result))
    assert again.recheck() == check and same_bits(again.x, result.x)
    assert "History of" in repr(result)


def test_a_table_is_printed_where_asked_for(capsys):
    nonsmooth.minimize(l1, [5.0, -3.0], options={"disp": True, "max_evaluations": 3})
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 4 and lines[0].split()[0] == "eval"


def test_scaling_by_sizes_and_by_a_matrix():
    sizes = nonsmooth.minimize(l1, [5.0, -3.0], options={"scaling": [10.0, 0.1]})
    matrix = nonsmooth.minimize(l1, [5.0, -3.0], options={"scaling": np.diag([10.0, 0.1])})
    assert sizes.fun < 1e-5 and matrix.fun < 1e-5
    with pytest.raises(ValueError, match="scaling"):
        nonsmooth.minimize(l1, [5.0, -3.0], options={"scaling": np.zeros((2, 2))})


def test_tol_and_x_scale_are_keywords_and_options():
    named = dict(options={"tolerance": 1e-5, "scaling": [10.0, 0.1]})
    wanted = nonsmooth.minimize(l1, [5.0, -3.0], **named)
    assert not same_bits(wanted.x, nonsmooth.minimize(l1, [5.0, -3.0]).x)
    for call in (
        dict(tol=1e-5, x_scale=[10.0, 0.1]),
        dict(tol=1e-5, options={"tolerance": 1e-5, "x_scale": [10.0, 0.1]}),
        dict(x_scale=np.array([10.0, 0.1]), options={"tol": 1e-5, "x_scale": [10.0, 0.1]}),
    ):
        assert same_bits(nonsmooth.minimize(l1, [5.0, -3.0], **call).x, wanted.x)
    through = scipy.optimize.minimize(
        l1, [5.0, -3.0], jac=True, method=nonsmooth.bundle_trust, tol=1e-5, options={"x_scale": [10.0, 0.1]}
    )
    assert same_bits(through.x, wanted.x)
    # One number stands for all variables.
    same = nonsmooth.minimize(l1, [5.0, -3.0], x_scale=3.0)
    assert same_bits(same.x, nonsmooth.minimize(l1, [5.0, -3.0], x_scale=[3.0, 3.0]).x)


def test_the_time_limit_holds_between_evaluations():
    def slow(x):
        time.sleep(0.05)
        return l1(x)

    # Three evaluations take longer; the whole run has more.
    result = nonsmooth.minimize(slow, [5.0, -3.0], options={"max_seconds": 0.12})
    assert result.reason == "time_limit" and 1 <= result.nfev <= 3 and "max_seconds" in result.message


def test_small_contradictions_are_told_as_they_are():
    for gap in (1e-7, 1e-8, 1e-9):
        rows = ([[1, 1]], 2 + gap, np.inf)
        with pytest.raises(nonsmooth.InfeasibleError) as caught:
            nonsmooth.minimize(l1, [0.0, 0.0], bounds=[(0, 1)] * 2, constraints=rows)
        told = float(re.search(r"by (\S+) \(relative", str(caught.value))[1])
        assert abs(told - gap / 2) < 0.01 * gap


def test_the_taylor_test_says_right_and_wrong(capsys):
    right = nonsmooth.taylor_test(l1, [5.0, -3.0])
    assert right.right and "subgradient: right" in capsys.readouterr().out
    quadratic = nonsmooth.taylor_test(lambda x: (x @ x, 2 * x), [5.0, -3.0], disp=False)
    assert quadratic.right and abs(quadratic.fitted_slope - 2) < 0.1
    wrong = nonsmooth.taylor_test(lambda x: (x @ x, 2.01 * x), [5.0, -3.0])
    assert not wrong.right and "WRONG" in capsys.readouterr().out
