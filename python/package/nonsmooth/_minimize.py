"""`minimize`, `minimize_composite`, and the method for `scipy.optimize.minimize`."""

import glob
import inspect
import json
import os
import threading

import numpy as np
from scipy.optimize import OptimizeResult

from . import _constraints, _engine, _nonlinear, _options, _result
from ._identity import identity
from ._numbers import real

#: Runs within runs. A function that calls itself without end must not run out of stack in the engine, which would kill the process.
_DEEPEST = 20
_depth = threading.local()

#: Names of outer functions.
OUTER = ("max", "l1", "hinge", "power", "norm")


def minimize(
    fun,
    x0,
    jac=True,
    args=(),
    bounds=None,
    constraints=(),
    options=None,
    callback=None,
    *,
    tol=None,
    x_scale=None,
    constraint_kinds=(),
    journal=None,
    resume=None,
):
    """Minimise a nonsmooth function with bounds, linear and nonlinear constraints.

    Parameters
    ----------
    fun : callable
        ``fun(x, *args)`` returns ``(value, subgradient)``. One subgradient per point is enough, where the function has
        a kink that of either side; for one variable it may be a number. With ``jac`` a callable, ``fun`` returns the
        value alone. ``fun`` is called only at points that satisfy bounds and linear constraints. If it takes the keyword
        ``accuracy``, it is told which relative accuracy is enough, and may return ``(value, subgradient, error_bound)``; 0 means as
        accurate as it can.
        Raise ``nonsmooth.OutsideDomain``, or return NaN, where ``fun`` is not defined: the step is shortened.
        Every other exception ends the run and is raised again, the same object; its attribute ``best`` is the
        ``Result`` so far (None if there is none).
    x0 : array_like
        Start with n entries. It need not satisfy the constraints.
    jac : True or callable
        True if ``fun`` returns the subgradient too, or ``jac(x, *args)``, which returns it. Differences of values are
        no subgradients of a nonsmooth function and are not offered.
    args : tuple
        Further arguments of ``fun`` and ``jac``; anything but a tuple is one argument, as for scipy.
    bounds : scipy.optimize.Bounds or sequence of pairs, optional
        ``(lower, upper)`` for every variable; None or infinity leaves a side open.
    constraints : scipy.optimize.LinearConstraint, (A, lower, upper), scipy.optimize.NonlinearConstraint, or a list of these
        ``lower <= A x <= upper``; equal sides make an equality. A may be sparse. A nonlinear constraint needs a callable ``jac``;
        points that are evaluated may violate it. ``nonsmooth.NonlinearConstraint(..., nonsmooth=True)`` may have kinks.
        Where ``lb`` and ``ub`` are numbers, its ``fun`` is called once more, at x0, for the number of its values.
    options : dict, optional
        See Notes. An unknown name is refused.
    callback : callable, optional
        ``callback(xk)`` or ``callback(intermediate_result=...)`` after every evaluation, with the best point accepted so far;
        the latter has ``x``, ``fun``, ``nfev`` and ``record``. ``StopIteration`` ends the run.
    tol : float, optional
        The option ``tolerance`` under scipy's name.
    x_scale : float or array_like, optional
        Typical sizes of the variables, n numbers > 0 or one for all: the units in which lengths of steps are measured.
        Give them where variables have different units.
    constraint_kinds : sequence of {'smooth', 'nonsmooth', 'equality'}
        What is asked of m constraints that ``fun`` returns with its value: c <= 0, or c = 0 for an equality, which is smooth. ``fun``
        then returns ``(value, subgradient, c, J)`` with the m × n matrix J of derivatives of c, and may add ``error_bound``.
    journal, resume : path, optional
        ``journal``: every evaluation is kept in this new folder. ``resume``: continues the run of such a folder, which
        ends as if it had never been interrupted; call it with the same arguments. Limits and the tolerance may differ; another
        start, other ``args``, constraints, sides or options are refused. The function itself must be the same, too.

    Returns
    -------
    Result
        A ``scipy.optimize.OptimizeResult`` with ``certificate``, ``history`` and ``recheck()``.

    Raises
    ------
    ValueError, TypeError
        Input that cannot be worked with; the message names it and what is allowed.
    InfeasibleError
        Bounds and linear constraints contradict each other. It is a ``ValueError``.

    Notes
    -----
    Options, with their defaults:

    tolerance : float, 1e-7 (also ``tol``)
        Predicted decrease, relative to the size of the function, that counts as small.
    max_evaluations : int, 2000 (also ``maxfev``)
        Largest number of evaluations.
    max_iterations : int, 100000 (also ``maxiter``)
        Largest number of steps, each with at most one evaluation.
    max_seconds : float, none
        Largest time.
    convex : bool, False
        Whether the function and its nonlinear inequalities are known to be convex. The run then bounds how far it is from the minimum
        (``gap``). Nonlinear equalities leave no such bound.
    first_step : float, chosen from x0
        Length of the first step.
    objective_scale : float, chosen from the values
        The size of the function that ``tolerance`` refers to.
    x_scale : array, from the bounds
        As the keyword.
    scaling : array, from the bounds
        A regular matrix M (n, n) in place of sizes: the run takes the course of x = M b in b. Sizes (n) are taken too.
    accuracy : 'tightest', 'on_demand' or (tightest, coarsest, factor)
        What ``fun`` is asked for. On demand if ``fun`` takes the keyword ``accuracy``, else tightest.
    bundle_size : int, n + 15, at most 500
        Largest number of cuts.
    confirm : bool, True
        Whether up to n + 1 evaluations next to the best point are spent to confirm an end.
    disp : bool, False
        Print one line per evaluation.

    Examples
    --------
    >>> import numpy as np, nonsmooth
    >>> def fun(x):
    ...     return np.abs(x - [1, 2]).sum(), np.sign(x - [1, 2])
    >>> result = nonsmooth.minimize(fun, [5.0, -3.0], constraints=([[1, 1]], -np.inf, 2), options={"convex": True})
    >>> result.success, round(result.fun, 6)
    (True, 1.0)
    """
    return _run(
        _joined(fun, jac, args), fun, x0, bounds, constraints, options, callback, journal, resume,
        tol=tol, x_scale=x_scale, kinds=constraint_kinds, jac=jac, args=args,
    )


def minimize_composite(
    outer,
    fun,
    x0,
    args=(),
    bounds=None,
    constraints=(),
    options=None,
    callback=None,
    *,
    exponent=2.0,
    groups=None,
    smooth=None,
    weight=1.0,
    tol=None,
    x_scale=None,
    constraint_kinds=(),
    journal=None,
    resume=None,
):
    """Minimise a convex function of outputs whose Jacobian is known, alone or added to a smooth function.

    Minimax problems, sums of absolute values and norms need a fraction of the evaluations in this form. With ``smooth``,
    the function is ``smooth(x) + weight * outer(fun(x))``: a fit with a penalty for example (lasso, group lasso), or a
    support vector machine.

    Parameters
    ----------
    outer : {'max', 'l1', 'hinge', 'power', 'norm'} or callable
        The convex function h: the largest output, the sum of absolute values, of positive parts max(0, c), of powers of
        absolute values, the Euclidean norm, or a function ``outer(c)`` that returns its value and one subgradient.
    fun : callable
        ``fun(x, *args)`` returns ``(outputs, jacobian)``: m outputs and the m × n matrix of their derivatives. For one
        variable, the m derivatives alone are enough.
    x0, args, bounds, constraints, options, callback : optional
        As for `minimize`; `x0` is needed.
    exponent : float
        The exponent of ``'power'``, at least 1.
    groups : sequence of int, optional
        With ``'norm'``: numbers of outputs in consecutive groups, whose norms are added. Subproblems then take seconds
        for some dozen outputs, since norms are approximated by planes.
    smooth : callable, optional
        ``smooth(x, *args)`` returns ``(value, gradient)`` of a differentiable function that is added.
    weight : float
        With ``smooth``: factor of the outer function, > 0.
    tol, x_scale, constraint_kinds, journal, resume : optional
        As for `minimize`.

    Returns
    -------
    Result
        As of `minimize`; ``recheck()`` computes the outer function again.

    Notes
    -----
    ``taylor_test(lambda x: (fun(x)[0] @ w, fun(x)[1].T @ w), x)`` tests a Jacobian along weights w of the outputs, and
    ``taylor_test(smooth, x)`` tests the smooth part.

    Examples
    --------
    >>> import numpy as np, nonsmooth
    >>> def lines(x):
    ...     return np.array([x[0], -x[0], x[1] - 1]), np.array([[1.0, 0], [-1, 0], [0, 1]])
    >>> result = nonsmooth.minimize_composite("max", lines, [3.0, 4.0])
    >>> result.success, abs(result.fun) < 1e-9
    (True, True)

    The lasso, here of two variables: squares of residuals and a weight on the sum of absolute values.

    >>> A, b = np.array([[1.0, 0.2], [0.2, 1.0]]), np.array([2.0, 0.1])
    >>> def squares(x):
    ...     return 0.5 * (A @ x - b) @ (A @ x - b), A.T @ (A @ x - b)
    >>> result = nonsmooth.minimize_composite("l1", lambda x: (x, np.eye(2)), [0.0, 0.0], smooth=squares, weight=0.5)
    >>> result.success, bool(abs(result.x[1]) < 1e-12)
    (True, True)
    """
    outer = _outer(outer, exponent, groups, weight, smooth)
    smooth = None if smooth is None else _with_args(smooth, args)
    return _run(
        _joined(fun, True, args), fun, x0, bounds, constraints, options, callback, journal, resume,
        tol=tol, x_scale=x_scale, kinds=constraint_kinds, outer=outer, smooth=smooth, args=args,
    )


def _outer(outer, exponent, groups, weight, smooth):
    """The outer function as the engine takes it; weight is none without a smooth part."""
    if isinstance(outer, str):
        if outer not in OUTER:
            names = ", ".join(repr(name) for name in OUTER)
            raise ValueError(f"outer = {outer!r} is unknown; allowed: {names}, or a function")
    elif not callable(outer):
        raise TypeError(f"outer is {type(outer).__name__}, expected a name or a function")
    exponent, weight = real(exponent, "exponent"), real(weight, "weight")
    if outer == "power" and not (exponent.ndim == 0 and np.isfinite(exponent) and exponent >= 1):
        raise ValueError(f"exponent = {exponent} is not allowed; allowed: a finite number ≥ 1")
    if not (weight.ndim == 0 and np.isfinite(weight) and weight > 0):
        raise ValueError(f"weight = {weight} is not allowed; allowed: a finite number > 0")
    if smooth is None and weight != 1:
        raise ValueError("weight belongs to a sum: pass smooth as well")
    if smooth is not None and not callable(smooth):
        raise TypeError(f"smooth is {type(smooth).__name__}, expected a function")
    return {
        "function": outer,
        "exponent": float(exponent),
        "groups": _groups(outer, groups),
        "weight": None if smooth is None else float(weight),
    }


def _groups(outer, groups):
    if groups is None:
        return None
    if not isinstance(outer, str) or outer != "norm":
        raise ValueError("groups belong to outer = 'norm'")
    sizes = real(groups, "groups")
    if sizes.ndim != 1 or sizes.size == 0 or not ((sizes >= 1) & (sizes == np.floor(sizes)) & np.isfinite(sizes)).all():
        raise ValueError(f"groups = {groups!r} is not allowed; allowed: integers ≥ 1, the numbers of outputs in the groups")
    return [int(size) for size in sizes]


def bundle_trust(
    fun, x0, args=(), jac=None, hess=None, hessp=None, bounds=None, constraints=(), callback=None, **options
):
    """The method for ``scipy.optimize.minimize(fun, x0, jac=True, method=nonsmooth.bundle_trust)``.

    Parameters
    ----------
    fun, x0, args, jac : as `scipy.optimize.minimize` passes them
        As for `minimize`. ``jac=True``, or a function, is needed: scipy passes on all else as None.
    hess, hessp : None
        Second derivatives are refused.
    bounds, constraints, callback : optional
        As for `minimize`.
    **options
        Those of `minimize`; scipy's ``tol`` is ``tolerance``. Journals are for `minimize` alone.

    Returns
    -------
    Result
        As of `minimize`.

    Examples
    --------
    >>> import numpy as np, scipy.optimize, nonsmooth
    >>> fun = lambda x: (abs(x).max(), np.eye(2)[abs(x).argmax()] * np.sign(x[abs(x).argmax()]))
    >>> options = {"convex": True}
    >>> scipy.optimize.minimize(fun, [1.0, 2.0], jac=True, method=nonsmooth.bundle_trust, options=options).success
    True
    """
    if hess is not None or hessp is not None:
        raise ValueError("bundle_trust uses no second derivatives: leave out hess and hessp")
    owner = getattr(jac, "__self__", None)
    if owner is not None and owner is fun and hasattr(fun, "fun"):
        # scipy has split a function that returns both.
        fun, jac = fun.fun, True
    return minimize(fun, x0, jac, args, bounds, constraints, options, callback)


def _joined(fun, jac, args):
    """One function of x alone that returns value and subgradient."""
    if not callable(fun):
        raise TypeError(f"fun is {type(fun).__name__}, expected a function")
    if not isinstance(args, tuple):
        args = (args,)
    if callable(jac):
        informed = takes_accuracy(jac)
        return lambda x, **accuracy: (fun(x, *args, **accuracy), jac(x, *args, **(accuracy if informed else {})))
    if jac is not True:
        raise ValueError(
            f"jac = {jac!r} is not allowed: pass jac=True and let fun return (value, subgradient), or pass a function. "
            "Finite differences are no subgradients of a nonsmooth function"
        )
    return _with_args(fun, args)


def _with_args(fun, args):
    """A function of x alone."""
    if not isinstance(args, tuple):
        args = (args,)
    return (lambda x, **accuracy: fun(x, *args, **accuracy)) if args else fun


def takes_accuracy(fun):
    """Whether a function has a parameter of the name `accuracy`."""
    try:
        return "accuracy" in inspect.signature(fun).parameters
    except (TypeError, ValueError):
        # A function without a signature, of C for example.
        return False


def _run(
    joined, fun, x0, bounds, constraints, options, callback, journal, resume,
    *, tol, x_scale, kinds, jac=True, outer=None, smooth=None, args=(),
):
    x0 = np.atleast_1d(real(x0, "x0"))
    if x0.ndim != 1 or x0.size == 0:
        raise ValueError(f"x0 has shape {x0.shape}, expected one dimension with at least one entry")
    accepts = takes_accuracy(fun)
    config, scaling, disp = _options.read(options, x0.size, accepts, tol, x_scale)
    places = list(enumerate(_constraints.listed(constraints)))
    admissible = _constraints.read(bounds, [one for _, one in places if not _nonlinear.is_nonlinear(one)], x0.size)
    apart = [(place, one) for place, one in places if _nonlinear.is_nonlinear(one)]
    nonlinear = _nonlinear.Nonlinear(apart, kinds, np.clip(x0, admissible["lower"], admissible["upper"]))
    name = nonlinear.identity(getattr(fun, "__qualname__", type(fun).__qualname__))
    known_by = identity(
        name, config, args=args, bounds_and_rows=admissible, sides_of_constraints=nonlinear.sides, outer_function=outer,
        smooth_function=smooth, options=scaling,
    )
    setup = {
        "fun": joined,
        "jac_apart": jac is not True,
        "takes_accuracy": accepts,
        "outer": outer,
        "smooth": smooth,
        "x0": x0,
        "constraints": admissible,
        "nonlinear": nonlinear.setup,
        "options": config,
        "scaling": scaling,
        "callback": told(callback),
        "disp": disp,
        "journal": journal_of(journal, resume, known_by),
    }
    return drive(_engine.minimize, setup, outer, nonlinear)


def drive(run, setup, outer=None, nonlinear=None):
    """Runs the engine; an exception of the user's code is raised again, with the best point."""
    depth = getattr(_depth, "runs", 0)
    if depth >= _DEEPEST:
        raise RecursionError(f"the function minimises within itself, more than {_DEEPEST} times")
    _depth.runs = depth + 1
    try:
        outcome, error = run(setup)
    finally:
        _depth.runs = depth
    result = None if outcome is None else _result.build(outcome, outer, nonlinear)
    if error is None:
        return result
    _attach(error, result)
    raise error


def told(callback):
    """The callback as the engine calls it, if there is one: true ends the run."""
    if callback is None:
        return None
    if not callable(callback):
        raise TypeError(f"callback is {type(callback).__name__}, expected a function")
    # scipy.optimize.minimize hands over a wrapper that takes the result, whatever the user's callback takes.
    wrapped = hasattr(callback, "stop_iteration")
    try:
        by_name = not wrapped and set(inspect.signature(callback).parameters) == {"intermediate_result"}
    except (TypeError, ValueError):
        by_name = False

    def tell(x, value, record):
        try:
            if not wrapped and not by_name:
                callback(x)
                return False
            record = json.loads(record)
            result = OptimizeResult(x=x, fun=value, nfev=record["evaluation"], record=record)
            callback(intermediate_result=result) if by_name else callback(result)
        except StopIteration:
            return True
        return False

    return tell


def journal_of(journal, resume, identity, has_runs=False):
    """Folder and identity for the engine; with ``has_runs``, folders below may hold journals too."""
    if journal is not None and resume is not None:
        raise ValueError("pass journal to begin a run, or resume to continue one, not both")
    folder = journal if journal is not None else resume
    if folder is None:
        return None
    folder = os.fsdecode(folder)
    # A path of the journal itself is as good as that of its folder.
    if os.path.basename(folder) == "journal.jsonl":
        folder = os.path.dirname(folder) or "."
    names = ["journal.jsonl"] + (["*/journal.jsonl"] if has_runs else [])
    exists = any(glob.glob(os.path.join(glob.escape(folder), name)) for name in names)
    if journal is not None and exists:
        raise FileExistsError(f"{folder} holds a journal: pass resume={folder!r} to continue it, or another folder")
    if resume is not None and not exists:
        raise FileNotFoundError(f"{folder} holds no journal; pass journal={folder!r} to begin one")
    return folder, identity


def _attach(error, result):
    """The best point so far for whoever handles the exception."""
    try:
        error.best = result
    except Exception:
        return  # An exception with __slots__, or with a property `best` of its own, takes no attribute.
    if result is not None and hasattr(error, "add_note"):
        error.add_note(
            f"nonsmooth: the best value before was {result.fun:.10g}, after {result.nfev} evaluations; the attribute "
            "`best` of this exception is the result so far"
        )
