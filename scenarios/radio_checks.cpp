#include <string>

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

void check_radio(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath path = top["radio"];
  const RadioSpec& radio = file.scenario.radio;
  if (radio.loss.model == "none" && radio.loss.probability > 0.0) {
    file.fail(path["loss"]["probability"],
              "without effect; set radio.loss.model = \"bernoulli\", too");
  }
  check_links(file);
  const bool long_links = radio.topology == "disk" || radio.topology == "random-geometric";
  if (radio.propagation_m_per_s && !long_links) {
    file.fail(
        path["propagation_m_per_s"],
        "only for topology = \"disk\" or \"random-geometric\", which know how long links are; "
        "found \"" +
            radio.topology + "\"");
  }
}

}  // namespace hearsay
