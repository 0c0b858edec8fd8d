#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Everything that `dampline identify` keeps of a record, as a NumPy and SciPy user would write it:
times and their rate, checks of the data, motion, the law averaged between samples, rows, the width
of the law, deviations by blocks, held-out errors, their history, densities with the moments that
the Fokker-Planck forms need, planes of the phase space and the guards' spectra and statistics.
What is judged by a few numbers afterwards is left out. `whole_job.py LOG`; see bench/README.md."""
import sys

import numpy as np
from scipy import signal

import pipeline
from pipeline import COUNT_MPS2, MASS_KG, NODES_MPS, RATE_HZ, WIDTHS_MPS

RANGE_MPS2 = (48.997337, 97.994674, 97.994674)
BLOCK = 600  # samples of 2 s
HALVES = (208, 104, 52, 26, 13)
WIDTHS = len(WIDTHS_MPS)
RAMPS = slice(WIDTHS, WIDTHS + len(NODES_MPS))
STIFFNESS, VISCOUS, TARGET = 18, 19, 20
GROUPS = 16


def sums(index, count, *weights):
    return np.array([np.bincount(index, w, count) for w in weights])


def read(path):
    """Counts by tick, which ticks are there, the measured rate."""
    text = np.fromfile(path, np.uint8)
    identifier, raw, counter, hashes = pipeline.frames(text)
    starts = np.concatenate(([0], np.flatnonzero(text == ord("\n"))[:-1] + 1))
    line = np.lib.stride_tricks.sliding_window_view(text, 18)[starts]
    seconds = pipeline.number(line[:, 1:11], 10)  # until 2038
    time_us = (seconds - seconds[0]) * np.int64(1_000_000) + pipeline.number(line[:, 12:18], 10)
    assert len(hashes) == len(starts)
    channels, clocks = [], []
    for own in np.unique(identifier)[:3]:
        mine = identifier == own
        tick = pipeline.ticks(counter[mine])
        channels.append((tick, raw[mine]))
        clocks.append(np.polyfit(tick, time_us[mine], 1)[0])
    length = min(tick[-1] for tick, _ in channels) + 1
    codes = np.zeros((3, length), np.int64)
    there = np.zeros((3, length), bool)
    for c, (tick, values) in enumerate(channels):
        inside = tick < length
        codes[c, tick[inside]] = values[inside]
        there[c, tick[inside]] = True
    return codes, there.all(axis=0), 1e6 / np.mean(clocks)


def stuck(codes):
    """Samples of runs of 60 and more equal codes."""
    edges = np.flatnonzero(np.concatenate(([True], np.diff(codes) != 0, [True])))
    return np.repeat(np.diff(edges) >= 60, np.diff(edges))


def by_block(bad):
    return np.add.reduceat(bad, np.arange(0, len(bad), BLOCK)) > 0


def smoothed(x):
    """Over 0.25 s."""
    return signal.lfilter([1 / (0.25 * RATE_HZ)], [1, 1 / (0.25 * RATE_HZ) - 1], x)


def averaged_law(velocity, accel):
    """Columns of the law averaged between samples: a cubic through velocities and accelerations,
    four points a sample, hat weights over two samples."""
    v0, v1, m0, m1 = velocity[:-1], velocity[1:], accel[:-1] / RATE_HZ, accel[1:] / RATE_HZ
    points = (v0, (54 * v0 + 9 * m0 + 10 * v1 - 3 * m1) / 64, (4 * (v0 + v1) + m0 - m1) / 8,
              (10 * v0 + 3 * m0 + 54 * v1 - 9 * m1) / 64)
    out = np.zeros((len(velocity), TARGET - 2), np.float32)
    for i, point in enumerate(points):
        columns = pipeline.law(point.astype(np.float32))
        out[:-1] += np.float32((4 - i) / 16) * columns
        if i > 0:
            columns *= np.float32(i / 16)
            out[1:] += columns
    return out


def block_grams(frame, relative, columns, still, bad):
    """[blocks, scales, 21, 21] of the rows that move."""
    blocks = len(bad)
    grams = np.zeros((blocks, len(HALVES), TARGET + 1, TARGET + 1))
    for s, half in enumerate(HALVES):
        table = pipeline.rows(frame, relative, columns, half)
        centre = half + (half // 4) * np.arange(len(table))
        table = table[~still[centre]]
        edges = np.searchsorted(centre[~still[centre]], BLOCK * np.arange(blocks + 1))
        for b in range(blocks):
            part = table[edges[b]:edges[b + 1]]
            grams[b, s] = part.T @ part
    grams[bad] = 0.0
    return grams


def solve(grams, columns):
    """Unknowns and what they leave, for stacked sums."""
    a = grams[..., columns, :][..., columns]
    b = grams[..., columns, TARGET]
    scale = np.sqrt(np.einsum("...ii->...i", a)) + 1e-300
    theta = np.linalg.solve(a / (scale[..., :, None] * scale[..., None, :])
                            + 1e-12 * np.eye(len(columns)), b / scale) / scale
    return theta, grams[..., TARGET, TARGET] - np.einsum("...i,...i", theta, b)


def deviations(grams, columns, theta):
    """By the scatter of the blocks."""
    a = grams[..., columns, :][..., columns]
    scores = grams[..., columns, TARGET] - a @ theta
    inverse = np.linalg.pinv(a.sum(axis=0))
    return np.sqrt(np.diag(inverse @ (scores.T @ scores) @ inverse))


def profile(grams, others):
    """The best width and the fit with it, for stacked sums of all scales."""
    left = np.stack([solve(grams, [w] + others)[1] for w in range(WIDTHS)], axis=-1)
    return left.argmin(axis=-1)


def estimates(grams):
    """Level, viscous part, curve with deviations and held-out errors; the level's history."""
    total = grams.sum(axis=0)
    weights = np.ones(len(HALVES))
    for _ in range(3):  # by what each scale leaves
        pooled = np.tensordot(weights, total, 1)
        columns = [int(profile(pooled, [STIFFNESS]))] + [STIFFNESS]
        theta, _ = solve(pooled, columns)
        direction = np.zeros(TARGET + 1)
        direction[columns], direction[TARGET] = theta, -1.0
        left = np.einsum("i,sij,j->s", direction, total, direction)
        weights = total[:, TARGET, TARGET].mean() / np.maximum(left, 1e-12)
    pooled = np.einsum("s,bsij->bij", weights, grams)
    folds = np.stack([np.delete(pooled, np.s_[f::5], axis=0).sum(axis=0) for f in range(5)])
    out = []
    for others in ([STIFFNESS], [STIFFNESS, VISCOUS], list(range(RAMPS.start, RAMPS.stop))
                   + [STIFFNESS]):
        columns = [int(profile(pooled.sum(axis=0), others))] + others
        theta, _ = solve(pooled.sum(axis=0), columns)
        held_out = 0.0
        for f in range(5):
            direction = np.zeros(TARGET + 1)
            direction[columns], direction[TARGET] = solve(folds[f], columns)[0], -1.0
            held_out += direction @ pooled[f::5].sum(axis=0) @ direction
        out.append((columns, theta, deviations(pooled, columns, theta),
                    held_out / pooled[:, TARGET, TARGET].sum()))
    return out, history(pooled)


def history(pooled):
    """Level and deviation every 4 s, from 960 s on every 8 s."""
    moments = np.concatenate((np.arange(10, min(480, len(pooled)), 2),
                              np.arange(480, len(pooled), 4)))
    so_far = np.cumsum(pooled, axis=0)[moments]
    width = profile(so_far, [STIFFNESS])
    rows = []
    for moment, w, gram in zip(moments, width, so_far):
        columns = [int(w), STIFFNESS]
        theta, _ = solve(gram, columns)
        rows.append((moment, theta, deviations(pooled[:moment + 1], columns, theta)))
    return rows


def densities(velocity, deflection, frame, relative, moving):
    """Histograms, drift moments by side, bin and group of blocks, spectra and moments of the
    input, powers of stretches."""
    group = np.arange(len(velocity)) // BLOCK % GROUPS
    v, y, f, r, g = (x[moving] for x in (velocity, deflection, frame, relative, group))
    z = f - 0.5 * r  # mean of the wheelsets
    nodes = np.concatenate(([0.0, 0.5 * NODES_MPS[0]], NODES_MPS))
    speed = np.abs(v)
    place = np.minimum(np.searchsorted(nodes, speed, "right") - 1, len(nodes) - 2)
    u = (speed - nodes[place]) / np.diff(nodes)[place]
    index = (g * 2 + (v >= 0)) * (len(nodes) - 1) + place
    away = speed > 0.0015 * np.abs(r)
    count = GROUPS * 2 * (len(nodes) - 1)
    weights = (np.ones_like(u), u, u * u, y, u * y, f, u * f)
    fine = np.clip(((v + 0.1) * (512 / 0.2)).astype(int), 0, 511)
    powers = np.vander(1e3 * y, 9, increasing=True)
    _, _, spectra = signal.spectrogram(z, RATE_HZ, "hann", 512, 256, detrend=False)
    stretch = np.arange(len(v)) * 32 // len(v)
    return (np.bincount(g * 512 + fine, minlength=GROUPS * 512), np.histogram(y, 128)[0],
            np.histogram2d(y, v, 32)[0], sums(index, count, *weights),
            sums(index[away], count, *(w[away] for w in weights)), spectra.mean(axis=1),
            powers.sum(axis=0), (z * z) @ powers[:, :5], sums(stretch, 32, v * v, z * z),
            np.count_nonzero(np.diff(v > 0)))


def phase_planes(velocity, deflection, relative, moving):
    v, y, r = velocity[moving], deflection[moving], relative[moving]
    slow = velocity[:len(velocity) // 6 * 6].reshape(-1, 6).mean(axis=1)  # 50 Hz
    spectrum = np.fft.rfft(slow, 2 * len(slow))
    return ([np.histogram2d(a, b, 96)[0] for a, b in ((y, v), (y, r), (v, r))],
            np.fft.irfft(np.abs(spectrum) ** 2)[:512])


def spectral_guards(accel, delay):
    """Powers and cross spectra of the channels and of wheelset 1 delayed, by blocks of twelve
    segments; the phase of each segment."""
    channels = np.vstack((accel, np.roll(accel[1], delay), 0.5 * (accel[1] + accel[2])))
    segments = np.lib.stride_tricks.sliding_window_view(channels, 512, axis=1)[:, ::256]
    f, one, two, late, mean = np.fft.rfft(segments * signal.windows.hann(512, False))[..., :256]
    starts = np.arange(0, len(f), 12)
    out = [np.add.reduceat(x, starts) for x in (
        np.abs(f) ** 2, np.abs(one) ** 2, np.abs(two) ** 2, np.abs(late) ** 2, np.abs(mean) ** 2,
        one.conj() * two, late.conj() * two, one.conj() * f, two.conj() * f)]
    slope = np.arange(256) * (np.abs(out[6]).mean(axis=0))
    return out, np.angle(late.conj() * two) @ slope / (slope @ np.arange(256))


def wheelset_guard(one, two, delay):
    """Wheelset 2 beside the delayed wheelset 1: differences of chunks of eight samples for shifts
    of four samples to either side, smallest of a window; its cubic part."""
    late = np.convolve(np.roll(one, delay), np.sinc(np.arange(-12, 12) + 0.5), "same")
    short = len(late) // 8 * 8
    error = np.stack([((two - np.roll(late, s))[:short] ** 2).reshape(-1, 8).sum(axis=1)
                      for s in range(-4, 5)])
    windows = np.cumsum(error, axis=1)
    best = (windows[:, 3:] - windows[:, :-3]).argmin(axis=0)
    blocks = np.arange(0, len(late), 10 * BLOCK // 2)
    cubic = []
    for x, y in ((late, two), (two, late)):
        c = x**3 / np.mean(x * x) - 3 * x
        cubic.append([np.add.reduceat(p, blocks) for p in (x * x, x * c, c * c, x * y, c * y)])
    return best, np.median(error, axis=1), cubic


def sample_guards(codes, accel):
    """Per channel: moving bits, ends of the range by blocks, strikes against the median second
    difference of their 2 s, impulses by the sixth difference, jumps of the mean of a second."""
    out = []
    for c in range(3):
        own = codes[c]
        whole = own[:len(own) // BLOCK * BLOCK].reshape(-1, BLOCK)
        change = np.abs(np.diff(own, 2, prepend=own[:2]))[:whole.size].reshape(-1, BLOCK)
        usual = np.median(change, axis=1)
        block, at = np.nonzero(change > 12 * (usual[:, None] + 1))
        at = np.clip(block * BLOCK + at, 3, len(own) - 4)
        around = own[at[:, None] + np.arange(-3, 4)]
        repaired = around @ np.array([0, -1, 4, 0, 4, -1, 0]) / 6
        sixth = np.abs(np.diff(accel[c], 6))
        second = accel[c][:len(own) // 300 * 300].reshape(-1, 300).mean(axis=1)
        mean = np.convolve(second, np.ones(5) / 5, "valid")
        out.append((np.bitwise_or.reduce(np.diff(own) ^ 0), whole.max(axis=1), whole.min(axis=1),
                    (whole == whole.max(axis=1)[:, None]).sum(axis=1),
                    (whole == whole.min(axis=1)[:, None]).sum(axis=1), around[:, 3] - repaired,
                    np.mean(sixth**2), np.median(sixth.reshape(-1)), mean[6:] - mean[:-6]))
    same = np.all(codes[:, 1:] == codes[:, :-1], axis=0).sum()
    return out, same - np.all(codes[:, 2:] == codes[:, :-2], axis=0).sum()


def main():
    codes, there, rate_hz = read(sys.argv[1])
    accel = codes * np.array([COUNT_MPS2[c] for c in range(3)])[:, None]
    wrong = ~there | (np.abs(accel) >= np.array(RANGE_MPS2)[:, None]).any(axis=0)
    bad = by_block(wrong) | by_block(np.any([stuck(c) for c in codes], axis=0))
    frame, first, second = accel
    relative = 2 * frame - first - second
    velocity = pipeline.integral(relative)
    deflection = pipeline.integral(velocity)
    input_change = np.diff(0.5 * (first + second), prepend=0.0)
    still = (smoothed(velocity**2) < 0.002**2) | (smoothed(input_change**2) < 0.2**2)
    columns = averaged_law(velocity, relative)
    fits, rows = estimates(block_grams(frame, relative, columns, still, bad))
    kept = densities(velocity, deflection, frame, relative, ~still)
    planes = phase_planes(velocity, deflection, relative, ~still)
    spectrum = np.fft.rfft(first[:65536]).conj() * np.fft.rfft(second[:65536])
    delay = int(np.argmax(np.fft.irfft(spectrum / (np.abs(spectrum) + 1e-30))[:96]))
    guards = (spectral_guards(accel, delay), wheelset_guard(first, second, delay),
              sample_guards(codes, accel))
    columns, theta, deviation, held_out = fits[0]
    print(f"coulomb {MASS_KG * theta[0]:.0f} +- {MASS_KG * deviation[0]:.0f} N, stiffness "
          f"{MASS_KG * theta[1]:.4g} +- {MASS_KG * deviation[1]:.2g} N/m, width "
          f"{1e3 * WIDTHS_MPS[columns[0]]:.1f} mm/s, held out {held_out:.4f}, {rate_hz:.3f} Hz, "
          f"{len(rows)} moments, {bad.sum()} blocks left out, delay {delay}, "
          f"{kept[0].sum()} and {planes[0][0].sum():.0f} counted, {len(guards[2][0])} guarded")


if __name__ == "__main__":
    main()
