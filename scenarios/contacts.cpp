#include "scenarios/contacts.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "scenarios/csv.hpp"

namespace hearsay {
namespace {

enum Column : std::size_t { t_s, a, b, state };

class ContactReader {
 public:
  ContactReader(const std::string& file, const ScenarioUnderCheck& scenario)
      : csv_(file, {.required = {"t_s", "a", "b", "state"}}), scenario_(scenario) {}

  std::vector<LinkChange> read() {
    std::vector<LinkChange> trace;
    for (std::size_t row = 0; row < csv_.rows(); ++row) {
      const Time time = time_of(row);
      const AgentId first = scenario_.resolve_agent(csv_, row, a);
      const AgentId second = scenario_.resolve_agent(csv_, row, b);
      if (first == second) csv_.reject(row, b, "is the same agent as a");
      trace.push_back({time, std::min(first, second), std::max(first, second), is_up(row)});
      check_alternation(row, trace.back());
    }
    return trace;
  }

 private:
  Time time_of(std::size_t row) {
    const double seconds = csv_.number(row, t_s);
    if (seconds < 0.0) csv_.reject(row, t_s, "must be at least 0");
    if (seconds > 1e9) csv_.reject(row, t_s, "must be at most 1000000000");
    if (row > 0 && seconds < before_s_) {
      csv_.reject(row, t_s,
                  "must not be before the time on line " + std::to_string(csv_.line(row - 1)) +
                      "; rows are sorted by time");
    }
    before_s_ = seconds;
    return Time::at(Duration::seconds(seconds));
  }

  bool is_up(std::size_t row) const {
    const std::string_view word = csv_.text(row, state);
    if (word != "up" && word != "down") csv_.reject(row, state, "must be up or down");
    return word == "up";
  }

  void check_alternation(std::size_t row, const LinkChange& change) {
    const auto [last, first] = last_.try_emplace({change.a, change.b}, Last{false, 0});
    if (last->second.up == change.up) {
      const std::string since =
          first ? "; a pair begins with up" : " since line " + std::to_string(last->second.line);
      csv_.reject(row, state,
                  std::string("the pair is ") + (change.up ? "up" : "down") + " already" + since);
    }
    last->second = {change.up, csv_.line(row)};
  }

  struct Last {
    bool up;
    int line;
  };
  const CsvFile csv_;
  const ScenarioUnderCheck& scenario_;
  double before_s_ = 0.0;
  std::map<std::pair<AgentId, AgentId>, Last> last_;
};

}  // namespace

std::vector<LinkChange> read_contacts(const std::string& file, const ScenarioUnderCheck& scenario) {
  return ContactReader(file, scenario).read();
}

}  // namespace hearsay
