#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the programs of bench/run wrote into FOLDER as one table: printed, and in table.md and
result.json there. `table.py FOLDER`; what is missing there is missing in the table, by name."""
import datetime
import json
import pathlib
import platform
import re
import shutil
import subprocess
import sys

from aims import SAME_ANSWER, aims


class Table:
    def __init__(self):
        self.rows = []

    def add(self, part, what, figure, beside=""):
        self.rows.append({"part": part, "what": what, "figure": figure, "beside": beside})

    def text(self):
        lines = ["| part | what | figure | beside it |", "|--|--|--|--|"]
        part = None
        for row in self.rows:
            shown = row["part"] if row["part"] != part else ""
            part = row["part"]
            lines.append(f"| {shown} | {row['what']} | {row['figure']} | {row['beside']} |")
        return "\n".join(lines) + "\n"


class Results:
    """What each program wrote; `missing` names what is not there."""

    def __init__(self, folder):
        self.folder = folder
        self.missing = []

    def json(self, name):
        path = self.folder / f"{name}.json"
        if not path.exists() or path.stat().st_size == 0:
            self.missing.append(name)
            return {}
        return json.loads(path.read_text())

    def log(self, name):
        path = self.folder / f"{name}.log"
        if path.exists():
            return path.read_text()
        self.missing.append(name)
        return ""


def machine():
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo", encoding="utf-8")
                if line.startswith("model name")), "unknown processor")
    gcc = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=False)
    return (f"{cpu}; {platform.system()} {platform.release()}; g++ {gcc.stdout.strip()}; "
            f"{datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d}")


def time_text(value, unit):
    for larger in ("us", "ms"):
        if value < 10_000:
            break
        value, unit = value / 1000, larger if unit == "ns" else "ms"
    return f"{value:.1f} {unit}" if value < 100 else f"{value:.0f} {unit}"


def benchmarks(table, part, results, name):
    """Processor times by name, ns."""
    out = {}
    scale = {"ns": 1.0, "us": 1e3, "ms": 1e6}
    for entry in results.json(name).get("benchmarks", []):
        ns = entry["cpu_time"] * scale[entry["time_unit"]]
        out[entry["name"]] = ns
        each = next((k for k in ("per_line", "per_frame", "per_row") if k in entry), None)
        table.add(part, entry["name"], time_text(1e9 * entry[each] if each else ns, "ns"),
                  each.replace("per_", "a ") if each else "")
    return out


def distribution(table, part, entries):
    for e in entries:
        quiet = (f"{e['heap_calls']} calls of the heap, {e['page_faults']} page faults"
                 if "heap_calls" in e else "")
        table.add(part, e["name"], " / ".join(str(e[q]) for q in
                                              ("p50", "p90", "p99", "p99.9", "max")), quiet)


def instructions(table, text):
    """Instructions of a sample by room: mean, and in the worst case."""
    part = "instructions a sample (valgrind)"
    mean = {room: float(count) for room, count in
            re.findall(r"^(\w+): ([\d.]+) instructions per sample,", text, re.M)}
    held = dict(re.findall(r"^(\w+): [\d.]+ instructions per sample, ([-+][\d.]+ %)", text, re.M))
    most = {room: int(count) for room, count in
               re.findall(r"^(\w+): \d+ instructions per sample in the mean, (\d+) in the worst", text, re.M)}
    for room, count in mean.items():
        worst = f"; worst case {most[room]:,}" if room in most else ""
        table.add(part, room, f"{count:,.0f}", f"{held[room]} of what is committed{worst}")
    if not mean:
        table.add(part, "", "not counted here", "needs valgrind and g++ 12")
    return mean, most


def least_squares(table, results):
    """ns a row by forgetting, name and unknowns; the largest difference from the batch solution
    of those who are held to it."""
    entries = (results.json("least_squares").get("least_squares", [])
               + results.json("numpy_least_squares").get("least_squares", []))
    ns, difference, held = {}, {}, {}
    for e in entries:
        race, name = e["forgetting"], e["name"]
        ns.setdefault(race, {}).setdefault(name, {})[e["unknowns"]] = e["ns_per_row"]
        difference[race, name] = max(difference.get((race, name), 0.0), e["difference"])
        held[race, name] = e["held"]
    for race, by_name in ns.items():
        past = "past rows weigh the same" if race == 1 else f"past rows fade by {race}"
        for name, by in by_name.items():
            apart = difference[race, name]
            note = ", single precision" if "eqrls" in name else (
                "" if apart < SAME_ANSWER else ": its errors grow")
            table.add(f"least squares, {past}, n = 8 / 16 / 32, ns a row", name,
                      " / ".join(f"{by[n]:.0f}" if n in by else "-" for n in (8, 16, 32)),
                      f"off the batch solution by {apart:.0e}{note}")
    return ns, max((d for key, d in difference.items() if held[key]), default=0.0)


def signals(table, results):
    part = "streaming, ns a sample"
    ours = results.json("signals")
    numpy = results.json("numpy_signals")
    ns = {}
    for e in ours.get("streaming", []) + numpy.get("streaming", []):
        ns[e["name"]] = e["ns_per_sample"]
        table.add(part, e["name"], f"{e['ns_per_sample']:.1f}")
    same = ours.get("histograms_agree", True) and numpy.get("largest_difference", 0.0) == 0.0
    table.add(part, "counts of all bins", "the same" if same else "NOT THE SAME",
              "GSL, NumPy" if numpy else "GSL")
    return ns


def robustness(table, entries):
    def text(o):
        error = "lost" if o["error_after"] is None else f"{o['error_after']:.1e}"
        after = o.get("not_a_number_after_s")
        return error if after is None else f"{error}, not a number after {after:.0f} s"

    for e in entries:
        hours = f"{e['hours']:.0f}" if e["hours"] >= 1 else f"{e['hours']}"
        part = f"error after {hours} h of running / 15 min / 8 h of standstill"
        table.add(part, e["name"], " / ".join(text(e[k]) for k in
                                              ("running", "standstill_900_s", "standstill_28800_s")),
                  f"after 5 min {e['running']['error_before']:.1e}")


def limits(table, limit, mean, ns):
    """What the core can do, and what of it the chain takes."""
    if not limit:
        return
    part = "limit of this core"
    table.add(part, "additions that wait for nothing",
              f"{limit['instructions_per_ns']:.1f} instructions a ns")
    if mean.get("chain") and ns.get("chain/densities"):
        table.add(part, "the chain with densities, of these",
                  f"{mean['chain'] / ns['chain/densities']:.1f} instructions a ns",
                  f"{mean['chain']:,.0f} instructions in {ns['chain/densities']:.0f} ns")
    table.add(part, "two doubles at a time, from registers", f"{limit['flops_per_ns']:.1f} flops a ns")
    for name in ("16_KiB", "256_MiB"):
        table.add(part, "read and written in " + name.replace("_", " "),
                  f"{limit['bytes_per_ns_' + name]:.1f} bytes a ns")


def scale(table, figures):
    """Times one truck, by trucks and samples of one in a row."""
    for e in figures.get("terms", []):
        square = (e["terms"] + 1) ** 2
        table.add("scale: a row of n unknowns", f"{e['rows']}, n = {e['terms']}",
                  f"{e['ns_per_row']:.0f} ns = {e['ns_per_row'] / square:.2f} ns (n + 1)^2",
                  f"{e['ns_per_row'] / e['least_ns']:.1f} times the least: {e['flops']:.0f} flops, "
                  f"{e['bytes']:.0f} bytes")
    for e in figures.get("trucks", []):
        misses = e["cache_misses_per_sample"]
        table.add("scale: trucks in one process, ns each",
                  f"{e['trucks']:,}, {e['mib']:.0f} MiB, {e['in_a_row']} of one in a row",
                  f"{e['ns_per_sample']:.0f}, {e['times_one']:.2f} times one",
                  "cache misses not counted here" if misses is None
                  else f"{misses:.1f} cache misses a sample")
    for e in figures.get("windows", []):
        table.add("scale: memory of the estimate, ns a sample", e["memory"],
                  f"{e['ns_per_sample']:.0f}")
    return {(e["trucks"], e["in_a_row"]): e["times_one"] for e in figures.get("trucks", [])}


def replay(table, entries):
    """Frames a second by name, of the longest file."""
    out = {}
    for e in entries:
        table.add("replay of a candump log, frames a second and core", e["name"],
                  f"{1e-6 * e['frames_per_s']:.2f} million",
                  f"{e['cpu_s']:.2f} s, {e['peak_mib']:.0f} MiB at most")
        out[e["name"].split(", ", 1)[1]] = e["frames_per_s"]
    return out


def other_processors(table, text):
    for cells in (line.strip("| ").split(" | ") for line in text.splitlines()
                  if re.match(r"\| (double|single) precision", line)):
        unit, level, flash, ram, stack, mean, most, same = cells
        table.add("Cortex-M7 in an emulator", f"{unit} unit, {level}",
                  f"{mean} instructions a sample, worst case {most}",
                  f"flash {flash}, RAM {ram}, stack {stack}; {same}")
    for figure in re.findall(r"^x86-64 without AVX2: (.*)$", text, re.M):
        table.add("x86-64 without AVX2, in an emulator", "beside the host", figure)
    for what, figure in re.findall(r"^64-bit Arm,? (.*): (.*)$", text, re.M):
        passed = re.search(r"PASSED *\] (.*)\.", figure)
        table.add("64-bit Arm in an emulator", what, passed[1] + " pass" if passed else figure)


def plot(folder):
    """The histogram of latency.csv as a picture."""
    if not (folder / "latency.csv").exists() or not shutil.which("gnuplot"):
        return
    rows = [line.split(",") for line in (folder / "latency.csv").read_text().splitlines()[1:]]
    script = ('set terminal svg size 900,420 background "white"\n'
              f'set output "{folder}/latency.svg"\nset logscale xy\nset grid\n'
              'set xlabel "time of one sample (ns)"\n'
              'set ylabel "samples in a sixteenth of an octave"\n')
    names = list(dict.fromkeys(row[0] for row in rows))
    for i, name in enumerate(names):
        script += f"$d{i} << EOD\n" + "".join(
            f"{row[1]} {row[3]}\n" for row in rows if row[0] == name) + "EOD\n"
    script += "plot " + ", ".join(f'$d{i} with histeps lw 2 title "{name}"'
                                  for i, name in enumerate(names)) + "\n"
    subprocess.run(["gnuplot"], input=script, text=True, check=False)


def main():
    folder = pathlib.Path(sys.argv[1])
    results = Results(folder)
    table = Table()
    figures = {"ns": benchmarks(table, "rooms and chain, a sample", results, "update")}
    benchmarks(table, "block ends and answers", results, "block_end")
    benchmarks(table, "decoding", results, "decode")
    figures["latency"] = results.json("latency").get("latency_ns", [])
    distribution(table, "latency: p50 / p90 / p99 / p99.9 / largest, ns", figures["latency"])
    distribution(table, "recvmmsg to result: the same, ns",
                 results.json("socket").get("socket_ns", []))
    figures["replay"] = replay(table, results.json("replay").get("replay", []))
    figures["mean"], figures["worst"] = instructions(table, results.log("instructions"))
    figures["rls"], figures["apart"] = least_squares(table, results)
    figures["streaming"] = signals(table, results)
    robustness(table, results.json("robustness").get("robustness", []))
    measured = results.json("scale")
    figures["trucks"] = scale(table, measured)
    limits(table, measured.get("limit"), figures["mean"], figures["ns"])
    other_processors(table, results.log("other_processors"))
    aims(table, figures)
    for name in results.missing:
        table.add("not measured here", name, "")
    plot(folder)
    text = f"{machine()}\n\n{table.text()}"
    print(text, end="")
    (folder / "table.md").write_text(text)
    parts = {path.stem: json.loads(path.read_text()) for path in sorted(folder.glob("*.json"))
             if path.name != "result.json"}
    (folder / "result.json").write_text(
        json.dumps({"machine": machine(), "table": table.rows, "parts": parts}, indent=1))
    print(f"written: {folder}/table.md, {folder}/result.json", file=sys.stderr)
    sys.exit(0 if figures["apart"] < SAME_ANSWER else 1)


main()
