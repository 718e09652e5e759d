#include "agents/estimator_agent.hpp"

#include <cmath>
#include <utility>

#include "agents/estimators/shared_trajectories.hpp"
#include "agents/estimators/whole_trajectories.hpp"
#include "filters/gaussian/distance.hpp"

namespace hearsay {
namespace {

gaussian::MessageForm form_of(const EstimatorAgent::Options& options) {
  return options.window ? gaussian::MessageForm::plain
                        : message_form(options.rule, options.content);
}

}  // namespace

const char* message_kind(gaussian::MessageForm form) {
  using gaussian::MessageForm;
  switch (form) {
    case MessageForm::split:
      return "gaussian-split";
    case MessageForm::consensus:
      return "gaussian-consensus";
    case MessageForm::hybrid:
      return "gaussian-hybrid";
    case MessageForm::diagonal:
      return "gaussian-diagonal";
    case MessageForm::quantised:
      return "gaussian-quantised";
    case MessageForm::plain:
      break;
  }
  return "gaussian";
}

EstimatorAgent::EstimatorAgent(Context& context, EstimatorWitness& witness, Options options)
    : Agent(context),
      witness_(witness),
      options_(std::move(options)),
      estimator_(make_estimator(context, witness, options_)),
      message_kind_(context.simulation().record().name(hearsay::message_kind(form_of(options_)))),
      policy_(options_.policy),
      alone_(options_.subjects, options_.dimension, options_.motion) {
  witness_.watch(context.id(), *estimator_);
}

std::unique_ptr<Estimator> EstimatorAgent::make_estimator(Context& context,
                                                          EstimatorWitness& witness,
                                                          const Options& options) {
  if (!options.window) {
    return std::make_unique<GaussianEstimator>(
        GaussianEstimator::Options{.rule = options.rule,
                                   .omega = options.omega,
                                   .correction = options.correction,
                                   .content = options.content,
                                   .bits = options.bits,
                                   .exact = options.policy.kind != TalkPolicyKind::event_triggered,
                                   .subjects = options.subjects,
                                   .dimension = options.dimension,
                                   .motion = options.motion,
                                   .ledgers = witness.ledgers(),
                                   .workspace = &witness.workspace(),
                                   .strangers = context.hears_strangers()},
        context.neighbours());
  }
  if (const auto exchange = exchange_of(options.rule)) {
    return std::make_unique<SharedTrajectories>(
        SharedTrajectories::Options{.exchange = *exchange,
                                    .subjects = options.subjects,
                                    .motion = options.motion.value(),
                                    .steps_max = *options.window,
                                    .ledgers = witness.ledgers(),
                                    .workspace = &witness.workspace()});
  }
  return std::make_unique<WholeTrajectories>(
      WholeTrajectories::Options{.rule = options.rule,
                                 .subjects = options.subjects,
                                 .motion = options.motion.value(),
                                 .steps_max = *options.window,
                                 .ledgers = witness.ledgers(),
                                 .workspace = &witness.workspace()},
      context.neighbours());
}

bool EstimatorAgent::recall(std::span<const std::byte> memory) {
  if (!estimator_->recall(memory)) return false;
  advance();
  return true;
}

std::int64_t EstimatorAgent::stamp() const {
  return options_.motion ? options_.motion->stamp_at(context().now()) : 0;
}

void EstimatorAgent::advance() {
  if (options_.motion) estimator_->advance(stamp());
}

void EstimatorAgent::start() {
  const bool speaks = gaussian::info(options_.rule).sends != gaussian::Sends::nothing;
  if (options_.talk && speaks) spawn(talk());
}

void EstimatorAgent::on_packet(const Packet& packet) {
  if (packet.kind != message_kind_) return;
  advance();
  estimator_->heard(packet.sender, packet.bytes, packet.rider);
}

void EstimatorAgent::on_up(bool forgets) {
  if (!forgets) return;
  advance();
  estimator_->forget();
  alone_.forget();
}

void EstimatorAgent::on_measurement(const Measurement& measurement) {
  const int subject = measurement.subject;
  advance();
  compare(subject, measurement.information);
  const gaussian::Belief whole = gaussian::lifted(measurement.information, options_.dimension);
  alone_.measured(subject, whole, stamp());
  estimator_->measured(subject, whole, measurement.index);
  measured_since_sent_ = true;
}

void EstimatorAgent::compare(int subject, const gaussian::Belief& information) {
  const gaussian::Belief* expectation = estimator_->expectation(subject);
  if (expectation == nullptr) return;
  const auto nis = gaussian::nis(*expectation, information);
  if (!nis) return;
  nis_sum_ += *nis / information.dimension();
  ++nis_count_;
}

void EstimatorAgent::finish() {
  advance();
  Record& record = context().simulation().record();
  record.scalar(context().id(), record.name("nis_mean"),
                nis_sum_ / static_cast<double>(nis_count_));
  double saved_m = 0.0;
  int seen = 0;
  for (int s = 0; s < options_.subjects; ++s) {
    const double alone_m = witness_.distance_error_m(s, alone_.at(s, stamp()));
    if (std::isnan(alone_m)) continue;
    saved_m += alone_m - witness_.distance_error_m(s, estimator_->tracked(s).belief);
    ++seen;
  }
  record.scalar(context().id(), record.name("distance_saved_m"), saved_m / seen);
}

Process EstimatorAgent::talk() {
  for (std::uint64_t tick = options_.talk->next_tick(context().now());;) {
    const Time when = options_.talk->tick(tick);
    co_await context().sleep_until(when);
    tick += speak_or_not(tick);
  }
}

/// @return after how many ticks the agent asks itself again.
std::uint64_t EstimatorAgent::speak_or_not(std::uint64_t tick) {
  if (!context().up()) return 1;
  advance();
  estimator_->about_to_talk(static_cast<int>(context().neighbours().size()));
  if (options_.listens_only) return 1;
  const TalkPolicy::Decision decision =
      policy_.decide({.measured = measured_since_sent_,
                      .divergence_nats = policy_.wants_divergence() ? estimator_->news_nats() : 0.0,
                      .waiting = context().waiting()});
  if (decision.talks) say(tick);
  return decision.ticks;
}

void EstimatorAgent::say(std::uint64_t tick) {
  if (gaussian::info(options_.rule).sends != gaussian::Sends::belief_less_heard) {
    return say_to(no_agent, tick);
  }
  const std::span<const AgentId> now = context().neighbours();
  listeners_.assign(now.begin(), now.end());
  for (const AgentId neighbour : listeners_) say_to(neighbour, tick);
}

void EstimatorAgent::say_to(AgentId receiver, std::uint64_t tick) {
  const Estimator::Speech speech = estimator_->speech(receiver);
  if (speech.bytes.empty()) return;
  Outgoing packet;
  packet.kind = message_kind_;
  packet.bytes = speech.bytes;
  packet.receiver = receiver;
  packet.tick = tick;
  packet.rider = speech.rider;
  // A belief is news of the one before. An update is not: it has what the one before has not.
  // (Of trajectories everything in the window is told again.)
  const bool update =
      gaussian::info(options_.rule).sends == gaussian::Sends::local_update && !options_.window;
  packet.subject = update ? tick : static_cast<std::uint64_t>(context().id());
  if (!context().send(packet)) return;
  estimator_->sent(receiver);
  measured_since_sent_ = false;
}

}  // namespace hearsay
