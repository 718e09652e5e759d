// The estimator agent: gets measurements, updates, talks now and then, fuses what it hears.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agents/agent.hpp"
#include "agents/alone.hpp"
#include "agents/estimator_witness.hpp"
#include "agents/estimators/gaussian.hpp"
#include "agents/measurement.hpp"
#include "agents/talk/periodic.hpp"
#include "agents/talk/policy.hpp"
#include "filters/gaussian/fusion.hpp"

namespace hearsay {

/// The kind of an estimator's messages: those of one kind are understood by all who encode theirs
/// alike.
const char* message_kind(gaussian::MessageForm form);

class EstimatorAgent final : public Agent, public MeasurementReceiver {
 public:
  struct Options {
    gaussian::Rule rule = gaussian::Rule::none;
    double omega = 0.5;       ///< of ci-fixed, in (0, 1]
    double correction = 1.0;  ///< γ of hybrid-consensus, ≥ 1
    Content content = Content::belief;
    int bits = 8;  ///< of an entry that is quantised, 4 … 16
    int subjects = 1;
    int dimension = 2;
    std::optional<MotionModel> motion;  ///< of the subjects; nothing: they stand still
    /// T in stamps: it believes in trajectories; nothing: in states as they are now.
    std::optional<int> window;
    std::optional<PeriodicTalk> talk;  ///< the ticks; nothing: neither talks nor fuses at ticks
    TalkPolicy::Options policy;        ///< at which ticks it talks
    bool listens_only = false;         ///< at none: what it holds is fused then
  };
  EstimatorAgent(Context& context, EstimatorWitness& witness, Options options);

  void start() override;
  void on_measurement(const Measurement& measurement) override;
  void on_packet(const Packet& packet) override;
  void on_up(bool forgets) override;
  bool save(std::vector<std::byte>& memory) const override { return estimator_->save(memory); }
  bool recall(std::span<const std::byte> memory) override;
  void finish() override;

  const Estimator& estimator() const { return *estimator_; }

 private:
  static std::unique_ptr<Estimator> make_estimator(Context& context, EstimatorWitness& witness,
                                                   const Options& options);
  /// How far the measurement is from what is believed, just before it is used.
  void compare(int subject, const gaussian::Belief& information);
  /// Of the present; 0 where states stand still.
  std::int64_t stamp() const;
  /// Brings the estimator to the present.
  void advance();
  Process talk();
  std::uint64_t speak_or_not(std::uint64_t tick);
  void say(std::uint64_t tick);
  void say_to(AgentId receiver, std::uint64_t tick);

  EstimatorWitness& witness_;
  Options options_;
  std::unique_ptr<Estimator> estimator_;
  NameId message_kind_;
  TalkPolicy policy_;
  bool measured_since_sent_ = false;
  Alone alone_;
  double nis_sum_ = 0.0;  // of NIS / m
  std::uint64_t nis_count_ = 0;
  std::vector<AgentId> listeners_;  // of the talk that is being held
};

}  // namespace hearsay
