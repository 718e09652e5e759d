#!/usr/bin/python3
"""How grids of vehicles develop: how far each is from the central grid, how far they are from one another, or
any other series over time. A column a rule, a row a metric, a line a vehicle.

    grid_time.py DATABASE OUTPUT [--by rule] [--rules A;B;…] [--metrics kl_to_central_nats;disagreement_probability]
                 [--threshold 0.8] [--study S]

The threshold is that of metrics of alarms. OUTPUT ends with .png, .svg or .pdf. Any other axis of the study is
chosen by an option of its name.
"""

import argparse
import math

import numpy as np

import data
import panels
import style

METRICS = "kl_to_central_nats;disagreement_probability"
COLUMNS_MAX = 6


class Developments:
    """Means over repetitions of each metric, for every label and vehicle."""

    def __init__(self, chosen, by, labels, metrics, threshold):
        self.chosen, self.by, self.labels = chosen, by, labels
        self.metrics = metrics
        self.cells = {label: chosen.cell(**{by: label}) for label in labels}
        self.subjects = {m: panels.threshold_subject(chosen, m, threshold) for m in metrics}
        self.series = {m: chosen.series((m,), subject=self.subjects[m])[m] for m in metrics}

    def vehicles(self, metric):
        return [int(a) for a in self.series[metric].agents if a >= 0]

    def of_vehicle(self, metric, label, agent):
        return panels.mean(self.series[metric], self.cells[label], agent).value

    def of_all(self, metric, label):
        """Mean over vehicles with its interval; of the fleet's own metrics that of agent −1."""
        who = "agents" if self.vehicles(metric) else "central"
        return panels.mean(self.series[metric], self.cells[label], who, interval=True)

    def central(self, metric, label):
        """The central grid's own, or None."""
        series = self.series[metric]
        if data.CENTRAL not in series.agents or not self.vehicles(metric):
            return None
        return panels.mean(series, self.cells[label], "central").value

    def values(self, metric):
        """All that is drawn of a metric."""
        arrays = []
        for label in self.labels:
            arrays += [self.of_vehicle(metric, label, a) for a in self.vehicles(metric)]
            of_all = self.of_all(metric, label)
            arrays += [of_all.value, of_all.high]
            central = self.central(metric, label)
            arrays += [central] if central is not None else []
        return panels.finite(arrays, metric)


def value_axis(axes, values, logarithmic):
    if logarithmic:
        positive = values[values > 0.0]
        high = positive.max()
        style.log_axis(axes, 0.7 * max(positive.min(), 1e-6 * min(high, 1.0)), 1.6 * high)
        return
    low, high = min(0.0, values.min()), max(0.0, values.max())
    room = 0.06 * (high - low)
    axes.set_ylim(low - room if low < 0.0 else 0.0, high + room if high > low else 1.0)


def panel(axes, developments, metric, label, colors):
    t_s = developments.series[metric].t_s
    floor = 1e-3 * axes.get_ylim()[0] if axes.get_yscale() == "log" else -math.inf

    def shown(values):
        """Zero lies below a logarithmic axis; what is not known is not drawn."""
        return np.where(np.isfinite(values), np.maximum(values, floor), np.nan)

    of_all = developments.of_all(metric, label)
    vehicles = developments.vehicles(metric)
    axes.fill_between(t_s, shown(of_all.low), shown(of_all.high), color=style.GREY, alpha=0.3, lw=0.0, zorder=2)
    for k, agent in enumerate(vehicles):  # the wider lie below, so that equal ones are all seen
        axes.plot(t_s, shown(developments.of_vehicle(metric, label, agent)), color=colors[agent],
                  lw=0.9 + 0.7 * (len(vehicles) - 1 - k), zorder=3)
    central = developments.central(metric, label)
    if central is not None:
        axes.plot(t_s, shown(central), color=style.BLACK, lw=1.4, ls="--", zorder=4)
    if not vehicles:
        axes.plot(t_s, shown(of_all.value), color=style.GREY, lw=1.8, zorder=3)
    style.time_axis(axes, t_s)


def draw(developments, colors):
    """(figure, left edge, names of metrics on logarithmic axes)"""
    labels, metrics = developments.labels, developments.metrics
    blocks = math.ceil(len(labels) / COLUMNS_MAX)
    columns = math.ceil(len(labels) / blocks)
    rows = blocks * len(metrics)
    width, height = max(2.3 * columns + 1.0, 6.6), 2.0 * rows + 0.35 * (blocks - 1) + 1.55
    figure = style.new_figure(width, height)
    left = 0.86 / width
    outer = figure.add_gridspec(blocks, 1, left=left, right=0.99, top=1 - 0.35 / height, bottom=1.22 / height,
                                hspace=0.6 / (2.0 * len(metrics)))
    grids = [part.subgridspec(len(metrics), columns, wspace=0.08, hspace=0.14) for part in outer]
    logarithmic = []
    for m, metric in enumerate(metrics):
        values = developments.values(metric)
        if panels.wants_log(values):
            logarithmic.append(metric)
        for k, label in enumerate(labels):
            block, column = divmod(k, columns)
            axes = figure.add_subplot(grids[block][m, column])
            value_axis(axes, values, metric in logarithmic)
            panel(axes, developments, metric, label, colors)
            lowest = m == len(metrics) - 1
            axes.tick_params(labelleft=column == 0, labelbottom=lowest)
            axes.set_xlabel("time [s]" if lowest and k + columns >= len(labels) else "", labelpad=1.5)
            if m == 0:
                axes.set_title(panels.label_name(developments.by, label), fontweight="bold", loc="left", pad=4)
            if column == 0:
                axes.set_ylabel(panels.metric_name(metric, developments.subjects[metric], short=True))
    return figure, left, logarithmic


def caption(developments, logarithmic):
    chosen = developments.chosen
    others = chosen.described(developments.by)
    sentences = [
        f"Means over {chosen.repetitions} paired repetitions{'; ' + others if others else ''}.",
        "Grey: 95 % bootstrap interval of the mean over vehicles.",
    ]
    linear = [m for m in developments.metrics if m not in logarithmic]
    if logarithmic:
        names = " and ".join(panels.metric_name(m, None, short=True).replace("\n", " ") for m in logarithmic)
        sentences.append(f"Logarithmic: {names}; zero lies below. " + ("Else linear." if linear else ""))
    else:
        sentences.append("Axes are linear.")
    if chosen.failed:
        sentences.append(f"{chosen.failed} failed runs left out.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--by", default="rule", help="axis with a column a label")
    parser.add_argument("--rules", "--labels", default="", dest="labels", help="labels of that axis, with ; between")
    parser.add_argument("--metrics", default=METRICS, help="series, with ; between")
    parser.add_argument("--threshold", default="0.8", help="of metrics of alarms")
    arguments, chosen = data.parse(parser)
    chosen.require_axes(arguments.by)
    labels = panels.chosen_labels(chosen, arguments.by, arguments.labels)
    metrics = panels.names_in(arguments.metrics, "--metrics")
    developments = Developments(chosen, arguments.by, labels, metrics, arguments.threshold)
    vehicles = sorted({a for m in metrics for a in developments.vehicles(m)})
    colors = style.agent_colors(vehicles)
    figure, left, logarithmic = draw(developments, colors)
    names = chosen.agent_names()
    entries = [panels.line_entry("-", colors[a], names.get(a, f"agent {a}")) for a in vehicles[: len(style.AGENTS)]]
    if any(not developments.vehicles(m) for m in metrics):
        entries.append(panels.line_entry("-", style.GREY, "of the fleet"))
    if any(developments.central(m, labels[0]) is not None for m in metrics):
        entries.append(panels.line_entry("--", style.BLACK, "central grid"))
    panels.legend(figure, (left, 0.56 / figure.get_figheight()), entries, len(entries))
    panels.write_caption(figure, left, caption(developments, logarithmic))
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
