#include "net/access.hpp"

#include <algorithm>
#include <sstream>

namespace hearsay {
namespace {

void refuse(const char* name, const char* allowed, double found) {
  std::ostringstream text;
  text << "radio: " << name << " must be " << allowed << ", not " << found;
  throw InputError(text.str());
}

void check(const AccessOptions& options) {
  if (options.slot <= Duration()) refuse("slot_s", "greater than 0", options.slot.seconds());
  if (!(options.send_probability >= 1e-3 && options.send_probability <= 1.0)) {
    refuse("send_probability", "in [0.001, 1]", options.send_probability);
  }
  if (options.slots < 0) refuse("slots", "at least 1", options.slots);
  if (options.interframe < Duration()) {
    refuse("interframe_s", "at least 0", options.interframe.seconds());
  }
  if (options.interframe_garbled < Duration()) {
    refuse("interframe_garbled_s", "at least 0", options.interframe_garbled.seconds());
  }
  if (options.window_min < 1 || options.window_min > 65536) {
    refuse("window_min", "in [1, 65536]", options.window_min);
  }
  if (options.window_max < options.window_min || options.window_max > 65536) {
    refuse("window_max", "in [window_min, 65536]", options.window_max);
  }
}

// Every frame begins with a slot.
class Slotted final : public Access {
 public:
  Slotted(const AccessOptions& options, Simulation& simulation, int radios, AccessUser& user)
      : options_(options),
        simulation_(simulation),
        user_(user),
        cycle_(options.slots > 0 ? options.slots : radios),
        grants_(static_cast<std::size_t>(radios)),
        requests_(static_cast<std::size_t>(radios), 0) {}
  ~Slotted() override {
    for (const EventId grant : grants_) simulation_.cancel(grant);
  }

  void request(AgentId radio, int, Time earliest) override {
    const Duration from = std::max(simulation_.now(), earliest).since_start();
    const Duration whole = from - from % options_.slot;
    std::int64_t slot = whole / options_.slot + (whole < from ? 1 : 0);
    if (options_.sharing == Sharing::tdma) {
      const std::int64_t early = (slot - radio) % cycle_;
      if (early != 0) slot += early < 0 ? -early : cycle_ - early;
    } else {
      slot += passed_over(radio);
    }
    if (slot > Time::never().since_start() / options_.slot) return;  // after the last instant
    grants_[index(radio)] = simulation_.schedule(Time::at(options_.slot * slot), Phase::update,
                                                 [this, radio] { user_.granted(radio); });
  }
  void withdraw(AgentId radio) override { simulation_.cancel(grants_[index(radio)]); }

 private:
  static std::size_t index(AgentId radio) { return static_cast<std::size_t>(radio); }
  // How many slots the radio lets pass. (Bounded, as the draws of one request are.)
  std::int64_t passed_over(AgentId radio) {
    if (options_.send_probability >= 1.0) return 0;
    Stream draws = simulation_.stream_at(Purpose("slotted ALOHA"), Entity::agent(radio),
                                         requests_[index(radio)]++);
    constexpr std::int64_t passed_max = 100'000;
    std::int64_t passed = 0;
    while (passed < passed_max && !draws.bernoulli(options_.send_probability)) ++passed;
    return passed;
  }

  AccessOptions options_;
  Simulation& simulation_;
  AccessUser& user_;
  std::int64_t cycle_;
  std::vector<EventId> grants_;
  std::vector<std::uint64_t> requests_;
};

// A radio that has a frame draws a number of slots. While the air around it is free, and has been
// for the interframe space, they are counted down, and at none it sends. Who sends in the same slot
// cannot hear the other in time.
class CarrierSense final : public Access, public AirListener {
 public:
  CarrierSense(const AccessOptions& options, Simulation& simulation, int radios, AccessUser& user)
      : options_(options),
        simulation_(simulation),
        user_(user),
        stations_(static_cast<std::size_t>(radios)) {}
  ~CarrierSense() override {
    for (const Station& station : stations_) simulation_.cancel(station.grant);
  }

  // (What the radio itself sends takes the air, too: `earliest` says nothing new.)
  void request(AgentId radio, int repetition, Time) override {
    Station& station = stations_[index(radio)];
    std::int64_t window = options_.window_min;
    for (int i = 0; i < repetition && window < options_.window_max; ++i) window *= 2;
    window = std::min<std::int64_t>(window, options_.window_max);
    Stream draws =
        simulation_.stream_at(Purpose("back-off"), Entity::agent(radio), station.requests++);
    station.slots = static_cast<std::int64_t>(draws.below(static_cast<std::uint64_t>(window)));
    station.wants = true;
    if (!station.taken) count_down(radio, options_.interframe);
  }
  void withdraw(AgentId radio) override {
    Station& station = stations_[index(radio)];
    station.wants = station.counts = false;
    simulation_.cancel(station.grant);
  }
  AirListener* listener() override { return this; }

  void air_taken(AgentId radio) override {
    Station& station = stations_[index(radio)];
    station.taken = true;
    const Time now = simulation_.now();
    if (!station.counts || station.sends_at <= now) return;  // too late to hold back
    station.counts = false;
    simulation_.cancel(station.grant);
    if (now > station.counts_from) station.slots -= (now - station.counts_from) / options_.slot;
  }
  void air_free(AgentId radio, bool garbled) override {
    Station& station = stations_[index(radio)];
    station.taken = false;
    if (!station.wants || station.counts) return;
    count_down(radio, options_.interframe + (garbled ? options_.interframe_garbled : Duration()));
  }

 private:
  struct alignas(64) Station {  // a line of the cache
    EventId grant;
    Time counts_from;  // when the first of `slots` begins
    Time sends_at;
    std::int64_t slots = 0;  // still to pass
    std::uint64_t requests = 0;
    bool wants = false;
    bool counts = false;  // down to its grant
    bool taken = false;   // the air
  };
  static std::size_t index(AgentId radio) { return static_cast<std::size_t>(radio); }
  void count_down(AgentId radio, Duration space) {
    Station& station = stations_[index(radio)];
    const Time now = simulation_.now();
    station.counts = true;
    station.counts_from = space < Time::never() - now ? now + space : Time::never();
    const bool in_time = station.slots <= (Time::never() - station.counts_from) / options_.slot;
    station.sends_at =
        in_time ? station.counts_from + options_.slot * station.slots : Time::never();
    station.grant = simulation_.schedule(station.sends_at, Phase::update, [this, radio] {
      stations_[index(radio)].wants = stations_[index(radio)].counts = false;
      user_.granted(radio);
    });
  }

  AccessOptions options_;
  Simulation& simulation_;
  AccessUser& user_;
  std::vector<Station> stations_;
};

}  // namespace

std::unique_ptr<Access> make_access(const AccessOptions& options, Simulation& simulation,
                                    int radios, AccessUser& user) {
  if (options.sharing == Sharing::none) return nullptr;
  check(options);
  if (options.sharing == Sharing::carrier_sense) {
    return std::make_unique<CarrierSense>(options, simulation, radios, user);
  }
  return std::make_unique<Slotted>(options, simulation, radios, user);
}

}  // namespace hearsay
