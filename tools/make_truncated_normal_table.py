#!/usr/bin/env python3
# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the certified tables that src/kilter/numerics is tested against.

Every input is a double; it is taken exactly (all its bits), and the closed forms are evaluated with 200 digits, so
that the cancellation of Eq. (12)-(14) leaves more than the 30 digits printed. Needs python3-mpmath.

    tools/make_truncated_normal_table.py src/kilter/numerics/testdata
"""
import itertools
import pathlib
import sys

import mpmath as mp

mp.mp.dps = 200


def digits(value):
    return mp.nstr(value, 30, min_fixed=0, max_fixed=0)


def phi(z):
    return mp.exp(-z * z / 2) / mp.sqrt(2 * mp.pi)


def mass(a, b):
    """P(a < Z < b), from the tail that both share."""
    if b < 0:
        return mass(-b, -a)
    if a > 0:
        return (mp.erfc(a / mp.sqrt(2)) - mp.erfc(b / mp.sqrt(2))) / 2
    return (mp.erf(b / mp.sqrt(2)) - mp.erf(a / mp.sqrt(2))) / 2


def truncated_normal_row(mu, sigma, low, high, x):
    mu, sigma, low, high, x = map(mp.mpf, (mu, sigma, low, high, x))
    alpha, beta, at = (low - mu) / sigma, (high - mu) / sigma, (x - mu) / sigma
    z = mass(alpha, beta)
    q = (phi(alpha) - phi(beta)) / z
    mean = mu + sigma * q
    variance = sigma**2 * (1 + (alpha * phi(alpha) - beta * phi(beta)) / z - q * q)
    return mean, variance, phi(at) / (sigma * z), mass(alpha, at) / z


def laws():
    """(mu, sigma, low, high): standard sweeps, metre-sized laws as they occur, shifted intervals, limits."""
    ratios = (-40, -20, -8, -3, -1, -0.3, 0, 0.3, 1, 3, 8, 20, 40)
    widths = (1e-3, 1e-2, 0.1, 0.3, 1, 3, 10, 30, 40, 100, 1e3)
    for ratio, width in itertools.product(ratios, widths):
        yield float(ratio), 1.0, 0.0, float(width)
    for mu, sigma in itertools.product((-0.7, -0.05, 0.05, 0.15, 0.5, 0.9, 1.3), (0.01, 0.03, 0.09, 0.2, 0.5, 2.0)):
        yield mu, sigma, 0.0, 1.0
    for mu, sigma in itertools.product((-30.0, -2.0, 0.1, 2.0, 30.0), (0.25, 1.0, 7.0)):
        yield mu, sigma, -2.5, 1.75
    yield from ((-1e6, 1e3, 0.0, 1.0), (1e6, 1e3, 0.0, 1.0), (-1e8, 1e5, 0.0, 1.0), (-100.0, 1.0, 0.0, 1.0),
                (0.5, 1e6, 0.0, 1.0), (0.5, 1e-6, 0.0, 1.0), (1e-9, 1e-7, 0.0, 1.0), (101.0, 1.0, 0.0, 1.0))


def write(path, source, header, rows):
    lines = ["# SPDX-FileCopyrightText: The kilter authors", "# SPDX-License-Identifier: BSD-3-Clause",
             f"# Made by tools/make_truncated_normal_table.py (mpmath, {mp.mp.dps} digits). {source}",
             "# Inputs are the exact doubles; results are rounded to 30 digits.", header]
    path.write_text("\n".join(lines + [",".join(row) for row in rows]) + "\n")


def truncated_normal_rows():
    for mu, sigma, low, high in laws():
        x = low + 0.375 * (high - low)
        if not -60 < (x - mu) / sigma < 60 and abs(mu) < 1e3:
            x = min(max(mu + 0.5 * sigma, low + 0.25 * sigma), high)
        values = truncated_normal_row(mu, sigma, low, high, x)
        yield [repr(v) for v in (mu, sigma, low, high, x)] + [digits(v) for v in values]


def special_rows():
    for x in (-26.0, -20.5, -10.1, -5.3, -3.0, -1.7, -1.0, -0.5, -0.1, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 0.1, 0.3, 0.5, 0.9,
              1.0, 1.5, 2.0, 3.3, 5.0, 7.7, 10.0, 15.0, 26.0, 27.3, 50.0, 100.0, 1e3, 1e5, 1e8, 1e20, 1e150):
        if x < 1e6:
            value = mp.exp(mp.mpf(x)**2) * mp.erfc(mp.mpf(x))
        else:  # asymptotic series: its next term is below 1e-30 of the sum
            t = 1 / (2 * mp.mpf(x)**2)
            value = (1 - t + 3 * t**2 - 15 * t**3) / (mp.mpf(x) * mp.sqrt(mp.pi))
        yield ["erfcx", repr(x), digits(value)]
    for z in (-40.0, -38.0, -10.0, -5.0, -2.0, -1.0, -0.3, -1e-6, 0.0, 1e-6, 0.3, 1.0, 2.0, 5.0, 8.3, 10.0, 20.0, 37.0,
              38.6, 100.0, 500.0):
        tail = mp.erfc(abs(mp.mpf(z)) / mp.sqrt(2)) / 2
        yield ["log_normal_tail", repr(z), digits(mp.log(tail) if z >= 0 else mp.log1p(-tail))]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    write(folder / "truncated_normal.csv", "Eq. (12)-(14) of the paper, signs corrected.",
          "mu,sigma,low,high,x,mean,variance,pdf,cdf", truncated_normal_rows())
    write(folder / "special.csv", "exp(x^2) erfc(x) and log(erfc(z / sqrt 2) / 2).", "function,argument,value",
          special_rows())


if __name__ == "__main__":
    main()
