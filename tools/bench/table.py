#!/usr/bin/env python3
"""Google Benchmark's JSON files as tables: a row a workload, ours beside its floor and the goal; then
what has a goal in microseconds, and how the cost of trajectories grows with their length."""
import json
import math
import platform
import statistics
import subprocess
import sys

# Ratio to the floor that a workload must reach; None: kept for comparison.
GOALS = {
    "hold/1000": 1.2, "hold/100000": 1.0, "hold/1000000": 1.5,
    "whole_seconds/1000": None, "whole_seconds/100000": 0.9, "whole_seconds/1000000": None,
    "timeouts/1000": None, "timeouts/100000": 0.35, "timeouts/1000000": None,
    "bimodal/1000": None, "bimodal/100000": None, "bimodal/1000000": None,
    "process/10000": 1.2,
    "beacon/100": 1.2, "beacon/1000": 1.2, "beacon/10000": 1.2,
    "moving/100": None, "moving/1000": None, "moving/10000": None, "moving/100000": 0.5,
    "fading/100": None, "fading/1000": None, "fading/10000": None,
    "sensing/100": None, "sensing/1000": None, "sensing/10000": None,
    "fuse/4": 3.0, "fuse/6": None,
    "add/20": None, "add/100": None, "add/1000": None,
    "weigh/20": None, "weigh/100": None, "weigh/1000": None,
    "means/20": None, "means/100": None, "means/1000": None,
    "intersect/20": None, "intersect/100": None, "intersect/1000": None,
    "fuse_grid/100": None, "fuse_grid/1000": 0.5, "fuse_grid_channel/1000": None,
    "camera/400": None, "camera/6400": None, "camera/102400": None, "camera_grid/64": None, "camera_grid/4096": None,
    "scan/6": None, "scan/12": None, "advance/6": None,
    "alive/1000": None, "alive/10000": None, "alive/100000": None,
    "reach/10": None, "reach/100": None, "reach/1000": None, "merge/1024": None,
    "log": 1.0,
}
# Measured against another workload's floor: what a time-out an event costs beside none at all.
FLOOR_OF = {"intersect": "means", "timeouts": "hold", "moving": "beacon", "fading": "beacon", "sensing": "beacon",
            "fuse_grid_channel": "fuse_grid"}
# Microseconds a call must stay below.
BELOW_US = {"fuse/4": 1.0, "fuse/6": 2.0, "add/20": 5.0, "weigh/20": 5.0, "means/20": 30.0, "intersect/20": 100.0,
            "scan/6": 20.0, "scan/12": 20.0}
# Exponents of time against steps, 20 to 1000: 1 within this.
GROWS = ("add", "weigh", "means", "intersect")
EXPONENT_WITHIN = 0.1
# How the cost of a look for a crumb may grow: sizes, of what, and the exponent it stays below. It does not depend on
# how many are alive, but for caches.
LOOKS = {"alive": ((1000, 10000, 100000), "alive, ten in reach", 0.15),
         "reach": ((10, 100, 1000), "in reach, 10,000 alive", 1.25)}
COUNTERS = {"bytes_per_process": "bytes a process", "bytes_per_agent": "bytes an agent", "bytes/row": "bytes a row",
            "in_reach": "in reach",
            "allocations": "allocations a call"}
RATES = ("items_per_second", "deliveries_per_s", "rows/s")


def processor():
    with open("/proc/cpuinfo") as info:
        for line in info:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.machine()


def workload_of(benchmark):
    """("floor" or "ours", workload), without what Google Benchmark appends to a name."""
    side, _, rest = benchmark["run_name"].partition("/")
    parts = [p for p in rest.split("/") if p != "real_time" and not p.startswith("iterations:")]
    return side, "/".join(parts[:2])


def collect(files):
    """{workload: {side: [things a second]}} and {workload: {counter: value}} of ours."""
    rates, counters = {}, {}
    for file in files:
        with open(file) as text:
            for benchmark in json.load(text)["benchmarks"]:
                rate = next((benchmark[name] for name in RATES if name in benchmark), None)
                if benchmark.get("error_occurred"):
                    sys.exit(f"{benchmark['run_name']}: {benchmark['error_message']}")
                if benchmark.get("run_type") != "iteration" or rate is None:
                    continue
                side, workload = workload_of(benchmark)
                rates.setdefault(workload, {}).setdefault(side, []).append(rate)
                for name in COUNTERS:
                    if name in benchmark:
                        counters.setdefault(workload, {})[name] = benchmark[name]
    return rates, counters


def exponent(sizes, times):
    """Slope of log time on log size by least squares."""
    x, y = ([math.log(v) for v in values] for values in (sizes, times))
    mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
    return (sum((u - mean_x) * (v - mean_y) for u, v in zip(x, y))
            / sum((u - mean_x) ** 2 for u in x))


def verdict(met):
    return "met" if met else "**missed**"


def print_times(rates):
    """What has a goal in microseconds, and exponents."""
    us = {workload: 1e6 / statistics.median(sides["ours"]) for workload, sides in rates.items() if "ours" in sides}
    print("\n## Fusion, trajectories and scans\n")
    print("CPU time of a call, from the same measurements. A trajectory is 6-D, a scan 180 rays.\n")
    print("| workload | ours [µs] | goal [µs] | |")
    print("|---|---|---|---|")
    for workload, goal in BELOW_US.items():
        print(f"| {workload} | {us[workload]:.2f} | < {goal:g} | {verdict(us[workload] < goal)} |")
    print("\n| trajectories of | 20 steps [µs] | 100 [µs] | 1000 [µs] | exponent | goal | |")
    print("|---|---|---|---|---|---|---|")
    sizes = (20, 100, 1000)
    for kind in GROWS:
        times = [us[f"{kind}/{size}"] for size in sizes]
        slope = exponent(sizes, times)
        print(f"| {kind} | " + " | ".join(f"{t:.2f}" for t in times)
              + f" | {slope:.3f} | 1 ± {EXPONENT_WITHIN} | {verdict(abs(slope - 1.0) <= EXPONENT_WITHIN)} |")
    print_looks(us)


def print_looks(us):
    """How a look for the crumb to follow grows with those alive and those in reach."""
    print("\n## A look for the crumb to follow\n")
    print("| crumbs | | | | exponent | goal | |")
    print("|---|---|---|---|---|---|---|")
    for kind, (sizes, what, goal) in LOOKS.items():
        times = [us[f"{kind}/{size}"] for size in sizes]
        slope = exponent(sizes, times)
        print(f"| {what} | " + " | ".join(f"{size}: {t:.2f} µs" for size, t in zip(sizes, times))
              + f" | {slope:.3f} | < {goal} | {verdict(slope < goal)} |")


def main():
    rates, counters = collect(sys.argv[1:])
    compiler = subprocess.run(["g++", "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    print("# Benchmarks\n")
    print(f"{processor()}, {compiler}, release build. Median of five interleaved repetitions, in millions "
          "a second (events, wake-ups, deliveries, fusions, trajectories, bytes of grids, cells in view, scans, moves, looks, crumbs, rows) of CPU time (log: of wall time). The "
          "ratio is ours to a floor in the same binary and run: plain arrays and std::priority_queue, "
          "dynamic-size Eigen (fuse), memcpy (fuse_grid), projections alone (camera), all walls (scan, advance), all crumbs (alive), bare prepared inserts (log). Written by `tools/bench/run`.\n")
    print("| workload | floor | ours | ratio | goal | |")
    print("|---|---|---|---|---|---|")
    for workload in GOALS:
        if workload not in rates:
            sys.exit(f"{workload} was not measured")
        kind, _, size = workload.partition("/")
        floor = statistics.median(rates["/".join(filter(None, (FLOOR_OF.get(kind, kind), size)))]["floor"])
        ours = statistics.median(rates[workload]["ours"])
        goal = "" if GOALS[workload] is None else f"{GOALS[workload]:.2f}"
        notes = ", ".join(f"{value:.0f} {COUNTERS[name]}" for name, value in counters.get(workload, {}).items())
        print(f"| {workload} | {floor / 1e6:.2f} | {ours / 1e6:.2f} | {ours / floor:.2f} | {goal} | {notes} |")
    missing = sorted(name for name, sides in rates.items() if "ours" in sides and name not in GOALS)
    if missing:
        sys.exit(f"no goal is known for {', '.join(missing)}")
    print("\nworkloads: `hold` takes one of N pending events and schedules another an exponential time later; "
          "`whole_seconds` rounds those times; `bimodal` mixes microseconds with minutes; `timeouts` also "
          "schedules and takes back a time-out for each event, and is compared with the floor of plain "
          "`hold`; `process` wakes sleeping coroutines; `beacon` is a broadcast a second of each of N "
          "radios, ten in range of each; `moving`, `fading` and `sensing` are the same with one thing "
          "added, beside the same floor, which does without: Gauss-Markov motion at 10 m/s, log-distance "
          "with shadowing where every reception is drawn from its SNR, carrier sense with back-off and "
          "collisions (60 s each, 100,000 moving radios for 10 s; what those hold is within 2 GiB, or "
          "nothing is written); `fuse` is covariance intersection with optimal ω in 4-D and 6-D; `add`, `weigh`, `means` "
          "and `intersect` are trajectories of 20, 100 and 1000 steps in 6-D: one added to another, the two "
          "weighted by a fixed ω, all means, and intersection of minimum determinant, beside the floor of "
          "means (fusion and trajectories that allocate once warm are refused); `fuse_grid` fuses certainty grids of "
          "100×100 and 1000×1000 cells, in bytes read and written, and `fuse_grid_channel` takes off a third grid; "
          "`camera` updates a grid of 4096×4096 cells by an image in which 400 to 102,400 of them are in view, and "
          "`camera_grid` grids of 64×64 and 4096×4096 with 1600 in view; "
          "`scan` is 180 rays of up to 10 m on a floor of 60×30 m with 6×6 or 12×12 rooms, beside each ray tried on "
          "all walls, `advance` a short move of a disc there, beside its distance to all walls; `alive` looks for the "
          "crumb to follow with about ten in reach and N alive, beside a loop over all, `reach` with about N in "
          "reach and 10,000 alive, beside a loop over N, and `merge` tells a full store news, beside a copy (looks and "
          "merges that allocate are refused); `log` writes "
          "rows into SQLite.")
    print_times(rates)


if __name__ == "__main__":
    main()
