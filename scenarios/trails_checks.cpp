#include "scenarios/trails_checks.hpp"

#include <string>

namespace hearsay {
namespace {

const trails::ParameterSet& set_of(const TrailsSpec& spec) {
  return *trails::parameter_set(spec.parameters);
}

// "found "completed"", and who says so.
std::string found_laying(const TrailsSpec& spec) {
  const bool at_once = laying_of(spec) == trails::Laying::at_once;
  return std::string("; found ") + (at_once ? "\"at-once\"" : "\"completed\"") +
         (spec.laying ? "" : ", by parameters \"" + spec.parameters + "\"");
}

void check_laying(const ScenarioUnderCheck& file, const TrailsSpec& spec, const KeyPath& path) {
  const bool at_once = laying_of(spec) == trails::Laying::at_once;
  if (spec.trail_crumbs_max && at_once) {
    file.fail(path["trail_crumbs_max"], "only for laying = \"completed\"" + found_laying(spec));
  }
  if (spec.life_arrivals == 1 && !at_once) {
    file.fail(
        path["life_arrivals"],
        "1 needs laying = \"at-once\": a trail that is told at an arrival has that behind it" +
            found_laying(spec));
  }
  if (spec.lanes != "none" && !at_once) {
    file.fail(path["lanes"],
              "\"" + spec.lanes +
                  "\" needs laying = \"at-once\", whose crumbs say where their robot "
                  "was going" +
                  found_laying(spec));
  }
}

// What is for those who follow trails alone.
void check_navigation(const ScenarioUnderCheck& file, const TrailsSpec& spec, const KeyPath& path) {
  if (spec.navigation == "trails") return;
  const auto useless = [&](bool given, const char* key) {
    if (given) {
      file.fail(path[key], "without effect with navigation = \"" + spec.navigation +
                               "\"; only with \"trails\"");
    }
  };
  useless(spec.lanes != "none", "lanes");
  useless(spec.field_rad.has_value(), "field_rad");
  useless(spec.random_chance.has_value(), "random_chance");
  useless(spec.random_falls_by.has_value(), "random_falls_by");
}

}  // namespace

trails::Laying laying_of(const TrailsSpec& spec) {
  if (!spec.laying) return set_of(spec).laying;
  return *spec.laying == "at-once" ? trails::Laying::at_once : trails::Laying::completed;
}

trails::Distance distance_of(const TrailsSpec& spec) {
  if (!spec.distance) return set_of(spec).distance;
  return *spec.distance == "time" ? trails::Distance::time : trails::Distance::steps_without_turns;
}

void check_trails(const ScenarioUnderCheck& file, const TrailsSpec& spec, const KeyPath& path) {
  check_navigation(file, spec, path);
  check_laying(file, spec, path);
  if (spec.trail_end_s && spec.trail_end == "none") {
    file.fail(path["trail_end_s"], "without effect with trail_end = \"none\"");
  }
  if (spec.random_falls_by && spec.random_chance.value_or(0.0) == 0.0) {
    file.fail(path["random_falls_by"], "needs a random_chance above 0");
  }
  if (!spec.scale && spec.transform == "as-is") {
    file.fail(path["scale"], "without effect with transform = \"as-is\"");
  }
}

void check_respawn(const ScenarioUnderCheck& file, const TrailsSpec& spec, const KeyPath& path) {
  if (spec.navigation != "trails" || laying_of(spec) == trails::Laying::completed) return;
  reject(file.locate(path), path,
         "needs agents.trails.laying = \"completed\": crumbs laid at once lead back to the last "
         "event, and who is carried away from there lays none" +
             found_laying(spec));
}

}  // namespace hearsay
