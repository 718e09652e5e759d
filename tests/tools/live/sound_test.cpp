// Which messages may be fused at all: of each form, sound ones and each kind of unsound ones.
#include <gtest/gtest.h>

#include <limits>

#include "agents/estimator_agent.hpp"
#include "agents/trail_message.hpp"
#include "filters/gaussian/message_forms.hpp"
#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/grid/codec.hpp"
#include "filters/trails/codec.hpp"
#include "tools/live/air.hpp"

namespace hearsay::fleet {
namespace {

using gaussian::Belief;
using gaussian::MessageForm;
using Bytes = std::vector<std::byte>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

Belief sound_belief() {
  Belief belief = Belief::unknown(2);
  belief.omega << 4.0, 1.0, 1.0, 3.0;
  belief.xi << 1.0, -2.0;
  return belief;
}

struct Parts {
  Belief belief = sound_belief();
  Belief fresh = [] {
    Belief part = sound_belief();
    return part *= 0.25;
  }();
};

/// Of two beliefs, of which the second is of these parts.
Bytes message_of(MessageForm form, bool moving, const Parts& parts) {
  gaussian::StampedMessage message{.stamp = 5, .message = {.incarnation = 0, .count = 1}};
  message.message.beliefs = {{0, sound_belief()}, {1, parts.belief}};
  gaussian::MessageExtras extras{.degree = 2, .fresh = {Parts().fresh, parts.fresh}, .bits = 8};
  if (form == MessageForm::quantised) {
    const auto quantised = gaussian::quantise(sound_belief(), 8);
    extras.quantised = {quantised.value(), quantised.value()};
  }
  Bytes bytes;
  if (moving) {
    encode(form, message, extras, bytes);
  } else {
    encode(form, message.message, extras, bytes);
  }
  return bytes;
}

struct Case {
  MessageForm form;
  bool moving;
  Tongue tongue() const {
    return {message_kind(form), moving ? live::States::moving : live::States::still};
  }
  bool sound(const Parts& parts) const {
    return is_sound(tongue(), message_of(form, moving, parts));
  }
};

std::vector<Case> cases(std::initializer_list<MessageForm> forms) {
  std::vector<Case> all;
  for (const MessageForm form : forms) {
    for (const bool moving : {false, true}) all.push_back({form, moving});
  }
  return all;
}

constexpr auto all_forms = {MessageForm::plain,  MessageForm::split,    MessageForm::consensus,
                            MessageForm::hybrid, MessageForm::diagonal, MessageForm::quantised};
constexpr auto with_numbers = {MessageForm::plain, MessageForm::split, MessageForm::consensus,
                               MessageForm::hybrid, MessageForm::diagonal};

TEST(Soundness, OfEachFormWholeMessagesAreSoundAndOthersNot) {
  for (const Case& one : cases(all_forms)) {
    SCOPED_TRACE(one.tongue().kind);
    Bytes bytes = message_of(one.form, one.moving, {});
    EXPECT_TRUE(is_sound(one.tongue(), bytes));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_FALSE(is_sound(one.tongue(), std::span(bytes).first(size)));
    }
    bytes.resize(bytes.size() + 8);
    EXPECT_FALSE(is_sound(one.tongue(), bytes));
    bytes.resize(std::size_t{1} << 20);
    EXPECT_FALSE(is_sound(one.tongue(), bytes));
  }
}

TEST(Soundness, NumbersMustBeFinite) {
  for (const Case& one : cases(with_numbers)) {
    SCOPED_TRACE(one.tongue().kind);
    for (const double bad : {nan, infinite, -infinite}) {
      Parts parts;
      parts.belief.xi(1) = bad;
      EXPECT_FALSE(one.sound(parts));
      parts = {};
      parts.belief.omega(0, 0) = bad;
      EXPECT_FALSE(one.sound(parts));
    }
  }
  for (const Case& one : cases({MessageForm::split, MessageForm::hybrid})) {
    SCOPED_TRACE(one.tongue().kind);
    Parts parts;
    parts.fresh.omega(1, 1) = nan;
    EXPECT_FALSE(one.sound(parts));
  }
  for (const Case& one : cases({MessageForm::hybrid})) {
    Parts parts;
    parts.fresh.xi(0) = nan;
    EXPECT_FALSE(one.sound(parts));
  }
}

TEST(Soundness, NoDirectionMayHoldNegativeInformation) {
  for (const Case& one : cases(with_numbers)) {
    SCOPED_TRACE(one.tongue().kind);
    Parts parts;
    parts.belief.omega << -1.0, 0.0, 0.0, 3.0;
    EXPECT_FALSE(one.sound(parts));
    if (one.form == MessageForm::diagonal) continue;
    parts.belief.omega << 1.0, 2.0, 2.0, 1.0;
    EXPECT_FALSE(one.sound(parts));
  }
}

TEST(Soundness, WhoKnowsNothingIsSound) {
  for (const Case& one : cases(with_numbers)) {
    SCOPED_TRACE(one.tongue().kind);
    Parts parts;
    parts.belief = Belief::unknown(2);
    parts.fresh = Belief::unknown(2);
    EXPECT_TRUE(one.sound(parts));
  }
}

TEST(Soundness, OfKindsThatNoCodecKnowsNobodyCanSay) {
  const Bytes some(3);
  EXPECT_TRUE(is_sound({"octets", live::States::still}, some));
  EXPECT_FALSE(is_sound({"gaussian", live::States::still}, some));
}

/// Three steps, each of which hangs together with the next by `link`.
gaussian::TrajectoryEntry trajectory(double link) {
  gaussian::TrajectoryEntry entry{.subject = 0, .first = 10};
  for (int k = 0; k < 3; ++k) {
    entry.steps.push_back({.stamp = 10 + k, .information = sound_belief()});
    if (k < 2 && link != 0.0) entry.steps.back().next = link * gaussian::Matrix::Identity(2, 2);
  }
  return entry;
}

bool sound(const gaussian::TrajectoryEntry& entry) {
  Bytes bytes;
  encode(gaussian::TrajectoryMessage{.incarnation = 0, .count = 1, .trajectories = {entry}}, bytes);
  return is_sound(Tongue{"gaussian", live::States::trajectory}, bytes);
}

TEST(Soundness, OfTrajectoriesEachStepMustBeSound) {
  for (const double link : {0.0, -0.5}) {
    EXPECT_TRUE(sound(trajectory(link)));
    gaussian::TrajectoryEntry entry = trajectory(link);
    entry.steps[1].information.xi(0) = nan;
    EXPECT_FALSE(sound(entry));
    entry = trajectory(link);
    entry.steps[2].information.omega(1, 1) = infinite;
    EXPECT_FALSE(sound(entry));
    entry = trajectory(link);
    entry.steps[0].information.omega(0, 0) = -1.0;
    EXPECT_FALSE(sound(entry));
    // What was measured may be nothing at some step.
    entry = trajectory(0.0);
    entry.steps[1].information = Belief::unknown(2);
    EXPECT_TRUE(sound(entry));
  }
  gaussian::TrajectoryEntry entry = trajectory(-0.5);
  entry.steps[0].next(1, 0) = nan;
  EXPECT_FALSE(sound(entry));
}

// Ω of three equal steps that hang together by c·I: eigenvalues are those of a step ± √2·c, and the
// least of (4 1; 1 3) is (7 − √5)/2 = 2.38, so that 1.6 is sound and 1.8 is not.
TEST(Soundness, OfWholeTrajectoriesAllStepsTogetherMustBe) {
  EXPECT_TRUE(sound(trajectory(1.6)));
  EXPECT_FALSE(sound(trajectory(1.8)));
  EXPECT_FALSE(sound(trajectory(-1.8)));
}

TEST(Soundness, WholeTrajectoriesAreChainsOfStepsOfOneDimension) {
  gaussian::TrajectoryEntry entry = trajectory(-0.5);
  entry.steps[2].stamp = entry.steps[1].stamp;
  EXPECT_FALSE(sound(entry));
  entry = trajectory(-0.5);
  entry.steps[1].next.resize(0, 0);
  EXPECT_FALSE(sound(entry));
  entry = trajectory(-0.5);
  entry.steps[2].next = gaussian::Matrix::Identity(2, 2);
  EXPECT_FALSE(sound(entry));
  entry = trajectory(-0.5);
  entry.steps[2].information = Belief::unknown(3);
  EXPECT_FALSE(sound(entry));
}

/// A track of two steps and the present, as trackers tell it.
Bytes trails_of(double first_omega, double now_omega, gaussian::Stamp second = 20) {
  const gaussian::Matrix one = gaussian::Matrix::Identity(2, 2);
  gaussian::Trajectory trail(2, 10);
  Belief step = Belief::unknown(2);
  step.omega = 2.0 * one;
  trail.update(0, step);
  trail.append(20, -0.5 * one, step);
  Belief now = Belief::unknown(2);
  now.omega = now_omega * one;
  gaussian::TrajectoryMessage message;
  const std::vector<tracking::Report> reports{{7, now, trail}};
  put_tracks(reports, 30, message);
  message.trajectories[0].steps[0].information.omega(0, 0) = first_omega;
  message.trajectories[0].steps[1].stamp = second;
  Bytes bytes;
  gaussian::encode(message, bytes);
  return bytes;
}

TEST(Soundness, TracksWithTrailsAreSound) {
  const Tongue trails{"trails", live::States::moving};
  EXPECT_TRUE(is_sound(trails, trails_of(2.0, 1.0)));
  EXPECT_FALSE(is_sound(trails, trails_of(-3.0, 1.0)));
  EXPECT_FALSE(is_sound(trails, trails_of(2.0, -1.0)));
  EXPECT_FALSE(is_sound(trails, trails_of(nan, 1.0)));
  EXPECT_FALSE(is_sound(trails, trails_of(2.0, infinite)));
  EXPECT_FALSE(is_sound(trails, Bytes(20)));
}

TEST(Soundness, TracksAndPositionsAreBeliefsOfStates) {
  for (const char* kind : {"tracks", "position"}) {
    const Tongue tongue{kind, live::States::moving};
    EXPECT_TRUE(is_sound(tongue, message_of(MessageForm::plain, true, {})));
    Parts parts;
    parts.belief.omega(0, 0) = -1.0;
    EXPECT_FALSE(is_sound(tongue, message_of(MessageForm::plain, true, parts)));
    EXPECT_FALSE(is_sound(tongue, Bytes(20)));
  }
}

TEST(Soundness, GridsAreOfTheAreasShapeAndFinite) {
  const Tongue tongue{.kind = "grid", .cells = 6, .layers = 1};
  const std::vector<float> evidence{1.0F, 2.0F, 3.0F, -1.0F, 0.0F, 0.5F};
  grid::Encoder encoder;
  for (const grid::Form form : {grid::Form::whole, grid::Form::runs}) {
    grid::Encoder::Message message;
    message.evidence = evidence;
    message.form = form;
    const auto packets = encoder.encode(message, {6, 1}, 1400);
    ASSERT_EQ(packets.size(), 1U);
    Bytes bytes = packets[0];
    EXPECT_TRUE(is_sound(tongue, bytes));
    EXPECT_FALSE(is_sound({.kind = "grid", .cells = 6, .layers = 2}, bytes));
    EXPECT_FALSE(is_sound({.kind = "grid", .cells = 5, .layers = 1}, bytes));
    bytes[24] = std::byte{7};  // a form that is none
    EXPECT_FALSE(is_sound(tongue, bytes));
    bytes = packets[0];
    for (std::size_t k = 1; k <= 4; ++k) bytes[bytes.size() - k] = std::byte{0xff};  // NaN
    EXPECT_FALSE(is_sound(tongue, bytes));
    bytes.pop_back();
    EXPECT_FALSE(is_sound(tongue, bytes));
  }
}

TEST(Soundness, TrailsOfRobotsAreWellFormed) {
  const Tongue tongue{.kind = "trail"};
  trails::MetricEncoder encoder;
  const trails::Crumb crumb{.event = 1, .position = {1.0F, 2.0F}, .distance_s = 3.0F};
  trails::MetricEncoder::Message message;
  message.sender = 1;
  message.crumbs = {&crumb, 1};
  const auto packets = encoder.encode(message, 1400);
  ASSERT_EQ(packets.size(), 1U);
  Bytes bytes = packets[0];
  EXPECT_TRUE(is_sound(tongue, bytes));
  for (std::size_t k = 1; k <= 4; ++k) bytes[bytes.size() - k] = std::byte{0xff};  // NaN
  EXPECT_FALSE(is_sound(tongue, bytes));
  bytes.resize(bytes.size() - 4);
  EXPECT_FALSE(is_sound(tongue, bytes));
}

}  // namespace
}  // namespace hearsay::fleet
