"""Nonlinear constraints: scipy's objects, constraints returned with the function, what is refused, what a result says."""

import json
import pickle

import numpy as np
import pytest
import scipy.optimize
from scipy.optimize import Bounds, LinearConstraint

import nonsmooth
from conftest import l1, same_bits, without_times
from nonsmooth import _engine, _minimize
from nonsmooth._engine import ConstrainedProblem

NAMES = [name for name in ConstrainedProblem.names() if len(ConstrainedProblem(name).start) <= 10]


def disc(lb, ub):
    """lb <= x @ x <= ub."""
    return scipy.optimize.NonlinearConstraint(lambda x: x @ x, lb, ub, jac=lambda x: 2 * x)


def rosen_suzuki(x):
    a, b, c, d = x
    value = a**2 + b**2 + 2 * c**2 + d**2 - 5 * a - 5 * b - 21 * c + 7 * d
    return value, np.array([2 * a - 5, 2 * b - 5, 4 * c - 21, 2 * d + 7])


def rosen_suzuki_limits(x):
    """Three values, each at least 0 where the point is feasible, and their Jacobian."""
    a, b, c, d = x
    values = [
        8 - a**2 - b**2 - c**2 - d**2 - a + b - c + d,
        10 - a**2 - 2 * b**2 - c**2 - 2 * d**2 + a + d,
        5 - 2 * a**2 - b**2 - c**2 - 2 * a + b + d,
    ]
    jacobian = [
        [-2 * a - 1, -2 * b + 1, -2 * c - 1, -2 * d + 1],
        [-2 * a + 1, -4 * b, -2 * c, -4 * d + 1],
        [-4 * a - 2, -2 * b + 1, -2 * c, 1],
    ]
    return np.array(values), np.array(jacobian)


def limits(lb=0, ub=np.inf):
    return scipy.optimize.NonlinearConstraint(
        lambda x: rosen_suzuki_limits(x)[0], lb, ub, jac=lambda x: rosen_suzuki_limits(x)[1]
    )


def rosenbrock(x):
    kink = x[0] ** 2 - x[1]
    side = 1 if kink >= 0 else -1
    return 8 * abs(kink) + (1 - x[0]) ** 2, np.array([16 * side * x[0] - 2 * (1 - x[0]), -8 * side])


def kinked(x):
    """max(sqrt(2) x0, 2 x1) with a subgradient."""
    first, second = np.sqrt(2) * x[0], 2 * x[1]
    return (first, np.array([np.sqrt(2), 0])) if first >= second else (second, np.array([0, 2.0]))


def test_rosen_suzuki():
    result = nonsmooth.minimize(rosen_suzuki, np.zeros(4), constraints=limits())
    assert result.success and result.reason == "stationary", result.message
    # The tolerance 1e-7 is relative to the size of the function, 44; at a regular solution the error is of its order.
    assert abs(result.fun + 44) < 44e-6
    assert np.abs(result.x - [0, 1, 2, -1]).max() < 1e-3
    assert result.constr_violation < 1e-8
    (values,), (multipliers,) = result.constr, result.multipliers
    assert np.abs(values - rosen_suzuki_limits(result.x)[0]).max() < 1e-12
    # Published multipliers 1, 0, 2, at the lower sides.
    assert np.abs(multipliers - [-1, 0, -2]).max() < 1e-2
    assert result.penalty > 0 and result.jac is not None
    assert same_bits(result.jac, rosen_suzuki(result.x)[1])


def test_a_nonsmooth_constraint_of_a_nonsmooth_function():
    limit = nonsmooth.NonlinearConstraint(lambda x: kinked(x)[0], -np.inf, 1, lambda x: kinked(x)[1], nonsmooth=True)
    result = nonsmooth.minimize(rosenbrock, [-1.2, 1.0], constraints=limit)
    # Curtis, Overton, SIAM J. Optim. 22 (2012), example 5.1.
    assert np.abs(result.x - [np.sqrt(0.5), 0.5]).max() < 1e-5
    assert abs(result.fun - (1 - np.sqrt(0.5)) ** 2) < 1e-6
    assert result.constr_violation < 1e-8


def test_the_same_objects_as_slsqp():
    """Hock-Schittkowski 66 by both methods."""

    def fun(x):
        return 0.2 * x[2] - 0.8 * x[0], np.array([-0.8, 0, 0.2])

    limit = scipy.optimize.NonlinearConstraint(
        lambda x: [x[1] - np.exp(x[0]), x[2] - np.exp(x[1])],
        0,
        np.inf,
        jac=lambda x: [[-np.exp(x[0]), 1, 0], [0, -np.exp(x[1]), 1]],
    )
    start, bounds = [0.0, 1.05, 2.9], Bounds([0, 0, 0], [100, 100, 10])
    own = nonsmooth.minimize(fun, start, bounds=bounds, constraints=limit)
    with np.errstate(all="ignore"):
        other = scipy.optimize.minimize(
            fun, start, jac=True, bounds=bounds, constraints=limit, method="SLSQP", options={"ftol": 1e-12}
        )
    assert own.success and other.success
    # Both tolerances lie below this difference.
    assert abs(own.fun - other.fun) < 1e-6 and abs(own.fun - 0.5181632741) < 1e-6
    through = scipy.optimize.minimize(
        fun, start, jac=True, bounds=bounds, constraints=limit, method=nonsmooth.bundle_trust
    )
    assert same_bits(through.x, own.x) and through.nfev == own.nfev


def test_two_sides_and_their_multipliers():
    for sign in (1, -1):
        # Least and largest first coordinate of the ring 1 <= x @ x <= 4 in the half plane x0 >= 0.1.
        result = nonsmooth.minimize(
            lambda x: (sign * x[0] + x[1] ** 2, np.array([sign, 2 * x[1]])),
            [1.5, 0.1],
            bounds=[(0.1, None), (None, None)],
            constraints=disc(1, 4),
        )
        radius = 1 if sign == 1 else 2
        if sign == 1:
            # The minimum on the inner circle: x0 + 1 - x0**2 is least at an end of 0.1 <= x0 <= 1.
            assert result.fun <= 1 + 1e-6
        else:
            assert result.success and abs(result.fun + radius) < 1e-6
            # -1 + v * 2 * 2 = 0.
            assert abs(result.multipliers[0][0] - 0.25) < 1e-4
            assert abs(result.constr[0][0] - 4) < 1e-6
        assert result.constr_violation < 1e-8
    inner = nonsmooth.minimize(
        lambda x: ((x - [0.5, 0]) @ (x - [0.5, 0]), 2 * (x - [0.5, 0])), [1.5, 0.1], constraints=disc(1, 4)
    )
    # x = (1, 0): 2 * 0.5 + v * 2 = 0.
    assert inner.success and abs(inner.fun - 0.25) < 1e-6
    assert abs(inner.multipliers[0][0] + 0.5) < 1e-4


def test_an_equality():
    result = nonsmooth.minimize(l1, [0.5, 0.5], constraints=disc(1, 1))
    # The point of the circle with the largest sum of coordinates, (1, 1)/√2, is the nearest to (1, 2) in the sum of absolute values.
    assert abs(result.fun - (3 - np.sqrt(2))) < 1e-6 and result.constr_violation < 1e-8
    # -1 + v * sqrt(2) = 0.
    assert abs(result.multipliers[0][0] - np.sqrt(0.5)) < 1e-3
    line = scipy.optimize.NonlinearConstraint(lambda x: x[0] + x[1], 1, 1, jac=lambda x: np.ones((1, 2)))
    squares = nonsmooth.minimize(lambda x: (x @ x, 2 * x), [3.0, 1.0], constraints=line)
    # The tolerance 1e-7 of the values leaves the square root of it to the point.
    assert squares.success and np.abs(squares.x - 0.5).max() < 3e-4 and abs(squares.fun - 0.5) < 1e-7
    # 2 * 0.5 + v = 0: the sign of an equality is free.
    assert abs(squares.multipliers[0][0] + 1) < 1e-4


def test_sides_of_components_and_open_ones():
    fun = lambda x: np.array([x[0], x[1], x[0] * x[1], x[0] + x[1]])
    jac = lambda x: np.array([[1, 0], [0, 1], [x[1], x[0]], [1, 1]])
    mixed = scipy.optimize.NonlinearConstraint(fun, [2, -np.inf, -np.inf, -10], [2, 1.5, np.inf, 10], jac=jac)
    result = nonsmooth.minimize(l1, [0.0, 0.0], constraints=[mixed, LinearConstraint([[0, 1]], -5, 5)])
    assert result.success and np.abs(result.x - [2, 1.5]).max() < 1e-6
    (values,), (multipliers,) = result.constr, result.multipliers
    assert np.isnan(values[2]) and np.abs(values[[0, 1, 3]] - [2, 1.5, 3.5]).max() < 1e-6
    assert np.abs(multipliers - [-1, 1, 0, 0]).max() < 1e-6
    open_only = scipy.optimize.NonlinearConstraint(lambda x: x @ x, -np.inf, np.inf, jac=lambda x: 2 * x)
    free, plain = nonsmooth.minimize(l1, [5.0, -3.0], constraints=open_only), nonsmooth.minimize(l1, [5.0, -3.0])
    assert same_bits(free.x, plain.x) and np.isnan(free.constr[0]).all() and free.multipliers[0].tolist() == [0]
    assert plain.constr == plain.multipliers == [] and plain.constr_violation == 0 and plain.penalty is None


@pytest.mark.parametrize(
    "constraints, bounds",
    [
        (nonsmooth.NonlinearConstraint(lambda x: abs(x).sum(), -np.inf, -1, np.sign, nonsmooth=True), None),
        ([disc(-np.inf, 1), scipy.optimize.NonlinearConstraint(lambda x: x[0], 3, np.inf, jac=lambda x: [1.0, 0])], None),
        (disc(1, 1), [(2, 3), (2, 3)]),
    ],
)
def test_infeasible_constraints_are_no_success(constraints, bounds):
    result = nonsmooth.minimize(l1, [2.5, 2.5], constraints=constraints, bounds=bounds)
    assert not result.success and result.reason == "infeasible" and result.status == 13
    assert "infeasible: the violation of the constraints is stationary" in result.message
    assert "start elsewhere, or relax the constraints" in result.message
    assert result.constr_violation > 0.5


def test_a_limit_is_no_success():
    result = nonsmooth.minimize(rosen_suzuki, np.zeros(4), constraints=limits(), options={"max_evaluations": 3})
    assert not result.success and result.reason == "evaluation_limit" and len(result.constr[0]) == 3


def test_degenerate_constraints_are_no_success():
    # Kuhn and Tucker's example: at the end (1, 0) of the cusp, the gradients of both constraints are opposite.
    cusp = scipy.optimize.NonlinearConstraint(
        lambda x: [x[1] - (1 - x[0]) ** 3, -x[1]], -np.inf, 0, jac=lambda x: [[3 * (1 - x[0]) ** 2, 1], [0, -1]]
    )
    result = nonsmooth.minimize(lambda x: (-x[0], np.array([-1.0, 0])), [0.5, 0.5], constraints=cusp)
    assert not result.success and result.reason == "degenerate_constraints" and result.status == 14, result.message
    assert "write the constraints so that their gradients do not vanish" in result.message
    assert abs(result.fun + 1) < 1e-3


@pytest.mark.parametrize("name", NAMES)
def test_the_collection_as_in_rust(name):
    """Constraints of the same call: the run in Rust, bit for bit; success only at a known minimum."""
    problem = ConstrainedProblem(name)
    setups = []

    class Spy:
        @staticmethod
        def minimize(setup):
            setups.append(setup)
            return _engine.minimize(setup)

    _minimize._engine = Spy
    try:
        result = nonsmooth.minimize(
            problem, problem.start, bounds=np.transpose(problem.bounds), constraint_kinds=problem.kinds,
            options={"max_evaluations": 500},
        )
    finally:
        _minimize._engine = _engine
    outcome = problem.minimize(setups[0])
    assert same_bits(result.x, outcome["x"]) and result.reason == outcome["reason"] and result.penalty == outcome["penalty"]
    assert without_times(result.history) == without_times(json.loads(outcome["history"]))
    reports = json.loads(outcome["constraints"])
    assert same_bits(result.multipliers[0], [report["multiplier"] for report in reports])
    assert (result.constr[0] == problem(result.x)[2]).all()
    assert (result.jac == problem(result.x)[1]).all()
    if result.success:
        size = max(1, np.abs(result.constr[0]).max())
        assert result.constr_violation < 1e-7 * size
        # The tolerance 1e-7 refers to the size of the function, which is larger than its optimal value on some problems.
        assert min(abs(result.fun - optimum) / (1 + abs(optimum)) for optimum in problem.optima) < 1e-5
        assert result.recheck().agrees


def test_constraints_of_the_same_call_are_those_of_objects():
    def both(x):
        values, jacobian = rosen_suzuki_limits(x)
        return *rosen_suzuki(x), -values, -jacobian

    one = nonsmooth.minimize(both, np.zeros(4), constraint_kinds=["smooth"] * 3)
    two = nonsmooth.minimize(rosen_suzuki, np.zeros(4), constraints=limits())
    assert one.success and same_bits(one.x, two.x) and without_times(one.history) == without_times(two.history)
    assert np.abs(one.multipliers[0] + two.multipliers[0]).max() == 0
    assert np.abs(one.constr[0] + two.constr[0]).max() == 0
    # Some returned, the others apart.
    mixed = nonsmooth.minimize(
        lambda x: (*both(x)[:2], both(x)[2][:2], both(x)[3][:2]),
        np.zeros(4),
        constraint_kinds=("smooth", "smooth"),
        constraints=[scipy.optimize.NonlinearConstraint(lambda x: both(x)[2][2], -np.inf, 0, jac=lambda x: both(x)[3][2])],
    )
    assert same_bits(mixed.x, one.x) and [len(part) for part in mixed.constr] == [2, 1]
    # An error bound comes last.
    bounded = nonsmooth.minimize(lambda x: (*both(x), 0.0), np.zeros(4), constraint_kinds=["smooth"] * 3)
    assert same_bits(bounded.x, one.x)


def test_a_composite_function_with_constraints():
    def outputs(x):
        return x, np.eye(2)

    result = nonsmooth.minimize_composite("max", outputs, [2.0, 1.0], constraints=disc(-np.inf, 1))
    assert result.success and abs(result.fun + np.sqrt(0.5)) < 1e-6
    # (1/2, 1/2) + v * 2 x = 0.
    assert abs(result.multipliers[0][0] - np.sqrt(0.125)) < 1e-4
    check = result.recheck()
    assert check.agrees and check.violation < 1e-9
    one = nonsmooth.minimize_composite(
        "max", lambda x: (*outputs(x), [x @ x - 1], [2 * x]), [2.0, 1.0], constraint_kinds=["smooth"]
    )
    assert same_bits(one.x, result.x)
    # Norms and powers have cones or curvature of their own.
    for outer in ("norm", "power", "l1"):
        far = nonsmooth.minimize_composite(
            outer, lambda x: (x - [3, 4], np.eye(2)), [0.0, 0.0], constraints=disc(-np.inf, 1), options={"convex": True}
        )
        expected = {"norm": 4.0, "power": 16.0, "l1": 7 - np.sqrt(2)}[outer]
        assert abs(far.fun - expected) < 1e-5 * expected and far.constr_violation < 1e-8, far.message
    smooth = nonsmooth.minimize_composite(
        "l1", outputs, [1.0, 1.0], smooth=lambda x: ((x - 2) @ (x - 2), 2 * (x - 2)), constraints=disc(-np.inf, 1)
    )
    # On the circle, the point (1, 1)/√2.
    assert np.abs(smooth.x - np.sqrt(0.5)).max() < 1e-5


def test_certificates_with_constraints_are_computed_again_and_pickled():
    result = nonsmooth.minimize(rosen_suzuki, np.zeros(4), constraints=limits())
    check = result.recheck()
    assert check.agrees and check.violation < 1e-9 and check.multiplier_defect < 1e-9
    again = pickle.loads(pickle.dumps(result))
    assert again.recheck() == check and same_bits(again.constr[0], result.constr[0])
    assert same_bits(again.multipliers[0], result.multipliers[0]) and again.penalty == result.penalty
    # A multiplier of another size is seen.
    text, admissible = result.certificate.__getnewargs__()
    wrong = json.loads(text)
    wrong["constraints"]["cuts"][0]["multiplier"] *= 1.1
    again.certificate = nonsmooth.Certificate(json.dumps(wrong), admissible)
    assert not again.recheck().agrees


def test_a_run_with_constraints_is_resumed(tmp_path):
    calls = []

    def fun(x):
        calls.append(None)
        return rosen_suzuki(x)

    whole = nonsmooth.minimize(fun, np.zeros(4), constraints=limits(np.zeros(3)))
    journal = tmp_path / "run"
    nonsmooth.minimize(fun, np.zeros(4), constraints=limits(np.zeros(3)), journal=journal, options={"maxfev": 5})
    calls.clear()
    resumed = nonsmooth.minimize(fun, np.zeros(4), constraints=limits(np.zeros(3)), resume=journal)
    assert same_bits(resumed.x, whole.x) and without_times(resumed.history) == without_times(whole.history)
    assert len(calls) == whole.nfev - 5
    assert same_bits(resumed.multipliers[0], whole.multipliers[0]) and same_bits(resumed.jac, whole.jac)
    with pytest.raises(ValueError, match="with constraints: 3 smooth"):
        nonsmooth.minimize(fun, np.zeros(4), resume=journal)


def from_the_third_call(first, then):
    """A function that returns something else from its third call on."""
    calls = []

    def fun(x):
        calls.append(None)
        return (first if len(calls) < 3 else then)(x)

    return fun


@pytest.mark.parametrize(
    "change, words",
    [
        (dict(fun=lambda x: [x @ x, 1.0]), r"constraints\[1\].fun returns values of shape \(2,\), expected \(1,\)"),
        (dict(fun=lambda x: "much"), r"what constraints\[1\].fun returns is 'much', expected real numbers"),
        (dict(jac=lambda x: np.eye(2)), r"constraints\[1\].jac returns an array of shape \(2, 2\), expected \(1, 2\)"),
        (dict(jac=lambda x: [1.0, 2.0, 3.0]), r"constraints\[1\].jac returns an array of shape \(3,\), expected \(1, 2\)"),
        (dict(jac=lambda x: None), r"constraints\[1\].jac returns an array of shape \(\), expected \(1, 2\)"),
    ],
)
@pytest.mark.parametrize("late", [False, True])
def test_wrong_answers_name_the_constraint(change, words, late):
    good = dict(fun=lambda x: x @ x, jac=lambda x: 2 * x)
    functions = {**good, **{name: from_the_third_call(good[name], wrong) if late else wrong for name, wrong in change.items()}}
    bad = scipy.optimize.NonlinearConstraint(functions["fun"], [-np.inf], [1], jac=functions["jac"])
    with pytest.raises((TypeError, ValueError), match=words) as found:
        nonsmooth.minimize(rosenbrock, [-1.2, 1.0], constraints=[disc(-np.inf, 4), bad])
    assert (found.value.best is not None) == late


@pytest.mark.parametrize(
    "answer, words",
    [
        (lambda x: (*l1(x), [0.0], np.zeros((2, 2))), "the vector of constraints that fun returns has 1 entries, expected 2"),
        (lambda x: (*l1(x), [0.0, 0.0], np.zeros((1, 2))), r"has shape \(1, 2\), expected \(2, 2\) \(constraints, variables\)"),
        (lambda x: (*l1(x), [0.0, "x"], np.zeros((2, 2))), "the vector of constraints that fun returns is list"),
        (lambda x: l1(x), r"fun must return \(value, subgradient, constraints, their Jacobian\)"),
    ],
)
@pytest.mark.parametrize("late", [False, True])
def test_wrong_constraints_of_the_function_are_refused(answer, words, late):
    good = lambda x: (*l1(x), [x @ x - 1, x[0] - 4], [2 * x, [1.0, 0]])
    with pytest.raises((TypeError, ValueError), match=words):
        nonsmooth.minimize(
            from_the_third_call(good, answer) if late else answer, [5.0, -3.0], constraint_kinds=["smooth", "smooth"]
        )


def test_entries_that_are_not_finite_shorten_the_step():
    def log(x):
        return np.log(x[0]) if x[0] > 0 else np.nan

    limit = scipy.optimize.NonlinearConstraint(log, -1, np.inf, jac=lambda x: [1 / x[0], 0])
    result = nonsmooth.minimize(
        lambda x: (x[0] + abs(x[1]), np.array([1, np.sign(x[1])])), [3.0, 2.0], constraints=limit, options={"first_step": 10.0}
    )
    assert result.counts["failed"] > 0 and abs(result.fun - np.exp(-1)) < 1e-6
    # At the start nothing can be shortened; the constraint is named.
    with pytest.raises(nonsmooth.OutsideDomain, match=r"constraints\[1\].fun has an entry in component 0 that is not finite"):
        nonsmooth.minimize(l1, [-1.0, 0.0], constraints=[disc(-np.inf, 9), limit])
    late = from_the_third_call(lambda x: [1.0, 0.0], lambda x: [np.nan, 0.0])
    failing = scipy.optimize.NonlinearConstraint(lambda x: x[0], -np.inf, 9, jac=late)
    result = nonsmooth.minimize(rosenbrock, [-1.2, 1.0], constraints=failing)
    assert not result.success and result.reason == "function_failing"
    assert "constraints[0].jac has an entry in component 0 that is not finite" in result.message
    with pytest.raises(ValueError, match="constraint values: entry 1 is NaN, expected a finite number"):
        nonsmooth.minimize(
            lambda x: (*l1(x), [0.0, np.nan], np.zeros((2, 2))), [0.0, 0.0], constraint_kinds=["smooth", "equality"]
        )


def test_exceptions_of_a_constraint_come_back():
    class Broken(Exception):
        pass

    def broken(x):
        raise Broken

    limit = scipy.optimize.NonlinearConstraint(from_the_third_call(lambda x: x @ x, broken), [-np.inf], [1], jac=lambda x: 2 * x)
    with pytest.raises(Broken) as found:
        nonsmooth.minimize(rosenbrock, [-1.2, 1.0], constraints=limit)
    assert found.value.best.nfev == 2 and not found.value.best.success


@pytest.mark.parametrize(
    "keywords, words",
    [
        (dict(), r"constraints\[1\]: jac = '2-point' is not allowed: pass a function"),
        (dict(jac="3-point"), "jac = '3-point' is not allowed"),
        (dict(jac="cs"), "jac = 'cs' is not allowed"),
        (dict(jac=lambda x: 2 * x, keep_feasible=True), r"constraints\[1\]: keep_feasible = True cannot be promised"),
        (dict(jac=lambda x: 2 * x, keep_feasible=[False, True]), "keep_feasible = True"),
        (dict(jac=lambda x: 2 * x, lb=2), "component 0 has lb > ub, which no point satisfies"),
        (dict(jac=lambda x: 2 * x, ub=-np.inf), "component 0 has ub = -inf"),
        (dict(jac=lambda x: 2 * x, lb=np.nan), "has entries that are NaN"),
        (dict(jac=lambda x: 2 * x, lb=[0, 0]), r"constraints\[1\].fun returns values of shape \(1,\), expected \(2,\)"),
        (dict(jac=lambda x: 2 * x, lb=[0, 0], ub=[1, 1, 1]), r"constraints\[1\].lb has shape \(2,\), expected one number or 3"),
    ],
)
def test_what_cannot_be_promised_is_refused(keywords, words):
    keywords = {"lb": -np.inf, "ub": 1, **keywords}
    constraint = scipy.optimize.NonlinearConstraint(lambda x: x @ x, **keywords)
    with pytest.raises(ValueError, match=words):
        nonsmooth.minimize(l1, [0.0, 0.0], constraints=[LinearConstraint([[1, 1]], -9, 9), constraint])


def test_second_derivatives_of_a_constraint_are_ignored():
    own = scipy.optimize.NonlinearConstraint(lambda x: x @ x, -np.inf, 1, jac=lambda x: 2 * x, hess=lambda x, v: 2 * v[0] * np.eye(2))
    with_hess, without = (nonsmooth.minimize(l1, [0.0, 0.0], constraints=one) for one in (own, disc(-np.inf, 1)))
    assert same_bits(with_hess.x, without.x)


def test_a_nonsmooth_equality_is_refused():
    kinked_equality = nonsmooth.NonlinearConstraint(lambda x: kinked(x)[0], 1, 1, lambda x: kinked(x)[1], nonsmooth=True)
    with pytest.raises(ValueError, match=r"constraints\[0\]: component 0 has lb = ub, but a nonsmooth.*no linearization can be satisfied"):
        nonsmooth.minimize(rosenbrock, [-1.2, 1.0], constraints=kinked_equality)
    for kinds, error, words in (
        (["smooth", "nonsmooth_equality"], ValueError, r"constraint_kinds\[1\] = 'nonsmooth_equality' is unknown.*no linearization"),
        (["hard"], ValueError, r"constraint_kinds\[0\] = 'hard' is unknown; allowed: 'smooth', 'nonsmooth', 'equality'"),
        ("smooth", TypeError, "expected a list of 'smooth'"),
        (3, TypeError, "expected a list"),
    ):
        with pytest.raises(error, match=words):
            nonsmooth.minimize(rosenbrock, [-1.2, 1.0], constraint_kinds=kinds)


def test_the_size_of_a_constraint_costs_one_call_at_the_start():
    calls = []

    def counted(x):
        calls.append(x.copy())
        return x @ x

    limit = scipy.optimize.NonlinearConstraint(counted, -np.inf, 1, jac=lambda x: 2 * x)
    result = nonsmooth.minimize(l1, [0.5, 0.5], constraints=limit)
    # The first evaluation uses the value of the call for the size.
    assert len(calls) == result.nfev
    calls.clear()
    result = nonsmooth.minimize(l1, [0.5, -7.0], bounds=[(-1, 1), (-1, 1)], constraints=limit)
    assert len(calls) == result.nfev and all((abs(x) <= 1).all() for x in calls)
