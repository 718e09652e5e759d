#include "net/live/config.hpp"

#include <algorithm>

#include "net/live/messages.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::live {
namespace {

constexpr std::uint32_t domain_max = 230;  // beyond, its ports would be no ports
/// Ports of a domain are 250 apart, two for each participant, so that 119 is the most.
constexpr const char* participants_max = "119";

// On the loopback interface a datagram may be as large as there are any.
constexpr const char* loopback_general =
    "<Interfaces><NetworkInterface name=\"lo\" multicast=\"false\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast>"
    "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>63000B</FragmentSize>";
constexpr const char* loopback_peers = "<Peers><Peer address=\"127.0.0.1\"/></Peers>";

bool may_be_interface(const std::string& name) {
  return name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '.' || c == '-' || c == '_' || c == ':' || c == '@';
         });
}

}  // namespace

std::string cyclone_config(std::uint32_t domain, const std::string& interface) {
  if (domain > domain_max) {
    throw InputError("domain: " + std::to_string(domain) + "; allowed are 0 to 230");
  }
  if (!may_be_interface(interface)) {
    throw InputError("interface: '" + interface + "' is no name of a network interface");
  }
  const bool loopback = interface.empty();
  std::string xml = "<CycloneDDS><Domain Id=\"any\"><General>";
  xml += loopback ? loopback_general
                  : "<Interfaces><NetworkInterface name=\"" + interface + "\"/></Interfaces>";
  xml += "</General><Discovery><ExternalDomainId>" + std::to_string(domain) +
         "</ExternalDomainId><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>";
  xml += participants_max;
  xml += "</MaxAutoParticipantIndex><LeaseDuration>2s</LeaseDuration>";
  if (loopback) xml += loopback_peers;
  xml += "</Discovery><Internal><MaxSampleSize>" + std::to_string(sample_bytes_max) +
         "B</MaxSampleSize><WriteBatch>true</WriteBatch>";
  // What is on its way to a reader should fit into the buffer of its socket.
  xml +=
      "<Watermarks><WhcHigh>2MB</WhcHigh><WhcHighInit>2MB</WhcHighInit></Watermarks>"
      "<SocketReceiveBufferSize min=\"default\" max=\"4MB\"/></Internal></Domain></CycloneDDS>";
  return xml;
}

}  // namespace hearsay::live
