"""Tests of the figures of scenarios/radio: the closed forms against published values and second
ways to compute them, the studies' claims and scenarios against the closed forms, the figures for
what they say."""

import math
import os
import random
import tomllib
import unittest

import numpy as np

from radio_study import WithRadioDatabase  # first: it makes the scripts known

import aloha
import carrier_sense
import data
import delay
import distance
import radio_panels
import radio_theory as theory
import sharing
import stats

STUDIES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../scenarios/radio")


def toml(name):
    with open(os.path.join(STUDIES, name), "rb") as stream:
        return tomllib.load(stream)


class Propagation(unittest.TestCase):
    def test_frame_success_is_that_of_the_published_table(self):
        for snr, success in ((7, 0.018), (8, 0.235), (9, 0.668), (10, 0.922), (11, 0.989)):
            self.assertAlmostEqual(float(theory.frame_success(snr, 50)), success, delta=5e-4)

    def test_shadowing_of_a_step_gives_the_normal_law(self):
        # Very long frames: success is a step at the SNR where half of them get through.
        step = 14.6
        low, high = step - 2.0, step + 2.0
        for _ in range(100):
            middle = 0.5 * (low + high)
            below = theory.frame_success(middle, 10**7) < 0.5
            low, high = (middle, high) if below else (low, middle)
        for offset in (-6.0, -1.0, 0.0, 3.0):
            mean = theory.shadowed_success(low + offset, 10**7, 4.0)
            normal = 0.5 * math.erfc(-offset / 4.0 / math.sqrt(2.0))
            self.assertAlmostEqual(mean, normal, delta=0.01)

    def test_the_quadrature_agrees_with_draws(self):
        draws = np.random.Generator(np.random.PCG64(1)).normal(0.0, 4.0, 200_000)
        mean = theory.frame_success(8.0 - draws, 50).mean()
        self.assertAlmostEqual(theory.shadowed_success(8.0, 50, 4.0), mean, delta=4 * 0.5 / 447)


def lindley(load, exponential, packets, room=None, seed=1):
    """(mean wait, share that gets in, waits squared) of a queue, packet by packet."""
    dice = random.Random(seed)
    now, leaves, waits, square, refused = 0.0, [], 0.0, 0.0, 0
    free = 0.0
    for _ in range(packets):
        now += dice.expovariate(load)
        leaves = [t for t in leaves if t > now] if room else leaves
        if room and len(leaves) >= room:
            refused += 1
            continue
        wait = max(free - now, 0.0)
        free = now + wait + (dice.expovariate(1.0) if exponential else 1.0)
        if room:
            leaves.append(free)
        waits += wait
        square += wait * wait
    inside = packets - refused
    return waits / inside, inside / packets, square / inside


class Queues(unittest.TestCase):
    def test_a_queue_with_endless_room_is_the_unbounded_one(self):
        for load in (0.3, 0.8):
            for bounded, wait in (
                (theory.m_d_1_k, theory.m_d_1_wait), (theory.m_m_1_k, theory.m_m_1_wait),
            ):
                found, share = bounded(load, 100)
                self.assertAlmostEqual(found, wait(load), delta=1e-6)
                self.assertAlmostEqual(share, 1.0, delta=1e-6)

    def test_room_for_the_one_in_service_alone_is_erlangs_loss(self):
        for load in (0.2, 1.0, 3.0):
            for bounded in (theory.m_d_1_k, theory.m_m_1_k):
                wait, share = bounded(load, 1)
                self.assertAlmostEqual(wait, 0.0, places=12)
                self.assertAlmostEqual(share, 1.0 / (1.0 + load), places=12)

    def test_bounded_queues_agree_with_lindleys_recursion(self):
        for exponential, bounded in ((False, theory.m_d_1_k), (True, theory.m_m_1_k)):
            wait, share, _ = lindley(0.9, exponential, 100_000, room=8)
            self.assertAlmostEqual(wait / bounded(0.9, 8)[0], 1.0, delta=0.03)
            self.assertAlmostEqual(share, bounded(0.9, 8)[1], delta=0.005)

    def test_mean_square_waits_agree_with_lindleys_recursion(self):
        for exponential in (False, True):
            square = lindley(0.5, exponential, 200_000)[2]
            expected = theory.mean_square_wait(0.5, exponential)
            self.assertAlmostEqual(square / expected, 1.0, delta=0.06)

    def test_an_empty_start_costs_what_its_closed_form_says(self):
        # Many short runs: mean work in [0, span) of M/M/1, seen by Poisson arrivals.
        load, span, runs = 0.5, 30.0, 8000
        dice = random.Random(3)
        total = count = 0.0
        for _ in range(runs):
            now, free = 0.0, 0.0
            while True:
                now += dice.expovariate(load)
                if now >= span:
                    break
                total += max(free - now, 0.0)
                count += 1.0
                free = max(free, now) + dice.expovariate(1.0)
        # By arrivals, whose number varies little: Wald's ratio is off by less than the tolerance.
        short = theory.m_m_1_wait(load) - total / (load * span * runs)
        expected = theory.empty_start_deficit(load, theory.mean_square_wait(load, True), span)
        self.assertAlmostEqual(short, expected, delta=0.25 * expected)


def countdowns(stations, window, doublings, stands_still, slots):
    """(share of slots in which a station begins, share of what begins that collides), slot by slot.
    A busy time counts as a slot, as Bianchi has it, or countdowns stand still meanwhile."""
    dice = random.Random(7)
    stage, counter = [0] * stations, [dice.randrange(window) for _ in range(stations)]
    begun = collided = 0
    for _ in range(slots):
        ready = [i for i in range(stations) if counter[i] == 0]
        if not (ready and stands_still):
            counter = [c - 1 for c in counter]
        begun += len(ready)
        collided += len(ready) if len(ready) > 1 else 0
        for i in ready:
            stage[i] = min(stage[i] + 1, doublings) if len(ready) > 1 else 0
            counter[i] = dice.randrange(window << stage[i])
    return begun / slots / stations, collided / begun


class Channels(unittest.TestCase):
    def test_the_collision_probabilities_are_the_published_ones(self):
        for n, p in ((2, 0.057), (5, 0.178), (10, 0.290), (20, 0.399), (50, 0.532)):
            self.assertAlmostEqual(theory.bianchi(n)[1], p, delta=5e-4)

    def test_a_station_alone_waits_half_a_window(self):
        self.assertAlmostEqual(theory.bianchi(1)[0], 2.0 / 33.0, places=12)
        share = theory.bianchi_share(1, 50e-6, 8e-3, 9e-3, 1.0)
        self.assertAlmostEqual(share, 8e-3 / (9e-3 + 15.5 * 50e-6), places=12)

    def test_bianchis_chain_agrees_with_its_own_draws(self):
        tau, p = theory.bianchi(5)
        begun, collided = countdowns(5, 32, 5, stands_still=False, slots=60_000)
        self.assertAlmostEqual(begun, tau, delta=0.03 * tau)
        self.assertAlmostEqual(collided, p, delta=0.05 * p)

    def test_a_countdown_that_stands_still_collides_less_where_windows_are_short(self):
        # What the study finds at 20 stations and a window of 16: 4 % less than Bianchi.
        _, p = theory.bianchi(20, 16, 6)
        _, collided = countdowns(20, 16, 6, stands_still=True, slots=60_000)
        self.assertAlmostEqual(collided / p, 0.96, delta=0.02)

    def test_aloha_of_many_stations_is_the_limit(self):
        self.assertAlmostEqual(theory.slotted_aloha(10**6, 1e-6), 1.0 / math.e, places=6)
        self.assertAlmostEqual(theory.slotted_aloha_many(1.0), 1.0 / math.e, places=12)
        self.assertEqual(theory.slotted_aloha(2, 0.5), 0.5)


class Intervals(unittest.TestCase):
    def test_t_quantiles_are_those_of_the_tables(self):
        for p, degrees, x in (
            (0.975, 1, 12.7062), (0.975, 9, 2.262157), (0.975, 19, 2.093024), (0.995, 5, 4.032143),
        ):
            self.assertAlmostEqual(stats.t_quantile(p, degrees), x, delta=1e-4 * x)

    def test_the_interval_of_a_mean_leaves_out_what_is_undefined(self):
        mean, half = stats.mean_interval([1.0, 2.0, 3.0, math.nan])
        self.assertAlmostEqual(mean, 2.0)
        self.assertAlmostEqual(half, 4.302653 / math.sqrt(3.0), places=4)
        self.assertTrue(math.isnan(stats.mean_interval([5.0])[1]))
        self.assertTrue(math.isnan(stats.mean_interval([])[0]))


class Claims(unittest.TestCase):
    """The bounds of the studies are the closed forms, give or take what the claim says."""

    def bounds(self, study):
        """(metric, where, low, high) of the claims with two bounds."""
        for claim in toml(study)["claims"]:
            expect = claim["expect"]
            if "within" in expect:
                yield expect["metric"], expect["where"], *expect["within"]

    def agree(self, low, high, value, half):
        """Bounds are written with four digits."""
        self.assertAlmostEqual(low, value - half, delta=1e-3 * value + 1e-9)
        self.assertAlmostEqual(high, value + half, delta=1e-3 * value + 1e-9)

    def test_distance(self):
        tolerances = {"grey-zone": 0.01, "log-distance": 0.01, "shadowed": 0.05}
        checked = 0
        for metric, where, low, high in self.bounds("character-distance.study.toml"):
            self.assertEqual(metric, "delivery_ratio")
            value = distance.MODELS[where["model"]][1](where["distance_m"])
            self.agree(low, high, value, tolerances[where["model"]])
            checked += 1
        self.assertEqual(checked, 12)

    def test_delay(self):
        checked = 0
        for metric, where, low, high in self.bounds("character-delay.study.toml"):
            load = where["load"]
            wait, share = delay.wait_and_share(where["sizes"], where["queue"], load)
            if metric == "delivery_ratio":
                self.agree(low, high, share, 0.005)
            elif metric == "delay_mean_s":
                self.agree(low, high, (wait + 1.0) * 1e-3, 0.01 * (wait + 1.0) * 1e-3)
            else:
                tolerance = {0.95: 0.1, 0.9: 0.05}.get(load, 0.02)
                tolerance = tolerance if where["queue"] == "unbounded" else 0.02
                self.agree(low, high, wait * 1e-3, tolerance * wait * 1e-3)
            checked += 1
        self.assertEqual(checked, 17)

    def test_aloha(self):
        unit = radio_panels.PAYLOAD_S * radio_panels.RATE_BPS / radio_panels.FRAME_S
        values = []
        for metric, where, low, high in self.bounds("character-aloha.study.toml"):
            self.assertEqual(metric, "goodput_bps")
            value = theory.slotted_aloha(where["stations"], where["probability"]) * unit
            if (low + high) / 2.0 < 0.995 * value:  # the claim about 1/e
                self.agree(low, high, unit / math.e, 0.03 * unit / math.e)
            else:
                self.agree(low, high, value, 0.02 * value)
            values.append(value)
        self.assertEqual(len(values), 7)

    def test_carrier_sense(self):
        checked = 0
        for metric, where, low, high in self.bounds("character-carrier-sense.study.toml"):
            n = where["stations"]
            if metric == "goodput_bps":
                value = carrier_sense.share(n, where["window"]) * radio_panels.RATE_BPS
                self.agree(low, high, value, (0.005 if n == 1 else 0.02) * value)
            else:
                value = 1.0 / (1.0 - theory.bianchi(n)[1])
                self.agree(low, high, value, 0.05 * value)
            checked += 1
        self.assertEqual(checked, 15)

    def test_sharing(self):
        unit = radio_panels.PAYLOAD_S * radio_panels.RATE_BPS / radio_panels.FRAME_S
        checked = 0
        for metric, where, low, high in self.bounds("character-sharing.study.toml"):
            self.assertEqual(metric, "goodput_bps")
            loads = where["load"] if isinstance(where["load"], list) else [where["load"]]
            for load in loads:
                value = sharing.arrives(where["model"], load) * unit
                tolerance = 0.03 if where["model"] == "slotted-aloha" else 0.02
                self.agree(low, high, value, tolerance * value)
                checked += 1
        self.assertEqual(checked, 8)


class Scenarios(unittest.TestCase):
    """The numbers that the scripts share with the scenario files."""

    def test_frames_slots_and_spaces_are_those_of_the_scenario(self):
        scenario = toml("shared.toml")
        radio, traffic = scenario["radio"], scenario["agents"][1]["traffic"]
        shared, answer = radio["sharing"], radio["acknowledgement"]
        bit_s = 1.0 / radio["rate_bps"]
        frame_s = 8 * (traffic["bytes"] + radio["header_bytes"]) * bit_s
        self.assertEqual(radio["rate_bps"], radio_panels.RATE_BPS)
        self.assertAlmostEqual(8 * traffic["bytes"] * bit_s, radio_panels.PAYLOAD_S, places=12)
        self.assertAlmostEqual(frame_s, radio_panels.FRAME_S, places=12)
        self.assertEqual(shared["slot_s"], radio_panels.SLOT_S)
        exchange_s = shared["interframe_s"] + frame_s + answer["interframe_s"]
        exchange_s += 8 * answer["bytes"] * bit_s
        self.assertAlmostEqual(exchange_s, radio_panels.EXCHANGE_S, places=12)
        self.assertEqual(shared["window_max"], carrier_sense.WINDOW_MAX)
        self.assertEqual(shared["window_min"], sharing.WINDOW)
        self.assertEqual(scenario["agents"][1]["count"], sharing.STATIONS)

    def test_a_slot_of_aloha_is_a_frame_and_a_load_of_sharing_is_frames_a_frame_time(self):
        aloha_slot_s = toml("character-aloha.study.toml")["set"]["radio.sharing"]["slot_s"]
        self.assertAlmostEqual(aloha_slot_s, radio_panels.FRAME_S, places=12)
        for point in toml("character-sharing.study.toml")["axes"]["load"]["points"]:
            period_s = point["set"]["agents[1].traffic.period_s"]
            load = sharing.STATIONS * radio_panels.FRAME_S / period_s
            self.assertAlmostEqual(load, point["label"], places=6)

    def test_packets_of_the_delay_study_take_what_the_script_says(self):
        scenario = toml("delay.toml")
        service_s = 8 * scenario["agents"][0]["traffic"]["bytes"] / scenario["radio"]["rate_bps"]
        self.assertAlmostEqual(1e3 * service_s, delay.SERVICE_MS, places=12)
        for point in toml("character-delay.study.toml")["axes"]["load"]["points"]:
            load = service_s / point["set"]["agents[0].traffic.period_s"]
            self.assertAlmostEqual(load, point["label"], places=6)

    def test_the_models_of_the_distance_study_are_those_of_the_script(self):
        traffic = toml("distance.toml")["agents"][0]["traffic"]
        self.assertEqual(traffic["bytes"], distance.FRAME_BYTES)
        points = toml("character-distance.study.toml")["axes"]["model"]["points"]
        models = {p["label"]: p["set"]["radio.propagation"] for p in points}
        self.assertEqual(list(models), list(distance.MODELS))
        self.assertEqual(models["disk"]["range_m"], 50.0)
        self.assertEqual((models["grey-zone"]["inner_m"], models["grey-zone"]["outer_m"]), (25, 75))
        self.assertEqual(models["shadowed"]["shadowing_sigma_db"], distance.SIGMA_DB)


class Figures(WithRadioDatabase):
    def test_each_figure_names_what_it_shows_and_is_the_same_twice(self):
        for script, make, said in (
            ("distance.py", self.distance, ("disk, 50 m", "Shadowing", "mean over links")),
            ("delay.py", self.delay, ("M/D/1/8", "M/M/1", "share dropped")),
            ("aloha.py", self.aloha, ("2 stations", "50 stations", "1/e")),
            ("carrier_sense.py", self.carrier_sense, ("window 16 … 1024", "Bianchi 2000")),
            ("sharing.py", self.sharing, ("slotted ALOHA", "carrier sense", "Delay")),
        ):
            if os.path.exists(self.file):
                os.remove(self.file)
            make()
            text = self.draw(script, "a.svg").decode()
            for words in (*said, "3\u00a0repetitions"):
                self.assertTrue(words in text, f"{script} does not say {words!r}")
            self.assertTrue(text == self.draw(script, "b.svg").decode(), script)

    def test_nobody_in_reach_hears_nothing(self):
        self.distance()
        rows = distance.delivered(self.chosen(), "disk", ["30", "80"])
        np.testing.assert_allclose(rows, [[0.99, 1.0, 1.01], [0.0, 0.0, 0.0]])

    def test_links_have_shares_of_their_own(self):
        self.distance()
        np.testing.assert_allclose(self.chosen().link_shares(0), [0.75, 0.0])

    def test_goodput_becomes_successes_a_slot(self):
        self.aloha()
        np.testing.assert_allclose(aloha.successes(self.chosen(), 0), [0.2475, 0.25, 0.2525])

    def test_collisions_are_frames_that_do_not_arrive(self):
        self.carrier_sense()
        np.testing.assert_allclose(carrier_sense.collisions(self.chosen()), 0.2)

    def test_another_study_is_refused_by_what_it_lacks(self):
        self.aloha()
        self.assertIn("choose one stations", self.refused("sharing.py", self.file, "x.png"))
        for ask, said in (
            (lambda: self.chosen().agent("sender"), "no agent 'sender'"),
            (lambda: self.chosen().scalar_of("frames", 0), "no scalar 'frames' of agent 0"),
        ):
            with self.assertRaises(data.UserError) as caught:
                ask()
            self.assertIn(said, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
