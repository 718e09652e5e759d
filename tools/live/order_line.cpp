#include "tools/live/order_line.hpp"

#include <utility>

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;

/// How often it is looked whether the world is alive while nothing comes.
constexpr auto patience = 100ms;

}  // namespace

OrderLine::OrderLine(live::Reader& orders, live::Writer& answers, Reactor& reactor, AgentId id,
                     std::function<void(const remote::Order&)> seen)
    : orders_(orders), answers_(answers), reactor_(reactor), seen_(std::move(seen)) {
  frame_.agent = static_cast<std::uint32_t>(id);
}

bool OrderLine::receive(remote::Order& order) {
  live::Frame frame;
  while (orders_.take(bytes_)) {
    if (!live::decode(bytes_, frame) || !remote::unpack(frame.content, order)) continue;
    seen_(order);
    return true;
  }
  return false;
}

bool OrderLine::take(remote::Order& order) {
  if (waiting_.empty()) return receive(order);
  order = std::move(waiting_.front());
  waiting_.pop_front();
  life_over_ = life_over_ && !waiting_.empty();
  return true;
}

bool OrderLine::gone() {
  gone_ = gone_ || waiting_.size() > orders_max || presence_.gone(orders_.writers_alive() > 0);
  return gone_;
}

void OrderLine::send(remote::AnswerKind kind) {
  answer_.kind = kind;
  remote::pack(answer_, frame_.content);
  answer_.notes.clear();
  answer_.content.clear();
  live::encode(frame_, bytes_);
  while (!answers_.write(bytes_) && !reactor_.stopped() && !gone()) {
    reactor_.wait(WallClock::now());
  }
}

void OrderLine::tell() {
  if (!answer_.notes.empty() || !answer_.content.empty()) send(remote::AnswerKind::done);
}

const remote::Order& OrderLine::ask(std::span<const std::byte> question) {
  answer_.content.assign(question.begin(), question.end());
  answer_.number = ++asked_;
  send(remote::AnswerKind::ask);
  while (!reactor_.stopped() && !gone() && !life_over_) {
    remote::Order order;
    while (!life_over_ && receive(order)) {
      if (order.kind == remote::OrderKind::go_on && order.number == asked_) {
        go_on_ = std::move(order);
        return go_on_;
      }
      life_over_ =
          order.kind == remote::OrderKind::start || order.kind == remote::OrderKind::dismiss;
      waiting_.push_back(std::move(order));
    }
    if (!life_over_) reactor_.wait(WallClock::now() + patience);
  }
  throw remote::WorldGone();
}

}  // namespace hearsay::fleet
