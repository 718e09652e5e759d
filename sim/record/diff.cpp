#include <algorithm>
#include <bit>
#include <memory>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/record/database.hpp"
#include "sim/record/schema.hpp"

namespace hearsay {

using namespace record;

namespace {

/// How the rows of a run in one table are read and told apart.
struct RowsOfRun {
  const char* table;
  const char* sql;  ///< ?1: the run, ?2 and ?3: ids of its first row and of the next run's
  int keys;         ///< so many columns say which value it is; the others are values
  int time;         ///< column by which a difference is dated; −1: none
};

constexpr RowsOfRun asked_rows[] = {
    {"axis",
     "SELECT a.name, a.value FROM axis_set a WHERE a.id = (SELECT axes FROM run_row WHERE id = ?1) "
     "AND ?2 < ?3 ORDER BY a.place",
     1, -1},
    {"agent",
     "SELECT a.agent AS id, a.name, a.kind FROM agent_set a "
     "WHERE a.id = (SELECT agents FROM run_row WHERE id = ?1) AND ?2 < ?3 ORDER BY a.place",
     1, -1},
};
constexpr RowsOfRun timed_rows[] = {
    {"series",
     "SELECT s.t_s, q.agent, q.subject, q.name, s.value "
     "FROM series_row s CROSS JOIN quantity q ON q.id = s.quantity "
     "WHERE ?1 AND s.id >= ?2 AND s.id < ?3 ORDER BY s.id",
     4, 0},
    {"message",
     "SELECT m.sent_s, m.arrived_s, m.sender, m.receiver, kind.text AS kind, m.bytes, "
     "fate.text AS fate FROM message_row m CROSS JOIN name kind ON kind.id = m.kind "
     "CROSS JOIN name fate ON fate.id = m.fate "
     "WHERE ?1 AND m.id >= ?2 AND m.id < ?3 ORDER BY m.id",
     5, 1},
    {"event",
     "SELECT e.t_s, e.agent, kind.text AS kind, e.detail "
     "FROM event_row e CROSS JOIN name kind ON kind.id = e.kind "
     "WHERE ?1 AND e.id >= ?2 AND e.id < ?3 ORDER BY e.id",
     3, 0},
};
constexpr RowsOfRun summed_rows[] = {
    {"scalar",
     "SELECT q.agent, q.name, s.value FROM scalar_row s CROSS JOIN quantity q ON q.id = s.quantity "
     "WHERE ?1 AND s.id >= ?2 AND s.id < ?3 ORDER BY s.id",
     2, -1},
    {"link",
     "SELECT l.sender, l.receiver, fate.text AS fate, l.packets "
     "FROM link_row l CROSS JOIN name fate ON fate.id = l.fate "
     "WHERE ?1 AND l.id >= ?2 AND l.id < ?3 ORDER BY l.id",
     3, -1},
};

/// Columns of `run`: what was asked, and what came out.
const std::vector<std::string> asked_columns = {"study",      "scenario", "parameters",
                                                "repetition", "seed",     "config_hash"};
const std::vector<std::string> result_columns = {"status", "reason", "events", "version", "digest"};

bool equal_cells(const Query& a, const Query& b, int column) {
  const int type = a.type(column);
  if (type != b.type(column)) return false;
  switch (type) {
    case SQLITE_NULL:
      return true;
    case SQLITE_INTEGER:
      return a.integer(column) == b.integer(column);
    case SQLITE_FLOAT:
      return std::bit_cast<std::uint64_t>(a.real(column)) ==
             std::bit_cast<std::uint64_t>(b.real(column));
    default:
      return a.text(column) == b.text(column);
  }
}

std::string cell_text(const Query& query, int column) {
  switch (query.type(column)) {
    case SQLITE_NULL:
      return "NULL";
    case SQLITE_FLOAT:
      return shortest(query.real(column));
    default:
      return std::string(query.text(column));
  }
}

/// "t_s=20 agent=2 …" of columns [first, last).
std::string cells_text(const Query& query, int first, int last) {
  std::string text;
  for (int column = first; column < last; ++column) {
    if (column > first) text += ' ';
    text += query.column_name(column) + std::string("=") + cell_text(query, column);
  }
  return text;
}

struct Found {
  std::string text;
  double time_s;
};

/// Two rows that stand at the same place, of which `in_a`, `in_b` are there. Nothing if equal.
std::optional<Found> row_difference(const RowsOfRun& rows, const Query& a, const Query& b,
                                    bool in_a, bool in_b, std::int64_t place) {
  const int columns = a.columns();
  const auto time = [&](const Query& query) { return rows.time < 0 ? 0 : query.real(rows.time); };
  const std::string table = rows.table;
  if (!in_a || !in_b) {
    const Query& there = in_a ? a : b;
    const std::string key = table + " " + cells_text(there, 0, rows.keys) + ": ";
    const std::string values = columns - rows.keys == 1 ? cell_text(there, rows.keys)
                                                        : cells_text(there, rows.keys, columns);
    return Found{key + (in_a ? values + " | absent" : "absent | " + values), time(there)};
  }
  int column = 0;
  while (column < columns && equal_cells(a, b, column)) ++column;
  if (column == columns) return std::nullopt;
  if (column < rows.keys) {
    return Found{table + " row " + std::to_string(place) + ": " + cells_text(a, 0, columns) +
                     " | " + cells_text(b, 0, columns),
                 std::min(time(a), time(b))};
  }
  const std::string which =
      columns - rows.keys == 1 ? "" : std::string(" ") + a.column_name(column);
  return Found{table + " " + cells_text(a, 0, rows.keys) + which + ": " + cell_text(a, column) +
                   " | " + cell_text(b, column),
               time(a)};
}

/// Reads the rows of a run in both files in step.
class RowsInStep {
 public:
  RowsInStep(const RowsOfRun& rows, SQLite::Database& a, SQLite::Database& b)
      : rows_(rows), a_(a, rows.sql), b_(b, rows.sql) {}

  std::optional<Found> first(std::int64_t run_a, std::int64_t run_b) {
    start(a_, run_a);
    start(b_, run_b);
    for (std::int64_t place = 1;; ++place) {
      const bool in_a = a_.step();
      const bool in_b = b_.step();
      if (!in_a && !in_b) return std::nullopt;
      if (auto found = row_difference(rows_, a_, b_, in_a, in_b, place)) return found;
    }
  }

 private:
  static void start(Query& query, std::int64_t run) {
    query.reset();
    query.bind(1, run);
    query.bind(2, first_row(run));
    query.bind(3, first_row(run + 1));
  }
  const RowsOfRun& rows_;
  Query a_, b_;
};

class Comparison {
 public:
  Comparison(const std::string& file_a, const std::string& file_b)
      : file_a_(file_a),
        file_b_(file_b),
        a_(open_to_read(file_a)),
        b_(open_to_read(file_b)),
        run_a_(a_, "SELECT * FROM run WHERE id = ?1"),
        run_b_(b_, "SELECT * FROM run WHERE id = ?1") {
    // One state of each file throughout, even while it is being written.
    a_.exec("BEGIN");
    b_.exec("BEGIN");
    for (const RowsOfRun& rows : asked_rows) {
      asked_.push_back(std::make_unique<RowsInStep>(rows, a_, b_));
    }
    for (const RowsOfRun& rows : timed_rows) {
      timed_.push_back(std::make_unique<RowsInStep>(rows, a_, b_));
    }
    for (const RowsOfRun& rows : summed_rows) {
      summed_.push_back(std::make_unique<RowsInStep>(rows, a_, b_));
    }
  }

  std::optional<std::string> databases() {
    if (auto found = studies()) return found;
    Query ids_a(a_, "SELECT id FROM run_row ORDER BY id");
    Query ids_b(b_, "SELECT id FROM run_row ORDER BY id");
    for (;;) {
      const bool in_a = ids_a.step();
      const bool in_b = ids_b.step();
      if (!in_a && !in_b) return std::nullopt;
      if (!in_b || (in_a && ids_a.integer(0) < ids_b.integer(0))) {
        return "run " + std::to_string(ids_a.integer(0)) + ": only in " + file_a_;
      }
      if (!in_a || ids_b.integer(0) < ids_a.integer(0)) {
        return "run " + std::to_string(ids_b.integer(0)) + ": only in " + file_b_;
      }
      const std::int64_t id = ids_a.integer(0);
      load(id, id);
      std::optional<std::string> found = asked(id, id);
      if (!found) found = happened(id, id);
      if (found) return "run " + std::to_string(id) + " " + *found;
    }
  }

  std::optional<std::string> runs(std::int64_t id_a, std::int64_t id_b) {
    load(id_a, id_b);
    std::optional<std::string> found = happened(id_a, id_b);
    if (!found) found = asked(id_a, id_b);
    if (!found) return std::nullopt;
    const std::string other = id_a == id_b ? "" : " | " + std::to_string(id_b);
    return "run " + std::to_string(id_a) + other + " " + *found;
  }

 private:
  std::optional<std::string> studies() {
    const char* const sql = "SELECT name, config FROM study ORDER BY name";
    Query a(a_, sql);
    Query b(b_, sql);
    for (;;) {
      const bool in_a = a.step();
      const bool in_b = b.step();
      if (!in_a && !in_b) return std::nullopt;
      if (!in_b || (in_a && a.text(0) < b.text(0))) {
        return "study " + cell_text(a, 0) + ": only in " + file_a_;
      }
      if (!in_a || b.text(0) < a.text(0))
        return "study " + cell_text(b, 0) + ": only in " + file_b_;
      if (!equal_cells(a, b, 1)) return "study " + cell_text(a, 0) + line_difference(a, b);
    }
  }

  /// The first line in which the texts of a study differ.
  static std::string line_difference(const Query& a, const Query& b) {
    std::string_view text_a = a.text(1);
    std::string_view text_b = b.text(1);
    const auto next = [](std::string_view& text) {
      const std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(text.size(), line.size() + 1));
      return line;
    };
    for (int number = 1;; ++number) {
      const std::string_view line_a = next(text_a);
      const std::string_view line_b = next(text_b);
      if (line_a == line_b && !(text_a.empty() && text_b.empty())) continue;
      return " config line " + std::to_string(number) + ": " + std::string(line_a) + " | " +
             std::string(line_b);
    }
  }

  void load(std::int64_t id_a, std::int64_t id_b) {
    load(run_a_, id_a, file_a_);
    load(run_b_, id_b, file_b_);
  }
  static void load(Query& run, std::int64_t id, const std::string& file) {
    run.reset();
    run.bind(1, id);
    if (!run.step()) throw InputError(file, 0, "has no run " + std::to_string(id));
  }

  std::optional<std::string> columns(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
      int column = 0;
      while (run_a_.column_name(column) != name) ++column;
      if (!equal_cells(run_a_, run_b_, column)) {
        return name + ": " + cell_text(run_a_, column) + " | " + cell_text(run_b_, column);
      }
    }
    return std::nullopt;
  }

  std::optional<std::string> asked(std::int64_t id_a, std::int64_t id_b) {
    if (auto found = columns(asked_columns)) return found;
    for (const auto& rows : asked_) {
      if (auto found = rows->first(id_a, id_b)) return found->text;
    }
    return std::nullopt;
  }

  std::optional<std::string> happened(std::int64_t id_a, std::int64_t id_b) {
    std::optional<Found> earliest;
    for (const auto& rows : timed_) {
      auto found = rows->first(id_a, id_b);
      if (found && (!earliest || found->time_s < earliest->time_s)) earliest = std::move(found);
    }
    if (earliest) return earliest->text;
    for (const auto& rows : summed_) {
      if (auto found = rows->first(id_a, id_b)) return found->text;
    }
    // The digest differs with any row, hence comes last; also rows that are not kept count in it.
    return columns(result_columns);
  }

  std::string file_a_, file_b_;
  SQLite::Database a_, b_;
  Query run_a_, run_b_;
  std::vector<std::unique_ptr<RowsInStep>> asked_, timed_, summed_;
};

}  // namespace

std::optional<std::string> first_difference(const std::string& file_a, const std::string& file_b,
                                            const DiffOptions& options) {
  try {
    Comparison comparison(file_a, file_b);
    if (!options.run_a && !options.run_b) return comparison.databases();
    const std::int64_t run_a = options.run_a ? *options.run_a : *options.run_b;
    return comparison.runs(run_a, options.run_b ? *options.run_b : run_a);
  } catch (const SQLite::Exception& error) {
    fail(file_a == file_b ? file_a : file_a + ", " + file_b, "read", error);
  }
}

}  // namespace hearsay
