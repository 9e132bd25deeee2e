from ._engine import Certificate as Certificate, InfeasibleError as InfeasibleError, OutsideDomain as OutsideDomain, __version__ as __version__
from ._minimize import bundle_trust as bundle_trust, minimize as minimize, minimize_composite as minimize_composite
from ._nonlinear import NonlinearConstraint as NonlinearConstraint
from ._result import History as History, Recheck as Recheck, Result as Result
from ._taylor import TaylorTest as TaylorTest, taylor_test as taylor_test

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
