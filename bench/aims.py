# SPDX-License-Identifier: MIT
"""What a sample was to cost, beside what one run of bench/run found."""

SAME_ANSWER = 1e-9
# What runs for days forgets, so the race with forgetting counts; the other one is told beside it.
FORGETTING = 0.9995
FORGETFUL = "dlib::rls, forgetting its prior too"


def least_squares_aims(aim, rls, chain_ns):
    def ns(forgetting, name, n):
        return rls.get(forgetting, {}).get(name, {}).get(n)

    def ratio(forgetting, name, n):
        ours, theirs = ns(forgetting, "dampline", n), ns(forgetting, name, n)
        return theirs / ours if ours and theirs else None

    def beside(theirs, reached, missed):
        """The same aim in the other races."""
        text = ""
        for who, figure in theirs:
            if figure is not None:
                text += f"; {who} {reached.format(figure)}" + (" (missed)" if missed(figure) else "")
        return text

    aim("its mean time, ns, beside dlib::rls with n = 16, forgetting", chain_ns,
        ns(FORGETTING, "dlib::rls", 16), note=beside(
            [("forgetting its prior too", ns(FORGETTING, FORGETFUL, 16)),
             ("without forgetting", ns(1.0, "dlib::rls", 16))], "{:,.0f}", lambda x: (chain_ns or 0.0) > x))
    for n, times in ((8, 10), (16, 8), (32, 5)):
        others = [("forgetting its prior too", ratio(FORGETTING, FORGETFUL, n)),
                  ("without forgetting", ratio(1.0, "dlib::rls", n))]
        aim(f"times as fast as dlib::rls, n = {n}, forgetting", ratio(FORGETTING, "dlib::rls", n),
            times, lambda x: f"{x:.1f}", True, beside(others, "{:.1f}", lambda x: x < times))
        name = "Eigen, covariance recursion"
        aim(f"times as fast as Eigen's covariance recursion, n = {n}, forgetting",
            ratio(FORGETTING, name, n), 1.0, lambda x: f"{x:.1f}", True,
            beside([("without forgetting", ratio(1.0, name, n))], "{:.1f}", lambda x: x < 1.0))


def replay_aims(aim, frames):
    """Of frames a second by name."""
    def times(ours, theirs):
        return frames[ours] / frames[theirs] if ours in frames and theirs in frames else None

    identify, parser = "dampline identify", "canplayer to a socket that takes all at once"
    aim("replay, million frames a second", 1e-6 * frames[identify] if identify in frames else None,
        2.0, lambda x: f"{x:.2f}", True)
    for what, ours, theirs, least in (
            ("replay, times canplayer to stdout", identify, "canplayer to stdout", 5.0),
            ("lines to frames alone, times canplayer's parsing alone",
             "dampline, lines to frames alone", parser, 5.0),
            ("lines to samples, times canplayer's parsing alone",
             "dampline, lines to samples alone", parser, 5.0),
            ("small job, times NumPy and SciPy", "small job, dampline's classes",
             "small job, NumPy and SciPy", 10.0),
            ("whole job, times NumPy and SciPy", identify, "whole job, NumPy and SciPy", 10.0)):
        aim(what, times(ours, theirs), least, lambda x: f"{x:.1f}", True)


def aims(table, f):
    """What was to be reached, from figures of this same run."""
    def aim(what, reached, bound, shown=None, least=False, note=""):
        if reached is None or bound is None:
            return table.add(what, "not measured here")
        met = reached >= bound if least else reached <= bound
        shown = shown or (lambda x: f"{x:,.0f}")
        table.add(what, shown(reached), ("met: " if met else "MISSED: ")
                  + ("at least " if least else "at most ") + shown(bound) + note)

    mean, worst, ns, rls, streaming = f["mean"], f["worst"], f["ns"], f["rls"], f["streaming"]
    aim("chain with densities, instructions a sample", mean.get("chain"), 4000)
    aim("its worst-case sample, instructions", worst.get("chain"), 60000)
    least_squares_aims(aim, rls, ns.get("chain/densities"))
    iir = streaming.get("motion: liquid iirfilt_rrrf, fourth order")
    aim("motion, ns an output, beside liquid's filter twice",
        streaming.get("motion: dampline, velocity and deflection (per output)"),
        None if iir is None else 2 * iir, lambda x: f"{x:.1f}")
    aim("a sample into a histogram, ns, beside GSL", streaming.get("histogram of 64: dampline"),
        streaming.get("histogram of 64: gsl_histogram_increment"), lambda x: f"{x:.1f}")
    aim("a sample into a joint histogram, ns, beside GSL",
        streaming.get("joint histogram of 32 x 32: dampline"),
        streaming.get("joint histogram of 32 x 32: gsl_histogram2d_increment"), lambda x: f"{x:.1f}")
    replay_aims(aim, f["replay"])
    for batch in (1, 8, 32):
        aim(f"10,000 trucks, {batch} of one in a row, times one", f["trucks"].get((10000, batch)),
            2.5, lambda x: f"{x:.2f}")
    latency = f["latency"]
    aim("calls of the heap and page faults after start-up",
        sum(e["heap_calls"] + e["page_faults"] for e in latency) if latency else None, 0)
    aim("answers beside the batch solution, dlib::rls among them, largest difference", f["apart"],
        SAME_ANSWER, lambda x: f"{x:.0e}")
