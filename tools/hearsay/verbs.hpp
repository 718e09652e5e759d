// The verbs of the program: options in, exit code out. cli.cpp fills the options.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "agents/catalog.hpp"

namespace hearsay::program {

inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;  ///< a run failed, a claim was not reproduced (--strict)
inline constexpr int exit_bad_input = 2;

struct RunVerb {
  std::string scenario;
  std::optional<std::uint64_t> seed;
  std::vector<std::string> set;
  std::string out;      ///< database; empty: none
  bool digest = false;  ///< print the digest alone
  bool json = false;
};
int run(const RunVerb& verb, const Catalog& catalog);

struct SweepVerb {
  std::string study;
  std::string out;  ///< default: <study>.db
  std::vector<std::string> set;
  int jobs = 0;  ///< 0: one a processor
  bool retry = false;
  bool json = false;
};
int sweep(const SweepVerb& verb, const Catalog& catalog);

struct CompareVerb {
  std::string database;
  std::string metric;
  std::string by;
  std::optional<std::string> baseline;
  std::string agents = "mean";
  std::string at = "end";
  std::optional<std::string> study;  ///< needed where a database holds several
  bool json = false;
};
int compare(const CompareVerb& verb);

struct ReproduceVerb {
  std::string what;  ///< "rumour", "rumour/trees"; empty: everything
  std::string out = "results";
  std::string data;  ///< directory of a log, for studies that replay one
  int jobs = 0;
  bool strict = false;
  bool fresh = false;  ///< forget runs of earlier, interrupted calls
};
int reproduce(const ReproduceVerb& verb, const Catalog& catalog);

struct CheckVerb {
  std::vector<std::string> files;
};
int check(const CheckVerb& verb, const Catalog& catalog);

struct ListVerb {
  std::string what = "all";
  bool json = false;
};
int list(const ListVerb& verb, const Catalog& catalog);

struct DiffVerb {
  std::string a, b;
  std::optional<std::int64_t> run_a, run_b;
};
int diff(const DiffVerb& verb);

struct ExportVerb {
  std::string database;
  std::string directory;
};
int export_csv(const ExportVerb& verb);

/// Of `agent`, `world` and `live`; each uses some of it.
struct LiveVerb {
  std::string scenario;
  std::vector<std::string> set;
  std::optional<std::uint64_t> seed;
  int agent = 0;
  std::string fleet;  ///< live: empty: one of its own
  std::string interface;
  std::uint32_t domain = 77;
  std::string radio = "scenario";  ///< or "direct"
  bool lockstep = false;
  double speed = 1.0;
  double patience_s = 30.0;
  std::string memory;  ///< agent: file; empty: none
  std::string out;
  bool digest = false, json = false;
  bool status = false;  ///< lines for `hearsay live`
};
int live_agent(const LiveVerb& verb, const Catalog& catalog);
int live_world(const LiveVerb& verb, const Catalog& catalog);
int live_fleet(const LiveVerb& verb, const Catalog& catalog);

}  // namespace hearsay::program
