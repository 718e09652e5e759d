// The digest of a record: XXH3, 128 bits.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sim/kernel/record.hpp"

namespace hearsay {

/// Name and version of the digest, as it stands before the colon: "xxh3-128/1". The version is
/// raised when the canonical form of a row changes.
inline constexpr const char* digest_name = "xxh3-128/1";

class Xxh3Digest final : public DigestSink {
 public:
  Xxh3Digest();
  ~Xxh3Digest() override;
  void update(std::span<const std::byte> bytes) override;
  /// 32 hexadecimal digits of what came so far.
  std::string hex() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// "xxh3-128/1:<run>" or, with a ledger, "xxh3-128/1:<run>+<ledger>".
std::string digest_text(const Xxh3Digest& run, const Xxh3Digest* ledger);

/// Digest of a text, for config_hash: "xxh3-128/1:…".
std::string text_digest(std::string_view text);

}  // namespace hearsay
