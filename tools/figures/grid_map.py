#!/usr/bin/python3
"""Certainty grids at the end of a run on maps: what a vehicle believes of every cell, where all vehicles
flew, and the alarms it would raise. A panel a rule.

    grid_map.py DATABASE OUTPUT [--by rule] [--rules A;B;…] [--repetition 1] [--agent NAME|central]
                [--layers probability|beta] [--threshold 0.8] [--study-file FILE] [--study S]

For runs of explorers with record.grids = "on" and the series place_x_m, place_y_m. The area and the targets
are read from the study file, which is looked for beside the database and among the scenarios. OUTPUT ends with
.png, .svg or .pdf. Any other axis of the study is chosen by an option of its name.
"""

import argparse
import math

import numpy as np
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

import data
import panels
import regions
import style
import world

LAYERS = {
    "cell_probability": "probability of an alarm",
    "cell_alpha": "α: looks that saw one",
    "cell_beta": "β: looks that saw none",
}
BETA = ("cell_alpha", "cell_beta", "cell_probability")
LOG_FROM = 30.0  # counts that span more are on a logarithmic scale
NEAR = 1e-6  # a cell so near a threshold may lie on either side of it
UNKNOWN = "#f3d9d9"


def greys():
    """From white to black in steps of equal lightness (CIE L*), so that hues are left for vehicles."""
    lightness = np.linspace(98.0, 8.0, 256)
    luminance = np.where(lightness > 8.0, ((lightness + 16.0) / 116.0) ** 3, lightness / 903.3)
    light = np.where(luminance > 0.0031308, 1.055 * luminance ** (1 / 2.4) - 0.055, 12.92 * luminance)
    shades = ListedColormap(np.repeat(light[:, None], 3, axis=1))
    shades.set_bad(UNKNOWN)
    return shades


def rows_of_run(chosen, run, names):
    """[(name, instant, agent, subject, value or None)] of these series of one run, in time."""
    return chosen.rows(
        "SELECT name, t_s, agent, subject, value FROM series WHERE run = ? AND name IN"
        f" ({', '.join('?' * len(names))}) ORDER BY t_s",
        (run, *names),
    )


class Run:
    """What one run left: grids and ways."""

    def __init__(self, chosen, cell, repetition, agent, layers, study_file):
        self.number = chosen.run(cell, repetition)
        self.world = world.read(chosen, cell, self.number, study_file)
        rows = rows_of_run(chosen, self.number, (*layers, "place_x_m", "place_y_m"))
        self.layers = {name: self._grid(rows, name, agent) for name in layers}
        self.end_s = rows[-1][1] if rows else 0.0
        self.ways = {}
        for name, t_s, who, _, value in rows:
            if name.startswith("place_"):
                axis = self.ways.setdefault(who, ([], []))["xy".index(name[6])]
                axis.append(np.nan if value is None else value)

    def _grid(self, rows, name, agent):
        """[row, column] at the end. @raises UserError if it was not recorded."""
        w = self.world
        found = np.full((w.rows, w.columns), np.nan)
        size = (0, 0)
        for of_name, _, who, subject, value in rows:
            if of_name == name and who == agent:
                column, row = map(int, subject.split(","))
                size = max(size[0], column + 1), max(size[1], row + 1)
                if column < w.columns and row < w.rows and value is not None:
                    found[row, column] = value
        if size == (0, 0):
            kind = "" if name == "cell_probability" else " (of Beta grids alone)"
            raise data.UserError(f'no {name}{kind} in this run; record.grids = "on" leaves it')
        if size != (w.columns, w.rows):
            raise data.UserError(
                f"{w.file}: an area of {w.columns} × {w.rows} cells, the run had {size[0]} × {size[1]}"
            )
        return found

    def check_targets(self, chosen, agent):
        """What the run recorded of detected and false cells must follow from the targets of the file.
        @raises UserError if it does not: they are those of another study."""
        probability, truth = self.layers["cell_probability"], self.world.truth()
        names = {"cells_detected_share": truth, "cells_false_share": ~truth}
        rows = rows_of_run(chosen, self.number, tuple(names))
        for name, t_s, who, threshold, value in rows:
            if t_s != self.end_s or who != agent or value is None:
                continue
            counted = probability[names[name]]
            over = (counted > float(threshold)).sum()
            doubtful = (np.abs(counted - float(threshold)) < NEAR).sum()
            if abs(value * len(counted) - over) > doubtful + 0.01:
                raise data.UserError(
                    f"{self.world.file}: the targets are not those of the runs, by their {name}"
                )

    def alarms(self, threshold):
        return regions.find(self.layers["cell_probability"], threshold, self.world.centres())


def map_panel(axes, run, layer, scale, colors, agent, alarms, cell_pt):
    """One layer of a grid, with targets, ways and alarms. A cell is `cell_pt` wide on paper."""
    w = run.world
    image = axes.imshow(run.layers[layer], origin="lower", extent=w.extent, cmap=greys(), norm=scale,
                        interpolation="nearest", zorder=1)
    thin = min(1.0, cell_pt / 10.0)  # small cells have thin outlines
    corners = [w.origin_m + w.cell_m * np.array([column, row]) for row, column in np.argwhere(w.truth())]
    for zorder, casing in ((5, 1.4 * thin), (6, None)):
        for corner in corners:
            axes.add_patch(Rectangle(corner, w.cell_m, w.cell_m, fill=False, zorder=zorder,
                                     ec="white" if casing else style.VERMILLION, lw=1.8 * thin + (casing or 0.0)))
        for region in alarms:
            axes.add_patch(regions.ellipse(region, w.cell_m, fill=False, ec="white" if casing else style.BLACK,
                                           lw=1.5 * thin + (casing or 0.0), zorder=zorder + 0.5))
    for who, (x, y) in sorted(run.ways.items()):
        width = 1.7 if who == agent else 1.0
        axes.plot(x, y, color=colors[who], lw=width, zorder=3, solid_joinstyle="round",
                  path_effects=[withStroke(linewidth=width + 1.4, foreground="white", alpha=0.8)])
        axes.plot(x[:1], y[:1], "o", color=colors[who], ms=6.0, mec="white", mew=1.0, zorder=4, clip_on=False)
    x0, x1, y0, y1 = w.extent
    axes.set_xlim(x0, x1)
    axes.set_ylim(y0, y1)
    axes.grid(False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(True)
    return image


def scale_of(values, layer):
    """How a layer's numbers become shades, alike in all panels."""
    if layer == "cell_probability":
        return Normalize(0.0, 1.0)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if low > 0.0 and high > LOG_FROM * low:
        return LogNorm(low, high)
    return Normalize(low, high if high > low else low + 1.0)


def columns_of(panels_count, layers, at_most):
    if layers > 1:
        return layers
    rows = math.ceil(panels_count / at_most)
    return math.ceil(panels_count / rows)


def draw(runs, by, layers, agent, threshold, colors, entries):
    """(figure, left edge) of a panel a run and layer, with a legend."""
    aspect = next(iter(runs.values())).world
    wide, bar = min(max(0.13 * aspect.columns, 3.0), 4.4), 0.95
    columns = columns_of(len(runs), len(layers), int(12.5 / wide))
    rows = math.ceil(len(runs) * len(layers) / columns)
    high = wide * aspect.rows / aspect.columns
    width = max(wide * columns + 0.35 * (columns - 1) + 0.75 + (0.1 if len(layers) > 1 else bar), 6.6)
    whole = sum(0.56 + 0.07 * len(entry.get_label()) for entry in entries) < width - 0.7
    fit = len(entries) if whole else max(2, int((width - 0.8) / 1.5))
    below = 1.03 + 0.2 * math.ceil(len(entries) / fit) + (0.62 if len(layers) > 1 else 0.0)
    height = (high + 0.42) * rows + 0.1 + below
    figure = style.new_figure(width, height)
    left = 0.62 / width
    grid = figure.add_gridspec(
        rows, columns, left=left, right=left + (wide * columns + 0.35 * (columns - 1)) / width,
        top=1 - 0.38 / height, bottom=below / height, wspace=0.35 / wide, hspace=0.42 / high,
    )
    places = [(label, layer) for label in runs for layer in layers]
    scales = {l: scale_of(np.concatenate([r.layers[l].ravel() for r in runs.values()]), l) for l in layers}
    last = [None] * columns
    for k, (label, layer) in enumerate(places):
        i, j = divmod(k, columns)
        axes = figure.add_subplot(grid[i, j])
        run = runs[label]
        alarms = run.alarms(threshold) if layer == "cell_probability" else []
        image = map_panel(axes, run, layer, scales[layer], colors, agent, alarms,
                          72.0 * wide / aspect.columns)
        last[j] = image, axes, layer
        lowest = k + columns >= len(places)
        axes.tick_params(labelleft=j == 0, labelbottom=lowest)
        axes.set_ylabel("y [m]" if j == 0 else "", labelpad=1)
        axes.set_xlabel("x [m]" if lowest else "", labelpad=1)
        if j == 0 or len(layers) == 1:
            axes.set_title(panels.label_name(by, label), loc="left", fontweight="bold", pad=4)
        if layer == "cell_probability":
            count = len(alarms)
            axes.set_title(f"{count} alarm{'' if count == 1 else 's'}", loc="right", fontsize=8.5, pad=4)
    colour_bars(figure, last, len(layers) > 1)
    panels.legend(figure, (left, 0.56 / height), entries, fit)
    return figure, left


def colour_bars(figure, last, below):
    """Beside the panels, or below each column if columns differ."""
    height, width = figure.get_figheight(), figure.get_figwidth()
    for image, axes, layer in last if below else last[-1:]:
        box = axes.get_position()
        if below:
            place = (box.x0, box.y0 - 0.62 / height, box.width, 0.11 / height)
        else:
            place = (last[-1][1].get_position().x1 + 0.15 / width, box.y0, 0.12 / width, box.height)
        bar = figure.colorbar(image, cax=figure.add_axes(place), orientation="horizontal" if below else "vertical")
        bar.set_label(LAYERS[layer] if layer != "cell_probability" or not below else
                      "mean α/(α+β)", fontsize=8.5, labelpad=2)
        bar.outline.set_linewidth(0.6)
        if isinstance(image.norm, LogNorm):
            bar.ax.xaxis.set_major_formatter(lambda v, _: style.number(v) if v < 1e4 else f"$10^{{{np.log10(v):.0f}}}$")
            bar.ax.minorticks_off()


def caption(chosen, arguments, run, by, name):
    others = chosen.described(by)
    sentences = [
        f"Grid of {'all looks together' if name == 'central' else name} at the end of"
        f" repetition {arguments.repetition} of {chosen.repetitions}, {run.end_s:g} s"
        f"{'; ' + others if others else ''}.",
        f"Area of {run.world.columns} × {run.world.rows} cells of {run.world.cell_m:g} m.",
        f"Alarms: cells over {arguments.threshold:g} that touch, by their probabilities as mean and 2 σ, the"
        " cells' own extent included.",
    ]
    if not all(np.isfinite(values).all() for values in run.layers.values()):
        sentences.append("Tinted: no value.")
    return sentences


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--by", default="rule", help="axis with a panel a label")
    parser.add_argument("--rules", "--labels", default="", dest="labels", help="labels of that axis, with ; between")
    parser.add_argument("--repetition", type=int, default=1, help="from 1")
    parser.add_argument("--agent", help="whose grid, or central; default: the first explorer's")
    parser.add_argument("--layers", choices=("probability", "beta"), default="probability")
    parser.add_argument("--threshold", type=float, default=0.8, help="of alarms")
    parser.add_argument("--study-file", help="with the area and the targets")
    arguments, chosen = data.parse(parser)
    by = arguments.by
    chosen.require_axes(by)
    labels = panels.chosen_labels(chosen, by, arguments.labels)
    layers = BETA if arguments.layers == "beta" else ("cell_probability",)
    chosen.series(("place_x_m", "place_y_m"), at_end=True)  # says so if they are not there
    flying = chosen.rows("SELECT MIN(agent) FROM series WHERE run = (SELECT MIN(run) FROM temp.chosen)"
                         " AND name = 'place_x_m'")[0][0]
    name = arguments.agent or chosen.agent_names()[flying]
    agent = chosen.agent(name)
    runs = {}
    for label in labels:
        cell = chosen.cell(**{by: label})
        runs[label] = Run(chosen, cell, arguments.repetition, agent, layers, arguments.study_file)
        runs[label].check_targets(chosen, agent)
    everybody = sorted({who for run in runs.values() for who in run.ways})
    colors = style.agent_colors(everybody)
    names = chosen.agent_names()
    entries = [panels.line_entry("-", colors[who], names.get(who, f"agent {who}"), "o") for who in everybody]
    entries += [
        panels.line_entry("", style.VERMILLION, "cell with a target", "s", mfc="none", ms=7.0, mew=1.8),
        panels.line_entry("", style.BLACK, f"alarm over {arguments.threshold:g}, 2 σ", "o", mfc="none", ms=8.0,
                          mew=1.6),
    ]
    figure, left = draw(runs, by, layers, agent, arguments.threshold, colors, entries)
    panels.write_caption(figure, left, caption(chosen, arguments, runs[labels[0]], by, name))
    style.write(figure, arguments.output)


if __name__ == "__main__":
    data.main(main)
