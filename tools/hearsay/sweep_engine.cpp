#include "tools/hearsay/sweep_engine.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <vector>

#include "scenarios/loader.hpp"
#include "sim/kernel/error.hpp"
#include "sim/record/database.hpp"
#include "tools/hearsay/one_run.hpp"

namespace hearsay::program {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t stop_requested = 0;

/// While it lives, SIGINT and SIGTERM ask the sweep to stop instead of ending the program.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_requested = 0;
    old_int_ = std::signal(SIGINT, [](int) { stop_requested = 1; });
    old_term_ = std::signal(SIGTERM, [](int) { stop_requested = 1; });
  }
  ~StopOnSignal() {
    std::signal(SIGINT, old_int_);
    std::signal(SIGTERM, old_term_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  void (*old_int_)(int);
  void (*old_term_)(int);
};

/// A cell's scenario, prepared by the first worker that needs it.
class CellScenario {
 public:
  CellScenario(const Study& study, Cell cell) : study_(study), cell_(std::move(cell)) {}
  const Cell& cell() const { return cell_; }

  /// @throws InputError.
  std::shared_ptr<const PreparedScenario> get(const Catalog& catalog, LogCache& logs) {
    const std::scoped_lock lock(mutex_);
    if (!prepared_) {
      prepared_ = prepare(load_scenario(study_.scenario_file, cell_.set, known_names(catalog)),
                          catalog, logs);
      config_hash_ = scenario_hash(prepared_->scenario);
    }
    return prepared_;
  }
  void release() {
    const std::scoped_lock lock(mutex_);
    prepared_.reset();
  }
  /// After get().
  std::string config_hash() {
    const std::scoped_lock lock(mutex_);
    return config_hash_;
  }

 private:
  const Study& study_;
  Cell cell_;
  std::mutex mutex_;
  std::shared_ptr<const PreparedScenario> prepared_;
  std::string config_hash_;
};

struct Job {
  std::int64_t id;
  CellScenario* cell;
  int repetition;
};

struct Outcome {
  FinishedRun finished;
  std::string input_error;  ///< the scenario of the cell could not be used
};

/// The runs of a sweep in order: handed out, given back, stored. A worker that gives back a run
/// stores what has become ready, unless another is storing already; so there is no thread that
/// only writes, and no processor idles while there are runs.
class Conveyor {
 public:
  using Store = std::function<void(const Job&, Outcome)>;
  /// `store` is called in the order of the jobs, by one thread at a time.
  Conveyor(std::vector<Job> jobs, std::size_t window, Store store)
      : jobs_(std::move(jobs)), window_(window), store_(std::move(store)) {}

  /// The next job, or nullptr when there is none left. Waits while storing is too far behind.
  const Job* take() {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return stopped_ || taken_ < stored_ + window_; });
    if (stopped_ || taken_ == jobs_.size()) return nullptr;
    return &jobs_[taken_++];
  }
  /// @throws what `store` throws.
  void give(const Job* job, Outcome outcome) {
    std::unique_lock lock(mutex_);
    outcomes_.emplace(static_cast<std::size_t>(job - jobs_.data()), std::move(outcome));
    if (storing_) return;  // whoever stores looks again before it goes
    storing_ = true;
    for (auto ready = outcomes_.find(stored_); ready != outcomes_.end();
         ready = outcomes_.find(stored_)) {
      Outcome next = std::move(ready->second);
      outcomes_.erase(ready);
      lock.unlock();
      store_(jobs_[stored_], std::move(next));
      lock.lock();
      ++stored_;
      room_.notify_all();
    }
    storing_ = false;
  }
  /// No more jobs are handed out; what has been taken is still given back and stored.
  void stop() {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    room_.notify_all();
  }

 private:
  const std::vector<Job> jobs_;
  const std::size_t window_;
  const Store store_;
  std::mutex mutex_;
  std::condition_variable room_;
  std::map<std::size_t, Outcome> outcomes_;
  std::size_t taken_ = 0;
  std::size_t stored_ = 0;  ///< written by the one thread that stores, under the mutex
  bool storing_ = false;
  bool stopped_ = false;
};

/// Does one job. False if there is none left.
bool work_once(Conveyor& conveyor, const Study& study, const Catalog& catalog, LogCache& logs) {
  const Job* job = conveyor.take();
  if (job == nullptr) return false;
  Outcome outcome;
  try {
    outcome.finished = execute(job->cell->get(catalog, logs), catalog,
                               study.seed + static_cast<std::uint64_t>(job->repetition - 1));
  } catch (const std::exception& error) {
    outcome.input_error = error.what();
  }
  if (job->repetition == study.repetitions) job->cell->release();
  conveyor.give(job, std::move(outcome));
  return true;
}

/// Calls `work` on so many threads, this one among them, until it returns false, or a signal asks
/// to stop. @throws the first exception of any of them, after all have ended.
void run_all(Conveyor& conveyor, int threads, const std::function<bool()>& work) {
  const StopOnSignal stop_on_signal;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto loop = [&] {
    try {
      while (stop_requested == 0 && work()) {
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failure) failure = std::current_exception();
    }
    conveyor.stop();  // for the others: there is none left, or a signal came, or one failed
  };
  {
    std::vector<std::jthread> others;
    for (int t = 1; t < threads; ++t) others.emplace_back(loop);
    loop();
  }
  if (failure) std::rethrow_exception(failure);
}

/// A label as the database has it: strings bare, the rest as in the study file.
std::string label_text(const Value& value) {
  const std::string* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : to_string(value);
}

nlohmann::ordered_json to_json(const Value& value) {
  return std::visit([](const auto& v) { return nlohmann::ordered_json(v); }, value);
}

RunRow row_of(const Job& job, const Study& study, const FinishedRun& finished) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  RunRow row;
  for (const auto& [axis, label] : job.cell->cell().labels) {
    parameters[axis] = to_json(label);
    row.axes.emplace_back(axis, label_text(label));
  }
  row.id = job.id;
  row.study = study.name;
  row.scenario = std::filesystem::path(study.scenario_file).filename().string();
  row.parameters_json = parameters.dump();
  row.repetition = job.repetition;
  row.seed = study.seed + static_cast<std::uint64_t>(job.repetition - 1);
  row.ok = finished.end.ok();
  row.reason = how_it_ended(finished.end);
  row.digest = finished.digest;
  row.config_hash = job.cell->config_hash();
  row.wall_s = finished.wall_s;
  row.events = finished.end.events;
  row.version = program_version();
  return row;
}

/// Which runs are still to be done. Refuses a database whose runs were made from other settings.
std::vector<Job> open_jobs(const Study& study, const SweepOptions& options,
                           DatabaseWriter& database,
                           std::vector<std::unique_ptr<CellScenario>>& cells) {
  const std::set<std::int64_t> present = database.run_ids();
  if (options.retry) {
    for (const std::int64_t id : database.failed_run_ids()) database.remove_run(id);
  }
  const std::set<std::int64_t> keep = options.retry ? database.run_ids() : present;
  std::vector<Job> jobs;
  std::int64_t id = 0;
  for (const auto& cell : cells) {
    for (int r = 1; r <= study.repetitions; ++r) {
      ++id;
      if (!keep.contains(id)) {
        jobs.push_back({id, cell.get(), r});
      } else if (r == 1 && database.config_hash(id) != cell->config_hash()) {
        throw InputError(options.database, 0,
                         "run " + std::to_string(id) + " of study '" + study.name +
                             "' was made from other settings than the study has now; give another "
                             "--out, or remove the file to start over");
      }
    }
  }
  if (!keep.empty() && *keep.rbegin() > id) {
    throw InputError(options.database, 0,
                     "holds more runs than the study '" + study.name + "' has; give another --out");
  }
  return jobs;
}

std::string cell_text(const Cell& cell) {
  std::string text;
  for (const auto& [axis, label] : cell.labels) {
    text += (text.empty() ? "" : " ") + axis + "=" + label_text(label);
  }
  return text;
}

std::string config_of(const Study& study, const std::vector<std::unique_ptr<CellScenario>>& cells) {
  // Only what decides the runs: claims and figures may change without making runs stale.
  nlohmann::ordered_json config;
  config["scenario"] = std::filesystem::path(study.scenario_file).filename().string();
  config["repetitions"] = study.repetitions;
  config["seed"] = study.seed;
  for (const auto& cell : cells) config["cells"].push_back(cell_text(cell->cell()));
  return config.dump();
}

}  // namespace

SweepSummary sweep_study(const Study& study, const Catalog& catalog, const SweepOptions& options) {
  const auto begin = Clock::now();
  std::vector<std::unique_ptr<CellScenario>> cell_scenarios;
  for (Cell& cell : cells(study)) {
    cell_scenarios.push_back(std::make_unique<CellScenario>(study, std::move(cell)));
  }
  LogCache logs;
  for (const auto& cell : cell_scenarios) cell->get(catalog, logs);  // all errors before any run
  if (options.ready) options.ready();
  DatabaseWriter database(options.database);
  database.add_study({study.name, std::filesystem::path(study.file).filename().string(),
                      config_of(study, cell_scenarios)});
  SweepSummary summary;
  summary.runs = static_cast<std::int64_t>(cell_scenarios.size()) * study.repetitions;
  std::vector<Job> jobs = open_jobs(study, options, database, cell_scenarios);
  database.commit();
  summary.present = summary.runs - static_cast<std::int64_t>(jobs.size());

  const auto total = static_cast<std::int64_t>(jobs.size());
  auto last_commit = Clock::now();
  const auto store = [&](const Job& job, const Outcome& outcome) {
    if (!outcome.input_error.empty()) throw InputError(outcome.input_error);
    database.add(row_of(job, study, outcome.finished), outcome.finished.run->record());
    ++summary.done;
    if (!outcome.finished.end.ok() && ++summary.failed == 1) {
      summary.first_failure = "run " + std::to_string(job.id) + " (" + cell_text(job.cell->cell()) +
                              "): " + how_it_ended(outcome.finished.end);
    }
    if (Clock::now() - last_commit < std::chrono::milliseconds(500)) return;
    database.commit();
    last_commit = Clock::now();
    if (options.progress) options.progress(summary.done, total);
  };
  const int threads = options.jobs > 0
                          ? options.jobs
                          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  Conveyor conveyor(std::move(jobs), static_cast<std::size_t>(threads) * 32, store);
  run_all(conveyor, threads, [&] { return work_once(conveyor, study, catalog, logs); });
  summary.interrupted = stop_requested != 0;
  database.close();
  if (options.progress) options.progress(summary.done, total);
  summary.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  return summary;
}

}  // namespace hearsay::program
