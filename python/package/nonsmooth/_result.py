"""What a run returns."""

import json
from dataclasses import dataclass

from scipy.optimize import OptimizeResult

#: Status by the reason why the run ended.
STATUS = {
    "stationary": 0,
    "stationary_unconfirmed": 1,
    "noise_limit": 2,
    "step_too_short": 3,
    "evaluation_limit": 4,
    "iteration_limit": 5,
    "time_limit": 6,
    "stopped": 7,
    "unbounded_below": 8,
    "function_failing": 9,
    "subproblem_failed": 10,
    "function_contradictory": 11,
    "other": 12,
    "infeasible": 13,
    "degenerate_constraints": 14,
    "violated": 15,
}

#: What to do next; for another reason, the engine advises.
_ADVICE = {
    "stationary": "result.recheck() computes the certificate again",
    "stationary_unconfirmed": "if the problem is convex, options={'convex': True} lets the run confirm that this is the minimum; otherwise "
    "start again from here, or from elsewhere, and compare",
    "noise_limit": "a more accurate fun is needed to get further",
    "step_too_short": "check the subgradients: nonsmooth.taylor_test(fun, x) compares them with values next to a point x",
    "evaluation_limit": "raise the option max_evaluations, and begin with x, or resume a journal",
    "iteration_limit": "raise the option max_iterations, and begin with x, or resume a journal",
    "time_limit": "raise the option max_seconds, and begin with x, or resume a journal",
    "stopped": "begin with x, or resume a journal, to go on",
    "unbounded_below": "pass bounds",
    "function_failing": "make fun robust near x, or pass bounds or constraints that keep away from where it fails",
    "subproblem_failed": "pass x_scale, the typical sizes of the variables, and check the sizes of the rows of the constraints",
}

#: The same for problems that were declared convex.
_ADVICE_IF_CONVEX = {
    "stationary_unconfirmed": "check that the function and the constraints are convex, or start again from here",
    "noise_limit": "a more accurate fun is needed to get further, or the function is not convex",
}


class History(list):
    """One dict per evaluation: number, kind of step, values, predicted decrease, seconds."""

    def __repr__(self):
        return f"<History of {len(self)} evaluations>"


@dataclass(frozen=True)
class Recheck:
    """The numbers of a certificate, computed again from its cuts and multipliers.

    Attributes
    ----------
    aggregate_norm, aggregate_error : float
        Norm and error of the aggregate subgradient.
    multiplier_defect : float
        The larger of ``|sum of multipliers - 1|`` and the largest negative multiplier.
    violation : float
        Relative violation of the constraints, nonlinear ones included, at the point.
    open_side_multiplier : float
        Largest multiplier of an infinite side; 0 in a valid certificate.
    composite_difference : float or None
        Largest relative difference of the cuts against outputs, Jacobian and outer function, computed again; None
        for a certificate that does not rest on them.
    agrees : bool
        Whether norm and error are those of the certificate to 1e-9 relative to its sizes, and the other numbers small.
    """

    aggregate_norm: float
    aggregate_error: float
    multiplier_defect: float
    violation: float
    open_side_multiplier: float
    composite_difference: "float | None"
    agrees: bool

    def confirms(self, norm_tolerance, error_tolerance):
        """Whether the point is stationary up to these tolerances.

        Parameters
        ----------
        norm_tolerance, error_tolerance : float
            Largest norm and error of the aggregate subgradient.

        Returns
        -------
        bool
            True if the numbers agree with the certificate and lie within the tolerances.
        """
        return (
            self.agrees and self.aggregate_norm <= norm_tolerance and self.aggregate_error <= error_tolerance
        )


class Result(OptimizeResult):
    """A ``scipy.optimize.OptimizeResult`` with a certificate.

    Attributes
    ----------
    x : ndarray
        The admissible point that ``message`` speaks about; where a limit or a failure ended the run, the lowest one evaluated, with
        nonlinear constraints the lowest feasible one or the one of least violation.
    fun : float
        The value there.
    jac : ndarray or None
        One subgradient there. It need not be small at a minimum; the certificate says how stationary the point is.
    success : bool
        Whether the point is stationary and confirmed. A limit, a stall or noise is no success.
    status : int
        0 for success; see ``nonsmooth._result.STATUS`` for the others.
    reason : str
        The name of the status.
    message : str
        Why the run ended, with numbers, and what to do.
    nfev, njev, nit : int
        Evaluations of value and subgradient, and steps.
    gap : float or None
        Bound of ``fun`` minus the minimum within reach, for a confirmed run with ``convex=True``: every variable reaches as far as the
        one does that lies farthest from zero or from its start.
    constr : list of ndarray
        Values of the nonlinear constraints at x: first those of ``constraint_kinds``, then an array for each object. A component
        without any side is NaN.
    constr_violation : float
        The largest violation among these values, or of the limits of a scene, each in its own unit; 0 without any.
    multipliers : list of ndarray
        Multipliers v of these values, for the Lagrangian ``fun(x) + sum(v * c(x))``, as in ``scipy``'s trust-constr: v > 0 where
        the upper side is active, v < 0 at the lower side, either sign for an equality.
    penalty : float or None
        Weight of the violation in the merit that the run has ended with, in units of ``fun`` per unit of x; None without nonlinear
        constraints.
    certificate : Certificate or None
        Cuts and multipliers of the last subproblem; None if there was none.
    history : History
        One record per evaluation.
    counts : dict
        Steps by kind, subproblems.
    largest_violation : float
        The largest violation of bounds and linear constraints at x.
    start_value, seconds : float
        Value at the start, and time of the run.
    warnings : list of str
        What went wrong without ending the run, a journal that cannot be written for example.
    limits : list of dict
        For nonlinear constraints and limits of scenes, one each: ``excess``, the limited quantity minus its limit, ``satisfied``, and ``multiplier``, by how much
        theta would fall per unit more.
    runs : list of dict
        For scenes, the runs that the optimization consists of (attempts, starts, meshes), one each: ``run``, the name of its folder
        below that of the journal, ``start_value``, ``fun``, ``nfev``, ``seconds``, ``message``. ``nfev`` and ``njev`` count the
        evaluations of all; ``nit``, ``history``, ``counts`` and ``certificate`` are those of the run that has found x.
    """

    def recheck(self):
        """Compute norm and error of the certificate again, from its cuts and multipliers alone.

        Returns
        -------
        Recheck
            The numbers, and whether they agree with the certificate.
        """
        certificate = self.certificate
        if certificate is None:
            raise ValueError("there is no certificate: the run ended before its first subproblem")
        numbers = json.loads(certificate.recheck())
        difference = None if self._outer is None else certificate.recheck_composite(self._outer)
        return Recheck(**numbers, composite_difference=difference, agrees=_agrees(certificate, numbers, difference))

    def __dir__(self):
        return [*super().__dir__(), "recheck"]


def _agrees(certificate, numbers, difference):
    largest = max(abs(certificate.subgradients).max(initial=0.0), abs(certificate.row_multipliers).max(initial=0.0), 1e-300)
    near = 1e-9
    return (
        abs(numbers["aggregate_norm"] - certificate.aggregate_norm) <= near * max(certificate.aggregate_norm, largest)
        and abs(numbers["aggregate_error"] - certificate.aggregate_error)
        <= near * max(certificate.aggregate_error, abs(certificate.fun), largest)
        and numbers["multiplier_defect"] <= near
        and numbers["violation"] <= near
        and numbers["open_side_multiplier"] == 0.0
        and (difference is None or difference <= near)
    )


#: With nonlinear constraints, a value without an outer function is the largest of one output.
_ONE_OUTPUT = {"function": "max", "exponent": 1.0, "groups": None, "weight": None}


def build(outcome, outer=None, nonlinear=None):
    """The result of a run of the engine."""
    reports = json.loads(outcome["constraints"])
    worst = [abs(own["value"]) if own["kind"] == "smooth_equality" else own["value"] for own in reports]
    # Limits of a scene: constraints that are told in `limits`.
    found = {"constr": [], "constr_violation": max(worst + [0.0]), "multipliers": []}
    if nonlinear:
        found = nonlinear.found(reports)
        outer = outer or _ONE_OUTPUT
    counts = json.loads(outcome["counts"])
    runs = json.loads(outcome["runs"])
    evaluations = sum(run["nfev"] for run in runs) if runs else counts["evaluations"]
    reason = outcome["reason"]
    history = History(json.loads(outcome["history"]))
    advice = _ADVICE | _ADVICE_IF_CONVEX if outcome["convex"] else _ADVICE
    words = [outcome["message"], advice.get(reason, outcome["advice"])]
    # The engine's words name the constraint where a run ends by itself.
    if not outcome["confirmed"] and reason not in ("violated", "infeasible") and found["constr_violation"] > 0.0:
        words.insert(1, f"x violates a nonlinear constraint by {found['constr_violation']:.1e}")
    result = Result(
        message="; ".join(words),
        success=outcome["confirmed"],
        status=STATUS[reason],
        reason=reason,
        fun=outcome["value"],
        x=outcome["x"],
        jac=outcome["subgradient"],
        nit=counts["iterations"],
        nfev=evaluations,
        njev=evaluations,
        gap=outcome["gap"],
        **found,
        penalty=outcome["penalty"],
        certificate=outcome["certificate"],
        history=history,
        counts=counts,
        largest_violation=outcome["largest_violation"],
        start_value=outcome["start_value"],
        seconds=outcome["seconds"],
        warnings=outcome["warnings"],
        limits=[
            {"excess": found["value"], "satisfied": found["satisfied"], "multiplier": found["multiplier"]}
            for found in reports
        ],
        runs=runs,
    )
    # No entry of the dict: it is not for users.
    object.__setattr__(result, "_outer", outer)
    return result
