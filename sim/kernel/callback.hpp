// A function without arguments and result that is kept in place: it never allocates.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace hearsay {

/// What happens at an event: any callable void() of at most 40 bytes that can be moved without
/// throwing. Move-only; callable any number of times; an empty one must not be called.
class Callback {
 public:
  static constexpr std::size_t bytes_max = 40;

  Callback() = default;

  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, Callback> &&
           std::is_invocable_v<std::remove_cvref_t<F>&>)
      Callback(F&& function) {  // NOLINT: implicit, so that schedule(…, [] { … }) reads well
    keep(std::forward<F>(function));
  }
  /// Drops what is held and takes `function`, built in place.
  template <class F>
  requires(!std::is_same_v<std::remove_cvref_t<F>, Callback> &&
           std::is_invocable_v<std::remove_cvref_t<F>&>) void
  operator=(F&& function) {
    clear();
    keep(std::forward<F>(function));
  }

  Callback(Callback&& other) noexcept { take(other); }
  Callback& operator=(Callback&& other) noexcept {
    if (this != &other) {
      clear();
      take(other);
    }
    return *this;
  }
  ~Callback() { clear(); }

  explicit operator bool() const { return kind_ != nullptr; }
  void operator()() { kind_->call(bytes_); }

  /// Asks the cache for what is behind the first captured pointer, which mostly is whom the
  /// callback acts on. If something else was captured first, nothing happens.
  void prefetch() const {
    const std::byte* first = nullptr;
    std::memcpy(&first, bytes_, sizeof first);
    __builtin_prefetch(first);
    __builtin_prefetch(first + 64);
    __builtin_prefetch(first + 128);
  }

 private:
  struct Kind {
    void (*call)(std::byte* at);
    void (*move)(std::byte* from, std::byte* to) noexcept;  // null: copy the bytes
    void (*destroy)(std::byte* at) noexcept;                // null: nothing to do
  };
  template <class F>
  static F* object(std::byte* at) {
    return std::launder(reinterpret_cast<F*>(at));
  }
  template <class F>
  static constexpr Kind kind_of = {
      [](std::byte* at) { (*object<F>(at))(); },
      std::is_trivially_copyable_v<F>
          ? nullptr
          : +[](std::byte* from, std::byte* to) noexcept {
              ::new (static_cast<void*>(to)) F(std::move(*object<F>(from)));
              std::destroy_at(object<F>(from));
            },
      std::is_trivially_destructible_v<F>
          ? nullptr
          : +[](std::byte* at) noexcept { std::destroy_at(object<F>(at)); }};

  template <class F>
  void keep(F&& function) {
    using Kept = std::remove_cvref_t<F>;
    static_assert(sizeof(Kept) <= bytes_max, "a callback captures more than 40 bytes");
    static_assert(alignof(Kept) <= alignof(std::max_align_t), "a callback is aligned too widely");
    static_assert(std::is_nothrow_move_constructible_v<Kept>, "moving a callback may throw");
    static_assert(std::is_nothrow_destructible_v<Kept>, "destroying a callback may throw");
    ::new (static_cast<void*>(bytes_)) Kept(std::forward<F>(function));
    kind_ = &kind_of<Kept>;
  }
  void take(Callback& other) noexcept {
    kind_ = std::exchange(other.kind_, nullptr);
    if (kind_ == nullptr) return;
    if (kind_->move != nullptr) {
      kind_->move(other.bytes_, bytes_);
    } else {
      std::memcpy(bytes_, other.bytes_, bytes_max);
    }
  }
  void clear() noexcept {
    const Kind* kind = std::exchange(kind_, nullptr);
    if (kind != nullptr && kind->destroy != nullptr) kind->destroy(bytes_);
  }

  alignas(std::max_align_t) std::byte bytes_[bytes_max];
  const Kind* kind_ = nullptr;
};

}  // namespace hearsay
