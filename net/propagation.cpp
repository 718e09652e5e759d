#include "net/propagation.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr PurposeOnLink reception{Purpose("reception of a tick"), Purpose("reception of a packet"),
                                  Purpose("reception of a repetition")};
constexpr Purpose shadowing("shadowing");

// Twice the data rate over the noise bandwidth: BER = ½ exp(−γ/1.28).
constexpr double gamma_scale = 1.28;

std::string must_be(const char* name, const char* allowed, double found) {
  std::ostringstream text;
  text << name << " must be " << allowed << ", not " << found;
  return text.str();
}

bool in_range(double value, double low, double high) { return value >= low && value <= high; }

void refuse(const char* model, const std::string& wrong) {
  if (!wrong.empty()) throw InputError(std::string(model) + ": " + wrong);
}

double log_bit_success(double snr_db) {
  const double gamma = mw_of_dbm(snr_db);
  return math::log1p(-0.5 * math::exp(-gamma / gamma_scale));
}

// The other way round: at which SNR a frame of so many bytes has this success, in (½^(8 bytes), 1).
double snr_db_for(double success, std::uint32_t bytes) {
  const double ber = -math::expm1(math::log(success) / (8.0 * bytes));
  return dbm_of_mw(-gamma_scale * math::log(2.0 * ber));
}

// Beyond which even a lucky link hears next to nothing; below d0 if none does anywhere.
double default_reach_m(const LogDistance& path) {
  const double least_snr_db =
      snr_db_for(LogDistance::reach_success, LogDistance::reach_frame_bytes);
  const double spare_db = path.transmit_dbm - path.noise_dbm - path.reference_loss_db +
                          LogDistance::reach_sigmas * path.shadowing_sigma_db - least_snr_db;
  return path.reference_m * math::pow(10.0, spare_db / (10.0 * path.exponent));
}

}  // namespace

double mw_of_dbm(double dbm) { return math::pow(10.0, dbm / 10.0); }
double dbm_of_mw(double mw) { return 10.0 * math::log10(mw); }

std::string wrong_with(const GreyZone& zone) {
  if (!(zone.inner_m >= 0.0) || !std::isfinite(zone.inner_m)) {
    return must_be("inner_m", "at least 0 and finite", zone.inner_m);
  }
  if (!(zone.outer_m > 0.0) || !std::isfinite(zone.outer_m)) {
    return must_be("outer_m", "positive and finite", zone.outer_m);
  }
  if (zone.outer_m < zone.inner_m) {
    return must_be("outer_m", "at least inner_m", zone.outer_m);
  }
  return {};
}

std::string wrong_with(const LogDistance& path) {
  constexpr double db_max = 200.0;
  const auto no_db = [](const char* name, double value) {
    return in_range(value, -db_max, db_max) ? std::string()
                                            : must_be(name, "between -200 and 200", value);
  };
  if (!in_range(path.exponent, 1.0, 10.0)) {
    return must_be("exponent", "between 1 and 10", path.exponent);
  }
  for (const std::string& wrong :
       {no_db("reference_loss_db", path.reference_loss_db),
        no_db("transmit_dbm", path.transmit_dbm), no_db("noise_dbm", path.noise_dbm)}) {
    if (!wrong.empty()) return wrong;
  }
  if (!(path.reference_m > 0.0) || !std::isfinite(path.reference_m)) {
    return must_be("reference_m", "positive and finite", path.reference_m);
  }
  if (!in_range(path.shadowing_sigma_db, 0.0, 30.0)) {
    return must_be("shadowing_sigma_db", "between 0 and 30", path.shadowing_sigma_db);
  }
  if (path.range_m) {
    if (*path.range_m > 0.0 && std::isfinite(*path.range_m)) return {};
    return must_be("range_m", "positive and finite", *path.range_m);
  }
  if (default_reach_m(path) >= path.reference_m) return {};
  std::ostringstream text;
  text << "nobody would hear: even at reference_m the signal is "
       << path.transmit_dbm - path.reference_loss_db << " dBm against a noise of " << path.noise_dbm
       << " dBm; raise transmit_dbm or lower reference_loss_db";
  return text.str();
}

Propagation Propagation::disk(double range_m) {
  if (!(range_m > 0.0) || !std::isfinite(range_m)) {
    refuse("disk", must_be("range_m", "positive and finite", range_m));
  }
  Propagation made;
  made.reach_m_ = range_m;
  return made;
}

Propagation Propagation::grey_zone(const GreyZone& zone) {
  refuse("grey zone", wrong_with(zone));
  Propagation made;
  made.model_ = Model::grey_zone;
  made.reach_m_ = zone.outer_m;
  made.zone_ = zone;
  return made;
}

Propagation Propagation::log_distance(const LogDistance& path) {
  refuse("log-distance", wrong_with(path));
  Propagation made;
  made.model_ = Model::log_distance;
  made.reach_m_ = path.range_m.value_or(default_reach_m(path));
  made.path_ = path;
  made.noise_mw_ = mw_of_dbm(path.noise_dbm);
  return made;
}

double Propagation::shadowing_db(std::uint64_t seed, AgentId a, AgentId b) const {
  if (model_ != Model::log_distance || path_.shadowing_sigma_db == 0.0) return 0.0;
  const Entity pair = Entity::link(std::min(a, b), std::max(a, b));
  return path_.shadowing_sigma_db * Stream(seed, shadowing, pair).normal();
}

LinkQuality Propagation::quality(double distance_m, double shadowing_db,
                                 double interference_mw) const {
  LinkQuality quality;
  if (distance_m > reach_m_) {
    quality.success = 0.0;
  } else if (model_ == Model::grey_zone && distance_m > zone_.inner_m) {
    quality.success = (zone_.outer_m - distance_m) / (zone_.outer_m - zone_.inner_m);
  }
  if (model_ != Model::log_distance) return quality;
  const double noise_dbm =
      interference_mw > 0.0 ? dbm_of_mw(noise_mw_ + interference_mw) : path_.noise_dbm;
  quality.snr_db = received_dbm(distance_m, shadowing_db) - noise_dbm;
  quality.log_bit_success = log_bit_success(quality.snr_db);
  return quality;
}

double Propagation::path_loss_db(double distance_m) const {
  if (model_ != Model::log_distance) return 20.0 * math::log10(std::max(distance_m, 1.0));
  const double ratio = std::max(distance_m / path_.reference_m, 1.0);
  return path_.reference_loss_db + 10.0 * path_.exponent * math::log10(ratio);
}

double Propagation::received_dbm(double distance_m, double shadowing_db) const {
  return path_.transmit_dbm - path_loss_db(distance_m) - shadowing_db;
}

double frame_success(const LinkQuality& quality, std::uint32_t frame_bytes) {
  if (quality.log_bit_success == 0.0 || quality.success == 0.0) return quality.success;
  return quality.success * math::exp(8.0 * frame_bytes * quality.log_bit_success);
}

bool frame_heard(const LinkQuality& quality, const PacketOnLink& packet, std::uint32_t frame,
                 std::uint32_t frame_bytes) {
  require(frame < frames_max, "propagation: a packet has too many frames");
  const double success = frame_success(quality, frame_bytes);
  if (frame == 0) return first_frame_heard(success, packet);
  if (success <= 0.0 || success >= 1.0) return success >= 1.0;
  FrameDraws draws(packet, reception);
  for (std::uint32_t f = 0; f < frame; ++f) draws.next();
  return draws.next() < success;
}

bool first_frame_heard(double success, const PacketOnLink& packet) {
  if (success <= 0.0 || success >= 1.0) return success >= 1.0;
  return first_frame_draw(packet, reception) < success;
}

bool packet_heard(const LinkQuality& quality, const PacketOnLink& packet, const FrameSizes& sizes) {
  require(sizes.frames <= frames_max, "propagation: a packet has too many frames");
  if (sizes.frames == 0) return true;
  if (sizes.frames == 1) return frame_heard(quality, packet, 0, sizes.last_bytes);
  const double success = frame_success(quality, sizes.frame_bytes);
  const double last_success = frame_success(quality, sizes.last_bytes);
  if (success >= 1.0 && last_success >= 1.0) return true;
  if (success <= 0.0 || last_success <= 0.0) return false;
  FrameDraws draws(packet, reception);
  for (std::uint32_t f = 0; f < sizes.frames; ++f) {
    if (draws.next() >= (f + 1 < sizes.frames ? success : last_success)) return false;
  }
  return true;
}

}  // namespace hearsay
