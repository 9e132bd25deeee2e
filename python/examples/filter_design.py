"""Minimax design of a low-pass filter: the largest deviation from the wanted response, over all frequencies, is least.

The taps are bounded by the word length of the target and sum to 1 (a constant passes unchanged), which the exchange
algorithm of scipy.signal.remez cannot take into account.
"""

import sys

import numpy as np

import nonsmooth

TAPS = 25  # Odd and symmetric: a cosine polynomial with 13 coefficients.
PASS, STOP = 0.20, 0.26  # Edges, as shares of the sampling frequency.


def design():
    frequencies = np.concatenate([np.linspace(0, PASS, 120), np.linspace(STOP, 0.5, 180)])
    wanted = (frequencies <= PASS).astype(float)
    k = np.arange(TAPS // 2 + 1)
    response = np.cos(2 * np.pi * np.outer(frequencies, k))

    def deviations(a):
        error = response @ a - wanted
        return np.concatenate([error, -error]), np.vstack([response, -response])

    start = np.where(k == 0, PASS + STOP, np.sin(np.pi * (PASS + STOP) * k) / (np.pi * np.maximum(k, 1)) * 2)
    free = nonsmooth.minimize_composite("max", deviations, start)
    exact_at_zero = nonsmooth.minimize_composite("max", deviations, start, constraints=(np.ones((1, len(k))), 1, 1))
    return free, exact_at_zero


def main(picture=None):
    free, bound = design()
    for name, result in (("free", free), ("constant passes unchanged", bound)):
        print(f"{name}: largest deviation {result.fun:.6f} after {result.nfev} evaluations, success {result.success}")
    if picture:
        import matplotlib.pyplot as plt

        frequencies = np.linspace(0, 0.5, 600)
        figure, axes = plt.subplots(figsize=(6, 3))
        for name, result, color in (("free", free, "0.6"), ("constant passes unchanged", bound, "C0")):
            response = np.cos(2 * np.pi * np.outer(frequencies, np.arange(len(result.x)))) @ result.x
            axes.plot(frequencies, 20 * np.log10(np.abs(response) + 1e-9), color=color, label=name)
        axes.set(xlabel="frequency / sampling frequency", ylabel="response, dB", ylim=(-70, 5))
        axes.legend()
        figure.tight_layout()
        figure.savefig(picture, dpi=80)
    return free, bound


if __name__ == "__main__":
    main(*sys.argv[1:2])
