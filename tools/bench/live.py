#!/usr/bin/env python3
"""Beliefs between two processes in live mode, beside ddsperf with packets of the same size, the same settings of
Cyclone DDS and in turn with it.

Usage: live.py LIVE_BENCH [SECONDS]     writes Markdown
"""
import os
import re
import statistics
import subprocess
import sys

LOADS = {"gaussian": "a Gaussian, 4-D", "trajectory": "a trajectory, 20 states in 6-D", "grid": "a grid, 100 × 100 cells"}
GOAL = 0.5  # of ddsperf's throughput
REPETITIONS = 3


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


def main():
    bench = sys.argv[1]
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
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


if __name__ == "__main__":
    main()
