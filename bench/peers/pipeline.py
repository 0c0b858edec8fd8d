#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The same job as `dampline identify`, as a NumPy and SciPy user would write it: a candump log of
the project's simulated sensors, parsed by whole arrays, filtered, counted in histograms, and brought
to the same rows of windows and one least-squares solution. `pipeline.py LOG`; see bench/README.md."""
import sys

import numpy as np
from scipy import signal, special

RATE_HZ = 300.0
MASS_KG = 37200.0
NODES_MPS = np.array([3.0, 5.5, 8.0, 11.0, 14.5, 19.0, 26.0, 40.0]) * 1e-3
WIDTHS_MPS = np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0]) * 1e-3
COUNT_MPS2 = {0: 49.03325 / 2048, 1: 98.0665 / 2048, 2: 98.0665 / 2048}


def digits(text, starts, count):
    """The hexadecimal numbers of `count` digits that begin at `starts`."""
    value = np.zeros(len(starts), np.int64)
    for i in range(count):
        c = text[starts + i].astype(np.int64)
        value = value * 16 + np.where(c >= 65, (c & 0x5F) - 55, c - 48)
    return value


def parse(path):
    """Acceleration of each channel by tick, m/s^2; a frame is 12 bits of signal, 12 of counter."""
    text = np.fromfile(path, np.uint8)
    hashes = np.flatnonzero(text == ord("#"))
    identifier = digits(text, hashes - 3, 3)
    low, middle, high = (digits(text, hashes + 1 + 2 * i, 2) for i in range(3))
    raw = low | (middle & 15) << 8
    raw -= (raw & 0x800) << 1
    counter = middle >> 4 | high << 4
    channels = []
    for channel, number in enumerate(sorted(set(identifier.tolist()))[:3]):
        mine = identifier == number
        count = counter[mine]
        tick = np.concatenate(([0], np.cumsum((np.diff(count) & 0xFFF))))
        values = np.zeros(tick[-1] + 1)
        values[tick] = COUNT_MPS2[channel] * raw[mine]
        channels.append(values)
    length = min(map(len, channels))
    return [c[:length] for c in channels]


def integral(x):
    """Integral without drift: zero phase, fourth order."""
    high = signal.butter(4, 0.7, "highpass", fs=RATE_HZ, output="sos")
    return signal.sosfiltfilt(high, np.cumsum(signal.sosfiltfilt(high, x)) / RATE_HZ)


def law(velocity):
    signs = special.erf(0.886226925452758 * velocity[:, None] / WIDTHS_MPS)
    left = np.concatenate(([0.0], NODES_MPS[:-1]))
    length = np.append(np.diff(np.append(0.0, NODES_MPS))[:-1], 1e3)
    ramps = np.clip(np.abs(velocity)[:, None] - left, 0.0, length) * np.sign(velocity)[:, None]
    return np.hstack((signs, ramps))


def rows(frame, relative, columns, half):
    """[columns, stiffness, viscous | target] at every fourth of `half`, by strided windows."""
    u = np.arange(-half, half + 1) / (half + 1)
    q = 1.0 - u * u
    psi = 672 * q**4 * (1 - 26 * u**2 + 65 * u**4)
    psi1 = 672 * u * q**5 * (1 - 5 * u**2) * (half + 1) / RATE_HZ
    psi2 = 16 * q**6 * (15 * u**2 - 1) * ((half + 1) / RATE_HZ) ** 2
    norm = np.sqrt(np.sum(psi**2))
    stride = half // 4

    def windows(x):
        return np.lib.stride_tricks.sliding_window_view(x, 2 * half + 1, axis=0)[::stride]

    return np.column_stack((windows(columns) @ psi, windows(relative) @ psi2,
                            -(windows(relative) @ psi1), -(windows(frame) @ psi))) / norm


def main():
    frame, first, second = parse(sys.argv[1])
    relative = 2 * frame - first - second
    velocity = integral(relative)
    deflection = integral(velocity)
    density, _ = np.histogram(velocity, 64, (-0.05, 0.05))
    joint, _, _ = np.histogram2d(deflection, velocity, 32, ((-2e-3, 2e-3), (-0.05, 0.05)))
    columns = law(velocity)
    table = np.vstack([rows(frame, relative, columns, half) for half in (208, 104, 52, 26, 13)])
    chosen = [4] + list(range(10, 20))  # one width, the ramps, stiffness, viscous
    answer, *_ = np.linalg.lstsq(table[:, chosen], table[:, -1], rcond=None)
    print(f"coulomb {MASS_KG * answer[0]:.0f} N, stiffness {MASS_KG * answer[-2]:.4g} N/m, "
          f"{density.sum():.0f} and {joint.sum():.0f} counted")


main()
