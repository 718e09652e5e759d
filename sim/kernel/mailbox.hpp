// What processes wait for besides time: mailboxes and signals, one or several, with a time-out.
//
//   Mailbox<Packet> inbox(simulation, 16);        // callbacks put, processes receive
//   Packet packet = co_await inbox.receive();
//   std::optional<Packet> soon = co_await inbox.receive_within(2_s);
//
//   Waitable* const both[] = {&inbox, &stop};
//   std::optional<std::size_t> which = co_await first_of(simulation, both, 2_s);
//
// Who waits is woken through the event queue, in Phase::update of the same instant, hence before
// anybody acts; time-outs come in Phase::act, so at one instant an item wins over a time-out.
// Nothing here allocates but the mailbox's ring. Cancelling a process that waits is safe at any
// moment. What has ended while somebody waits for it never wakes him.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/process.hpp"
#include "sim/kernel/simulation.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// A time-out that never comes.
inline constexpr Duration forever = Duration::nanoseconds(INT64_MAX);

class Waiter;

/// Something a process can wait for: it is ready, or becomes so and then notifies.
class Waitable {
 public:
  explicit Waitable(Simulation& simulation) : simulation_(simulation) {}
  Waitable(const Waitable&) = delete;
  Waitable& operator=(const Waitable&) = delete;
  virtual ~Waitable();

  virtual bool ready() const = 0;
  bool has_waiters() const { return first_ != nullptr; }

 protected:
  /// Wakes all who wait, in the order in which they came. Who then finds it not ready, because an
  /// earlier one took the item, waits on in his place.
  void notify();
  Simulation& simulation() const { return simulation_; }

 private:
  friend class Waiter;
  /// One waiter's place in the line of one waitable.
  struct Link {
    Waiter* waiter = nullptr;
    Waitable* on = nullptr;  // null: in no line
    Link* previous = nullptr;
    Link* next = nullptr;
  };
  void append(Link& link);
  void remove(Link& link);

  Simulation& simulation_;
  Link* first_ = nullptr;
  Link* last_ = nullptr;
};

/// Base of the awaitables below: one process that stands in the line of some waitables. Leaves all
/// lines and takes back its events when it is destroyed.
class Waiter {
 public:
  static constexpr std::size_t waitables_max = 8;

  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;

 protected:
  explicit Waiter(Simulation& simulation) : simulation_(simulation) {}
  ~Waiter() { leave(); }

  /// Waits on all of `waitables` until one is ready, or to the end of `timeout`.
  void wait(Process::Handle handle, std::span<Waitable* const> waitables, Time until);
  /// Which of them was ready; none after the time-out.
  std::optional<std::size_t> woken_by() const { return woken_by_; }

 private:
  friend class Waitable;
  std::optional<std::size_t> find_ready() const;
  void notice();
  void on_notice();
  void go_on(std::optional<std::size_t> woken_by);
  void leave();

  Simulation& simulation_;
  Process::Handle handle_;
  std::array<Waitable::Link, waitables_max> links_;
  std::size_t count_ = 0;
  EventId notice_;
  EventId timeout_;
  std::optional<std::size_t> woken_by_;
};

/// A bounded first-in-first-out line of items between callbacks and processes. Several processes
/// may wait on one: they are served in the order in which they came.
template <class T>
class Mailbox : public Waitable {
 public:
  /// Holds at most `capacity` ≥ 1 items.
  Mailbox(Simulation& simulation, std::size_t capacity) : Waitable(simulation), ring_(capacity) {
    require(capacity >= 1, "a mailbox needs room for at least one item");
  }

  /// Adds `item` at the end. False, and counted in dropped(), if the mailbox is full.
  bool put(T item) {
    if (size_ == ring_.size()) {
      ++dropped_;
      return false;
    }
    ring_[(front_ + size_) % ring_.size()].emplace(std::move(item));
    ++size_;
    notify();
    return true;
  }
  /// Takes the first item at once, if there is one, past those who wait.
  std::optional<T> try_receive() {
    if (size_ == 0) return std::nullopt;
    return take();
  }

  std::size_t size() const { return size_; }
  std::uint64_t dropped() const { return dropped_; }
  bool ready() const override { return size_ > 0; }

  class [[nodiscard]] Receive : private Waiter {
   public:
    explicit Receive(Mailbox& box) : Waiter(box.simulation()), box_(box) {}
    bool await_ready() const { return box_.ready() && !box_.has_waiters(); }
    void await_suspend(Process::Handle handle) {
      Waitable* const one[] = {&box_};
      wait(handle, one, Time::never());
    }
    T await_resume() { return box_.take(); }

   private:
    Mailbox& box_;
  };
  class [[nodiscard]] ReceiveWithin : private Waiter {
   public:
    ReceiveWithin(Mailbox& box, Duration timeout)
        : Waiter(box.simulation()), box_(box), until_(box.simulation().after(timeout)) {}
    bool await_ready() {
      at_once_ = box_.ready() && !box_.has_waiters();
      return at_once_;
    }
    void await_suspend(Process::Handle handle) {
      Waitable* const one[] = {&box_};
      wait(handle, one, until_);
    }
    std::optional<T> await_resume() {
      if (!at_once_ && !woken_by()) return std::nullopt;
      return box_.take();
    }

   private:
    Mailbox& box_;
    Time until_;
    bool at_once_ = false;
  };

  /// co_await box.receive(): the next item, T.
  Receive receive() { return Receive(*this); }
  /// co_await box.receive_within(2_s): the next item, or nothing if none comes in time,
  /// std::optional<T>. A negative span counts as zero.
  ReceiveWithin receive_within(Duration timeout) { return ReceiveWithin(*this, timeout); }

 private:
  T take() {
    std::optional<T>& first = ring_[front_];
    T item = std::move(*first);
    first.reset();
    front_ = (front_ + 1) % ring_.size();
    --size_;
    return item;
  }

  std::vector<std::optional<T>> ring_;
  std::size_t front_ = 0;
  std::size_t size_ = 0;
  std::uint64_t dropped_ = 0;
};

/// Awaitable of first_of().
class [[nodiscard]] FirstOf : private Waiter {
 public:
  FirstOf(Simulation& simulation, std::span<Waitable* const> waitables, Duration timeout);
  bool await_ready();
  void await_suspend(Process::Handle handle);
  std::optional<std::size_t> await_resume() const { return at_once_ ? at_once_ : woken_by(); }

 private:
  std::array<Waitable*, waitables_max> waitables_;
  std::size_t count_;
  Time until_;
  std::optional<std::size_t> at_once_;
};

/// co_await first_of(simulation, both, 5_s): the index of the first of `waitables` (at most 8) that
/// is ready, or nothing after `timeout`: std::optional<std::size_t>. If several are ready at one
/// instant, the one named first. It takes nothing: use try_receive() then. `waitables` is copied.
inline FirstOf first_of(Simulation& simulation, std::span<Waitable* const> waitables,
                        Duration timeout) {
  return FirstOf(simulation, waitables, timeout);
}

/// A flag that processes wait for: once fired it stays ready until it is cleared.
class Signal : public Waitable {
 public:
  using Waitable::Waitable;
  void fire() {
    fired_ = true;
    notify();
  }
  void clear() { fired_ = false; }
  bool ready() const override { return fired_; }

  /// co_await signal.wait(): go on when it is fired, at once if it is.
  FirstOf wait() {
    Waitable* const one[] = {this};
    return FirstOf(simulation(), one, forever);
  }

 private:
  bool fired_ = false;
};

}  // namespace hearsay
