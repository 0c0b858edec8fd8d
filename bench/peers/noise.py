#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What SciPy makes of the records of `noise --records FOLDER`, with the true structure given:
least squares on central differences, and output error (least_squares on odeint) of the smooth laws,
started there. Prints a table of the worst parameter's median error over the seeds.
`noise.py FOLDER`; see bench/README.md."""
import pathlib
import re
import statistics
import sys
import time

import numpy as np
from scipy.integrate import odeint
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


def by_output(terms, t, x, f, start):
    force = CubicSpline(t, f)
    piece, base, h = force.c.tolist(), t[0], t[1] - t[0]
    functions = list(terms.values())
    last = len(t) - 2

    def rate(state, at, theta):
        i = min(max(int((at - base) / h), 0), last)
        u = at - base - i * h
        push = ((piece[0][i] * u + piece[1][i]) * u + piece[2][i]) * u + piece[3][i]
        held = sum(c * g(state[0], state[1]) for c, g in zip(theta[1:], functions))
        return state[1], (push - held) / theta[0]

    def left(unknowns):
        theta = unknowns[:-2] * scale
        path = odeint(rate, unknowns[-2:] * (rms, rms / h * 0.01), t, args=(theta.tolist(),),
                      rtol=1e-8, atol=1e-10, mxstep=5000)
        return np.nan_to_num((path[:, 0] - x) / rms, nan=1e3, posinf=1e3, neginf=-1e3)

    scale = np.maximum(np.abs(start), 1e-9)
    rms = np.std(x)
    fit = least_squares(left, [*np.sign(start), x[0] / rms, 0.0], method="lm", max_nfev=400)
    return fit.x[:-2] * scale


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
