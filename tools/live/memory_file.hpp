// What an agent remembers, in a file that outlives its process.
#pragma once

#include <string>
#include <vector>

#include "agents/remote/remote_world.hpp"

namespace hearsay::fleet {

class MemoryFile final : public remote::MemoryStore {
 public:
  /// `owner`: whose memory it is; that of another is refused. Reads the file, if it is there.
  /// @throws InputError if it cannot be read, or is another's.
  MemoryFile(std::string file, std::string owner);

  /// There was something in the file.
  bool remembers() const { return !memory_.empty(); }

  /// @throws InputError if what is in the file is damaged.
  bool recall(Agent& agent) override;
  /// Replaces the file, whole or not at all, if there is anything new. @throws std::runtime_error
  /// if it cannot be written, or agents of this kind cannot be saved.
  void save(const Agent& agent) override;

 private:
  std::string file_, owner_;
  std::vector<std::byte> memory_;  // as in the file
  std::vector<std::byte> now_, bytes_;
};

}  // namespace hearsay::fleet
