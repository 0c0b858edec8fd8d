# SPDX-License-Identifier: MIT
"""What a sample was to cost, beside what one run of bench/run found."""

SAME_ANSWER = 1e-9


def aims(table, f):
    """What was to be reached, from figures of this same run."""
    def aim(what, reached, bound, shown=None, least=False):
        if reached is None or bound is None:
            return table.add("aims", what, "not measured here")
        met = reached >= bound if least else reached <= bound
        shown = shown or (lambda x: f"{x:,.0f}")
        table.add("aims", what, shown(reached), ("met: " if met else "MISSED: ")
                  + ("at least " if least else "at most ") + shown(bound))

    mean, dearest, ns, rls, streaming = f["mean"], f["dearest"], f["ns"], f["rls"], f["streaming"]
    ours, dlib = rls.get("dampline", {}), rls.get("dlib::rls", {})
    eigen = rls.get("Eigen, covariance recursion", {})
    aim("chain with densities, instructions a sample", mean.get("chain"), 4000)
    aim("its dearest sample, instructions", dearest.get("chain"), 60000)
    aim("its mean time, ns, beside dlib::rls with n = 16", ns.get("chain/densities"), dlib.get(16))
    for n, times in ((8, 10), (16, 8), (32, 5)):
        ratio = dlib[n] / ours[n] if n in ours and n in dlib else None
        aim(f"times as fast as dlib::rls, n = {n}", ratio, times, lambda x: f"{x:.1f}", True)
        aim(f"ns a row beside Eigen's covariance recursion, n = {n}", ours.get(n), eigen.get(n))
    iir = streaming.get("motion: liquid iirfilt_rrrf, fourth order")
    aim("motion, ns an output, beside liquid's filter twice",
        streaming.get("motion: dampline, velocity and deflection (per output)"),
        None if iir is None else 2 * iir, lambda x: f"{x:.1f}")
    aim("a sample into a histogram, ns, beside GSL", streaming.get("histogram of 64: dampline"),
        streaming.get("histogram of 64: gsl_histogram_increment"), lambda x: f"{x:.1f}")
    aim("a sample into a joint histogram, ns, beside GSL",
        streaming.get("joint histogram of 32 x 32: dampline"),
        streaming.get("joint histogram of 32 x 32: gsl_histogram2d_increment"), lambda x: f"{x:.1f}")
    frames = f["replay"].get("dampline identify")
    canplayer = f["replay"].get("canplayer to stdout")
    numpy = f["replay"].get("NumPy and SciPy")
    aim("replay, million frames a second", frames and 1e-6 * frames, 2.0, lambda x: f"{x:.2f}", True)
    aim("replay, times canplayer, which only parses",
        frames / canplayer if frames and canplayer else None, 5.0, lambda x: f"{x:.2f}", True)
    aim("replay, times NumPy and SciPy", frames / numpy if frames and numpy else None, 10.0,
        lambda x: f"{x:.1f}", True)
    aim("10,000 trucks, times one", f["trucks"].get(10000), 2.5, lambda x: f"{x:.2f}")
    latency = f["latency"]
    aim("calls of the heap and page faults after start-up",
        sum(e["heap_calls"] + e["page_faults"] for e in latency) if latency else None, 0)
    aim("answers beside peers in double precision, largest difference", f["apart"], SAME_ANSWER,
        lambda x: f"{x:.0e}")
