#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes what the programs of bench/run left in FOLDER into bench/RESULTS.md, one section a part.

results.py FOLDER PART...     the sections of these parts; the others stay as they are, each with the
                              commit and the machine that it names
"""
import datetime
import json
import os
import pathlib
import re
import subprocess
import sys

from aims import SAME_ANSWER, aims

RESULTS = pathlib.Path(__file__).with_name("RESULTS.md")
HEAD = """# Results

Written by `bench/run`; each section names the commit and the machine that it comes from. What each
program asks: [README.md](README.md). Times depend on what else a machine does: figures of one section
compare, those of two sections only where nothing else ran. Instructions do not depend on it.
"""
# Part and heading, in the order of the file. What has no function below is a program's own text.
PARTS = {
    "aims": "What a sample was to cost",
    "instructions": "Instructions a sample, counted by valgrind",
    "update": "Rooms and chain, a sample",
    "block_end": "Block ends and answers",
    "decode": "Decoding",
    "latency": "Times of single samples",
    "socket": "From recvmmsg to the result",
    "replay": "Replay of a candump log",
    "least_squares": "Least squares beside other libraries",
    "signals": "Filters and histograms beside other libraries",
    "robustness": "A day of running, hours of standstill",
    "scale": "Terms, trucks and memory",
    "trucks": "Trucks at 300 Hz in one process",
    "blackbox": "Recording",
    "other_processors": "Other processors, in emulators",
    "archive": "Archives of logs",
    "fleet": "A fleet of 10,000 cars for a year",
    "live": "Lateness of a live run",
    "accuracy": "Accuracy",
    "small_parts": "The estimate for small parts",
    "diagnosis": "Missing effects",
    "coverage": "Deviations of explained parameters",
    "noise": "Noise on the motion of a driven mass",
    "diagnosis_pairs": "Two missing effects at once",
    "unseen": "Trucks of any kind",
    "guards": "Faults",
    "field": "Faults on other trucks",
    "sensors": "Coarse, noisy, slow and unfiltered sensors",
    "places": "Sensors that sit elsewhere",
    "combinations": "Faults beside effects, faults and changed parameters",
    "drifting": "Parameters that change",
    "months": "The live alarm over months",
    "vehicle": "The reduction to one truck",
    "fokker_planck": "Fokker-Planck forms",
    "phase": "Phase mappings",
    "oscillators": "Oscillators from two accelerometers",
    "wavelet": "Wavelet-Galerkin rows",
}
# The aims are held against these once all are of one commit and machine; until then their section stays.
AIMED_AT = ("instructions", "update", "least_squares", "signals", "replay", "scale", "latency")


class Table:
    def __init__(self):
        self.rows = []

    def add(self, what, figure, beside=""):
        self.rows.append((what, figure, beside))

    def text(self):
        return "".join(f"| {' | '.join(row)} |\n" for row in
                       [("what", "figure", "beside it"), ("--", "--", "--"), *self.rows])


class Results:
    """What each program wrote; empty where it wrote nothing."""

    def __init__(self, folder):
        self.folder = folder

    def json(self, name):
        path = self.folder / f"{name}.json"
        return json.loads(path.read_text()) if path.exists() and path.stat().st_size else {}

    def log(self, name):
        path = self.folder / f"{name}.log"
        return path.read_text() if path.exists() else ""

    def origin(self, name):
        """Commit and machine of a part, as bench/run noted them when it ran it."""
        path = self.folder / f"{name}.origin"
        return path.read_text().strip() if path.exists() else ""

    def is_of_now(self, name):
        """Measured at this commit, on this machine."""
        return self.origin(name).rsplit(";", 1)[0] == origin().rsplit(";", 1)[0]


def time_text(value, unit):
    for larger in ("us", "ms"):
        if value < 10_000:
            break
        value, unit = value / 1000, larger if unit == "ns" else "ms"
    return f"{value:.1f} {unit}" if value < 100 else f"{value:.0f} {unit}"


def benchmarks(table, entries):
    """Processor times by name, ns."""
    out = {}
    scale = {"ns": 1.0, "us": 1e3, "ms": 1e6}
    for entry in entries:
        ns = entry["cpu_time"] * scale[entry["time_unit"]]
        out[entry["name"]] = ns
        each = next((k for k in ("per_line", "per_frame", "per_row") if k in entry), None)
        table.add(entry["name"], time_text(1e9 * entry[each] if each else ns, "ns"),
                  each.replace("per_", "a ") if each else "")
    return out


def distribution(table, entries):
    table.add("p50 / p90 / p99 / p99.9 / largest", "ns")
    for e in entries:
        quiet = (f"{e['heap_calls']} calls of the heap, {e['page_faults']} page faults"
                 if "heap_calls" in e else "")
        table.add(e["name"], " / ".join(str(e[q]) for q in
                                        ("p50", "p90", "p99", "p99.9", "max")), quiet)


def instructions(table, text):
    """Instructions of a sample by room: mean, and in the worst case."""
    mean = {room: float(count) for room, count in
            re.findall(r"^(\w+): ([\d.]+) instructions per sample,", text, re.M)}
    held = dict(re.findall(r"^(\w+): [\d.]+ instructions per sample, ([-+][\d.]+ %)", text, re.M))
    most = {room: int(count) for room, count in
               re.findall(r"^(\w+): \d+ instructions per sample in the mean, (\d+) in the worst", text, re.M)}
    for room, count in mean.items():
        worst = f"; worst case {most[room]:,}" if room in most else ""
        table.add(room, f"{count:,.0f}", f"{held[room]} of what is committed{worst}")
    for verb, figures in re.findall(r"^(program_\w+): (decode .*|[-\d.]+ million .*)$", text, re.M):
        table.add(verb, "of which", figures)
    if not mean:
        table.add("", "not counted here", "needs valgrind and g++ 12")
    return mean, most


def least_squares(table, results):
    """ns a row by forgetting, name and unknowns; the largest difference from the batch solution
    of those who are held to it."""
    entries = (results.json("least_squares").get("least_squares", [])
               + results.json("numpy_least_squares").get("least_squares", []))
    table.add("n = 8 / 16 / 32", "ns a row")
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
            table.add(f"{name}; {past}",
                      " / ".join(f"{by[n]:.0f}" if n in by else "-" for n in (8, 16, 32)),
                      f"off the batch solution by {apart:.0e}{note}")
    return ns, max((d for key, d in difference.items() if held[key]), default=0.0)


def signals(table, results):
    table.add("", "ns a sample")
    ours = results.json("signals")
    numpy = results.json("numpy_signals")
    ns = {}
    for e in ours.get("streaming", []) + numpy.get("streaming", []):
        ns[e["name"]] = e["ns_per_sample"]
        table.add(e["name"], f"{e['ns_per_sample']:.1f}")
    same = ours.get("histograms_agree", True) and numpy.get("largest_difference", 0.0) == 0.0
    table.add("counts of all bins", "the same" if same else "NOT THE SAME",
              "GSL, NumPy" if numpy else "GSL")
    return ns


def limits(table, limit, mean, ns):
    """What the core can do, and what of it the chain takes."""
    if not limit:
        return
    table.add("additions that wait for nothing",
              f"{limit['instructions_per_ns']:.1f} instructions a ns")
    if mean.get("chain") and ns.get("chain/densities"):
        table.add("the chain with densities, of these",
                  f"{mean['chain'] / ns['chain/densities']:.1f} instructions a ns",
                  f"{mean['chain']:,.0f} instructions in {ns['chain/densities']:.0f} ns")
    table.add("two doubles at a time, from registers", f"{limit['flops_per_ns']:.1f} flops a ns")
    for name in ("16_KiB", "256_MiB"):
        table.add("read and written in " + name.replace("_", " "),
                  f"{limit['bytes_per_ns_' + name]:.1f} bytes a ns")


def scale(table, figures):
    """Times one truck, by trucks and samples of one in a row."""
    for e in figures.get("terms", []):
        square = (e["terms"] + 1) ** 2
        table.add(f"a row of n unknowns, {e['rows']}, n = {e['terms']}",
                  f"{e['ns_per_row']:.0f} ns = {e['ns_per_row'] / square:.2f} ns (n + 1)^2",
                  f"{e['ns_per_row'] / e['least_ns']:.1f} times the least: {e['flops']:.0f} flops, "
                  f"{e['bytes']:.0f} bytes")
    for e in figures.get("trucks", []):
        misses = e["cache_misses_per_sample"]
        table.add(f"{e['trucks']:,} trucks, {e['mib']:.0f} MiB, {e['in_a_row']} of one in a row",
                  f"{e['ns_per_sample']:.0f} ns each, {e['times_one']:.2f} times one",
                  "cache misses not counted here" if misses is None
                  else f"{misses:.1f} cache misses a sample")
    for e in figures.get("windows", []):
        table.add(f"memory of the estimate: {e['memory']}", f"{e['ns_per_sample']:.0f} ns a sample")
    return {(e["trucks"], e["in_a_row"]): e["times_one"] for e in figures.get("trucks", [])}


def replay(table, entries):
    """Frames a second by name, of the longest file."""
    out = {}
    for e in entries:
        table.add(e["name"], f"{1e-6 * e['frames_per_s']:.2f} million frames a second and core",
                  f"{e['cpu_s']:.2f} s, {e['peak_mib']:.0f} MiB at most")
        out[e["name"].split(", ", 1)[1]] = e["frames_per_s"]
    return out


def other_processors(table, text):
    for cells in (line.strip("| ").split(" | ") for line in text.splitlines()
                  if re.match(r"\| (double|single) precision", line)):
        unit, level, flash, ram, stack, mean, most, same = cells
        table.add(f"Cortex-M7, {unit}, {level}",
                  f"{mean} instructions a sample, worst case {most}",
                  f"flash {flash}, RAM {ram}, stack {stack}; {same}")
    for example, figure in re.findall(r"^examples/(\S+): (.*)$", text, re.M):
        table.add(f"examples/{example}", figure)
    for figure in re.findall(r"^x86-64 without AVX2: (.*)$", text, re.M):
        table.add("x86-64 without AVX2, beside the host", figure)
    for what, figure in re.findall(r"^64-bit Arm,? (.*): (.*)$", text, re.M):
        passed = re.search(r"PASSED *\] (.*)\.", figure)
        table.add(f"64-bit Arm, {what}", passed[1] + " pass" if passed else figure)


def machine():
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo", encoding="utf-8")
                if line.startswith("model name")), "unknown processor")
    gcc = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=False)
    return f"{cpu}, {os.cpu_count()} processors, {os.uname().sysname} {os.uname().release}, g++ " \
        f"{gcc.stdout.strip()}"


def commit():
    def git(*command):
        return subprocess.run(["git", *command], capture_output=True, text=True,
                              check=False).stdout.strip()
    changed = git("status", "--porcelain", "--", ".", ":!bench/RESULTS.md")
    return (git("rev-parse", "--short=12", "HEAD") or "unknown") + (" with changes" if changed else "")


def origin():
    return f"Commit {commit()}; {machine()}; {datetime.date.today()}"


def own_text(text):
    """A program's own output: tables as they are, whatever else as it stands."""
    text = re.sub(r"^#+ ", "**", text.strip(), flags=re.M)
    return (text if "|--" in text else f"```\n{text}\n```") + "\n"


def figures_of(results, tables):
    """Fills `tables` and returns what the aims need."""
    def table(part):
        return tables.setdefault(part, Table())

    def of_now(part, figure):
        return figure if results.is_of_now(part) else type(figure)()

    ns = {part: benchmarks(table(part), results.json(part).get("benchmarks", []))
          for part in ("update", "block_end", "decode", "blackbox", "wavelet")}
    latency = results.json("latency").get("latency_ns", [])
    distribution(table("latency"), latency)
    distribution(table("socket"), results.json("socket").get("socket_ns", []))
    speeds = replay(table("replay"), results.json("replay").get("replay", []))
    mean, worst = instructions(table("instructions"), results.log("instructions"))
    rls, apart = least_squares(table("least_squares"), results)
    streaming = signals(table("signals"), results)
    measured = results.json("scale")
    trucks = scale(table("scale"), measured)
    limits(table("scale"), measured.get("limit"), of_now("instructions", mean),
           of_now("update", ns["update"]))
    other_processors(table("other_processors"), results.log("other_processors"))
    return {"mean": mean, "worst": worst, "ns": ns["update"], "rls": rls,
            "apart": apart if results.is_of_now("least_squares") else None,
            "streaming": streaming, "replay": speeds, "trucks": trucks, "latency": latency}


def sections_of(text):
    """Part and text of each section of RESULTS.md."""
    by_heading = {heading: part for part, heading in PARTS.items()}
    pieces = re.split(r"^## (.*)\n", text, flags=re.M)
    return {by_heading[heading]: body.strip() + "\n"
            for heading, body in zip(pieces[1::2], pieces[2::2]) if heading in by_heading}


def write(sections):
    text = HEAD + "".join(f"\n## {heading}\n\n{sections[part]}" for part, heading in PARTS.items()
                          if part in sections)
    RESULTS.write_text(text)


def main():
    if sys.argv[1:] == ["--origin"]:
        print(origin())
        return
    folder = pathlib.Path(sys.argv[1])
    results = Results(folder)
    tables = {}
    figures = figures_of(results, tables)
    parts = sys.argv[2:]
    if any(part in AIMED_AT for part in parts) and all(map(results.is_of_now, AIMED_AT)):
        tables["aims"] = Table()
        aims(tables["aims"], figures)
        parts.append("aims")
    sections = sections_of(RESULTS.read_text() if RESULTS.exists() else "")
    for part in parts:
        body = tables[part].text() if part in tables else own_text(results.log(part))
        sections[part] = f"{origin() if part == 'aims' else results.origin(part)}\n\n{body}"
        print(f"## {PARTS[part]}\n\n{sections[part]}")
    write(sections)
    print(f"written: {RESULTS}", file=sys.stderr)
    sys.exit(1 if (figures["apart"] or 0.0) >= SAME_ANSWER else 0)


main()
