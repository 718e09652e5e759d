#include "sim/record/digest.hpp"

// With this header the library chooses the widest vectors that the processor has, when it runs.
// The values are the same. (It is only there where the library was built with that choice.)
#if defined(__x86_64__) && __has_include(<xxh_x86dispatch.h>)
#include <xxh_x86dispatch.h>
#else
#include <xxhash.h>
#endif

#include <new>

namespace hearsay {

struct Xxh3Digest::State {
  XXH3_state_t* hash = XXH3_createState();  // aligned to 64 bytes, which `new` need not do
  State() {
    if (hash == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(hash);
  }
  ~State() { XXH3_freeState(hash); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

namespace {

/// 32 digits, the most significant first: the canonical form of xxHash.
std::string hexadecimal(XXH128_hash_t hash) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : canonical.digest) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

}  // namespace

Xxh3Digest::Xxh3Digest() : state_(std::make_unique<State>()) {}

Xxh3Digest::~Xxh3Digest() = default;

void Xxh3Digest::update(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_->hash, bytes.data(), bytes.size());
}

std::string Xxh3Digest::hex() const { return hexadecimal(XXH3_128bits_digest(state_->hash)); }

std::string digest_text(const Xxh3Digest& run, const Xxh3Digest* ledger) {
  std::string text = std::string(digest_name) + ":" + run.hex();
  if (ledger != nullptr) text += "+" + ledger->hex();
  return text;
}

std::string text_digest(std::string_view text) {
  return std::string(digest_name) + ":" + hexadecimal(XXH3_128bits(text.data(), text.size()));
}

}  // namespace hearsay
