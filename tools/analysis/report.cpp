#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sim/kernel/error.hpp"
#include "tools/analysis/claims.hpp"

namespace hearsay::analysis {
namespace {

using nlohmann::ordered_json;

std::string number(double value) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0.0 ? "∞" : "−∞";
  return fmt::format("{:.4g}", value);
}

std::string range(double low, double high) {
  if (std::isnan(low) || std::isnan(high)) return "–";
  if (low == high) return number(low);
  return fmt::format("{}{}, {}{}", std::isinf(low) ? "(" : "[", number(low), number(high),
                     std::isinf(high) ? ")" : "]");
}

std::string claimed(const ClaimResult& result) {
  using Kind = Expectation::Kind;
  const double low = result.bound_low;
  const double high = result.bound_high;
  std::string text;
  switch (result.claim.expect.kind) {
    case Kind::at_most:
      text = "≤ " + number(high);
      break;
    case Kind::at_least:
      text = (result.claim.expect.chi2_band ? "> " : "≥ ") + number(low);
      break;
    case Kind::less_than:
      text = "< " + number(high);
      break;
    case Kind::greater_than:
    case Kind::grows:
      text = "> " + number(low);
      break;
    case Kind::within:
    case Kind::falls_as:
    case Kind::agrees_with:
      text = range(low, high);
      break;
  }
  return result.claim.expect.chi2_band ? text + " (χ² band)" : text;
}

/// Text for a cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c == '\n' || c == '\r' ? ' ' : c;
  }
  return escaped;
}

std::array<std::size_t, 3> counts(const std::vector<ClaimResult>& results) {
  std::array<std::size_t, 3> count = {};
  for (const ClaimResult& result : results) ++count[static_cast<std::size_t>(result.verdict)];
  return count;
}

std::string markdown(const std::vector<ClaimResult>& results, const std::string& title) {
  const auto [reproduced, not_reproduced, undecided] = counts(results);
  std::string text = fmt::format(
      "# {}\n\n{} claims: {} reproduced, {} not reproduced, {} undecided.\n\n"
      "Intervals hold with 95 % for all comparisons of a claim together. Estimate, interval, bound "
      "and place are those of the comparison that decides: the one nearest to the bound, or "
      "farthest beyond it.\n\n"
      "| Claim | Source | Verdict | Quantity | Estimate | Interval | Claimed | Comparisons | "
      "Repetitions | Where | Note |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
      title, results.size(), reproduced, not_reproduced, undecided);
  for (const ClaimResult& r : results) {
    std::string comparisons = fmt::format("{}", r.comparisons);
    if (r.failing > 0) comparisons += fmt::format(", {} beyond the bound", r.failing);
    if (r.open > 0) comparisons += fmt::format(", {} open", r.open);
    std::string note = r.note;
    if (r.missing_values > 0) {
      note +=
          fmt::format("{}{} missing values left out", note.empty() ? "" : "; ", r.missing_values);
    }
    text +=
        fmt::format("| {} | {} | **{}** | {} | {} | {} | {} | {} | {} | {} | {} |\n",
                    cell(r.claim.text), cell(r.claim.source), to_string(r.verdict),
                    cell(r.quantity), number(r.worst.estimate), range(r.worst.low, r.worst.high),
                    claimed(r), comparisons, r.repetitions, cell(r.worst_where), cell(note));
  }
  return text;
}

ordered_json json_number(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  return value;
}

std::string json(const std::vector<ClaimResult>& results, const std::string& title) {
  const auto [reproduced, not_reproduced, undecided] = counts(results);
  ordered_json document;
  document["title"] = title;
  document["counts"] = {{"claims", results.size()},
                        {"reproduced", reproduced},
                        {"not reproduced", not_reproduced},
                        {"undecided", undecided}};
  document["claims"] = ordered_json::array();
  for (const ClaimResult& r : results) {
    ordered_json claim;
    claim["text"] = r.claim.text;
    claim["source"] = r.claim.source;
    claim["verdict"] = to_string(r.verdict);
    claim["metric"] = r.claim.expect.metric;
    claim["quantity"] = r.quantity;
    claim["estimate"] = json_number(r.worst.estimate);
    claim["low"] = json_number(r.worst.low);
    claim["high"] = json_number(r.worst.high);
    claim["bound_low"] = json_number(r.bound_low);
    claim["bound_high"] = json_number(r.bound_high);
    claim["where"] = r.worst_where;
    claim["comparisons"] = r.comparisons;
    claim["failing"] = r.failing;
    claim["open"] = r.open;
    claim["repetitions"] = r.repetitions;
    claim["missing_values"] = r.missing_values;
    claim["note"] = r.note;
    document["claims"].push_back(std::move(claim));
  }
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

/// A file under a temporary name, removed unless put in place.
class Draft {
 public:
  Draft(const std::string& file, const std::string& content) : file_(file), draft_(file + ".part") {
    std::ofstream stream(draft_, std::ios::binary | std::ios::trunc);
    stream << content;
    stream.close();
    if (stream.fail()) {
      discard();
      throw InputError(file_, 0, "cannot be written");
    }
  }
  ~Draft() { discard(); }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  void put_in_place() {
    std::error_code error;
    std::filesystem::rename(draft_, file_, error);
    if (error) throw InputError(file_, 0, "cannot be written: " + error.message());
  }

 private:
  void discard() {
    std::error_code ignored;
    std::filesystem::remove(draft_, ignored);
  }

  std::string file_;
  std::string draft_;
};

}  // namespace

void write_claims_report(const std::vector<ClaimResult>& results, const std::string& title,
                         const std::string& markdown_file, const std::string& json_file) {
  Draft for_people(markdown_file, markdown(results, title));
  Draft for_programs(json_file, json(results, title));
  for_people.put_in_place();
  for_programs.put_in_place();
}

}  // namespace hearsay::analysis
