#include "tools/calibration_date.hpp"

#include <chrono>
#include <ctime>

#include "stages/error.hpp"

namespace seampath {

std::string date_of(const std::string& given) {
    std::tm time{};
    if (given.empty()) {
        const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
        gmtime_r(&now, &time);
    } else {
        const char* end = strptime(given.c_str(), "%Y-%m-%dT%H:%M:%SZ", &time);
        if (!end || *end != '\0') {
            throw InputError("--date: \"" + given + "\" is no date; one like 2026-11-26T05:00:00Z (UTC) was needed");
        }
    }
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &time);
    return text;
}

void check_acceptance(bool accept, const std::string& reason) {
    if (accept == reason.empty()) {
        throw InputError(accept ? "--accept: a reason was needed; add --reason TEXT"
                                : "--reason: it belongs to --accept; add it, or leave the reason out");
    }
}

}  // namespace seampath
