# SPDX-License-Identifier: MIT
"""Runs of dampline for analysts: one file, needs Python 3.9 and NumPy.

    import dampline
    run = dampline.load("run1")
    run["coulomb"].value, run["coulomb"].std, run["coulomb"].unit
    run.tables["curve"]["force_n"]                      # every CSV file, by its columns
    table = dampline.load_many("runs/*.run")            # a column for each name, a row for each run
    pandas.DataFrame(table)                             # where there is pandas
    state = dampline.read_state("run1/state.dls")       # docs/state_format.md
    state.level(moving_mass_kg=37200.0)                 # friction and stiffness from it

Units are those of the files: SI, and the name of a column ends in its unit.
"""
import collections
import csv
import glob
import json
import os
import struct

import numpy as np

Estimate = collections.namedtuple("Estimate", "value std unit")
Estimate.__doc__ = "A value and its standard deviation, in `unit`."

_NULL = float("nan")


class Run:
    """A run directory. run[NAME] is a parameter; `run.parameters` has all of them by name.

    `about`: all of parameters.json; `tables`: of each CSV file, by its name without the suffix, the
    columns as arrays by their header: numbers as floats (no number: NaN), else text.
    """

    def __init__(self, path):
        self.path = os.fspath(path)
        with open(os.path.join(self.path, "parameters.json"), encoding="utf-8") as file:
            self.about = json.load(file)
        self.parameters = {p["name"]: _estimate(p) for p in self.about["parameters"]}
        self.tables = {}
        for name in sorted(os.listdir(self.path)):
            stem, suffix = os.path.splitext(name)
            if suffix == ".csv":
                self.tables[stem] = _read_table(os.path.join(self.path, name))

    def __getitem__(self, name):
        return self.parameters[name]

    def __contains__(self, name):
        return name in self.parameters

    def __repr__(self):
        values = ", ".join(f"{n} {p.value:.6g} ± {p.std:.2g} {p.unit}" for n, p in self.parameters.items())
        return f"<{self.path}: {self.about['trust']}; {values}>"

    @property
    def start(self):
        """First sample in UTC; NaT where the record has no epoch."""
        return _time(self.about.get("start_utc"))

    @property
    def end(self):
        """Newest sample in UTC."""
        return _time(self.about.get("end_utc"))

    @property
    def state(self):
        """state.dls of a truck's run."""
        return read_state(os.path.join(self.path, "state.dls"))


def load(run):
    """The run directory `run`. FileNotFoundError where it holds no parameters.json."""
    return Run(run)


def load_many(pattern):
    """Runs as a table, a dictionary of columns of the same length, in the order of their start.

    `pattern`: a glob, or a list of directories; what holds no parameters.json is passed over. The
    columns: run, vehicle, truck, note, source, version, commit, kind, model, trust, start, end
    (datetime64, UTC), duration_s, nmse, held_out_nmse, and of each parameter of any run NAME_UNIT
    and NAME_std_UNIT; NaN where a run has it not. ValueError where a parameter has two units.
    """
    paths = sorted(glob.glob(os.fspath(pattern))) if isinstance(pattern, (str, os.PathLike)) else pattern
    runs = [Run(p) for p in paths if os.path.exists(os.path.join(p, "parameters.json"))]
    runs.sort(key=lambda run: (np.isnat(run.start), run.start, run.path))
    table = {"run": np.array([run.path for run in runs], dtype=object)}
    for key in ("vehicle", "truck", "note", "source", "version", "commit", "kind", "trust"):
        table[key] = np.array([run.about.get(key) for run in runs], dtype=object)
    table["model"] = np.array([", ".join(run.about["model"]) for run in runs], dtype=object)
    table["start"] = np.array([run.start for run in runs], dtype="datetime64[us]")
    table["end"] = np.array([run.end for run in runs], dtype="datetime64[us]")
    table["duration_s"] = _floats(run.about["duration_s"] for run in runs)
    for key in ("nmse", "held_out_nmse"):
        table[key] = _floats(run.about["fit"][key] for run in runs)
    for name, unit in _units_of(runs).items():
        suffix = unit_suffix(unit)
        column = f"_{suffix}" if suffix else ""
        found = [run.parameters.get(name, Estimate(_NULL, _NULL, unit)) for run in runs]
        table[f"{name}{column}"] = _floats(p.value for p in found)
        table[f"{name}_std{column}"] = _floats(p.std for p in found)
    return table


def unit_suffix(unit):
    """ "N s^2/m^2" as the names of columns end in it: "ns2pm2"."""
    if unit == "%":
        return "percent"
    above, _, below = unit.partition("/")
    letters = lambda text: "".join(c for c in text.lower() if c.isalnum())
    above = "" if above == "1" else letters(above)
    return above + ("p" + letters(below) if below else "")


def _units_of(runs):
    units = {}
    for run in runs:
        for name, p in run.parameters.items():
            if units.setdefault(name, p.unit) != p.unit:
                raise ValueError(f"{run.path}: {name} in {p.unit}, expected {units[name]} as in the runs before")
    return units


def _estimate(p):
    number = lambda x: _NULL if x is None else float(x)
    return Estimate(number(p["value"]), number(p["std"]), p["unit"])


def _floats(values):
    return np.array([_NULL if v is None else v for v in values], dtype=float)


def _time(text):
    return np.datetime64("NaT", "us") if text is None else np.datetime64(text.rstrip("Z"), "us")


def _read_table(path):
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    header, cells = rows[0], rows[1:]
    return {name: _column([row[i] for row in cells]) for i, name in enumerate(header)}


def _column(cells):
    try:
        return np.array([float(c) if c else _NULL for c in cells])
    except ValueError:
        return np.array(cells, dtype=object)


# state.dls, as firmware_core/docs/state_format.md has it.

_SCALES, _COLUMNS, _SEGMENTS, _MOST_ENTRIES = 5, 21, 8, 28
_PACKED = _COLUMNS * (_COLUMNS + 1) // 2
_HEAD_BYTES, _FACTORS_BYTES = 360, 8 * _SCALES * (_PACKED + 1) + 4
_LIGHT_BYTES = _FACTORS_BYTES - 4 * _SCALES * _PACKED
_COUNTS = ("samples gaps lost saturated stuck not_finite repeated blocks blocks_excluded blocks_still "
           "rows rows_still").split()
_WIDTHS_MPS = 1e-3 * np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 11.0])
_STIFFNESS, _VISCOUS, _TARGET = 18, 19, 20
_LONG_SCALES = 4
# Of the time that the truck sticks: from where on and up to where the bent law counts; what bias is
# left of level and stiffness for each unit of the share, and from where on.
_BENDS = 0.15, 0.25
_STICKING = (0.05, 0.12), (0.32, 0.18)
# The velocity's own error: widths of exact sensors' law, m/s and m/s Hz^3; what goes with the part
# between samples below so many Hz; bias of level and stiffness for each unit of the share; and what
# of each is not known.
_EXACT_WIDTH = 1.9e-3, 1.0e4
_LOST, _AMPLE_HZ = (0.0055, 0.7), 300.0
_LEVEL_BIAS, _STIFFNESS_BIAS = (0.27, 0.30), (0.30, 1.0)

Factors = collections.namedtuple("Factors", "factor rows blocks")
Factors.__doc__ = """Of one stretch: `factor` (5, 21, 21), the upper triangles R of the scales; `rows`
(5,), how many rows each holds; `blocks`, of 2 s."""


class State:
    """The sufficient statistics of a truck's run: the fields of state.dls by their names, `total`
    (Factors), `entries`, a list of Factors, oldest first (none of a light state), and `about`, what
    it is of: vehicle, truck, start_ns, sequence, ... (empty: of version 1)."""

    def level(self, moving_mass_kg, sample_rate_hz=None, viscous=False):
        """Parameters as parameters.json has them: a dictionary of Estimate.

        `sample_rate_hz`: the measured rate, `sample_rate` of parameters.json; absent: the nominal
        one. `viscous`: with a viscous part in the model. ValueError where the data do not suffice.
        """
        if len(self.entries) < 4:
            raise ValueError(f"{len(self.entries)} entries, at least 4 are needed")
        law, std = self._law(range(_SCALES), viscous)
        long_law, long_std = self._law(range(_LONG_SCALES), viscous)
        ratio = 1.0 if sample_rate_hz is None else sample_rate_hz / self.sample_rate_hz
        coulomb, stiffness = law.theta[0], long_law.theta[1]
        level, level_std = self._level(law, std[0], viscous)
        sticks = [factor * max(self.stick_share - start, 0.0) for factor, start in _STICKING]
        level_std = np.hypot(level_std, level * np.hypot(2.5e-3, sticks[0]))
        stiffness_std = np.hypot(long_std[1], stiffness * np.hypot(3e-3, sticks[1]))
        below, above = _neighbours(law.width)
        span = _WIDTHS_MPS[above] - _WIDTHS_MPS[below]
        width = _WIDTHS_MPS[law.width] + law.theta[-1] / coulomb * span
        share, lost = self._velocity_error(width)
        bias = _LEVEL_BIAS[0] * share
        level, level_std = _corrected(level, level_std, (1.0 + lost) / (1.0 + bias),
                                      np.hypot(_LEVEL_BIAS[1] * bias, _LOST[1] * lost))
        bias = _STIFFNESS_BIAS[0] * share
        stiffness, stiffness_std = _corrected(stiffness, stiffness_std, 1.0 + bias,
                                              np.hypot(_STIFFNESS_BIAS[1] * bias, _LOST[1] * lost))
        k = moving_mass_kg * ratio**2
        out = {"coulomb": Estimate(moving_mass_kg * level, moving_mass_kg * level_std, "N"),
               "stiffness": Estimate(k * stiffness, k * stiffness_std, "N/m")}
        if viscous:
            floor = 3e-3 * level / self.velocity_rms_mps
            out["viscous"] = Estimate(moving_mass_kg * ratio * law.theta[2],
                                      moving_mass_kg * ratio * np.hypot(std[2], floor), "N s/m")
        out["law_width"] = Estimate(width / ratio, std[-1] / coulomb * span / ratio, "m/s")
        return out

    @property
    def velocity_rms_mps(self):
        """Of the samples that moved."""
        return float(np.sqrt(self.sum_squares / self.moving))

    @property
    def stick_share(self):
        """Of the samples that moved."""
        return self.sticking / self.moving

    def _velocity_error(self, width_mps):
        """Share by which the law is wider than that of exact sensors, of the motion; and what of the
        level goes with the velocity's part between samples."""
        exact = _EXACT_WIDTH[0] + _EXACT_WIDTH[1] / self.sample_rate_hz**3
        share = max(width_mps**2 - exact**2, 0.0) / self.velocity_rms_mps**2
        return share, _LOST[0] * max((_AMPLE_HZ / self.sample_rate_hz)**2 - 1.0, 0.0)

    def _level(self, law, std, viscous):
        """The level of the law, or, the more the truck sticks, of the bent one, and its deviation."""
        share = np.clip((self.stick_share - _BENDS[0]) / (_BENDS[1] - _BENDS[0]), 0.0, 1.0)
        below, above = _neighbours(law.width)
        if share == 0.0 or above - below < 2:
            return law.theta[0], std
        columns = _map([_unit(law.width)] + _middle(viscous) +
                       [_unit(above) - _unit(below), _unit(above) - 2 * _unit(law.width) + _unit(below)])
        fit = _weighted_fit(self.total, columns, range(_SCALES))
        bent_std = self._deviations(fit, columns)[0]
        return law.theta[0] + share * (fit.theta[0] - law.theta[0]), std + share * (bent_std - std)

    def _deviations(self, fit, columns):
        count = len(self.entries)
        factor = 1.0 + 3.0 / (count - 3.0) if count > 4 else 4.0
        return factor * np.sqrt(np.maximum(np.diag(_score_covariance(fit, self.entries, columns)), 0.0))

    def _law(self, scales, viscous):
        """The law of the width that fits best, with the width free, and its unknowns' deviations."""
        middle = _middle(viscous)
        fits = [_weighted_fit(self.total, _map([_unit(i)] + middle), scales) for i in range(len(_WIDTHS_MPS))]
        width = int(np.argmin([fit.objective for fit in fits]))
        below, above = _neighbours(width)
        columns = _map([_unit(width)] + middle + [_unit(above) - _unit(below)])
        fit = _weighted_fit(self.total, columns, scales)._replace(width=width)
        return fit, self._deviations(fit, columns)


def read_state(path):
    """Reads state.dls. ValueError where it is none, is cut off or damaged, or of another version."""
    with open(path, "rb") as file:
        data = file.read()
    version, light, payload = _check_frame(data, os.fspath(path))
    state = State()
    fields = struct.unpack_from("<Qdd8dII8Q8QQQddq12Q", payload)
    state.basis_hash, state.sample_rate_hz, state.velocity_corner_hz = fields[:3]
    state.curve_nodes_mps = np.array(fields[3:11])
    entries, state.blocks_per_entry = fields[11:13]
    state.positive, state.negative = np.array(fields[13:21]), np.array(fields[21:29])
    state.moving, state.sticking, state.sum_squares, state.noise_mps2, state.newest_tick = fields[29:34]
    state.counts = dict(zip(_COUNTS, fields[34:]))
    length = _LIGHT_BYTES if light else _FACTORS_BYTES
    sums = _HEAD_BYTES + (entries + 1) * length
    if entries > _MOST_ENTRIES or len(payload) < sums or (version == 1 and len(payload) != sums):
        raise ValueError(f"{path}: a payload of another length than its {entries} entries need")
    factors = [_factors(payload, _HEAD_BYTES + i * length, light) for i in range(entries + 1)]
    state.total, state.entries = factors[0], factors[1:]
    state.about = _about(payload[sums:], version) if version > 1 else {}
    return state


def _about(data, version):
    at = 0

    def take(layout):
        nonlocal at
        values = struct.unpack_from("<" + layout, data, at)
        at += struct.calcsize("<" + layout)
        return values if len(values) > 1 else values[0]

    def text():
        length = take("I")
        return take(f"{length}s").decode("utf-8", "replace") if length else ""

    about = {"vehicle": text(), "truck": text()}
    for name in ("start_ns", "record", "sequence"):
        about[name] = take("q" if name == "start_ns" else "Q")
    about["segments"], about["end_ns"], about["load"] = take("I"), take("q"), text()
    about["moving_mass_kg"] = take("d")
    for name, unit in (("rate", "Hz"), ("coulomb", "N"), ("stiffness", "N/m")):
        about[name] = Estimate(*take("2d"), unit)
    viscous, trust = take("2I")
    about["viscous"] = bool(viscous)
    about["trust"] = ("trusted", "model_incomplete", "data_faulty", "not_identified")[trust]
    about["alarms"] = text() if version > 2 else ""
    return about


def _check_frame(data, path):
    if data[:8] != b"DAMPLINE"[:max(len(data), 1)]:
        raise ValueError(f"{path}: is no dampline state")
    if len(data) < 44:
        raise ValueError(f"{path}: is cut off after {len(data)} bytes")
    version, kind, *sizes, _, length = struct.unpack_from("<2H3IQQ", data, 8)
    if version not in (1, 2, 3) or kind > min(version - 1, 1) or sizes != [_SCALES, _COLUMNS, _SEGMENTS]:
        raise ValueError(f"{path}: is of version {version} with sizes {sizes}, expected 1 to 3 and "
                         f"{[_SCALES, _COLUMNS, _SEGMENTS]}")
    if len(data) != 44 + length:
        raise ValueError(f"{path}: is cut off or has bytes too many: {len(data)}, expected {44 + length}")
    if _crc32c(data[:-4]) != struct.unpack_from("<I", data, len(data) - 4)[0]:
        raise ValueError(f"{path}: is damaged: its checksum does not fit")
    return version, kind == 1, data[40:-4]


def _crc32c(data):
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = (byte >> 1) ^ (0x82F63B78 if byte & 1 else 0)
        table.append(byte)
    crc = 0xFFFFFFFF
    for byte in data:
        crc = (crc >> 8) ^ table[(crc ^ byte) & 0xFF]
    return crc ^ 0xFFFFFFFF


def _factors(payload, offset, light):
    packed = np.frombuffer(payload, "<f4" if light else "<f8", _SCALES * _PACKED, offset)
    packed = packed.reshape(_SCALES, _PACKED)
    factor = np.zeros((_SCALES, _COLUMNS, _COLUMNS))
    row, column = np.triu_indices(_COLUMNS)
    factor[:, row, column] = packed
    rows = np.frombuffer(payload, "<f8", _SCALES, offset + packed.nbytes).copy()
    (blocks,) = struct.unpack_from("<I", payload, offset + packed.nbytes + rows.nbytes)
    return Factors(factor, rows, blocks)


_Fit = collections.namedtuple("_Fit", "theta inverse weight objective width")


def _unit(column):
    return np.eye(_COLUMNS)[column]


def _map(regressors):
    return np.column_stack(regressors + [_unit(_TARGET)])


def _corrected(value, std, factor, uncertain):
    """A value and its deviation times a factor; `uncertain`, of the value, is in the deviation then."""
    return factor * value, np.hypot(factor * std, uncertain * factor * value)


def _middle(viscous):
    return [_unit(_STIFFNESS)] + ([_unit(_VISCOUS)] if viscous else [])


def _neighbours(i):
    return max(i - 1, 0), min(i + 1, len(_WIDTHS_MPS) - 1)


def _weighted_fit(total, columns, scales):
    """Least squares over the scales, each weighted by the inverse of its own residual variance."""
    unknowns = columns.shape[1] - 1
    mapped = {s: total.factor[s] @ columns for s in scales if total.rows[s] >= 5 * unknowns}
    if not mapped:
        raise ValueError("too few rows in every scale")
    weight = {s: total.rows[s] / np.sum(m[:, -1] ** 2) for s, m in mapped.items()}
    for _ in range(5):
        stacked = np.vstack([np.sqrt(weight[s]) * m for s, m in mapped.items()])
        factor = np.linalg.qr(stacked, mode="r")
        upper = factor[:unknowns, :unknowns]
        theta = np.linalg.solve(upper, factor[:unknowns, -1])
        root = np.linalg.inv(upper)
        left = {s: np.sum((m[:, -1] - m[:, :-1] @ theta) ** 2) for s, m in mapped.items()}
        weight = {s: total.rows[s] / left[s] for s in mapped}
    objective = sum(total.rows[s] * np.log(left[s] / total.rows[s]) for s in mapped)
    return _Fit(theta, root @ root.T, weight, objective, None)


def _score_covariance(fit, entries, columns):
    scatter = np.zeros((len(fit.theta),) * 2)
    last = np.zeros(len(fit.theta))
    for entry in entries:
        score = np.zeros(len(fit.theta))
        for s, weight in fit.weight.items():
            mapped = entry.factor[s] @ columns
            score += weight * mapped[:, :-1].T @ (mapped[:, -1] - mapped[:, :-1] @ fit.theta)
        scatter += np.outer(score, score) + 0.5 * (np.outer(score, last) + np.outer(last, score))
        last = score
    return fit.inverse @ scatter @ fit.inverse
