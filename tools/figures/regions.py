"""Alarms of a certainty grid: cells over a threshold that hang together, as positions with
covariances. Merino 2007, eq. 4.20; filters/grid/regions.hpp finds the same in runs."""

from dataclasses import dataclass

import numpy as np
from matplotlib.patches import Ellipse


@dataclass
class Region:
    cells: list  # of (row, column)
    position_m: np.ndarray
    covariance_m2: np.ndarray  # of the cells' centres alone; singular for cells in one row

    def with_extent(self, cell_m):
        """Covariance with that of a cell's own extent."""
        return self.covariance_m2 + np.eye(2) * cell_m**2 / 12.0


def _members(marks, first):
    """The cells that hang together with `first` by sides or corners; takes their marks away."""
    members = [first]
    marks[first] = False
    for row, column in members:  # grows as it goes
        rows, columns = slice(max(row - 1, 0), row + 2), slice(max(column - 1, 0), column + 2)
        for below, right in np.argwhere(marks[rows, columns]):
            beside = int(rows.start + below), int(columns.start + right)
            marks[beside] = False
            members.append(beside)
    return members


def find(probability, threshold, centres_m):
    """Regions of cells with more than `threshold`, by their first cells. `probability` [row, column],
    NaN where there is none; `centres_m`: x of the columns and y of the rows."""
    marks = np.nan_to_num(probability, nan=0.0) > threshold
    regions = []
    for first in map(tuple, np.argwhere(marks)):
        if not marks[first]:
            continue
        members = _members(marks, (int(first[0]), int(first[1])))
        rows, columns = np.array(members).T
        weights = probability[rows, columns]
        places = np.column_stack([centres_m[0][columns], centres_m[1][rows]])
        position = weights @ places / weights.sum()
        apart = places - position
        regions.append(Region(members, position, (weights[:, None] * apart).T @ apart / weights.sum()))
    return regions


def ellipse(region, cell_m, sigmas=2.0, **look):
    """What lies within `sigmas` standard deviations of a region's mean, as a patch."""
    variances, axes = np.linalg.eigh(region.with_extent(cell_m))
    return Ellipse(
        region.position_m, *(2.0 * sigmas * np.sqrt(variances)),
        angle=np.degrees(np.arctan2(axes[1, 0], axes[0, 0])), **look,
    )
