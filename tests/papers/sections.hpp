#pragma once

#include <string>
#include <vector>

/// docs/papers.md: the figures that the papers print beside those that the program computes. Each section computes its
/// figures when it is called.
namespace seampath {

std::string interpolation_section();    ///< Minejeva & Markovics
std::string scanned_section();          ///< the same methods on seams of scans
std::string parametrization_section();  ///< Marin
std::string saddle_section();           ///< Xue et al.
std::string mechanism_section();        ///< Naumov et al.

std::string papers_page();

/// A table in Markdown; the first row is the header.
std::string markdown_table(const std::vector<std::vector<std::string>>& rows);

}  // namespace seampath
