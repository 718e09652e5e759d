#include "scenarios/radio_models.hpp"

#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>
#include <utility>

namespace hearsay {
namespace {

std::set<std::string> choices(const std::string& path) {
  std::set<std::string> names;
  for (const KeyInfo& key : schema_keys()) {
    if (key.path != path) continue;
    std::istringstream text(key.allowed);
    for (std::string name, bar; text >> name; text >> bar) names.insert(name);
  }
  return names;
}

TEST(RadioModels, HaveOneNameEachWithinTheirPart) {
  std::set<std::pair<std::string, std::string>> names;
  for (const RadioModelInfo& model : radio_models()) {
    EXPECT_TRUE(names.insert({model.part, model.name}).second) << model.part << " " << model.name;
    EXPECT_FALSE(model.meaning.empty()) << model.name;
  }
}

TEST(RadioModels, HaveParametersThatTheSchemaKnows) {
  for (const RadioModelInfo& model : radio_models()) {
    for (const std::string& key : model.keys) {
      EXPECT_FALSE(parameters({.keys = {key}}).empty()) << model.name << ": " << key;
    }
  }
}

TEST(RadioModels, AreAllThatAFileCanChoose) {
  std::set<std::string> keys;
  for (const RadioModelInfo& model : radio_models()) keys.insert(model.chosen_by);
  keys.erase("");
  EXPECT_GE(keys.size(), 4u);
  for (const std::string& key : keys) {
    std::set<std::string> listed;
    for (const RadioModelInfo& model : radio_models()) {
      if (model.chosen_by == key) listed.insert(model.name);
    }
    EXPECT_EQ(listed, choices(key)) << key;
  }
}

TEST(RadioModels, OwnEveryKeyOfTheRadioAndOfDropouts) {
  std::set<std::string> owned;
  for (const RadioModelInfo& model : radio_models()) {
    owned.insert(model.chosen_by);
    for (const KeyInfo& key : parameters(model)) owned.insert(key.path);
  }
  for (const KeyInfo& key : schema_keys()) {
    if (!key.path.starts_with("radio.") && !key.path.starts_with("dropouts.")) continue;
    EXPECT_TRUE(owned.contains(key.path)) << key.path;
  }
}

TEST(RadioModels, TellUnitsByTheEndsOfKeys) {
  EXPECT_EQ(unit_of("radio.range_m"), "m");
  EXPECT_EQ(unit_of("radio.latency_s"), "s");
  EXPECT_EQ(unit_of("radio.propagation_m_per_s"), "m/s");
  EXPECT_EQ(unit_of("agents.localizer.turn_rad_per_sqrt_s"), "rad/√s");
  EXPECT_EQ(unit_of("agents.robot.turn_rad_per_s"), "rad/s");
  EXPECT_EQ(unit_of("agents.robot.forward_m_per_sqrt_m"), "m/√m");
  EXPECT_EQ(unit_of("agents.robot.turn_rad_per_sqrt_m"), "rad/√m");
  EXPECT_EQ(unit_of("agents.robot.turn_rad_per_sqrt_rad"), "rad/√rad");
  EXPECT_EQ(unit_of("agents.estimator.acceleration_psd_m2_per_s3"), "m²/s³");
  EXPECT_EQ(unit_of("radio.rate_bps"), "bit/s");
  EXPECT_EQ(unit_of("radio.header_bytes"), "bytes");
  EXPECT_EQ(unit_of("radio.queue_bytes_max"), "bytes");
  EXPECT_EQ(unit_of("radio.queue_packets_max"), "packets");
  EXPECT_EQ(unit_of("radio.propagation.noise_dbm"), "dBm");
  EXPECT_EQ(unit_of("radio.propagation.reference_loss_db"), "dB");
  EXPECT_EQ(unit_of("radio.loss.mean_burst"), "packets");
  EXPECT_EQ(unit_of("radio.loss.probability"), "");
}

}  // namespace
}  // namespace hearsay
