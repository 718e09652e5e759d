// A world in another process, as an agent sees it; and what an agent there can be asked.
//
// Beside its radio and its witness an agent may need things of its world: a body on its floor, what
// a sensor sees. Each has an interface; in the agent's process something stands there that asks
// across, in the world somebody answers. Questions and answers are bytes (agents/packing), the
// first of a question its kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "agents/estimator_witness.hpp"
#include "agents/packing.hpp"
#include "net/radio_port.hpp"
#include "net/steering.hpp"

namespace hearsay::remote {

enum class Question : std::uint8_t {
  steer,      ///< a note: move along a leg
  plots,      ///< of a tracker: PlotSource
  look,       ///< of an explorer: LookSource
  saw_place,  ///< of a localizer: SightingAccount, a note, as the next
  saw_robot,
  // Of a robot: RobotBody, TrailAccount.
  pose,
  scan,
  drive,
  happens,
  put_back,
  way,
  sets_off,
  drove,
  arrived,
  dropped,
  told,
  gave_up,
  learned,
  all_arrived,
};
constexpr Question question_last = Question::all_arrived;

/// Thrown through an agent's code when its world is gone, or wants to hear no more of its life.
struct WorldGone {};

/// The way to the world for what stands in its place.
class Asker {
 public:
  virtual ~Asker() = default;
  /// Asks and waits for the answer, which is valid until anything else is asked or told.
  /// @throws WorldGone if none will come.
  virtual std::span<const std::byte> ask(std::span<const std::byte> question) = 0;
  /// Tells what needs no answer. It comes before whatever the agent asks or does next.
  virtual void note(std::span<const std::byte> note) = 0;
};

/// A question or a note in the making, and its way. Reuses its room.
class Asking {
 public:
  /// `asker` outlives this.
  explicit Asking(Asker& asker) : asker_(asker) {}
  Packer begin(Question question) {
    bytes_.clear();
    Packer out(bytes_);
    out.u8(static_cast<std::uint8_t>(question));
    return out;
  }
  Unpacker ask() { return Unpacker(asker_.ask(bytes_)); }
  void note() { asker_.note(bytes_); }

 private:
  Asker& asker_;
  std::vector<std::byte> bytes_;
};

/// All that an agent sees of a world in another process.
class DistantWorld : public RadioPort, public EstimatorWitness, public Steering, public Asker {};

/// What an agent tells of itself whenever its world wants to know; nullptr where it is asked for
/// its beliefs alone.
class Reporter {
 public:
  virtual ~Reporter() = default;
  virtual void report(Packer& out) = 0;
};

class StandIn;

/// Who answers in the world for an agent elsewhere, and knows what its Reporter tells.
class Desk {
 public:
  virtual ~Desk() = default;
  /// From now on it is `agent` that reports; before, nothing is known. It outlives this.
  void attach(StandIn& agent) { agent_ = &agent; }
  /// Reads what follows the kind of a question, all of it before it acts, and writes the answer;
  /// nothing for a note. @throws BrokenInvariant, and nothing has happened, for a question that is
  /// malformed or none of its.
  virtual void answer(Question question, Unpacker& in, Packer& out) = 0;
  /// Whether a report is one that such an agent can make. (In real time whoever is on the network
  /// may write one.)
  virtual bool is_sound(std::span<const std::byte> report) const = 0;

 protected:
  /// What was reported; empty if nobody knows. Valid until anything else happens.
  Unpacker state() const;

 private:
  StandIn* agent_ = nullptr;
};

/// @throws BrokenInvariant unless all was there, and nothing is left.
void require_whole(const Unpacker& in);

void put(Packer& out, const Leg& leg);
Leg take_leg(Unpacker& in);

}  // namespace hearsay::remote
