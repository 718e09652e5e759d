#include "net/live/topics.hpp"

#include <gtest/gtest.h>

#include <set>

#include "filters/grid/codec.hpp"
#include "net/live/descriptors.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::live {
namespace {

std::string type_name(Type type) { return descriptor_of(type).m_typename; }

TopicId only(std::string_view kind, States states = States::still) {
  const auto topics = air_topics(kind, states);
  EXPECT_EQ(topics.size(), 1u) << kind;
  return topics.front();
}

TEST(Topics, EachTypeIsTheOneOfItsName) {
  EXPECT_EQ(type_name(hello_topic().type), "hearsay::Hello");
  EXPECT_EQ(type_name(welcome_topic().type), "hearsay::Welcome");
  EXPECT_EQ(type_name(order_topic().type), "hearsay::Frame");
  EXPECT_EQ(type_name(answer_topic().type), "hearsay::Frame");
  EXPECT_EQ(type_name(clock_topic().type), "hearsay::Clock");
  EXPECT_EQ(type_name(measurement_topic().type), "hearsay::Measurement");
  EXPECT_EQ(type_name(truth_topic().type), "hearsay::Truth");
  EXPECT_EQ(type_name(report_topic().type), "hearsay::Report");
  std::set<std::string> names;
  for (int type = 0; type < type_count; ++type) names.insert(type_name(static_cast<Type>(type)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(type_count));
}

TEST(Topics, AKindOfGaussianBeliefsHasOneForEachWayStatesAre) {
  const struct {
    const char* kind;
    const char* name;
    const char* type;
  } all[] = {{"gaussian", "gaussian", "Gaussian"},
             {"gaussian-split", "gaussian_split", "Split"},
             {"gaussian-consensus", "gaussian_consensus", "Consensus"},
             {"gaussian-hybrid", "gaussian_hybrid", "Hybrid"},
             {"gaussian-diagonal", "gaussian_diagonal", "Diagonal"},
             {"gaussian-quantised", "gaussian_quantised", "Quantised"}};
  for (const auto& [kind, name, type] : all) {
    const TopicId still = only(kind), moving = only(kind, States::moving);
    EXPECT_EQ(still.name, std::string("hearsay_air_") + name);
    EXPECT_EQ(type_name(still.type), std::string("hearsay::") + type + "Packet");
    EXPECT_EQ(moving.name, std::string("hearsay_air_") + name + "_moving");
    EXPECT_EQ(type_name(moving.type), std::string("hearsay::Stamped") + type + "Packet");
  }
  const TopicId window = only("gaussian", States::trajectory);
  EXPECT_EQ(window.name, "hearsay_air_gaussian_trajectory");
  EXPECT_EQ(type_name(window.type), "hearsay::TrajectoryPacket");
}

TEST(Topics, OtherKindsDoNotDependOnThat) {
  for (const States states : {States::still, States::moving, States::trajectory}) {
    EXPECT_EQ(only("position", states), (TopicId{Type::stamped_gaussian, "hearsay_air_position"}));
    EXPECT_EQ(only("tracks", states), (TopicId{Type::stamped_gaussian, "hearsay_air_tracks"}));
    EXPECT_EQ(only("trails", states), (TopicId{Type::trajectory, "hearsay_air_trails"}));
    EXPECT_EQ(only("trail", states), (TopicId{Type::trail, "hearsay_air_trail"}));
    EXPECT_EQ(only("my kind-1", states), (TopicId{Type::octets, "hearsay_air_my_kind_1"}));
  }
  EXPECT_EQ(type_name(Type::octets), "hearsay::OctetsPacket");
  EXPECT_EQ(type_name(Type::trail), "hearsay::TrailPacket");
}

TEST(Topics, AGridGoesWhereItsFormSays) {
  const std::vector<float> evidence{1.0F, 1.0F, 2.0F};
  grid::Encoder encoder;
  const auto topic = [&](grid::Form form) {
    const auto packets = encoder.encode({1, 2, form, evidence, evidence}, {3, 1}, 1000);
    return air_topic("grid", States::still, packets[0]);
  };
  EXPECT_EQ(topic(grid::Form::whole), (TopicId{Type::whole_grid, "hearsay_air_grid_whole"}));
  EXPECT_EQ(topic(grid::Form::changed), (TopicId{Type::changed_grid, "hearsay_air_grid_changed"}));
  EXPECT_EQ(topic(grid::Form::runs), (TopicId{Type::grid_runs, "hearsay_air_grid_runs"}));
  EXPECT_EQ(air_topics("grid", States::still).size(), 3u);
  EXPECT_THROW(air_topic("grid", States::still, {}), BrokenInvariant);
}

TEST(Topics, PartitionsOfAFleet) {
  EXPECT_EQ(fleet_partition("red"), "red");
  EXPECT_EQ(agent_partition("red", 13), "red.13");
  EXPECT_EQ(air_partition("red"), "red.air");
  for (const char* good : {"a", "A-b_9"}) EXPECT_TRUE(is_fleet_name(good));
  for (const char* bad : {"", "a.b", "a*", "a b", "ä"}) EXPECT_FALSE(is_fleet_name(bad)) << bad;
  EXPECT_TRUE(is_fleet_name(std::string(64, 'x')));
  EXPECT_FALSE(is_fleet_name(std::string(65, 'x')));
}

}  // namespace
}  // namespace hearsay::live
