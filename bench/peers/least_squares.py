#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""NumPy's answer to the rows that `peers_rls --rows FILE` wrote, beside the project's in the same
file, and what a recursion row by row costs as a NumPy user would write it. Exit 1 where the answers
are further apart than 1e-9. `least_squares.py FILE [JSON]`; see bench/README.md."""
import json
import sys
import time

import numpy as np

UNKNOWNS = 32
PRIOR_VARIANCE = 1e4  # parameters 0, as every contestant of peers_rls
SAME_ANSWER = 1e-9


def recursive(x, y):
    p = PRIOR_VARIANCE * np.eye(UNKNOWNS)
    theta = np.zeros(UNKNOWNS)
    for row, value in zip(x, y):
        px = p @ row
        gain = px / (1.0 + row @ px)
        theta += gain * (value - row @ theta)
        p -= np.outer(gain, px)
    return theta


def main():
    numbers = np.fromfile(sys.argv[1])
    rows = numbers[:-UNKNOWNS].reshape(-1, UNKNOWNS + 1)
    ours = numbers[-UNKNOWNS:]
    x, y = rows[:, :-1], rows[:, -1]
    prior = np.eye(UNKNOWNS) / np.sqrt(PRIOR_VARIANCE)
    start = time.process_time()
    batch, *_ = np.linalg.lstsq(np.vstack((prior, x)), np.append(np.zeros(UNKNOWNS), y), rcond=None)
    middle = time.process_time()
    row_by_row = recursive(x, y)
    end = time.process_time()
    print(f"| NumPy {np.__version__}, n = {UNKNOWNS} | ns per row | difference of the answer |")
    print("|--|--|--|")
    same = True
    out = []
    for name, answer, cost_s in (("lstsq over all rows", batch, middle - start),
                                 ("recursion row by row", row_by_row, end - middle)):
        difference = np.abs(answer - ours).max()
        same = same and difference < SAME_ANSWER
        print(f"| {name} | {1e9 * cost_s / len(y):.0f} | {difference:.1e} |")
        out.append({"name": f"NumPy {np.__version__}, {name}", "forgetting": 1.0, "held": True,
                    "unknowns": UNKNOWNS,
                    "ns_per_row": 1e9 * cost_s / len(y), "difference": difference})
    if len(sys.argv) > 2:
        with open(sys.argv[2], "w", encoding="utf-8") as file:
            json.dump({"least_squares": out}, file)
    sys.exit(0 if same else 1)


main()
