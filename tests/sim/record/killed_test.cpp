// A writer that is killed at any moment, and its continuation.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include "sample.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr std::int64_t runs = 60;
constexpr std::int64_t batch = 7;

/// Adds what is missing, as a sweep does. Calls `step` after each thing done.
template <typename Step>
void write_all(const std::string& file, Step step) {
  DatabaseWriter writer(file);
  step();
  writer.add_study(sample::study);
  const std::set<std::int64_t> there = writer.run_ids();
  for (std::int64_t id = 1; id <= runs; ++id) {
    if (there.contains(id)) continue;
    sample::add(writer, id, static_cast<double>(getpid()));  // wall times differ
    step();
    if (id % batch != 0) continue;
    writer.commit();
    step();
  }
  writer.close();
  step();
}

/// Runs write_all in a process that is killed `after` so many steps: by itself, hence exactly
/// there, or from outside, hence somewhere in what follows.
void write_killed(const std::string& file, int after, bool from_outside) {
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    int steps = 0;
    try {
      write_all(file, [&] {
        const char byte = 0;
        if (write(pipe_ends[1], &byte, 1) != 1) _exit(1);
        if (++steps == after && !from_outside) raise(SIGKILL);
      });
    } catch (const std::exception&) {
      _exit(1);  // not into the test framework of a second process
    }
    _exit(0);
  }
  close(pipe_ends[1]);
  char byte;
  for (int steps = 0; (!from_outside || steps < after) && read(pipe_ends[0], &byte, 1) == 1;) {
    ++steps;
  }
  if (from_outside) kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  close(pipe_ends[0]);
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0);
}

class Killed : public testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(Killed, WriterLeavesAPrefixThatIsContinuedToTheSameContent) {
  const auto [after, from_outside] = GetParam();
  const sample::Directory directory;
  const std::string whole = directory / "whole.db";
  const std::string killed = directory / "killed.db";
  write_all(whole, [] {});
  write_killed(killed, after, from_outside);
  {
    DatabaseWriter writer(killed);
    const std::set<std::int64_t> there = writer.run_ids();
    if (!from_outside) {
      EXPECT_LT(there.size(), static_cast<std::size_t>(runs));
    }
    if (!there.empty()) {
      EXPECT_EQ(*there.rbegin(), static_cast<std::int64_t>(there.size()));
    }
    EXPECT_TRUE(there.size() % batch == 0 || there.size() == runs);
  }
  write_killed(killed, 11, from_outside);  // and once more on its way
  write_all(killed, [] {});
  EXPECT_EQ(first_difference(whole, killed, {}), std::nullopt);
  EXPECT_EQ(sample::everything(whole), sample::everything(killed));
  EXPECT_EQ(directory.files().size(), 2u);  // nothing beside the two
}

INSTANTIATE_TEST_SUITE_P(AtAStep, Killed,
                         testing::Combine(testing::Values(1, 2, 8, 9, 10, 25, 40, 60),
                                          testing::Values(false)));
INSTANTIATE_TEST_SUITE_P(AnyWhere, Killed,
                         testing::Combine(testing::Values(0, 1, 3, 8, 9, 17, 26, 41, 57, 68),
                                          testing::Values(true)));

TEST(KilledWriter, HoldsTheFileNoLonger) {
  const sample::Directory directory;
  const std::string file = directory / "a.db";
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    DatabaseWriter writer(file);
    const char byte = 0;
    if (write(pipe_ends[1], &byte, 1) != 1) _exit(1);
    for (;;) pause();
  }
  char byte;
  ASSERT_EQ(read(pipe_ends[0], &byte, 1), 1);
  try {
    DatabaseWriter second(file);
    ADD_FAILURE() << "two writers";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()), file + ": is being written by another process");
  }
  kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  close(pipe_ends[0]);
  close(pipe_ends[1]);
  DatabaseWriter next(file);
  EXPECT_TRUE(next.run_ids().empty());
}

}  // namespace
}  // namespace hearsay
