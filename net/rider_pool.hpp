// Riders of one kind, reused from packet to packet.
#pragma once

#include <memory>
#include <vector>

#include "net/packet.hpp"

namespace hearsay {

template <class R>
class RiderPool;

/// What a rider R derives from to be kept in a RiderPool<R>: it goes home when nobody uses it.
template <class R>
class PooledRider : public Rider {
 protected:
  explicit PooledRider(std::vector<R*>& home) : home_(home) {}

 private:
  void recycle() override { home_.push_back(static_cast<R*>(this)); }
  std::vector<R*>& home_;
};

/// Must outlive every packet that carries one of its riders. R has a constructor, for this class
/// alone, that takes the list of the free ones.
template <class R>
class RiderPool {
 public:
  RiderPool() = default;
  RiderPool(const RiderPool&) = delete;
  RiderPool& operator=(const RiderPool&) = delete;

  /// One that nobody uses, with what it last carried. `rider` is what the pointer refers to.
  RiderPtr make(R*& rider) {
    if (free_.empty()) {
      riders_.push_back(std::unique_ptr<R>(new R(free_)));
      free_.reserve(riders_.size());
      rider = riders_.back().get();
    } else {
      rider = free_.back();
      free_.pop_back();
    }
    return RiderPtr(rider);
  }

 private:
  std::vector<std::unique_ptr<R>> riders_;
  std::vector<R*> free_;
};

}  // namespace hearsay
