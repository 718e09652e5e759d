#!/usr/bin/env python3
"""Whole runs: how fast the rumour study is swept, fleets that follow moving targets and survey an area, robots
that go by trails, how CPU time grows with agents and simulated time, and memory with simulated time.

Usage: scaling.py HEARSAY [--hour]     writes Markdown; --hour adds an hour of 10,000 agents (minutes)
"""
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

SPACING_M = 20.0
REPETITIONS = 3
HERE = os.path.dirname(os.path.abspath(__file__))
SCENARIO = os.path.join(HERE, "scale.toml")
FLEET = os.path.join(HERE, "fleet.toml")
FLEET_S = 600.0
SURVEY = os.path.join(HERE, "survey.toml")
FORAGE = os.path.join(HERE, "forage.toml")
FORAGE_S = 900.0
CROWD_S = 120.0
CROWD = ["agents.count=1000", 'agents.robot.start="anywhere"', "agents.trails.crumbs_max=1024"]
STUDY = os.path.join(HERE, "../../scenarios/rumour/rumour.study.toml")
RUNS = 21600  # of the study


def run(hearsay, agents, duration_s):
    """CPU seconds and peak memory in MB of one run."""
    return measured(hearsay, SCENARIO, [
        f"agents.count={agents}", f"agents.circle.radius_m={agents * SPACING_M / (2 * math.pi)!r}",
        f"duration_s={float(duration_s)!r}"])


def measured(hearsay, scenario, sets):
    """CPU seconds and peak memory in MB of one run of a scenario."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    # A process of its own between, so that the peak is this run's and not the largest so far.
    code = ("import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, "
            "stdout=subprocess.DEVNULL); "
            "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)")
    command = [hearsay, "run", scenario, "--digest"] + [word for s in sets for word in ("--set", s)]
    peak = subprocess.run([sys.executable, "-S", "-c", code] + command, check=True,
                          capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return cpu_s, int(peak.stdout) / 1024


def cpu_s(hearsay, agents, duration_s):
    return statistics.median(run(hearsay, agents, duration_s)[0] for _ in range(REPETITIONS))


def exponent(sizes, times):
    return numpy.polyfit(numpy.log(sizes), numpy.log(times), 1)[0]


def sweep(hearsay, jobs, database):
    """Runs a second of the rumour study, every cell and repetition."""
    for suffix in ("", "-wal", "-shm"):
        if os.path.exists(database + suffix):
            os.remove(database + suffix)
    begin = time.monotonic()
    subprocess.run([hearsay, "sweep", STUDY, "--jobs", str(jobs), "--out", database], check=True,
                   capture_output=True)
    return RUNS / (time.monotonic() - begin)


def sweeps(hearsay):
    rates = {1: [], 2: []}
    with tempfile.TemporaryDirectory() as scratch:
        for _ in range(REPETITIONS):
            for jobs in rates:
                rates[jobs].append(sweep(hearsay, jobs, os.path.join(scratch, "rumour.db")))
    one, two = (statistics.median(rates[jobs]) for jobs in (1, 2))
    spread = ", ".join(f"{b / a:.2f}" for a, b in zip(rates[1], rates[2]))
    print("\n## The rumour study\n")
    print(f"All {RUNS:,} runs into a database: {one:.0f} runs a second with `--jobs 1`, {two:.0f} with "
          f"`--jobs 2` on two processors, {two / one:.2f} times as many (medians of {REPETITIONS}, taken in "
          f"turn; pair by pair {spread}).")


def fleets(hearsay, duration_s):
    print("\n## A fleet that follows moving targets\n")
    print(f"`tools/bench/fleet.toml`: a hundred agents, each with a 4-D belief about each of ten targets, that see "
          f"all ten and talk once a second under ci-det; {duration_s:g} s, ledger off. One run a row, start-up, "
          "motion, sightings and predictions included.\n")
    print("| graph | CPU time [s] | times real time | [µs] a belief heard | peak memory [MB] |")
    print("|---|---|---|---|---|")
    for topology, heard in (("ring", 2), ("full", 99)):
        cpu, peak = measured(hearsay, FLEET, [f'radio.topology="{topology}"', f"duration_s={float(duration_s)!r}"])
        beliefs = 100 * heard * 0.9 * 10 * duration_s  # a tenth of the packets is lost
        print(f"| {topology} | {cpu:.1f} | {duration_s / cpu:.1f} | {1e6 * cpu / beliefs:.2f} | {peak:.1f} |")


def verdict(met):
    return "met" if met else "**missed**"


def survey(hearsay, duration_s, goal):
    print("\n## A fleet that surveys an area\n")
    print(f"`tools/bench/survey.toml`: twenty vehicles with cameras over a grid of 200 × 200 cells, each of which looks "
          f"once a second, goes where a look tells most and tells all others every ten what changed; {duration_s:g} s, "
          "ledger off. One run, start-up included.\n")
    print("| CPU time [s] | times real time | goal | | peak memory [MB] |")
    print("|---|---|---|---|---|")
    cpu, peak = measured(hearsay, SURVEY, [f"duration_s={float(duration_s)!r}"])
    times = duration_s / cpu
    print(f"| {cpu:.1f} | {times:.1f} | ≥ {goal} | {verdict(times >= goal)} | {peak:.1f} |")


def forage(hearsay, duration_s, goal, crowd_s, goal_mb):
    print("\n## Robots that go by trails\n")
    print(f"`tools/bench/forage.toml`: robots among the walls of a hospital, each of which looks around itself with 180 "
          "rays ten times a second, and tells who is within 20 m of each crumb that it lays. A hundred, until crumbs go "
          "of age as fast as they are laid, and a thousand, each with room for 1024 crumbs; ledger off. One run a row, "
          "start-up included.\n")
    print("| robots | simulated [s] | CPU time [s] | times real time | goal | | peak memory [MB] | goal | |")
    print("|---|---|---|---|---|---|---|---|---|")
    cpu, peak = measured(hearsay, FORAGE, [f"duration_s={float(duration_s)!r}"])
    times = duration_s / cpu
    print(f"| 100 | {duration_s:g} | {cpu:.1f} | {times:.1f} | ≥ {goal} | {verdict(times >= goal)} | {peak:.1f} | | |")
    cpu, peak = measured(hearsay, FORAGE, CROWD + [f"duration_s={float(crowd_s)!r}"])
    print(f"| 1000 | {crowd_s:g} | {cpu:.1f} | {crowd_s / cpu:.1f} | | | {peak:.1f} | ≤ {goal_mb} | "
          f"{verdict(peak <= goal_mb)} |")


def section(title, unit, sizes, times):
    print(f"\n{title}: exponent {exponent(sizes, times):.3f} "
          f"(least squares of log time on log {unit}).\n")
    print(f"| {unit} | CPU time [s] | [µs] a delivery |")
    print("|---|---|---|")
    return zip(sizes, times)


def main():
    hearsay = sys.argv[1]
    sweeps(hearsay)
    fleets(hearsay, FLEET_S)
    survey(hearsay, FLEET_S, 100)
    forage(hearsay, FORAGE_S, 20, CROWD_S, 1024)
    start_s = cpu_s(hearsay, 2, 0.001)  # what a process costs that does nothing; taken off below
    print("\n## How cost grows\n")
    print("`tools/bench/scale.toml`: agents 20 m apart on a ring, six in range of each, that look at "
          "one target and talk once a second under ci-det, ledger off. Medians of "
          f"{REPETITIONS} runs of the whole program, less the {1e3 * start_s:.0f} ms of a run that "
          "does nothing.")
    agents = [10, 30, 100, 300, 1000, 3000, 10000]
    duration_s = 300
    times = [cpu_s(hearsay, n, duration_s) - start_s for n in agents]
    for n, t in section(f"Against the number of agents, {duration_s} s each", "agents", agents, times):
        print(f"| {n} | {t:.3f} | {1e6 * t / (6 * n * duration_s):.2f} |")
    durations_s = [60, 180, 600, 1800, 7200]
    times = [cpu_s(hearsay, 100, d) - start_s for d in durations_s]
    for d, t in section("Against simulated time, 100 agents", "simulated s", durations_s, times):
        print(f"| {d} | {t:.3f} | {1e6 * t / (6 * 100 * d):.2f} |")
    if "--hour" in sys.argv:
        minute, hour = (run(hearsay, 10000, d)[1] for d in (60, 3600))
        print(f"\nPeak memory with 10,000 agents: {minute:.1f} MB after a minute of simulated time, "
              f"{hour:.1f} MB after an hour ({hour / minute - 1:+.1%}).")


if __name__ == "__main__":
    main()
