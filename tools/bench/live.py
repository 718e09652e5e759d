#!/usr/bin/env python3
"""Beliefs between two processes in live mode, beside ddsperf with packets of the same size, the same settings of
Cyclone DDS and in turn with it.

And fleets in lockstep: how fast simulated time goes by, and how long a fleet takes to start and to end.

Usage: live.py LIVE_BENCH HEARSAY [SECONDS]     writes Markdown
"""
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

LOADS = {"gaussian": "a Gaussian, 4-D", "trajectory": "a trajectory, 20 states in 6-D", "grid": "a grid, 100 × 100 cells"}
GOAL = 0.5  # of ddsperf's throughput
REPETITIONS = 3
FLEETS = (5, 20)  # agents
START_GOAL_S = 5.0  # of the largest fleet
RING = """\
duration_s = 1
[world]
targets = [{ name = "alarm", position_m = [40.0, 25.0] }]
[radio]
topology = "ring"
rate_bps = 250_000
loss = { model = "bernoulli", probability = 0.1 }
[[agents]]
sensor = { kind = "position", period_s = 1.0, sigma_m = 5.0 }
estimator = { kind = "static-gaussian", fusion = "ci-det" }
talk = { policy = "periodic", period_s = 1.0 }
[record]
ledger = "off"
"""


def ours(bench, load, what, seconds):
    """(bytes, packets a second or median µs there and back)"""
    out = subprocess.run([bench, load, what, str(seconds)], check=True, capture_output=True, text=True).stdout.split()
    return int(out[0]), float(out[1])


def pair(environment, first, second, pattern):
    """What `first` measured, as the pattern finds it; both are ddsperf's, and end by themselves. On a busy machine
    they may miss each other."""
    for _ in range(5):
        found = re.findall(pattern, attempt(environment, first, second))
        if found:
            return [float(number) for number in found]
    sys.exit("ddsperf measured nothing, five times")


def attempt(environment, first, second):
    with subprocess.Popen(["ddsperf", *first], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True) as one:
        subprocess.run(["ddsperf", *second], env=environment, check=False, capture_output=True)
        return one.communicate()[0]


def ddsperf_rate(environment, size, seconds):
    """Packets a second: the median of the seconds that were full ones."""
    rates = pair(environment, ["-D", str(seconds + 1), "sub"], ["-D", str(seconds), "pub", "size", str(size)],
                 r"rate ([0-9.]+) kS/s")
    return 1e3 * statistics.median(rates[:seconds])


def ddsperf_us(environment, size, seconds):
    """Median of microseconds there and back, by threads that wait for what comes, as ours does."""
    return statistics.median(pair(environment, ["-D", str(seconds), "ping", "size", str(size), "waitset"],
                                  ["-D", str(seconds), "pong", "waitset"], r" 50% ([0-9.]+)us"))


def wall_s(hearsay, scenario, agents, duration_s, *mode):
    command = [hearsay, *mode, scenario, "--set", f"agents.count={agents}", "--set", f"duration_s={duration_s}",
               "--digest"]
    begin = time.monotonic()
    digest = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return time.monotonic() - begin, digest


def fleets(hearsay):
    print("\n## Fleets in lockstep\n")
    print("`hearsay live --lockstep` of a ring of agents that measure and talk once a second, beside `hearsay run` of "
          f"the same; medians of {REPETITIONS}. Start and end: a fleet that lives for a second of its time. Simulated "
          "seconds a second: of 500 more.\n")
    print("| processes | start and end [s] | goal | | simulated s a second | `hearsay run` | µs an agent and second |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        scenario = Path(scratch) / "ring.toml"
        scenario.write_text(RING)
        for agents in FLEETS:
            short, longer, alone = [], [], []
            for _ in range(REPETITIONS):
                short.append(wall_s(hearsay, scenario, agents, 1, "live", "--lockstep")[0])
                took_s, digest = wall_s(hearsay, scenario, agents, 501, "live", "--lockstep")
                longer.append(took_s)
                here_s, same = wall_s(hearsay, scenario, agents, 501, "run")
                alone.append(here_s)
                if digest != same:
                    sys.exit("the fleet's digest is not that of the run")
            start_s = statistics.median(short)
            lived_s = statistics.median(longer) - start_s
            judged = agents == max(FLEETS)
            goal = (f"< {START_GOAL_S:g}", "met" if start_s < START_GOAL_S else "**missed**") if judged else ("", "")
            print(f"| {agents} + 1 | {start_s:.2f} | {goal[0]} | {goal[1]} | {500 / lived_s:,.0f} | "
                  f"{501 / statistics.median(alone):,.0f} | {1e6 * lived_s / 500 / agents:,.0f} |")


def main():
    bench, hearsay = sys.argv[1:3]
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 3
    config = subprocess.run([bench, "config"], check=True, capture_output=True, text=True).stdout
    environment = {**os.environ, "CYCLONEDDS_URI": config.strip()}
    print("\n## Beliefs between processes\n")
    print("Live mode: packets from one process to another through a port, on the loopback interface, beside ddsperf "
          "with packets of the same size and the same settings of Cyclone DDS; medians of "
          f"{REPETITIONS} times {seconds} s, taken in turn. There and back: the median, beside ddsperf's waitset.\n")
    print("| packet | bytes | packets a second | ddsperf | ratio | goal | | there and back [µs] | ddsperf [µs] |")
    print("|---|---|---|---|---|---|---|---|---|")
    for load, meaning in LOADS.items():
        rates, trips, their_rates, their_trips = [], [], [], []
        for _ in range(REPETITIONS):
            size, rate = ours(bench, load, "throughput", seconds)
            rates.append(rate)
            their_rates.append(ddsperf_rate(environment, size, seconds))
            trips.append(ours(bench, load, "roundtrip", seconds)[1])
            their_trips.append(ddsperf_us(environment, size, seconds))
        rate, their_rate = statistics.median(rates), statistics.median(their_rates)
        ratio = rate / their_rate
        print(f"| {meaning} | {size:,} | {rate:,.0f} | {their_rate:,.0f} | {ratio:.2f} | ≥ {GOAL} | "
              f"{'met' if ratio >= GOAL else '**missed**'} | {statistics.median(trips):.0f} | "
              f"{statistics.median(their_trips):.0f} |")
    fleets(hearsay)


if __name__ == "__main__":
    main()
