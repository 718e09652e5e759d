// The kinds of agent that scenario files may name, besides the built-in "estimator",
// "tracker", "localizer", "explorer", "forager" and "source": what a user's own program adds.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "agents/agent.hpp"

namespace hearsay {

class Catalog {
 public:
  using Factory = std::function<std::unique_ptr<Agent>(Context&)>;
  struct AgentKind {
    std::string meaning;
    Factory make;
  };
  struct OwnMetric {
    std::string name;
    std::string meaning;
  };

  /// Agents of class T, made by T(Context&), are `kind = "<name>"` in scenario files.
  /// @throws std::invalid_argument if the name is taken.
  template <class T>
  Catalog& add_agent(const std::string& name, const std::string& meaning) {
    AgentKind kind{meaning, [](Context& context) { return std::make_unique<T>(context); }};
    const bool built_in = name == "estimator" || name == "tracker" || name == "localizer" ||
                          name == "explorer" || name == "forager" || name == "source";
    if (built_in || !agents_.emplace(name, std::move(kind)).second) {
      throw std::invalid_argument("agent kind '" + name + "' exists already");
    }
    return *this;
  }
  /// A name that such agents record and that claims may speak of.
  Catalog& add_metric(const std::string& name, const std::string& meaning) {
    metrics_.push_back({name, meaning});
    return *this;
  }

  const std::map<std::string, AgentKind>& agents() const { return agents_; }
  const std::vector<OwnMetric>& metrics() const { return metrics_; }

 private:
  std::map<std::string, AgentKind> agents_;
  std::vector<OwnMetric> metrics_;
};

}  // namespace hearsay
