#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "sim/kernel/error.hpp"
#include "sim/record/database.hpp"
#include "sim/record/schema.hpp"

namespace hearsay {

using namespace record;

namespace {

constexpr std::size_t buffer_bytes = 1 << 20;

void append_text(std::string& out, std::string_view text) {
  if (!text.empty() && text.find_first_of(",\"\r\n") == std::string_view::npos) {
    out += text;
    return;
  }
  out += '"';
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  out += '"';
}

template <typename Number>
void append_number(std::string& out, Number value) {
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

void append_cell(std::string& out, const Query& query, int column) {
  switch (query.type(column)) {
    case SQLITE_NULL:
      return;
    case SQLITE_INTEGER:
      return append_number(out, query.integer(column));
    case SQLITE_FLOAT:
      return append_number(out, query.real(column));
    default:
      return append_text(out, query.text(column));
  }
}

/// Files under temporary names that vanish unless all are renamed.
class PartFiles {
 public:
  explicit PartFiles(const std::filesystem::path& directory) : directory_(directory) {}
  ~PartFiles() {
    std::error_code ignored;
    for (const std::string& table : tables_) std::filesystem::remove(part(table), ignored);
  }
  PartFiles(const PartFiles&) = delete;
  PartFiles& operator=(const PartFiles&) = delete;

  std::filesystem::path add(const std::string& table) {
    tables_.push_back(table);
    return part(table);
  }
  void rename_all() {
    for (const std::string& table : tables_) {
      std::filesystem::rename(part(table), directory_ / (table + ".csv"));
    }
    tables_.clear();
  }

 private:
  std::filesystem::path part(const std::string& table) const {
    return directory_ / ("." + table + ".csv.part");
  }
  std::filesystem::path directory_;
  std::vector<std::string> tables_;
};

[[noreturn]] void fail_to_write(const std::filesystem::path& file) {
  throw InputError(file.string(), 0, std::string("cannot be written: ") + std::strerror(errno));
}

std::int64_t write_table(SQLite::Database& database, const std::string& table,
                         const std::filesystem::path& file) {
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  if (!out) fail_to_write(file);
  Query rows(database, "SELECT * FROM " + table);
  std::string buffer;
  const int columns = rows.columns();
  for (int column = 0; column < columns; ++column) {
    if (column > 0) buffer += ',';
    append_text(buffer, rows.column_name(column));
  }
  buffer += "\r\n";
  std::int64_t count = 0;
  for (; rows.step(); ++count) {
    for (int column = 0; column < columns; ++column) {
      if (column > 0) buffer += ',';
      append_cell(buffer, rows, column);
    }
    buffer += "\r\n";
    if (buffer.size() < buffer_bytes) continue;
    out.write(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    buffer.clear();
  }
  out.write(buffer.data(), static_cast<std::streamsize>(buffer.size()));
  out.close();
  if (!out) fail_to_write(file);
  return count;
}

}  // namespace

std::vector<std::pair<std::string, std::int64_t>> export_csv(const std::string& file,
                                                             const std::string& directory) {
  try {
    SQLite::Database database = open_to_read(file);
    database.exec("BEGIN");  // all tables of one state, even while the file is being written
    std::filesystem::create_directories(directory);
    PartFiles parts(directory);
    std::vector<std::pair<std::string, std::int64_t>> counts;
    for (const char* table : public_tables) {
      counts.emplace_back(table, write_table(database, table, parts.add(table)));
    }
    parts.rename_all();
    return counts;
  } catch (const SQLite::Exception& error) {
    fail(file, "read", error);
  } catch (const std::filesystem::filesystem_error& error) {
    throw InputError(directory, 0, "cannot be written: " + error.code().message());
  }
}

}  // namespace hearsay
