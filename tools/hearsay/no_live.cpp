// hearsay agent, world, live, of a program that was built without them.
#include <fmt/core.h>

#include <cstdio>

#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {
namespace {

int refuse() {
  fmt::print(stderr, "hearsay: this program was built without live mode (HEARSAY_LIVE=OFF)\n");
  return exit_bad_input;
}

}  // namespace

int live_agent(const LiveVerb&, const Catalog&) { return refuse(); }
int live_world(const LiveVerb&, const Catalog&) { return refuse(); }
int live_fleet(const LiveVerb&, const Catalog&) { return refuse(); }

}  // namespace hearsay::program
