// Beliefs and their ledgers, packed. What take() makes of bytes that put() did not make is
// unspecified, and the Unpacker is no longer good(): a dimension beyond gaussian::dimension_max, a
// ledger that is none.
#pragma once

#include "agents/estimator.hpp"
#include "agents/packing.hpp"
#include "filters/grid/ledger.hpp"

namespace hearsay {

void put(Packer& out, const gaussian::Belief& belief);
void take(Unpacker& in, gaussian::Belief& belief);
void put(Packer& out, const Ledger& ledger);
void take(Unpacker& in, Ledger& ledger);
void put(Packer& out, const TrackedBelief& tracked);
void put(Packer& out, const grid::LookLedger& ledger);
void take(Unpacker& in, TrackedBelief& tracked);
/// Fails for a ledger of a grid of another shape.
void take(Unpacker& in, const grid::Shape& shape, grid::LookLedger& ledger);

}  // namespace hearsay
