#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""SciPy's filter and NumPy's histograms, over whole arrays, on the samples that `peers_signals
--signals FILE` wrote; the counts beside the project's in the same file. Exit 1 where a bin differs.
`signals.py FILE [JSON]`; see bench/README.md."""
import json
import sys
import time

import numpy as np
from scipy import signal

LINE = 64
PLANE = 32
VELOCITY_MPS = 0.05
DEFLECTION_M = 2e-3
ROUNDS = 15


def best_ns(work, samples):
    """Of the rounds, processor time per sample; and the last answer."""
    best = float("inf")
    for _ in range(ROUNDS):
        start = time.process_time()
        answer = work()
        best = min(best, time.process_time() - start)
    return 1e9 * best / samples, answer


def main():
    numbers = np.fromfile(sys.argv[1])
    counts = numbers[-(LINE + PLANE * PLANE):]
    relative, deflection, velocity = numbers[: -len(counts)].reshape(3, -1)
    high = signal.butter(4, 0.7, "highpass", fs=300.0, output="sos")
    filtered, _ = best_ns(lambda: signal.sosfilt(high, relative), len(relative))
    line, line_counts = best_ns(
        lambda: np.histogram(velocity, LINE, (-VELOCITY_MPS, VELOCITY_MPS))[0], len(velocity))
    limits = ((-DEFLECTION_M, DEFLECTION_M), (-VELOCITY_MPS, VELOCITY_MPS))
    plane, plane_counts = best_ns(
        lambda: np.histogram2d(deflection, velocity, PLANE, limits)[0], len(velocity))
    difference = max(np.abs(line_counts - counts[:LINE]).max(),
                     np.abs(plane_counts.ravel() - counts[LINE:]).max())
    out = [{"name": name, "ns_per_sample": ns}
           for name, ns in (("motion: scipy.signal.sosfilt, whole array", filtered),
                            ("histogram of 64: numpy.histogram, whole array", line),
                            ("joint histogram of 32 x 32: numpy.histogram2d, whole array", plane))]
    print("| whole arrays, ns per sample | |")
    print("|--|--|")
    for entry in out:
        print(f"| {entry['name']} | {entry['ns_per_sample']:.1f} |")
    print(f"Counts of the bins differ by at most {difference:.0f}")
    if len(sys.argv) > 2:
        with open(sys.argv[2], "w", encoding="utf-8") as file:
            json.dump({"streaming": out, "largest_difference": difference}, file)
    sys.exit(0 if difference < 0.5 else 1)


main()
