#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "stages/read/cloud.hpp"

/// Binary records: typed columns at a fixed stride.
namespace seampath {

enum class Scalar { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
std::size_t size_of(Scalar type);

/// Numbers of one type, `stride` bytes apart; `swap` where their byte order is not this machine's.
struct Column {
    const char* first = nullptr;
    std::size_t stride = 0;
    Scalar type = Scalar::f32;
    bool swap = false;
};

/// One number, wherever it is aligned. 64-bit integers are rounded to a double.
double load(const char* at, Scalar type, bool swap);

/// Takes records 0 .. count - 1 into the cloud. The caller has shown that the columns hold them.
void decode_columns(Cloud& cloud, const std::array<Column, 3>& position,
                    const std::optional<std::array<Column, 3>>& normal, std::size_t count, bool record_numbers);

}  // namespace seampath
