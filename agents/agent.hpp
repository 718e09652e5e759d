// An agent: something with a radio and a behaviour over time.
//
// Behaviour over time is written as coroutines that start() spawns; reactions to packets go into
// on_packet(). README.md shows a whole agent in forty lines.
#pragma once

#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "agents/context.hpp"

namespace hearsay {

class Agent : public Receiver {
 public:
  /// `context` outlives the agent.
  explicit Agent(Context& context) : context_(context) {}

  /// Called once, at time 0, before any event.
  virtual void start() = 0;
  /// Called for each packet that arrives. Most agents react by remembering.
  void on_packet(const Packet& packet) override { static_cast<void>(packet); }
  /// The agent failed: its radio is off until on_up(). Its processes go on; they ask
  /// context().up() before they look or talk.
  virtual void on_down() {}
  /// It is back; `forgets` if it lost its memory.
  virtual void on_up(bool forgets) { static_cast<void>(forgets); }
  /// All that it remembers, in place of what `memory` held, so that another process can take its
  /// place. @return false if agents of its kind cannot be saved.
  virtual bool save(std::vector<std::byte>& memory) const {
    static_cast<void>(memory);
    return false;
  }
  /// Called once after start(): takes up what was saved. @return false, and nothing is changed, if
  /// that is of another kind of agent, or damaged.
  virtual bool recall(std::span<const std::byte> memory) {
    static_cast<void>(memory);
    return false;
  }
  /// Called once after the last event, to leave final values in the record.
  virtual void finish() {}

 protected:
  Context& context() { return context_; }
  const Context& context() const { return context_; }
  /// Starts a process of this agent; the agent owns it.
  void spawn(Process process) {
    processes_.push_back(std::move(process));
    processes_.back().start(context_.simulation(), context_.id());
  }

 private:
  Context& context_;
  std::vector<Process> processes_;
};

/// The bytes of a plain value, to be sent between agents of one program.
template <class T>
requires std::is_trivially_copyable_v<T> std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

/// The plain value a packet carries; nothing if its size is another.
template <class T>
requires std::is_trivially_copyable_v<T> std::optional<T> value_of(const Packet& packet) {
  if (packet.bytes.size() != sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, packet.bytes.data(), sizeof(T));
  return value;
}

}  // namespace hearsay
