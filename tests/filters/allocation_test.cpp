// Nothing that happens for a packet or a sample may allocate. Counted at malloc, which operator new
// and Eigen both end in.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

#include "filters/gaussian/codec.hpp"
#include "filters/gaussian/fusion.hpp"
#include "filters/gaussian/geolocation.hpp"
#include "filters/gaussian/nonlinear.hpp"
#include "filters/gaussian/trajectory_factor.hpp"
#include "filters/grid/camera_look.hpp"
#include "filters/grid/codec.hpp"
#include "filters/grid/fusion.hpp"
#include "filters/grid/gain.hpp"
#include "filters/grid/ledger.hpp"
#include "filters/grid/regions.hpp"
#include "filters/ledger/ledger.hpp"
#include "filters/trails/codec.hpp"
#include "filters/trails/frames.hpp"
#include "filters/trails/laying.hpp"
#include "tests/filters/gaussian/samples.hpp"

#if defined(__SANITIZE_ADDRESS__)
#define HEARSAY_COUNTS_MALLOC 0  // the sanitizer has a malloc of its own
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HEARSAY_COUNTS_MALLOC 0
#endif
#endif
#if !defined(HEARSAY_COUNTS_MALLOC) && defined(__GLIBC__)
#define HEARSAY_COUNTS_MALLOC 1
#endif

#if HEARSAY_COUNTS_MALLOC

namespace {
std::atomic<std::size_t> allocations{0};
}

extern "C" {
void* __libc_malloc(std::size_t size);
void* malloc(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
}

namespace hearsay::gaussian {
namespace {

template <typename Work>
std::size_t allocations_of(const Work& work) {
  const std::size_t before = allocations.load();
  work();
  return allocations.load() - before;
}

TEST(Allocation, IsCounted) {
  EXPECT_EQ(allocations_of([] { ::operator delete(::operator new(8)); }), 1u);
  EXPECT_GE(allocations_of([] { const Eigen::MatrixXd m = Eigen::MatrixXd::Zero(3, 3); }), 1u);
}

TEST(Allocation, DoesNotHappenInFusionRules) {
  Stream random = stream("allocation");
  for (int n = 1; n <= dimension_max; ++n) {
    const Belief a = random_belief(random, n);
    const Belief b = random_belief(random, n);
    Belief singular = a;
    singular.omega.row(0).setZero();
    singular.omega.col(0).setZero();
    BatchIntersection batch;
    const Matrix* const both[] = {&a.omega, &b.omega};
    batch.weights(both);
    EXPECT_EQ(allocations_of([&] { batch.weights(both); }), 0u) << n;
    for (const RuleInfo& row : rules()) {
      if (row.fuses == Fuses::at_once) continue;  // the storage is the batch's
      for (const auto& beliefs : {std::pair(&a, &b), {&a, &singular}, {&singular, &singular}}) {
        const Belief& x = *beliefs.first;
        const Belief& y = *beliefs.second;
        EXPECT_EQ(allocations_of([&] { fused(row.rule, x, y, Belief::unknown(n)); }), 0u)
            << row.name << n;
      }
    }
    EXPECT_EQ(allocations_of([&] { intersect_det(a.omega, b.omega); }), 0u) << n;
    EXPECT_EQ(allocations_of([&] { intersect_trace(a.omega, b.omega); }), 0u) << n;
  }
}

TEST(Allocation, DoesNotHappenInMetricsOfABelief) {
  Stream random = stream("allocation");
  for (int n = 1; n <= dimension_max; ++n) {
    const Belief a = random_belief(random, n);
    const Belief b = random_belief(random, n);
    Belief indefinite = a;
    indefinite.omega(0, 0) -= 2 * indefinite.omega.trace();
    const Vector truth = Vector::Zero(n);
    EXPECT_EQ(allocations_of([&] {
                Belief sum = a;
                sum += measurement_information(Matrix::Identity(n, n), b.omega, truth);
                sum -= b;
                definiteness(sum);
                state(indefinite);
                covariance(a);
                entropy_nats(a);
                kl_divergence_nats(a, b);
                nees(a, truth);
                claimed_sigma(a);
              }),
              0u)
        << n;
  }
}

TEST(Allocation, DoesNotHappenInAWarmCodec) {
  Stream random = stream("allocation");
  Message large{1, 2, {}};
  for (int i = 0; i < 15; ++i) large.beliefs.push_back({0, random_belief(random, 2)});
  Message small = large;
  small.beliefs.resize(3);
  Message back;
  std::vector<std::byte> bytes;
  EXPECT_GT(allocations_of([&] { encode(large, bytes); }), 0u);
  EXPECT_GT(allocations_of([&] { decode(bytes, back); }), 0u);
  for (const Message* message : {&small, &large}) {
    EXPECT_EQ(allocations_of([&] { encode(*message, bytes); }), 0u);
    EXPECT_EQ(allocations_of([&] { decode(bytes, back); }), 0u);
    EXPECT_EQ(back.beliefs.size(), message->beliefs.size());
  }
}

TEST(Allocation, DoesNotHappenInWarmTrajectories) {
  for (const int axes : {1, 2, 3}) {
    const int n = 2 * axes;
    const Transition move = white_noise_acceleration(axes, 1.0, 0.1);
    Belief seen = Belief::unknown(n);
    for (int i = 0; i < axes; ++i) seen.omega(i, i) = seen.xi(i) = 1.0 + i;
    Trajectory own(n, 0);
    own.update(0, seen);
    for (Stamp k = 1; k <= 20; ++k) own.augment(k, move);
    ASSERT_TRUE(own.marginalise(0));  // the window is full; what it needs while it slides, it has
    Trajectory other = own;
    for (int k = 0; k < other.steps(); ++k) other.update(k, seen);
    Trajectory heard = own;
    TrajectoryFactor factor;
    ASSERT_EQ(factor.factor(other), Definiteness::positive);
    factor.means();
    EXPECT_EQ(allocations_of([&] {
                own += other;
                own.intersect(0.4, other);
                heard = own;
                intersect_det(own, other);
                factor.factor(own);
                factor.means();
                own.augment(21, move);
                own.update(own.steps() - 1, seen);
                own.marginalise(0);
              }),
              0u)
        << n;
    EXPECT_EQ(own.stamps().front(), 2);
    EXPECT_EQ(own.stamps().back(), 21);
  }
}

TEST(Allocation, DoesNotHappenInLooks) {
  Terrain::Options options{.columns = 9, .rows = 9, .heights_m = std::vector<double>(81, 0.0)};
  options.spacing_m = 20.0;
  const Ground terrain = Terrain(std::move(options));
  const Look look{infrared_camera, looking({10, 80, 40}, 0.0, 0.9), vector({120.0, 160.0}),
                  look_covariance({0.5, 0.02, 1.0})};
  const BearingOnly bearing{{vector({0.0, 0.0}), 0.0}};
  const Belief prior = Belief::from_moments(vector({30.0, 20.0}), Matrix::Identity(2, 2));
  Stream random = stream("looks");
  int found = 0;
  EXPECT_EQ(allocations_of([&] {
              const Matrix S = Matrix::Identity(1, 1);
              const Vector z = Vector::Constant(1, 0.5);
              found += geolocate_linearised(look, terrain).has_value();
              found += geolocate_unscented(look, terrain).has_value();
              const auto normal = [&] { return random.normal(); };
              found += geolocate_sampled(look, terrain, 50, normal).y.has_value();
              found += extended_information(prior, bearing, z, S).information.has_value();
              found += unscented_information(prior, bearing, z, S, 1.0).information.has_value();
            }),
            0u);
  EXPECT_EQ(found, 5);
}

TEST(Allocation, DoesNotHappenInAWarmLedger) {
  MeasurementBook book(2);
  Ledger own;
  Ledger heard;
  Ledger common;
  for (int k = 0; k < 600; ++k) {
    const std::size_t index = book.add({Matrix::Identity(2, 2), Vector::Zero(2)});
    (k % 2 == 0 ? own : heard).measured(index);
  }
  own.combine(1, 1, heard, 0, nullptr);
  common = heard;
  Ledger copy = own;
  const Belief belief = book.weighted_sum(own.weights());
  EXPECT_EQ(allocations_of([&] {
              own.combine(0.5, 0.5, heard, 1, &common);
              common = own;
              copy = own;
              copy.clear();
              copy = own;
              multiplicity(own);
              true_covariance(belief.omega, own, book);
              reach_gap(belief, own, book);
            }),
            0u);
}

template <typename Grid>
void expect_no_allocation_in_fusion(Grid& own, bool grid::RuleInfo::*is_for) {
  const std::vector<float> received(own.evidence().size(), 1.5F);
  std::vector<grid::Shares> out(received.size());
  for (const grid::RuleInfo& row : grid::rules()) {
    if (!(row.*is_for)) continue;
    const grid::Heard heard{.received = received, .common = received};
    EXPECT_EQ(allocations_of([&] { grid::shares(row.rule, own, heard, 0.5, out); }), 0u)
        << row.name;
    EXPECT_EQ(allocations_of([&] { grid::fuse(row.rule, own, heard); }), 0u) << row.name;
  }
}

TEST(Allocation, DoesNotHappenInFusionAndMessagesOfGrids) {
  const grid::Area area({.columns = 40, .rows = 40});
  grid::BernoulliGrid bernoulli(area);
  grid::BetaGrid beta(area);
  expect_no_allocation_in_fusion(bernoulli, &grid::RuleInfo::bernoulli);
  expect_no_allocation_in_fusion(beta, &grid::RuleInfo::beta);
  const std::vector<float> sent(1600, 0.0F);
  std::vector<float> evidence = sent;
  for (std::size_t i = 0; i < evidence.size(); i += 3) evidence[i] = 1.0F;
  const grid::Shape shape{1600, 1};
  grid::Encoder encoder;
  for (const grid::Form form : {grid::Form::runs, grid::Form::changed, grid::Form::whole}) {
    const grid::Encoder::Message message{1, 2, form, evidence, sent};
    EXPECT_GT(encoder.encode(message, shape, 500).size(), 1u);
    std::size_t packets = 0;
    EXPECT_EQ(allocations_of([&] {
                for (const std::vector<std::byte>& bytes : encoder.encode(message, shape, 500)) {
                  grid::Packet::parse(bytes, shape)
                      ->for_each_range([&](int first, std::span<const float> values) {
                        grid::fuse(grid::Rule::naive, bernoulli, {first, values});
                      });
                  ++packets;
                }
              }),
              0u);
    EXPECT_GT(packets, 1u);
  }
}

TEST(Allocation, DoesNotHappenInLedgersOfGridsButForRowsThatAreSharedOrGrow) {
  const grid::Shape shape{400, 1};
  grid::LookLedger own(shape), heard(shape), sent(shape), last(shape);
  for (int cell = 0; cell < 400; ++cell) {
    own.looked(cell, 3);
    heard.looked(cell, 2);
    if (cell % 2 == 0) last.looked(cell, 1);
  }
  grid::LookLedger copy = own;
  const std::vector<grid::Shares> all(400, {1.0, 1.0, 1.0}), half(400, {0.5, 0.5, 0.0});
  const auto work = [&] {
    own.looked(7, 3);
    own.combine(0, all, heard, &last);
    own.combine(0, half, heard);
    sent.difference(own, last);
  };
  EXPECT_GT(allocations_of(work), 0u);  // of rows shared with the copy
  EXPECT_EQ(allocations_of([&] { copy = own; }), 0u);
  copy.clear();
  sent.clear();
  for (int cell = 0; cell < 400; ++cell) sent.looked(cell, 3);
  EXPECT_EQ(allocations_of([&] {
              own.looked(7, 3);
              own.combine(0, all, heard, &last);
              own.combine(0, half, heard);
              last.copy_range(0, 400, heard);
              sent.difference(own, last);
              copy = own;
            }),
            0u);
}

TEST(Allocation, DoesNotHappenInWarmLooksAtGrids) {
  const grid::Area area({.columns = 40, .rows = 40, .x_m = -20.0, .y_m = -20.0});
  grid::BernoulliGrid bernoulli(area);
  grid::CameraLook look({.lens = infrared_camera,
                         .width = 240,
                         .height = 320,
                         .detector = {0.9, 0.1},
                         .range_max_m = 80.0},
                        area);
  grid::SegmentedImage image(240, 320);
  image.mark(120, 160);
  const CameraPose pose = looking({0, 0, 20}, 0.0, 1.4);
  const Matrix covariance = look_covariance({0.3, 0.01, 0.0}).topLeftCorner(6, 6);
  std::vector<grid::CellLook> looks;
  std::vector<grid::CellInView> cells;
  grid::RegionFinder finder;
  double gain = 0.0;
  const auto work = [&] {
    look.look(pose, covariance);
    look.judge(image, looks);
    grid::add(looks, bernoulli);
    gain += grid::expected_gain(bernoulli, look.in_view());
    cells_in_view(grid::PresenceSensor{{0.9, 0.1}, 40.0, 0.4}, pose, area, cells);
    grid::presence_look(cells, true, looks);
    grid::add(looks, bernoulli);
    gain += static_cast<double>(finder.find(bernoulli, 0.5).size());
  };
  EXPECT_GT(allocations_of(work), 0u);
  EXPECT_EQ(allocations_of(work), 0u);
  EXPECT_GT(gain, 0.0);
}

/// A robot that lays, tells, hears and follows; each call is a round from A to B.
class TrailTeam {
 public:
  void go() {
    for (int step = 0; step < 100; ++step) {
      now_s_ += 1.0;
      const trails::Point at = trails::point(step, 0.1 * (round_ % 7));
      trail_.lay(now_s_, at);
      followed_ += store_.best(round_ % 2, {at, 2.5, trails::Field{0.0, 2.0}}, now_s_) != nullptr;
      store_.within(round_ % 2, {at, 2.0, {}}, now_s_, found_);
    }
    const trails::EventId event = ++round_ % 2;
    store_.merge(
        trails::Place{event, {99.0F * static_cast<float>(event), 0.0F}, now_s_, numbers_.take()},
        now_s_);
    for (const trails::Crumb& crumb : trail_.complete(event, now_s_, numbers_)) {
      store_.merge(crumb, now_s_);
    }
    news_.clear();
    store_.news(cursor_, {}, now_s_, news_);
    for (const auto& bytes : encoder_.encode({0, 0, round_, store_.places(), news_}, 500)) {
      hear(bytes);
    }
  }
  std::size_t followed() const { return followed_; }

 private:
  void hear(std::span<const std::byte> bytes) {
    const auto packet = trails::MetricPacket::parse(bytes);
    places_.clear();
    for (std::size_t i = 0; i < packet->places(); ++i) places_.push_back(packet->place(i));
    trails::common_places(places_, store_.places(), pairs_);
    const auto alignment = trails::align(pairs_, {.optimistic = true});
    for (std::size_t i = 0; i < packet->crumbs(); ++i) {
      trails::Crumb crumb = trails::mapped(packet->crumb(i), alignment->map);
      crumb.identity.robot = 1;  // as if from somebody else
      store_.merge(crumb, now_s_, 1);
    }
  }
  trails::MetricStore store_{{.robot = 0, .crumbs_max = 1000, .age_max_s = 300.0}};
  trails::TemporaryTrail<trails::Point> trail_{{.interval_s = 1.0}};
  trails::Numbering numbers_{0};
  trails::Cursor cursor_;
  trails::MetricEncoder encoder_;
  std::vector<trails::Crumb> news_, found_;
  std::vector<trails::Place> places_;
  std::vector<trails::PointPair> pairs_;
  double now_s_ = 0.0;
  std::uint32_t round_ = 0;
  std::size_t followed_ = 0;
};

TEST(Allocation, DoesNotHappenInWarmTrails) {
  TrailTeam team;
  EXPECT_GT(allocations_of([&] {
              for (int round = 0; round < 10; ++round) team.go();
            }),
            0u);
  const std::size_t followed = team.followed();
  EXPECT_EQ(allocations_of([&] {
              for (int round = 0; round < 10; ++round) team.go();
            }),
            0u);
  EXPECT_GT(team.followed(), followed);
}

}  // namespace
}  // namespace hearsay::gaussian

#endif
