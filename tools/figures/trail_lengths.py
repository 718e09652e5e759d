#!/usr/bin/python3
"""How long the trips of foragers are, iteration by iteration, and how long they end: a line and a histogram a
label of an axis.

    trail_lengths.py DATABASE OUTPUT [--by method] [--labels A;B;…] [--count robot|team] [--final 45] [--until 60]
                     [--shortest 47.1] [--highest 150] [--study S]

From the arrivals among a run's events. Iteration 5 is the fifth trip of each robot, or with --count team the fifth
arrival of all. --final is the iteration of the histogram, --shortest the length in m of the shortest way there is,
--highest where the axis of the lines ends. OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is chosen by an option of its name.
"""

import argparse
import math

import numpy as np

import data
import panels
import style
import trips as trips_of

SPAN = 5.0  # lengths that span more are on a logarithmic axis
RUNS_DRAWN = 40  # thin lines of more would hide one another
FADE = 0.28


def runs_of(chosen, cell):
    return [run for (run,) in chosen.rows("SELECT run FROM temp.chosen WHERE cell = ? ORDER BY repetition", (cell,))]


class Lengths:
    """values[run][robot, iteration] of the runs of one label, NaN where a robot did not get so far; of the team one
    row a run."""

    def __init__(self, chosen, runs, trips, count):
        self.values = []
        for run in runs:
            rows = {}
            if count == "team":
                rows[0] = [t.length_m for t in trips[run]]
            else:
                robots = chosen.rows("SELECT id FROM agent WHERE run = ? AND kind = 'forager' ORDER BY id", (run,))
                rows = {agent: [t.length_m for t in trips[run] if t.agent == agent] for (agent,) in robots}
            longest = max(map(len, rows.values()), default=0)
            table = np.full((len(rows), longest), np.nan)
            for row, lengths in zip(table, rows.values()):
                row[: len(lengths)] = lengths
            self.values.append(table)
        self.iterations = max(table.shape[1] for table in self.values)

    def _padded(self, table):
        return np.pad(table, ((0, 0), (0, self.iterations - table.shape[1])), constant_values=np.nan)

    def quartiles(self):
        """(lower quartile, median, upper quartile, share that got there), over robots and runs, an entry an
        iteration; of those who got there, NaN where less than half of them did."""
        everybody = np.concatenate([self._padded(table) for table in self.values])
        there = np.isfinite(everybody).mean(axis=0)
        found = np.full((3, self.iterations), np.nan)
        for i in np.nonzero(there >= 1.0 - panels.MISSING_MAX)[0]:
            column = everybody[:, i]
            found[:, i] = np.quantile(column[np.isfinite(column)], [0.25, 0.5, 0.75])
        return (*found, there)

    def of_runs(self):
        """[run, iteration]: the median over the robots of a run that got there."""
        found = np.full((len(self.values), self.iterations), np.nan)
        for row, table in zip(found, self.values):
            for i in range(table.shape[1]):
                column = table[np.isfinite(table[:, i]), i]
                row[i] = np.median(column)
        return found

    def final(self, iteration):
        """Of each run that got there, how long its trips of that iteration were."""
        if iteration > self.iterations:
            return np.array([])
        column = self.of_runs()[:, iteration - 1]
        return column[np.isfinite(column)]


def look(label, labels):
    return style.label_style(label, labels) if label is not None else (style.BLUE, "o")


def lines_panel(axes, lengths, until, shortest, highest):
    """Length against iteration; lines may run out above `highest`. Returns whether somewhere only some got there."""
    labels, some_missing, drawn = list(lengths), False, []
    for label, of_label in lengths.items():
        color, marker = look(label, labels)
        iteration = np.arange(1, of_label.iterations + 1)
        runs = of_label.of_runs()[:RUNS_DRAWN]
        for run in runs:
            axes.plot(iteration, run, "-", color=color, lw=0.6, alpha=FADE, zorder=2)
        low, middle, high, there = of_label.quartiles()
        drawn += [low[:until], high[:until], runs[:, :until].ravel()]
        axes.fill_between(iteration, low, high, color=color, alpha=0.16, lw=0.0, zorder=2.5)
        whole = there >= 1.0
        axes.plot(iteration, np.where(whole, middle, np.nan), "-", color=color, lw=2.0, zorder=4)
        partly = np.isfinite(middle) & ~whole
        if partly.any():
            some_missing = True
            beside = partly | np.append(partly[1:], False)
            axes.plot(iteration, np.where(beside, middle, np.nan), ls=(0, (1.2, 1.0)), color=color, lw=2.0, zorder=4)
        last = np.nonzero(np.isfinite(middle))[0]
        if len(last) and last[-1] + 1 < until:
            axes.plot(iteration[last[-1]], middle[last[-1]], marker, color=color, mfc="white", mew=1.4, ms=6.0, zorder=5)
    values = panels.finite(drawn + ([np.array([shortest])] if shortest else []), "length of trips")
    top = highest or values.max()
    if top > SPAN * values.min():
        style.log_axis(axes, values.min() / 1.12, highest or top * 1.15)
        axes.set_ylabel("length of a trip [m] (log)")
    else:
        axes.set_ylim(0.94 * values.min(), highest or 1.04 * top)
        axes.set_ylabel("length of a trip [m]")
    if shortest:
        axes.axhline(shortest, color=style.BLACK, lw=1.0, ls=(0, (5, 3)), zorder=1.5)
    axes.set_xlim(0.0, until + 0.5)
    axes.set_xlabel("iteration")
    axes.set_title("Each iteration", loc="left", fontweight="bold")
    return some_missing


def bins_of(values):
    """Edges for values in m: steps of 1, 2 or 5 times a power of ten, about 2 √n of them."""
    at_most = min(max(6.0, 2.0 * math.sqrt(len(values))), 24.0)
    span = max(np.ptp(values), 0.02 * values.max(), 1e-9)
    power = 10.0 ** math.floor(math.log10(span / at_most))
    step = next(power * s for s in (1, 2, 5, 10) if power * s * at_most >= span)
    first, last = math.floor(values.min() / step), math.floor(values.max() / step) + 1
    return step * np.arange(first, last + 1)


def final_panel(axes, lengths, iteration, shortest):
    """Histogram of the runs' lengths at an iteration, with Gaussian fits. Returns what the fits are."""
    labels = list(lengths)
    finals = {label: of_label.final(iteration) for label, of_label in lengths.items()}
    everything = np.concatenate(list(finals.values()))
    axes.set_xlabel("length of a trip [m]")
    axes.set_ylabel("runs")
    axes.set_title(f"Iteration {iteration}", loc="left", fontweight="bold")
    fits = {}
    if len(everything) == 0:
        panels.note(axes, "no run got so far", color=style.VERMILLION)
        axes.set_yticks([])
        return {label: f"0 of {len(of_label.values)} runs" for label, of_label in lengths.items()}
    edges = bins_of(everything)
    step = edges[1] - edges[0]
    low, high = edges[0], edges[-1]
    axes.hist(list(finals.values()), edges, color=[look(label, labels)[0] for label in labels], alpha=0.45, rwidth=0.92,
              zorder=2)  # side by side
    for label, values in finals.items():
        color, _ = look(label, labels)
        count = f"{len(values)} of {len(lengths[label].values)} runs"
        deviation = float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
        if len(values) == 0:
            fits[label] = count
        elif deviation == 0.0:
            fits[label] = f"{values[0]:.1f} m, {count}"
        else:
            mean = float(values.mean())
            x = np.linspace(mean - 3.5 * deviation, mean + 3.5 * deviation, 300)
            density = np.exp(-0.5 * ((x - mean) / deviation) ** 2) / (deviation * math.sqrt(2.0 * math.pi))
            axes.plot(x, density * len(values) * step, "-", color=color, lw=1.8, zorder=4)
            low, high = min(low, mean - 2.5 * deviation), max(high, mean + 2.5 * deviation)
            fits[label] = f"{mean:.1f} ± {deviation:.1f} m, {count}"
    if shortest:
        axes.axvline(shortest, color=style.BLACK, lw=1.0, ls=(0, (5, 3)), zorder=1.5)
        low, high = min(low, shortest), max(high, shortest)
    axes.set_xlim(low - 0.04 * (high - low), high + 0.04 * (high - low))
    axes.set_ylim(0.0, 1.08 * axes.dataLim.y1)
    axes.yaxis.get_major_locator().set_params(integer=True)
    return fits


def draw(lengths, by, arguments, sentences):
    width, labels = 10.4, list(lengths)
    left = 0.62 / width
    lines = len(labels) + bool(arguments.shortest)
    below = 1.18 + 0.2 * math.ceil(lines / 2)
    height = 3.5 + below
    figure = style.new_figure(width, height)
    grid = figure.add_gridspec(1, 2, left=left, right=0.985, top=1 - 0.32 / height, bottom=below / height,
                               width_ratios=(1.45, 1.0), wspace=0.17)
    longest = max(of_label.iterations for of_label in lengths.values())
    until = arguments.until or min(longest, max(2 * arguments.final, 10))
    some_missing = lines_panel(figure.add_subplot(grid[0, 0]), lengths, until, arguments.shortest,
                               arguments.highest)
    fits = final_panel(figure.add_subplot(grid[0, 1]), lengths, arguments.final, arguments.shortest)
    entries = []
    for label in labels:
        name = f"{label}: " if label is not None else ""
        entries.append(panels.line_entry("-", look(label, labels)[0], f"{name}{fits[label]}"))
    if arguments.shortest:
        entries.append(panels.line_entry((0, (5, 3)), style.BLACK, f"shortest way there is: {arguments.shortest:g} m"))
    panels.legend(figure, (left, 0.62 / height), entries, 2)
    if arguments.highest:
        sentences.insert(1, f"Lines may run out of their axis at {arguments.highest:g} m.")
    if some_missing:
        sentences.insert(1, "Dotted: not all got there by the end of the run; a line ends where less than half did.")
    panels.write_caption(figure, left, sentences)
    return figure


def caption(chosen, arguments, drawn):
    others = chosen.described(*drawn)
    if arguments.count == "team":
        sentences = ["Lines: median over runs of the trip that ended with the arrival of that number in the team;"
                     " band: quartiles; thin: single runs."]
    else:
        sentences = ["Lines: median over robots and runs of each robot's trip of that number; band: quartiles; thin:"
                     " medians of single runs."]
    sentences.append(
        "Histogram: " + ("that trip" if arguments.count == "team" else "the median over the robots") + " of each run,"
        " with Gaussians of the same mean and standard deviation, which the legend gives."
    )
    sentences.append(f"{chosen.repetitions} repetitions{'; ' + others if others else ''}.")
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--by", default="method", help="axis with a line a label")
    parser.add_argument("--labels", default="", help="labels of that axis, with ; between")
    parser.add_argument("--count", choices=("robot", "team"), default="robot", help="whose trips are counted")
    parser.add_argument("--final", type=int, default=45, help="iteration of the histogram")
    parser.add_argument("--until", type=int, help="last iteration of the lines")
    parser.add_argument("--shortest", type=float, help="length in m of the shortest way there is")
    parser.add_argument("--highest", type=float, help="length in m at which the axis of the lines ends")
    arguments, chosen = data.parse(parser)
    if arguments.final < 1 or (arguments.until or 1) < 1:
        raise data.UserError("--final and --until are above 0")
    for option in ("shortest", "highest"):
        value = getattr(arguments, option)
        if value is not None and not 0.0 < value < math.inf:
            raise data.UserError(f"--{option}: {value:g} is not above 0")
    if arguments.highest and arguments.highest <= (arguments.shortest or 0.0):
        raise data.UserError("--highest: it is not above --shortest")
    by = arguments.by if arguments.by != "method" or "method" in chosen.axes else None
    drawn = [by] if by else []
    chosen.require_axes(*drawn)
    labels = panels.chosen_labels(chosen, by, arguments.labels) if by else [None]
    trips = trips_of.of_runs(chosen)
    lengths = {
        label: Lengths(chosen, runs_of(chosen, chosen.cell(**({by: label} if by else {}))), trips, arguments.count)
        for label in labels
    }
    style.write(draw(lengths, by, arguments, caption(chosen, arguments, drawn)), arguments.output)


if __name__ == "__main__":
    data.main(main)
