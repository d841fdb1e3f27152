#include "pipeline/report_cells.hpp"

#include "pipeline/report_assets.hpp"
#include "pipeline/report_text.hpp"
#include "stages/text.hpp"

namespace seampath {

std::string value_attributes(const ReportRow& row, const std::string& path) {
    return " data-row=\"" + path + '.' + row.name + "\" data-value=\"" + escape_html(exact(row)) + '"';
}

std::string cell(const ReportRows& rows, const std::string& path, std::string_view name) {
    const ReportRow& row = find_row(rows, name);
    const char* style = std::holds_alternative<std::string>(row.value) ? "" : " class=\"num\"";
    return "<td" + std::string(style) + value_attributes(row, path) + '>' + escape_html(shown(row)) + "</td>";
}

std::string cell_at(const std::string& pointer, double value, int decimals) {
    return "<td class=\"num\" data-at=\"" + pointer + "\" data-value=\"" + shortest(value) + "\">" +
           decimal(value, decimals) + "</td>";
}

std::string heading(std::string_view text, bool number) {
    return (number ? "<th scope=\"col\" class=\"num\">" : "<th scope=\"col\">") + std::string(text) + "</th>";
}

std::string badge(bool pass) {
    return pass ? "<span class=\"badge pass\">PASS</span>" : "<span class=\"badge fail\">FAIL</span>";
}

std::string page_head(std::string_view title) {
    return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta "
           "http-equiv=\"Content-Security-Policy\" "
           "content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">"
           "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><meta name=\"color-scheme\" "
           "content=\"light dark\"><title>" +
           escape_html(title) + "</title>\n<style>" + std::string(report_style()) + "</style></head>\n<body>\n";
}

std::string data_script(std::string_view id, const std::string& json) {
    std::string safe;
    for (const char c : json) {
        safe += c == '<' ? "\\u003c" : std::string(1, c);
    }
    return "<script type=\"application/json\" id=\"" + std::string(id) + "\">" + safe + "</script>\n";
}

std::string address(std::string_view path) {
    std::string text;
    for (const char c : path) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                           std::string_view("-._/").find(c) != std::string_view::npos;
        const auto byte = static_cast<unsigned char>(c);
        text +=
            plain ? std::string(1, c) : std::string{'%', "0123456789ABCDEF"[byte >> 4], "0123456789ABCDEF"[byte & 15]};
    }
    return text;
}

}  // namespace seampath
