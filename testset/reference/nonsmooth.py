"""Maxima, sums of magnitudes, limits on a grid, and problems of many variables."""

import math

import casadi as ca
import numpy as np
from collection import add, items, largest, le, plain, squares

# maxima


def cb2(x):
    return [x[0] ** 2 + x[1] ** 4, (2 - x[0]) ** 2 + (2 - x[1]) ** 2, 2 * ca.exp(x[1] - x[0])]


add(
    "CB2Limited",
    [2.1, 1.9],
    largest(cb2),
    lambda x: le(2.25 - x[0] ** 2 - x[1] ** 2, x[0] + x[1] - 2),
    linear=[1],
    known=2.25,
)


def evd52(x):
    disk = x[0] ** 2 + x[1] ** 2
    return [
        disk + x[2] ** 2 - 1,
        disk + (x[2] - 2) ** 2,
        x[0] + x[1] + x[2] - 1,
        x[0] + x[1] - x[2] + 1,
        2 * (x[0] ** 3 + 3 * x[1] ** 2 + (5 * x[2] - x[0] + 1) ** 2),
        x[0] ** 2 - 9 * x[2],
    ]


add(
    "EVD52TwoBalls",
    [1, 1, 1],
    largest(evd52),
    lambda x: le((x[0] - 1) ** 2 + x[1] ** 2 + x[2] ** 2 - 0.5, x[0] ** 2 + (x[1] - 1) ** 2 + x[2] ** 2 - 1),
)
SHOR_A = [
    [0, 0, 0, 0, 0],
    [2, 1, 1, 1, 3],
    [1, 2, 1, 1, 2],
    [1, 4, 1, 2, 2],
    [3, 2, 1, 0, 1],
    [0, 2, 1, 0, 1],
    [1, 1, 1, 1, 1],
    [1, 0, 1, 2, 1],
    [0, 0, 2, 1, 0],
    [1, 1, 2, 0, 0],
]
SHOR_B = [1, 5, 10, 2, 4, 3, 1.7, 2.5, 6, 3.5]


def shor(x):
    return [b * sum((x[j] - a[j]) ** 2 for j in range(5)) for a, b in zip(SHOR_A, SHOR_B)]


add(
    "ShorTwoLimits",
    [0, 0, 0, 0, 1],
    largest(shor),
    lambda x: le(squares(x, 5) - 4, x[2] ** 2 - x[4] + 0.36),
)


def maxquad(x):
    n, pieces = 10, []
    for k in range(1, 6):
        a = np.zeros((n, n))
        for i in range(1, n + 1):
            for j in range(1, n + 1):
                if i != j:
                    a[i - 1, j - 1] = math.exp(min(i, j) / max(i, j)) * math.cos(i * j) * math.sin(k)
        for i in range(n):
            a[i, i] = abs(math.sin(k)) * (i + 1) / n + sum(abs(a[i, j]) for j in range(n) if j != i)
        b = [math.exp(i / k) * math.sin(i * k) for i in range(1, n + 1)]
        pieces.append(
            sum(x[i] * sum(a[i, j] * x[j] for j in range(n)) for i in range(n)) - sum(b[i] * x[i] for i in range(n))
        )
    return pieces


add("MaxquadBall", [1] * 10, largest(maxquad), lambda x: le(squares(x, 10) - 0.04))


def polak3(x):
    return [
        sum(ca.exp((x[i - 1] - math.sin(2 * i + k - 3)) ** 2) / (i + k - 1) for i in range(1, 12)) for k in range(1, 11)
    ]


add("Polak3Ball", [1] * 11, largest(polak3), lambda x: le(squares(x, 11, 0.5) - 1, x[0] ** 2 + x[1] ** 2 - x[2]))


def davidon2(x):
    return [
        (x[0] + x[1] * t - math.exp(t)) ** 2 + (x[2] + x[3] * math.sin(t) - math.cos(t)) ** 2
        for t in [0.2 * i for i in range(1, 21)]
    ]


add("Davidon2Ball", [25, 5, -5, -1], largest(davidon2), lambda x: le((squares(x, 4) - 300) / 100))

# sums of magnitudes
LOSS = [42, 37, 37, 28, 18, 18, 19, 20, 15, 14, 14, 13, 11, 12, 8, 7, 8, 8, 9, 15, 15]
AIR = [80, 80, 75, 62, 62, 62, 62, 62, 58, 58, 58, 58, 58, 58, 50, 50, 50, 50, 50, 56, 70]
WATER = [27, 27, 25, 24, 22, 23, 24, 24, 23, 18, 18, 17, 18, 19, 18, 18, 19, 19, 20, 20, 20]
ACID = [89, 88, 90, 87, 87, 87, 93, 93, 87, 80, 89, 88, 82, 93, 89, 86, 72, 79, 80, 82, 91]


def stack_loss(x):
    return [x[0] + a * x[1] + w * x[2] + c * x[3] - y for y, a, w, c in zip(LOSS, AIR, WATER, ACID)]


add(
    "StackLossBall",
    [0, 0, 0, 0],
    lambda x: ("absolutes", stack_loss(x)),
    lambda x: le(x[1] ** 2 + x[2] ** 2 + x[3] ** 2 - 0.64, (x[0] / 20) ** 2 - x[1]),
)


def el_attar(x):
    pieces = []
    for i in range(51):
        t = 0.1 * i
        y = (
            0.5 * math.exp(-t)
            - math.exp(-2 * t)
            + 0.5 * math.exp(-3 * t)
            + 1.5 * math.exp(-1.5 * t) * math.sin(7 * t)
            + math.exp(-2.5 * t) * math.sin(5 * t)
        )
        pieces.append(x[0] * ca.exp(-x[1] * t) * ca.cos(x[2] * t + x[3]) + x[4] * ca.exp(-x[5] * t) - y)
    return pieces


add(
    "ElAttarBall",
    [2, 2, 7, 0, -2, 1],
    lambda x: ("absolutes", el_attar(x)),
    lambda x: le(x[0] ** 2 + x[1] ** 2 + x[4] ** 2 - 6),
)


def lasso_data():
    rows = [[math.cos(0.7 * (i + 1) * (j + 1) + 0.3 * j) for j in range(20)] for i in range(30)]
    right = [math.sin(1.3 * (i + 1)) + (i + 1) / 30 for i in range(30)]
    return rows, right


def lasso(x):
    rows, right = lasso_data()
    return 0.5 * sum((sum(a * x[j] for j, a in enumerate(row)) - b) ** 2 for row, b in zip(rows, right))


add(
    "Lasso20",
    [0] * 20,
    plain(lasso),
    lambda x: [("nonsmooth", "maxima", [[x[j], -x[j]] for j in range(20)] + [[0 * x[0] - 0.6]])],
)

# semi-infinite limits on 101 points
GRID = [i / 100 for i in range(101)]


def on_grid(f):
    return lambda x: [("nonsmooth", "maximum", [f(x, t) for t in GRID])]


add(
    "TFI1",
    [1, 1, 1],
    plain(lambda x: squares(x, 3)),
    on_grid(lambda x, t: x[0] + x[1] * ca.exp(x[2] * t) + math.exp(2 * t) - 2 * math.sin(4 * t)),
)
add(
    "TFI2",
    [0, 0, 0],
    plain(lambda x: x[0] + x[1] / 2 + x[2] / 3),
    on_grid(lambda x, t: math.tan(t) - x[0] - x[1] * t - x[2] * t**2),
)
add(
    "TFI3",
    [1, 0.5, 0],
    plain(lambda x: ca.exp(x[0]) + ca.exp(x[1]) + ca.exp(x[2])),
    on_grid(lambda x, t: 1 / (1 + t**2) - x[0] - x[1] * t - x[2] * t**2),
)

# any number of variables


def chained_lq(x, n):
    pair = lambda a, b: [-a - b, -a - b + a**2 + b**2 - 1]
    return "maxima", [pair(x[i], x[i + 1]) for i in range(n - 1)]


def weighted(x, n):
    return sum((1 + i % 3) * x[i] ** 2 for i in range(n)) / n


def mad1_links(x, n):
    return [x[i] ** 2 + x[i + 1] ** 2 + x[i] * x[i + 1] - 2 * x[i] - 2 * x[i + 1] + 1 for i in range(n - 1)]


add(
    "MaxqLinks50",
    [0.6] * 50,
    largest(lambda x: [v**2 for v in items(x, 50)]),
    lambda x: le(*mad1_links(x, 50)),
    known=1 / 9,
)
add("ChainedLQEllipsoid200", [-0.5] * 200, lambda x: chained_lq(x, 200), lambda x: le(weighted(x, 200) - 0.9))


def cb3_sums(x, n):
    pairs = [(x[i], x[i + 1]) for i in range(n - 1)]
    return [
        sum(a**4 + b**2 for a, b in pairs),
        sum((2 - a) ** 2 + (2 - b) ** 2 for a, b in pairs),
        sum(2 * ca.exp(b - a) for a, b in pairs),
    ]


add("ChainedCB3IIEllipsoid100", [2] * 100, largest(lambda x: cb3_sums(x, 100)), lambda x: le(weighted(x, 100) - 1.9))
add(
    "ChainedLQLinks60",
    [-0.5] * 60,
    lambda x: chained_lq(x, 60),
    lambda x: le(*[x[i] ** 2 + x[i + 1] ** 2 + x[i] * x[i + 1] - 1 for i in range(59)]),
    known=-118 / math.sqrt(3),
)
add(
    "NesterovBall200",
    [0.0] * 200,
    largest(lambda x: [10 * v + 0.5 * squares(x, 200) for v in items(x, 200)]),
    lambda x: le(squares(x, 200) - 0.25),
    known=-10 * 0.5 / math.sqrt(200) + 0.125,
)


def frame(n):
    return [1 + 0.5 * math.sin(i + 1) for i in range(n)], [(1 + 0.5 * math.cos(2 * (i + 1))) / n for i in range(n)]


add(
    "LargestStress60",
    [3] * 60,
    largest(lambda x: [a * x[i] ** 2 for i, a in enumerate(frame(60)[0])]),
    lambda x: le(sum(b / x[i] for i, b in enumerate(frame(60)[1])) - 1),
    0.01,
    100,
    known=sum(b * math.sqrt(a) for a, b in zip(*frame(60))) ** 2,
)


def discs(k):
    return [(i + 1.0, 1.5 if i % 2 == 0 else -1.5, 0.5 + 0.2 * math.sin(i + 1)) for i in range(k)]


def tour(x, k):
    points = [(0.0, 0.0)] + [(x[2 * i], x[2 * i + 1]) for i in range(k)] + [(k + 1.0, 0.0)]
    return sum(ca.sqrt((q[0] - p[0]) ** 2 + (q[1] - p[1]) ** 2) for p, q in zip(points, points[1:]))


add(
    "Tour25",
    [c for x, y, _ in discs(25) for c in (x, y)],
    plain(lambda x: tour(x, 25)),
    lambda x: le(*[(x[2 * i] - a) ** 2 + (x[2 * i + 1] - b) ** 2 - r**2 for i, (a, b, r) in enumerate(discs(25))]),
)

# kinks of constraints in many variables


def total_variation(x, n):
    return [("nonsmooth", "maxima", [[x[i + 1] - x[i], x[i] - x[i + 1]] for i in range(n - 1)] + [[0 * x[0] - 2]])]


def noisy(i):
    return (1.0 if 30 <= i < 60 else 0.0) + 0.3 * math.sin(1.7 * i)


add(
    "TotalVariation100",
    [0.0] * 100,
    plain(lambda x: 0.5 * sum((x[i] - noisy(i)) ** 2 for i in range(100))),
    lambda x: total_variation(x, 100),
)
add(
    "LimitedLQ50",
    [0.0] * 50,
    plain(lambda x: 0.5 * sum((x[i] - 1.5 * math.cos(i)) ** 2 for i in range(50))),
    lambda x: [("nonsmooth", "maxima", chained_lq(x, 50)[1] + [[0 * x[0] + 45]])],
)
add(
    "MaxquadNorms",
    [1] * 10,
    largest(maxquad),
    lambda x: [
        ("nonsmooth", "maximum", [sign * v - 0.1 for v in items(x, 10) for sign in (1, -1)]),
        ("nonsmooth", "maxima", [[v, -v] for v in items(x, 10)] + [[0 * x[0] - 0.4]]),
    ],
)
