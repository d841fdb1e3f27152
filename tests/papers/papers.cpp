#include <iostream>

#include "tests/papers/sections.hpp"

/// Prints docs/papers.md.
int main() {
    std::cout << seampath::papers_page();
    return std::cout.flush() ? 0 : 1;
}
