"""A PyTorch function with automatic subgradients: largest singular value of A - sum x_i B_i, in double precision."""

import torch

import nonsmooth

torch.manual_seed(1)
A, B = torch.randn(8, 6, dtype=torch.float64), torch.randn(5, 8, 6, dtype=torch.float64)


def fun(x):
    point = torch.tensor(x, requires_grad=True)
    value = torch.linalg.matrix_norm(A - torch.einsum("i,ijk->jk", point, B), ord=2)
    value.backward()
    return value.item(), point.grad.numpy()


def main():
    assert nonsmooth.taylor_test(fun, [0.1, 0.2, 0.3, 0.4, 0.5]).right
    result = nonsmooth.minimize(fun, [0.0] * 5, options={"convex": True})
    print(f"largest singular value {result.start_value:.6f} -> {result.fun:.6f} after {result.nfev} evaluations")
    return result


if __name__ == "__main__":
    main()
