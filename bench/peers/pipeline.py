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


VALUE = np.zeros(256, np.int32)  # of a hexadecimal digit
VALUE[np.frombuffer(b"0123456789", np.uint8)] = range(10)
VALUE[np.frombuffer(b"ABCDEF", np.uint8)] = VALUE[np.frombuffer(b"abcdef", np.uint8)] = range(10, 16)


def number(digits, base=16):
    """The number of each row of digits."""
    value = VALUE[digits[:, 0]]
    for i in range(1, digits.shape[1]):
        value = value * base + VALUE[digits[:, i]]
    return value


def frames(text):
    """Identifier, acceleration in counts and counter of every line, and where its # stands; a
    frame is 12 bits of signal, 12 of counter."""
    hashes = np.flatnonzero(text == ord("#"))
    fields = np.lib.stride_tricks.sliding_window_view(text, 10)[hashes - 3]
    low, middle, high = (number(fields[:, i:i + 2]) for i in (4, 6, 8))
    raw = low | (middle & 15) << 8
    raw -= (raw & 0x800) << 1
    return number(fields[:, :3]), raw, middle >> 4 | high << 4, hashes


def ticks(counter):
    return np.concatenate(([0], np.cumsum(np.diff(counter) & 0xFFF)))


def parse(path):
    """Acceleration of each channel by tick, m/s^2."""
    identifier, raw, counter, _ = frames(np.fromfile(path, np.uint8))
    channels = []
    for channel, own in enumerate(np.unique(identifier)[:3]):
        mine = identifier == own
        tick = ticks(counter[mine])
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
    """Smooth signs of each width, and the ramps of an odd broken line; of the velocity's type."""
    widths = len(WIDTHS_MPS)
    left = np.concatenate(([0.0], NODES_MPS[:-1])).astype(velocity.dtype)
    length = np.append(np.diff(np.append(0.0, NODES_MPS))[:-1], 1e3).astype(velocity.dtype)
    out = np.empty((len(velocity), widths + len(NODES_MPS)), velocity.dtype)
    np.multiply(velocity[:, None], (0.886226925452758 / WIDTHS_MPS).astype(velocity.dtype),
                out=out[:, :widths])
    special.erf(out[:, :widths], out=out[:, :widths])
    np.clip(np.abs(velocity)[:, None] - left, 0.0, length, out=out[:, widths:])
    out[:, widths:] *= np.sign(velocity)[:, None]
    return out


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

    return np.column_stack((windows(columns) @ psi.astype(columns.dtype), windows(relative) @ psi2,
                            -(windows(relative) @ psi1), -(windows(frame) @ psi))) / norm


def main():
    frame, first, second = parse(sys.argv[1])
    relative = 2 * frame - first - second
    velocity = integral(relative)
    deflection = integral(velocity)
    density, _ = np.histogram(velocity, 64, (-0.05, 0.05))
    joint, _, _ = np.histogram2d(deflection, velocity, 32, ((-2e-3, 2e-3), (-0.05, 0.05)))
    columns = law(velocity.astype(np.float32))
    table = np.vstack([rows(frame, relative, columns, half) for half in (208, 104, 52, 26, 13)])
    chosen = [4] + list(range(10, 20))  # one width, the ramps, stiffness, viscous
    answer, *_ = np.linalg.lstsq(table[:, chosen], table[:, -1], rcond=None)
    print(f"coulomb {MASS_KG * answer[0]:.0f} N, stiffness {MASS_KG * answer[-2]:.4g} N/m, "
          f"{density.sum():.0f} and {joint.sum():.0f} counted")


if __name__ == "__main__":
    main()
