#include "filters/trails/parameters.hpp"

#include <array>

namespace hearsay::trails {
namespace {

constexpr std::array<ParameterSet, 3> table = {{
    {.name = "lost-2002",
     .source = "Vaughan, Støy, Sukhatme & Matarić, IEEE TRA 18(5), 2002. S is given as 4 s and as "
               "2 s, and the number of crumbs implies 1 s: 2 s here; sweep it",
     .frame = Frame::odometry,
     .laying = Laying::at_once,
     .distance = Distance::time,
     .sense_radius_m = 1.0,
     .interval_s = 2.0,
     .crumbs_max = std::nullopt,
     .age_max_s = 240.0,
     .life_arrivals = std::nullopt,
     .speed_mps = 0.25,
     .event_radius_m = 1.0,
     .trail_end = 2.0,
     .goal_similarity = std::nullopt,
     .views = std::nullopt,
     .local_search = std::nullopt},
    {.name = "thesis-2019-text",
     .source =
         "Shamshirdar, Deep neural networks for robot navigation using visual teach and "
         "repeat, 2019, sections 4.2.5 and 4.3. It calls 0.6 the chance of following the crumb, "
         "and has it fall while random moves fade: read as the chance of a random move, as is "
         "usual for ε. The last crumb is one step from the goal. S, r, the age limit and the "
         "similarity of crumbs matched before are not given",
     .frame = Frame::views,
     .laying = Laying::completed,
     .distance = Distance::time,
     .sense_radius_m = std::nullopt,
     .interval_s = std::nullopt,
     .crumbs_max = 500,
     .age_max_s = std::nullopt,
     .life_arrivals = std::nullopt,
     .speed_mps = std::nullopt,
     .event_radius_m = std::nullopt,
     .trail_end = 1.0,
     .goal_similarity = 0.95,
     .views = ViewSearch{.nearest = 10,
                         .similarity_min = 0.95,
                         .again_similarity_min = std::nullopt,
                         .ahead_similarity_min = 0.92,
                         .ahead_max = 15},
     .local_search = LocalSearch{0.6, 0.001, Fading::per_iteration}},
    {.name = "thesis-2019-code",
     .source =
         "the program published with Shamshirdar 2019, which differs from the text: its LOST "
         "(figure 4.6) uses true positions, and crumbs live for about 11 arrivals at the goal",
     .frame = Frame::true_positions,
     .laying = Laying::completed,
     .distance = Distance::steps_without_turns,
     .sense_radius_m = std::nullopt,
     .interval_s = std::nullopt,
     .crumbs_max = 700,
     .age_max_s = std::nullopt,
     .life_arrivals = 11,
     .speed_mps = std::nullopt,
     .event_radius_m = std::nullopt,
     .trail_end = std::nullopt,
     .goal_similarity = std::nullopt,
     .views = ViewSearch{.nearest = 3,
                         .similarity_min = 0.9,
                         .again_similarity_min = 0.85,
                         .ahead_similarity_min = 0.85,
                         .ahead_max = 20},
     .local_search = LocalSearch{0.3, 0.01, Fading::per_success}},
}};

}  // namespace

std::span<const ParameterSet> parameter_sets() { return table; }

const ParameterSet* parameter_set(std::string_view name) {
  for (const ParameterSet& set : table) {
    if (set.name == name) return &set;
  }
  return nullptr;
}

}  // namespace hearsay::trails
