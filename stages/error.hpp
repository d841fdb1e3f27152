#pragma once

#include <stdexcept>
#include <string>

namespace seampath {

/// Bad input or bad configuration. The message reads "stage: what is wrong, with the value; what was needed; what to
/// do". The program ends with exit status 2.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The user asked the program to stop (Ctrl-C, SIGTERM). Exit status 130.
class Interrupted : public std::runtime_error {
public:
    Interrupted() : std::runtime_error("interrupted") {}
};

/// Our own mistake: a condition that the code itself must guarantee does not hold. Exit status 3.
class InternalError : public std::logic_error {
public:
    using std::logic_error::logic_error;
};

/// Assertion that stays on in every build; throws InternalError naming file and line. Builtins, because clang 14, which
/// builds the fuzzers, has no std::source_location.
inline void ensure(bool holds, const char* what, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    if (!holds) {
        throw InternalError(std::string(file) + ":" + std::to_string(line) + ": " + what);
    }
}

}  // namespace seampath
