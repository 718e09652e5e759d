#!/usr/bin/env python3
"""Google Benchmark's JSON files as one table: a row a workload, ours beside its floor."""
import json
import platform
import statistics
import subprocess
import sys


def processor():
    with open("/proc/cpuinfo") as info:
        for line in info:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.machine()


def rate(benchmark):
    """Things a second, from the counter that has a rate; None if there is none."""
    for name in ("items_per_second", "deliveries_per_s", "rows/s"):
        if name in benchmark:
            return benchmark[name]
    return None


def order(workload):
    """By kind, then by size."""
    kind, _, size = workload.partition("/")
    kinds = ["hold", "whole_seconds", "timeouts", "process", "beacon", "log"]
    return kinds.index(kind) if kind in kinds else len(kinds), int(size) if size.isdigit() else 0


def main():
    rates = {}
    for file in sys.argv[1:]:
        with open(file) as text:
            for benchmark in json.load(text)["benchmarks"]:
                value = rate(benchmark)
                if benchmark.get("run_type") != "iteration" or value is None:
                    continue
                name = benchmark["run_name"].removesuffix("/real_time")
                side, _, workload = name.partition("/")
                rates.setdefault(workload, {}).setdefault(side, []).append(value)
    compiler = subprocess.run(["g++", "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    print("# Benchmarks\n")
    print(f"{processor()}, {compiler}, release build. Median of five interleaved repetitions, in millions "
          "a second (events, wake-ups, deliveries, rows) of CPU time (log: of wall time); the ratio "
          "is ours to a floor made of plain arrays in the same binary and run. Written by `tools/bench/run`.\n")
    print("| workload | floor | ours | ratio |")
    print("|---|---|---|---|")
    for workload, sides in sorted(rates.items(), key=lambda item: order(item[0])):
        ours = statistics.median(sides["ours"]) if "ours" in sides else None
        floor = statistics.median(sides["floor"]) if "floor" in sides else None
        show = lambda value: "" if value is None else f"{value / 1e6:.2f}"
        ratio = f"{ours / floor:.2f}" if ours and floor else ""
        print(f"| {workload} | {show(floor)} | {show(ours)} | {ratio} |")


if __name__ == "__main__":
    main()
