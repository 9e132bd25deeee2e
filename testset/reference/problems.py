"""The constrained problems, written down a second time. Indices count from zero."""

import math

import casadi as ca
import numpy as np

INF = math.inf
SMOOTH, EIGENVALUE = [], []


def add(name, start, objective, constraints, lower=-INF, upper=INF, linear=(), published=None):
    """objective: x -> (outer, pieces); constraints: x -> list of (kind, outer, pieces); linear: the constraints that are linear."""
    n = len(start)
    SMOOTH.append(
        {
            "name": name,
            "n": n,
            "start": np.array(start, float),
            "lower": np.broadcast_to(np.array(lower, float), n).copy(),
            "upper": np.broadcast_to(np.array(upper, float), n).copy(),
            "objective": objective,
            "constraints": constraints,
            "linear": set(linear),
            "published": published,
        }
    )


def le(*values):
    return [("smooth", "identity", [v]) for v in values]


def eq(*values):
    return [("equality", "identity", [v]) for v in values]


def plain(f):
    return lambda x: ("identity", [f(x)])


def largest(f):
    return lambda x: ("maximum", f(x))


def items(x, n):
    return [x[i] for i in range(n)]


def squares(x, n, center=0.0):
    return sum((x[i] - center) ** 2 for i in range(n))


R2 = math.sqrt(2.0)

# --- classics ---------------------------------------------------------------------------------------------------------------------------
add(
    "RosenSuzuki",
    [0, 0, 0, 0],
    plain(lambda x: x[0] ** 2 + x[1] ** 2 + 2 * x[2] ** 2 + x[3] ** 2 - 5 * x[0] - 5 * x[1] - 21 * x[2] + 7 * x[3]),
    lambda x: le(
        squares(x, 4) + x[0] - x[1] + x[2] - x[3] - 8,
        x[0] ** 2 + 2 * x[1] ** 2 + x[2] ** 2 + 2 * x[3] ** 2 - x[0] - x[3] - 10,
        2 * x[0] ** 2 + x[1] ** 2 + x[2] ** 2 + 2 * x[0] - x[1] - x[3] - 5,
    ),
    published=-44,
)
add(
    "NonsmoothRosenbrock",
    [-1.2, 1],
    lambda x: ("maximum", [8 * (x[0] ** 2 - x[1]) + (1 - x[0]) ** 2, 8 * (x[1] - x[0] ** 2) + (1 - x[0]) ** 2]),
    lambda x: [("nonsmooth", "maximum", [R2 * x[0] - 1, 2 * x[1] - 1])],
    published=(1 - R2 / 2) ** 2,
)
add(
    "HS66",
    [0, 1.05, 2.9],
    plain(lambda x: 0.2 * x[2] - 0.8 * x[0]),
    lambda x: le(ca.exp(x[0]) - x[1], ca.exp(x[1]) - x[2]),
    0,
    [100, 100, 10],
    published=0.5181632741,
)
add(
    "HS100",
    [1, 2, 0, 4, 0, 1, 1],
    plain(
        lambda x: (x[0] - 10) ** 2 + 5 * (x[1] - 12) ** 2 + x[2] ** 4 + 3 * (x[3] - 11) ** 2 + 10 * x[4] ** 6
        + 7 * x[5] ** 2 + x[6] ** 4 - 4 * x[5] * x[6] - 10 * x[5] - 8 * x[6]
    ),
    lambda x: le(
        2 * x[0] ** 2 + 3 * x[1] ** 4 + x[2] + 4 * x[3] ** 2 + 5 * x[4] - 127,
        7 * x[0] + 3 * x[1] + 10 * x[2] ** 2 + x[3] - x[4] - 282,
        23 * x[0] + x[1] ** 2 + 6 * x[5] ** 2 - 8 * x[6] - 196,
        4 * x[0] ** 2 + x[1] ** 2 - 3 * x[0] * x[1] + 2 * x[2] ** 2 + 5 * x[5] - 11 * x[6],
    ),
    published=680.6300573,
)


def hs113(x):
    return (
        x[0] ** 2 + x[1] ** 2 + x[0] * x[1] - 14 * x[0] - 16 * x[1] + (x[2] - 10) ** 2 + 4 * (x[3] - 5) ** 2 + (x[4] - 3) ** 2
        + 2 * (x[5] - 1) ** 2 + 5 * x[6] ** 2 + 7 * (x[7] - 11) ** 2 + 2 * (x[8] - 10) ** 2 + (x[9] - 7) ** 2 + 45
    )


def hs113_limits(x):
    return le(
        3 * (x[0] - 2) ** 2 + 4 * (x[1] - 3) ** 2 + 2 * x[2] ** 2 - 7 * x[3] - 120,
        5 * x[0] ** 2 + 8 * x[1] + (x[2] - 6) ** 2 - 2 * x[3] - 40,
        0.5 * (x[0] - 8) ** 2 + 2 * (x[1] - 4) ** 2 + 3 * x[4] ** 2 - x[5] - 30,
        x[0] ** 2 + 2 * (x[1] - 2) ** 2 - 2 * x[0] * x[1] + 14 * x[4] - 6 * x[5],
        -3 * x[0] + 6 * x[1] + 12 * (x[8] - 8) ** 2 - 7 * x[9],
    )


def hs113_rows(x):
    return le(
        4 * x[0] + 5 * x[1] - 3 * x[6] + 9 * x[7] - 105,
        10 * x[0] - 8 * x[1] - 17 * x[6] + 2 * x[7],
        -8 * x[0] + 2 * x[1] + 5 * x[8] - 2 * x[9] - 12,
    )


add(
    "HS113",
    [2, 3, 5, 5, 1, 2, 7, 3, 6, 10],
    plain(hs113),
    lambda x: hs113_limits(x) + hs113_rows(x),
    linear=[5, 6, 7],
    published=24.3062091,
)
add(
    "Wong3",
    [2, 3, 5, 5, 1, 2, 7, 3, 6, 10, 2, 2, 6, 15, 1, 2, 1, 2, 1, 3],
    plain(
        lambda x: hs113(x) + (x[10] - 9) ** 2 + 10 * (x[11] - 1) ** 2 + 5 * (x[12] - 7) ** 2 + 4 * (x[13] - 14) ** 2
        + 27 * (x[14] - 1) ** 2 + x[15] ** 4 + (x[16] - 2) ** 2 + 13 * (x[17] - 2) ** 2 + (x[18] - 3) ** 2 + x[19] ** 2 + 50
    ),
    lambda x: hs113_limits(x)
    + le(
        x[0] ** 2 + 15 * x[10] - 8 * x[11] - 28,
        4 * x[0] + 9 * x[1] + 5 * x[12] ** 2 - 9 * x[13] - 87,
        3 * x[0] + 4 * x[1] + 3 * (x[12] - 6) ** 2 - 14 * x[13] - 10,
        14 * x[0] ** 2 + 35 * x[14] - 79 * x[15] - 92,
        15 * x[1] ** 2 + 11 * x[14] - 61 * x[15] - 54,
        5 * x[0] ** 2 + 2 * x[1] + 9 * x[16] ** 4 - x[17] - 68,
        x[0] ** 2 - x[1] + 19 * x[18] - 20 * x[19] + 19,
        7 * x[0] ** 2 + 5 * x[1] ** 2 + x[18] ** 2 - 30 * x[19],
    )
    + hs113_rows(x)
    + le(x[0] + x[1] + 4 * x[10] - 21 * x[11]),
    linear=[13, 14, 15, 16],
    published=133.72828,
)

# --- Hock, Schittkowski: inequalities ---------------------------------------------------------------------------------------------------
add("HS10", [-10, 10], plain(lambda x: x[0] - x[1]), lambda x: le(3 * x[0] ** 2 - 2 * x[0] * x[1] + x[1] ** 2 - 1), published=-1)
add("HS11", [4.9, 0.1], plain(lambda x: (x[0] - 5) ** 2 + x[1] ** 2 - 25), lambda x: le(x[0] ** 2 - x[1]), published=-8.498464223)
add(
    "HS12",
    [0, 0],
    plain(lambda x: 0.5 * x[0] ** 2 + x[1] ** 2 - x[0] * x[1] - 7 * x[0] - 7 * x[1]),
    lambda x: le(4 * x[0] ** 2 + x[1] ** 2 - 25),
    published=-30,
)
add(
    "HS22",
    [2, 2],
    plain(lambda x: (x[0] - 2) ** 2 + (x[1] - 1) ** 2),
    lambda x: le(x[0] ** 2 - x[1], x[0] + x[1] - 2),
    linear=[1],
    published=1,
)
add("HS29", [1, 1, 1], plain(lambda x: -x[0] * x[1] * x[2]), lambda x: le(x[0] ** 2 + 2 * x[1] ** 2 + 4 * x[2] ** 2 - 48), published=-16 * R2)
add(
    "HS31",
    [1, 1, 1],
    plain(lambda x: 9 * x[0] ** 2 + x[1] ** 2 + 9 * x[2] ** 2),
    lambda x: le(1 - x[0] * x[1]),
    [-10, 1, -10],
    [10, 10, 1],
    published=6,
)
add(
    "HS34",
    [0, 1.05, 2.9],
    plain(lambda x: -x[0]),
    lambda x: le(ca.exp(x[0]) - x[1], ca.exp(x[1]) - x[2]),
    0,
    [100, 100, 10],
    published=-math.log(math.log(10)),
)
add(
    "HS64",
    [1, 1, 1],
    plain(lambda x: 5 * x[0] + 50000 / x[0] + 20 * x[1] + 72000 / x[1] + 10 * x[2] + 144000 / x[2]),
    lambda x: le(4 / x[0] + 32 / x[1] + 120 / x[2] - 1),
    1e-5,
    published=6299.842428,
)
add(
    "HS65",
    [-5, 5, 0],
    plain(lambda x: (x[0] - x[1]) ** 2 + (x[0] + x[1] - 10) ** 2 / 9 + (x[2] - 5) ** 2),
    lambda x: le(squares(x, 3) - 48),
    [-4.5, -4.5, -5],
    [4.5, 4.5, 5],
    published=0.9535288567,
)
add(
    "HS72",
    [1, 1, 1, 1],
    plain(lambda x: 1 + x[0] + x[1] + x[2] + x[3]),
    lambda x: le(
        4 / x[0] + 2.25 / x[1] + 1 / x[2] + 0.25 / x[3] - 0.0401,
        0.16 / x[0] + 0.36 / x[1] + 0.64 / x[2] + 0.64 / x[3] - 0.010085,
    ),
    0.001,
    [4e5, 3e5, 2e5, 1e5],
    published=727.67937,
)


def hs83(x):
    a = 85.334407 + 0.0056858 * x[1] * x[4] + 0.0006262 * x[0] * x[3] - 0.0022053 * x[2] * x[4]
    b = 80.51249 + 0.0071317 * x[1] * x[4] + 0.0029955 * x[0] * x[1] + 0.0021813 * x[2] ** 2 - 90
    c = 9.300961 + 0.0047026 * x[2] * x[4] + 0.0012547 * x[0] * x[2] + 0.0019085 * x[2] * x[3] - 20
    return le(-a, a - 92, -b, b - 20, -c, c - 5)


add(
    "HS83",
    [78, 33, 27, 27, 27],
    plain(lambda x: 5.3578547 * x[2] ** 2 + 0.8356891 * x[0] * x[4] + 37.293239 * x[0] - 40792.141),
    hs83,
    [78, 33, 27, 27, 27],
    [102, 45, 45, 45, 45],
    published=-30665.53867,
)


def hs93(x):
    return x[0] * x[3] * (x[0] + x[1] + x[2]), x[1] * x[2] * (x[0] + 1.57 * x[1] + x[3])


add(
    "HS93",
    [5.54, 4.4, 12.02, 11.82, 0.702, 0.852],
    plain(
        lambda x: 0.0204 * hs93(x)[0] + 0.0187 * hs93(x)[1] + 0.0607 * hs93(x)[0] * x[4] ** 2 + 0.0437 * hs93(x)[1] * x[5] ** 2
    ),
    lambda x: le(
        2.07 - 0.001 * x[0] * x[1] * x[2] * x[3] * x[4] * x[5],
        0.00062 * hs93(x)[0] * x[4] ** 2 + 0.00058 * hs93(x)[1] * x[5] ** 2 - 1,
    ),
    0,
    published=135.075961,
)


def hs104(x):
    return 0.4 * (x[0] / x[6]) ** 0.67 + 0.4 * (x[1] / x[7]) ** 0.67 + 10 - x[0] - x[1]


add(
    "HS104",
    [6, 3, 0.4, 0.2, 6, 6, 1, 0.5],
    plain(hs104),
    lambda x: le(
        0.0588 * x[4] * x[6] + 0.1 * x[0] - 1,
        0.0588 * x[5] * x[7] + 0.1 * x[0] + 0.1 * x[1] - 1,
        4 * x[2] / x[4] + 2 / (x[2] ** 0.71 * x[4]) + 0.0588 * x[6] / x[2] ** 1.3 - 1,
        4 * x[3] / x[5] + 2 / (x[3] ** 0.71 * x[5]) + 0.0588 * x[7] / x[3] ** 1.3 - 1,
        1 - hs104(x),
        hs104(x) - 4.2,
    ),
    0.1,
    10,
    published=3.9511634396,
)
add(
    "HS106",
    [5000, 5000, 5000, 200, 350, 150, 225, 425],
    plain(lambda x: x[0] + x[1] + x[2]),
    lambda x: le(
        833.33252 * x[3] / (x[0] * x[5]) + 100 / x[5] - 83333.333 / (x[0] * x[5]) - 1,
        1250 * x[4] / (x[1] * x[6]) + x[3] / x[6] - 1250 * x[3] / (x[1] * x[6]) - 1,
        1250000 / (x[2] * x[7]) + x[4] / x[7] - 2500 * x[4] / (x[2] * x[7]) - 1,
        0.0025 * (x[3] + x[5]) - 1,
        0.0025 * (x[4] + x[6] - x[3]) - 1,
        0.01 * (x[7] - x[4]) - 1,
    ),
    [100, 1000, 1000] + [10] * 5,
    [10000] * 3 + [1000] * 5,
    linear=[3, 4, 5],
    published=7049.24802,
)
COLVILLE = {
    "a": [
        [-16, 2, 0, 1, 0],
        [0, -2, 0, 0.4, 2],
        [-3.5, 0, 2, 0, 0],
        [0, -2, 0, -4, -1],
        [0, -9, -2, 1, -2.8],
        [2, 0, -4, 0, 0],
        [-1, -1, -1, -1, -1],
        [-1, -2, -3, -2, -1],
        [1, 2, 3, 4, 5],
        [1, 1, 1, 1, 1],
    ],
    "b": [-40, -2, -0.25, -4, -4, -1, -40, -60, 5, 1],
    "c": [[30, -20, -10, 32, -10], [-20, 39, -6, -31, 32], [-10, -6, 10, -6, -10], [32, -31, -6, 39, -20], [-10, 32, -10, -20, 30]],
    "d": [4, 8, 10, 6, 2],
    "e": [-15, -27, -36, -18, -12],
}


def hs117(x):
    q = COLVILLE
    y = [x[10 + j] for j in range(5)]
    quadratic = sum(q["c"][k][j] * y[k] * y[j] for k in range(5) for j in range(5))
    return -sum(q["b"][k] * x[k] for k in range(10)) + quadratic + 2 * sum(q["d"][j] * y[j] ** 3 for j in range(5))


def hs117_limits(x):
    q = COLVILLE
    y = [x[10 + j] for j in range(5)]
    return le(
        *[
            sum(q["a"][k][j] * x[k] for k in range(10))
            - 2 * sum(q["c"][k][j] * y[k] for k in range(5))
            - 3 * q["d"][j] * y[j] ** 2
            - q["e"][j]
            for j in range(5)
        ]
    )


add("HS117", [0.001] * 6 + [60] + [0.001] * 8, plain(hs117), hs117_limits, 0, published=32.34867897)

# --- Hock, Schittkowski: equations ------------------------------------------------------------------------------------------------------
add("HS6", [-1.2, 1], plain(lambda x: (1 - x[0]) ** 2), lambda x: eq(10 * (x[1] - x[0] ** 2)), published=0)
add(
    "HS7",
    [2, 2],
    plain(lambda x: ca.log(1 + x[0] ** 2) - x[1]),
    lambda x: eq((1 + x[0] ** 2) ** 2 + x[1] ** 2 - 4),
    published=-math.sqrt(3),
)
add(
    "HS27",
    [2, 2, 2],
    plain(lambda x: 0.01 * (x[0] - 1) ** 2 + (x[1] - x[0] ** 2) ** 2),
    lambda x: eq(x[0] + x[2] ** 2 + 1),
    published=0.04,
)
add(
    "HS39",
    [2, 2, 2, 2],
    plain(lambda x: -x[0]),
    lambda x: eq(x[1] - x[0] ** 3 - x[2] ** 2, x[0] ** 2 - x[1] - x[3] ** 2),
    published=-1,
)
add(
    "HS40",
    [0.8] * 4,
    plain(lambda x: -x[0] * x[1] * x[2] * x[3]),
    lambda x: eq(x[0] ** 3 + x[1] ** 2 - 1, x[0] ** 2 * x[3] - x[2], x[3] ** 2 - x[1]),
    published=-0.25,
)
add(
    "HS71",
    [1, 5, 5, 1],
    plain(lambda x: x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]),
    lambda x: le(25 - x[0] * x[1] * x[2] * x[3]) + eq(squares(x, 4) - 40),
    1,
    5,
    published=17.0140173,
)
add(
    "HS77",
    [2] * 5,
    plain(lambda x: (x[0] - 1) ** 2 + (x[0] - x[1]) ** 2 + (x[2] - 1) ** 2 + (x[3] - 1) ** 4 + (x[4] - 1) ** 6),
    lambda x: eq(x[0] ** 2 * x[3] + ca.sin(x[3] - x[4]) - 2 * R2, x[1] + x[2] ** 4 * x[3] ** 2 - 8 - R2),
    published=0.24150513,
)
add(
    "HS78",
    [-2, 1.5, 2, -1, -1],
    plain(lambda x: x[0] * x[1] * x[2] * x[3] * x[4]),
    lambda x: eq(squares(x, 5) - 10, x[1] * x[2] - 5 * x[3] * x[4], x[0] ** 3 + x[1] ** 3 + 1),
    published=-2.91970041,
)
add(
    "HS79",
    [2] * 5,
    plain(lambda x: (x[0] - 1) ** 2 + (x[0] - x[1]) ** 2 + (x[1] - x[2]) ** 2 + (x[2] - x[3]) ** 4 + (x[3] - x[4]) ** 4),
    lambda x: eq(x[0] + x[1] ** 2 + x[2] ** 3 - 2 - 3 * R2, x[1] - x[2] ** 2 + x[3] + 2 - 2 * R2, x[0] * x[4] - 2),
    published=0.0787768209,
)

# --- maxima -----------------------------------------------------------------------------------------------------------------------------


def cb2(x):
    return [x[0] ** 2 + x[1] ** 4, (2 - x[0]) ** 2 + (2 - x[1]) ** 2, 2 * ca.exp(x[1] - x[0])]


add("CB2Limited", [2.1, 1.9], largest(cb2), lambda x: le(2.25 - x[0] ** 2 - x[1] ** 2, x[0] + x[1] - 2), linear=[1], published=2.25)

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
        pieces.append(sum(x[i] * sum(a[i, j] * x[j] for j in range(n)) for i in range(n)) - sum(b[i] * x[i] for i in range(n)))
    return pieces


add("MaxquadBall", [1] * 10, largest(maxquad), lambda x: le(squares(x, 10) - 0.04))


def polak3(x):
    return [
        sum(ca.exp((x[i - 1] - math.sin(2 * i + k - 3)) ** 2) / (i + k - 1) for i in range(1, 12)) for k in range(1, 11)
    ]


add("Polak3Ball", [1] * 11, largest(polak3), lambda x: le(squares(x, 11, 0.5) - 1, x[0] ** 2 + x[1] ** 2 - x[2]))


def davidon2(x):
    return [
        (x[0] + x[1] * t - math.exp(t)) ** 2 + (x[2] + x[3] * math.sin(t) - math.cos(t)) ** 2 for t in [0.2 * i for i in range(1, 21)]
    ]


add("Davidon2Ball", [25, 5, -5, -1], largest(davidon2), lambda x: le((squares(x, 4) - 300) / 100))

# --- sums of magnitudes -----------------------------------------------------------------------------------------------------------------
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
        y = 0.5 * math.exp(-t) - math.exp(-2 * t) + 0.5 * math.exp(-3 * t) + 1.5 * math.exp(-1.5 * t) * math.sin(7 * t) + math.exp(-2.5 * t) * math.sin(5 * t)
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

# --- semi-infinite limits on 101 points -------------------------------------------------------------------------------------------------
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

# --- any number of variables ------------------------------------------------------------------------------------------------------------


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
    published=1 / 9,
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
    published=-118 / math.sqrt(3),
)
add(
    "NesterovBall200",
    [0.0] * 200,
    largest(lambda x: [10 * v + 0.5 * squares(x, 200) for v in items(x, 200)]),
    lambda x: le(squares(x, 200) - 0.25),
    published=-10 * 0.5 / math.sqrt(200) + 0.125,
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
    published=sum(b * math.sqrt(a) for a, b in zip(*frame(60))) ** 2,
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

# --- limits on the largest eigenvalue ---------------------------------------------------------------------------------------------------


def add_eigenvalue(name, start, cost, matrices, lower=-INF, upper=INF, published=None):
    n = len(start)
    EIGENVALUE.append(
        {
            "name": name,
            "n": n,
            "start": np.array(start, float),
            "lower": np.broadcast_to(np.array(lower, float), n).copy(),
            "upper": np.broadcast_to(np.array(upper, float), n).copy(),
            "cost": np.array(cost, float),
            "matrices": [(np.array(a0, float), np.array(a, float)) for a0, a in matrices],
            "published": published,
        }
    )


def laplacian(edges, n):
    total = np.zeros((n, n))
    for i, j in edges:
        total += edge(i, j, n)
    return total


def edge(i, j, n):
    v = np.zeros(n)
    v[i], v[j] = 1, -1
    return np.outer(v, v)


PETERSEN = [(i, (i + 1) % 5) for i in range(5)] + [(i, i + 5) for i in range(5)] + [(5 + i, 5 + (i + 2) % 5) for i in range(5)]
CUBE = [(i, i ^ (1 << b)) for i in range(8) for b in range(3) if i < i ^ (1 << b)]
unit = lambda n, i: np.diag(np.eye(n)[i])
add_eigenvalue(
    "MaxCutPetersen", [3.0] * 10, [1] * 10, [(laplacian(PETERSEN, 10) / 4, [-unit(10, i) for i in range(10)])], published=12.5
)
swap = lambda i, j, n: np.outer(np.eye(n)[i], np.eye(n)[j]) + np.outer(np.eye(n)[j], np.eye(n)[i])
add_eigenvalue(
    "LovaszHeptagon",
    [8.0] + [0.0] * 7,
    [1] + [0] * 7,
    [(np.ones((7, 7)), [-np.eye(7)] + [swap(i, (i + 1) % 7, 7) for i in range(7)])],
    published=7 * math.cos(math.pi / 7) / (1 + math.cos(math.pi / 7)),
)
add_eigenvalue(
    "ConnectivityCube",
    [1.0] * 12,
    [1] * 12,
    [(np.eye(8) - np.ones((8, 8)), [-edge(i, j, 8) for i, j in CUBE])],
    lower=0,
    published=6,
)
covariance = np.array([[math.exp(-abs(i - j) / 2) + (1.0 if i == j else 0.0) + 0.1 * math.cos(i * j) for j in range(6)] for i in range(6)])
add_eigenvalue("EducationalTesting6", [0.0] * 6, [-1] * 6, [(-covariance, [unit(6, i) for i in range(6)])], lower=0)
family = lambda s: [[[math.cos(s * (k + 1) * (min(i, j) + 1) + max(i, j)) for j in range(4)] for i in range(4)] for k in range(6)]
add_eigenvalue("TwoSpectra", [0.0] * 6, [-1, 0, 1, 0, -1, 1], [(-np.eye(4), family(1.0)), (-np.eye(4), family(0.8))])
