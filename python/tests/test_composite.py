"""Convex functions of outputs."""

import numpy as np
import pytest
import scipy.sparse

import nonsmooth
from conftest import same_bits

POINTS = np.sin(np.arange(1.0, 41.0)).reshape(20, 2)


def residuals(x, shift=0.0):
    """A linear fit with outliers: POINTS x - b."""
    b = POINTS @ [1.0, -2.0] + shift
    b = b + np.where(np.arange(20) % 7 == 0, 3.0, 0.0)
    return POINTS @ x - b, POINTS


def curve(x):
    outputs = np.array([x[0] ** 4 + x[1] ** 2, (2 - x[0]) ** 2 + (2 - x[1]) ** 2, 2 * np.exp(x[1] - x[0])])
    e = outputs[2]
    return outputs, np.array([[4 * x[0] ** 3, 2 * x[1]], [2 * x[0] - 4, 2 * x[1] - 4], [-e, e]])


def test_minimax_in_one_line():
    result = nonsmooth.minimize_composite("max", curve, [2.0, 2.0])
    assert result.success and abs(result.fun - 2) < 1e-6 and result.nfev < 12
    check = result.recheck()
    assert check.agrees and check.composite_difference < 1e-12


def test_l1_ignores_outliers():
    result = nonsmooth.minimize_composite("l1", residuals, [0.0, 0.0])
    assert result.success and np.abs(result.x - [1, -2]).max() < 1e-6
    assert abs(result.fun - 9) < 1e-6


def test_powers_and_norm_agree_with_least_squares():
    b = -residuals(np.zeros(2))[0]
    x = np.linalg.lstsq(POINTS, b, rcond=None)[0]
    least = np.linalg.norm(POINTS @ x - b)
    norm = nonsmooth.minimize_composite("norm", residuals, [0.0, 0.0])
    assert norm.success and abs(norm.fun - least) < 1e-6
    squares = nonsmooth.minimize_composite("power", residuals, [0.0, 0.0], exponent=2)
    assert squares.success and abs(squares.fun - least**2) < 1e-5
    assert np.abs(squares.x - x).max() < 1e-4


def test_a_function_of_the_user_as_outer():
    calls = []

    def largest(c):
        calls.append(c)
        i = c.argmax()
        return c[i], np.eye(len(c))[i]

    own = nonsmooth.minimize_composite(largest, curve, [2.0, 2.0])
    named = nonsmooth.minimize_composite("max", curve, [2.0, 2.0])
    # Cuts of the named function pass through zero, since it is homogeneous; of the user's nothing of this kind is known: rounding differs.
    assert np.abs(own.x - named.x).max() < 1e-9 and own.nfev == named.nfev and calls
    assert own.recheck().agrees


def test_constraints_args_and_sparse_jacobians():
    def sparse(x, shift):
        outputs, jacobian = residuals(x, shift)
        return outputs, scipy.sparse.csr_array(jacobian)

    result = nonsmooth.minimize_composite("l1", sparse, [0.0, 0.0], args=(0.5,), constraints=([[1, 1]], 0, 0))
    dense = nonsmooth.minimize_composite("l1", residuals, [0.0, 0.0], args=(0.5,), constraints=([[1, 1]], 0, 0))
    assert result.success and abs(result.x.sum()) < 1e-12 and same_bits(result.x, dense.x)


def test_exceptions_of_outer_and_inner_come_back():
    error = KeyError("outer")

    def outer(c):
        if outer.calls == 3:
            raise error
        outer.calls += 1
        return np.abs(c).sum(), np.sign(c)

    outer.calls = 0
    with pytest.raises(KeyError) as caught:
        nonsmooth.minimize_composite(outer, residuals, [0.0, 0.0])
    assert caught.value is error and error.best.fun > 0
    inner = ZeroDivisionError()

    def fails(x):
        raise inner

    with pytest.raises(ZeroDivisionError) as caught:
        nonsmooth.minimize_composite("max", fails, [0.0, 0.0])
    assert caught.value is inner and inner.best is None


@pytest.mark.parametrize(
    "call, error, words",
    [
        (("min", curve), ValueError, "outer = 'min' is unknown; allowed: 'max', 'l1', 'hinge', 'power', 'norm', or"),
        ((3, curve), TypeError, "outer is int"),
        (("max", lambda x: (np.ones(3), np.ones((2, 2)))), ValueError, r"has shape \(2, 2\), expected \(3, 2\)"),
        (("max", lambda x: 1.0), TypeError, "fun must return .outputs, Jacobian"),
    ],
)
def test_bad_input_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        nonsmooth.minimize_composite(*call, [2.0, 2.0])
    with pytest.raises(ValueError, match="exponent = 0.5 is not allowed"):
        nonsmooth.minimize_composite("power", curve, [2.0, 2.0], exponent=0.5)


def test_a_composite_run_is_resumed(tmp_path):
    whole = nonsmooth.minimize_composite("max", curve, [2.0, 2.0])
    nonsmooth.minimize_composite("max", curve, [2.0, 2.0], journal=tmp_path, options={"max_evaluations": 4})
    result = nonsmooth.minimize_composite("max", curve, [2.0, 2.0], resume=tmp_path)
    assert same_bits(result.x, whole.x) and result.nfev == whole.nfev
    with pytest.raises(ValueError, match="another objective.*outer function"):
        nonsmooth.minimize_composite("l1", curve, [2.0, 2.0], resume=tmp_path)


def test_a_number_of_outputs_that_changes_ends_the_run():
    calls = []

    def outputs(x):
        calls.append(x)
        values, jacobian = curve(x)
        count = 3 if len(calls) < 3 else 2
        return values[:count], jacobian[:count]

    result = nonsmooth.minimize_composite("max", outputs, [2.0, 2.0])
    assert not result.success and (result.reason, result.status) == ("function_contradictory", 11)
    assert "has 2 entries, expected 3" in result.message and result.nfev == 3 and result.fun <= 20


@pytest.mark.parametrize("broken", [[0, 1], [0], [1]])
@pytest.mark.parametrize("outer", ["max", "l1", lambda c: (np.abs(c).max(), np.eye(2)[np.abs(c).argmax()] * np.sign(c))])
def test_outputs_that_are_no_numbers_shorten_the_step(outer, broken):
    def outputs(x):
        values = np.array([9 - x[0], 8 - x[0]])
        if x[0] > 1:
            values[broken] = np.nan
        return values, np.array([[-1.0], [-1.0]])

    result = nonsmooth.minimize_composite(outer, outputs, [0.0], bounds=[(0, 5)])
    assert result.reason == "function_failing" and abs(result.x[0] - 1) < 1e-6
    assert "is NaN, expected a finite number" in result.message
