#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <sqlite3.h>

#include "stages/error.hpp"

namespace seampath {

/// An open SQLite database. Every failure is one of the file, so of the input.
class Database {
public:
    /// `flags` are those of sqlite3_open_v2. `kept` says what is kept there, e.g. "calibrations", for messages. Throws
    /// InputError when it can't be opened, as all members do for what the file refuses.
    Database(const std::filesystem::path& file, int flags, std::string kept) : file_(file), kept_(std::move(kept)) {
        constexpr int kBusy_ms = 5000;
        sqlite3* raw = nullptr;
        const int status = sqlite3_open_v2(file.c_str(), &raw, flags, nullptr);
        handle_.reset(raw);
        check(status);
        sqlite3_busy_timeout(raw, kBusy_ms);
    }

    void run(const std::string& sql) { check(sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr)); }

    using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;
    Statement prepare(const std::string& sql) {
        sqlite3_stmt* raw = nullptr;
        check(sqlite3_prepare_v2(handle_.get(), sql.c_str(), -1, &raw, nullptr));
        return {raw, sqlite3_finalize};
    }

    std::int64_t last_row() const { return sqlite3_last_insert_rowid(handle_.get()); }

    void check(int status) const {
        if (status != SQLITE_OK && status != SQLITE_DONE && status != SQLITE_ROW) {
            throw InputError("history: " + file_.string() + ": " +
                             (handle_ ? sqlite3_errmsg(handle_.get()) : "cannot open") + "; a database that " + kept_ +
                             " are written to was needed; check the path and permissions");
        }
    }

private:
    std::filesystem::path file_;
    std::string kept_;
    std::unique_ptr<sqlite3, decltype(&sqlite3_close)> handle_{nullptr, sqlite3_close};
};

/// Values for the parameters of a statement, in their order.
class Binder {
public:
    Binder(Database& database, sqlite3_stmt* statement) : database_(database), statement_(statement) {}
    void text(const std::string& value) {
        database_.check(
            sqlite3_bind_text(statement_, ++index_, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT));
    }
    void number(double value) { database_.check(sqlite3_bind_double(statement_, ++index_, value)); }
    void integer(std::int64_t value) { database_.check(sqlite3_bind_int64(statement_, ++index_, value)); }
    void flag(bool value) { database_.check(sqlite3_bind_int(statement_, ++index_, value)); }

private:
    Database& database_;
    sqlite3_stmt* statement_;
    int index_ = 0;
};

/// Values of a row, in their order.
class Columns {
public:
    explicit Columns(sqlite3_stmt* statement) : statement_(statement) {}
    std::string text() {
        const auto* value = reinterpret_cast<const char*>(sqlite3_column_text(statement_, next_++));
        return value ? value : "";
    }
    double number() { return sqlite3_column_double(statement_, next_++); }
    std::int64_t integer() { return sqlite3_column_int64(statement_, next_++); }
    bool flag() { return sqlite3_column_int(statement_, next_++) != 0; }

private:
    sqlite3_stmt* statement_;
    int next_ = 0;
};

}  // namespace seampath
