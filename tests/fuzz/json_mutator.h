// SPDX-License-Identifier: Apache-2.0
//
// Changes documents as documents: bytes at random rarely leave JSON that a reader looks into.
#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace vecino::fuzz {

using RandomEngine = std::minstd_rand;

/// A document that differs in a few values, keys or elements, of at most so many bytes; empty where
/// the text is no JSON, or the change makes it too long.
std::string mutated_json(const std::string& text, std::size_t most_bytes, RandomEngine& random);

/// A document with a value of another one in the place of one of its own; empty as above.
std::string crossed_json(const std::string& text, const std::string& other, RandomEngine& random);

}  // namespace vecino::fuzz
