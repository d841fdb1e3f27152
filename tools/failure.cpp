#include "tools/failure.hpp"

#include <iostream>
#include <new>
#include <sstream>

#include "stages/error.hpp"
#include "tools/exit_status.hpp"

namespace seampath {
namespace {

int fail(int status, const std::string& prefix, const std::string& message) {
    std::istringstream lines(message);
    for (std::string line; std::getline(lines, line);) {
        std::cerr << prefix << line << "\n";
    }
    return status;
}

}  // namespace

int guarded(const std::function<int()>& act, const std::string& prefix) {
    try {
        return act();
    } catch (const InputError& error) {
        return fail(kBadInput, prefix, error.what());
    } catch (const Interrupted&) {
        return fail(kInterrupted, prefix,
                    "interrupted; run the same command again to go on from the last finished stage");
    } catch (const std::bad_alloc&) {
        return fail(kBadInput, prefix,
                    "memory: there is not enough for this input; give the program more or a smaller scan");
    } catch (const std::exception& error) {
        return fail(kOwnFault, prefix, std::string("fault of the program itself: ") + error.what());
    }
}

}  // namespace seampath
