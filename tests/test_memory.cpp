// SPDX-License-Identifier: Apache-2.0
#include "core/memory.h"

#include "core/error.h"
#include "tests/catch.h"
#include "tests/error_of.h"

using namespace vecino;

TEST_CASE("memory that no machine has is refused, memory that every one has is not", "[memory]") {
    const Error error = error_of([] { require_memory(std::uint64_t{1} << 60, "a.exr"); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what())
              .starts_with("a.exr: needs 1073741824.0 GiB of memory, this machine has "));
    CHECK_NOTHROW(require_memory(0, "a.exr"));
    CHECK_NOTHROW(require_memory(std::uint64_t{1} << 27, "a.exr"));
}

TEST_CASE("what planes take is counted as they are held", "[memory]") {
    CHECK(bytes_of(Planes::all(), {10, 3}) == 30 * 108);
    CHECK(bytes_of({Plane::radiance, Plane::id}, {65536, 65536}) == 16ull << 32);
    CHECK(bytes_of({}, {10, 3}) == 0);
}
