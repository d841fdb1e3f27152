#include "datasets/regression/history.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/database.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRuns = "runs of suites";

constexpr const char* kTables =
    "CREATE TABLE IF NOT EXISTS suite_run (id INTEGER PRIMARY KEY, date TEXT NOT NULL, suite TEXT NOT NULL,"
    " commit_name TEXT NOT NULL, build TEXT NOT NULL, machine TEXT NOT NULL, verdict TEXT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS suite_case (id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES suite_run(id),"
    " name TEXT NOT NULL, verdict TEXT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS suite_metric (suite_case INTEGER NOT NULL REFERENCES suite_case(id),"
    " seed INTEGER NOT NULL, name TEXT NOT NULL, value REAL);"  // NULL: not a number
    "CREATE INDEX IF NOT EXISTS suite_metric_by_case ON suite_metric(suite_case);";

/// Nothing that was written down is changed.
std::string guards() {
    std::string sql;
    for (const std::string table : {"suite_run", "suite_case", "suite_metric"}) {
        for (const std::string what : {"UPDATE", "DELETE"}) {
            sql += "CREATE TRIGGER IF NOT EXISTS " + table + "_no_" + what + " BEFORE " + what + " ON " + table +
                   " BEGIN SELECT RAISE(ABORT, 'the history is only added to'); END;";
        }
    }
    return sql;
}

void add_case(Database& database, std::int64_t run, const CaseResult& result) {
    const auto statement = database.prepare("INSERT INTO suite_case (run,name,verdict) VALUES (?,?,?)");
    Binder bind(database, statement.get());
    bind.integer(run);
    bind.text(result.id);
    bind.text(std::string(kCaseVerdictNames[static_cast<std::size_t>(result.judgement.verdict)]));
    database.check(sqlite3_step(statement.get()));
    const std::int64_t id = database.last_row();
    for (const CaseRun& one : result.runs) {
        for (const auto& [name, value] : one.measured.numbers) {
            const auto metric =
                database.prepare("INSERT INTO suite_metric (suite_case,seed,name,value) VALUES (?,?,?,?)");
            Binder bind_metric(database, metric.get());
            bind_metric.integer(id);
            bind_metric.integer(static_cast<std::int64_t>(one.seed));
            bind_metric.text(name);
            bind_metric.number(value);
            database.check(sqlite3_step(metric.get()));
        }
    }
}

/// Calls f with each row of a query that has one integer parameter.
template <class F>
void for_each_row(Database& database, const std::string& sql, std::int64_t parameter, const F& f) {
    const auto statement = database.prepare(sql);
    Binder(database, statement.get()).integer(parameter);
    int status = SQLITE_ROW;
    while ((status = sqlite3_step(statement.get())) == SQLITE_ROW) {
        f(Columns(statement.get()));
    }
    database.check(status);
}

}  // namespace

void add_to_suite_history(const fs::path& file, const SuiteResults& results) {
    Database database(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kRuns);
    database.run("BEGIN IMMEDIATE");  // the connection rolls back when it closes before the end
    database.run(kTables + guards());
    const auto statement =
        database.prepare("INSERT INTO suite_run (date,suite,commit_name,build,machine,verdict) VALUES (?,?,?,?,?,?)");
    Binder bind(database, statement.get());
    const SuiteFacts& f = results.facts;
    const std::string verdict(kCaseVerdictNames[static_cast<std::size_t>(verdict_of(results))]);
    for (const auto* value : {&f.date, &f.suite, &f.commit, &f.build, &f.machine, &verdict}) {
        bind.text(*value);
    }
    database.check(sqlite3_step(statement.get()));
    const std::int64_t run = database.last_row();
    for (const CaseResult& result : results.cases) {
        add_case(database, run, result);
    }
    database.run("COMMIT");
}

std::vector<HistoryRun> read_suite_history(const fs::path& file, const std::string& suite) {
    if (!fs::is_regular_file(file)) {
        throw InputError("history: there is no file " + file.string() +
                         "; the history.db in the --out folder of \"seampath dataset run\" was needed");
    }
    Database database(file, SQLITE_OPEN_READONLY, kRuns);
    std::vector<HistoryRun> runs;
    std::vector<std::int64_t> ids;
    for_each_row(database,
                 "SELECT id,date,suite,commit_name,build,machine,verdict FROM suite_run WHERE id > ? ORDER BY id", 0,
                 [&](Columns c) {
                     const std::int64_t id = c.integer();
                     HistoryRun run;
                     for (auto* value : {&run.facts.date, &run.facts.suite, &run.facts.commit, &run.facts.build,
                                         &run.facts.machine, &run.verdict}) {
                         *value = c.text();
                     }
                     if (run.facts.suite == suite) {
                         runs.push_back(std::move(run));
                         ids.push_back(id);
                     }
                 });
    for (std::size_t i = 0; i < runs.size(); ++i) {
        for_each_row(database,
                     "SELECT c.name,c.verdict,m.name,AVG(m.value) FROM suite_case c LEFT JOIN suite_metric m ON "
                     "m.suite_case = c.id WHERE c.run = ? GROUP BY c.id,m.name ORDER BY c.id",
                     ids[i], [&](Columns c) {
                         const std::string name = c.text(), verdict = c.text(), metric = c.text();
                         auto& cases = runs[i].cases;
                         if (cases.empty() || cases.back().id != name) {
                             cases.push_back({name, verdict, {}});
                         }
                         if (!metric.empty()) {
                             cases.back().metrics[metric] = c.number();
                         }
                     });
    }
    return runs;
}

}  // namespace seampath
