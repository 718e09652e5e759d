#include "agents/agent.hpp"
#include "tools/hearsay/program.hpp"

using namespace hearsay;

// Estimates a temperature by averaging its own noisy thermometer with whatever it hears.
class Averager final : public Agent {
 public:
  explicit Averager(Context& own)
      : Agent(own), noise_(own.stream("thermometer")), sigma_(own.parameter("sigma_c", 1.0)) {}

  void start() override {
    spawn(sense());
    spawn(talk());
  }
  void on_packet(const Packet& packet) override {
    if (const auto heard = value_of<double>(packet)) mean_c_ += 0.5 * (*heard - mean_c_);
  }

 private:
  Process sense() {
    for (;; mean_c_ += 0.1 * (noise_.normal(20.0, sigma_) - mean_c_)) {
      context().record("mean_c", mean_c_);
      co_await context().sleep(1_s, Phase::measure);
    }
  }
  Process talk() {
    for (;; context().broadcast("mean", bytes_of(mean_c_))) co_await context().sleep(5_s);
  }

  Stream noise_;
  double sigma_, mean_c_ = 15.0;
};

int main(int argc, char** argv) {
  Catalog catalog;
  catalog.add_agent<Averager>("averager", "averages temperatures").add_metric("mean_c", "°C");
  return run_program(argc, argv, catalog);
}
