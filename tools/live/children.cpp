#include "tools/live/children.hpp"

#include <fmt/core.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <utility>  // before Boost 1.74's Asio

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/streambuf.hpp>

namespace hearsay::fleet {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto grace = 4s;              ///< to stop in
constexpr std::size_t line_max = 4096;  ///< of a child; what is longer is cut

/// One end of a pipe to a child.
struct Pipe {
  explicit Pipe(asio::io_context& context) : end(context), buffer(line_max) {}
  asio::posix::stream_descriptor end;
  asio::streambuf buffer;
};

struct Child {
  Child(asio::io_context& context, const ChildSpec& spec_)
      : spec(spec_), out(context), error(context) {}
  const ChildSpec& spec;
  pid_t pid = -1;  // −1: over
  Pipe out, error;
  std::string status = "starts";
};

class Children {
 public:
  explicit Children(const std::vector<ChildSpec>& specs)
      : signals_(context_, SIGCHLD, SIGINT, SIGTERM), timer_(context_), specs_(specs) {}

  ChildrenResult run() {
    for (const ChildSpec& spec : specs_) {
      children_.push_back(std::make_unique<Child>(context_, spec));
      start(*children_.back());
    }
    left_ = children_.size();
    await_signal();
    draw();
    context_.run();
    return std::move(result_);
  }

 private:
  void start(Child& child) {
    int out[2], error[2];
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(error, O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe to a child");
    }
    const pid_t parent = getpid();
    child.pid = fork();
    if (child.pid < 0) throw std::runtime_error("no process for a child");
    if (child.pid == 0) become(child.spec, parent, out[1], error[1]);
    close(out[1]);
    close(error[1]);
    child.out.end.assign(out[0]);
    child.error.end.assign(error[0]);
    listen(child, child.out, false);
    listen(child, child.error, true);
  }

  [[noreturn]] static void become(const ChildSpec& spec, pid_t parent, int out, int error) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);
    dup2(out, STDOUT_FILENO);
    dup2(error, STDERR_FILENO);
    std::vector<std::string> words = {"hearsay"};
    words.insert(words.end(), spec.arguments.begin(), spec.arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    execv("/proc/self/exe", pointers.data());
    _exit(127);
  }

  void listen(Child& child, Pipe& pipe, bool is_error) {
    asio::async_read_until(pipe.end, pipe.buffer, '\n',
                           [this, &child, &pipe, is_error](error_code error, std::size_t size) {
                             const bool whole = !error;
                             if (!whole) size = pipe.buffer.size();
                             if (size > 0) take(child, pipe, size, is_error);
                             // A line that is too long comes in pieces.
                             if (whole || error == asio::error::not_found) {
                               listen(child, pipe, is_error);
                             }
                           });
  }

  void take(Child& child, Pipe& pipe, std::size_t size, bool is_error) {
    const char* data = static_cast<const char*>(pipe.buffer.data().data());
    std::string line(data, size);
    pipe.buffer.consume(size);
    if (line.ends_with('\n')) line.pop_back();
    if (is_error) {
      clear();
      fmt::print(stderr, "{}: {}\n", child.spec.name, line);
    } else if (line.starts_with(status_mark)) {
      child.status = line.substr(std::string_view(status_mark).size());
    } else if (&child == children_.front().get()) {
      result_.lines.push_back(line);
    }
    draw();
  }

  void await_signal() {
    signals_.async_wait([this](error_code error, int signal) {
      if (error) return;
      if (signal == SIGCHLD) {
        reap();
      } else {
        if (!stopping_) result_.code = 1;
        stop_all();
      }
      if (left_ > 0) {
        await_signal();
      } else {
        timer_.cancel();
      }
    });
  }

  void reap() {
    int how = 0;
    for (pid_t pid = waitpid(-1, &how, WNOHANG); pid > 0; pid = waitpid(-1, &how, WNOHANG)) {
      for (const auto& child : children_) {
        if (child->pid == pid) ended(*child, how);
      }
    }
  }

  void ended(Child& child, int how) {
    child.pid = -1;
    --left_;
    const bool killed = WIFSIGNALED(how);
    const int code = killed ? 1 : WEXITSTATUS(how);
    child.status = killed ? fmt::format("killed by signal {}", WTERMSIG(how))
                          : (code == 0 ? "done" : fmt::format("failed, exit code {}", code));
    const bool first = &child == children_.front().get();
    if (first && !stopping_) result_.code = code;
    if (!first && !stopping_ && !killed && code != 0) result_.code = 1;
    if (first || (!killed && code != 0)) stop_all();
    draw();
  }

  void stop_all() {
    if (stopping_) return;
    stopping_ = true;
    // Who is being dismissed gets a moment to go by itself.
    timer_.expires_after(500ms);
    timer_.async_wait([this](error_code error) {
      if (error) return;
      kill_all(SIGTERM);
      timer_.expires_after(grace);
      timer_.async_wait([this](error_code cancelled) {
        if (!cancelled) kill_all(SIGKILL);
      });
    });
  }

  void kill_all(int signal) {
    for (const auto& child : children_) {
      if (child->pid > 0) kill(child->pid, signal);
    }
  }

  void clear() {
    if (drawn_ > 0) fmt::print("\x1b[{}A\x1b[J", drawn_);
    drawn_ = 0;
    std::fflush(stdout);
  }

  void draw() {
    if (!terminal_) return;
    clear();
    for (const auto& child : children_) {
      fmt::print("{:<12} {:.100}\n", child->spec.name, child->status);
    }
    drawn_ = children_.size();
    std::fflush(stdout);
  }

  asio::io_context context_;
  asio::signal_set signals_;
  asio::steady_timer timer_;
  const std::vector<ChildSpec>& specs_;
  std::vector<std::unique_ptr<Child>> children_;
  std::size_t left_ = 0;
  std::size_t drawn_ = 0;  // lines
  bool stopping_ = false;
  bool terminal_ = isatty(STDOUT_FILENO) == 1;
  ChildrenResult result_;
};

}  // namespace

ChildrenResult run_children(const std::vector<ChildSpec>& specs) { return Children(specs).run(); }

}  // namespace hearsay::fleet
