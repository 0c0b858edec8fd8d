#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What SciPy makes of the records of `noise --records FOLDER`, with the true structure given:
least squares on central differences, and output error (least_squares on Runge and Kutta's steps) of the smooth laws,
started there. Prints a table of the worst parameter's median error over the seeds.
`noise.py FOLDER`; see bench/README.md."""
import pathlib
import re
import statistics
import sys
import time

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

# Terms of each law beside the mass: name, and the function of x and v.
PLAIN = {"stiffness": lambda x, v: x, "viscous": lambda x, v: v}
LAWS = {
    "linear": PLAIN,
    "Duffing": {**PLAIN, "cubic_stiffness": lambda x, v: x**3},
    "VanDerPol": {**PLAIN, "progressive_damping": lambda x, v: x * x * v},
    "Coulomb": {**PLAIN, "coulomb": lambda x, v: np.sign(v)},
}
SMOOTH = ("linear", "Duffing", "VanDerPol")


def read(path):
    truth = {}
    with path.open() as lines:
        for line in lines:
            if not line.startswith("#"):
                break
            name, value = line[1:].split()
            truth[name] = float(value)
    t, x, f = np.loadtxt(path, delimiter=",", skiprows=len(truth) + 1, unpack=True)
    return truth, t, x, f


def by_differences(terms, t, x, f):
    h = t[1] - t[0]
    v = (x[2:] - x[:-2]) / (2 * h)
    a = (x[2:] - 2 * x[1:-1] + x[:-2]) / h**2
    columns = [a, *(term(x[1:-1], v) for term in terms.values())]
    return np.linalg.lstsq(np.column_stack(columns), f[1:-1], rcond=None)[0]


def paths_of(terms, unknowns, force, h):
    """Deflections of several laws at once, a column each: Runge and Kutta's fourth order. `force` at
    the samples and halfway between them; `unknowns`: mass, coefficients, start."""
    mass, *coefficients, x, v = unknowns
    functions = list(terms.values())

    def accel(push, x, v):
        return (push - sum(c * g(x, v) for c, g in zip(coefficients, functions))) / mass

    out = np.empty((len(force) // 2 + 1, len(x)))
    out[0] = x
    for i in range(len(out) - 1):
        a, b, c = force[2 * i : 2 * i + 3]
        a1 = accel(a, x, v)
        v2 = v + h / 2 * a1
        a2 = accel(b, x + h / 2 * v, v2)
        v3 = v + h / 2 * a2
        a3 = accel(b, x + h / 2 * v2, v3)
        v4 = v + h * a3
        a4 = accel(c, x + h * v3, v4)
        x = x + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        out[i + 1] = x
    return out


def by_output(terms, t, x, f, start):
    h = t[1] - t[0]
    force = CubicSpline(t, f)(t[0] + h / 2 * np.arange(2 * len(t) - 1))
    rms = np.std(x)
    scale = np.array([*np.abs(start), rms, 10 * rms])

    def left(u):
        path = paths_of(terms, (u * scale)[:, None], force, h)[:, 0]
        return np.nan_to_num((path - x) / rms, nan=1e3, posinf=1e3, neginf=-1e3)

    def slopes(u):
        beside = u[:, None] + np.column_stack([np.zeros(len(u)), 1e-6 * np.eye(len(u))])
        paths = paths_of(terms, beside * scale[:, None], force, h)
        return np.nan_to_num((paths[:, 1:] - paths[:, :1]) / (1e-6 * rms))

    fit = least_squares(left, [*np.sign(start), x[0] / rms, 0.0], slopes, method="lm", max_nfev=60)
    return (fit.x * scale)[:-2]


def worst(truth, terms, theta):
    found = dict(zip(["moving_mass", *terms], theta))
    return max(100 * abs(found[name] / value - 1) for name, value in truth.items())


def main():
    rows = {}
    for path in sorted(pathlib.Path(sys.argv[1]).glob("*.csv")):
        system, of_x, of_force, _ = re.fullmatch(r"(\w+)_([\d.]+)_([\d.]+)_(\d+)", path.stem).groups()
        if system not in LAWS:
            continue
        truth, t, x, f = read(path)
        terms = LAWS[system]
        row = rows.setdefault((list(LAWS).index(system), float(of_force), float(of_x)), ([], [], []))
        start = by_differences(terms, t, x, f)
        row[0].append(worst(truth, terms, start))
        if system in SMOOTH:
            clock = time.process_time()
            # Noise ruins the differences as a start: ten per cent off the truth instead.
            guess = [value * 1.1 for value in (truth["moving_mass"], *(truth[n] for n in terms))]
            row[1].append(worst(truth, terms, by_output(terms, t, x, f, np.array(guess))))
            row[2].append(time.process_time() - clock)
    print("| system | noise of x, % | of the force, % | SciPy, central differences, % "
          "| SciPy, output error, % | processor s |\n|---|---|---|---|---|---|")
    for (number, of_force, of_x), row in sorted(rows.items()):
        cells = [f"{statistics.median(values):.3g}" if values else "" for values in row]
        print(f"| {list(LAWS)[number]} | {of_x:g} | {of_force:g} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
