"""A JAX function with automatic subgradients: a median of points on a sphere, in double precision."""

import jax
import jax.numpy as jnp
import numpy as np

import nonsmooth

jax.config.update("jax_enable_x64", True)
POINTS = jnp.array(np.random.default_rng(1).normal(size=(30, 3)))


@jax.jit
@jax.value_and_grad
def distances(x):
    return jnp.sum(jnp.sqrt(jnp.sum((POINTS - x) ** 2, axis=1)))


def main():
    assert nonsmooth.taylor_test(distances, [3.0, 2.0, 1.0]).right
    result = nonsmooth.minimize(distances, [3.0, 2.0, 1.0], options={"convex": True})
    print(f"sum of distances {result.start_value:.6f} -> {result.fun:.6f} after {result.nfev} evaluations")
    return result


if __name__ == "__main__":
    main()
