#include <gtest/gtest.h>

#include "tests/papers/sections.hpp"
#include "tests/pipeline/run_support.hpp"

namespace seampath {
namespace page_test {

TEST(PapersPage, IsWhatTheProgramComputes) {
    EXPECT_EQ(text_of(std::filesystem::path(SEAMPATH_SOURCE_DIR) / "docs" / "papers.md"), papers_page())
        << "docs/papers.md is stale; write it again: build/seampath_papers > docs/papers.md";
}

}  // namespace page_test
}  // namespace seampath
