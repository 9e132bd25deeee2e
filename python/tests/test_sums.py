"""A smooth function plus a convex function of outputs, against solutions by other methods."""

import pickle

import numpy as np
import pytest
import scipy.optimize

import nonsmooth


def squares(A, b):
    """|A x - b|^2/2 with its gradient."""
    return lambda x: (0.5 * (A @ x - b) @ (A @ x - b), A.T @ (A @ x - b))


def fit(n, m, active):
    """Observations of a vector with few entries that are not zero."""
    random = np.random.default_rng(n + m)
    A = random.standard_normal((m, n))
    x = np.where(np.arange(n) < active, 2 * random.standard_normal(n), 0.0)
    return A, A @ x + 0.1 * random.standard_normal(m)


def variables(x):
    return x, np.eye(len(x))


@pytest.mark.parametrize("m", [50, 100])
def test_the_lasso(m):
    A, b = fit(20, m, 5)
    smooth, weight = squares(A, b), 0.1 * np.abs(A.T @ b).max()
    result = nonsmooth.minimize_composite("l1", variables, np.zeros(20), smooth=smooth, weight=weight)
    # Positive and negative parts; then the equations on the support, whose optimality is checked.
    split = scipy.optimize.minimize(
        lambda z: (smooth(z[:20] - z[20:])[0] + weight * z.sum(), np.kron([1, -1], smooth(z[:20] - z[20:])[1]) + weight),
        np.zeros(40), jac=True, bounds=[(0, None)] * 40, options=dict(maxfun=10**5, maxiter=10**5, ftol=1e-15, gtol=1e-9),
    ).x
    near = split[:20] - split[20:]
    support = np.abs(near) > 1e-5
    x = np.zeros(20)
    x[support] = np.linalg.solve(A[:, support].T @ A[:, support], A[:, support].T @ b - weight * np.sign(near[support]))
    assert (x * near >= 0).all() and np.abs(smooth(x)[1][~support]).max() <= weight
    least = smooth(x)[0] + weight * np.abs(x).sum()
    assert result.success and abs(result.fun - least) < 1e-8 * least
    assert result.nfev < 80 < nonsmooth.minimize(
        lambda x: (smooth(x)[0] + weight * np.abs(x).sum(), smooth(x)[1] + weight * np.sign(x)), np.zeros(20)
    ).nfev
    check = result.recheck()
    # The cuts may confirm the end before the composite model does.
    assert check.agrees and (check.composite_difference or 0.0) < 1e-9
    assert pickle.loads(pickle.dumps(result)).recheck() == check


def test_a_support_vector_machine():
    random = np.random.default_rng(1)
    points, normal = random.standard_normal((200, 10)), random.standard_normal(10)
    side = np.sign(points @ normal + 0.5 * random.standard_normal(200))
    slopes, ridge = -side[:, None] * points, 0.01
    result = nonsmooth.minimize_composite(
        "hinge",
        lambda w: (1 + slopes @ w, slopes),
        np.zeros(10),
        smooth=lambda w: (ridge / 2 * w @ w, ridge * w),
        weight=1 / 200,
    )
    # The dual program: every a in [0, 1/200]^200 bounds the minimum from below.
    product = slopes @ slopes.T / ridge
    a = scipy.optimize.minimize(
        lambda a: (0.5 * a @ product @ a - a.sum(), product @ a - 1), np.full(200, 0.0025), jac=True,
        bounds=[(0, 1 / 200)] * 200, options=dict(maxfun=10**5, maxiter=10**5, ftol=1e-16, gtol=1e-12, maxcor=50),
    ).x
    bound = a.sum() - 0.5 * a @ product @ a
    assert result.success and -1e-15 < result.fun - bound < 1e-8 * bound
    assert result.nfev < 15


def test_the_group_lasso():
    A, b = fit(12, 40, 6)
    groups = np.arange(12).reshape(4, 3)
    smooth, weight = squares(A, b), 0.3 * max(np.linalg.norm((A.T @ b)[group]) for group in groups)
    result = nonsmooth.minimize_composite(
        "norm", variables, np.zeros(12), groups=[3] * 4, smooth=smooth, weight=weight, tol=1e-8
    )
    # The proximal gradient method.
    x, step = np.zeros(12), np.linalg.norm(A, 2) ** -2
    for _ in range(5000):
        x = (x - step * smooth(x)[1]).reshape(4, 3)
        size = np.linalg.norm(x, axis=1, keepdims=True)
        x = (x * np.maximum(0, 1 - step * weight / np.maximum(size, 1e-300))).ravel()
    least = smooth(x)[0] + weight * np.linalg.norm(x[groups], axis=1).sum()
    assert result.success and abs(result.fun - least) < 1e-8 * least
    assert result.nfev < 60 and result.recheck().agrees


def test_other_outer_functions_args_and_constraints():
    def smooth(x, at):
        return 0.5 * (x - at) @ (x - at), x - at

    def own(c):
        return np.abs(c).sum(), np.sign(c)

    at = np.array([3.0, -2.0, 0.1])
    call = dict(args=(at,), smooth=smooth, constraints=([[1, 1, 1]], -np.inf, 0.5), options={"convex": True})
    named = nonsmooth.minimize_composite("l1", lambda x, at: variables(x), np.zeros(3), weight=0.5, **call)
    mine = nonsmooth.minimize_composite(own, lambda x, at: variables(x), np.zeros(3), weight=0.5, **call)
    # With the multiplier ν of the row, x = (2.5 − ν, −1.5 − ν, 0) while |0.1 − ν| ≤ 0.5: the sum is 0.5 for ν = 0.25.
    for result in (named, mine):
        assert result.success and np.abs(result.x - [2.25, -1.75, 0]).max() < 1e-4
    assert abs(named.fun - mine.fun) < 1e-8
    largest = nonsmooth.minimize_composite("max", lambda x, at: variables(x), np.zeros(3), **call)
    assert largest.success and mine.recheck().agrees and largest.recheck().agrees


@pytest.mark.parametrize(
    "call, error, words",
    [
        (dict(smooth=3), TypeError, "smooth is int, expected a function"),
        (dict(weight=2.0), ValueError, "weight belongs to a sum: pass smooth"),
        (dict(smooth=lambda x: (x @ x, 2 * x), weight=-1), ValueError, "weight = -1.0 is not allowed"),
        (dict(smooth=lambda x: x @ x), TypeError, "smooth must return .value, gradient."),
        (dict(smooth=lambda x: (x @ x, x[:1])), ValueError, "the gradient that smooth returns has 1 entries, expected 2"),
        (dict(groups=[2]), ValueError, "groups belong to outer = 'norm'"),
        (dict(outer="norm", groups=[1, 2]), ValueError, "fun returns 2 outputs, but the groups hold 3"),
        (dict(outer="norm", groups=[1, 0]), ValueError, "groups = .1, 0. is not allowed"),
    ],
)
def test_bad_sums_are_refused(call, error, words):
    with pytest.raises(error, match=words):
        nonsmooth.minimize_composite(fun=variables, x0=[1.0, 2.0], **{"outer": "l1", **call})
    failure = RuntimeError("smooth failed")

    def fails(x):
        raise failure

    with pytest.raises(RuntimeError) as caught:
        nonsmooth.minimize_composite("l1", variables, [1.0, 2.0], smooth=fails)
    assert caught.value is failure
