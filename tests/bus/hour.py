# SPDX-License-Identifier: MIT
"""Inside the machine of tests/bus/hour: Prometheus and node_exporter scrape a live run.

hour.py DAMPLINE BUS SECONDS
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import urllib.parse
import urllib.request

DAMPLINE, BUS, SECONDS = sys.argv[1], sys.argv[2], int(sys.argv[3])
EVERY_S = 5
LEVEL_N = 8356.0  # laden car: what the simulated friction comes to

CONFIG = f"""
global: {{scrape_interval: {EVERY_S}s, scrape_timeout: {EVERY_S}s}}
scrape_configs:
- {{job_name: live, static_configs: [{{targets: ['127.0.0.1:9464']}}]}}
- {{job_name: file, static_configs: [{{targets: ['127.0.0.1:9100']}}]}}
"""


def get(port, path):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/{path}", timeout=60) as answer:
        return answer.read().decode()


def query(expression):
    """Value by job and the labels beside it."""
    found = json.loads(get(9090, "api/v1/query?query=" + urllib.parse.quote(expression)))
    assert found["status"] == "success", found
    return [(r["metric"], float(r["value"][1])) for r in found["data"]["result"]]


def one(expression):
    found = query(expression)
    assert len(found) == 1, (expression, found)
    return found[0][1]


def wait_for(port, path):
    for _ in range(600):
        try:
            return get(port, path)
        except OSError:
            time.sleep(0.1)
    raise AssertionError(f"port {port} does not answer")


def check_metrics(text):
    done = subprocess.run(["promtool", "check", "metrics"], input=text, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", ""), done


def start_all(folder):
    (folder / "prometheus.yml").write_text(CONFIG)
    (folder / "texts").mkdir()
    commands = {
        "live": [DAMPLINE, "identify", BUS, "--out", folder / "run", "--no-report", "--quiet", "--serve",
                 "127.0.0.1:9464", "--prom-file", folder / "texts" / "dampline.prom"],
        "node_exporter": ["prometheus-node-exporter", "--collector.disable-defaults", "--collector.textfile",
                          f"--collector.textfile.directory={folder / 'texts'}",
                          "--web.listen-address=127.0.0.1:9100"],
        "prometheus": ["prometheus", f"--config.file={folder / 'prometheus.yml'}",
                       f"--storage.tsdb.path={folder / 'tsdb'}", "--web.listen-address=127.0.0.1:9090"],
        "simulate": ["chrt", "--fifo", "60", DAMPLINE, "simulate", "--to", BUS, "--duration", str(SECONDS), "--batch",
                     "10", "--quiet"],
    }
    running = {}
    for name, command in commands.items():
        with open(folder / f"{name}.log", "w") as log:
            running[name] = subprocess.Popen(command, stdout=log, stderr=log)
        if name != "simulate":
            wait_for({"live": 9464, "node_exporter": 9100, "prometheus": 9090}[name], "metrics")
    return running


def check_history():
    """What Prometheus remembers of the whole run, from both ways."""
    span = f"[{SECONDS}s]"
    for job in ("live", "file"):
        scrapes = one(f'count_over_time(up{{job="{job}"}}{span})')
        answered = one(f'sum_over_time(up{{job="{job}"}}{span})')
        print(f"{job}: {scrapes:.0f} scrapes, {answered:.0f} answered")
        assert answered == scrapes >= SECONDS / EVERY_S - 3
        assert one(f'resets(dampline_frames_total{{job="{job}",result="processed"}}{span})') == 0
        level = one(f'dampline_parameter{{job="{job}",name="coulomb",unit="N"}}')
        std = one(f'dampline_parameter_std{{job="{job}",name="coulomb"}}')
        frames = one(f'dampline_frames_total{{job="{job}",result="processed"}}')
        late_s = one(f'histogram_quantile(0.999, rate(dampline_lateness_seconds_bucket{{job="{job}"}}{span}))')
        print(f"{job}: coulomb {level:.0f} +- {std:.0f} N, {frames:.0f} frames, lateness p99.9 {1e6 * late_s:.0f} us")
        assert abs(level - LEVEL_N) < 0.004 * LEVEL_N, level
        assert frames >= 900 * (SECONDS - 20), frames
        assert one(f'dampline_cycle_slips_total{{job="{job}"}}') == 0
        assert one(f'dampline_trust{{job="{job}",trust="trusted"}}') == 1
    assert one('max_over_time(dampline_http_streams[1m])') == 0
    oldest_s = one(f'max_over_time(dampline_explanation_age_seconds{{job="live"}}{span})')
    print(f"explanation: at most {oldest_s:.1f} s old")
    assert oldest_s <= 10.0, oldest_s
    assert one('sum(node_textfile_scrape_error)') == 0
    pages = query('sum by (job) (dampline_page_faults_total)')
    assert len(pages) == 2 and all(faults == 0 for _, faults in pages), pages


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        running = {}
        try:
            running = start_all(folder)
            start = time.monotonic()
            while running["simulate"].poll() is None:
                time.sleep(SECONDS / 12)
                for port in (9464, 9100):  # 9100: what node_exporter makes of the file, its own beside it
                    check_metrics(get(port, "metrics"))
                assert all(running[name].poll() is None for name in ("live", "node_exporter", "prometheus"))
            assert running["simulate"].wait() == 0
            print(f"{time.monotonic() - start:.0f} s of the machine's time")
            time.sleep(2 * EVERY_S)
            check_history()
        except BaseException:
            for log in folder.glob("*.log"):
                print(f"--- {log.name}\n{log.read_text()[-2000:]}", file=sys.stderr)
            raise
        finally:
            for child in reversed(running.values()):
                child.terminate()
            codes = {name: child.wait(timeout=600) for name, child in running.items()}
        assert codes["live"] == codes["prometheus"] == 0, codes


main()
