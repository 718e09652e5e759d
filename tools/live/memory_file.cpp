#include "tools/live/memory_file.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "agents/packing.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::fleet {

MemoryFile::MemoryFile(std::string file, std::string owner)
    : file_(std::move(file)), owner_(std::move(owner)) {
  if (!std::filesystem::exists(file_)) return;
  std::ifstream in(file_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw InputError(file_, 0, "cannot be read");
  Unpacker unpacker(std::as_bytes(std::span(text)));
  const std::string whose = unpacker.text();
  const std::span<const std::byte> memory = unpacker.bytes();
  if (!unpacker.done()) throw InputError(file_, 0, "is no memory of an agent, or damaged");
  if (whose != owner_) {
    throw InputError(file_, 0, "is the memory of another agent: of " + whose + ", not " + owner_);
  }
  memory_.assign(memory.begin(), memory.end());
}

bool MemoryFile::recall(Agent& agent) {
  if (memory_.empty()) return false;
  if (!agent.recall(memory_)) throw InputError(file_, 0, "is damaged: the agent cannot recall it");
  return true;
}

void MemoryFile::save(const Agent& agent) {
  if (!agent.save(now_)) {
    throw InputError(file_, 0, "agents of this kind cannot keep a memory");
  }
  if (now_ == memory_) return;
  bytes_.clear();
  Packer packer(bytes_);
  packer.text(owner_);
  packer.bytes(now_);
  const std::string fresh = file_ + ".new";
  std::ofstream out(fresh, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes_.data()),
            static_cast<std::streamsize>(bytes_.size()));
  out.close();
  if (!out || std::rename(fresh.c_str(), file_.c_str()) != 0) {
    throw std::runtime_error(file_ + ": cannot be written");
  }
  memory_.swap(now_);
}

}  // namespace hearsay::fleet
