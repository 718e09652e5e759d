// Capture, jammers and reach among radios that move: when fates switch, from geometry, and whole
// fleets frame by frame.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "tests/net/fleet.hpp"

namespace hearsay {
namespace {

constexpr double rate_bps = 8e6;  // a byte a µs
constexpr Duration slot = 1_ms, period = 100_ms;
constexpr std::size_t frame_bytes = 1000;  // a slot long
constexpr double infinity = std::numeric_limits<double>::infinity();

// Strong enough that every frame without a disturbance is heard for certain.
Propagation certain_log_distance(double exponent, double range_m, double sigma_db = 0.0) {
  return Propagation::log_distance({.exponent = exponent,
                                    .shadowing_sigma_db = sigma_db,
                                    .transmit_dbm = 100.0,
                                    .range_m = range_m});
}

RadioOptions shared(const Propagation& propagation, double capture_db) {
  return {.rate_bps = rate_bps,
          .half_duplex = true,
          .access = {.sharing = Sharing::slotted_aloha, .slot = slot},
          .capture_db = capture_db,
          .propagation = propagation};
}

std::unique_ptr<Motion> hover(double x_m, double y_m = 0.0) {
  return motion::make(motion::Hover{.position_m = {x_m, y_m}});
}
std::unique_ptr<Motion> drive(motion::PlanePoint from_m, motion::PlanePoint to_m, double speed) {
  return motion::make(motion::Waypoints{.points_m = {from_m, to_m}, .speed_m_per_s = speed});
}

// Fates at a receiver of what a sender sent, by when the frame began.
std::map<double, std::string> fates(const Fleet& fleet, AgentId sender, AgentId receiver) {
  std::map<double, std::string> by_s;
  for (const MessageRow& row : fleet.rows()) {
    if (row.sender != sender || row.receiver != receiver) continue;
    by_s[row.sent.seconds()] = fleet.fate_of(row);
  }
  return by_s;
}

TEST(RadioMoving, BetweenTwoSendersTheNearerIsHeardByTheRatioOfDistances) {
  // Agents 0 and 1 stand 400 m apart and send at the same times; 2 drives from one to the other.
  // At x it hears 0 if (400 − x)^n ≥ R x^n, where R is the ratio of powers: x ≤ 400/(1 + R^(1/n)).
  // A disk knows no powers, and takes n = 2.
  constexpr double apart_m = 400.0, speed = 10.0;
  for (const double exponent : {2.0, 3.0, 0.0}) {
    for (const double capture_db : {0.0, 6.0, 15.0, infinity}) {
      for (const bool addressed : {false, true}) {
        SCOPED_TRACE(testing::Message() << exponent << ", " << capture_db << " dB");
        const Propagation propagation =
            exponent > 0.0 ? certain_log_distance(exponent, 500.0) : Propagation::disk(500.0);
        Fleet fleet(
            3,
            [](AgentId a) {
              return a == 2 ? drive({0.5, 0.0}, {apart_m - 0.7, 0.0}, speed)
                            : hover(a == 0 ? 0.0 : apart_m);
            },
            shared(propagation, capture_db), Time::at(40_s));
        for (int k = 0; k < 390; ++k) {
          for (const AgentId a : {0, 1}) {
            fleet.send(period * k, a, frame_bytes, addressed ? 2 : no_agent);
          }
        }
        fleet.run();
        const double n = exponent > 0.0 ? exponent : 2.0;
        const double edge_m = apart_m / (1.0 + std::pow(10.0, capture_db / (10.0 * n)));
        std::map<std::string, int> seen;
        for (const AgentId sender : {0, 1}) {
          const auto at = fates(fleet, sender, 2);
          ASSERT_EQ(at.size(), 390u);
          for (const auto& [t_s, fate] : at) {
            const double x_m = 0.5 + speed * t_s;
            const bool heard = sender == 0 ? x_m <= edge_m : apart_m - x_m <= edge_m;
            EXPECT_EQ(fate, heard ? "delivered" : "collided") << "at " << x_m << " m";
            ++seen[fate];
          }
        }
        EXPECT_GT(capture_db < infinity ? seen["delivered"] : 1, 0);
        EXPECT_GT(capture_db > 0.0 ? seen["collided"] : 1, 0);
      }
    }
  }
}

TEST(RadioMoving, WhoDrivesPastAJammerIsDeafWithinItsRadiusWhileItIsOn) {
  // Along y = 30 past a jammer at (0, 0) of 50 m: |x| ≤ 40, which at 10 m/s from −100 m is from 6 s
  // to 14 s, but for the time before 7.25 s, when it is off.
  RadioOptions options{.rate_bps = rate_bps, .propagation = Propagation::disk(1000.0)};
  options.jammers = {{.radius_m = 50.0, .from = Time::at(7250_ms)}};
  Fleet fleet(
      2,
      [](AgentId a) {
        return a == 0 ? hover(0, 500) : drive({-100, 30}, {100, 30}, 10);
      },
      options, Time::at(20_s));
  for (int k = 0; k < 199; ++k) {
    fleet.send(period * k, 0, frame_bytes);
    fleet.send(period * k, 1, frame_bytes);
  }
  fleet.run();
  for (const auto& [t_s, fate] : fates(fleet, 0, 1)) {
    // Judged where it is when the last bit arrives; on at any time of the frame.
    const double x_m = -100.0 + 10.0 * (t_s + 1e-3);
    const bool near = std::abs(x_m) <= 40.0, on = t_s + 1e-3 >= 7.25;
    EXPECT_EQ(fate, near && on ? "jammed" : "delivered") << "at " << t_s << " s";
  }
  for (const auto& [t_s, fate] : fates(fleet, 1, 0)) {
    EXPECT_EQ(fate, "delivered") << "it is the receiver that is jammed, not the sender";
  }
}

TEST(RadioMoving, AJammersPowerIsNoiseWhereTheReceiverIsNow) {
  // Agent 1 drives past a jammer of the power of a radio. Frame k is heard if its named uniform is
  // below (1 − ½e^(−γ/1.28))^bits, with γ the signal over noise and jammer; else it is jammed.
  constexpr double exponent = 2.5, reference_db = 40.0, signal_dbm = 20.0, noise_dbm = -95.0;
  constexpr double jammer_dbm = 3.0;
  constexpr std::size_t bytes = 50;
  const auto power_mw = [&](double dbm, double distance_m) {
    return std::pow(10.0, (dbm - reference_db) / 10.0) * std::pow(distance_m, -exponent);
  };
  RadioOptions options{.rate_bps = rate_bps,
                       .propagation = Propagation::log_distance({.exponent = exponent,
                                                                 .reference_loss_db = reference_db,
                                                                 .transmit_dbm = signal_dbm,
                                                                 .noise_dbm = noise_dbm,
                                                                 .range_m = 1e4})};
  options.jammers = {{.position_m = {0.0, 40.0, 0.0}, .power_dbm = jammer_dbm}};
  std::map<std::string, int> seen;
  double expected_jammed = 0.0, variance = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Fleet fleet(
        2,
        [](AgentId a) {
          return a == 0 ? hover(0, -80) : drive({-100, 0}, {100, 0}, 10);
        },
        options, Time::at(20_s), seed);
    for (int k = 0; k < 199; ++k) fleet.send(period * k, 0, bytes);
    fleet.run();
    std::uint64_t n = 0;
    for (const auto& [t_s, fate] : fates(fleet, 0, 1)) {
      const double x_m = -100.0 + 10.0 * (t_s + 50e-6);
      const double ratio =
          power_mw(signal_dbm, std::hypot(x_m, 80.0)) /
          (std::pow(10.0, noise_dbm / 10.0) + power_mw(jammer_dbm, std::hypot(x_m, 40.0)));
      const double success = std::pow(1.0 - 0.5 * std::exp(-ratio / 1.28), 8.0 * bytes);
      const double u =
          Stream::at(seed, Purpose("reception of a packet"), Entity::link(0, 1), n++).uniform();
      EXPECT_EQ(fate, u < success ? "delivered" : "jammed") << "at " << x_m << " m";
      ++seen[fate];
      expected_jammed += 1.0 - success;
      variance += success * (1.0 - success);
    }
  }
  EXPECT_EQ(seen["delivered"] + seen["jammed"], 10 * 199);
  EXPECT_NEAR(seen["jammed"], expected_jammed, 4.0 * std::sqrt(variance));
  EXPECT_GT(variance, 50.0) << "there is no grey zone";
}

// What each frame of a slot meets at everybody, by brute force.
class FrameByFrame {
 public:
  FrameByFrame(Fleet& fleet, const RadioOptions& options, int agents, std::uint64_t seed)
      : fleet_(fleet), options_(options), agents_(agents), seed_(seed) {}

  // All slots in order of time; the number of frames of each fate.
  std::map<std::string, int> expect_all() {
    std::map<Time, std::map<AgentId, std::map<AgentId, std::string>>> slots;  // by their end
    for (const MessageRow& row : fleet_.rows()) {
      const auto [place, fresh] =
          slots[row.arrived][row.sender].emplace(row.receiver, fleet_.fate_of(row));
      EXPECT_TRUE(fresh) << "a second fate";
    }
    std::map<std::string, int> seen;
    for (const auto& [end, senders] : slots) {
      std::vector<Point> begins, ends;
      for (AgentId a = 0; a < agents_; ++a) begins.push_back(fleet_.at(a, end - slot));
      for (AgentId a = 0; a < agents_; ++a) ends.push_back(fleet_.at(a, end));
      for (const auto& [sender, got] : senders) {
        for (AgentId hearer = 0; hearer < agents_; ++hearer) {
          const std::string expected = fate(sender, hearer, senders, begins, ends, end);
          const auto found = got.find(hearer);
          EXPECT_EQ(found == got.end() ? "" : found->second, expected)
              << sender << " → " << hearer << " at " << end.seconds() << " s";
          ++seen[expected];
        }
      }
    }
    return seen;
  }

 private:
  double distance_m(const std::vector<Point>& at, AgentId a, AgentId b) const {
    return std::sqrt(
        squared_distance_m2(at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)]));
  }
  double received_db(const std::vector<Point>& at, AgentId a, AgentId b) const {
    return -30.0 * std::log10(std::max(distance_m(at, a, b), 1.0)) -
           options_.propagation.shadowing_db(seed_, a, b);
  }
  template <class Senders>
  std::string fate(AgentId sender, AgentId hearer, const Senders& senders,
                   const std::vector<Point>& begins, const std::vector<Point>& ends, Time end) {
    const double reach_m = options_.propagation.reach_m();
    if (hearer == sender || distance_m(begins, sender, hearer) > reach_m) return "";
    if (senders.contains(hearer)) return "half_duplex";
    for (const Jammer& jammer : options_.jammers) {
      const bool on = jammer.from <= end && end - slot < jammer.until;
      const double d2 =
          squared_distance_m2(ends[static_cast<std::size_t>(hearer)], jammer.position_m);
      if (on && d2 <= *jammer.radius_m * *jammer.radius_m) return "jammed";
    }
    const double mine_db = received_db(begins, sender, hearer);
    for (const auto& [other, got] : senders) {
      if (other == sender || distance_m(begins, other, hearer) > reach_m) continue;
      if (mine_db < received_db(begins, other, hearer) + options_.capture_db) return "collided";
    }
    return "delivered";
  }

  Fleet& fleet_;
  const RadioOptions& options_;
  int agents_;
  std::uint64_t seed_;
};

TEST(RadioMoving, FleetsThatCaptureAndAreJammedMeetTheFatesOfTheirPlaces) {
  constexpr int agents = 14;
  constexpr motion::Rectangle field{{0.0, 0.0}, {600.0, 400.0}};
  std::map<std::string, int> seen;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    RadioOptions options = shared(certain_log_distance(3.0, 260.0, 5.0), seed % 2 ? 4.0 : 12.0);
    options.access.send_probability = 0.3;
    options.queue.packets_max = 1000;
    options.jammers = {
        {.position_m = {100.0, 100.0, 0.0}, .radius_m = 80.0, .until = Time::at(6_s)},
        {.position_m = {400.0, 300.0, 0.0}, .radius_m = 120.0, .from = Time::at(3_s)}};
    Fleet fleet(
        agents,
        [&](AgentId a) {
          return motion::make(
              motion::RandomWaypoint{
                  .area = field, .speed_min_m_per_s = 20.0, .speed_max_m_per_s = 90.0},
              seed, a);
        },
        options, Time::at(9_s), seed);
    Stream draw(seed, Purpose("talk"), Entity{0});
    for (AgentId a = 0; a < agents; ++a) {
      for (int k = 0; k < 60; ++k) {  // bursts of all, so that there is always somebody else
        const Duration at = 100_ms * static_cast<std::int64_t>(draw.below(88));
        fleet.send(at, a, frame_bytes);
      }
    }
    fleet.run();
    for (const auto& [fate, n] : FrameByFrame(fleet, options, agents, seed).expect_all()) {
      seen[fate] += n;
    }
  }
  EXPECT_GT(seen["delivered"], 5000);
  EXPECT_GT(seen["collided"], 3000);
  EXPECT_GT(seen["half_duplex"], 1000);
  EXPECT_GT(seen["jammed"], 500);
}

}  // namespace
}  // namespace hearsay
