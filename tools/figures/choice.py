#!/usr/bin/python3
"""Which rule to take when, as a table: what each rule takes for granted, whether it ever claimed more
than was true on trees and on loops, its true error beside the central filter's, and what it sends.

    choice.py DATABASE OUTPUT.md [--trees GRAPH…] [--study S]

The study has the axes rule and network, with labels "GRAPH, RADIO"; the first radio is the good one.
OUTPUT.csv beside OUTPUT.md has the numbers, a line a rule and network.
"""

import argparse
import csv
import io
import os

import numpy as np

import data
import rules as figure
import stats
import style

# What a rule takes for granted, in a few words; `hearsay list rules` says it in full.
ASSUMES = {
    "none": "nothing; hears nobody",
    "local-update": "all hear all, each message once",
    "naive": "all that is heard is news",
    "channel": "a tree, nothing lost or crossing",
    "channel-robust": "a tree",
    "ci-det": "nothing about correlation",
    "ci-trace": "nothing about correlation",
    "ci-half": "nothing about correlation",
    "ci-fixed": "nothing about correlation",
    "ci-niehsen": "nothing about correlation",
    "ci-franken-huepper": "nothing about correlation",
    "most-certain": "nothing about correlation",
    "inverse-ci": "what is shared is information of both",
    "ellipsoidal": "the better belief contains the other",
    "ci-batch": "nothing about correlation",
    "split-ci": "one's own news is independent",
    "consensus-information": "nothing about correlation",
    "hybrid-consensus": "news spreads evenly over all agents",
    "hybrid-consensus, γ = 1": "one's own news is independent",
}


class Choice:
    """What the table says, worked out from the runs."""

    def __init__(self, chosen, trees):
        self.ends = figure.Ends(chosen)
        if self.ends.anees is None:
            raise data.UserError(f"study {chosen.study!r} recorded no series 'ledger_anees'")
        self.chosen = chosen
        self.bytes, self.saved = chosen.scalar("bytes_sent"), chosen.scalar("distance_saved_m")
        unknown = [tree for tree in trees if tree not in self.ends.topologies]
        if unknown:
            raise data.UserError(f"--trees {unknown[0]}: no such graph in {chosen.study!r}")
        self.trees = trees
        self.loops = [graph for graph in self.ends.topologies if graph not in trees]

    def cell(self, rule, graph, radio):
        return self.chosen.cell(rule=rule, network=f"{graph}, {radio}")

    def relative_error(self, rule, graph, radio):
        return (self.ends.of(rule, graph, radio)[0]
                / self.ends.of(rule, graph, radio, "central")[0])

    def mean(self, scalar, rule, graph, radio):
        """Mean over agents and repetitions."""
        cell = self.cell(rule, graph, radio)
        values = np.array([array[cell] for agent, array in scalar.items() if agent >= 0])
        return float(np.nanmean(values)) if np.isfinite(values).any() else np.nan

    def bytes_per_m(self, rule, graph, radio):
        """NaN where nothing is saved, or so little that its sign is not certain (95 %)."""
        cell = self.cell(rule, graph, radio)
        values = np.array([array[cell] for agent, array in self.saved.items() if agent >= 0])
        of_runs = np.nanmean(np.where(np.isfinite(values).any(axis=1)[:, None], values, np.nan), axis=0)
        mean, half = stats.mean_interval(of_runs)
        sent = self.mean(self.bytes, rule, graph, radio)
        return sent / mean if mean - half > 0.0 and sent > 0.0 else np.nan

    def squares(self, rule, graph, radio):
        """Sum of squared errors over agents, a number a repetition."""
        series = self.ends.series["rms_error_m"]
        return series.of("squares", "agents")[self.cell(rule, graph, radio)].sum(axis=(-2, -1))

    def best(self, graph, radio):
        """Of the rules that did not claim too much: the one that errs least, and all that cannot
        be told from it (95 %, paired)."""
        honest = [r for r in self.ends.rules if self.ends.honest(r, graph, radio)]
        if not honest:
            return []
        honest.sort(key=lambda rule: self.relative_error(rule, graph, radio))
        best = self.squares(honest[0], graph, radio)
        found = honest[:1]
        for rule in honest[1:]:
            low, _ = stats.ratio_interval(self.squares(rule, graph, radio)[:, None], best[:, None])
            if low[0] <= 1.0 + 1e-9:
                found.append(rule)
        return found


def span(values):
    """"1.4" or "1.0 – 1.7": the least and the greatest, if their texts differ."""
    values = [v for v in values if np.isfinite(v)]
    if not values:
        return "–"
    low, high = (style.number(v) for v in (min(values), max(values)))
    return low if low == high else f"{low} – {high}"


def verdict(choice, rule, graphs):
    """Whether it ever claimed more than is true on these graphs, with the worst ANEES."""
    good, *others = [
        max(choice.ends.worst_anees(rule, graph, radio) for graph in graphs)
        for radio in choice.ends.radios
    ]
    worst = max([good, *others])
    text = "indefinite" if np.isinf(worst) else style.number(worst)
    if worst <= figure.OVER:
        return f"yes ({text})"
    return f"radio {choice.ends.radios[0]} only ({text})" if good <= figure.OVER else f"**no** ({text})"


def table(rows):
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["| " + " | ".join(c.ljust(w) for c, w in zip(row, widths)) + " |" for row in rows]
    lines.insert(1, "|" + "|".join("-" * (w + 2) for w in widths) + "|")
    return "\n".join(lines) + "\n"


def markdown(choice):
    ends, radios = choice.ends, choice.ends.radios
    first = [["graph"] + [f"radio {radio}" for radio in radios]]
    for graph in ends.topologies:
        cells = []
        for radio in radios:
            found = choice.best(graph, radio)
            texts = [f"**{found[0]}** {choice.relative_error(found[0], graph, radio):.2f}"] if found else ["–"]
            texts += [f"{r} {choice.relative_error(r, graph, radio):.2f}" for r in found[1:]]
            cells.append(", ".join(texts))
        first.append([graph] + cells)
    second = [["rule", "takes for granted", "honest on trees", "honest on loops"]]
    second[0] += [f"error, {graph}" for graph in ends.topologies] + ["kB an agent", "kB a metre saved"]
    for rule in ends.rules:
        row = [rule, ASSUMES.get(rule, ""), verdict(choice, rule, choice.trees),
               verdict(choice, rule, choice.loops)]
        row += [span([choice.relative_error(rule, g, r) for r in radios]) for g in ends.topologies]
        for measure in (lambda g: choice.mean(choice.bytes, rule, g, radios[0]),
                        lambda g: choice.bytes_per_m(rule, g, radios[0])):
            row.append(span([measure(g) / 1000.0 for g in ends.topologies]))
        second.append(row)
    return (
        f"**{choice.chosen.study}**: which rule to take when, by {choice.chosen.repetitions} paired"
        " repetitions\n\n"
        "Of the rules that nowhere claimed more than is true, the one with the least true error, over"
        " that of the central\nfilter; then those that cannot be told from it (95 %, paired):\n\n"
        + table(first)
        + "\nRule by rule. *Honest*: no agent claims more than is true, whatever the radio; in brackets"
        " the worst agent's ANEES\nby the ledger (1: claims what is true, less: gives away)."
        " *Error*: true error over that of the central filter, from the best\nto the worst radio."
        " *kB a metre saved*: bytes sent for each metre that the estimate comes nearer to the truth"
        f" than by\none's own measurements, radio {radios[0]}, over the graphs.\n\n"
        + table(second)
    )


def csv_text(choice):
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["rule", "graph", "radio", "worst_ledger_anees", "error_over_central",
                     "bytes_sent", "bytes_per_m_saved"])
    for rule in choice.ends.rules:
        for graph in choice.ends.topologies:
            for radio in choice.ends.radios:
                place = (rule, graph, radio)
                values = [choice.ends.worst_anees(*place), choice.relative_error(*place),
                          choice.mean(choice.bytes, *place), choice.bytes_per_m(*place)]
                writer.writerow([*place] + [f"{v:.9g}" if np.isfinite(v) else "" for v in values])
    return out.getvalue()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--trees", nargs="+", default=["line"], metavar="GRAPH",
                        help="the graphs without loops (default: line)")
    arguments, chosen = data.parse(parser)
    stem, ending = os.path.splitext(arguments.output)
    if ending != ".md":
        raise data.UserError(f"{arguments.output}: this table ends with .md")
    choice = Choice(chosen, arguments.trees)
    data.write_text(stem + ".csv", csv_text(choice))
    data.write_text(arguments.output, markdown(choice))


if __name__ == "__main__":
    data.main(main)
