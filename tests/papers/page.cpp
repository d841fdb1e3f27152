#include "tests/papers/sections.hpp"

namespace seampath {

std::string markdown_table(const std::vector<std::vector<std::string>>& rows) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::string rule = "|";
        for (const auto& cell : rows[i]) {
            text += "| " + cell + " ";
            rule += " --- |";
        }
        text += "|\n" + (i == 0 ? rule + "\n" : "");
    }
    return text + "\n";
}

std::string papers_page() {
    return "# What the papers print, and what comes out\n\n"
           "Made by `build/seampath_papers > docs/papers.md`; a test holds that this page is what that program prints. "
           "The papers' tables are in `tests/papers/`.\n\n" +
           interpolation_section() + scanned_section() + parametrization_section() + saddle_section() +
           mechanism_section();
}

}  // namespace seampath
