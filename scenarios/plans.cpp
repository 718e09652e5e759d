#include "scenarios/plans.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

bool is_bitmap(const PlanSpec& spec) { return spec.file.ends_with(".png"); }

plan::Drawing drawing_of(const ScenarioUnderCheck& file, const PlanSpec& spec,
                         const KeyPath& path) {
  if (spec.file.empty()) {
    file.fail(path["file"], "missing; which drawing in text, or bitmap in PNG?");
  }
  std::error_code error;
  if (!std::filesystem::exists(spec.file, error)) {
    file.fail(path["file"], "there is no file \"" + spec.file + "\"");
  }
  if (is_bitmap(spec)) return plan::read_png(spec.file, spec.cell_m, spec.wall_below.value_or(128));
  if (spec.wall_below) {
    file.fail(path["wall_below"], "only for bitmaps, whose file ends in .png");
  }
  return plan::read_text(spec.file, spec.cell_m);
}

void add(const ScenarioUnderCheck& file, const PlanPlaceSpec& spec, const KeyPath& path,
         plan::Drawing& drawing) {
  if (spec.name.empty()) file.fail(path["name"], "missing");
  if (!spec.position_m) file.fail(path["position_m"], "missing");
  // Names stand in records, with blanks between them.
  if (spec.name.find(' ') != std::string::npos || spec.name == "anywhere") {
    const KeyPath name = path["name"];
    reject(file.locate(name), name,
           spec.name == "anywhere" ? "means something else in robot.start; take another name"
                                   : "must not contain blanks");
  }
  try {
    drawing.add(spec.name, {spec.position_m->at(0), spec.position_m->at(1)});
  } catch (const InputError& error) {
    file.fail(path, error.what());
  }
}

}  // namespace

void take_plan(ScenarioUnderCheck& file) {
  if (!file.scenario.world.plan) return;
  PlanSpec& spec = *file.scenario.world.plan;
  const KeyPath top;
  const KeyPath world = top["world"];
  const KeyPath path = world["plan"];
  const KeyPath places = path["places"];
  plan::Drawing drawing = drawing_of(file, spec, path);
  for (std::size_t i = 0; i < spec.places.size(); ++i)
    add(file, spec.places[i], places[i], drawing);
  try {
    spec.plan = std::make_shared<const plan::Plan>(drawing);
  } catch (const InputError& error) {
    file.fail(path["file"], error.what());
  }
}

}  // namespace hearsay
