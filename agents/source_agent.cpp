#include "agents/source_agent.hpp"

#include <algorithm>

namespace hearsay {

SourceAgent::SourceAgent(Context& context, const std::optional<SourceTraffic>& traffic)
    : Agent(context),
      traffic_(traffic),
      message_kind_(context.simulation().record().name("traffic")),
      gaps_(context.stream("traffic arrivals")),
      sizes_(context.stream("traffic sizes")) {}

void SourceAgent::start() {
  if (!traffic_) return;
  if (traffic_->arrivals != SourceTraffic::Arrivals::saturated) return spawn(offer());
  context().tell_of_empty_queue();
  fill();
}

// Arrivals go on while the agent is down, unsent: what comes later is the same without the outage.
Process SourceAgent::offer() {
  const bool periodic = traffic_->arrivals == SourceTraffic::Arrivals::periodic;
  Time arrival = periodic ? Time::at(traffic_->phase) : after(Time());
  while (made_ < traffic_->packets_max && arrival <= context().end()) {
    co_await context().sleep_until(arrival);
    hand_over(context().up());
    arrival = after(arrival);
  }
}

Time SourceAgent::after(Time arrival) {
  Duration gap = traffic_->period;
  if (traffic_->arrivals == SourceTraffic::Arrivals::poisson) {
    constexpr double longest_s = 9e9;  // later than the end of any run
    gap =
        Duration::seconds(std::min(gaps_.exponential(1.0 / traffic_->period.seconds()), longest_s));
  }
  return gap < Time::never() - arrival ? arrival + gap : Time::never();
}

// Has one packet wait. Where the first begins at once, a second does.
void SourceAgent::fill() {
  for (int i = 0; i < 2 && context().up() && context().waiting() == 0; ++i) {
    if (made_ < traffic_->packets_max) hand_over(true);
  }
}

void SourceAgent::hand_over(bool up) {
  const std::uint64_t number = made_++;
  const std::size_t size = traffic_->sizes.draw(sizes_);
  if (!up) return;
  if (payload_.size() < size) payload_.resize(size);
  Outgoing packet;
  packet.kind = message_kind_;
  packet.bytes = std::span<const std::byte>(payload_).first(size);
  packet.receiver = traffic_->receiver;
  packet.tick = number;
  packet.acknowledged = traffic_->acknowledged;
  context().send(packet);
}

void SourceAgent::on_packet(const Packet& packet) {
  ++heard_packets_;
  heard_bytes_ += packet.bytes.size();
  delay_ += context().now() - packet.sent;
}

void SourceAgent::on_up(bool) {
  if (traffic_ && traffic_->arrivals == SourceTraffic::Arrivals::saturated) fill();
}

void SourceAgent::finish() {
  const auto heard = static_cast<double>(heard_packets_);
  context().record_final("heard_packets", heard);
  context().record_final("delay_mean_s", delay_.seconds() / heard);
  context().record_final("goodput_bps",
                         8.0 * static_cast<double>(heard_bytes_) / context().end().seconds());
}

}  // namespace hearsay
