"""Minimise nonsmooth functions with bounds, linear and nonlinear constraints, and get a certificate.

``nonsmooth.minimize(fun, x0)`` is called like ``scipy.optimize.minimize``; ``fun`` returns its value and one
subgradient. ``scipy.optimize.minimize(..., method=nonsmooth.bundle_trust)`` works as well. ``success`` is true only
where the point found is confirmed to be stationary.
"""

from ._engine import Certificate, InfeasibleError, OutsideDomain, __version__
from ._minimize import bundle_trust, minimize, minimize_composite
from ._nonlinear import NonlinearConstraint
from ._result import History, Recheck, Result
from ._taylor import TaylorTest, taylor_test

__all__ = [
    "Certificate",
    "History",
    "InfeasibleError",
    "NonlinearConstraint",
    "OutsideDomain",
    "Recheck",
    "Result",
    "TaylorTest",
    "__version__",
    "bundle_trust",
    "minimize",
    "minimize_composite",
    "taylor_test",
]
