#include "tools/live/reactor.hpp"

#include <unistd.h>

#include <csignal>
#include <utility>  // before Boost 1.74's Asio

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>

namespace hearsay::fleet {

namespace asio = boost::asio;
using boost::system::error_code;

struct Reactor::Impl {
  explicit Impl(live::Port& port_)
      : port(port_),
        signals(context, SIGINT, SIGTERM),
        wake(context, dup(port_.wake_fd())),
        timer(context) {
    signals.async_wait([this](error_code error, int) { stopped = stopped || !error; });
  }
  void listen() {
    if (listening) return;
    listening = true;
    wake.async_wait(asio::posix::stream_descriptor::wait_read, [this](error_code error) {
      listening = false;
      news = news || !error;
    });
  }

  live::Port& port;
  asio::io_context context;
  asio::signal_set signals;
  asio::posix::stream_descriptor wake;
  asio::steady_timer timer;
  bool listening = false, news = false, stopped = false;
};

Reactor::Reactor(live::Port& port) : impl_(std::make_unique<Impl>(port)) {}
Reactor::~Reactor() = default;

bool Reactor::wait(WallTime until) {
  Impl& me = *impl_;
  me.news = false;
  me.listen();
  bool over = false;
  me.timer.expires_at(until);
  me.timer.async_wait([&over](error_code error) { over = over || !error; });
  while (!me.news && !over && !me.stopped) me.context.run_one();
  if (!over) {
    me.timer.cancel();
    me.context.poll();  // its handler refers to `over`
  }
  if (me.news) me.port.drain();
  return me.news;
}

bool Reactor::stopped() const { return impl_->stopped; }

}  // namespace hearsay::fleet
