#include "tools/hearsay/one_run.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace hearsay::program {
namespace {

// In place of the path of a small file, what is in it. A file that went away since it was loaded
// keeps its path, so that the hash is another.
void hold_content(std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (path.empty() || !file) return;
  path = text_digest(std::string(std::istreambuf_iterator<char>(file), {}));
}

}  // namespace

FinishedRun execute(const std::shared_ptr<const PreparedScenario>& prepared, const Catalog& catalog,
                    std::uint64_t seed) {
  const auto begin = std::chrono::steady_clock::now();
  Xxh3Digest digest, ledger_digest;
  FinishedRun finished;
  finished.run = std::make_unique<Run>(
      prepared, catalog,
      Run::Options{.seed = seed, .digest = &digest, .ledger_digest = &ledger_digest});
  finished.end = finished.run->run();
  const bool ledger = prepared->scenario.record.ledger == "on";
  finished.digest = digest_text(digest, ledger ? &ledger_digest : nullptr);
  finished.run->keep_record_only();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  finished.wall_s = wall.count();
  return finished;
}

std::string how_it_ended(const RunEnd& end) {
  return end.message.empty() ? to_string(end.reason) : end.message;
}

std::string scenario_hash(Scenario scenario) {
  if (scenario.world.log) {
    std::string& directory = scenario.world.log->directory;
    directory = std::filesystem::path(directory + "/").parent_path().filename().string();
  }
  WorldSpec& world = scenario.world;
  if (world.area && world.area->heights) hold_content(*world.area->heights);
  if (world.plan) hold_content(world.plan->file);
  hold_content(scenario.radio.contacts);
  for (AgentSpec& agent : scenario.agents) {
    if (agent.motion && agent.motion->file) hold_content(*agent.motion->file);
  }
  return text_digest(canonical_text(scenario));
}

std::string program_version() { return HEARSAY_VERSION; }

}  // namespace hearsay::program
