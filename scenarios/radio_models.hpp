// The models that make up a radio network, by name: what `hearsay list radios` shows.
//
// A model's parameters, their ranges and defaults are those of the schema; here stands only which
// keys belong to it, what it means and where it comes from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scenarios/schema.hpp"

namespace hearsay {

struct RadioModelInfo {
  std::string part;               ///< "loss", "propagation", … of the network
  std::string name;               ///< "gilbert-elliott"; with the part it is unique
  std::string chosen_by;          ///< the key whose value is `name`; empty: by its parameters
  std::string meaning;            ///< one sentence
  std::vector<std::string> keys;  ///< its parameters; "radio.loss.links." is all that begins so
  std::string source;             ///< a paper or book, or what the model is an idealisation of
};

/// All models, by part.
const std::vector<RadioModelInfo>& radio_models();

/// The model's parameters as the schema knows them, in the order of `keys`.
std::vector<KeyInfo> parameters(const RadioModelInfo& model);

/// The unit that the end of a key tells: "m" of "radio.range_m", "bit/s" of "radio.rate_bps". Empty
/// for plain numbers and for what is no number.
std::string unit_of(std::string_view key);

}  // namespace hearsay
