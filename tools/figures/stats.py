"""χ² quantiles and intervals, in numpy and the standard library alone."""

import functools
import math

import numpy as np


def gamma_p(a, x):
    """Regularised lower incomplete gamma function P(a, x), a > 0, x ≥ 0."""
    if x <= 0.0:
        return 0.0
    scale = math.exp(a * math.log(x) - x - math.lgamma(a))
    if x < a + 1.0:  # power series
        term = total = 1.0 / a
        n = a
        while abs(term) > 1e-17 * abs(total):
            n += 1.0
            term *= x / n
            total += term
        return scale * total
    # continued fraction of the upper function, evaluated by Lentz's method
    tiny = 1e-300
    b = x + 1.0 - a
    c = 1.0 / tiny
    d = 1.0 / b
    h = d
    for i in range(1, 10_000):
        an = -i * (i - a)
        b += 2.0
        d = 1.0 / (an * d + b or tiny)
        c = b + an / c or tiny
        step = c * d
        h *= step
        if abs(step - 1.0) < 1e-15:
            break
    return 1.0 - scale * h


def chi2_quantile(p, degrees):
    """x with P(χ²_degrees ≤ x) = p, by bisection."""
    low, high = 0.0, degrees + 10.0
    while gamma_p(degrees / 2.0, high / 2.0) < p:
        high *= 2.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        if gamma_p(degrees / 2.0, middle / 2.0) < p:
            low = middle
        else:
            high = middle
        if high - low <= 1e-13 * high:
            break
    return 0.5 * (low + high)


def anees_band(dimension, runs, comparisons=1, alpha=0.05):
    """Where the ANEES (mean over `runs` of NEES, divided by the state's dimension) of a consistent
    estimator lies with probability 1 − alpha in all of `comparisons` (Bonferroni)."""
    tail = alpha / 2.0 / comparisons
    degrees = dimension * runs
    return chi2_quantile(tail, degrees) / degrees, chi2_quantile(1.0 - tail, degrees) / degrees


@functools.lru_cache(maxsize=64)
def t_quantile(p, degrees):
    """x with P(t_degrees ≤ x) = p, ½ ≤ p < 1: bisection on Simpson's rule."""
    log_scale = math.lgamma((degrees + 1) / 2) - math.lgamma(degrees / 2)
    scale = math.exp(log_scale) / math.sqrt(degrees * math.pi)

    def above_half(x):
        y = np.linspace(0.0, x, 2001)
        density = scale * (1.0 + y * y / degrees) ** (-(degrees + 1) / 2)
        weights = np.full(len(y), 2.0)
        weights[1::2], weights[0], weights[-1] = 4.0, 1.0, 1.0
        return float(weights @ density) * (y[1] - y[0]) / 3.0

    low, high = 0.0, 1000.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        if above_half(middle) < p - 0.5:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def mean_interval(values, alpha=0.05):
    """(mean, half width of its t interval) of the finite values. Without two of them no width is
    known: NaN; without any neither."""
    values = np.asarray(values)[np.isfinite(values)]
    if len(values) == 0:
        return math.nan, math.nan
    if len(values) == 1:
        return float(values[0]), math.nan
    error = values.std(ddof=1) / math.sqrt(len(values))
    return float(values.mean()), t_quantile(1.0 - alpha / 2.0, len(values) - 1) * float(error)


@functools.lru_cache(maxsize=8)
def _resamples(n, resamples, seed):
    """How often each of n repetitions is drawn in each resample."""
    generator = np.random.Generator(np.random.PCG64(seed))
    return generator.multinomial(n, np.full(n, 1.0 / n), resamples).astype(float)


def ratio_interval(totals, counts, alpha=0.05, resamples=2000, seed=1):
    """Bootstrap (percentile) interval of Σ totals / Σ counts over repetitions (axis 0), point by
    point; the same resamples everywhere. NaN with fewer than two repetitions."""
    n = len(totals)
    if n < 2:
        return np.full(totals.shape[1:], np.nan), np.full(totals.shape[1:], np.nan)
    draws = _resamples(n, resamples, seed)
    flat = (n, -1)
    with np.errstate(invalid="ignore", divide="ignore"):
        means = (draws @ totals.reshape(flat)) / (draws @ counts.reshape(flat))
    means = np.where(np.isfinite(means), means, np.inf)
    low, high = np.quantile(means, [alpha / 2.0, 1.0 - alpha / 2.0], axis=0, method="nearest")
    shape = totals.shape[1:]
    return (np.where(np.isfinite(a), a, np.nan).reshape(shape) for a in (low, high))


def median_interval(values, alpha=0.05, resamples=2000, seed=1):
    """(median, low, high) of all values but NaN, by a percentile bootstrap over repetitions (axis
    0); infinite ones count as the largest. The lower of two medians. NaN where unknown."""
    known = ~np.isnan(values)
    if not known.any():
        return math.nan, math.nan, math.nan
    order = np.argsort(values[known], kind="stable")
    ranked, repetition = values[known][order], np.nonzero(known)[0][order]

    def median(weights):
        above = np.cumsum(weights[..., repetition], axis=-1)
        return ranked[np.argmax(2.0 * above >= above[..., -1:], axis=-1)]

    middle = float(median(np.ones(len(values))))
    if len(values) < 2:
        return middle, math.nan, math.nan
    medians = np.sort(median(_resamples(len(values), resamples, seed)))
    last = resamples - 1
    return middle, medians[int(alpha / 2.0 * last)], medians[round((1.0 - alpha / 2.0) * last)]
