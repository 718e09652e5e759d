#include "sim/kernel/mailbox.hpp"

#include <algorithm>

namespace hearsay {

Waitable::~Waitable() {
  while (first_ != nullptr) remove(*first_);
}

void Waitable::notify() {
  for (Link* link = first_; link != nullptr; link = link->next) link->waiter->notice();
}

void Waitable::append(Link& link) {
  link.on = this;
  link.previous = last_;
  link.next = nullptr;
  (last_ != nullptr ? last_->next : first_) = &link;
  last_ = &link;
}

void Waitable::remove(Link& link) {
  (link.previous != nullptr ? link.previous->next : first_) = link.next;
  (link.next != nullptr ? link.next->previous : last_) = link.previous;
  link = {link.waiter, nullptr, nullptr, nullptr};
}

void Waiter::wait(Process::Handle handle, std::span<Waitable* const> waitables, Time until) {
  handle_ = handle;
  count_ = waitables.size();
  for (std::size_t i = 0; i < count_; ++i) {
    links_[i].waiter = this;
    waitables[i]->append(links_[i]);
  }
  // Ready already, but others stand before this one.
  if (find_ready()) notice();
  if (until != Time::never()) {
    timeout_ = simulation_.schedule(until, Phase::act, [this] { go_on(std::nullopt); });
  }
}

std::optional<std::size_t> Waiter::find_ready() const {
  for (std::size_t i = 0; i < count_; ++i) {
    if (links_[i].on != nullptr && links_[i].on->ready()) return i;
  }
  return std::nullopt;
}

void Waiter::notice() {
  if (notice_ != EventId()) return;
  notice_ = simulation_.schedule(simulation_.now(), Phase::update, [this] { on_notice(); });
}

void Waiter::on_notice() {
  notice_ = {};
  const std::optional<std::size_t> index = find_ready();
  if (index) go_on(index);
}

void Waiter::go_on(std::optional<std::size_t> woken_by) {
  woken_by_ = woken_by;
  leave();
  Process::resume(handle_);
}

void Waiter::leave() {
  for (std::size_t i = 0; i < count_; ++i) {
    if (links_[i].on != nullptr) links_[i].on->remove(links_[i]);
  }
  simulation_.cancel(std::exchange(notice_, {}));
  simulation_.cancel(std::exchange(timeout_, {}));
}

FirstOf::FirstOf(Simulation& simulation, std::span<Waitable* const> waitables, Duration timeout)
    : Waiter(simulation),
      waitables_{},
      count_(waitables.size()),
      until_(simulation.after(timeout)) {
  require(count_ <= waitables_max, "first_of waits for at most 8 things");
  std::copy(waitables.begin(), waitables.end(), waitables_.begin());
}

bool FirstOf::await_ready() {
  for (std::size_t i = 0; i < count_ && !at_once_; ++i) {
    if (waitables_[i]->ready()) at_once_ = i;
  }
  return at_once_.has_value();
}

void FirstOf::await_suspend(Process::Handle handle) {
  wait(handle, std::span(waitables_).first(count_), until_);
}

}  // namespace hearsay
