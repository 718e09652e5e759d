"""Closed forms for radios: what the figures of scenarios/radio draw as lines, and what the bounds
of their claims are made from. Plain numbers in, plain numbers out."""

import math

import numpy as np

# --- Delivery over a distance


def disk(distance_m, range_m):
    """Whoever is within range hears."""
    return 1.0 if distance_m <= range_m else 0.0


def grey_zone(distance_m, inner_m, outer_m):
    """From all at inner_m the share heard falls linearly to none at outer_m."""
    return min(max((outer_m - distance_m) / (outer_m - inner_m), 0.0), 1.0)


def snr_db(distance_m, exponent=3.0, reference_loss_db=46.6777, power_over_noise_db=105.0):
    """Signal to noise over a distance of at least 1 m: log-distance path loss (Rappaport 2002,
    section 4.9)."""
    return power_over_noise_db - reference_loss_db - 10.0 * exponent * math.log10(distance_m)


def frame_success(snr, frame_bytes):
    """(1 − BER)^(8 bytes) with BER = ½ exp(−γ/1.28), γ = 10^(dB/10) (Zuniga and Krishnamachari
    2004)."""
    ber = 0.5 * np.exp(-(10.0 ** (np.asarray(snr) / 10.0)) / 1.28)
    return np.exp(8.0 * frame_bytes * np.log1p(-ber))


def shadowed_success(snr, frame_bytes, sigma_db, reach_db=None):
    """Mean of frame_success over a shadowing X ~ N(0, σ²) that is subtracted from `snr`, by
    Simpson's rule over ±8σ."""
    x = np.linspace(-8.0, 8.0, 4001)
    weight = np.full(len(x), 2.0)
    weight[1::2], weight[0], weight[-1] = 4.0, 1.0, 1.0
    density = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    values = frame_success(snr - sigma_db * x, frame_bytes) * density
    return float(np.sum(weight * values) * (x[1] - x[0]) / 3.0)


# --- Waiting in a transmitter's queue; times in units of the mean time that a packet takes


def m_d_1_wait(load):
    """Mean wait before service, equal sizes (Pollaczek and Khinchine)."""
    return load / (2.0 * (1.0 - load))


def m_m_1_wait(load):
    """The same for exponential sizes."""
    return load / (1.0 - load)


def m_m_1_k(load, k):
    """(mean wait of who gets in, share that gets in) with at most k waiting or in service."""
    share = load ** np.arange(k + 1)
    share /= share.sum()
    inside = share[:k] / (1.0 - share[k])
    return float(np.arange(k) @ inside), 1.0 - float(share[k])


def m_d_1_k(load, k):
    """The same for equal sizes: the chain of those left behind by departures (0 … k − 1), then
    p_j = π_j/(π_0 + ρ) (Gross and Harris, Fundamentals of queueing theory, section 5.1.8)."""
    j = np.arange(k + 1)
    arrive = np.exp(-load + j * math.log(load) - np.array([math.lgamma(i + 1) for i in j]))
    step = np.zeros((k, k))
    for i in range(k):
        left = max(i - 1, 0)
        step[i, left : k - 1] = arrive[: k - 1 - left]
        step[i, k - 1] = 1.0 - step[i, : k - 1].sum()
    equations = np.vstack([(step.T - np.eye(k))[:-1], np.ones(k)])
    pi = np.linalg.solve(equations, np.append(np.zeros(k - 1), 1.0))
    lost = 1.0 - 1.0 / (pi[0] + load)
    inside = float(np.arange(k) @ pi) / (pi[0] + load) + k * lost
    return inside / (load * (1.0 - lost)) - 1.0, 1.0 - lost


def empty_start_deficit(load, mean_square_wait, span):
    """By how much the mean wait over `span` from an empty queue on falls short of the stationary
    one: E[W²]/(2 (1 − ρ) span). (Started with work x, a queue has ∫ (x − idle time so far)⁺ more
    of it than from empty; idle time y takes y/(1 − ρ).)"""
    return mean_square_wait / (2.0 * (1.0 - load) * span)


def mean_square_wait(load, exponential):
    """E[W²] of M/D/1 or M/M/1: 2 E[W]² + λ E[S³]/(3 (1 − ρ)) (Takács)."""
    wait = m_m_1_wait(load) if exponential else m_d_1_wait(load)
    return 2.0 * wait * wait + load * (6.0 if exponential else 1.0) / (3.0 * (1.0 - load))


# --- A shared channel


def slotted_aloha(stations, probability):
    """Share of slots with exactly one frame: n p (1 − p)^(n − 1)."""
    return stations * probability * (1.0 - probability) ** (stations - 1)


def slotted_aloha_many(offered):
    """The same for infinitely many stations: G e^−G (Roberts 1975)."""
    return offered * np.exp(-offered)


def bianchi(stations, window=32, doublings=5):
    """(τ, p) of saturated carrier sense: the share of slots in which a station begins, and the
    probability that another one does, too (Bianchi 2000, equations 7 and 9)."""

    def begins(p):
        return 2.0 * (1.0 - 2.0 * p) / (
            (1.0 - 2.0 * p) * (window + 1.0)
            + p * window * (1.0 - (2.0 * p) ** doublings)
        )

    low, high = 0.0, 1.0
    for _ in range(200):  # 1 − (1 − τ(p))^(n − 1) falls in p
        p = 0.5 * (low + high)
        if p == 0.5:
            p += 1e-12
        if 1.0 - (1.0 - begins(p)) ** (stations - 1) > p:
            low = p
        else:
            high = p
    p = 0.5 * (low + high)
    return begins(p), p


def bianchi_share(stations, slot_s, payload_s, success_s, collision_s, window=32, doublings=5):
    """Share of time that carries payload which arrives (Bianchi 2000, equation 13)."""
    tau, _ = bianchi(stations, window, doublings)
    busy = 1.0 - (1.0 - tau) ** stations
    one = stations * tau * (1.0 - tau) ** (stations - 1)
    return one * payload_s / (
        (1.0 - busy) * slot_s + one * success_s + (busy - one) * collision_s
    )
